//! One tile's memory: eight samples at a time, and how far the farthest of each block lies.

use shadow_scene::NO_TRIANGLE;

use super::bins::TILE_SIZE;
use crate::kernel::{
    LANES,
    lanes::{Floats, Ints, Lanes},
};

/// From a pixel of a tile to the one below it. A vector may begin at any pixel of a row; what it has beyond the row's end falls into the padding.
pub(crate) const STRIDE: usize = TILE_SIZE + LANES;
/// Rows are drawn in steps of so many; those beyond the last row fall into the padding.
pub(crate) const ROW_STEP: usize = 4;
/// Pixels of a tile with its padding.
pub(crate) const PIXELS: usize = STRIDE * (TILE_SIZE + ROW_STEP);
/// Blocks of a vector's width and as many rows in a row of a tile, and in a column of it.
pub(crate) const ROW_BLOCKS: usize = TILE_SIZE / LANES;

/// The depth of a shadow map where nothing was drawn.
pub(crate) const FAR_DEPTH: f32 = 1.0;

/// A tile of a depth map: the smallest depth wins, and of reversed depths the largest.
#[derive(Clone)]
pub(crate) struct DepthTile<const REVERSED: bool> {
    pub(crate) depth: [f32; PIXELS],
    farthest: [[f32; ROW_BLOCKS]; ROW_BLOCKS],
}

/// A tile of a visibility buffer with reversed depth: the largest depth wins, and of equals the first.
#[derive(Clone)]
pub(crate) struct VisibilityTile {
    pub(crate) depth: [f32; PIXELS],
    /// The bits of the triangles' indices.
    pub(crate) triangle: [i32; PIXELS],
    farthest: [[f32; ROW_BLOCKS]; ROW_BLOCKS],
}

/// What samples are written into. A tile keeps a bound on the farthest depth in each of its blocks; it may lie behind the truth, never before it.
pub(crate) trait Tile {
    /// Whether a smaller depth is nearer.
    const SMALLER_IS_NEARER: bool;

    fn clear(&mut self);

    /// Offers eight samples side by side; lanes that are negative in `outside` are left alone. Gives the depths that stand after it.
    fn write<L: Lanes>(&mut self, offset: usize, outside: L::I, z: L::F, id: u32) -> L::F;

    /// Whether one sample would be seen.
    fn accepts(&self, offset: usize, z: f32) -> bool;

    /// Writes one sample that was accepted.
    fn write_one(&mut self, offset: usize, z: f32, id: u32);

    /// The bounds of a row of blocks.
    fn farthest(&mut self, block_row: usize) -> &mut [f32; ROW_BLOCKS];

    /// All bits set where `near` lies before `far`.
    #[inline(always)]
    fn before<L: Lanes>(near: L::F, far: L::F) -> L::I {
        if Self::SMALLER_IS_NEARER { near.less(far) } else { far.less(near) }
    }

    /// The farther of each pair.
    #[inline(always)]
    fn farther<L: Lanes>(a: L::F, b: L::F) -> L::F {
        if Self::SMALLER_IS_NEARER { a.max(b) } else { a.min(b) }
    }
}

/// The vector of pixels that begins at `offset`.
///
/// # Panics
///
/// If it does not lie within the tile.
#[inline(always)]
fn lanes_at<T>(pixels: &mut [T; PIXELS], offset: usize) -> &mut [T; LANES] {
    let lanes = &mut pixels[offset..offset + LANES];
    lanes.first_chunk_mut().expect("the slice is as long as a vector")
}

impl<const REVERSED: bool> DepthTile<REVERSED> {
    const FAR: f32 = if REVERSED { 0.0 } else { FAR_DEPTH };
}

impl<const REVERSED: bool> Tile for DepthTile<REVERSED> {
    const SMALLER_IS_NEARER: bool = !REVERSED;

    #[inline(always)]
    fn clear(&mut self) {
        self.depth = [Self::FAR; PIXELS];
        self.farthest = [[Self::FAR; ROW_BLOCKS]; ROW_BLOCKS];
    }

    #[inline(always)]
    fn write<L: Lanes>(&mut self, offset: usize, outside: L::I, z: L::F, _id: u32) -> L::F {
        let depth = lanes_at(&mut self.depth, offset);
        let offered = outside.select_negative(L::F::splat(Self::FAR), z);
        let stood = L::F::load(depth);
        let stands = if REVERSED { offered.max(stood) } else { offered.min(stood) };
        stands.store(depth);
        stands
    }

    #[inline(always)]
    fn accepts(&self, offset: usize, z: f32) -> bool {
        if REVERSED { z > self.depth[offset] } else { z < self.depth[offset] }
    }

    #[inline(always)]
    fn write_one(&mut self, offset: usize, z: f32, _id: u32) {
        self.depth[offset] = z;
    }

    #[inline(always)]
    fn farthest(&mut self, block_row: usize) -> &mut [f32; ROW_BLOCKS] {
        &mut self.farthest[block_row]
    }
}

impl Tile for VisibilityTile {
    const SMALLER_IS_NEARER: bool = false;

    #[inline(always)]
    fn clear(&mut self) {
        self.depth = [0.0; PIXELS];
        self.triangle = [NO_TRIANGLE as i32; PIXELS];
        self.farthest = [[0.0; ROW_BLOCKS]; ROW_BLOCKS];
    }

    #[inline(always)]
    fn write<L: Lanes>(&mut self, offset: usize, outside: L::I, z: L::F, id: u32) -> L::F {
        let (depth, triangle) = (lanes_at(&mut self.depth, offset), lanes_at(&mut self.triangle, offset));
        // Nothing is farther than 0, so that a lane that is outside never wins.
        let offered = outside.select_negative(L::F::splat(0.0), z);
        let stood = L::F::load(depth);
        let wins = stood.less(offered);
        let stands = offered.max(stood);
        stands.store(depth);
        // Arithmetic in place of a choice: the compiler makes a masked store of a choice whose one side was there, and that takes a Zen
        // some twenty cycles.
        let stood = L::I::load(triangle);
        (stood + ((L::I::splat(id as i32) - stood) & wins)).store(triangle);
        stands
    }

    #[inline(always)]
    fn accepts(&self, offset: usize, z: f32) -> bool {
        z > self.depth[offset]
    }

    #[inline(always)]
    fn write_one(&mut self, offset: usize, z: f32, id: u32) {
        self.depth[offset] = z;
        self.triangle[offset] = id as i32;
    }

    #[inline(always)]
    fn farthest(&mut self, block_row: usize) -> &mut [f32; ROW_BLOCKS] {
        &mut self.farthest[block_row]
    }
}

impl<const REVERSED: bool> Default for DepthTile<REVERSED> {
    fn default() -> Self {
        Self { depth: [Self::FAR; PIXELS], farthest: [[Self::FAR; ROW_BLOCKS]; ROW_BLOCKS] }
    }
}

impl Default for VisibilityTile {
    fn default() -> Self {
        Self { depth: [0.0; PIXELS], triangle: [NO_TRIANGLE as i32; PIXELS], farthest: [[0.0; ROW_BLOCKS]; ROW_BLOCKS] }
    }
}
