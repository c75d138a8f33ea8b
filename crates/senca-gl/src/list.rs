//! Display lists (OpenGL 1.5, section 5.4).
//!
//! A list is a row of steps. Vertices between `begin` and `end` are kept as steps of their own while the
//! list is compiled and gathered into blocks when it is ended, so that calling it does not go through
//! them one by one.

use crate::component::Component;
use crate::immediate::VertexBlock;
use crate::{Context, Enum, gl};
use std::collections::HashMap;
use std::sync::Arc;

/// How deep lists may call lists; what is deeper is left out.
pub(crate) const MAX_LIST_NESTING: usize = 64;

type Call = Box<dyn Fn(&mut Context) + Send + Sync>;

/// What a list does.
pub(crate) enum Step {
    Call(Call),
    Begin(Enum),
    End,
    Attribute(Attribute),
    Vertices(Arc<VertexBlock>),
}

impl std::fmt::Debug for Step {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Call(_) => f.write_str("Call"),
            Self::Begin(mode) => write!(f, "Begin({mode})"),
            Self::End => f.write_str("End"),
            Self::Attribute(a) => write!(f, "{a:?}"),
            Self::Vertices(block) => write!(f, "Vertices({})", block.len()),
        }
    }
}

/// What is said about a vertex; [`Attribute::Vertex`] ends it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Attribute {
    Vertex([f32; 4]),
    Color([f32; 4]),
    Secondary([f32; 3]),
    Normal([f32; 3]),
    TexCoord(u8, [f32; 4]),
    FogCoord(f32),
    EdgeFlag(bool),
    Index(f32),
}

/// A finished list.
#[derive(Debug, Default)]
pub(crate) struct List {
    steps: Vec<Step>,
}

/// All lists.
#[derive(Debug, Default)]
pub(crate) struct Lists {
    lists: HashMap<u32, Arc<List>>,
    /// No list has a greater number.
    last: u32,
}

impl Lists {
    fn get(&self, name: u32) -> Option<Arc<List>> {
        self.lists.get(&name).cloned()
    }

    fn insert(&mut self, name: u32, list: List) {
        self.lists.insert(name, Arc::new(list));
        self.last = self.last.max(name);
    }

    /// The first of `range` numbers in a row that no list has.
    fn free_range(&self, range: u32) -> Option<u32> {
        if let Some(first) = self.last.checked_add(1)
            && first.checked_add(range - 1).is_some()
        {
            return Some(first);
        }
        let mut names: Vec<u32> = self.lists.keys().copied().collect();
        names.sort_unstable();
        let mut first = 1u32;
        for name in names {
            if name - first >= range {
                return Some(first);
            }
            first = name.checked_add(1)?;
        }
        first.checked_add(range - 1).map(|_| first)
    }
}

/// The list being made.
#[derive(Debug)]
pub(crate) struct Compiling {
    name: u32,
    execute: bool,
    steps: Vec<Step>,
}

impl Compiling {
    /// Whether commands are also done at once.
    pub(crate) fn executes(&self) -> bool {
        self.execute
    }

    pub(crate) fn push_call(&mut self, call: impl Fn(&mut Context) + Send + Sync + 'static) {
        self.steps.push(Step::Call(Box::new(call)));
    }

    pub(crate) fn push(&mut self, step: Step) {
        self.steps.push(step);
    }

    /// Name and mode, for `LIST_INDEX` and `LIST_MODE`.
    pub(crate) fn query(&self) -> (u32, Enum) {
        (self.name, if self.execute { gl::COMPILE_AND_EXECUTE } else { gl::COMPILE })
    }
}

/// Puts runs of `begin`, attributes, `end` into blocks.
fn gathered(steps: Vec<Step>) -> Vec<Step> {
    let mut out = Vec::with_capacity(steps.len().min(64));
    let mut run: Option<(Enum, Vec<Attribute>)> = None;
    let give_up = |out: &mut Vec<Step>, run: Option<(Enum, Vec<Attribute>)>| {
        if let Some((mode, attributes)) = run {
            out.push(Step::Begin(mode));
            out.extend(attributes.into_iter().map(Step::Attribute));
        }
    };
    for step in steps {
        match (step, &mut run) {
            (Step::Begin(mode), _) => {
                give_up(&mut out, run.take());
                run = Some((mode, Vec::new()));
            }
            (Step::Attribute(a), Some((_, attributes))) => attributes.push(a),
            (Step::End, Some(_)) => {
                let Some((mode, attributes)) = run.take() else { continue };
                match VertexBlock::new(mode, &attributes) {
                    Some(block) => out.push(Step::Vertices(Arc::new(block))),
                    None => {
                        give_up(&mut out, Some((mode, attributes)));
                        out.push(Step::End);
                    }
                }
            }
            (step, _) => {
                give_up(&mut out, run.take());
                out.push(step);
            }
        }
    }
    give_up(&mut out, run);
    out.shrink_to_fit();
    out
}

impl Context {
    /// `glNewList`: begins list `list`, which is not 0; `mode` is `COMPILE` or `COMPILE_AND_EXECUTE`.
    pub fn new_list(&mut self, list: u32, mode: Enum) {
        self.outside(|c| {
            if list == 0 {
                return c.error(gl::INVALID_VALUE);
            }
            if mode != gl::COMPILE && mode != gl::COMPILE_AND_EXECUTE {
                return c.error(gl::INVALID_ENUM);
            }
            if c.compiling.is_some() {
                return c.error(gl::INVALID_OPERATION);
            }
            let execute = mode == gl::COMPILE_AND_EXECUTE;
            c.compiling = Some(Compiling { name: list, execute, steps: Vec::new() });
        });
    }

    /// `glEndList`: ends the list, which replaces one of the same name.
    pub fn end_list(&mut self) {
        self.outside(|c| match c.compiling.take() {
            Some(done) => c.shared().lists.insert(done.name, List { steps: gathered(done.steps) }),
            None => c.error(gl::INVALID_OPERATION),
        });
    }

    /// `glCallList`: does what the list `list` says; nothing when there is none.
    pub fn call_list(&mut self, list: u32) {
        self.submit_anywhere(move |c| c.run_list(list));
    }

    /// `glCallLists` with names already read: each plus the list base.
    pub fn call_lists(&mut self, names: &[u32]) {
        let names: Arc<[u32]> = names.into();
        self.submit_anywhere(move |c| {
            let base = c.state.list_base;
            names.iter().for_each(|n| c.run_list(base.wrapping_add(*n)));
        });
    }

    /// `glCallLists`: the `n` names at the beginning of `bytes`, of type `kind` (`BYTE` to `FLOAT`, `2_BYTES` to
    /// `4_BYTES`), in the machine's byte order.
    pub fn call_lists_of(&mut self, n: i32, kind: Enum, bytes: &[u8]) {
        let Ok(n) = usize::try_from(n) else {
            return self.submit_anywhere(|c| c.error(gl::INVALID_VALUE));
        };
        match names_of(n, kind, bytes) {
            Some(names) => self.call_lists(&names),
            None => self.submit_anywhere(|c| c.error(gl::INVALID_ENUM)),
        }
    }

    /// `glListBase`: what [`Context::call_lists`] adds to each name.
    pub fn list_base(&mut self, base: u32) {
        self.submit(move |c| c.state.list_base = base);
    }

    /// `glGenLists`: the first of `range` unused names in a row, which now are empty lists; 0 when there are none.
    pub fn gen_lists(&mut self, range: i32) -> u32 {
        self.ask(|c| {
            let Ok(range) = u32::try_from(range) else {
                c.error(gl::INVALID_VALUE);
                return 0;
            };
            if range == 0 {
                return 0;
            }
            let mut shared = c.shared();
            let Some(first) = shared.lists.free_range(range) else { return 0 };
            // Reserving a name costs memory, so the number of lists is bounded.
            if range as usize + shared.lists.lists.len() > MAX_LISTS {
                drop(shared);
                c.error(gl::OUT_OF_MEMORY);
                return 0;
            }
            let empty = Arc::new(List::default());
            for name in first..=first + (range - 1) {
                shared.lists.lists.insert(name, Arc::clone(&empty));
            }
            shared.lists.last = shared.lists.last.max(first + (range - 1));
            first
        })
    }

    /// `glDeleteLists`: forgets `range` lists from `list` on.
    pub fn delete_lists(&mut self, list: u32, range: i32) {
        self.outside(|c| {
            let Ok(range) = u32::try_from(range) else { return c.error(gl::INVALID_VALUE) };
            let mut shared = c.shared();
            let end = list.saturating_add(range);
            if (range as usize) < shared.lists.lists.len() {
                (list..end).for_each(|name| drop(shared.lists.lists.remove(&name)));
            } else {
                shared.lists.lists.retain(|name, _| !(list..end).contains(name));
            }
        });
    }

    /// `glIsList`: whether there is a list of that name.
    pub fn is_list(&mut self, list: u32) -> bool {
        self.ask(|c| c.shared().lists.lists.contains_key(&list))
    }

    fn run_list(&mut self, name: u32) {
        if self.list_depth >= MAX_LIST_NESTING {
            return;
        }
        let Some(list) = self.shared().lists.get(name) else { return };
        // What a list does is not recorded again in one being made: that has the call.
        let compiling = self.compiling.take();
        self.list_depth += 1;
        list.steps.iter().for_each(|step| self.run_step(step));
        self.list_depth -= 1;
        self.compiling = compiling;
    }

    fn run_step(&mut self, step: &Step) {
        match step {
            Step::Call(call) => call(self),
            Step::Begin(mode) => self.do_begin(*mode),
            Step::End => self.do_end(),
            Step::Attribute(a) => self.do_attribute(*a),
            Step::Vertices(block) => self.do_block(block),
        }
    }
}

/// Most lists there may be.
const MAX_LISTS: usize = 1 << 24;

/// List names of any type; `None` for an unknown one. Names beyond the end of `bytes` are left out.
fn names_of(n: usize, kind: Enum, bytes: &[u8]) -> Option<Vec<u32>> {
    fn each<const N: usize>(n: usize, bytes: &[u8], name: impl Fn([u8; N]) -> u32) -> Vec<u32> {
        bytes.as_chunks::<N>().0.iter().take(n).map(|b| name(*b)).collect()
    }
    // Floating point is rounded towards minus infinity; negative names wrap, as they are offsets.
    let floor = |v: f32| v.value().floor() as i64 as u32;
    Some(match kind {
        gl::BYTE => each(n, bytes, |b: [u8; 1]| i32::from(b[0] as i8) as u32),
        gl::UNSIGNED_BYTE => each(n, bytes, |b: [u8; 1]| u32::from(b[0])),
        gl::SHORT => each(n, bytes, |b| i32::from(i16::from_ne_bytes(b)) as u32),
        gl::UNSIGNED_SHORT => each(n, bytes, |b| u32::from(u16::from_ne_bytes(b))),
        gl::INT | gl::UNSIGNED_INT => each(n, bytes, u32::from_ne_bytes),
        gl::FLOAT => each(n, bytes, |b| floor(f32::from_ne_bytes(b))),
        gl::_2_BYTES => each(n, bytes, |b| u32::from(u16::from_be_bytes(b))),
        gl::_3_BYTES => each(n, bytes, |[a, b, c]: [u8; 3]| u32::from_be_bytes([0, a, b, c])),
        gl::_4_BYTES => each(n, bytes, u32::from_be_bytes),
        _ => return None,
    })
}

/// Bytes of a name of type `kind`; `None` for an unknown one.
#[must_use]
pub fn list_name_bytes(kind: Enum) -> Option<usize> {
    match kind {
        gl::BYTE | gl::UNSIGNED_BYTE => Some(1),
        gl::SHORT | gl::UNSIGNED_SHORT | gl::_2_BYTES => Some(2),
        gl::_3_BYTES => Some(3),
        gl::INT | gl::UNSIGNED_INT | gl::FLOAT | gl::_4_BYTES => Some(4),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Config;

    #[test]
    fn names_of_all_ten_types() {
        let is = |kind, bytes: &[u8], expected: &[u32]| {
            assert_eq!(names_of(expected.len(), kind, bytes).unwrap(), expected, "{kind:#x}");
        };
        is(gl::BYTE, &[1, 255], &[1, u32::MAX]);
        is(gl::UNSIGNED_BYTE, &[1, 255], &[1, 255]);
        is(gl::SHORT, &[(-2i16).to_ne_bytes(), 7i16.to_ne_bytes()].concat(), &[u32::MAX - 1, 7]);
        is(gl::UNSIGNED_SHORT, &65535u16.to_ne_bytes(), &[65535]);
        is(gl::INT, &(-1i32).to_ne_bytes(), &[u32::MAX]);
        is(gl::UNSIGNED_INT, &9u32.to_ne_bytes(), &[9]);
        is(gl::FLOAT, &3.9f32.to_ne_bytes(), &[3]);
        is(gl::_2_BYTES, &[1, 2], &[258]);
        is(gl::_3_BYTES, &[1, 2, 3], &[66051]);
        is(gl::_4_BYTES, &[1, 2, 3, 4], &[16_909_060]);
        assert_eq!(names_of(1, gl::DOUBLE, &[0; 8]), None);
    }

    #[test]
    fn names_are_reserved_in_rows_and_forgotten() {
        let mut c = Context::new(Config::default());
        let first = c.gen_lists(3);
        assert!((0..3).all(|k| c.is_list(first + k)));
        c.delete_lists(first + 1, 1);
        assert!(c.is_list(first) && !c.is_list(first + 1) && c.is_list(first + 2));
        assert_eq!(c.gen_lists(-1), 0);
        assert_eq!(c.get_error(), gl::INVALID_VALUE);
        c.new_list(u32::MAX, gl::COMPILE);
        c.end_list();
        let again = c.gen_lists(2);
        assert!(again != 0 && c.is_list(again + 1));
    }

    #[test]
    fn a_list_that_calls_itself_ends() {
        let mut c = Context::new(Config::default());
        c.new_list(1, gl::COMPILE);
        c.translate([1.0, 0.0, 0.0]);
        c.call_list(1);
        c.end_list();
        c.call_list(1);
        assert_eq!(c.modelview.top().w_axis.x, MAX_LIST_NESTING as f32);
    }

    #[test]
    fn compile_and_execute_does_both() {
        let mut c = Context::new(Config::default());
        c.new_list(5, gl::COMPILE_AND_EXECUTE);
        c.translate([0.0, 2.0, 0.0]);
        c.end_list();
        assert_eq!(c.modelview.top().w_axis.y, 2.0);
        c.call_list(5);
        assert_eq!(c.modelview.top().w_axis.y, 4.0);
    }
}
