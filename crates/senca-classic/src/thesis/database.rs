//! Objects, surfaces, polygons, vertices and vertex normals, linked both ways.
//!
//! Records stand in lists of their object, and a link is a place in such a list; the program had
//! pointers. Links go down from object to surface to polygon to vertex, and back up: a vertex knows
//! its normals, a normal its polygons, a polygon its surface. A vertex has one normal for each
//! surface it belongs to, so shading is smooth within a surface and creased between surfaces.
//! Source: 1991 thesis, section 9 and figures 42 and 43.

use senca_io::classic::{ClassicObject, ClassicScene};
use senca_io::{Files, Location, ReadError};
use senca_math::ViewKind;
use senca_math::glam::{DMat4, DVec3, DVec4};
use senca_scene::{Scene, Shape, Warning, polygon_normal_1991};

use super::build::{BuildAlgorithm, ObjectRecords};

/// All objects of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Database {
    /// In the order of the scene file.
    pub objects: Vec<Object>,
}

/// An object with all its records.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// How the scene file places it.
    pub placement: ClassicObject,
    /// The same as a matrix.
    pub world_from_object: DMat4,
    /// In the order of the file.
    pub vertices: Vec<Vertex>,
    /// Normals of vertices, surface by surface.
    pub normals: Vec<VertexNormal>,
    /// In the order of the file.
    pub polygons: Vec<Polygon>,
    /// In the order of the file.
    pub surfaces: Vec<Surface>,
}

/// A vertex: one place, shared by all polygons around it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Vertex {
    /// Where the file puts it.
    pub local: DVec3,
    /// In world coordinates.
    pub world: DVec3,
    /// In device coordinates: pixels from the top left corner and depth, divided by w where the
    /// vertex lies before the eye, and then with w = 1.
    pub screen: DVec4,
    /// Its normals, one for each surface.
    pub normals: Vec<usize>,
}

/// The normal of a vertex on one surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VertexNormal {
    /// The vertex.
    pub vertex: usize,
    /// The surface.
    pub surface: usize,
    /// Polygons of the surface around the vertex.
    pub polygons: Vec<usize>,
    /// Unit vector in world coordinates; zero before it is computed, or where the polygons' cancel.
    pub normal: DVec3,
}

/// A corner of a polygon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Corner {
    /// The vertex there.
    pub vertex: usize,
    /// The vertex' normal on the polygon's surface.
    pub normal: usize,
}

/// A polygon: flat, convex, counter-clockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polygon {
    /// The surface that it belongs to.
    pub surface: usize,
    /// Its corners, at least three.
    pub corners: Vec<Corner>,
    /// Unit vector in world coordinates; zero before it is computed.
    pub normal: DVec3,
    /// Whether it turns its back to the viewer.
    pub culled: bool,
    /// Line of the object file, from 1.
    pub line: u32,
}

/// A group of polygons that is smooth in itself.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Surface {
    /// Its polygons.
    pub polygons: Vec<usize>,
}

impl Database {
    /// Reads the object files that `scene` names and builds the database; oddities come as warnings.
    ///
    /// # Errors
    /// With file, line and column where a file breaks its format, and when one is missing.
    pub fn load(
        scene: &ClassicScene,
        files: &dyn Files,
        algorithm: BuildAlgorithm,
    ) -> Result<(Self, Vec<Warning>), ReadError> {
        let mut warnings = Vec::new();
        let mut objects = Vec::with_capacity(scene.objects.len());
        for placement in &scene.objects {
            let (records, odd) = read_records(&placement.file, &files.read(&placement.file)?, files)?;
            warnings.extend(odd);
            objects.push(Object::build(placement.clone(), &records, algorithm));
        }
        Ok((Self { objects }, warnings))
    }

    /// Places all vertices in the world.
    pub fn place(&mut self) {
        for object in &mut self.objects {
            let m = object.world_from_object;
            object.vertices.iter_mut().for_each(|v| v.world = m.transform_point3(v.local));
        }
    }

    /// Computes the normals of polygons and vertices in the world.
    ///
    /// # Errors
    /// With file and line for a polygon no three consecutive corners of which span a plane.
    pub fn compute_normals(&mut self) -> Result<(), ReadError> {
        for object in &mut self.objects {
            for polygon in 0..object.polygons.len() {
                object.compute_polygon_normal(polygon)?;
            }
            for normal in 0..object.normals.len() {
                object.compute_vertex_normal(normal);
            }
        }
        Ok(())
    }

    /// Marks the polygons that turn their back; those seen edge-on do not (section 4).
    pub fn cull(&mut self, kind: &ViewKind) {
        for object in &mut self.objects {
            let vertices = &object.vertices;
            for polygon in &mut object.polygons {
                let first = vertices[polygon.corners[0].vertex].world;
                polygon.culled = kind.sees_back_of(first, polygon.normal);
            }
        }
    }

    /// Puts a vertex elsewhere, in the object's coordinates: its polygons, and the normals around
    /// them, follow by the links; nothing else is computed again.
    ///
    /// # Errors
    /// When a polygon loses its plane; it then keeps the normal it had.
    ///
    /// # Panics
    /// When there is no such object or vertex.
    pub fn move_vertex(&mut self, object: usize, vertex: usize, local: DVec3) -> Result<(), ReadError> {
        let object = &mut self.objects[object];
        object.vertices[vertex].local = local;
        object.vertices[vertex].world = object.world_from_object.transform_point3(local);
        let around = object.vertices[vertex].normals.clone();
        let polygons: Vec<usize> = around.iter().flat_map(|&n| object.normals[n].polygons.clone()).collect();
        let outcome = polygons.iter().try_for_each(|&polygon| object.compute_polygon_normal(polygon));
        let mut touched: Vec<usize> =
            polygons.iter().flat_map(|&p| object.polygons[p].corners.iter().map(|c| c.normal)).collect();
        touched.sort_unstable();
        touched.dedup();
        touched.iter().for_each(|&normal| object.compute_vertex_normal(normal));
        outcome
    }

    /// Numbers of vertices, polygons, surfaces and vertex normals.
    #[must_use]
    pub fn counts(&self) -> [usize; 4] {
        self.objects.iter().fold([0; 4], |[v, p, s, n], o| {
            [v + o.vertices.len(), p + o.polygons.len(), s + o.surfaces.len(), n + o.normals.len()]
        })
    }
}

impl Object {
    fn compute_polygon_normal(&mut self, polygon: usize) -> Result<(), ReadError> {
        let record = &self.polygons[polygon];
        let places = record.corners.iter().map(|c| self.vertices[c.vertex].world.as_vec3());
        let Some(normal) = polygon_normal_1991(places) else {
            let at = Location::text(&self.placement.file, record.line, 1);
            let message =
                format!("polygon {polygon} has no normal: no three consecutive corners span a plane");
            return Err(ReadError::malformed(at, message));
        };
        self.polygons[polygon].normal = normal.as_dvec3();
        Ok(())
    }

    /// The mean of the unit normals of the surface's polygons around the vertex.
    fn compute_vertex_normal(&mut self, normal: usize) {
        let sum: DVec3 = self.normals[normal].polygons.iter().map(|&p| self.polygons[p].normal).sum();
        self.normals[normal].normal = sum.normalize_or_zero();
    }
}

/// What an object file holds.
fn read_records(
    name: &str,
    bytes: &[u8],
    files: &dyn Files,
) -> Result<(ObjectRecords, Vec<Warning>), ReadError> {
    let Scene { geometries, warnings, .. } = senca_io::classic::read_object(name, bytes, files)?;
    let records = geometries.first().and_then(|geometry| match &geometry.shape {
        Shape::Mesh(mesh) => Some(ObjectRecords::from_mesh(mesh, &polygon_lines(bytes, mesh.points.len()))),
        _ => None,
    });
    Ok((records.unwrap_or_default(), warnings))
}

/// Lines on which the polygons stand: behind the header and the vertices, blank lines passed over.
fn polygon_lines(bytes: &[u8], vertices: usize) -> Vec<u32> {
    let text = String::from_utf8_lossy(bytes);
    let full = text.lines().zip(1u32..).filter(|(line, _)| !line.trim().is_empty());
    full.skip(1 + vertices).map(|(_, number)| number).collect()
}
