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

/// Children that wait, each with the distance at which the ray enters it.
pub(crate) struct Stack<'a, const N: usize> {
    places: &'a mut Places<N>,
    /// All places below have been written.
    top: usize,
}

impl<'a, const N: usize> Stack<'a, N> {
    #[inline(always)]
    pub(crate) fn new(places: &'a mut Places<N>) -> Self {
        Self { places, top: 0 }
    }

    /// Puts the first `count` of eight on the stack. There must be room for eight.
    #[inline(always)]
    pub(crate) fn push(&mut self, entries: [f32; WIDTH], children: [u32; WIDTH], count: usize) {
        let top = self.top;
        assert!(top <= N - WIDTH && count <= WIDTH);
        if let Some(places) = self.places.entries[top..].first_chunk_mut::<WIDTH>() {
            *places = entries.map(MaybeUninit::new);
        }
        if let Some(places) = self.places.children[top..].first_chunk_mut::<WIDTH>() {
            *places = children.map(MaybeUninit::new);
        }
        self.top = top + count;
    }

    /// Takes the last child that the ray enters no later than at `t_max`.
    #[inline(always)]
    pub(crate) fn pop(&mut self, t_max: f32) -> Option<u32> {
        while self.top > 0 {
            self.top -= 1;
            // SAFETY: `push` is all that raises `top`, never beyond places it has written in both arrays.
            let (entry, child) = unsafe {
                (
                    self.places.entries.get_unchecked(self.top).assume_init(),
                    self.places.children.get_unchecked(self.top).assume_init(),
                )
            };
            if entry <= t_max {
                return Some(child);
            }
        }
        None
    }
}
