//! What a caller chooses of the method of the book.

use senca_scene::Scene;

use crate::system::StopRule;
use crate::{DirectSettings, MeshSettings, RadiosityError};

/// Patches along the diagonal of the scene, where no size is given.
const PATCHES_ALONG: f64 = 12.0;

/// How form factors are computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FactorMethod {
    /// The closed form, times the share of lines of sight that are open.
    RayCast {
        /// Lines of sight for a pair, 1 to 4096; the first quarter decides where it agrees.
        rays: u32,
    },
    /// Half cubes on the parts of a patch or element.
    Hemicube {
        /// Cells along an edge, an even number from 2 to 4096.
        resolution: u32,
        /// Parts each way of what looks, 1 to 64.
        parts: u32,
    },
}

impl FactorMethod {
    /// The method of the book's section 4.2: half cubes of 50 cells, on 2 x 2 parts.
    pub const HEMICUBE: Self = Self::Hemicube { resolution: 50, parts: 2 };
}

impl Default for FactorMethod {
    fn default() -> Self {
        Self::RayCast { rays: 32 }
    }
}

/// How the equations are solved.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Relaxation {
    /// All patches gather in turn, from factors that are all computed before.
    #[default]
    GaussSeidel,
    /// The patch with most unsent light sends it to all others, again and again (progressive refinement).
    Shooting(ShootingRule),
}

/// When shooting ends, and what it shows by then.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShootingRule {
    /// Unsent power that is left, as a share of all, in (0, 1). Default 1e-4.
    pub unsent: f64,
    /// Steps at most; then elements are not divided. Default `u32::MAX`.
    pub max_steps: u32,
    /// Whether light on its way is shown as if it were everywhere alike. Default true.
    pub ambient: bool,
}

impl Default for ShootingRule {
    fn default() -> Self {
        Self { unsent: 1e-4, max_steps: u32::MAX, ambient: true }
    }
}

/// How light is computed by the method of the book.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BookSettings {
    /// The patches to begin with. Default: edges of a twelfth of the scene's diagonal.
    pub mesh: MeshSettings,
    /// How elements look at lamps.
    pub direct: DirectSettings,
    /// How form factors are computed.
    pub factors: FactorMethod,
    /// A patch is divided where the factor to it from any other exceeds this; in (0, 1]. Default 0.5.
    pub largest_factor: f64,
    /// Largest difference in shown light between neighbours, as a share of its mean; > 0. Default 0.1.
    pub largest_step: f64,
    /// Rounds of dividing elements. Default 2.
    pub rounds: u32,
    /// Divisions of a patch at most. Default 3.
    pub depth: u8,
    /// Elements with no longer edge than this are not divided, in world units, >= 0. Default 0.
    pub smallest: f64,
    /// Reflectances are held to this, in (0, 1). Default 0.99: no paint returns more.
    pub largest_reflectance: f32,
    /// How the equations are solved.
    pub relaxation: Relaxation,
    /// When [`Relaxation::GaussSeidel`] stops.
    pub stop: StopRule,
    /// Form factors from elements at most; each takes 8 bytes. Default 2^27.
    pub max_factors: u64,
}

impl Default for BookSettings {
    fn default() -> Self {
        Self {
            mesh: MeshSettings::default(),
            direct: DirectSettings::default(),
            factors: FactorMethod::default(),
            largest_factor: 0.5,
            largest_step: 0.1,
            rounds: 2,
            depth: 3,
            smallest: 0.0,
            largest_reflectance: 0.99,
            relaxation: Relaxation::default(),
            stop: StopRule::default(),
            max_factors: 1 << 27,
        }
    }
}

impl BookSettings {
    /// `Ok` when every number is in its range.
    ///
    /// # Errors
    /// [`RadiosityError::Setting`].
    pub fn check(&self) -> Result<(), RadiosityError> {
        self.direct.check()?;
        let (name, value, fits, expected) = match self.factors {
            FactorMethod::RayCast { rays } => {
                ("rays of a form factor", rays, (1..=4096).contains(&rays), "from 1 to 4096")
            }
            FactorMethod::Hemicube { parts, .. } => {
                ("parts of what looks", parts, (1..=64).contains(&parts), "from 1 to 64")
            }
        };
        if !fits {
            return Err(RadiosityError::Setting { name, value: value.into(), expected });
        }
        let unsent = match self.relaxation {
            Relaxation::Shooting(rule) => rule.unsent,
            Relaxation::GaussSeidel => ShootingRule::default().unsent,
        };
        let reflectance = f64::from(self.largest_reflectance);
        let above_0 = |value: f64| value > 0.0 && value.is_finite();
        for (name, value, fits, expected) in [
            (
                "largest factor",
                self.largest_factor,
                self.largest_factor > 0.0 && self.largest_factor <= 1.0,
                "above 0 and at most 1",
            ),
            ("largest step", self.largest_step, above_0(self.largest_step), "above 0 and finite"),
            ("smallest element", self.smallest, self.smallest >= 0.0, "0 or more"),
            (
                "largest reflectance",
                reflectance,
                reflectance > 0.0 && reflectance < 1.0,
                "above 0 and below 1",
            ),
            ("unsent power", unsent, unsent > 0.0 && unsent < 1.0, "above 0 and below 1"),
            ("tolerance", self.stop.tolerance, above_0(self.stop.tolerance), "above 0 and finite"),
        ] {
            if !fits {
                return Err(RadiosityError::Setting { name, value, expected });
            }
        }
        Ok(())
    }
}

/// Edge of the patches of a scene that nothing was said about, in world units.
pub(super) fn default_patch_size(scene: &Scene) -> f64 {
    let size = scene.bounds().diagonal() / PATCHES_ALONG;
    if size > 0.0 && size.is_finite() { size } else { 1.0 }
}
