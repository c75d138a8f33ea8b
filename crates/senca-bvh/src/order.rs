//! From near to far without comparing distances.
//!
//! The build puts a node's children into slots by the corner of the node they are nearest to, as in Henri
//! Ylitie, Tero Karras, Samuli Laine: Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide
//! BVHs, 2017. Bit by bit a slot says on which side of the middle its child is; a ray meets slots in the
//! order of `slot ^ octant`. So the order of those it meets is in a table.

use fearless_simd::{Simd, f32x8, prelude::*};

use crate::node::WIDTH;
use crate::prepared::PreparedRay;

/// A bit per axis along which the ray goes towards smaller coordinates.
#[inline(always)]
pub(crate) fn octant(ray: &PreparedRay) -> usize {
    usize::from(ray.downward[0]) | usize::from(ray.downward[1]) << 1 | usize::from(ray.downward[2]) << 2
}

/// Slots from far to near, a byte each from the lowest; the nearest again in the highest four bits.
#[derive(Clone, Copy)]
pub(crate) struct Order(u64);

/// By octant and the mask of slots that are met.
pub(crate) static ORDERS: [[Order; 256]; 8] = {
    let mut orders = [[Order(0); 256]; 8];
    let mut octant = 0;
    while octant < 8 {
        let mut mask = 0;
        while mask < 256 {
            orders[octant][mask] = Order::of(octant, mask);
            mask += 1;
        }
        octant += 1;
    }
    orders
};

impl Order {
    const fn of(octant: usize, mask: usize) -> Self {
        let (mut bytes, mut count, mut nearest, mut place) = (0u64, 0, 0, 8);
        while place > 0 {
            place -= 1;
            let slot = place ^ octant;
            if mask >> slot & 1 == 1 {
                bytes |= (slot as u64) << (8 * count);
                count += 1;
                nearest = slot as u64;
            }
        }
        Self(bytes | nearest << 60)
    }

    #[inline(always)]
    pub(crate) fn nearest(self) -> usize {
        (self.0 >> 60) as usize % WIDTH
    }

    /// Both in this order; places after those that are met hold anything.
    #[inline(always)]
    pub(crate) fn arrange<S: Simd>(
        self,
        simd: S,
        enter: f32x8<S>,
        children: &[u32; WIDTH],
    ) -> ([f32; WIDTH], [u32; WIDTH]) {
        #[cfg(target_arch = "x86_64")]
        if let Some(avx512) = simd.level().as_avx512() {
            return x86::arrange_avx512(avx512, self.0, enter.to_array(), *children);
        } else if let Some(avx2) = simd.level().as_avx2() {
            return x86::arrange_avx2(avx2, self.0, enter.to_array(), *children);
        }
        let slots = self.0.to_le_bytes().map(|slot| slot as usize % WIDTH);
        (slots.map(|slot| enter[slot]), slots.map(|slot| children[slot]))
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::WIDTH;
    use fearless_simd::{f32x8, kernel, prelude::*, u32x8};
    use std::arch::x86_64::{
        _mm_cvtsi64_si128, _mm256_cvtepu8_epi32, _mm256_permutevar8x32_epi32, _mm256_permutevar8x32_ps,
    };

    macro_rules! arrange {
        ($name:ident, $level:ident) => {
            kernel!(
                #[inline(always)]
                pub(super) fn $name(
                    token: $level,
                    order: u64,
                    enter: [f32; WIDTH],
                    children: [u32; WIDTH],
                ) -> ([f32; WIDTH], [u32; WIDTH]) {
                    let slots = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(order as i64));
                    let enter = f32x8::load_array(token, enter);
                    let children = u32x8::load_array(token, children);
                    let enter: f32x8<_> = _mm256_permutevar8x32_ps(enter.into(), slots).simd_into(token);
                    let children: u32x8<_> =
                        _mm256_permutevar8x32_epi32(children.into(), slots).simd_into(token);
                    (enter.to_array(), children.to_array())
                }
            );
        };
    }

    arrange!(arrange_avx512, Avx512);
    arrange!(arrange_avx2, Avx2);
}
