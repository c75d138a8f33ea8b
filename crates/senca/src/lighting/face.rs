//! The flat face of an object, as a place to measure light on.

use senca_math::glam::{DVec2, DVec3};
use senca_radiosity::{ElementMesh, LuxGrid, RadiosityError, Solution};
use senca_scene::Scene;

use crate::Error;

/// Cosine between normals of one face.
const SAME_DIRECTION: f64 = 0.9999;

/// Cosine between the normal of a face and the direction it is asked to look in.
const FACING: f64 = 0.8;

/// Share of the largest area that counts as the same.
const AS_LARGE: f64 = 0.999;

/// A grid of places, of which those on some polygons count, or all of them.
#[derive(Clone, Debug, PartialEq)]
pub struct LuxPlaces {
    /// The places.
    pub grid: LuxGrid,
    /// Polygons of the solution's mesh; empty where all places count.
    pub polygons: Vec<u32>,
}

impl From<LuxGrid> for LuxPlaces {
    fn from(grid: LuxGrid) -> Self {
        Self { grid, polygons: Vec::new() }
    }
}

impl LuxPlaces {
    /// Places about `spacing` apart on the largest flat face of the objects of this name, of equal ones the
    /// one that looks up most; with `facing`, of those that look about there.
    ///
    /// # Errors
    /// [`Error::UnknownObject`], and [`Error::Radiosity`] for the spacing.
    pub fn on_object(
        scene: &Scene,
        solution: &Solution,
        name: &str,
        facing: Option<DVec3>,
        spacing: Option<f64>,
    ) -> Result<Self, Error> {
        let names = object_names(scene);
        let named: Vec<bool> = names.iter().map(|(node, shape)| node == name || shape == name).collect();
        let mesh = &solution.mesh;
        let looks = |normal: DVec3| facing.is_none_or(|f| normal.dot(f.normalize_or_zero()) > FACING);
        let polygons = (0..mesh.polygons().len() as u32).filter(|&polygon| {
            let instance = mesh.surface(polygon).instance as usize;
            named.get(instance) == Some(&true) && looks(mesh.normal(polygon))
        });
        let face = largest_face(mesh, polygons).ok_or_else(|| {
            let mut known: Vec<String> = names.iter().map(|(node, _)| node.clone()).collect();
            known.dedup();
            Error::UnknownObject { name: name.to_owned(), known }
        })?;
        let grid = grid_on(mesh, &face, spacing).map_err(Error::from)?;
        Ok(Self { grid, polygons: face })
    }

    /// Whether a place of the grid counts.
    pub(super) fn counts(&self, mesh: &ElementMesh, place: DVec3) -> bool {
        let holds = |&polygon: &u32| {
            let (shape, normal) = (mesh.shape(polygon), mesh.normal(polygon));
            let corners = shape.corners();
            let next = corners.iter().cycle().skip(1);
            corners.iter().zip(next).all(|(a, b)| {
                let across = normal.cross(*b - *a);
                across.dot(place - *a) >= -1e-9 * across.length_squared()
            })
        };
        self.polygons.is_empty() || self.polygons.iter().any(holds)
    }
}

/// Names of node and geometry of each instance.
fn object_names(scene: &Scene) -> Vec<(String, String)> {
    let names = |instance: &senca_scene::Instance| {
        let node = scene.nodes[instance.node.index()].name.clone();
        (node, scene.geometries[instance.geometry.index()].name.clone())
    };
    scene.instances().iter().map(names).collect()
}

/// Polygons of the plane that most area lies in.
fn largest_face(mesh: &ElementMesh, polygons: impl Iterator<Item = u32>) -> Option<Vec<u32>> {
    let reach = 1e-5 * mesh.bounds().diagonal();
    let mut faces: Vec<(f64, Vec<u32>)> = Vec::new();
    for polygon in polygons {
        let element = &mesh.elements()[polygon as usize];
        let lies_in = |(_, face): &&mut (f64, Vec<u32>)| {
            let normal = mesh.normal(face[0]);
            let height = normal.dot(element.center - mesh.elements()[face[0] as usize].center);
            normal.dot(mesh.normal(polygon)) > SAME_DIRECTION && height.abs() <= reach
        };
        match faces.iter_mut().find(lies_in) {
            Some((area, face)) => {
                *area += element.area;
                face.push(polygon);
            }
            None => faces.push((element.area, vec![polygon])),
        }
    }
    let largest = faces.iter().map(|face| face.0).fold(0.0, f64::max);
    let up = |face: &(f64, Vec<u32>)| mesh.normal(face.1[0]).y;
    let large = faces.into_iter().filter(|face| face.0 >= AS_LARGE * largest);
    large.reduce(|a, b| if up(&b) > up(&a) { b } else { a }).map(|face| face.1)
}

/// A rectangle of places around a face: seen from above where it lies, upright where it stands.
fn grid_on(mesh: &ElementMesh, face: &[u32], spacing: Option<f64>) -> Result<LuxGrid, RadiosityError> {
    /// Places along the longer side where no spacing is given.
    const PLACES_ALONG: f64 = 20.0;
    let normal = mesh.normal(face[0]);
    let (right, down) = if normal.y.abs() > 0.9 {
        let right = DVec3::X.reject_from_normalized(normal).normalize();
        let down = normal.cross(right);
        (right, if down.z < 0.0 { -down } else { down })
    } else {
        let right = DVec3::Y.cross(normal).normalize();
        (right, right.cross(normal))
    };
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for &polygon in face {
        for corner in mesh.shape(polygon).corners() {
            let at = DVec2::new(corner.dot(right), corner.dot(down));
            (low, high) = (low.min(at), high.max(at));
        }
    }
    let plane = normal * normal.dot(mesh.elements()[face[0] as usize].center);
    let size = high - low;
    let spacing = spacing.unwrap_or(size.max_element() / PLACES_ALONG);
    let corner = plane + right * low.x + down * low.y;
    let grid = LuxGrid::rectangle(corner, [right * size.x, down * size.y], spacing)?;
    Ok(LuxGrid { normal, ..grid })
}
