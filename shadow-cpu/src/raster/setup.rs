//! A triangle's edge functions and depth plane.
//!
//! Most triangles of a dense mesh are smaller than a few pixels, and most of those miss every pixel centre: [`look_at`] tells
//! eight of them at a time from the rest, and [`setup_small`] sets eight of those up that are left, in 32-bit numbers.
//! Large and clipped ones take their time in [`setup_large`].

use super::{
    DepthPlaneRule, RasterRules,
    plane::{CornerPlane, DepthPlane, WholeTriangle},
    transform::{OUTCODE_BITS, Transformed, WindowVertex},
};
use crate::kernel::{
    LANES,
    lanes::{Floats, Ints, Lanes},
};

/// A triangle ready to be sampled. A sample at pixel `(x, y)` is inside if `c - a (x - min_x) + b (y - min_y) >= 0` for all three edges: whole
/// pixels, the top-left rule included.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SmallTriangle {
    /// The index of the triangle.
    pub(crate) id: u32,
    /// The first column and row of pixel centres in its bounding box.
    pub(crate) min_x: u16,
    pub(crate) min_y: u16,
    /// How many columns and rows there are after the first, below [`SMALL_PIXELS`].
    pub(crate) more_x: u8,
    pub(crate) more_y: u8,
    /// The first two edges' coefficients; since the edges are a closed walk, the third's are what is missing to zero.
    a: [i16; 2],
    b: [i16; 2],
    pub(crate) c: [i32; 3],
    /// Depth at the centre of the target's pixel (0, 0), and its change per pixel.
    pub(crate) plane: DepthPlane,
}

/// A small triangle is at most this many pixels wide and high: its edge functions then fit 32 bits on the finest grid, and it touches at most two
/// tiles on each axis.
pub(crate) const SMALL_PIXELS: i32 = 64;

/// In boxes of at most so many pixels on each axis every sample is tested before the triangle is binned.
const TINY_PIXELS: usize = 3;

impl SmallTriangle {
    #[inline(always)]
    pub(crate) fn a(&self) -> [i32; 3] {
        let [a0, a1] = self.a.map(i32::from);
        [a0, a1, -(a0 + a1)]
    }

    #[inline(always)]
    pub(crate) fn b(&self) -> [i32; 3] {
        let [b0, b1] = self.b.map(i32::from);
        [b0, b1, -(b0 + b1)]
    }
}

/// A triangle of any size. A sample at pixel `(x, y)` is inside if `c - a x + b y >= 0` for all three edges.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LargeTriangle {
    pub(crate) id: u32,
    /// The first and last columns and rows of pixel centres in its bounding box.
    pub(crate) min_x: u16,
    pub(crate) max_x: u16,
    pub(crate) min_y: u16,
    pub(crate) max_y: u16,
    pub(crate) a: [i32; 3],
    pub(crate) b: [i32; 3],
    pub(crate) c: [i64; 3],
    pub(crate) plane: DepthPlane,
    /// In its place where the rules have it.
    pub(crate) corner_plane: CornerPlane,
}

/// Which triangles are left out by the way that they face.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Culling {
    /// None.
    #[default]
    None,
    /// Those that wind clockwise on the screen: back faces.
    Back,
    /// Those that wind counter-clockwise on the screen: front faces.
    Front,
}

/// The limits of what is drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    pub(crate) width: u32,
    pub(crate) height: u32,
}

/// What a first look at eight triangles found: a bit for each, the first one's lowest. Those in neither set cover no sample.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FirstLook {
    /// For [`setup_small`].
    pub(crate) small: u32,
    /// For [`setup_large`], after clipping where they cross a plane.
    pub(crate) rest: u32,
}

/// The first and last whole pixel of an interval on the grid, cut to what is drawn.
#[inline(always)]
fn pixels(low: i32, high: i32, bits: u32, size: u32) -> (i32, i32) {
    ((low + ((1 << bits) - 1)) >> bits, (high >> bits).min(size as i32 - 1))
}

/// As [`pixels`], for eight intervals.
#[inline(always)]
fn pixels_of<I: Ints>(low: I, high: I, bits: u32, size: u32) -> (I, I) {
    let first = (low + I::splat((1 << bits) - 1)).shift_right(bits).max(I::splat(0));
    (first, high.shift_right(bits).min(I::splat(size as i32 - 1)))
}

/// Twice the signed area of eight triangles on the grid.
#[inline(always)]
fn area_of<I: Ints>(x: [I; 3], y: [I; 3]) -> I {
    (x[0] - x[1]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[0] - y[1])
}

/// The smallest and the largest of three, in each lane.
#[inline(always)]
fn range_of<I: Ints>([a, b, c]: [I; 3]) -> (I, I) {
    (a.min(b).min(c), a.max(b).max(c))
}

/// One corner of eight triangles on the grid: x with the outcode below it, and y.
#[inline(always)]
fn grid_corner<L: Lanes>(vertices: &Transformed, corners: &[[u32; 3]; LANES], corner: usize) -> [L::I; 2] {
    let mut pairs = [0; LANES];
    for lane in 0..LANES {
        pairs[lane] = vertices.grid(corners[lane][corner]).0;
    }
    L::I::columns(pairs)
}

/// A first look at eight triangles.
#[inline(always)]
pub(crate) fn look_at<L: Lanes>(
    vertices: &Transformed,
    corners: &[[u32; 3]; LANES],
    culling: Culling,
    extent: Extent,
    rules: &RasterRules,
) -> FirstLook {
    let bits = rules.subpixel_bits;
    let [v0, v1, v2] =
        [grid_corner::<L>(vertices, corners, 0), grid_corner::<L>(vertices, corners, 1), grid_corner::<L>(vertices, corners, 2)];
    let x = [v0[0].shift_right(OUTCODE_BITS), v1[0].shift_right(OUTCODE_BITS), v2[0].shift_right(OUTCODE_BITS)];
    let y = [v0[1], v1[1], v2[1]];
    let code_bits = L::I::splat((1 << OUTCODE_BITS) - 1);
    let all = v0[0] & v1[0] & v2[0] & code_bits;
    let any = (v0[0] | v1[0] | v2[0]) & code_bits;
    let zero = L::I::splat(0);
    // Of triangles that cross a plane the grid coordinates mean nothing, and what follows is not looked at.
    let crosses = any.greater(zero);
    let outside = all.greater(zero);

    let (low_x, high_x) = range_of(x);
    let (low_y, high_y) = range_of(y);
    let (min_x, max_x) = pixels_of(low_x, high_x, bits, extent.width);
    let (min_y, max_y) = pixels_of(low_y, high_y, bits, extent.height);
    let misses = min_x.greater(max_x) | min_y.greater(max_y);
    // A small triangle has no room for a plane from one of its corners on.
    let longest = if rules.depth_plane == DepthPlaneRule::Snapped { 0 } else { (SMALL_PIXELS - 1) << bits };
    let limit = L::I::splat(longest);
    let is_small = limit.greater(high_x - low_x) & limit.greater(high_y - low_y);
    // Wraps where the triangle is not small.
    let area = area_of(x, y);
    let culled = match culling {
        Culling::None => zero,
        Culling::Back => zero.greater(area),
        Culling::Front => area.greater(zero),
    };
    let faces_away = area.equal(zero) | culled;

    let (crosses, outside, misses) = (crosses.negative_bits(), outside.negative_bits(), misses.negative_bits());
    let (is_small, faces_away) = (is_small.negative_bits(), faces_away.negative_bits());
    let whole = !crosses & !misses;
    FirstLook { small: whole & is_small & !faces_away, rest: (crosses & !outside) | (whole & !is_small) }
}

/// Sets up the first `count` of eight triangles that [`look_at`] found small, and passes on those that may cover a sample.
#[inline(always)]
pub(crate) fn setup_small<L: Lanes>(
    vertices: &Transformed,
    ids: &[u32; LANES],
    corners: &[[u32; 3]; LANES],
    count: usize,
    extent: Extent,
    rules: &RasterRules,
    mut emit: impl FnMut(SmallTriangle),
) {
    let bits = rules.subpixel_bits;
    let zero = L::I::splat(0);
    let mut x = [zero; 3];
    let mut y = [zero; 3];
    let mut points = [[L::F::splat(0.0); 3]; 3];
    for corner in 0..3 {
        let [word, grid_y] = grid_corner::<L>(vertices, corners, corner);
        x[corner] = word.shift_right(OUTCODE_BITS);
        y[corner] = grid_y;
        let mut rows = [&[0.0; 4]; LANES];
        for lane in 0..LANES {
            rows[lane] = vertices.window(corners[lane][corner]);
        }
        let [point_x, point_y, point_z, _] = L::F::columns(rows);
        points[corner] = [point_x, point_y, point_z];
    }
    // Clockwise triangles go the other way round.
    let swaps = area_of(x, y);
    (x[1], x[2]) = (swaps.select_negative_ints(x[2], x[1]), swaps.select_negative_ints(x[1], x[2]));
    (y[1], y[2]) = (swaps.select_negative_ints(y[2], y[1]), swaps.select_negative_ints(y[1], y[2]));
    for axis in 0..3 {
        let (first, second) = (points[1][axis], points[2][axis]);
        points[1][axis] = swaps.select_negative(second, first);
        points[2][axis] = swaps.select_negative(first, second);
    }

    let (low_x, high_x) = range_of(x);
    let (low_y, high_y) = range_of(y);
    let (min_x, max_x) = pixels_of(low_x, high_x, bits, extent.width);
    let (min_y, max_y) = pixels_of(low_y, high_y, bits, extent.height);
    let (more_x, more_y) = (max_x - min_x, max_y - min_y);

    // Edge values at the first pixel of the box, with all distances from its centre: they stay small.
    let (left, top) = (min_x.shift_left(bits), min_y.shift_left(bits));
    let mut edges = [[[0; LANES]; 3]; 3];
    let mut outside = [[zero; TINY_PIXELS]; TINY_PIXELS];
    for (edge, [from, to]) in [[0, 1], [1, 2], [2, 0]].into_iter().enumerate() {
        let a = y[from] - y[to];
        let b = x[from] - x[to];
        let value = a * (x[from] - left) - b * (y[from] - top);
        // The top-left rule: samples exactly on such an edge are inside. -1 for the other edges.
        let is_other = (L::I::splat(-1) - zero.greater(a)) & (L::I::splat(-1) - (a.equal(zero) & b.greater(L::I::splat(-1))));
        // value > 0 in steps of the grid's square, and (value - 1) >> bits >= 0 in whole pixels, are the same test.
        let c = (value + is_other).shift_right(bits);
        let mut at_row = c;
        for row in &mut outside {
            let mut at_pixel = at_row;
            for pixel in row {
                *pixel = *pixel | at_pixel;
                at_pixel = at_pixel - a;
            }
            at_row = at_row + b;
        }
        a.store(&mut edges[edge][0]);
        b.store(&mut edges[edge][1]);
        c.store(&mut edges[edge][2]);
    }
    // Whether a tiny box has a sample inside is decided here: half of the tiny boxes of dense meshes have none. Samples beyond the box are
    // not inside, or beyond the target.
    let tiny = L::I::splat(TINY_PIXELS as i32);
    let is_tiny = tiny.greater(more_x) & tiny.greater(more_y);
    let mut misses = is_tiny;
    for sample in outside.as_flattened() {
        misses = misses & *sample;
    }
    let covers = !misses.negative_bits();

    let plane = DepthPlane::<L::F>::through(points, L::F::splat(1.0), L::F::splat(0.5));
    let mut box_ = [[0; LANES]; 4];
    for (lanes, values) in box_.iter_mut().zip([min_x, min_y, more_x, more_y]) {
        values.store(lanes);
    }
    let mut planes = [[0.0; LANES]; 3];
    for (lanes, values) in planes.iter_mut().zip([plane.origin, plane.dx, plane.dy]) {
        values.store(lanes);
    }
    let mut waiting = covers & ((1 << count) - 1);
    while waiting != 0 {
        let lane = waiting.trailing_zeros() as usize;
        waiting &= waiting - 1;
        emit(SmallTriangle {
            id: ids[lane],
            min_x: box_[0][lane] as u16,
            min_y: box_[1][lane] as u16,
            more_x: box_[2][lane] as u8,
            more_y: box_[3][lane] as u8,
            a: [edges[0][0][lane] as i16, edges[1][0][lane] as i16],
            b: [edges[0][1][lane] as i16, edges[1][1][lane] as i16],
            c: [edges[0][2][lane], edges[1][2][lane], edges[2][2][lane]],
            plane: DepthPlane { origin: planes[0][lane], dx: planes[1][lane], dy: planes[2][lane] },
        });
    }
}

/// Sets a triangle of any size up; `None` if it covers no sample, has no area on the grid, or is culled. `whole` is the triangle that it is of, where the rules ask for that.
#[inline(always)]
pub(crate) fn setup_large(
    id: u32,
    [v0, v1, v2]: [&WindowVertex; 3],
    whole: Option<&WholeTriangle>,
    culling: Culling,
    extent: Extent,
    rules: &RasterRules,
) -> Option<LargeTriangle> {
    let bits = rules.subpixel_bits;
    let low = |f: fn(&WindowVertex) -> i32| f(v0).min(f(v1)).min(f(v2));
    let high = |f: fn(&WindowVertex) -> i32| f(v0).max(f(v1)).max(f(v2));
    let (min_x, max_x) = pixels(low(|v| v.grid_x), high(|v| v.grid_x), bits, extent.width);
    let (min_y, max_y) = pixels(low(|v| v.grid_y), high(|v| v.grid_y), bits, extent.height);
    let (min_x, min_y) = (min_x.max(0), min_y.max(0));
    if min_x > max_x || min_y > max_y {
        return None;
    }

    let area = i64::from(v0.grid_x - v1.grid_x) * i64::from(v2.grid_y - v0.grid_y)
        - i64::from(v2.grid_x - v0.grid_x) * i64::from(v0.grid_y - v1.grid_y);
    let (is_turned, is_culled) = match whole {
        None => (false, (area < 0 && culling == Culling::Back) || (area > 0 && culling == Culling::Front)),
        Some(WholeTriangle { area: whole, .. }) => (
            (*whole > 0.0) != (area > 0),
            (*whole < 0.0 && culling == Culling::Back) || (*whole >= 0.0 && culling == Culling::Front),
        ),
    };
    if area == 0 || is_turned || is_culled {
        return None;
    }
    let (v1, v2) = if area < 0 { (v2, v1) } else { (v1, v2) };

    let mut a = [0; 3];
    let mut b = [0; 3];
    let mut c = [0; 3];
    for (edge, (from, to)) in [(v0, v1), (v1, v2), (v2, v0)].into_iter().enumerate() {
        a[edge] = from.grid_y - to.grid_y;
        b[edge] = from.grid_x - to.grid_x;
        let value = i64::from(a[edge]) * i64::from(from.grid_x) - i64::from(b[edge]) * i64::from(from.grid_y);
        let is_top_left = a[edge] < 0 || (a[edge] == 0 && b[edge] >= 0);
        c[edge] = (value - i64::from(!is_top_left)) >> bits;
    }
    Some(LargeTriangle {
        id,
        min_x: min_x as u16,
        max_x: max_x as u16,
        min_y: min_y as u16,
        max_y: max_y as u16,
        a,
        b,
        c,
        plane: DepthPlane::through([v0, v1, v2].map(|v| [v.x, v.y, v.z]), 1.0, 0.5),
        corner_plane: whole.map_or(CornerPlane::default(), |whole| whole.plane),
    })
}
