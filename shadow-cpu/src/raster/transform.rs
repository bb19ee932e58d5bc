//! Vertices to window coordinates, each once.

use std::ops::RangeInclusive;

use glam::Vec3;
use rayon::prelude::*;

use super::{ClipRule, RasterRules, SnapRule, pass::MAX_TARGET_SIZE};
use crate::kernel::{
    Kernel, LANES, MultiplyAdd, dispatch,
    lanes::{Floats, Ints, Lanes},
};

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
    pub(crate) const ALL: u8 = RIGHT | LEFT | TOP | BOTTOM | NEAR | FAR;
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
}

impl WindowVertex {
    /// Whether the vertex lies where the edge functions have room for it, and is a number.
    ///
    /// A vertex inside the clip volume does: the guard band of the largest target ends a pixel before. One that clipping made need
    /// not, where the volume is so narrow, at the eye, or the coordinates so large that rounding leaves nothing of it.
    #[inline(always)]
    pub(crate) fn has_room(&self) -> bool {
        /// Half the largest target in pixels.
        const HALF: f32 = 0.5 * MAX_TARGET_SIZE as f32;
        const ROOM: RangeInclusive<f32> = HALF - ClipRule::GUARD_BAND * HALF - 1.0..=HALF + ClipRule::GUARD_BAND * HALF + 1.0;
        ROOM.contains(&self.x) && ROOM.contains(&self.y) && self.z.is_finite()
    }
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
    pub(crate) fn window<M: MultiplyAdd>(&self, clip: [f32; 4], grid: Grid) -> WindowVertex {
        let half_width = 0.5 * self.width as f32;
        let half_height = 0.5 * self.height as f32;
        let inverse_w = 1.0 / clip[3];
        let (ndc_x, ndc_y) = (clip[0] * inverse_w, clip[1] * inverse_w);
        let x = M::multiply_add(ndc_x, half_width, half_width);
        let y = M::multiply_add(ndc_y, -half_height, half_height);
        let Grid { scale, snap } = grid;
        let steps = match snap {
            SnapRule::FromPixels => [(x - 0.5) * scale, (y - 0.5) * scale],
            SnapRule::AtOnce => [
                M::multiply_add(ndc_x, half_width * scale, (half_width - 0.5) * scale),
                M::multiply_add(ndc_y, -half_height * scale, (half_height - 0.5) * scale),
            ],
        };
        let [grid_x, grid_y] = steps.map(|steps| steps.round_ties_even() as i32);
        WindowVertex { x, y, z: clip[2] * inverse_w, grid_x, grid_y }
    }
}

/// The sub-pixel grid, and how vertices get onto it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grid {
    /// Steps per pixel.
    scale: f32,
    snap: SnapRule,
}

impl RasterRules {
    /// The grid.
    #[inline(always)]
    pub(crate) fn grid(&self) -> Grid {
        Grid { scale: self.subpixel_scale(), snap: self.snap }
    }

    /// The sides of the clip volume, as a multiple of w.
    #[inline(always)]
    pub(crate) fn clip_side(&self) -> f32 {
        match self.clip {
            ClipRule::Viewport | ClipRule::NearFirst => 1.0,
            ClipRule::GuardBand => ClipRule::GUARD_BAND,
        }
    }

    /// Steps of the sub-pixel grid per pixel.
    #[inline(always)]
    pub(crate) fn subpixel_scale(&self) -> f32 {
        (1_u32 << self.subpixel_bits) as f32
    }
}

/// How far a grid coordinate is shifted to make room for an outcode below it. The coordinates of a vertex inside the clip volume, at most `2^23`
/// steps, stay within 32 bits.
pub(crate) const OUTCODE_BITS: u32 = 6;

/// A vertex on the sub-pixel grid in 8 bytes, all that most triangles are looked at with: `x` above the outcode in the low half, `y` in
/// the high one. Of a vertex that lies outside of some plane only the outcode is meant.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct GridVertex(pub(crate) i64);

impl GridVertex {
    #[inline(always)]
    pub(crate) fn x(self) -> i32 {
        self.0 as i32 >> OUTCODE_BITS
    }

    #[inline(always)]
    pub(crate) fn y(self) -> i32 {
        (self.0 >> 32) as i32
    }

    /// The planes that the vertex lies outside of.
    #[inline(always)]
    pub(crate) fn outcode(self) -> u32 {
        self.0 as u32 & ((1 << OUTCODE_BITS) - 1)
    }
}

/// Vertices in the window.
#[derive(Debug, Default)]
pub(crate) struct Transformed {
    grid: Vec<[GridVertex; LANES]>,
    /// x, y and z in the window; the fourth number makes one load of it.
    window: Vec<[[f32; 4]; LANES]>,
}

impl Transformed {
    /// A vertex on the grid.
    #[inline(always)]
    pub(crate) fn grid(&self, index: u32) -> GridVertex {
        self.grid.as_flattened()[index as usize]
    }

    /// A vertex that no plane cuts off, whole.
    #[inline(always)]
    pub(crate) fn vertex(&self, index: u32) -> WindowVertex {
        let grid = self.grid(index);
        let [x, y, z, _] = *self.window(index);
        WindowVertex { x, y, z, grid_x: grid.x(), grid_y: grid.y() }
    }

    /// A vertex in the window: x, y and z; the fourth number means nothing.
    #[inline(always)]
    pub(crate) fn window(&self, index: u32) -> &[f32; 4] {
        &self.window.as_flattened()[index as usize]
    }

    /// Transforms every vertex, into the memory of the last time.
    pub(crate) fn transform(&mut self, positions: &Positions, view: &Viewpoint, rules: &RasterRules) {
        self.grid.resize(positions.x.len(), [GridVertex::default(); LANES]);
        self.window.resize(positions.x.len(), [[0.0; 4]; LANES]);
        let tasks = self.grid.par_chunks_mut(VECTORS_PER_TASK).zip(self.window.par_chunks_mut(VECTORS_PER_TASK));
        tasks.enumerate().for_each(|(task, (grid, window))| {
            let first = task * VECTORS_PER_TASK;
            dispatch(rules.fused, TransformKernel { positions, view, rules, first, grid, window });
        });
    }
}

/// How many vectors one task transforms.
const VECTORS_PER_TASK: usize = 512;

struct TransformKernel<'a> {
    positions: &'a Positions,
    view: &'a Viewpoint,
    rules: &'a RasterRules,
    first: usize,
    grid: &'a mut [[GridVertex; LANES]],
    window: &'a mut [[[f32; 4]; LANES]],
}

impl Kernel for TransformKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes, M: MultiplyAdd>(self) {
        let side = self.rules.clip_side();
        let grid_of_target = self.rules.grid();
        let positions = self.positions;
        let vectors = positions.x[self.first..].iter().zip(&positions.y[self.first..]).zip(&positions.z[self.first..]);
        for ((grid, window), ((x, y), z)) in self.grid.iter_mut().zip(self.window).zip(vectors) {
            let position = [L::F::load(x), L::F::load(y), L::F::load(z)];
            let (pairs, rows) = transform_lanes::<L, M>(self.view, position, side, grid_of_target);
            for lane in 0..LANES {
                grid[lane] = GridVertex(pairs[lane]);
            }
            *window = rows;
        }
    }
}

/// Where the lanes of a point do not lie inside a plane, the plane's bit. What is not a number lies inside of nothing.
#[inline(always)]
fn bit_outside<L: Lanes>(inside: L::I, plane: u8) -> L::I {
    let bit = L::I::splat(plane.into());
    bit - (inside & bit)
}

/// The planes that clip points lie outside of. One inside whose w is subnormal, as at the eye itself, so that its inverse can be infinite, or so
/// large that its sides are, counts as outside of all: nothing takes its place in the window for one.
#[inline(always)]
fn outcodes<L: Lanes>([x, y, z, w]: [L::F; 4], side: f32) -> L::I {
    let zero = L::F::splat(0.0);
    let limit = w * L::F::splat(side);
    let planes = bit_outside::<L>(x.at_most(limit), outcode::RIGHT)
        | bit_outside::<L>((zero - limit).at_most(x), outcode::LEFT)
        | bit_outside::<L>(y.at_most(limit), outcode::TOP)
        | bit_outside::<L>((zero - limit).at_most(y), outcode::BOTTOM)
        | bit_outside::<L>(zero.at_most(z), outcode::NEAR)
        | bit_outside::<L>(z.at_most(w), outcode::FAR);
    let is_outside = planes.greater(L::I::splat(0));
    let has_place = L::F::splat(f32::MIN_POSITIVE).at_most(w) & limit.at_most(L::F::splat(f32::MAX));
    planes | bit_outside::<L>(is_outside | has_place, outcode::ALL)
}

/// Eight vertices on the grid, as [`GridVertex`], and in the window: [`Viewpoint::clip`] and [`Viewpoint::window`] in vectors.
#[inline(always)]
fn transform_lanes<L: Lanes, M: MultiplyAdd>(
    view: &Viewpoint,
    [x, y, z]: [L::F; 3],
    side: f32,
    grid: Grid,
) -> ([i64; LANES], [[f32; 4]; LANES]) {
    let mut clip = [L::F::splat(0.0); 4];
    for (clip, row) in clip.iter_mut().zip(&view.rows) {
        *clip = L::F::splat(row[0]) * x + L::F::splat(row[1]) * y + L::F::splat(row[2]) * z + L::F::splat(row[3]);
    }
    let [x, y, z, w] = clip;
    let outcode = outcodes::<L>(clip, side);

    let half_width = 0.5 * view.width as f32;
    let half_height = 0.5 * view.height as f32;
    let inverse_w = L::F::splat(1.0) / w;
    let (ndc_x, ndc_y) = (x * inverse_w, y * inverse_w);
    let place = |ndc: L::F, half: f32, middle: f32| M::multiply_add_lanes(ndc, L::F::splat(half), L::F::splat(middle));
    let x = place(ndc_x, half_width, half_width);
    let y = place(ndc_y, -half_height, half_height);
    let Grid { scale, snap } = grid;
    let steps = match snap {
        SnapRule::FromPixels => [x, y].map(|pixels| (pixels - L::F::splat(0.5)) * L::F::splat(scale)),
        SnapRule::AtOnce => [
            place(ndc_x, half_width * scale, (half_width - 0.5) * scale),
            place(ndc_y, -half_height * scale, (half_height - 0.5) * scale),
        ],
    };
    let [grid_x, grid_y] = steps.map(|steps| steps.round());
    let pairs = L::I::pairs([grid_x.shift_left(OUTCODE_BITS) | outcode, grid_y]);
    (pairs, L::F::rows([x, y, z * inverse_w, L::F::splat(0.0)]))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::kernel::{Fused, Separate, lanes::Portable};

    /// What eight vertices become in vectors, and each by itself.
    fn check<M: MultiplyAdd>(view: &Viewpoint, points: [[f32; LANES]; 3], side: f32, snap: SnapRule) {
        let grid = Grid { scale: 256.0, snap };
        let lanes = points.map(|coordinates| <Portable as Lanes>::F::load(&coordinates));
        let (pairs, rows) = transform_lanes::<Portable, M>(view, lanes, side, grid);
        for lane in 0..LANES {
            let [x, y, z] = points.map(|coordinates| coordinates[lane]);
            let vertex = view.window::<M>(view.clip(x, y, z), grid);
            let on_grid = GridVertex(pairs[lane]);
            if on_grid.outcode() == 0 {
                assert_eq!(rows[lane], [vertex.x, vertex.y, vertex.z, 0.0]);
                assert_eq!((on_grid.x(), on_grid.y()), (vertex.grid_x, vertex.grid_y));
            }
        }
    }

    proptest! {
        /// A vertex that clipping keeps has the bits that it has in its neighbours, which are not clipped: else there would be cracks.
        #[test]
        fn vectors_and_single_vertices_agree(
            rows in prop::array::uniform4(prop::array::uniform4(-2.0..2.0_f32)),
            points in prop::array::uniform3(prop::array::uniform8(-3.0..3.0_f32)),
            size in (1..4000_u32, 1..4000_u32),
            side in prop::sample::select(vec![1.0, ClipRule::GUARD_BAND]),
        ) {
            let view = Viewpoint { rows, width: size.0, height: size.1 };
            for snap in [SnapRule::FromPixels, SnapRule::AtOnce] {
                check::<Fused>(&view, points, side, snap);
                check::<Separate>(&view, points, side, snap);
            }
        }
    }
}
