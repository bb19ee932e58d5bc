//! Maps that hold something else than the depth that is drawn.

use rayon::prelude::*;
use shadow_math::{
    caster::{CASTER_PLAIN, caster_offset, pushed_depth},
    depth::{DEPTH_Z_OVER_W, depth_of_two, encoded_depth},
    plan::ViewPlan,
};

use super::{
    RasterRules,
    bins::TILE_SIZE,
    pass::{AlphaTest, Run, Scratch, Target, check_target, draw_tile},
    tile::{DepthTile, FAR_DEPTH, PIXELS, ROW_BLOCKS, STRIDE, Tile},
    transform::Positions,
};
use crate::kernel::{
    LANES,
    lanes::{Floats, Ints, Lanes},
};

/// What is drawn into a map.
#[derive(Clone, Copy, Debug)]
pub struct Drawing<'a> {
    /// The vertices.
    pub positions: &'a Positions,
    /// The triangles' corners.
    pub triangles: &'a [[u32; 3]],
    /// Which of them are drawn, and how.
    pub runs: &'a [Run],
    /// From where, and how large.
    pub target: &'a Target,
    /// What is left to drivers.
    pub rules: &'a RasterRules,
}

/// Renders what a view's map holds, as [`ViewPlan`] says: reversed, linear or rounded depth, and casters that are drawn deeper.
///
/// Where nothing is drawn that is 0 with reversed depth and else 1.
///
/// # Panics
///
/// As [`rasterize_depth`](super::rasterize_depth).
pub fn rasterize_stored(
    scratch: &mut Scratch,
    drawing: Drawing<'_>,
    alpha_test: &impl AlphaTest,
    view: &ViewPlan,
    depth: &mut [f32],
) {
    let encode = |drawn: f32| encoded_depth(view, drawn);
    match (view.depth_kind == DEPTH_Z_OVER_W, view.caster_kind == CASTER_PLAIN) {
        (true, true) => draw(scratch, drawing, alpha_test, DepthTile::<false>::default, encode, depth),
        (false, true) => draw(scratch, drawing, alpha_test, DepthTile::<true>::default, encode, depth),
        (true, false) => draw(scratch, drawing, alpha_test, || PushedTile::<false>::new(drawing, view), encode, depth),
        (false, false) => draw(scratch, drawing, alpha_test, || PushedTile::<true>::new(drawing, view), encode, depth),
    }
}

/// Renders what is made of the two nearest surfaces of every sample; 1 where there is no second one. `first` has the depths of the first.
///
/// # Panics
///
/// As [`rasterize_depth`](super::rasterize_depth), also if `first` does not have a value for every sample.
pub fn rasterize_second(
    scratch: &mut Scratch,
    drawing: Drawing<'_>,
    alpha_test: &impl AlphaTest,
    view: &ViewPlan,
    first: &[f32],
    depth: &mut [f32],
) {
    let Drawing { positions, triangles, runs, target, rules } = drawing;
    check_target(target, depth.len());
    check_target(target, first.len());
    let chunks = scratch.bin(positions, triangles, runs, target, rules);
    let width = target.width as usize;
    let bands = depth.par_chunks_mut(width * TILE_SIZE).zip(first.par_chunks(width * TILE_SIZE));
    bands.enumerate().for_each_init(SecondTile::default, |tile, (tile_y, (band, first))| {
        for tile_x in 0..target.tiles_wide() {
            let left = tile_x * TILE_SIZE;
            let columns = TILE_SIZE.min(width - left);
            for (row, stored) in first.chunks_exact(width).zip(tile.first.chunks_exact_mut(STRIDE)) {
                stored[..columns].copy_from_slice(&row[left..left + columns]);
            }
            draw_tile(tile, chunks, target, tile_x, tile_y, rules, alpha_test);
            let rows = tile.second.depth.chunks_exact(STRIDE).zip(tile.first.chunks_exact(STRIDE));
            for (pixels, (second, first)) in band.chunks_exact_mut(width).zip(rows) {
                for (pixel, (&second, &first)) in pixels[left..left + columns].iter_mut().zip(second.iter().zip(first)) {
                    *pixel = if second < FAR_DEPTH { depth_of_two(view, first, second) } else { FAR_DEPTH };
                }
            }
        }
    });
}

/// Draws into tiles of a kind and writes what becomes of their depths.
fn draw<T: DepthOf>(
    scratch: &mut Scratch,
    drawing: Drawing<'_>,
    alpha_test: &impl AlphaTest,
    tile: impl Fn() -> T + Sync + Send,
    encode: impl Fn(f32) -> f32 + Sync,
    depth: &mut [f32],
) {
    let Drawing { positions, triangles, runs, target, rules } = drawing;
    check_target(target, depth.len());
    let chunks = scratch.bin(positions, triangles, runs, target, rules);
    let width = target.width as usize;
    depth.par_chunks_mut(width * TILE_SIZE).enumerate().for_each_init(tile, |tile, (tile_y, band)| {
        for tile_x in 0..target.tiles_wide() {
            draw_tile(tile, chunks, target, tile_x, tile_y, rules, alpha_test);
            let left = tile_x * TILE_SIZE;
            let columns = TILE_SIZE.min(width - left);
            for (pixels, row) in band.chunks_exact_mut(width).zip(tile.depth().chunks_exact(STRIDE)) {
                for (pixel, &drawn) in pixels[left..left + columns].iter_mut().zip(row) {
                    *pixel = encode(drawn);
                }
            }
        }
    });
}

/// A tile that has depths.
trait DepthOf: Tile {
    fn depth(&self) -> &[f32; PIXELS];
}

impl<const REVERSED: bool> DepthOf for DepthTile<REVERSED> {
    fn depth(&self) -> &[f32; PIXELS] {
        &self.depth
    }
}

/// A tile of a depth map into which casters are drawn deeper. The bounds of its blocks are those of what was drawn: what lies behind them without being pushed also does when it is.
struct PushedTile<'a, const REVERSED: bool> {
    tile: DepthTile<REVERSED>,
    view: &'a ViewPlan,
    positions: &'a Positions,
    triangles: &'a [[u32; 3]],
    /// The triangle that was drawn last, and its offset.
    last: Option<(u32, f32)>,
}

impl<'a, const REVERSED: bool> PushedTile<'a, REVERSED> {
    fn new(drawing: Drawing<'a>, view: &'a ViewPlan) -> Self {
        Self { tile: DepthTile::default(), view, positions: drawing.positions, triangles: drawing.triangles, last: None }
    }

    #[inline(always)]
    fn offset(&mut self, id: u32) -> f32 {
        match self.last {
            Some((last, offset)) if last == id => offset,
            _ => {
                let [v0, v1, v2] = self.triangles[id as usize].map(|corner| self.positions.get(corner));
                let offset = caster_offset(self.view, v0, v1, v2);
                self.last = Some((id, offset));
                offset
            }
        }
    }
}

impl<const REVERSED: bool> DepthOf for PushedTile<'_, REVERSED> {
    fn depth(&self) -> &[f32; PIXELS] {
        &self.tile.depth
    }
}

impl<const REVERSED: bool> Tile for PushedTile<'_, REVERSED> {
    const SMALLER_IS_NEARER: bool = !REVERSED;

    #[inline(always)]
    fn clear(&mut self) {
        self.tile.clear();
    }

    #[inline(always)]
    fn write<L: Lanes>(&mut self, offset: usize, outside: L::I, z: L::F, id: u32) -> L::F {
        let push = self.offset(id);
        let mut lanes = [0.0; LANES];
        z.store(&mut lanes);
        for depth in &mut lanes {
            *depth = pushed_depth(self.view, *depth, push);
        }
        self.tile.write::<L>(offset, outside, L::F::load(&lanes), id)
    }

    #[inline(always)]
    fn accepts(&self, offset: usize, z: f32) -> bool {
        self.tile.accepts(offset, z)
    }

    #[inline(always)]
    fn write_one(&mut self, offset: usize, z: f32, id: u32) {
        let push = self.offset(id);
        let pushed = pushed_depth(self.view, z, push);
        // It was accepted for where it is, and may be pushed behind what is there.
        if self.tile.accepts(offset, pushed) {
            self.tile.write_one(offset, pushed, id);
        }
    }

    #[inline(always)]
    fn farthest(&mut self, block_row: usize) -> &mut [f32; ROW_BLOCKS] {
        self.tile.farthest(block_row)
    }
}

/// A tile of the nearest depths of those behind the first.
struct SecondTile {
    first: [f32; PIXELS],
    second: DepthTile<false>,
}

impl Default for SecondTile {
    fn default() -> Self {
        Self { first: [FAR_DEPTH; PIXELS], second: DepthTile::default() }
    }
}

impl Tile for SecondTile {
    const SMALLER_IS_NEARER: bool = true;

    #[inline(always)]
    fn clear(&mut self) {
        self.second.clear();
    }

    #[inline(always)]
    fn write<L: Lanes>(&mut self, offset: usize, outside: L::I, z: L::F, id: u32) -> L::F {
        let first = self.first[offset..].first_chunk().map_or(L::F::splat(FAR_DEPTH), L::F::load);
        // All bits set is negative: a sample that is not behind the first surface is outside.
        let is_not_behind = L::I::splat(-1) - first.less(z);
        self.second.write::<L>(offset, outside | is_not_behind, z, id)
    }

    #[inline(always)]
    fn accepts(&self, offset: usize, z: f32) -> bool {
        z > self.first[offset] && self.second.accepts(offset, z)
    }

    #[inline(always)]
    fn write_one(&mut self, offset: usize, z: f32, id: u32) {
        self.second.write_one(offset, z, id);
    }

    #[inline(always)]
    fn farthest(&mut self, block_row: usize) -> &mut [f32; ROW_BLOCKS] {
        self.second.farthest(block_row)
    }
}
