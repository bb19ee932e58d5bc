//! Cameras as `--camera` describes them.

use std::str::FromStr;

use glam::DVec3;
use shadow_math::{Camera, CameraError, Projection};

use super::{Selector, SpecError, pairs::Pairs};

/// The vertical angle of view of a camera that does not say one, in degrees.
const DEFAULT_FOV_DEGREES: f64 = 45.0;
/// The near plane of a camera of the command line, in metres, in scenes that are not tiny. Reversed depth in floating point is as
/// fine for a near plane of a centimetre as for one of a metre.
const NEAR_METRES: f64 = 0.01;
/// The near plane is never farther than this share of the scene's radius.
const NEAR_SHARE: f64 = 1e-3;

/// A camera as it was typed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum CameraChoice {
    /// One of the scene's.
    Selected(Selector),
    /// A camera of its own.
    Placed(CameraSpec),
}

impl FromStr for CameraChoice {
    type Err = SpecError;

    /// A text with an equals sign is a place; any other is a number or a name.
    fn from_str(text: &str) -> Result<Self, SpecError> {
        if !text.contains('=') {
            return Ok(Self::Selected(Selector::new(text)));
        }
        let pairs = Pairs::parse(text, "a camera", &["eye", "target", "fov"])?;
        Ok(Self::Placed(CameraSpec {
            text: text.into(),
            eye: pairs.vector("eye")?,
            target: pairs.vector("target")?,
            fov_degrees: pairs.optional_number("fov")?.unwrap_or(DEFAULT_FOV_DEGREES),
        }))
    }
}

/// A camera that was placed on the command line: points in metres of the file's world space.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CameraSpec {
    /// What was typed, for messages.
    pub(crate) text: String,
    eye: DVec3,
    target: DVec3,
    /// The vertical angle of view in degrees.
    fov_degrees: f64,
}

impl CameraSpec {
    /// The camera relative to `origin`, a point in metres of the file's world space, for a scene of that radius in metres. It has no far
    /// plane.
    pub(crate) fn to_camera(&self, origin: DVec3, scene_radius: f64) -> Result<Camera, CameraError> {
        let near = (scene_radius * NEAR_SHARE).clamp(f64::from(f32::MIN_POSITIVE), NEAR_METRES);
        let projection = Projection::Perspective { vertical_fov: self.fov_degrees.to_radians(), near, far: None };
        let camera = Camera::look_at(self.eye - origin, self.target - origin, projection)?;
        camera.validate()?;
        Ok(camera)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cameras_are_chosen_or_placed() {
        assert_eq!("1".parse(), Ok(CameraChoice::Selected(Selector::Index(1))));
        assert_eq!("main".parse(), Ok(CameraChoice::Selected(Selector::Name("main".into()))));
        let Ok(CameraChoice::Placed(spec)) = "eye=1001,2,3;target=1001,2,0".parse() else { panic!("not placed") };
        let camera = spec.to_camera(DVec3::new(1000.0, 0.0, 0.0), 1.0).unwrap();
        assert_eq!(camera.eye, DVec3::new(1.0, 2.0, 3.0));
        assert!((camera.direction() - DVec3::NEG_Z).length() < 1e-12);
        let Projection::Perspective { vertical_fov, near, far } = camera.projection else { panic!("not perspective") };
        assert!((vertical_fov - core::f64::consts::FRAC_PI_4).abs() < 1e-12);
        assert_eq!((near, far), (1e-3, None));
    }

    #[test]
    fn wrong_cameras_are_told_what_a_camera_takes() {
        let error = |text: &str| text.parse::<CameraChoice>().unwrap_err().to_string();
        assert_eq!(error("eye=1,2,3"), "a camera needs `target`; it takes: eye, target, fov");
        assert_eq!(error("eye=1,2,3;at=0,0,0"), "a camera has no `at`; it takes: eye, target, fov");
        let place = |text: &str| match text.parse() {
            Ok(CameraChoice::Placed(spec)) => spec.to_camera(DVec3::ZERO, 1.0),
            other => panic!("{other:?}"),
        };
        assert_eq!(place("eye=1,2,3;target=1,2,3"), Err(CameraError::Direction));
        assert!(matches!(place("eye=1,2,3;target=0,0,0;fov=180"), Err(CameraError::FieldOfView(_))));
    }
}
