//! Scene files.

use senca_scene::math::LinearRgb;
use senca_scene::math::glam::{DMat3, DMat4, DVec3};
use senca_scene::{
    Attenuation, Camera, CameraId, Geometry, Light, LightId, LightKind, Node, Projection, Scene, Shape,
    Transform,
};

use super::{object, vector};
use crate::text::Cursor;
use crate::{Files, ReadError};

/// Line 1 of a scene file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClassicProjection {
    /// 0: parallel along the view plane's normal.
    Parallel,
    /// 1: perspective.
    Perspective,
}

/// What the 1991 program draws, line 9 of a scene file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClassicOperation {
    /// 0: edges.
    Wireframe,
    /// 1: edges and vertex normals.
    WireframeWithNormals,
    /// 2: edges, then faces after Phong.
    Phong,
    /// 3: edges, then faces after Gouraud.
    Gouraud,
}

/// An object of a scene: four lines.
#[derive(Clone, Debug, PartialEq)]
pub struct ClassicObject {
    /// Object file, beside the scene file.
    pub file: String,
    /// Scale along the world's axes, after the rotation.
    pub scale: DVec3,
    /// Angles about x, then y, then z, in degrees.
    pub rotation_degrees: DVec3,
    /// Translation, last.
    pub translation: DVec3,
}

/// A scene file as it stands, line by line (1991 thesis, section 12.2.8).
#[derive(Clone, Debug, PartialEq)]
pub struct ClassicScene {
    /// Line 1.
    pub projection: ClassicProjection,
    /// Line 2, VPD: distance of the view plane from `vrp` along `vpn`; the program's back plane.
    pub view_plane_distance: f64,
    /// Line 3, COP: distance of the centre of projection from `vrp` along `vpn`, > 0 in perspective.
    pub projection_distance: f64,
    /// Line 4, VRP: view reference point, in world coordinates.
    pub vrp: DVec3,
    /// Line 5, VPN: normal of the view plane, towards the viewer.
    pub vpn: DVec3,
    /// Line 6, VUP: what is up, not parallel to `vpn`.
    pub vup: DVec3,
    /// Line 7: width and height of the window around `vrp`, each > 0.
    pub window: [f64; 2],
    /// Line 8: height of the picture in pixels, > 0.
    pub raster_height: u32,
    /// Line 9.
    pub operation: ClassicOperation,
    /// Line 10: direction towards the light; `None` for the operations 0 and 1, which pass the line over.
    pub light: Option<DVec3>,
    /// Line 11: bitmap to write; `None` for the operations 0 and 1, which pass the line over.
    pub output: Option<String>,
    /// Lines 12 and on.
    pub objects: Vec<ClassicObject>,
}

/// Reads a scene file and the object files that it names.
///
/// The scene gets a camera, for the operations 2 and 3 a white parallel light, and a node per
/// object; objects that share a file share their geometry. Use [`ClassicScene::parse`] for what has
/// no place in a [`Scene`]: the operation, the picture's height and the bitmap's name.
///
/// # Errors
/// With file, line and column where a file breaks its format, and when an object file is missing.
pub fn read_scene(name: &str, bytes: &[u8], files: &dyn Files) -> Result<Scene, ReadError> {
    ClassicScene::parse(name, bytes)?.to_scene(name, files)
}

impl ClassicScene {
    /// Reads the scene file alone.
    ///
    /// # Errors
    /// With line and column where the file breaks the format.
    pub fn parse(name: &str, bytes: &[u8]) -> Result<Self, ReadError> {
        let mut lines = Lines { cursor: Cursor::new(name, bytes), begun: false };
        let projection = match lines.choice("the projection type, 0 (parallel) or 1 (perspective)", 2)? {
            0 => ClassicProjection::Parallel,
            _ => ClassicProjection::Perspective,
        };
        let view_plane_distance = lines.next()?.f64("the distance of the view plane")?;
        let start = lines.next()?.pos;
        let projection_distance = lines.cursor.f64("the distance of the centre of projection")?;
        if projection == ClassicProjection::Perspective && projection_distance <= 0.0 {
            let message = "the distance of the centre of projection must be positive";
            return Err(lines.cursor.malformed(start, message));
        }
        let vrp = vector(lines.next()?, ["x of VRP", "y of VRP", "z of VRP"])?;
        let start = lines.next()?.pos;
        let vpn = vector(&mut lines.cursor, ["x of VPN", "y of VPN", "z of VPN"])?;
        if vpn.try_normalize().is_none() {
            return Err(lines.cursor.malformed(start, "VPN must have a direction"));
        }
        let start = lines.next()?.pos;
        let vup = vector(&mut lines.cursor, ["x of VUP", "y of VUP", "z of VUP"])?;
        if side(vpn, vup).is_none() {
            return Err(lines.cursor.malformed(start, "VUP must have a direction other than VPN's"));
        }
        let window =
            [lines.positive("the width of the window")?, lines.same_positive("the height of the window")?];
        let raster_height = lines.raster_height()?;
        let operation = match lines.choice("the operation, 0 to 3", 4)? {
            0 => ClassicOperation::Wireframe,
            1 => ClassicOperation::WireframeWithNormals,
            2 => ClassicOperation::Phong,
            _ => ClassicOperation::Gouraud,
        };
        let (light, output) = lines.light_and_output(operation)?;
        let objects = lines.objects()?;
        Ok(Self {
            projection,
            view_plane_distance,
            projection_distance,
            vrp,
            vpn,
            vup,
            window,
            raster_height,
            operation,
            light,
            output,
            objects,
        })
    }

    /// The scene with its objects. `name` is the scene file's.
    ///
    /// # Errors
    /// As [`read_scene`].
    pub fn to_scene(&self, name: &str, files: &dyn Files) -> Result<Scene, ReadError> {
        let mut scene = Scene { name: crate::stem(name), ..Scene::default() };
        self.add_camera(&mut scene);
        self.add_light(&mut scene);
        let mut known = std::collections::HashMap::new();
        for object in &self.objects {
            let geometry = match known.get(&object.file) {
                Some(&geometry) => geometry,
                None => {
                    let (mesh, warnings) = object::mesh(&object.file, &files.read(&object.file)?)?;
                    scene.warnings.extend(warnings);
                    let (name, shape) = (crate::stem(&object.file), Shape::Mesh(mesh));
                    let geometry = scene.add_geometry(Geometry { name, shape, material: None });
                    known.insert(object.file.clone(), geometry);
                    geometry
                }
            };
            let transform = Transform::Matrix(object.world_from_object());
            let name = crate::stem(&object.file);
            let node = scene.add_node(Node { name, transform, geometry: Some(geometry), ..Node::default() });
            scene.roots.push(node);
        }
        Ok(scene)
    }

    /// Width of the picture in pixels: `raster_height` times the window's aspect, cut off.
    #[must_use]
    pub fn raster_width(&self) -> u32 {
        (f64::from(self.raster_height) * self.window[0] / self.window[1]) as u32
    }

    /// The camera at the centre of projection. The program clips nothing, so no planes are set.
    fn add_camera(&self, scene: &mut Scene) {
        let [width, height] = self.window;
        let aspect = Some(width / height);
        let distance = self.projection_distance;
        let projection = match self.projection {
            ClassicProjection::Perspective => {
                let yfov = 2.0 * (0.5 * height / distance).atan();
                Projection::Perspective { yfov, aspect, near: None, far: None }
            }
            ClassicProjection::Parallel => Projection::Orthographic { height, aspect, near: None, far: None },
        };
        scene.cameras.push(Camera::new("view", projection));
        let z = self.vpn.normalize_or(DVec3::Z);
        let x = side(self.vpn, self.vup).unwrap_or(DVec3::X);
        let eye = self.vrp + z * distance;
        add_root(scene, "view", frame(x, z, eye), |node| node.camera = Some(CameraId(0)));
    }

    fn add_light(&self, scene: &mut Scene) {
        let Some(towards) = self.light.and_then(DVec3::try_normalize) else { return };
        let (color, kind) = (LinearRgb::WHITE, LightKind::Parallel);
        scene.lights.push(Light { name: "light".to_owned(), color, attenuation: Attenuation::None, kind });
        let place = frame(towards.any_orthonormal_vector(), towards, DVec3::ZERO);
        add_root(scene, "light", place, |node| node.light = Some(LightId(0)));
    }
}

impl ClassicObject {
    /// T S Rz Ry Rx: the scale acts after the rotation, so an uneven one shears a turned object.
    #[must_use]
    pub fn world_from_object(&self) -> DMat4 {
        let [x, y, z] = self.rotation_degrees.to_array().map(f64::to_radians);
        let rotation = DMat4::from_rotation_z(z) * DMat4::from_rotation_y(y) * DMat4::from_rotation_x(x);
        DMat4::from_translation(self.translation) * DMat4::from_scale(self.scale) * rotation
    }
}

/// The u axis: horizontal in the picture.
fn side(vpn: DVec3, vup: DVec3) -> Option<DVec3> {
    vup.try_normalize()?.cross(vpn.try_normalize()?).try_normalize()
}

fn frame(x: DVec3, z: DVec3, origin: DVec3) -> DMat4 {
    let y = z.cross(x);
    DMat4::from_mat3_translation(DMat3::from_cols(x, y, z), origin)
}

fn add_root(scene: &mut Scene, name: &str, place: DMat4, set: impl FnOnce(&mut Node)) {
    let mut node = Node { name: name.to_owned(), transform: Transform::Matrix(place), ..Node::default() };
    set(&mut node);
    let node = scene.add_node(node);
    scene.roots.push(node);
}

/// The lines of the file, one by one.
struct Lines<'a> {
    cursor: Cursor<'a>,
    begun: bool,
}

impl<'a> Lines<'a> {
    /// The cursor at the next line, behind its blanks.
    fn next(&mut self) -> Result<&mut Cursor<'a>, ReadError> {
        if self.begun {
            self.cursor.next_line();
        }
        self.begun = true;
        self.cursor.skip_blanks();
        Ok(&mut self.cursor)
    }

    /// A whole number below `count` on the next line.
    fn choice(&mut self, what: &str, count: i64) -> Result<i64, ReadError> {
        let start = self.next()?.pos;
        let value = self.cursor.integer(what)?;
        if (0..count).contains(&value) {
            return Ok(value);
        }
        Err(self.cursor.malformed(start, format!("expected {what}, found {value}")))
    }

    fn positive(&mut self, what: &str) -> Result<f64, ReadError> {
        self.next()?;
        self.same_positive(what)
    }

    /// A positive number on the same line.
    fn same_positive(&mut self, what: &str) -> Result<f64, ReadError> {
        self.cursor.skip_blanks();
        let start = self.cursor.pos;
        let value = self.cursor.f64(what)?;
        if value > 0.0 {
            return Ok(value);
        }
        Err(self.cursor.malformed(start, format!("{what} must be positive, not {value}")))
    }

    fn raster_height(&mut self) -> Result<u32, ReadError> {
        let start = self.next()?.pos;
        let value = self.cursor.integer("the raster height in pixels")?;
        let height = u32::try_from(value).ok().filter(|height| (1..=65_536).contains(height));
        height.ok_or_else(|| {
            self.cursor.malformed(start, format!("the raster height must be 1 to 65536 pixels, not {value}"))
        })
    }

    /// Lines 10 and 11, which wireframes pass over.
    fn light_and_output(
        &mut self,
        operation: ClassicOperation,
    ) -> Result<(Option<DVec3>, Option<String>), ReadError> {
        if matches!(operation, ClassicOperation::Wireframe | ClassicOperation::WireframeWithNormals) {
            self.next()?;
            self.next()?;
            return Ok((None, None));
        }
        let start = self.next()?.pos;
        let light = vector(&mut self.cursor, ["x of the light", "y of the light", "z of the light"])?;
        if light.try_normalize().is_none() {
            return Err(self.cursor.malformed(start, "the light must have a direction"));
        }
        let output = self.word("the name of the bitmap")?;
        Ok((Some(light), Some(output)))
    }

    /// The first word of the next line.
    fn word(&mut self, what: &str) -> Result<String, ReadError> {
        let cursor = self.next()?;
        if cursor.at_line_end() {
            return Err(cursor.expected(what));
        }
        Ok(String::from_utf8_lossy(cursor.word()).into_owned())
    }

    fn objects(&mut self) -> Result<Vec<ClassicObject>, ReadError> {
        let count = self.next()?.count("the number of objects")?;
        let mut objects = Vec::new();
        for _ in 0..count {
            let file = self.word("the name of an object file")?;
            let scale = vector(self.next()?, ["x of the scale", "y of the scale", "z of the scale"])?;
            let angles = ["the angle about x", "the angle about y", "the angle about z"];
            let rotation_degrees = vector(self.next()?, angles)?;
            let parts = ["x of the translation", "y of the translation", "z of the translation"];
            let translation = vector(self.next()?, parts)?;
            objects.push(ClassicObject { file, scale, rotation_degrees, translation });
        }
        Ok(objects)
    }
}
