//! The camera: a pose and a projection.

use glam::{DMat4, DQuat, DVec2, DVec3, dcamera::rh};

use crate::spaces::ClipDepth;

/// How a camera maps its view to the picture. The picture's aspect ratio is the viewport's, not the camera's.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum Projection {
    /// Rays from one point.
    Perspective {
        /// The vertical angle of view in radians, between 0 and pi.
        vertical_fov: f64,
        /// The distance to the near plane in metres, above 0.
        near: f64,
        /// The distance to the far plane in metres, above `near`; `None` for none.
        far: Option<f64>,
    },
    /// Parallel rays.
    Orthographic {
        /// Half the height of the view in metres, above 0.
        half_height: f64,
        /// The distance to the near plane in metres, at least 0.
        near: f64,
        /// The distance to the far plane in metres, above `near`.
        far: f64,
    },
}

/// A camera in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Camera {
    /// The eye, in metres relative to the scene's origin.
    pub eye: DVec3,
    /// The rotation from view to world space, of unit length: the camera looks along `orientation * -z`.
    pub orientation: DQuat,
    /// The projection.
    pub projection: Projection,
}

/// Why a camera cannot be used.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum CameraError {
    /// The vertical angle of view, in radians, is not between 0 and pi.
    FieldOfView(f64),
    /// The near and far planes do not enclose a range.
    Planes {
        /// The distance to the near plane in metres.
        near: f64,
        /// The distance to the far plane in metres; infinite for none.
        far: f64,
    },
    /// Half the height of an orthographic view is not a positive number of metres.
    HalfHeight(f64),
    /// The eye or the orientation is not finite, or the orientation is not of unit length.
    Pose,
    /// The eye and the target are the same point, or the view direction is not finite.
    Direction,
}

impl core::fmt::Display for CameraError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::FieldOfView(angle) => {
                write!(f, "the camera's vertical field of view is {} degrees; it must lie between 0 and 180", angle.to_degrees())
            }
            Self::Planes { near, far } => write!(
                f,
                "the camera's near plane at {near} m and far plane at {far} m enclose nothing; near must be positive (or 0 for an orthographic camera) and far beyond it"
            ),
            Self::HalfHeight(half_height) => {
                write!(f, "the orthographic camera is {half_height} m high at half height; it must be a positive number")
            }
            Self::Pose => f.write_str("the camera's position or orientation is not a finite pose"),
            Self::Direction => f.write_str("the camera's eye and target are the same point, so it has no direction to look in"),
        }
    }
}

impl core::error::Error for CameraError {}

impl Camera {
    /// A camera at `eye` that looks at `target` with y up; straight up or down, -z takes the place of up.
    ///
    /// # Errors
    ///
    /// [`CameraError::Direction`] if the two points coincide or are not finite.
    ///
    /// ```
    /// use shadow_math::{Camera, Projection};
    /// use glam::DVec3;
    ///
    /// let projection = Projection::Perspective { vertical_fov: 0.8, near: 0.1, far: None };
    /// let camera = Camera::look_at(DVec3::new(0.0, 2.0, 5.0), DVec3::ZERO, projection)?;
    /// let target_in_view = camera.view_from_world().transform_point3(DVec3::ZERO);
    /// assert!(target_in_view.x.abs() < 1e-12 && target_in_view.z < 0.0);
    /// # Ok::<(), shadow_math::CameraError>(())
    /// ```
    pub fn look_at(eye: DVec3, target: DVec3, projection: Projection) -> Result<Self, CameraError> {
        let direction = (target - eye).try_normalize().ok_or(CameraError::Direction)?;
        Ok(Self { eye, orientation: world_from_view_rotation(direction), projection })
    }

    /// The direction the camera looks in, of unit length.
    #[must_use]
    pub fn direction(&self) -> DVec3 {
        self.orientation * DVec3::NEG_Z
    }

    /// Checks every value that could not be used.
    ///
    /// # Errors
    ///
    /// The first [`CameraError`] that applies.
    pub fn validate(&self) -> Result<(), CameraError> {
        if !self.eye.is_finite() || !self.orientation.is_finite() || !self.orientation.is_normalized() {
            return Err(CameraError::Pose);
        }
        match self.projection {
            Projection::Perspective { vertical_fov, near, far } => {
                if !(vertical_fov > 0.0 && vertical_fov < core::f64::consts::PI) {
                    return Err(CameraError::FieldOfView(vertical_fov));
                }
                let far = far.unwrap_or(f64::INFINITY);
                if !(near > 0.0 && near.is_finite() && far > near) {
                    return Err(CameraError::Planes { near, far });
                }
            }
            Projection::Orthographic { half_height, near, far } => {
                if !(half_height > 0.0 && half_height.is_finite()) {
                    return Err(CameraError::HalfHeight(half_height));
                }
                if !(near >= 0.0 && far > near && far.is_finite()) {
                    return Err(CameraError::Planes { near, far });
                }
            }
        }
        Ok(())
    }

    /// The matrix from world to view space.
    #[must_use]
    pub fn view_from_world(&self) -> DMat4 {
        DMat4::from_rotation_translation(self.orientation, self.eye).inverse()
    }

    /// The matrix from view to clip space with the depth range asked for, for a picture of `aspect` (width over height).
    ///
    /// A perspective camera without a far plane has one at infinity under every range.
    #[must_use]
    pub fn clip_from_view(&self, aspect: f64, depth: ClipDepth) -> DMat4 {
        // The direct range is built first and others derived from it, but for an infinite reversed range, where the
        // subtraction would lose the near plane's digits.
        let zero_to_one = match self.projection {
            Projection::Perspective { vertical_fov, near, far: Some(far) } => {
                rh::proj::directx::perspective(vertical_fov, aspect, near, far)
            }
            Projection::Perspective { vertical_fov, near, far: None } => {
                if depth == ClipDepth::Reversed {
                    return rh::proj::directx::perspective_infinite_reverse(vertical_fov, aspect, near);
                }
                rh::proj::directx::perspective_infinite(vertical_fov, aspect, near)
            }
            Projection::Orthographic { half_height, near, far } => {
                let half_width = half_height * aspect;
                rh::proj::directx::orthographic(-half_width, half_width, -half_height, half_height, near, far)
            }
        };
        depth.zero_to_one_from_clip().inverse() * zero_to_one
    }

    /// Half the width and half the height of the view: in metres at a distance of 1 m for a perspective camera, in
    /// metres everywhere for an orthographic one.
    #[must_use]
    pub fn half_extent(&self, aspect: f64) -> DVec2 {
        let half_height = match self.projection {
            Projection::Perspective { vertical_fov, .. } => {
                #[cfg(not(feature = "std"))]
                use crate::float::FloatFuncs;
                (0.5 * vertical_fov).tan()
            }
            Projection::Orthographic { half_height, .. } => half_height,
        };
        DVec2::new(half_height * aspect, half_height)
    }
}

/// The rotation from a view that looks along `direction` (of unit length) to world space, with y up.
///
/// Where `direction` is within a hundredth of a degree of the vertical, -z takes the place of up, so that the roll is
/// chosen by a rule and not by rounding.
#[must_use]
pub fn world_from_view_rotation(direction: DVec3) -> DQuat {
    /// Sine of the angle to the vertical below which y cannot serve as up.
    const MIN_SINE_TO_UP: f64 = 1.7e-4;
    let horizontal = DVec3::new(direction.x, 0.0, direction.z).length();
    let up = if horizontal < MIN_SINE_TO_UP { DVec3::NEG_Z } else { DVec3::Y };
    let right = direction.cross(up).normalize();
    let true_up = right.cross(direction);
    DQuat::from_mat3(&glam::DMat3::from_cols(right, true_up, -direction))
}
