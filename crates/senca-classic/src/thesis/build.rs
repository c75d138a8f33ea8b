//! The two ways to build an object's records from its file (1991 thesis, sections 9.1 and 9.2).
//!
//! The text makes a normal for every vertex of an object when a surface begins, and frees those that
//! no polygon has used when it ends. Here a normal is made when it is first used, which leaves the
//! same ones and does not grow with vertices times surfaces.

use senca_io::classic::ClassicObject;
use senca_math::glam::DVec3;
use senca_scene::Mesh;

use super::database::{Corner, Object, Polygon, Surface, Vertex, VertexNormal};

/// How the records are linked. Both make the same links; the numbering of normals differs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BuildAlgorithm {
    /// All vertices and polygons first, in tables; then surface by surface the normals (section 9.1).
    Tables,
    /// Polygon by polygon, each linked as it is read (section 9.2); the one the program uses.
    #[default]
    AsRead,
}

/// What stands in an object file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObjectRecords {
    /// Places of the vertices.
    pub points: Vec<DVec3>,
    /// The polygons, grouped by surface.
    pub polygons: Vec<PolygonRecord>,
}

/// A polygon as it stands in the file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PolygonRecord {
    /// Number of its surface: that of the polygon before, or the next; the first is 0.
    pub surface: usize,
    /// Its vertices.
    pub vertices: Vec<usize>,
    /// Line of the file.
    pub line: u32,
}

impl ObjectRecords {
    /// The records of a mesh that was read from an object file, with the lines of its polygons.
    #[must_use]
    pub fn from_mesh(mesh: &Mesh, lines: &[u32]) -> Self {
        let point = |&vertex: &u32| mesh.vertices.point[vertex as usize] as usize;
        let record = |(face, corners): (usize, &[u32])| PolygonRecord {
            surface: mesh.faces.surface_of(face) as usize,
            vertices: corners.iter().map(point).collect(),
            line: lines.get(face).copied().unwrap_or(0),
        };
        Self {
            points: mesh.points.iter().map(|p| p.as_dvec3()).collect(),
            polygons: mesh.faces.iter().enumerate().map(record).collect(),
        }
    }
}

impl Object {
    /// Builds the records of an object.
    #[must_use]
    pub fn build(placement: ClassicObject, records: &ObjectRecords, algorithm: BuildAlgorithm) -> Self {
        let vertices = records.points.iter().map(|&local| Vertex { local, ..Vertex::default() });
        let mut object = Self {
            world_from_object: placement.world_from_object(),
            placement,
            vertices: vertices.collect(),
            normals: Vec::new(),
            polygons: Vec::with_capacity(records.polygons.len()),
            surfaces: Vec::new(),
        };
        match algorithm {
            BuildAlgorithm::Tables => object.link_by_tables(records),
            BuildAlgorithm::AsRead => object.link_as_read(records),
        }
        object
    }

    /// Section 9.1: polygons with their vertices; then for each surface its normals, in the order of
    /// the vertices, and the polygons' links to them.
    fn link_by_tables(&mut self, records: &ObjectRecords) {
        for record in &records.polygons {
            let corners = record.vertices.iter().map(|&vertex| Corner { vertex, normal: usize::MAX });
            let (surface, line) = (record.surface, record.line);
            self.polygons.push(Polygon { surface, corners: corners.collect(), line, ..Polygon::default() });
            self.enter_in_surface(self.polygons.len() - 1);
        }
        for surface in 0..self.surfaces.len() {
            let polygons = self.surfaces[surface].polygons.clone();
            let corners = polygons.iter().flat_map(|&polygon| &self.polygons[polygon].corners);
            let mut used: Vec<usize> = corners.map(|corner| corner.vertex).collect();
            used.sort_unstable();
            used.dedup();
            used.iter().for_each(|&vertex| _ = self.new_normal(vertex, surface));
            for polygon in polygons {
                for corner in 0..self.polygons[polygon].corners.len() {
                    self.link_corner(polygon, corner);
                }
            }
        }
    }

    /// Section 9.2: each polygon is linked at once; a vertex's last normal is the current surface's,
    /// if it has one yet.
    fn link_as_read(&mut self, records: &ObjectRecords) {
        for record in &records.polygons {
            let (surface, line) = (record.surface, record.line);
            self.polygons.push(Polygon { surface, line, ..Polygon::default() });
            let polygon = self.polygons.len() - 1;
            self.enter_in_surface(polygon);
            for &vertex in &record.vertices {
                if self.last_normal(vertex, surface).is_none() {
                    self.new_normal(vertex, surface);
                }
                self.polygons[polygon].corners.push(Corner { vertex, normal: usize::MAX });
                self.link_corner(polygon, self.polygons[polygon].corners.len() - 1);
            }
        }
    }

    fn enter_in_surface(&mut self, polygon: usize) {
        let surface = self.polygons[polygon].surface;
        if self.surfaces.len() <= surface {
            self.surfaces.push(Surface::default());
        }
        let last = self.surfaces.len() - 1;
        self.surfaces[surface.min(last)].polygons.push(polygon);
    }

    fn last_normal(&self, vertex: usize, surface: usize) -> Option<usize> {
        let last = self.vertices[vertex].normals.last().copied();
        last.filter(|&normal| self.normals[normal].surface == surface)
    }

    fn new_normal(&mut self, vertex: usize, surface: usize) -> usize {
        self.normals.push(VertexNormal { vertex, surface, ..VertexNormal::default() });
        self.vertices[vertex].normals.push(self.normals.len() - 1);
        self.normals.len() - 1
    }

    /// Links a corner to its vertex' newest normal, and that to the polygon. A polygon that names a
    /// vertex twice is entered once.
    fn link_corner(&mut self, polygon: usize, corner: usize) {
        let vertex = self.polygons[polygon].corners[corner].vertex;
        let Some(&normal) = self.vertices[vertex].normals.last() else { return };
        self.polygons[polygon].corners[corner].normal = normal;
        if self.normals[normal].polygons.last() != Some(&polygon) {
            self.normals[normal].polygons.push(polygon);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_support::{load, sample};
    use super::*;

    /// Each corner as vertex, surface of its normal, polygons of its normal.
    fn links(object: &Object) -> Vec<(usize, usize, Vec<usize>)> {
        let corners = object.polygons.iter().flat_map(|polygon| &polygon.corners);
        corners
            .map(|corner| {
                let normal = &object.normals[corner.normal];
                assert_eq!(normal.vertex, corner.vertex);
                (corner.vertex, normal.surface, normal.polygons.clone())
            })
            .collect()
    }

    #[test]
    fn both_algorithms_make_the_same_links() {
        for file in ["house.dat", "cylinder.dat", "patch.dat", "teapot.dat"] {
            let [tables, as_read] = [BuildAlgorithm::Tables, BuildAlgorithm::AsRead]
                .map(|a| load(&sample(file), a).objects.remove(0));
            assert_eq!(links(&tables), links(&as_read));
            assert_eq!(tables.surfaces, as_read.surfaces);
            let per_vertex = |o: &Object| o.vertices.iter().map(|v| v.normals.len()).collect::<Vec<_>>();
            assert_eq!(per_vertex(&tables), per_vertex(&as_read));
        }
    }

    #[test]
    fn links_lead_both_ways() {
        let database = load(&sample("teapot.dat"), BuildAlgorithm::AsRead);
        let object = &database.objects[0];
        for (p, polygon) in object.polygons.iter().enumerate() {
            assert!(object.surfaces[polygon.surface].polygons.contains(&p));
            for corner in &polygon.corners {
                assert!(object.normals[corner.normal].polygons.contains(&p));
                assert!(object.vertices[corner.vertex].normals.contains(&corner.normal));
                assert_eq!(object.normals[corner.normal].surface, polygon.surface);
            }
        }
        assert!(object.normals.iter().all(|normal| !normal.polygons.is_empty()));
    }

    #[test]
    fn a_vertex_has_a_normal_for_each_of_its_surfaces() {
        let house = load(&sample("house.dat"), BuildAlgorithm::AsRead).objects.remove(0);
        let normals: Vec<usize> = house.vertices.iter().map(|v| v.normals.len()).collect();
        assert_eq!(normals[0], 6);
        assert_eq!(normals[5..10], [3; 5]);
        let cylinder = load(&sample("cylinder.dat"), BuildAlgorithm::AsRead);
        assert_eq!(cylinder.counts(), [16, 10, 3, 32]);
        assert!(cylinder.objects[0].vertices.iter().all(|v| v.normals.len() == 2));
    }
}
