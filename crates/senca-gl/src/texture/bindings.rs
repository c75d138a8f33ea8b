//! Texture names, and what is bound to the units.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::{Names, TexParams, Texture, View};
use crate::arrays::MAX_NAMES;
use crate::state::{TEXTURE_UNITS, TexTarget};
use crate::{Context, Enum, Error, gl};

/// A texture object, shared by all that bind it, attach it or know its name.
#[derive(Clone, Debug)]
pub(crate) struct TextureRef(Arc<Mutex<Texture>>);

impl TextureRef {
    fn new(name: u32, target: TexTarget) -> Self {
        Self(Arc::new(Mutex::new(Texture::new(name, target))))
    }

    pub(crate) fn lock(&self) -> MutexGuard<'_, Texture> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether both are the same object.
    pub(crate) fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// All texture objects with names.
pub(crate) type Textures = Names<TextureRef>;

/// What is bound to each unit.
#[derive(Debug)]
pub(crate) struct Bindings {
    /// The textures of name 0, by target.
    defaults: [TextureRef; 4],
    /// By unit and target.
    units: [[TextureRef; 4]; TEXTURE_UNITS],
    /// Images that proxies would have, by target and level.
    pub(super) proxies: [Vec<Option<super::upload::Proxy>>; 4],
}

impl Default for Bindings {
    fn default() -> Self {
        let defaults = TexTarget::ALL.map(|target| TextureRef::new(0, target));
        let units = std::array::from_fn(|_| defaults.clone());
        Self { defaults, units, proxies: Default::default() }
    }
}

/// What `push_attrib(TEXTURE_BIT)` saves of bindings and of the parameters of bound textures.
#[derive(Debug)]
pub(crate) struct SavedBindings {
    units: [[(TextureRef, TexParams); 4]; TEXTURE_UNITS],
}

impl Bindings {
    /// The texture bound to a unit.
    pub(crate) fn get(&self, unit: usize, target: TexTarget) -> &TextureRef {
        &self.units[unit][target as usize]
    }
}

impl Context {
    /// The texture bound to the active unit.
    pub(crate) fn bound_texture(&self, target: TexTarget) -> TextureRef {
        self.bindings.get(self.state.texturing.active, target).clone()
    }

    /// The texture that a unit draws with: of the most dimensions that is on and complete.
    pub(crate) fn texture_view(&self, unit: usize) -> Option<(TexTarget, View)> {
        let enabled = self.state.texturing.units[unit].enabled;
        let target = TexTarget::ALL.into_iter().rev().find(|target| enabled[*target as usize])?;
        Some((target, self.bindings.get(unit, target).lock().view()?))
    }

    pub(crate) fn save_bindings(&self) -> SavedBindings {
        let with_params = |texture: &TextureRef| (texture.clone(), texture.lock().params);
        SavedBindings { units: self.bindings.units.each_ref().map(|unit| unit.each_ref().map(with_params)) }
    }

    pub(crate) fn restore_bindings(&mut self, saved: SavedBindings) {
        for (unit, saved) in self.bindings.units.iter_mut().zip(saved.units) {
            for ((bound, default), (texture, params)) in
                unit.iter_mut().zip(&self.bindings.defaults).zip(saved)
            {
                let name = texture.lock().name;
                let alive = name == 0 || {
                    let shared = self.shared.lock().unwrap_or_else(PoisonError::into_inner);
                    shared.textures.get_ref(name).is_some_and(|found| found.is(&texture))
                };
                *bound = if alive { texture } else { default.clone() };
                if alive {
                    bound.lock().set_params(params);
                }
            }
        }
        self.touch_raster();
    }

    /// Draws what waits and lets go of the textures it was drawn with, so that they can be changed in place.
    pub(crate) fn release_textures(&mut self) {
        self.flush_batch();
        self.batch.state.units.clear();
        self.touch_raster();
    }

    /// `glGenTextures`: unused names.
    pub fn gen_textures(&mut self, n: i32) -> Vec<u32> {
        self.ask(|c| {
            if !(0..=MAX_NAMES).contains(&n) {
                c.error(gl::INVALID_VALUE);
                return Vec::new();
            }
            c.shared().textures.generate(n as usize)
        })
    }

    /// `glDeleteTextures`. Units that have them bound go back to the default texture; framebuffers bound now lose
    /// them.
    pub fn delete_textures(&mut self, names: &[u32]) {
        self.outside(|c| {
            c.release_textures();
            for &name in names {
                let Some(texture) = c.shared().textures.remove(name) else { continue };
                for unit in &mut c.bindings.units {
                    for (bound, default) in unit.iter_mut().zip(&c.bindings.defaults) {
                        if bound.is(&texture) {
                            *bound = default.clone();
                        }
                    }
                }
                c.framebuffers.detach_texture(&texture);
            }
        });
    }

    /// `glIsTexture`: whether the name has been bound.
    pub fn is_texture(&mut self, name: u32) -> bool {
        self.ask(|c| c.shared().textures.get_ref(name).is_some())
    }

    /// `glBindTexture`.
    pub fn bind_texture(&mut self, target: Enum, name: u32) {
        self.submit(move |c| {
            let result = c.set_binding(target, name);
            c.check(result);
        });
    }

    fn set_binding(&mut self, target: Enum, name: u32) -> Result<(), Error> {
        let target = TexTarget::of(target).ok_or(Error::InvalidEnum)?;
        let texture = if name == 0 {
            self.bindings.defaults[target as usize].clone()
        } else {
            let make = || TextureRef::new(name, target);
            let texture = self.shared().textures.get_or_insert(name, make).clone();
            if texture.lock().target != target {
                return Err(Error::InvalidOperation);
            }
            texture
        };
        self.bindings.units[self.state.texturing.active][target as usize] = texture;
        self.touch_raster();
        Ok(())
    }

    /// `glPrioritizeTextures`: pairs of names and priorities; names without a texture are left out.
    pub fn prioritize_textures(&mut self, priorities: &[(u32, f32)]) {
        let priorities: Vec<(u32, f32)> = priorities.to_vec();
        self.submit(move |c| {
            for &(name, priority) in &priorities {
                if let Some(texture) = c.shared().textures.get(name) {
                    texture.lock().params.priority = priority.clamp(0.0, 1.0);
                }
            }
        });
    }

    /// `glAreTexturesResident`: all are. `INVALID_VALUE` and false if a name has no texture.
    pub fn are_textures_resident(&mut self, names: &[u32]) -> bool {
        self.ask(|c| {
            let all = names.iter().all(|&name| c.shared().textures.get_ref(name).is_some());
            if !all {
                c.error(gl::INVALID_VALUE);
            }
            all
        })
    }

    /// `glTexParameter`: one value, or four of `TEXTURE_BORDER_COLOR` as colours.
    pub fn tex_parameter(&mut self, target: Enum, name: Enum, values: &[f64]) {
        let mut kept = [0.0; 4];
        let n = values.len().min(4);
        kept[..n].copy_from_slice(&values[..n]);
        self.submit(move |c| {
            let result = TexTarget::of(target)
                .ok_or(Error::InvalidEnum)
                .and_then(|target| c.bound_texture(target).lock().set_parameter(name, &kept[..n]));
            c.check(result);
            c.touch_raster();
        });
    }
}
