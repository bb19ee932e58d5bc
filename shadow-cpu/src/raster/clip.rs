//! Clipping in homogeneous space (Sutherland and Hodgman 1974), in the order and with the arithmetic that the rules demand.

use super::{
    ClipRule, RasterRules,
    transform::{Viewpoint, WindowVertex, outcode},
};
use crate::kernel::{MultiplyAdd, Separate};

/// The most vertices of a triangle clipped by six planes: each plane adds at most one.
const MAX_VERTICES: usize = 3 + 6;

#[derive(Clone, Copy)]
struct ClipVertex {
    position: [f32; 4],
    /// Whether clipping made it: then its window coordinates are computed without fused multiply-adds.
    is_new: bool,
}

/// A convex polygon.
struct Polygon {
    vertices: [ClipVertex; MAX_VERTICES],
    len: usize,
}

impl Polygon {
    const EMPTY: Self = Self { vertices: [ClipVertex { position: [0.0; 4], is_new: false }; MAX_VERTICES], len: 0 };

    #[inline(always)]
    fn push(&mut self, vertex: ClipVertex) {
        // Rounding can make a sliver cross a plane more than twice; what no longer fits is a vertex that the exact polygon
        // does not have.
        if self.len < MAX_VERTICES {
            self.vertices[self.len] = vertex;
            self.len += 1;
        }
    }
}

/// The signed distance of a clip point from the plane of one outcode bit, `side` times w wide: at least 0 inside.
#[inline(always)]
fn distance(code: u8, [x, y, z, w]: [f32; 4], side: f32) -> f32 {
    let limit = w * side;
    match code {
        outcode::RIGHT => limit - x,
        outcode::LEFT => limit + x,
        outcode::TOP => limit - y,
        outcode::BOTTOM => limit + y,
        outcode::NEAR => z,
        _ => w - z,
    }
}

/// Clips a triangle against the planes in `codes`, the union of its vertices' outcodes, and passes on the fan of what is left.
#[inline(always)]
pub(crate) fn clip_triangle<M: MultiplyAdd>(
    corners: [[f32; 4]; 3],
    codes: u32,
    view: &Viewpoint,
    rules: &RasterRules,
    mut emit: impl FnMut(WindowVertex, WindowVertex, WindowVertex),
) {
    let side = rules.clip_side();
    let mut polygon = Polygon::EMPTY;
    for position in corners {
        polygon.push(ClipVertex { position, is_new: false });
    }
    let is_near_first = rules.clip == ClipRule::NearFirst;
    for code in if is_near_first { NEAR_FIRST } else { SIDES_FIRST } {
        if codes & u32::from(code) == 0 {
            continue;
        }
        let mut clipped = Polygon::EMPTY;
        if polygon.len < 3 {
            return;
        }
        let mut previous = polygon.vertices[0];
        let mut previous_distance = distance(code, previous.position, side);
        for i in 1..=polygon.len {
            let vertex = polygon.vertices[if i == polygon.len { 0 } else { i }];
            let vertex_distance = distance(code, vertex.position, side);
            if previous_distance >= 0.0 {
                clipped.push(previous);
            }
            if (previous_distance >= 0.0) != (vertex_distance >= 0.0) {
                let crossing = if is_near_first { weighted_crossing } else { stepped_crossing };
                clipped.push(crossing(previous, previous_distance, vertex, vertex_distance));
            }
            previous = vertex;
            previous_distance = vertex_distance;
        }
        polygon = clipped;
    }
    if polygon.len < 3 {
        return;
    }
    let grid = rules.grid();
    let window = |vertex: ClipVertex| {
        if vertex.is_new { view.window::<Separate>(vertex.position, grid) } else { view.window::<M>(vertex.position, grid) }
    };
    let first = window(polygon.vertices[0]);
    let mut previous = window(polygon.vertices[1]);
    for vertex in &polygon.vertices[2..polygon.len] {
        let vertex = window(*vertex);
        if first.has_room() && previous.has_room() && vertex.has_room() {
            emit(first, previous, vertex);
        }
        previous = vertex;
    }
}

/// The order of the planes for [`ClipRule::Viewport`] and [`ClipRule::GuardBand`].
const SIDES_FIRST: [u8; 6] = [outcode::RIGHT, outcode::LEFT, outcode::TOP, outcode::BOTTOM, outcode::NEAR, outcode::FAR];
/// The order of the planes for [`ClipRule::NearFirst`].
const NEAR_FIRST: [u8; 6] = [outcode::NEAR, outcode::FAR, outcode::LEFT, outcode::RIGHT, outcode::TOP, outcode::BOTTOM];

/// The point where an edge crosses a plane, as a sum of its endpoints in which each has the other's distance as its weight.
#[inline(always)]
fn weighted_crossing(a: ClipVertex, a_distance: f32, b: ClipVertex, b_distance: f32) -> ClipVertex {
    let (inner, inner_distance, outer, outer_distance) =
        if a_distance >= 0.0 { (a, a_distance, b, b_distance) } else { (b, b_distance, a, a_distance) };
    let scale = 1.0 / (outer_distance - inner_distance);
    let position = core::array::from_fn(|i| (outer_distance * inner.position[i] - inner_distance * outer.position[i]) * scale);
    ClipVertex { position, is_new: true }
}

/// The point where an edge crosses a plane, computed from the endpoint that is nearer to it; between equals from the inner one.
#[inline(always)]
fn stepped_crossing(a: ClipVertex, a_distance: f32, b: ClipVertex, b_distance: f32) -> ClipVertex {
    let a_is_inside = a_distance >= 0.0;
    let a_is_nearer = if a_is_inside { a_distance.abs() <= b_distance.abs() } else { a_distance.abs() < b_distance.abs() };
    let (near, near_distance, far, far_distance) =
        if a_is_nearer { (a, a_distance, b, b_distance) } else { (b, b_distance, a, a_distance) };
    let t = near_distance.abs() / (near_distance.abs() + far_distance.abs());
    let position = core::array::from_fn(|i| near.position[i] + t * (far.position[i] - near.position[i]));
    ClipVertex { position, is_new: true }
}
