//! One tile: triangles sampled eight pixels at a time.

use shadow_scene::NO_TRIANGLE;

use super::{bins::TILE_SIZE, pass::AlphaTest, setup::TriangleSetup};
use crate::kernel::{LANES, MultiplyAdd};

const PIXELS: usize = TILE_SIZE * TILE_SIZE;

/// The depth of a shadow map where nothing was drawn.
const FAR_DEPTH: f32 = 1.0;

/// A tile of a depth map: the smallest depth wins.
#[derive(Clone)]
pub(crate) struct DepthTile {
    pub(crate) depth: [f32; PIXELS],
}

/// A tile of a visibility buffer with reversed depth: the largest depth wins, and of equals the first.
#[derive(Clone)]
pub(crate) struct VisibilityTile {
    pub(crate) depth: [f32; PIXELS],
    pub(crate) triangle: [u32; PIXELS],
}

/// What samples are written into.
pub(crate) trait Tile {
    fn clear(&mut self);

    /// Offers eight samples side by side to the pixels from `offset`; lanes that are not inside are left alone.
    fn write(&mut self, offset: usize, inside: [bool; LANES], z: [f32; LANES], id: u32);

    /// Whether one sample would be seen.
    fn accepts(&self, offset: usize, z: f32) -> bool;

    /// Writes one sample that was accepted.
    fn write_one(&mut self, offset: usize, z: f32, id: u32);
}

impl Tile for DepthTile {
    fn clear(&mut self) {
        self.depth.fill(FAR_DEPTH);
    }

    #[inline(always)]
    fn write(&mut self, offset: usize, inside: [bool; LANES], z: [f32; LANES], _id: u32) {
        let Some(depth) = self.depth[offset..].first_chunk_mut::<LANES>() else { return };
        for lane in 0..LANES {
            let wins = inside[lane] & (z[lane] < depth[lane]);
            depth[lane] = if wins { z[lane] } else { depth[lane] };
        }
    }

    #[inline(always)]
    fn accepts(&self, offset: usize, z: f32) -> bool {
        z < self.depth[offset]
    }

    #[inline(always)]
    fn write_one(&mut self, offset: usize, z: f32, _id: u32) {
        self.depth[offset] = z;
    }
}

impl Tile for VisibilityTile {
    fn clear(&mut self) {
        self.depth.fill(0.0);
        self.triangle.fill(NO_TRIANGLE);
    }

    #[inline(always)]
    fn write(&mut self, offset: usize, inside: [bool; LANES], z: [f32; LANES], id: u32) {
        let Some(depth) = self.depth[offset..].first_chunk_mut::<LANES>() else { return };
        let Some(triangle) = self.triangle[offset..].first_chunk_mut::<LANES>() else { return };
        for lane in 0..LANES {
            let wins = inside[lane] & (z[lane] > depth[lane]);
            depth[lane] = if wins { z[lane] } else { depth[lane] };
            triangle[lane] = if wins { id } else { triangle[lane] };
        }
    }

    #[inline(always)]
    fn accepts(&self, offset: usize, z: f32) -> bool {
        z > self.depth[offset]
    }

    #[inline(always)]
    fn write_one(&mut self, offset: usize, z: f32, id: u32) {
        self.depth[offset] = z;
        self.triangle[offset] = id;
    }
}

impl Default for DepthTile {
    fn default() -> Self {
        Self { depth: [FAR_DEPTH; PIXELS] }
    }
}

impl Default for VisibilityTile {
    fn default() -> Self {
        Self { depth: [0.0; PIXELS], triangle: [NO_TRIANGLE; PIXELS] }
    }
}

/// Edge values beyond this cannot come back to zero within a tile, whose 63 steps on each axis are at most `2^23` each; and after them they
/// still fit 32 bits. Only the values behind the last column and row, which nobody looks at, can wrap.
const EDGE_LIMIT: i64 = (1 << 30) - 1;

/// Samples a triangle in the tile whose first pixel is `(left, top)`.
#[inline(always)]
pub(crate) fn draw_triangle<M: MultiplyAdd, T: Tile>(
    tile: &mut T,
    left: usize,
    top: usize,
    triangle: &TriangleSetup,
    alpha_test: Option<&impl AlphaTest>,
) {
    let x0 = usize::from(triangle.min_x).max(left);
    let x1 = usize::from(triangle.max_x).min(left + TILE_SIZE - 1);
    let y0 = usize::from(triangle.min_y).max(top);
    let y1 = usize::from(triangle.max_y).min(top + TILE_SIZE - 1);
    let first_vector = (x0 - left) / LANES;
    let last_vector = (x1 - left) / LANES;
    let first_x = left + first_vector * LANES;

    // The edge values of the first vector's lanes in the first row.
    let mut row = [[0_i32; LANES]; 3];
    let mut step_x = [0; 3];
    for edge in 0..3 {
        let (a, b) = (triangle.edge_a[edge], triangle.edge_b[edge]);
        let start = triangle.edge_c[edge] - i64::from(a) * first_x as i64 + i64::from(b) * y0 as i64;
        let start = start.clamp(-EDGE_LIMIT, EDGE_LIMIT) as i32;
        for lane in 0..LANES {
            row[edge][lane] = start - a * lane as i32;
        }
        step_x[edge] = a * LANES as i32;
    }

    for y in y0..=y1 {
        let mut edges = row;
        let py = y as f32;
        for vector in first_vector..=last_vector {
            let mut inside = [false; LANES];
            let mut any = -1;
            for lane in 0..LANES {
                // Negative if any of the three is: the sign bits are joined.
                let outside = edges[0][lane] | edges[1][lane] | edges[2][lane];
                inside[lane] = outside >= 0;
                any &= outside;
            }
            if any >= 0 {
                let x = left + vector * LANES;
                let mut z = [0.0; LANES];
                for lane in 0..LANES {
                    let px = (x + lane) as i32 as f32;
                    let along_row = M::multiply_add(triangle.dz_dx, px, triangle.z);
                    z[lane] = M::multiply_add(triangle.dz_dy, py, along_row).max(0.0).min(1.0);
                }
                let offset = (y - top) * TILE_SIZE + vector * LANES;
                match alpha_test {
                    None => tile.write(offset, inside, z, triangle.id),
                    Some(test) => {
                        for lane in 0..LANES {
                            let is_seen = inside[lane] && tile.accepts(offset + lane, z[lane]);
                            if is_seen && test.passes(triangle.id, (x + lane) as u32, y as u32) {
                                tile.write_one(offset + lane, z[lane], triangle.id);
                            }
                        }
                    }
                }
            }
            for edge in 0..3 {
                for lane in 0..LANES {
                    edges[edge][lane] = edges[edge][lane].wrapping_sub(step_x[edge]);
                }
            }
        }
        for edge in 0..3 {
            for lane in 0..LANES {
                row[edge][lane] = row[edge][lane].wrapping_add(triangle.edge_b[edge]);
            }
        }
    }
}
