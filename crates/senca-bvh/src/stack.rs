//! The stack of a walk, which costs nothing to make.
#![expect(unsafe_code, reason = "places of the stack are not cleared for each ray")]

use std::mem::MaybeUninit;

use crate::node::WIDTH;

/// Room for a stack.
pub(crate) struct Places<const N: usize> {
    entries: [MaybeUninit<f32>; N],
    children: [MaybeUninit<u32>; N],
}

impl<const N: usize> Places<N> {
    #[inline(always)]
    pub(crate) fn new() -> Self {
        Self { entries: [const { MaybeUninit::uninit() }; N], children: [const { MaybeUninit::uninit() }; N] }
    }
}

/// Children that wait. With DISTANCES, each with that at which the ray enters it.
pub(crate) struct Stack<'a, const N: usize, const DISTANCES: bool> {
    places: &'a mut Places<N>,
    /// All places below have been written.
    top: usize,
}

impl<'a, const N: usize, const DISTANCES: bool> Stack<'a, N, DISTANCES> {
    #[inline(always)]
    pub(crate) fn new(places: &'a mut Places<N>) -> Self {
        Self { places, top: 0 }
    }

    /// Puts the first `count` of eight on the stack. There must be room for eight.
    #[inline(always)]
    pub(crate) fn push(&mut self, entries: [f32; WIDTH], children: [u32; WIDTH], count: usize) {
        let top = self.top;
        assert!(top <= N - WIDTH && count <= WIDTH);
        if DISTANCES && let Some(places) = self.places.entries[top..].first_chunk_mut::<WIDTH>() {
            *places = entries.map(MaybeUninit::new);
        }
        if let Some(places) = self.places.children[top..].first_chunk_mut::<WIDTH>() {
            *places = children.map(MaybeUninit::new);
        }
        self.top = top + count;
    }

    /// Takes the last child. With distances, the last that the ray enters no later than at `t_max`.
    #[inline(always)]
    pub(crate) fn pop(&mut self, t_max: f32) -> Option<u32> {
        while self.top > 0 {
            self.top -= 1;
            if !DISTANCES || self.entry() <= t_max {
                return Some(self.child());
            }
        }
        None
    }

    /// The distance that was last.
    #[inline(always)]
    fn entry(&self) -> f32 {
        // SAFETY: `push` is all that raises `top`. With DISTANCES, which `pop` has seen to, it does so by no
        // more than the places of `entries` it has written, and checks that they are there.
        unsafe { self.places.entries.get_unchecked(self.top).assume_init() }
    }

    /// The child that was last.
    #[inline(always)]
    fn child(&self) -> u32 {
        // SAFETY: `push` is all that raises `top`, by no more than the places of `children` it has written,
        // and checks that they are there.
        unsafe { self.places.children.get_unchecked(self.top).assume_init() }
    }
}
