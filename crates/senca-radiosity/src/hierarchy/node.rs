//! What links join.

/// A cluster, an element, or a rectangular lamp.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Node(u32);

const CLUSTER: u32 = 1 << 31;
const LAMP: u32 = 1 << 30;

/// Elements and clusters at most.
pub(super) const MAX_NODES: usize = LAMP as usize;

impl Node {
    pub(super) const fn element(number: u32) -> Self {
        Self(number)
    }

    pub(super) const fn cluster(number: u32) -> Self {
        Self(number | CLUSTER)
    }

    pub(super) const fn lamp(number: u32) -> Self {
        Self(number | LAMP)
    }

    /// Number among its kind.
    #[inline]
    pub(crate) const fn index(self) -> usize {
        (self.0 & (LAMP - 1)) as usize
    }

    #[inline]
    pub(crate) const fn as_cluster(self) -> Option<u32> {
        if self.0 & CLUSTER != 0 { Some(self.index() as u32) } else { None }
    }

    #[inline]
    pub(super) const fn as_lamp(self) -> Option<u32> {
        if self.0 & (CLUSTER | LAMP) == LAMP { Some(self.index() as u32) } else { None }
    }

    #[inline]
    pub(super) const fn as_element(self) -> Option<u32> {
        if self.0 & (CLUSTER | LAMP) == 0 { Some(self.0) } else { None }
    }

    /// A number that no other node has.
    #[inline]
    pub(super) const fn key(self) -> u32 {
        self.0
    }
}
