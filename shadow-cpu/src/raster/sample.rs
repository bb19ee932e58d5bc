//! Triangles into a tile: which samples they cover, and how deep they lie there.

use std::ops::RangeInclusive;

use super::{
    bins::TILE_SIZE,
    pass::AlphaTest,
    plane::{CornerPlane, DepthPlane},
    setup::{LargeTriangle, SmallTriangle},
    tile::{ROW_BLOCKS, ROW_STEP, STRIDE, Tile},
};
use crate::kernel::{
    LANES, MultiplyAdd,
    lanes::{Floats, Ints, Lanes},
};

/// The lanes' numbers.
const LANE: [i32; LANES] = [0, 1, 2, 3, 4, 5, 6, 7];

/// A triangle's part of one tile: the box of pixels that is looked at, counted from the tile's top left corner, and the edge functions there.
pub(crate) struct Part {
    id: u32,
    plane: DepthPlane,
    corner_plane: CornerPlane,
    columns: RangeInclusive<usize>,
    rows: RangeInclusive<usize>,
    /// The edge values at the box's first pixel, and their changes: minus `a` a pixel, plus `b` a row.
    start: [i32; 3],
    a: [i32; 3],
    b: [i32; 3],
}

/// The tile's first pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corner {
    pub(crate) left: usize,
    pub(crate) top: usize,
}

impl Part {
    /// The part of a small triangle that touches the tile.
    #[inline(always)]
    pub(crate) fn of_small(triangle: &SmallTriangle, corner: Corner) -> Self {
        let Corner { left, top } = corner;
        let (min_x, min_y) = (usize::from(triangle.min_x), usize::from(triangle.min_y));
        let x0 = min_x.max(left) - left;
        let x1 = (min_x + usize::from(triangle.more_x) - left).min(TILE_SIZE - 1);
        let y0 = min_y.max(top) - top;
        let y1 = (min_y + usize::from(triangle.more_y) - top).min(TILE_SIZE - 1);
        let (a, b) = (triangle.a(), triangle.b());
        let (right, down) = ((left + x0 - min_x) as i32, (top + y0 - min_y) as i32);
        let mut start = triangle.c;
        for edge in 0..3 {
            start[edge] += b[edge] * down - a[edge] * right;
        }
        let corner_plane = CornerPlane::default();
        Self { id: triangle.id, plane: triangle.plane, corner_plane, columns: x0..=x1, rows: y0..=y1, start, a, b }
    }

    /// The part of a triangle of any size whose box touches the tile.
    #[inline(always)]
    pub(crate) fn of_large(triangle: &LargeTriangle, corner: Corner) -> Self {
        let Corner { left, top } = corner;
        let x0 = usize::from(triangle.min_x).max(left) - left;
        let x1 = (usize::from(triangle.max_x) - left).min(TILE_SIZE - 1);
        let y0 = usize::from(triangle.min_y).max(top) - top;
        let y1 = (usize::from(triangle.max_y) - top).min(TILE_SIZE - 1);
        let (first_x, first_y) = ((left + x0) as i64, (top + y0) as i64);
        let (a, b) = (triangle.a, triangle.b);
        let mut start = [0; 3];
        for edge in 0..3 {
            let value = triangle.c[edge] - i64::from(a[edge]) * first_x + i64::from(b[edge]) * first_y;
            start[edge] = value.clamp(-EDGE_LIMIT, EDGE_LIMIT) as i32;
        }
        let LargeTriangle { id, plane, corner_plane, .. } = *triangle;
        Self { id, plane, corner_plane, columns: x0..=x1, rows: y0..=y1, start, a, b }
    }
}

/// Edge values beyond this cannot come back to zero within a tile, whose 63 steps on each axis are at most `2^23` each; and after them they
/// still fit 32 bits. Only the values behind the last column and row, which nobody looks at, can wrap.
const EDGE_LIMIT: i64 = (1 << 30) - 1;

/// The depths of a vector's pixels, in two steps: what is the same in all rows, and the rest. `SNAPPED` says which of the part's planes it is.
struct Depths<L: Lanes, const SNAPPED: bool> {
    along_row: L::F,
    dy: L::F,
    /// The row and the depth that the rest is counted from.
    y0: f32,
    z0: L::F,
}

impl<L: Lanes, const SNAPPED: bool> Depths<L, SNAPPED> {
    /// For pixels in columns `x`, counted from the target's left.
    #[inline(always)]
    fn new<M: MultiplyAdd>(part: &Part, x: L::I) -> Self {
        if SNAPPED {
            let CornerPlane { x0, y0, z0, dx, dy } = part.corner_plane;
            let along_row = (x.to_floats() - L::F::splat(x0)) * L::F::splat(dx);
            return Self { along_row, dy: L::F::splat(dy), y0, z0: L::F::splat(z0) };
        }
        let plane = part.plane;
        let along_row = M::multiply_add_lanes(L::F::splat(plane.dx), x.to_floats(), L::F::splat(plane.origin));
        Self { along_row, dy: L::F::splat(plane.dy), y0: 0.0, z0: L::F::splat(0.0) }
    }

    /// Limited to depths that there are. A sliver that has an area on the grid may have none in f32, or before it is clipped, and its plane is then not a number; drivers
    /// that limit it with a minimum first have a depth of 1 there, and those that begin with a maximum one of 0.
    #[inline(always)]
    fn in_row<M: MultiplyAdd>(&self, y: f32) -> L::F {
        let (least, most) = (L::F::splat(0.0), L::F::splat(1.0));
        if SNAPPED {
            let z = (self.z0 + L::F::splat(y - self.y0) * self.dy) + self.along_row;
            return z.max(least).min(most);
        }
        M::multiply_add_lanes(self.dy, L::F::splat(y), self.along_row).min(most).max(least)
    }
}

/// The columns of the pixels of the vector at column `x` of the tile, counted from the target's left.
#[inline(always)]
fn columns<L: Lanes>(corner: Corner, x: usize) -> L::I {
    L::I::splat((corner.left + x) as i32) + L::I::load(&LANE)
}

/// The edge values of the lanes of a vector, whose first lane has `start`.
#[inline(always)]
fn edge_lanes<L: Lanes>(start: [i32; 3], a: [i32; 3]) -> [L::I; 3] {
    let mut edges = [L::I::splat(0); 3];
    for edge in 0..3 {
        edges[edge] = L::I::splat(start[edge]) - L::I::splat(a[edge]) * L::I::load(&LANE);
    }
    edges
}

/// Draws a small triangle.
#[inline(always)]
pub(crate) fn draw_small<L: Lanes, M: MultiplyAdd, T: Tile, const SNAPPED: bool>(
    tile: &mut T,
    corner: Corner,
    triangle: &SmallTriangle,
) {
    draw_columns::<L, M, T, SNAPPED>(tile, corner, &Part::of_small(triangle, corner));
}

/// Draws a triangle of any size.
#[inline(always)]
pub(crate) fn draw_large<L: Lanes, M: MultiplyAdd, T: Tile, const SNAPPED: bool>(
    tile: &mut T,
    corner: Corner,
    triangle: &LargeTriangle,
) {
    let part = Part::of_large(triangle, corner);
    let (columns, rows) = (part.columns.end() - part.columns.start(), part.rows.end() - part.rows.start());
    if columns < LANES || rows < LANES {
        draw_columns::<L, M, T, SNAPPED>(tile, corner, &part);
    } else {
        draw_blocks::<L, M, T, SNAPPED>(tile, corner, &part);
    }
}

/// Draws by vectors that begin at the box's first column, and [`ROW_STEP`] rows at a time: most triangles are one vector wide and one step high,
/// and then nothing is left for the processor to guess. Rows below the box are outside the edges, or in the padding.
#[inline(always)]
fn draw_columns<L: Lanes, M: MultiplyAdd, T: Tile, const SNAPPED: bool>(tile: &mut T, corner: Corner, part: &Part) {
    let (first_row, last_row) = (*part.rows.start(), *part.rows.end());
    let (mut x, last_x) = (*part.columns.start(), *part.columns.end());
    let mut start = part.start;
    loop {
        let depths = Depths::<L, SNAPPED>::new::<M>(part, columns::<L>(corner, x));
        let mut edges = edge_lanes::<L>(start, part.a);
        let mut row = first_row;
        loop {
            for step in 0..ROW_STEP {
                let outside = edges[0] | edges[1] | edges[2];
                let z = depths.in_row::<M>((corner.top + row + step) as i32 as f32);
                tile.write::<L>((row + step) * STRIDE + x, outside, z, part.id);
                for edge in 0..3 {
                    edges[edge] = edges[edge] + L::I::splat(part.b[edge]);
                }
            }
            row += ROW_STEP;
            if row > last_row {
                break;
            }
        }
        x += LANES;
        if x > last_x {
            break;
        }
        for edge in 0..3 {
            start[edge] = start[edge].wrapping_sub(part.a[edge] * LANES as i32);
        }
    }
}

/// Draws block by block: whole rows of blocks are tested at once for being outside, inside or hidden.
#[inline(always)]
fn draw_blocks<L: Lanes, M: MultiplyAdd, T: Tile, const SNAPPED: bool>(tile: &mut T, corner: Corner, part: &Part) {
    /// From the first to the last pixel of a block.
    const ACROSS: i32 = LANES as i32 - 1;
    let (first_column, last_column) = (*part.columns.start() as i32, *part.columns.end() as i32);
    let (first_row, last_row) = (*part.rows.start(), *part.rows.end());
    let (first_block_row, last_block_row) = (first_row / LANES, last_row / LANES);
    let block_columns = L::I::load(&LANE);
    // Blocks of the part's columns: the others lie outside the box, whatever their edge values, which may have wrapped.
    let in_box = (L::I::splat(first_column / LANES as i32 - 1) - block_columns)
        & (block_columns - L::I::splat(last_column / LANES as i32 + 1));
    let in_box = in_box.negative_bits();

    // The nearest corner of a block, where its depth is compared, is the same one for all.
    let nearest = |slope: f32| if (slope > 0.0) == T::SMALLER_IS_NEARER { 0 } else { ACROSS };
    let (dx, dy) = if SNAPPED { (part.corner_plane.dx, part.corner_plane.dy) } else { (part.plane.dx, part.plane.dy) };
    let nearest_x = L::I::splat(corner.left as i32 + nearest(dx)) + block_columns * L::I::splat(LANES as i32);
    let near_depths = Depths::<L, SNAPPED>::new::<M>(part, nearest_x);

    for block_row in first_block_row..=last_block_row {
        let top_row = block_row * LANES;
        let mut outside = L::I::splat(0);
        let mut partial = L::I::splat(0);
        let mut starts = [[0; ROW_BLOCKS]; 3];
        for edge in 0..3 {
            let (a, b) = (part.a[edge], part.b[edge]);
            // At the top left pixel of each block of the row.
            let down = b.wrapping_mul(top_row as i32 - first_row as i32);
            let right = (block_columns * L::I::splat(LANES as i32) - L::I::splat(first_column)) * L::I::splat(a);
            let at_corner = L::I::splat(part.start[edge].wrapping_add(down)) - right;
            at_corner.store(&mut starts[edge]);
            let (most, least) = ((-a).max(0) + b.max(0), (-a).min(0) + b.min(0));
            outside = outside | (at_corner + L::I::splat(most.wrapping_mul(ACROSS)));
            partial = partial | (at_corner + L::I::splat(least.wrapping_mul(ACROSS)));
        }
        let near_y = (corner.top + top_row) as i32 + nearest(dy);
        let near = near_depths.in_row::<M>(near_y as f32);
        let may_be_seen = T::before::<L>(near, L::F::load(tile.farthest(block_row)));
        let mut blocks = in_box & !outside.negative_bits() & may_be_seen.negative_bits();
        let partial = partial.negative_bits();
        while blocks != 0 {
            let block = blocks.trailing_zeros() as usize;
            blocks &= blocks - 1;
            let depths = Depths::<L, SNAPPED>::new::<M>(part, columns::<L>(corner, block * LANES));
            let mut farthest = L::F::splat(if T::SMALLER_IS_NEARER { 0.0 } else { 1.0 });
            if partial >> block & 1 == 0 {
                for row in top_row..top_row + LANES {
                    let z = depths.in_row::<M>((corner.top + row) as i32 as f32);
                    let stands = tile.write::<L>(row * STRIDE + block * LANES, L::I::splat(0), z, part.id);
                    farthest = T::farther::<L>(farthest, stands);
                }
            } else {
                let mut edges = edge_lanes::<L>([starts[0][block], starts[1][block], starts[2][block]], part.a);
                for row in top_row..top_row + LANES {
                    let outside = edges[0] | edges[1] | edges[2];
                    let z = depths.in_row::<M>((corner.top + row) as i32 as f32);
                    let stands = tile.write::<L>(row * STRIDE + block * LANES, outside, z, part.id);
                    farthest = T::farther::<L>(farthest, stands);
                    for edge in 0..3 {
                        edges[edge] = edges[edge] + L::I::splat(part.b[edge]);
                    }
                }
            }
            let mut lanes = [0.0; LANES];
            farthest.store(&mut lanes);
            // A comparison, not `f32::max`: there is no NaN to care for, and where LLVM 22 does not unroll that reduction, as in instrumented
            // builds, it forgets the last lanes.
            let farther = |a: f32, b: f32| if (a > b) == T::SMALLER_IS_NEARER { a } else { b };
            tile.farthest(block_row)[block] = lanes.into_iter().reduce(farther).unwrap_or_default();
        }
    }
}

/// Draws an alpha-tested triangle: samples that would be seen are asked for one by one.
#[inline(always)]
pub(crate) fn draw_masked<L: Lanes, M: MultiplyAdd, T: Tile, const SNAPPED: bool>(
    tile: &mut T,
    corner: Corner,
    part: &Part,
    alpha_test: &impl AlphaTest,
) {
    let mut start = part.start;
    for x in part.columns.clone().step_by(LANES) {
        let depths = Depths::<L, SNAPPED>::new::<M>(part, columns::<L>(corner, x));
        let mut edges = edge_lanes::<L>(start, part.a);
        // Lanes beyond the tile belong to the next one.
        let in_tile = (1_u32 << LANES.min(TILE_SIZE - x)) - 1;
        for row in part.rows.clone() {
            let outside = edges[0] | edges[1] | edges[2];
            let mut inside = !outside.negative_bits() & in_tile;
            if inside != 0 {
                let y = corner.top + row;
                let mut z = [0.0; LANES];
                depths.in_row::<M>(y as i32 as f32).store(&mut z);
                while inside != 0 {
                    let lane = inside.trailing_zeros() as usize;
                    inside &= inside - 1;
                    let offset = row * STRIDE + x + lane;
                    let is_seen = tile.accepts(offset, z[lane]);
                    if is_seen && alpha_test.passes(part.id, (corner.left + x + lane) as u32, y as u32) {
                        tile.write_one(offset, z[lane], part.id);
                    }
                }
            }
            for edge in 0..3 {
                edges[edge] = edges[edge] + L::I::splat(part.b[edge]);
            }
        }
        for edge in 0..3 {
            start[edge] = start[edge].wrapping_sub(part.a[edge] * LANES as i32);
        }
    }
}
