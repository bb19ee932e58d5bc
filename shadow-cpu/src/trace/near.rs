//! Rays that pass a triangle so closely that a renderer, which rounds its corners, may see them meet.
//!
//! A triangle whose corners move by up to `radius` across a ray stays within its box made larger by that, and each of its edges within that distance of
//! where it was. So it can only come to meet the ray if the box does, and if the ray passes each edge on the inside or nearer than that.

use glam::{DVec2, DVec3};

use super::{
    ray::{Hit, Ray},
    structure::{LEAF, NO_LANE, Node, Structure},
    triangle::ShearedRay,
};
use crate::kernel::LANES;

/// How far from a ray corners may be moved: at its beginning and at its end, in metres; between them in proportion. A ray without an end keeps the
/// first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance {
    /// At the ray's origin.
    pub at_origin: f64,
    /// At its end.
    pub at_end: f64,
}

impl Clearance {
    fn at(self, distance: f64, end: f64) -> f64 {
        if end < f64::INFINITY { self.at_origin + (self.at_end - self.at_origin) * (distance / end) } else { self.at_origin }
    }
}

/// Eight directions around a place in a plane, such as a ray seen along itself.
pub(crate) const AROUND: [[f64; 2]; 8] =
    [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [-1.0, 0.0], [1.0, 0.0], [0.0, -1.0], [0.0, 1.0]];

/// Whether a triangle that matters comes within `clearance` of a ray, and is there. Rays are few here: boxes are taken one after the other.
///
/// `is_there` is told where the ray itself meets a triangle and, where
/// it goes through a hole, where rays beside it do: the hole's outline moves as the corners do. Triangles that the ray passes by are there.
pub(super) fn is_nearly_met(
    structure: &Structure,
    stack: &mut Vec<(u32, f32)>,
    ray: Ray,
    clearance: Clearance,
    matters: impl Fn(&[DVec3; 3]) -> bool,
    is_there: impl Fn(&Hit) -> bool,
) -> bool {
    let sheared = ShearedRay::new(ray);
    let widest = clearance.at_origin.max(clearance.at_end);
    stack.clear();
    stack.push((0, 0.0));
    while let Some((child, _)) = stack.pop() {
        if child & LEAF == 0 {
            let node = &structure.nodes[child as usize];
            let entered = (0..LANES).filter(|&lane| enters(node, lane, ray, widest));
            stack.extend(entered.map(|lane| (node.children[lane], 0.0)));
            continue;
        }
        let leaf = &structure.leaves[(child & !LEAF) as usize];
        for lane in (0..LANES).filter(|&lane| leaf.triangle[lane] != NO_LANE && leaf.triangle[lane] != ray.left()) {
            let corners = [leaf.corner(0, lane), leaf.corner(1, lane), leaf.corner(2, lane)];
            if matters(&corners) && sheared.passes_near(corners, clearance) {
                let Some(hit) = sheared.meet(leaf.triangle[lane], corners) else { return true };
                let radius = clearance.at(hit.distance, ray.end());
                let is_there_beside = |[x, y]: [f64; 2]| {
                    let beside = ShearedRay::new(ray.beside(sheared.across(x * radius, y * radius)));
                    beside.meet(leaf.triangle[lane], corners).is_some_and(|hit| is_there(&hit))
                };
                if is_there(&hit) || AROUND.into_iter().any(is_there_beside) {
                    return true;
                }
            }
        }
    }
    false
}

/// Whether a ray enters a box of a node made larger by `radius`.
fn enters(node: &Node, lane: usize, ray: Ray, radius: f64) -> bool {
    let (mut near, mut far) = (0.0_f64, ray.end());
    for axis in 0..3 {
        let lower = f64::from(node.planes[2 * axis][lane]) - radius - ray.origin()[axis];
        let upper = f64::from(node.planes[2 * axis + 1][lane]) + radius - ray.origin()[axis];
        let direction = ray.direction()[axis];
        if direction == 0.0 {
            if lower > 0.0 || upper < 0.0 {
                return false;
            }
        } else {
            let (a, b) = (lower / direction, upper / direction);
            near = near.max(a.min(b));
            far = far.min(a.max(b));
        }
    }
    near <= far
}

impl ShearedRay {
    /// A step across the ray, by its two lesser axes.
    fn across(&self, x: f64, y: f64) -> DVec3 {
        let mut step = DVec3::ZERO;
        step[self.axes[0]] = x;
        step[self.axes[1]] = y;
        step
    }

    /// Whether a ray passes each edge of a triangle on the inside or within `clearance` of it, before its end.
    fn passes_near(&self, corners: [DVec3; 3], clearance: Clearance) -> bool {
        let [v0, v1, v2] = corners;
        let normal = (v1 - v0).cross(v2 - v0);
        let speed = normal.dot(self.ray.direction());
        let across = corners.map(|corner| DVec2::from(self.shear(corner)));
        let direction = self.ray.direction();
        let along = corners.map(|corner| (corner - self.ray.origin()).dot(direction) / direction.length_squared());
        let (nearest, farthest) = (along[0].min(along[1]).min(along[2]), along[0].max(along[1]).max(along[2]));
        let to_plane = normal.dot(v0 - self.ray.origin()) / speed;
        // Moved to the side, the triangle is met nearer or farther by the cotangent of the angle between ray and plane times as much, between its own nearest and
        // farthest corner: a plane that the ray runs along anywhere between them.
        let widest = clearance.at_origin.max(clearance.at_end) / direction.length();
        let sine = speed.abs() / (normal.length() * direction.length());
        let shift = widest * (1.0 - sine * sine).max(0.0).sqrt() / sine;
        let (first, last) = if shift < f64::INFINITY {
            (nearest.max(to_plane - shift), farthest.min(to_plane + shift))
        } else {
            (nearest, farthest)
        };
        if !(last > 0.0 && first < self.ray.end()) || self.ends_on(corners) {
            return false;
        }
        // Sheared along the direction, a step across the ray becomes longer by at most the direction's length, whose largest component is 1.
        let end = self.ray.end();
        let radius = clearance.at(first.max(0.0), end).max(clearance.at(last.min(end), end)) * direction.length();
        let twice_area = (across[1] - across[0]).perp_dot(across[2] - across[0]);
        let side = if twice_area < 0.0 { -1.0 } else { 1.0 };
        (0..3).all(|i| {
            let (from, to) = (across[i], across[(i + 1) % 3]);
            side * from.perp_dot(to) >= -radius * (to - from).length()
        })
    }
}
