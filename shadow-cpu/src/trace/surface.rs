//! A point of a surface, from which rays go to the lights.
//!
//! The corners of a triangle are exact, and so is its plane; a point of it that is computed as `v0 + u e1 + v e2` is off it by rounding. Each coordinate
//! passes through at most four roundings of numbers no larger than `|v0| + |u e1| + |v e2|`, so that with `2^-53` each the point is off by
//! less than `2^-51` of that, and off the plane by less than the sum over the axes of that times the normal's components (Pharr, Jakob and Humphreys
//! 2023, section 6.8.6). A ray begins that much above the plane, twice over for the rounding of its own beginning.

use glam::DVec3;

use super::ray::Ray;

/// The error of a coordinate, as a share of the sizes that were added up: four roundings.
const POINT_ROUNDING: f64 = 1.0 / (1_u64 << 51) as f64;

/// A point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// The point, in metres relative to the scene's origin.
    pub position: DVec3,
    /// The geometric normal, turned to the viewer, of unit length.
    pub normal: DVec3,
    /// How far above the surface rays begin, in metres.
    pub lift: f64,
    /// The triangle that it lies on, or [`NO_TRIANGLE`](shadow_scene::NO_TRIANGLE) for a point of no triangle's.
    pub triangle: u32,
}

impl SurfacePoint {
    /// The point of a triangle at these weights of its second and third corner, seen along `direction`.
    #[must_use]
    pub(super) fn of_triangle(triangle: u32, [v0, v1, v2]: [DVec3; 3], u: f64, v: f64, direction: DVec3) -> Self {
        let (e1, e2) = (v1 - v0, v2 - v0);
        let position = v0 + e1 * u + e2 * v;
        // Triangles without an area are not in the tree, so there is a normal.
        let normal = e1.cross(e2).normalize_or(DVec3::Y);
        let error = POINT_ROUNDING * (v0.abs() + (e1 * u).abs() + (e2 * v).abs());
        let normal = if normal.dot(direction) > 0.0 { -normal } else { normal };
        Self { position, normal, lift: 2.0 * normal.abs().dot(error), triangle }
    }

    /// Where rays begin that go to the side of the normal.
    #[must_use]
    pub fn above(&self) -> DVec3 {
        self.position + self.normal * self.lift
    }

    /// The ray toward a point; `None` where that lies behind the surface or on its plane.
    #[must_use]
    pub fn toward(&self, target: DVec3) -> Option<Ray> {
        let origin = self.above();
        (self.normal.dot(target - origin) > 0.0).then(|| Ray::between(origin, target).leaving(self.triangle))
    }

    /// The ray in a direction; `None` where that goes into the surface or along it.
    #[must_use]
    pub fn along(&self, direction: DVec3) -> Option<Ray> {
        (self.normal.dot(direction) > 0.0).then(|| Ray::along(self.above(), direction).leaving(self.triangle))
    }
}
