//! A ray's way through the tree.
//!
//! Boxes and triangles are first tested in single precision, eight at a time, in a way that can only err toward "met"; what is left goes
//! through [`ShearedRay::meet`] in double precision.
//!
//! Let `u = 2^-24` and `m` be the largest coordinate of the scene or of the ray's origin. A box's plane is at `(plane - origin) / direction`, where
//! rounding the origin, the difference and the planes' own f32 arithmetic move the plane by less than `4 u m`: each is moved outward by
//! [`BOX_MARGIN`] of m. The direction, its reciprocal and the product are off by `3 u` of their result, for which the far end is moved by [`END_MARGIN`] of itself.
//! A sheared coordinate of a corner is off by at most `14 u m`, a little less than [`SHEAR_MARGIN`] of m, which for an edge function of
//! corners b and c makes `2 e (|b| + |c|)`, its own three roundings included: an edge function counts only if it is larger than that.

use super::{
    ray::{Hit, Ray},
    structure::{LEAF, Leaf, NO_LANE, Node, Structure},
    triangle::ShearedRay,
};
use crate::kernel::{
    Kernel, LANES, MultiplyAdd,
    lanes::{Floats, Ints, Lanes},
};

/// By how much the planes of boxes are moved outward: a share of the largest coordinate.
const BOX_MARGIN: f64 = 1.0 / (1_u32 << 21) as f64;
/// By how much a box's far end is moved back: a share of its distance, as a factor on it.
const END_MARGIN: f32 = 1.0 + 1.0 / (1_u32 << 20) as f32;
/// The error of a sheared coordinate: a share of the largest coordinate.
const SHEAR_MARGIN: f32 = 1.0 / (1_u32 << 20) as f32;

/// A child that waits to be entered, and how far away it begins.
pub(super) type Waiting = (u32, f32);

/// Finds the nearest hit that `accept` accepts or, with `ANY`, some hit.
pub(super) struct Walk<'a, A, const ANY: bool> {
    pub(super) structure: &'a Structure,
    pub(super) stack: &'a mut Vec<Waiting>,
    pub(super) ray: Ray,
    /// Whether a hit counts: told the hit.
    pub(super) accept: A,
}

/// A ray as boxes see it in single precision.
struct BoxRay {
    /// The origin moved along the direction, for near planes, and against it, for far planes.
    origin: [[f32; 3]; 2],
    inverse: [f32; 3],
    /// The rows of [`Node::planes`] that are near and far, for each axis.
    rows: [[usize; 3]; 2],
}

/// A ray as triangles see it in single precision.
struct CornerRay {
    point: [f32; 3],
    shear: [f32; 2],
    axes: [usize; 3],
    /// The error of a sheared coordinate, in metres.
    error: f32,
}

impl BoxRay {
    /// `largest` is the largest coordinate of the scene and of the ray's origin.
    #[inline(always)]
    fn new(ray: &Ray, largest: f64) -> Self {
        let (origin, direction) = (ray.origin(), ray.direction());
        let margin = largest * BOX_MARGIN;
        let mut coarse = Self { origin: [[0.0; 3]; 2], inverse: [0.0; 3], rows: [[0; 3]; 2] };
        for axis in 0..3 {
            let is_backward = direction[axis] < 0.0;
            let forward = if is_backward { -margin } else { margin };
            coarse.origin[0][axis] = (origin[axis] + forward) as f32;
            coarse.origin[1][axis] = (origin[axis] - forward) as f32;
            // A component of -0 is none, and goes the way of 0.
            coarse.inverse[axis] = if direction[axis] == 0.0 { f32::INFINITY } else { 1.0 / direction[axis] as f32 };
            coarse.rows[0][axis] = 2 * axis + usize::from(is_backward);
            coarse.rows[1][axis] = 2 * axis + usize::from(!is_backward);
        }
        coarse
    }

    /// Which of a node's boxes the ray enters before `end`, a bit each, and where.
    #[inline(always)]
    fn enter<L: Lanes>(&self, node: &Node, end: f32) -> (u32, L::F) {
        let mut near = L::F::splat(0.0);
        let mut far = L::F::splat(end);
        for axis in 0..3 {
            let inverse = L::F::splat(self.inverse[axis]);
            let to_near = (L::F::load(&node.planes[self.rows[0][axis]]) - L::F::splat(self.origin[0][axis])) * inverse;
            let to_far = (L::F::load(&node.planes[self.rows[1][axis]]) - L::F::splat(self.origin[1][axis])) * inverse;
            // A plane through the origin of a ray that runs along it gives NaN, which these ignore: the ray is between the planes.
            near = to_near.max(near);
            far = to_far.min(far);
        }
        (near.at_most(far * L::F::splat(END_MARGIN)).negative_bits(), near)
    }
}

impl CornerRay {
    #[inline(always)]
    fn new(sheared: &ShearedRay, largest: f64) -> Self {
        Self {
            point: sheared.ray.origin().as_vec3().to_array(),
            shear: [sheared.shear[0] as f32, sheared.shear[1] as f32],
            axes: sheared.axes,
            error: largest as f32 * SHEAR_MARGIN,
        }
    }

    /// Which of a leaf's triangles the ray may meet, a bit each.
    #[inline(always)]
    fn candidates<L: Lanes>(&self, leaf: &Leaf) -> u32 {
        let [x, y, z] = self.axes;
        let (shear_x, shear_y) = (L::F::splat(self.shear[0]), L::F::splat(self.shear[1]));
        let (point_x, point_y, point_z) = (L::F::splat(self.point[x]), L::F::splat(self.point[y]), L::F::splat(self.point[z]));
        let zero = L::F::splat(0.0);
        let error = L::F::splat(self.error);
        let twice_error = error + error;
        let mut across = [[zero; 2]; 3];
        let mut size = [zero; 3];
        for corner in 0..3 {
            let position = &leaf.corners[corner];
            let along = L::F::load(&position[z]) - point_z;
            let across_x = L::F::load(&position[x]) - point_x - shear_x * along;
            let across_y = L::F::load(&position[y]) - point_y - shear_y * along;
            across[corner] = [across_x, across_y];
            size[corner] = across_x.max(zero - across_x) + across_y.max(zero - across_y) + error;
        }
        let [[ax, ay], [bx, by], [cx, cy]] = across;
        let [a, b, c] = size;
        let (w0, e0) = (cx * by - cy * bx, twice_error * (b + c));
        let (w1, e1) = (ax * cy - ay * cx, twice_error * (c + a));
        let (w2, e2) = (bx * ay - by * ax, twice_error * (a + b));
        let is_outside_left = (w0 + e0).min((w1 + e1).min(w2 + e2)).less(zero);
        let is_outside_right = zero.less((w0 - e0).max((w1 - e1).max(w2 - e2)));
        !(is_outside_left & is_outside_right).negative_bits() & ((1 << LANES) - 1)
    }
}

impl<A: FnMut(&Hit) -> bool, const ANY: bool> Kernel for Walk<'_, A, ANY> {
    type Output = Option<Hit>;

    #[inline(always)]
    fn run<L: Lanes, M: MultiplyAdd>(self) -> Option<Hit> {
        let Self { structure, stack, ray, mut accept } = self;
        let mut end = (ray.end() as f32).next_up();
        if !(end > 0.0) {
            return None;
        }
        let largest = f64::from(structure.extent).max(ray.origin().abs().max_element());
        let boxes = BoxRay::new(&ray, largest);
        // Many rays pass by all there is, and need nothing more.
        let root = boxes.enter::<L>(&structure.nodes[0], end);
        if root.0 == 0 {
            return None;
        }
        let mut of_root = Some(root);
        let mut sheared = ShearedRay::new(ray);
        let corners = CornerRay::new(&sheared, largest);
        let mut best: Option<Hit> = None;
        stack.clear();
        let mut current = 0;
        loop {
            if current & LEAF == 0 {
                let node = &structure.nodes[current as usize];
                let (mut mask, near) = match of_root.take() {
                    Some(entered) => entered,
                    None => boxes.enter::<L>(node, end),
                };
                if mask != 0 {
                    let first = mask.trailing_zeros() as usize;
                    mask &= mask - 1;
                    current = node.children[first];
                    if mask != 0 {
                        let mut nears = [0.0; LANES];
                        near.store(&mut nears);
                        let mut nearest = nears[first];
                        let waiting = stack.len();
                        while mask != 0 {
                            let lane = mask.trailing_zeros() as usize;
                            mask &= mask - 1;
                            let (mut child, mut distance) = (node.children[lane], nears[lane]);
                            if distance < nearest {
                                core::mem::swap(&mut child, &mut current);
                                core::mem::swap(&mut distance, &mut nearest);
                            }
                            stack.push((child, distance));
                            // What begins nearer is entered first, and may spare the rest.
                            let mut place = stack.len() - 1;
                            while !ANY && place > waiting && stack[place - 1].1 < stack[place].1 {
                                stack.swap(place - 1, place);
                                place -= 1;
                            }
                        }
                    }
                    continue;
                }
            } else {
                let leaf = &structure.leaves[(current & !LEAF) as usize];
                let mut mask = corners.candidates::<L>(leaf);
                while mask != 0 {
                    let lane = mask.trailing_zeros() as usize;
                    mask &= mask - 1;
                    let triangle = leaf.triangle[lane];
                    if triangle == NO_LANE {
                        break;
                    }
                    if triangle == ray.left() {
                        continue;
                    }
                    let exact = [leaf.corner(0, lane), leaf.corner(1, lane), leaf.corner(2, lane)];
                    let Some(hit) = sheared.meet(triangle, exact) else { continue };
                    // Of two triangles at the same distance the lower index is seen.
                    let is_behind = best.is_some_and(|best| hit.distance == best.distance && hit.triangle > best.triangle);
                    if !is_behind && accept(&hit) {
                        if ANY {
                            return Some(hit);
                        }
                        best = Some(hit);
                        sheared.nearest = hit.distance;
                        end = end.min((hit.distance as f32).next_up());
                    }
                }
            }
            // What begins behind the best hit has been overtaken by it.
            current = loop {
                match stack.pop() {
                    Some((child, near)) if ANY || near <= end * END_MARGIN => break child,
                    Some(_) => {}
                    None => return best,
                }
            };
        }
    }
}
