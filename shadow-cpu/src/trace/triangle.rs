//! Does a ray meet a triangle, and how far away?
//!
//! Whether it does is decided as by Woop, Benthin and Wald ("Watertight Ray/Triangle Intersection", JCGT 2013): the corners are sheared so
//! that the ray becomes an axis, and the signs of three edge functions say on which side of each edge it passes. Each corner is sheared
//! alike in all its triangles, and an edge function is a difference of two products, whose sign rounding can turn to 0 but never over; 0 counts as inside.
//! So no ray slips through a shared edge or corner.
//!
//! How far is a matter of the triangle's plane, `-(n . (o - v0)) / (n . d)`: with the corners exact, the error is known. Let `u = 2^-53`. The six
//! products in `n . a` with `n = e1 x e2` and `a = o - v0` each pass through at most seven roundings, so that the error is at most
//! `8 u |e1| |e2| |a|` in norms that bound every product. A plane nearer to the origin than that is not in the ray's way: it is the surface on which the
//! origin lies, or one that continues it.

use glam::DVec3;

use super::ray::{Hit, Ray};

/// The bound on rounding of a point's distance from a plane, as a factor of `|e1| |e2| |a|`: eight roundings of `2^-53`.
const PLANE_ROUNDING: f64 = 1.0 / (1_u64 << 50) as f64;

/// A ray with what every triangle asks of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShearedRay {
    pub(super) ray: Ray,
    /// The axes that become x, y and z: z is the longest of the direction.
    pub(super) axes: [usize; 3],
    /// What is taken off x and y for each step along z.
    pub(super) shear: [f64; 2],
    /// The distance of the nearest hit so far, in units of the direction; the ray's end before there is one.
    pub(super) nearest: f64,
}

impl ShearedRay {
    #[inline(always)]
    pub(super) fn new(ray: Ray) -> Self {
        let direction = ray.direction();
        let size = direction.abs();
        let z = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        // The longest component is 1 or -1, so that these products are quotients, and exact.
        let shear = [direction[x] * direction[z], direction[y] * direction[z]];
        Self { ray, axes: [x, y, z], shear, nearest: ray.end() }
    }

    /// A corner in the plane in which the ray is the origin: how far to the side of the ray it lies, sheared.
    #[inline(always)]
    pub(super) fn shear(&self, corner: DVec3) -> [f64; 2] {
        let a = corner - self.ray.origin();
        let [x, y, z] = self.axes;
        [a[x] - self.shear[0] * a[z], a[y] - self.shear[1] * a[z]]
    }

    /// Where the ray meets a triangle between its origin and its end, neither of them included by as much as rounding could move them, and
    /// no farther away than the nearest hit so far.
    ///
    /// The edges and corners belong to the triangle. A triangle seen edge-on is not met: its neighbours are.
    #[inline(always)]
    pub(super) fn meet(&self, triangle: u32, [v0, v1, v2]: [DVec3; 3]) -> Option<Hit> {
        let (a, b, c) = (self.shear(v0), self.shear(v1), self.shear(v2));
        let w0 = c[0] * b[1] - c[1] * b[0];
        let w1 = a[0] * c[1] - a[1] * c[0];
        let w2 = b[0] * a[1] - b[1] * a[0];
        if (w0 < 0.0 || w1 < 0.0 || w2 < 0.0) && (w0 > 0.0 || w1 > 0.0 || w2 > 0.0) {
            return None;
        }
        let sum = w0 + w1 + w2;
        if sum == 0.0 {
            return None;
        }
        let (e1, e2) = (v1 - v0, v2 - v0);
        let normal = e1.cross(e2);
        let from_plane = self.ray.origin() - v0;
        let above = normal.dot(from_plane);
        let rounding = PLANE_ROUNDING * one_norm(e1) * one_norm(e2) * from_plane.abs().max_element();
        let speed = normal.dot(self.ray.direction());
        let distance = -above / speed;
        if above.abs() <= rounding || !(distance > 0.0 && distance <= self.nearest) {
            return None;
        }
        if self.ends_on([v0, v1, v2]) {
            return None;
        }
        Some(Hit { triangle, distance, u: w1 / sum, v: w2 / sum, is_back: speed > 0.0 })
    }
}

impl ShearedRay {
    /// Whether the ray ends on a triangle's plane, as far as rounding can tell: a light may lie on a surface, which then does not stand in the way.
    #[inline(always)]
    pub(super) fn ends_on(&self, [v0, v1, v2]: [DVec3; 3]) -> bool {
        let end = self.ray.end();
        if end == f64::INFINITY {
            return false;
        }
        let (e1, e2) = (v1 - v0, v2 - v0);
        let normal = e1.cross(e2);
        let from_plane = self.ray.origin() - v0;
        let to_end = from_plane.abs().max_element() + end;
        let above_at_end = normal.dot(from_plane) + end * normal.dot(self.ray.direction());
        above_at_end.abs() <= PLANE_ROUNDING * one_norm(e1) * one_norm(e2) * to_end
    }
}

/// The sum of a vector's components: with it every product of a cross product is bounded.
#[inline(always)]
fn one_norm(v: DVec3) -> f64 {
    let v = v.abs();
    v.x + v.y + v.z
}
