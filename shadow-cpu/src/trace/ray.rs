//! Rays in double precision, and what they meet.

use glam::DVec3;
use shadow_scene::NO_TRIANGLE;

/// The smallest component of a direction whose largest one is 1 that still moves a ray: a smaller one is taken for 0.
///
/// Over the way through a scene it would move the ray by less than `2^-60` of the scene, far below the margin of the boxes.
const LEAST_COMPONENT: f64 = 1.0 / (1_u64 << 60) as f64;

/// A ray from a point of the scene, with an end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    origin: DVec3,
    direction: DVec3,
    end: f64,
    /// The triangle that it leaves, or [`NO_TRIANGLE`].
    left: u32,
}

impl Ray {
    /// The ray from `origin` along `direction`, without an end. Both are finite, the direction not zero; the origin is in metres
    /// relative to the scene's origin.
    ///
    /// A direction of zero, or one that is not finite, gives a ray that meets nothing.
    #[must_use]
    pub fn along(origin: DVec3, direction: DVec3) -> Self {
        let longest = direction.abs().max_element();
        let end = if direction.is_finite() && longest > 0.0 { f64::INFINITY } else { f64::NEG_INFINITY };
        Self { origin, direction: scaled(direction, longest), end, left: NO_TRIANGLE }
    }

    /// The part of the ray from `origin` toward `target` that lies between the two, both in metres relative to the scene's origin.
    #[must_use]
    pub fn between(origin: DVec3, target: DVec3) -> Self {
        let direction = target - origin;
        let longest = direction.abs().max_element();
        let end = if direction.is_finite() && longest > 0.0 { longest } else { f64::NEG_INFINITY };
        Self { origin, direction: scaled(direction, longest), end, left: NO_TRIANGLE }
    }

    /// The same ray, which leaves this triangle and so does not meet it: a ray meets a plane once.
    #[must_use]
    pub fn leaving(self, triangle: u32) -> Self {
        Self { left: triangle, ..self }
    }

    /// The same ray, moved to the side by `step`.
    pub(super) fn beside(self, step: DVec3) -> Self {
        Self { origin: self.origin + step, ..self }
    }

    /// The triangle that the ray leaves, or [`NO_TRIANGLE`].
    #[must_use]
    pub fn left(&self) -> u32 {
        self.left
    }

    /// Where it begins, in metres relative to the scene's origin.
    #[must_use]
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// Its direction: the largest component is 1 or -1.
    #[must_use]
    pub fn direction(&self) -> DVec3 {
        self.direction
    }

    /// Where it ends, in units of the direction.
    #[must_use]
    pub fn end(&self) -> f64 {
        self.end
    }

    /// The point at a distance in units of the direction.
    #[must_use]
    pub fn at(&self, distance: f64) -> DVec3 {
        self.origin + self.direction * distance
    }
}

/// The direction with a largest component of 1.
fn scaled(direction: DVec3, longest: f64) -> DVec3 {
    let scaled = direction / longest;
    if !scaled.is_finite() {
        return DVec3::X;
    }
    let keep = |component: f64| if component.abs() < LEAST_COMPONENT { 0.0 } else { component };
    DVec3::new(keep(scaled.x), keep(scaled.y), keep(scaled.z))
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The triangle's index in the scene.
    pub triangle: u32,
    /// How far along the ray, in units of its direction.
    pub distance: f64,
    /// The weight of the second corner.
    pub u: f64,
    /// The weight of the third corner; the first has `1 - u - v`.
    pub v: f64,
    /// Whether the ray meets the back: the side from which the corners run clockwise.
    pub is_back: bool,
}
