//! Names of objects: numbers that stand for textures, renderbuffers and framebuffers.

use std::collections::BTreeMap;

/// Objects by name. Name 0 is never among them.
///
/// A name can be in use before it has an object: `Gen*` marks it, the first bind makes the object.
#[derive(Clone, Debug)]
pub(crate) struct Names<T> {
    objects: BTreeMap<u32, Option<T>>,
    /// Where the search for a free name begins.
    next: u32,
}

impl<T> Default for Names<T> {
    fn default() -> Self {
        Self { objects: BTreeMap::new(), next: 1 }
    }
}

impl<T: Clone> Names<T> {
    /// Marks `count` unused names as used.
    pub(crate) fn generate(&mut self, count: usize) -> Vec<u32> {
        (0..count).map_while(|_| self.reserve()).collect()
    }

    /// Marks one unused name as used. `None` if there is none, which takes four billion objects.
    fn reserve(&mut self) -> Option<u32> {
        let first = self.next;
        loop {
            let name = self.next;
            self.next = self.next.wrapping_add(1).max(1);
            if let std::collections::btree_map::Entry::Vacant(vacant) = self.objects.entry(name) {
                vacant.insert(None);
                return Some(name);
            }
            if self.next == first {
                return None;
            }
        }
    }

    /// Whether the name is in use, with or without an object.
    pub(crate) fn is_used(&self, name: u32) -> bool {
        self.objects.contains_key(&name)
    }

    /// Object of a name.
    pub(crate) fn get(&self, name: u32) -> Option<T> {
        self.objects.get(&name)?.clone()
    }

    /// Object of a name, by reference.
    pub(crate) fn get_ref(&self, name: u32) -> Option<&T> {
        self.objects.get(&name)?.as_ref()
    }

    /// Object of a name, to be changed.
    pub(crate) fn get_mut(&mut self, name: u32) -> Option<&mut T> {
        self.objects.get_mut(&name)?.as_mut()
    }

    /// Object of a name, made by `make` if it has none yet. Any name but 0 may be used.
    pub(crate) fn get_or_insert(&mut self, name: u32, make: impl FnOnce() -> T) -> &mut T {
        self.objects.entry(name).or_default().get_or_insert_with(make)
    }

    /// Frees a name; its object, if it had one.
    pub(crate) fn remove(&mut self, name: u32) -> Option<T> {
        self.objects.remove(&name).flatten()
    }
}
