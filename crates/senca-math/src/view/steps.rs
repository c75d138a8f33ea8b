//! A viewing operation as a sequence of named motions.

use glam::DMat4;

use super::ViewError;
use crate::transform::compose;

/// One partial matrix of a viewing operation, with the motion that undoes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewStep {
    /// Name in the book, such as `"T4"`.
    pub name: &'static str,
    /// What it does, in a few words.
    pub meaning: &'static str,
    /// The transform, for column vectors.
    pub forward: DMat4,
    /// The reversed motion, built from the same quantities and not by numeric inversion.
    pub inverse: DMat4,
}

/// The partial matrices of a viewing operation, in the order of application.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewSteps {
    steps: Vec<ViewStep>,
}

impl ViewSteps {
    /// Fails when the product or its inverse is not finite.
    pub(super) fn new(steps: Vec<ViewStep>) -> Result<Self, ViewError> {
        let all = Self { steps };
        let finite = all.product().is_finite() && all.inverse().is_finite();
        if finite { Ok(all) } else { Err(ViewError::OutOfRange) }
    }

    /// The partial matrices, first applied first.
    #[must_use]
    pub fn steps(&self) -> &[ViewStep] {
        &self.steps
    }

    /// The whole transform, the book's T.
    #[must_use]
    pub fn product(&self) -> DMat4 {
        compose(self.steps.iter().map(|step| step.forward))
    }

    /// The whole transform undone, by the reversed motions in reverse order.
    /// Source: course text, section 1.9.
    #[must_use]
    pub fn inverse(&self) -> DMat4 {
        compose(self.steps.iter().rev().map(|step| step.inverse))
    }

    /// Names and matrices of the steps, for printing.
    #[must_use]
    pub fn partial_matrices(&self) -> Vec<(String, DMat4)> {
        self.steps.iter().map(|step| (step.name.to_owned(), step.forward)).collect()
    }

    /// The product of the first `count` steps.
    pub(super) fn product_of_first(&self, count: usize) -> DMat4 {
        compose(self.steps[..count].iter().map(|step| step.forward))
    }

    /// The product of all steps but the first `count`.
    pub(super) fn product_after(&self, count: usize) -> DMat4 {
        compose(self.steps[count..].iter().map(|step| step.forward))
    }
}
