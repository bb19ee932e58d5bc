//! Triangles sorted by tile, in chunks.

use super::setup::{LargeTriangle, SmallTriangle};
use crate::kernel::prefetch;

/// Width and height of a tile in pixels: its depths, 16 KiB, stay in the first cache.
pub(crate) const TILE_SIZE: usize = 64;

/// How many triangles ahead of the one that is drawn memory is asked for: their drawing takes about as long as the answer.
const AHEAD: usize = 8;

/// The bit of an entry's index that says that it counts the large triangles.
const LARGE: u32 = 1 << 31;

/// The set-up triangles of one chunk, and for each tile which of them may touch it, in order.
#[derive(Debug, Default)]
pub(crate) struct Bins {
    pub(crate) is_masked: bool,
    tiles_wide: usize,
    small: Vec<SmallTriangle>,
    large: Vec<LargeTriangle>,
    /// (tile, index) in the order in which the triangles were added.
    entries: Vec<(u32, u32)>,
    /// Where each tile's entries end in `sorted`.
    ends: Vec<u32>,
    sorted: Vec<u32>,
}

/// A triangle in a bin.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Binned<'a> {
    Small(&'a SmallTriangle),
    Large(&'a LargeTriangle),
}

impl Bins {
    /// Empties the bins for a new chunk; their memory stays.
    pub(crate) fn begin(&mut self, tiles_wide: usize, tiles_high: usize, is_masked: bool) {
        self.is_masked = is_masked;
        self.tiles_wide = tiles_wide;
        self.small.clear();
        self.large.clear();
        self.entries.clear();
        self.ends.clear();
        self.ends.resize(tiles_wide * tiles_high + 1, 0);
    }

    /// Adds a small triangle to the tiles, at most four, that its box touches.
    #[inline(always)]
    pub(crate) fn push_small(&mut self, triangle: SmallTriangle) {
        let index = self.small.len() as u32;
        let (x0, y0) = (usize::from(triangle.min_x), usize::from(triangle.min_y));
        let (x1, y1) = (x0 + usize::from(triangle.more_x), y0 + usize::from(triangle.more_y));
        let (x0, x1, y0, y1) = (x0 / TILE_SIZE, x1 / TILE_SIZE, y0 / TILE_SIZE, y1 / TILE_SIZE);
        self.small.push(triangle);
        let first = (y0 * self.tiles_wide + x0) as u32;
        self.entries.push((first, index));
        if x0 == x1 && y0 == y1 {
            return;
        }
        if x0 != x1 {
            self.entries.push((first + 1, index));
        }
        if y0 != y1 {
            let below = first + self.tiles_wide as u32;
            self.entries.push((below, index));
            if x0 != x1 {
                self.entries.push((below + 1, index));
            }
        }
    }

    /// Adds a triangle of any size to the tiles that it may touch.
    #[inline(always)]
    pub(crate) fn push_large(&mut self, triangle: LargeTriangle) {
        let index = self.large.len() as u32 | LARGE;
        let (x0, x1) = (usize::from(triangle.min_x) / TILE_SIZE, usize::from(triangle.max_x) / TILE_SIZE);
        let (y0, y1) = (usize::from(triangle.min_y) / TILE_SIZE, usize::from(triangle.max_y) / TILE_SIZE);
        self.large.push(triangle);
        for y in y0..=y1 {
            for x in x0..=x1 {
                if touches_tile(&triangle, x, y) {
                    self.entries.push(((y * self.tiles_wide + x) as u32, index));
                }
            }
        }
    }

    /// Sorts what was added by tile; within a tile the order stays.
    pub(crate) fn finish(&mut self) {
        // Counts go one slot up, so that after the sums each slot holds its tile's start; filling in moves it to the tile's end.
        for &(tile, _) in &self.entries {
            self.ends[tile as usize + 1] += 1;
        }
        let mut sum = 0;
        for end in &mut self.ends {
            sum += *end;
            *end = sum;
        }
        self.sorted.clear();
        self.sorted.resize(self.entries.len(), 0);
        for &(tile, index) in &self.entries {
            let slot = &mut self.ends[tile as usize];
            self.sorted[*slot as usize] = index;
            *slot += 1;
        }
    }

    /// The triangles that may touch a tile, in the order in which they were added.
    #[inline(always)]
    pub(crate) fn of_tile(&self, tile: usize) -> impl Iterator<Item = Binned<'_>> {
        let start = if tile == 0 { 0 } else { self.ends[tile - 1] };
        let indices = &self.sorted[start as usize..self.ends[tile] as usize];
        indices.iter().enumerate().map(|(i, &index)| {
            if let Some(&ahead) = indices.get(i + AHEAD)
                && let Some(triangle) = self.small.get(ahead as usize)
            {
                prefetch(triangle);
            }
            if index & LARGE == 0 {
                Binned::Small(&self.small[index as usize])
            } else {
                Binned::Large(&self.large[(index & !LARGE) as usize])
            }
        })
    }
}

/// Whether any sample of a tile lies inside all three edges, each taken for itself.
#[inline(always)]
fn touches_tile(triangle: &LargeTriangle, tile_x: usize, tile_y: usize) -> bool {
    let (left, top) = ((tile_x * TILE_SIZE) as i64, (tile_y * TILE_SIZE) as i64);
    let (right, bottom) = (left + TILE_SIZE as i64 - 1, top + TILE_SIZE as i64 - 1);
    (0..3).all(|edge| {
        let (a, b) = (i64::from(triangle.a[edge]), i64::from(triangle.b[edge]));
        // The corner of the tile that lies farthest inside the edge.
        let x = if a > 0 { left } else { right };
        let y = if b > 0 { bottom } else { top };
        triangle.c[edge] - a * x + b * y >= 0
    })
}
