//! Triangles sorted by tile, in chunks.

use super::setup::TriangleSetup;

/// Width and height of a tile in pixels: its depths, 16 KiB, stay in the first cache.
pub(crate) const TILE_SIZE: usize = 64;

/// The set-up triangles of one chunk, and for each tile which of them may touch it, in order.
pub(crate) struct Bins {
    triangles: Vec<TriangleSetup>,
    /// Where each tile's entries begin in `sorted`; one more than there are tiles.
    starts: Vec<u32>,
    sorted: Vec<u32>,
}

/// Collects the triangles of a chunk.
pub(crate) struct Binner {
    tiles_wide: usize,
    tile_count: usize,
    triangles: Vec<TriangleSetup>,
    entries: Vec<(u32, u32)>,
}

impl Binner {
    pub(crate) fn new(tiles_wide: usize, tiles_high: usize, capacity: usize) -> Self {
        Self {
            tiles_wide,
            tile_count: tiles_wide * tiles_high,
            triangles: Vec::with_capacity(capacity),
            entries: Vec::with_capacity(capacity),
        }
    }

    /// Adds a triangle to every tile that it may touch.
    #[inline(always)]
    pub(crate) fn push(&mut self, triangle: TriangleSetup) {
        let index = self.triangles.len() as u32;
        let (x0, x1) = (usize::from(triangle.min_x) / TILE_SIZE, usize::from(triangle.max_x) / TILE_SIZE);
        let (y0, y1) = (usize::from(triangle.min_y) / TILE_SIZE, usize::from(triangle.max_y) / TILE_SIZE);
        self.triangles.push(triangle);
        if x0 == x1 && y0 == y1 {
            self.entries.push(((y0 * self.tiles_wide + x0) as u32, index));
            return;
        }
        for y in y0..=y1 {
            for x in x0..=x1 {
                if touches_tile(&triangle, x, y) {
                    self.entries.push(((y * self.tiles_wide + x) as u32, index));
                }
            }
        }
    }

    /// Sorts what was added by tile; within a tile the order stays.
    pub(crate) fn finish(self) -> Bins {
        let mut starts = vec![0_u32; self.tile_count + 1];
        for &(tile, _) in &self.entries {
            starts[tile as usize + 1] += 1;
        }
        for tile in 0..self.tile_count {
            starts[tile + 1] += starts[tile];
        }
        let mut next = starts.clone();
        let mut sorted = vec![0; self.entries.len()];
        for (tile, index) in self.entries {
            let slot = &mut next[tile as usize];
            sorted[*slot as usize] = index;
            *slot += 1;
        }
        Bins { triangles: self.triangles, starts, sorted }
    }
}

impl Bins {
    /// The triangles that may touch a tile, in the order in which they were added.
    pub(crate) fn of_tile(&self, tile: usize) -> impl Iterator<Item = &TriangleSetup> {
        let range = self.starts[tile] as usize..self.starts[tile + 1] as usize;
        self.sorted[range].iter().map(|&index| &self.triangles[index as usize])
    }
}

/// Whether any sample of a tile lies inside all three edges, each taken for itself.
#[inline(always)]
fn touches_tile(triangle: &TriangleSetup, tile_x: usize, tile_y: usize) -> bool {
    let (left, top) = ((tile_x * TILE_SIZE) as i64, (tile_y * TILE_SIZE) as i64);
    let (right, bottom) = (left + TILE_SIZE as i64 - 1, top + TILE_SIZE as i64 - 1);
    (0..3).all(|edge| {
        let (a, b) = (i64::from(triangle.edge_a[edge]), i64::from(triangle.edge_b[edge]));
        // The corner of the tile that lies farthest inside the edge.
        let x = if a > 0 { left } else { right };
        let y = if b > 0 { bottom } else { top };
        triangle.edge_c[edge] - a * x + b * y >= 0
    })
}
