//! Listings of the database.

use std::fmt::Write;

use super::database::{Database, Object};

impl Database {
    /// Everything in the database as text: vertices with their places and normals, polygons with
    /// their corners, surfaces. V, N, P and S stand for vertex, normal, polygon and surface; the
    /// program printed addresses.
    #[must_use]
    pub fn dump(&self) -> String {
        let mut text = String::new();
        for (number, object) in self.objects.iter().enumerate() {
            let counts = [object.vertices.len(), object.polygons.len(), object.surfaces.len()];
            let _ = writeln!(
                text,
                "object {number} {}: {} vertices, {} polygons, {} surfaces, {} normals",
                object.placement.file,
                counts[0],
                counts[1],
                counts[2],
                object.normals.len()
            );
            dump_vertices(&mut text, object);
            dump_polygons(&mut text, object);
            for (number, surface) in object.surfaces.iter().enumerate() {
                let _ = writeln!(text, "S{number}{}", names('P', surface.polygons.iter().copied()));
            }
        }
        text
    }
}

fn dump_vertices(text: &mut String, object: &Object) {
    for (number, vertex) in object.vertices.iter().enumerate() {
        let (l, w, s) = (vertex.local, vertex.world, vertex.screen);
        let _ = writeln!(
            text,
            "V{number} local {:.3} {:.3} {:.3} world {:.3} {:.3} {:.3} screen {:.3} {:.3} {:.0} {:.3}",
            l.x, l.y, l.z, w.x, w.y, w.z, s.x, s.y, s.z, s.w
        );
        for &normal in &vertex.normals {
            let record = &object.normals[normal];
            let n = record.normal;
            let polygons = names('P', record.polygons.iter().copied());
            let _ =
                writeln!(text, "  N{normal} S{} {:.4} {:.4} {:.4}{polygons}", record.surface, n.x, n.y, n.z);
        }
    }
}

fn dump_polygons(text: &mut String, object: &Object) {
    for (number, polygon) in object.polygons.iter().enumerate() {
        let (n, corners) = (polygon.normal, &polygon.corners);
        let culled = if polygon.culled { " culled" } else { "" };
        let vertices = names('V', corners.iter().map(|corner| corner.vertex));
        let _ = writeln!(
            text,
            "P{number} S{} {} vertices{culled} normal {:.4} {:.4} {:.4}{vertices}",
            polygon.surface,
            corners.len(),
            n.x,
            n.y,
            n.z
        );
    }
}

fn names(letter: char, numbers: impl Iterator<Item = usize>) -> String {
    numbers.map(|number| format!(" {letter}{number}")).collect()
}

#[cfg(test)]
mod tests {
    use super::super::BuildAlgorithm;
    use super::super::test_support::{load, sample};

    #[test]
    fn the_listing_names_every_record() {
        let mut database = load(&sample("cylinder.dat"), BuildAlgorithm::AsRead);
        database.place();
        database.compute_normals().expect("normals");
        let text = database.dump();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "object 0 cylinder.dat: 16 vertices, 10 polygons, 3 surfaces, 32 normals");
        assert_eq!(
            lines[1],
            "V0 local 0.000 10.000 0.000 world 0.000 10.000 0.000 screen 0.000 0.000 0 0.000"
        );
        assert_eq!(lines[2], "  N0 S0 -0.9239 -0.3827 0.0000 P0 P7");
        assert!(lines[3].ends_with("S1 0.0000 0.0000 -1.0000 P8"), "{}", lines[3]);
        assert!(text.contains("P0 S0 4 vertices normal -0.7071 -0.7071 0.0000 V0 V1 V9 V8\n"));
        assert!(text.contains("\nS1 P8\n"));
        assert_eq!(lines.len(), 1 + 16 + 32 + 10 + 3);
    }
}
