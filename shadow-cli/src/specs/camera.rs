//! Cameras as `--camera` describes them.

use std::str::FromStr;

use glam::DVec3;
use shadow_math::{Camera, CameraError, Projection, bounds::Aabb};

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

/// A camera of a scene as `--camera` takes it, to be copied and varied.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct WrittenCamera {
    /// The description.
    pub(crate) text: String,
    /// Whether the description shows the same: a camera that is rolled about its axis has none.
    pub(crate) is_level: bool,
}

/// Describes a perspective camera, which lies relative to `origin`, in a scene of these bounds. There is no description of parallel rays,
/// nor of a camera so far away that its direction is lost in the digits of its place.
pub(crate) fn spec_of(camera: &Camera, origin: DVec3, bounds: Aabb) -> Option<WrittenCamera> {
    let Projection::Perspective { vertical_fov, .. } = camera.projection else { return None };
    let radius = f64::from(bounds.radius()).max(f64::from(f32::MIN_POSITIVE));
    // The target is the point of the axis nearest to the middle of the scene, so that moving the eye turns around what is seen.
    let middle = (bounds.center().as_dvec3() - camera.eye).dot(camera.direction());
    let target = camera.eye + camera.direction() * middle.max(0.1 * radius);
    // A millionth of the scene is far less than a pixel, and the last decimal is worth no more.
    let decimals = (6.0 - radius.log10().floor()).clamp(0.0, 12.0) as usize;
    let point = |point: DVec3| (point + origin).to_array().map(|coordinate| shortest(coordinate, decimals)).join(",");
    let fov = angle_text(vertical_fov.to_degrees());
    let text = format!("eye={};target={};fov={fov}", point(camera.eye), point(target));
    // What was written decides: its numbers are rounded, and the roll of a camera that looks down nearly straight hangs on their last digits.
    let Ok(CameraChoice::Placed(read)) = text.parse() else { return None };
    let read = read.to_camera(origin, radius).ok()?;
    /// The largest sine of an angle of turn or roll that nobody sees: 0.06 degrees, a pixel at a thousand pixels from the centre.
    const MAX_TURN: f64 = 1e-3;
    let keeps = |axis: DVec3| (read.orientation * axis - camera.orientation * axis).length() < MAX_TURN;
    if !keeps(DVec3::NEG_Z) {
        return None;
    }
    let is_level = keeps(DVec3::X);
    Some(WrittenCamera { text, is_level })
}

/// An angle of view in degrees, with four decimals; with more where it or what it lacks to 180 degrees would have fewer than four digits.
fn angle_text(degrees: f64) -> String {
    let narrow = degrees.min(180.0 - degrees);
    let decimals = (3.0 - narrow.log10().floor()).clamp(4.0, 12.0);
    shortest(degrees, decimals as usize)
}

/// A number with at most so many decimals and no zeros at the end.
fn shortest(number: f64, decimals: usize) -> String {
    let text = format!("{number:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".into() } else { text.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The place that a description names.
    fn placed(text: &str) -> CameraSpec {
        let place = match text.parse() {
            Ok(CameraChoice::Placed(spec)) => Some(spec),
            _ => None,
        };
        place.expect("a description that begins with `eye=` is a place")
    }

    #[test]
    fn cameras_are_chosen_or_placed() {
        assert_eq!("1".parse(), Ok(CameraChoice::Selected(Selector::Index(1))));
        assert_eq!("main".parse(), Ok(CameraChoice::Selected(Selector::Name("main".into()))));
        let spec = placed("eye=1001,2,3;target=1001,2,0");
        let camera = spec.to_camera(DVec3::new(1000.0, 0.0, 0.0), 1.0).expect("the place is a camera");
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

    #[test]
    fn a_written_camera_is_the_camera() {
        let origin = DVec3::new(500.0, 0.0, -20.0);
        let bounds = Aabb::from_points([glam::Vec3::splat(-3.0), glam::Vec3::splat(3.0)]);
        let projection = Projection::Perspective { vertical_fov: 0.7, near: 0.1, far: Some(100.0) };
        let camera =
            Camera::look_at(DVec3::new(4.0, 2.0, 6.0), DVec3::new(0.1, 1.0, 0.2), projection).expect("the eye is not the target");
        let written = spec_of(&camera, origin, bounds).expect("the camera can be written");
        assert!(written.is_level);
        let spec = placed(&written.text);
        let read = spec.to_camera(origin, f64::from(bounds.radius())).expect("the place is a camera");
        assert!((read.eye - camera.eye).length() < 1e-5, "{}", written.text);
        assert!((read.direction() - camera.direction()).length() < 1e-5, "{}", written.text);
        let Projection::Perspective { vertical_fov, .. } = read.projection else { panic!("not perspective") };
        assert!((vertical_fov - 0.7).abs() < 1e-5);

        let rolled = Camera { orientation: camera.orientation * glam::DQuat::from_rotation_z(0.1), ..camera };
        assert!(!spec_of(&rolled, origin, bounds).expect("the camera can be written").is_level);
        let projection = Projection::Orthographic { half_height: 1.0, near: 0.0, far: 10.0 };
        assert_eq!(spec_of(&Camera { projection, ..camera }, origin, bounds), None);
    }

    /// What is written can be read again, also where rounding could make it nonsense.
    #[test]
    fn an_extreme_camera_is_written_as_what_it_is_or_not_at_all() {
        let bounds = Aabb::from_points([glam::Vec3::splat(-3.0), glam::Vec3::splat(3.0)]);
        let rewritten = |text: &str| {
            let spec = placed(text);
            let radius = f64::from(bounds.radius());
            spec_of(&spec.to_camera(DVec3::ZERO, radius).expect("the camera can be written"), DVec3::ZERO, bounds)
        };
        for fov in ["0.00001", "0.00014", "179.99999", "40.5"] {
            let written = rewritten(&format!("eye=4,2,6;target=0,1,0;fov={fov}")).expect("the camera can be written");
            assert!(written.is_level && written.text.ends_with(&format!("fov={fov}")), "{}", written.text);
        }
        assert_eq!(rewritten("eye=4,2,6;target=0,1,0;fov=1e-20"), None);
        assert_eq!(rewritten("eye=1e20,0,0;target=2e20,1e20,0"), None, "a step of 1e20 in double precision is 16 km");
        // Just above the angle to the vertical at which y cannot be up; rounded, just below it.
        let written = rewritten("eye=0,9,0;target=0.001530004,0,0").expect("the camera can be written");
        assert!(!written.is_level, "{}", written.text);
    }

    #[test]
    fn rounding_moves_the_eye_by_less_than_a_millionth_of_the_scene() {
        let origin = DVec3::new(6.4e6, 3.0, -2e6);
        for half_size in [1e-4, 0.9, 1.1, 3.0, 60.0, 999.0, 1000.0, 1e6] {
            let bounds = Aabb::new(glam::Vec3::splat(-half_size), glam::Vec3::splat(half_size));
            let radius = f64::from(bounds.radius());
            let projection = Projection::Perspective { vertical_fov: 0.8, near: 0.01 * radius, far: None };
            let camera = Camera::look_at(DVec3::splat(radius / 0.7), DVec3::ZERO, projection).expect("the eye is not the target");
            let written = spec_of(&camera, origin, bounds).expect("the camera can be written");
            let read = placed(&written.text);
            let moved = (read.to_camera(origin, radius).expect("the place is a camera").eye - camera.eye).length();
            // Numbers of millions of metres round to a billionth of one.
            assert!(moved < 1e-6 * radius + 1e-9, "{}: {moved} m", written.text);
        }
    }

    #[test]
    fn written_numbers_are_short() {
        assert_eq!((shortest(1.5, 4), shortest(-0.00001, 3), shortest(100.0, 0)), ("1.5".into(), "0".into(), "100".into()));
    }
}
