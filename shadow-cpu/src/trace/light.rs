//! Rays from a surface toward a light, or to points spread over it.
//!
//! A light that has a size is seen as a flat figure: a directional light as a disc across its direction, a sphere as the disc
//! that its outline fills, a rectangle as itself. Visibility is the share of the figure's area that is not hidden.

use core::f64::consts::PI;

use glam::{DVec2, DVec3};
use shadow_math::{LightKind, LightShape, bounds::Aabb};
use shadow_scene::SceneLight;

use super::{ray::Ray, surface::SurfacePoint};

/// The ray from a surface toward the middle of a light; `None` where the surface does not face it.
pub(super) fn ray_to_center(point: &SurfacePoint, light: &SceneLight) -> Option<Ray> {
    match light.light.kind {
        LightKind::Directional { direction } => point.along(-direction.as_dvec3()),
        LightKind::Spot { position, .. } | LightKind::Point { position, .. } => point.toward(position.as_dvec3()),
    }
}

/// The ray of a light's middle through a point, from where it has met nothing of a scene within `bounds`.
pub(super) fn ray_from_center(point: DVec3, light: &SceneLight, bounds: Aabb) -> Ray {
    match light.light.kind {
        LightKind::Directional { direction } => {
            let outside = 2.0 * (f64::from(bounds.radius()) + point.distance(bounds.center().as_dvec3()));
            let direction = direction.as_dvec3();
            Ray::along(point - direction.normalize() * outside, direction)
        }
        LightKind::Spot { position, .. } | LightKind::Point { position, .. } => {
            let position = position.as_dvec3();
            Ray::along(position, point - position)
        }
    }
}

/// What a light looks like from a point.
pub(super) enum Figure {
    /// A place without a size, or a point inside the light.
    Dot,
    /// Directions `center + right x + up y` with (x, y) in the unit disc, without an end.
    Sky { center: DVec3, right: DVec3, up: DVec3 },
    /// Points `center + right x + up y` with (x, y) in the unit disc, and the sphere of which this is the outline.
    Sphere { position: DVec3, radius: f64, center: DVec3, right: DVec3, up: DVec3 },
    /// Points `center + right x + up y` with x and y from -1 to 1.
    Rectangle { center: DVec3, right: DVec3, up: DVec3 },
}

impl Figure {
    pub(super) fn new(point: DVec3, light: &SceneLight) -> Self {
        match (light.shape, light.light.kind) {
            (LightShape::Disc { angular_diameter }, LightKind::Directional { direction }) => {
                let center = -direction.as_dvec3().normalize_or_zero();
                let radius = (0.5 * f64::from(angular_diameter)).tan();
                let (right, up) = center.any_orthonormal_pair();
                Self::Sky { center, right: right * radius, up: up * radius }
            }
            (LightShape::Sphere { radius }, LightKind::Spot { position, .. } | LightKind::Point { position, .. }) => {
                let (position, radius) = (position.as_dvec3(), f64::from(radius));
                let toward = position - point;
                let distance = toward.length();
                if distance <= radius {
                    return Self::Dot;
                }
                // The outline is a circle nearer than the centre: where the tangents from the point touch the sphere.
                let share = 1.0 - (radius / distance) * (radius / distance);
                let (right, up) = (toward / distance).any_orthonormal_pair();
                let outline = radius * share.sqrt();
                Self::Sphere { position, radius, center: point + toward * share, right: right * outline, up: up * outline }
            }
            (LightShape::Rectangle { half_width, half_height }, LightKind::Spot { position, .. }) => {
                Self::Rectangle { center: position.as_dvec3(), right: half_width.as_dvec3(), up: half_height.as_dvec3() }
            }
            _ => Self::Dot,
        }
    }

    /// The ray to the point of the figure that belongs to `sample`, each coordinate from 0 to 1: equal areas there are equal areas of the figure.
    /// `None` where the surface does not face it.
    pub(super) fn ray(&self, point: &SurfacePoint, light: &SceneLight, sample: DVec2) -> Option<Ray> {
        match *self {
            Self::Dot => ray_to_center(point, light),
            Self::Sky { center, right, up } => {
                let at = disc(sample);
                point.along(center + right * at.x + up * at.y)
            }
            Self::Sphere { position, radius, center, right, up } => {
                let at = disc(sample);
                let through = center + right * at.x + up * at.y;
                // The ray ends where it enters the sphere: what is inside the light does not hide it.
                let direction = through - point.position;
                let middle = direction.dot(position - point.position) / direction.length_squared();
                let off_center = (point.position + direction * middle - position).length_squared();
                let before = (radius * radius - off_center).max(0.0).sqrt() / direction.length();
                point.toward(point.position + direction * (middle - before))
            }
            Self::Rectangle { center, right, up } => {
                let at = 2.0 * sample - DVec2::ONE;
                point.toward(center + right * at.x + up * at.y)
            }
        }
    }
}

/// The point of the unit disc that belongs to a point of the unit square, equal areas to equal areas (Shirley and Chiu 1997).
fn disc(sample: DVec2) -> DVec2 {
    let square = 2.0 * sample - DVec2::ONE;
    if square == DVec2::ZERO {
        return DVec2::ZERO;
    }
    let (radius, angle) = if square.x.abs() > square.y.abs() {
        (square.x, PI / 4.0 * (square.y / square.x))
    } else {
        (square.y, PI / 2.0 - PI / 4.0 * (square.x / square.y))
    };
    radius * DVec2::from_angle(angle)
}

/// The point of one cell among `side` x `side`, jittered within it: a number for each pixel, light and cell, always the same.
pub(super) fn stratified(side: u32, cell: u32, seed: u64) -> DVec2 {
    let random = scramble(seed ^ (u64::from(cell) + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    let unit = |bits: u32| f64::from(bits) / (f64::from(u32::MAX) + 1.0);
    let within = DVec2::new(unit(random as u32), unit((random >> 32) as u32));
    (DVec2::new(f64::from(cell % side), f64::from(cell / side)) + within) / f64::from(side)
}

/// A number in which every bit depends on every bit of `x`: the finaliser of SplitMix64 (Steele, Lea and Flood 2014).
pub(super) fn scramble(x: u64) -> u64 {
    let x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ x >> 31
}
