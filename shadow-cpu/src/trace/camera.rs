//! The rays of a camera, from its pose: no matrix takes part.

use glam::DVec3;
use shadow_math::{Camera, Projection};

use super::ray::Ray;

/// A camera's view of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraView {
    camera: Camera,
    width: u32,
    height: u32,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
}

impl CameraView {
    /// The view of a picture of `width` x `height` pixels, both at least 1.
    #[must_use]
    pub fn new(camera: &Camera, width: u32, height: u32) -> Self {
        let axis = |axis: DVec3| camera.orientation * axis;
        Self { camera: *camera, width, height, right: axis(DVec3::X), up: axis(DVec3::Y), forward: axis(DVec3::NEG_Z) }
    }

    /// Width of the picture in pixels.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height of the picture in pixels.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The ray through the centre of pixel (x, y), counted from the top left, from the near plane to the far plane.
    #[must_use]
    pub fn ray(&self, x: u32, y: u32) -> Ray {
        let (width, height) = (f64::from(self.width), f64::from(self.height));
        // From -1 to 1, y up, and then in halves of the picture's height.
        let across = (2.0 * (f64::from(x) + 0.5) / width - 1.0) * (width / height);
        let upward = 1.0 - 2.0 * (f64::from(y) + 0.5) / height;
        match self.camera.projection {
            Projection::Perspective { vertical_fov, near, far } => {
                let half = (0.5 * vertical_fov).tan();
                let direction = self.forward + (self.right * across + self.up * upward) * half;
                let origin = self.camera.eye + direction * near;
                far.map_or_else(|| Ray::along(origin, direction), |far| Ray::between(origin, origin + direction * (far - near)))
            }
            Projection::Orthographic { half_height, near, far } => {
                let eye = self.camera.eye + (self.right * across + self.up * upward) * half_height;
                Ray::between(eye + self.forward * near, eye + self.forward * far)
            }
        }
    }

    /// The reversed depth of a point, as frames have it: 1 at the near plane, 0 at the far plane or infinitely far away.
    #[must_use]
    pub fn reversed_depth(&self, point: DVec3) -> f64 {
        let distance = (point - self.camera.eye).dot(self.forward);
        match self.camera.projection {
            Projection::Perspective { near, far: None, .. } => near / distance,
            Projection::Perspective { near, far: Some(far), .. } => near * (far - distance) / (distance * (far - near)),
            Projection::Orthographic { near, far, .. } => (far - distance) / (far - near),
        }
    }
}
