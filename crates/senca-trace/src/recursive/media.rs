//! What a ray is in: which transparent bodies it has entered and not left.
//!
//! The text does not say how a ray knows which medium it comes from. Here it carries the bodies it is
//! in, in the order of entering. The one entered last decides refraction and absorption, so a bubble
//! in glass in water needs nothing said; where bodies overlap, the common part belongs to the one
//! entered last. Leaving a body that is not the last bends nothing.

/// Bodies that a ray remembers being in; of more, the outermost are forgotten.
const DEEPEST: usize = 6;

/// A transparent body that a ray is in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Medium {
    /// Index of the object.
    pub(crate) object: u32,
    /// Index of its material where the ray came in.
    pub(crate) material: u32,
}

/// The bodies that a ray is in, in the order of entering.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Media {
    inside: [Medium; DEEPEST],
    count: u8,
}

impl Media {
    /// The body that decides; `None` outside of all.
    #[inline]
    pub(crate) fn current(&self) -> Option<Medium> {
        self.all().last().copied()
    }

    fn all(&self) -> &[Medium] {
        &self.inside[..usize::from(self.count)]
    }

    /// After entering a body.
    pub(crate) fn entered(mut self, medium: Medium) -> Self {
        if usize::from(self.count) == DEEPEST {
            self.inside.copy_within(1.., 0);
            self.count -= 1;
        }
        self.inside[usize::from(self.count)] = medium;
        self.count += 1;
        self
    }

    /// After leaving a body, once where it was entered more often. As it is when it was never entered.
    pub(crate) fn left(mut self, object: u32) -> Self {
        if let Some(i) = self.all().iter().rposition(|m| m.object == object) {
            self.inside.copy_within(i + 1.., i);
            self.count -= 1;
        }
        self
    }

    /// Whether the ray is in this body.
    pub(crate) fn holds(&self, object: u32) -> bool {
        self.all().iter().any(|m| m.object == object)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body(object: u32) -> Medium {
        Medium { object, material: 10 * object }
    }

    #[test]
    fn the_body_entered_last_counts() {
        let air = Media::default();
        assert_eq!(air.current(), None);
        let both = air.entered(body(1)).entered(body(2));
        assert_eq!(both.current(), Some(body(2)));
        assert_eq!(both.left(2).current(), Some(body(1)));
        assert_eq!(both.left(1).current(), Some(body(2)), "leaving the outer one first");
        assert_eq!(both.left(1).left(2), air.entered(body(2)).left(2));
        assert_eq!(both.left(7).current(), Some(body(2)));
    }

    #[test]
    fn more_bodies_than_it_remembers_do_no_harm() {
        let many = (0..20).fold(Media::default(), |media, i| media.entered(body(i)));
        assert_eq!(many.current(), Some(body(19)));
        assert!(many.holds(14) && !many.holds(13));
        let none = (0..20).rev().fold(many, Media::left);
        assert_eq!(none.current(), None);
    }
}
