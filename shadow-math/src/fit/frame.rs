//! The frame of a light's camera before anything is fitted: where it is and where it looks.

use glam::{DMat4, DQuat, DVec2, DVec3, DVec4, Vec3};

use super::uniform::rigid_inverse;
use crate::camera::world_from_view_rotation;

/// A light's pose and what it can reach. Its image is the plane at a distance of 1 m before a light at a place, with tangents as coordinates, and any plane across parallel light, with
/// metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightFrame {
    /// From view to world space; the view looks along -z.
    pub rotation: DQuat,
    /// Where the light is, in metres relative to the scene's origin; zero for parallel light.
    pub eye: DVec3,
    /// Whether the light is at a place.
    pub is_perspective: bool,
    /// Half the width of the image that the light can reach, as a tangent; infinite for parallel light.
    pub reach: f64,
    /// The distance beyond which there is no light, in metres; infinite for none.
    pub limit: f64,
}

/// A rectangle of a light's image, with sides along the image's axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// The corner with the smallest coordinates.
    pub min: DVec2,
    /// The corner with the largest coordinates.
    pub max: DVec2,
}

impl Window {
    /// The smallest one around some points; `None` around none.
    #[must_use]
    pub fn around(points: impl IntoIterator<Item = DVec2>) -> Option<Self> {
        let empty = Self { min: DVec2::INFINITY, max: DVec2::NEG_INFINITY };
        let around = points.into_iter().fold(empty, |around, p| Self { min: around.min.min(p), max: around.max.max(p) });
        (around.min.is_finite() && around.max.is_finite()).then_some(around)
    }

    /// The midpoint.
    #[must_use]
    pub fn center(self) -> DVec2 {
        0.5 * (self.min + self.max)
    }

    /// Half the width and height.
    #[must_use]
    pub fn half(self) -> DVec2 {
        0.5 * (self.max - self.min)
    }

    /// The rectangle with the same midpoint, so many times as wide and as high.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        let (center, half) = (self.center(), factor * self.half());
        Self { min: center - half, max: center + half }
    }
}

impl LightFrame {
    /// The frame of parallel light that travels along `direction`, of any length above 0.
    #[must_use]
    pub fn parallel(direction: Vec3) -> Self {
        let rotation = world_from_view_rotation(direction.as_dvec3().normalize());
        Self { rotation, eye: DVec3::ZERO, is_perspective: false, reach: f64::INFINITY, limit: f64::INFINITY }
    }

    /// The frame of a light at `position` that looks along `direction`, of any length above 0, and reaches points whose tangents are at most `reach`, within `limit` metres.
    #[must_use]
    pub fn perspective(position: Vec3, direction: DVec3, reach: f64, limit: f64) -> Self {
        let rotation = world_from_view_rotation(direction.normalize());
        Self { rotation, eye: position.as_dvec3(), is_perspective: true, reach, limit }
    }

    /// The same light, turned about its axis so that `up`, a unit vector of its image, becomes the image's y axis.
    #[must_use]
    pub fn rolled(&self, up: DVec2) -> Self {
        // The turn takes y to `up`, and so x to `up` turned back by a quarter.
        let x = self.rotation * DVec3::new(up.y, -up.x, 0.0);
        let y = self.rotation * DVec3::new(up.x, up.y, 0.0);
        let z = self.rotation * DVec3::Z;
        Self { rotation: DQuat::from_mat3(&glam::DMat3::from_cols(x, y, z)).normalize(), ..*self }
    }

    /// From world to view space.
    #[must_use]
    pub fn view_from_world(&self) -> DMat4 {
        rigid_inverse(self.rotation, self.eye)
    }

    /// The light as a homogeneous point: the vector toward parallel light, with a 0, or the position, with a 1.
    #[must_use]
    pub fn light(&self) -> DVec4 {
        if self.is_perspective { self.eye.extend(1.0) } else { (self.rotation * DVec3::Z).extend(0.0) }
    }

    /// Where a point of view space is in the image. It must lie before a light at a place.
    #[must_use]
    pub fn image(&self, view_point: DVec3) -> DVec2 {
        if self.is_perspective { view_point.truncate() / -view_point.z } else { view_point.truncate() }
    }
}
