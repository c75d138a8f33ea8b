//! Bodies put together from bodies.

use senca_scene::{Csg, CsgLeaf, CsgNode, MaterialId, Shape, Transform};

use super::builder::Builder;
use super::meshes;
use super::shapes::{self, Kind, ReadShape};
use super::source::{Result, Table};
use super::transforms::{compose, read_transform};
use super::values::Value;

#[derive(Clone, Copy)]
enum Operation {
    Union,
    Intersection,
    Difference,
}

const OPERATIONS: [(&str, Operation); 3] = [
    ("union", Operation::Union),
    ("intersection", Operation::Intersection),
    ("difference", Operation::Difference),
];

/// What bodies take over from the operation that they stand in.
#[derive(Clone, Copy)]
struct Outer {
    /// Place of the operation in the frame of the whole.
    place: Transform,
    material: Option<MaterialId>,
    depth: usize,
}

impl<'a> Builder<'a> {
    /// The tree of a table with `operation` and `bodies`.
    pub(super) fn csg(&mut self, table: &mut Table<'a>) -> Result<Shape> {
        let outer = Outer { place: Transform::default(), material: None, depth: 0 };
        let mut leaves = 0;
        let csg = Csg { root: self.operation(table, outer, &mut leaves)? };
        csg.check().map_err(|error| table.error(error.to_string()))?;
        Ok(Shape::Csg(csg))
    }

    fn operation(&mut self, table: &mut Table<'a>, outer: Outer, leaves: &mut usize) -> Result<CsgNode> {
        if outer.depth == Csg::MAX_DEPTH {
            let message = format!("bodies nest deeper than {}", Csg::MAX_DEPTH);
            return Err(table.error(message));
        }
        let operation = table.require("operation")?.choice(&OPERATIONS)?;
        let bodies = table.require("bodies")?;
        let wanted = "a list of bodies such as { shape = \"sphere\" }";
        let inner = Outer { depth: outer.depth + 1, ..outer };
        let nodes = bodies.list(wanted, |body| self.body(body.table("the body")?, inner, leaves))?;
        if nodes.len() < 2 {
            return Err(bodies.refuse(format_args!("needs two bodies or more, but has {}", nodes.len())));
        }
        Ok(match operation {
            Operation::Union => CsgNode::Union(nodes),
            Operation::Intersection => CsgNode::Intersection(nodes),
            Operation::Difference => CsgNode::Difference(nodes),
        })
    }

    /// A closed shape with its place and material, or an operation of its own.
    fn body(&mut self, mut table: Table<'a>, outer: Outer, leaves: &mut usize) -> Result<CsgNode> {
        let name = table.read_or("name", "", Value::string)?.to_owned();
        let material = table.read("material", |value| self.material(value))?.or(outer.material);
        let place = compose(outer.place, read_transform(&mut table)?.unwrap_or_default());
        let shape = match table.get("shape") {
            None => None,
            Some(value) => match shapes::kind(value)? {
                Kind::Csg => None,
                kind => Some(kind),
            },
        };
        let node = match shape {
            None => self.operation(&mut table, Outer { place, material, ..outer }, leaves)?,
            Some(kind) => CsgNode::Leaf(self.leaf(&mut table, kind, name, place, material, leaves)?),
        };
        table.finish()?;
        Ok(node)
    }

    fn leaf(
        &mut self,
        table: &mut Table<'a>,
        kind: Kind,
        name: String,
        place: Transform,
        material: Option<MaterialId>,
        leaves: &mut usize,
    ) -> Result<CsgLeaf> {
        let read: ReadShape = match kind {
            Kind::Mesh => meshes::read(table, &mut |value| self.material(value))?.into(),
            other => shapes::read(table, other)?,
        };
        *leaves += 1;
        if *leaves > Csg::MAX_LEAVES {
            return Err(table.error(format!("there are more than {} bodies in one object", Csg::MAX_LEAVES)));
        }
        let transform = compose(place, read.place);
        let leaf = CsgLeaf { name, shape: Box::new(read.shape), transform, material };
        leaf.shape.check_closed().map_err(|reason| {
            let which = if leaf.name.is_empty() { String::new() } else { format!(" \"{}\"", leaf.name) };
            table.error(format!("the {}{which} cannot be a body: {reason}", leaf.shape.kind()))
        })?;
        Ok(leaf)
    }
}
