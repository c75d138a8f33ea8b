//! Light baked into a scene that other programs show as it is.
//!
//! - [`bake_vertex_colors`]: the mesh of the solution with a colour at each vertex. Textures stay what
//!   they are, multiplied by the colours.
//! - [`bake_lightmap`]: the polygons of the scene as they are, with one picture that holds what each place
//!   shows, textures included, on coordinates of its own.
//!
//! - [`bake_light_picture`]: the light alone, on the same coordinates, for programs that multiply.
//!
//! Materials are unlit; colours above white are cut off, since that is what viewers would do.

mod atlas;

use senca_math::glam::{DVec2, DVec3, Vec2, Vec4};
use senca_math::{Image, LinearRgb, Srgb8};
use senca_scene::{
    Faces, Filter, Geometry, ImageData, ImageId, Material, MaterialId, Mesh, Node, Phong, Reflection, Scene,
    Shape, Surface, Texture, TextureId, TextureImage, TextureRef, Wrap,
};
use senca_trace::{Interaction, MaterialPoint, MaterialTable, ReflectionPoint};

use crate::display::{ElementFinder, LightField, ShownColors, matt_share, shown_scene};
use crate::{NONE, RadiosityError};
use atlas::Atlas;

/// Sides of lightmaps, in texels.
const LIGHTMAP_SIDES: std::ops::RangeInclusive<u32> = 16..=16_384;

/// The light of `field` as colours of vertices: see [`shown_scene`].
#[must_use]
pub fn bake_vertex_colors(scene: &Scene, field: &LightField<'_>) -> Scene {
    let mut baked = shown_scene(scene, field, ShownColors::Portable);
    for geometry in &mut baked.geometries {
        if let Shape::Mesh(mesh) = &mut geometry.shape {
            mesh.vertices.color.iter_mut().for_each(|color| *color = color.clamp(Vec4::ZERO, Vec4::ONE));
        }
    }
    drop_unused_pictures(&mut baked);
    baked
}

/// The light of `field` as a picture of `side` times `side` texels, 16 to 16 384, laid onto the polygons.
///
/// # Errors
/// [`RadiosityError::Setting`] when the side is out of range, or too small for so many polygons.
pub fn bake_lightmap(
    scene: &Scene,
    field: &LightField<'_>,
    finder: &ElementFinder<'_>,
    side: u32,
) -> Result<Scene, RadiosityError> {
    let refuse = |expected| RadiosityError::Setting { name: "lightmap side", value: side.into(), expected };
    if !LIGHTMAP_SIDES.contains(&side) {
        return Err(refuse("from 16 to 16384 texels"));
    }
    let elements = field.mesh();
    let atlas = Atlas::of(elements, side).ok_or_else(|| refuse("larger: the polygons find no room"))?;
    let painter = Painter { materials: MaterialTable::new(scene), field, finder };
    let texels = atlas.paint(elements, &|polygon, point| painter.color(polygon, point));
    let mut baked = Scene { name: scene.name.clone(), background: scene.background, ..Scene::default() };
    baked.images.push(TextureImage { name: "light".into(), data: encoded(&texels, side) });
    baked.textures.push(Texture {
        name: "light".into(),
        image: ImageId(0),
        wrap_u: Wrap::Clamp,
        wrap_v: Wrap::Clamp,
        // Smaller copies of the picture would mix neighbouring charts.
        filter: Filter::Bilinear,
    });
    let texture = Some(TextureRef::new(TextureId(0)));
    let white = LinearRgb::WHITE;
    let reflection = Reflection::Phong(Phong { ambient: white, diffuse: white, texture, ..Phong::default() });
    baked.add_material(Material { name: "light".into(), reflection, unlit: true, ..Material::default() });
    let shape = Shape::Mesh(mesh_of(elements, &atlas));
    let geometry =
        baked.add_geometry(Geometry { name: "light".into(), shape, material: Some(MaterialId(0)) });
    let root = baked.add_node(Node { name: "light".into(), geometry: Some(geometry), ..Node::default() });
    baked.roots.push(root);
    crate::display::add_cameras(scene, &mut baked);
    Ok(baked)
}

/// The light alone, what a white matt surface would show, on the coordinates of [`bake_lightmap`] with the same
/// side: linear, as bright as it is.
///
/// # Errors
/// As [`bake_lightmap`].
pub fn bake_light_picture(field: &LightField<'_>, side: u32) -> Result<Image, RadiosityError> {
    let refuse = |expected| RadiosityError::Setting { name: "lightmap side", value: side.into(), expected };
    if !LIGHTMAP_SIDES.contains(&side) {
        return Err(refuse("from 16 to 16384 texels"));
    }
    let atlas = Atlas::of(field.mesh(), side).ok_or_else(|| refuse("larger: the polygons find no room"))?;
    // The leaf is found down the polygon's tree, without a look at what is around.
    let texels = atlas.paint(field.mesh(), &|polygon, point| {
        let leaf = crate::gather::leaf_at(field.mesh(), polygon, point);
        field.at(leaf, point)
    });
    let pixels = texels.iter().map(|light| [light.r, light.g, light.b, 1.0]).collect();
    Image::from_pixels(side, side, pixels).ok_or_else(|| refuse("that of the texels"))
}

/// Pictures that no material shows are not written.
fn drop_unused_pictures(scene: &mut Scene) {
    let used = scene.materials.iter().any(|material| {
        let base = match &material.reflection {
            Reflection::Phong(phong) => phong.texture,
            Reflection::MetallicRoughness(rough) => rough.base_color_texture,
        };
        base.is_some() || material.emission_texture.is_some()
    });
    if !used {
        scene.textures.clear();
        scene.images.clear();
    }
}

/// Colours of places.
struct Painter<'a> {
    materials: MaterialTable<'a>,
    field: &'a LightField<'a>,
    finder: &'a ElementFinder<'a>,
}

impl Painter<'_> {
    /// What a place of a polygon shows.
    fn color(&self, polygon: u32, point: DVec3) -> LinearRgb {
        let elements = self.field.mesh();
        let place = self.finder.on_polygon(polygon, point);
        let arriving = self.field.at(place.element, place.point);
        let material = self.material(polygon, point);
        match material.reflection {
            ReflectionPoint::Unlit(color) => color + material.emission,
            _ if elements.has_attributes() => material.emission + matt_share(&material) * arriving,
            // Without texture coordinates a picture counts by its average.
            _ => elements.surface(polygon).emission + elements.surface(polygon).reflectance * arriving,
        }
    }

    fn material(&self, polygon: u32, point: DVec3) -> MaterialPoint {
        let elements = self.field.mesh();
        let attributes = elements.attributes_at(polygon, point);
        let normal = elements.normal(polygon);
        self.materials.at(&Interaction {
            point,
            normal,
            shading_normal: normal,
            to_viewer: normal,
            entering: true,
            texcoords: attributes.texcoords.map(Vec2::as_dvec2),
            tangent: DVec3::ZERO,
            handedness: 1.0,
            color: attributes.color,
            material: elements.surface(polygon).material as usize,
            object: 0,
            error: 0.0,
        })
    }
}

fn encoded(texels: &[LinearRgb], side: u32) -> ImageData {
    let encode = |color: &LinearRgb| {
        let Srgb8 { r, g, b } = color.to_srgb8();
        [r, g, b, 255]
    };
    ImageData::Rgba8 { width: side, height: side, texels: texels.iter().map(encode).collect() }
}

/// The polygons with coordinates of the picture.
fn mesh_of(elements: &crate::ElementMesh, atlas: &Atlas) -> Mesh {
    let mut mesh = Mesh { faces: Faces::default(), ..Mesh::default() };
    mesh.surfaces.push(Surface { smooth: false, ..Surface::default() });
    mesh.points = elements.positions().iter().map(|p| p.as_vec3()).collect();
    for polygon in 0..elements.polygons().len() as u32 {
        let [a, b, c, d] = elements.elements()[polygon as usize].vertices;
        let first = mesh.vertices.point.len() as u32;
        for vertex in [a, b, c, d].into_iter().filter(|&vertex| vertex != NONE) {
            let uv: DVec2 = atlas.uv(polygon, elements.positions()[vertex as usize]);
            mesh.vertices.point.push(vertex);
            mesh.vertices.texcoord0.push(uv.as_vec2());
        }
        mesh.faces.push(&[first, first + 1, first + 2], 0);
        if d != NONE {
            mesh.faces.push(&[first, first + 2, first + 3], 0);
        }
    }
    mesh
}

#[cfg(test)]
mod tests;
