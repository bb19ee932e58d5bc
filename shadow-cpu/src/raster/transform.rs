//! Vertices to window coordinates, each once.

use glam::Vec3;
use rayon::prelude::*;

use super::{ClipRule, RasterRules};
use crate::kernel::{Kernel, LANES, MultiplyAdd, dispatch};

/// Vertex positions as separate arrays, padded to whole vectors: the form that the transform reads at full width.
#[derive(Clone, Debug, Default)]
pub struct Positions {
    len: usize,
    x: Vec<[f32; LANES]>,
    y: Vec<[f32; LANES]>,
    z: Vec<[f32; LANES]>,
}

impl Positions {
    /// Takes positions apart.
    #[must_use]
    pub fn new(positions: &[Vec3]) -> Self {
        let split = |axis: usize| -> Vec<[f32; LANES]> {
            positions
                .chunks(LANES)
                .map(|chunk| {
                    // The last position fills the last vector, so that no padding can overflow where no vertex does.
                    let last = chunk[chunk.len() - 1];
                    core::array::from_fn(|lane| chunk.get(lane).copied().unwrap_or(last)[axis])
                })
                .collect()
        };
        Self { len: positions.len(), x: split(0), y: split(1), z: split(2) }
    }

    /// How many positions there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// One position.
    pub(crate) fn get(&self, index: u32) -> Vec3 {
        let (vector, lane) = (index as usize / LANES, index as usize % LANES);
        Vec3::new(self.x[vector][lane], self.y[vector][lane], self.z[vector][lane])
    }
}

/// Bits of an outcode, in the order in which the planes are clipped against.
pub(crate) mod outcode {
    pub(crate) const RIGHT: u8 = 1;
    pub(crate) const LEFT: u8 = 2;
    pub(crate) const TOP: u8 = 4;
    pub(crate) const BOTTOM: u8 = 8;
    pub(crate) const NEAR: u8 = 16;
    pub(crate) const FAR: u8 = 32;
}

/// A vertex in the window: x and y in pixels from the top left corner, z as depth; and x and y on the sub-pixel grid, counted from the
/// centre of the first pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct WindowVertex {
    pub(crate) x: f32,
    pub(crate) y: f32,
    pub(crate) z: f32,
    pub(crate) grid_x: i32,
    pub(crate) grid_y: i32,
    /// The planes that the vertex lies outside of.
    pub(crate) outcode: u32,
}

/// The rows of a matrix from world to clip space, and the size of the target.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Viewpoint {
    pub(crate) rows: [[f32; 4]; 4],
    pub(crate) width: u32,
    pub(crate) height: u32,
}

impl Viewpoint {
    /// A point in clip space: each row is summed in ascending order.
    #[inline(always)]
    pub(crate) fn clip(&self, x: f32, y: f32, z: f32) -> [f32; 4] {
        self.rows.map(|row| row[0] * x + row[1] * y + row[2] * z + row[3])
    }

    /// Clip space to the window. A vertex that the vertex shader made goes through fused multiply-adds where the rules have them; one
    /// that clipping made passes `Separate`.
    #[inline(always)]
    pub(crate) fn window<M: MultiplyAdd>(&self, clip: [f32; 4], subpixel_scale: f32) -> WindowVertex {
        let half_width = 0.5 * self.width as f32;
        let half_height = 0.5 * self.height as f32;
        let inverse_w = 1.0 / clip[3];
        let x = M::multiply_add(clip[0] * inverse_w, half_width, half_width);
        let y = M::multiply_add(clip[1] * inverse_w, -half_height, half_height);
        WindowVertex {
            x,
            y,
            z: clip[2] * inverse_w,
            grid_x: ((x - 0.5) * subpixel_scale).round_ties_even() as i32,
            grid_y: ((y - 0.5) * subpixel_scale).round_ties_even() as i32,
            outcode: 0,
        }
    }

    /// The planes that a clip point lies outside of. A point that is not a number lies outside of all.
    #[inline(always)]
    pub(crate) fn outcode(clip: [f32; 4], side: f32) -> u32 {
        let [x, y, z, w] = clip;
        let limit = w * side;
        let bit = |inside: bool, code: u8| if inside { 0 } else { u32::from(code) };
        bit(x <= limit, outcode::RIGHT)
            | bit(x >= -limit, outcode::LEFT)
            | bit(y <= limit, outcode::TOP)
            | bit(y >= -limit, outcode::BOTTOM)
            | bit(z >= 0.0, outcode::NEAR)
            | bit(z <= w, outcode::FAR)
    }
}

impl RasterRules {
    /// The sides of the clip volume, as a multiple of w.
    #[inline(always)]
    pub(crate) fn clip_side(&self) -> f32 {
        match self.clip {
            ClipRule::Viewport => 1.0,
            ClipRule::GuardBand => ClipRule::GUARD_BAND,
        }
    }

    /// Steps of the sub-pixel grid per pixel.
    #[inline(always)]
    pub(crate) fn subpixel_scale(&self) -> f32 {
        (1_u32 << self.subpixel_bits) as f32
    }
}

/// Vertices of one transformed vector.
pub(crate) type WindowVector = [WindowVertex; LANES];

/// Vertices in the window.
pub(crate) struct Transformed(Vec<WindowVector>);

impl Transformed {
    #[inline(always)]
    pub(crate) fn get(&self, index: u32) -> &WindowVertex {
        &self.0[index as usize / LANES][index as usize % LANES]
    }
}

/// How many vectors one task transforms.
const VECTORS_PER_TASK: usize = 512;

/// Transforms every vertex.
pub(crate) fn transform(positions: &Positions, view: &Viewpoint, rules: &RasterRules) -> Transformed {
    let mut out = vec![[WindowVertex::default(); LANES]; positions.x.len()];
    out.par_chunks_mut(VECTORS_PER_TASK).enumerate().for_each(|(task, out)| {
        let first = task * VECTORS_PER_TASK;
        dispatch(rules.fused, TransformKernel { positions, view, rules, first, out });
    });
    Transformed(out)
}

struct TransformKernel<'a> {
    positions: &'a Positions,
    view: &'a Viewpoint,
    rules: &'a RasterRules,
    first: usize,
    out: &'a mut [WindowVector],
}

impl Kernel for TransformKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn run<M: MultiplyAdd>(self) {
        let side = self.rules.clip_side();
        let scale = self.rules.subpixel_scale();
        let positions = self.positions;
        let vectors = positions.x[self.first..].iter().zip(&positions.y[self.first..]).zip(&positions.z[self.first..]);
        for (out, ((x, y), z)) in self.out.iter_mut().zip(vectors) {
            for lane in 0..LANES {
                let clip = self.view.clip(x[lane], y[lane], z[lane]);
                out[lane] = WindowVertex { outcode: Viewpoint::outcode(clip, side), ..self.view.window::<M>(clip, scale) };
            }
        }
    }
}
