//! What a caller chooses of radiosity.

use senca_radiosity::book::FactorMethod;
use senca_radiosity::{DirectSettings, HierarchySettings, MeshSettings};

/// How light is computed and shown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RadiositySettings {
    /// By which method light is computed.
    pub solver: Solver,
    /// The mesh of patches. Where no size of patches is given, the solver chooses: see [`Solver`].
    pub mesh: MeshSettings,
    /// How exact a solution by [`Solver::Hierarchical`] is.
    pub hierarchy: HierarchySettings,
    /// How [`Solver::GaussSeidel`] and [`Solver::Shooting`] find form factors.
    pub factors: FactorMethod,
    /// Steps of [`Solver::Shooting`] at most; what is on its way then is estimated. Default: as many as it
    /// takes.
    pub max_steps: Option<u32>,
    /// How elements look at lamps and the sky.
    pub direct: DirectSettings,
    /// How light gets from the elements to the picture.
    pub display: Display,
    /// What of it is shown.
    pub show: Show,
    /// Factor on all light when it is shown; 0, the default, stands for 1.
    pub exposure: f32,
}

impl RadiositySettings {
    /// Factor on all light when it is shown.
    #[must_use]
    pub fn exposure_factor(&self) -> f32 {
        if self.exposure > 0.0 { self.exposure } else { 1.0 }
    }
}

/// The methods to compute light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Solver {
    /// Links between elements and clusters of any size; elements are divided where light asks for it.
    #[default]
    Hierarchical,
    /// The method of the book: form factors between all patches, and relaxation.
    GaussSeidel,
    /// The same patches, of which the one with most light not sent yet sends it to all others: a picture
    /// after the first step (progressive refinement).
    Shooting,
}

/// The ways from elements to a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Display {
    /// One colour an element, by the standard pipeline.
    Flat,
    /// Colours of nodes, interpolated in the picture by the standard pipeline (course text, section 4.1).
    Gouraud,
    /// Light of nodes, interpolated in the scene, by a ray for each sample (course text, task 4.3).
    #[default]
    Bilinear,
    /// By the recursive tracer, with the computed light in place of the ambient light (course text, task
    /// 4.9): lamps give sharp shadows and highlights, mirrors and glass show what they should.
    Trace,
    /// What arrives is gathered once more at every place that is seen (final gathering), so that shadows
    /// are as sharp as they are, whatever the mesh. Slow.
    Gather,
}

/// What is shown of light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Show {
    /// The scene in its light.
    #[default]
    Light,
    /// The scene in its light, with the edges of elements.
    Mesh,
    /// Illuminance by a scale of colours.
    FalseColors {
        /// Value at the upper end of the scale, in lux. Default: the brightest element but for the
        /// brightest hundredth of the area, rounded up.
        most: Option<f64>,
        /// Luminance in cd/m² that a shown 1 stands for.
        luminance_of_one: f64,
        /// Whether the scale is logarithmic.
        logarithmic: bool,
        /// Whether the edges of elements are shown, too.
        mesh: bool,
    },
}
