//! Any bytes as arguments of the program: no panic, and what is printed to be typed again means the same.
//!
//! The program has no library; its modules of the command line are compiled here as they are, with the part of the program's error that they
//! make.

#![no_main]
#![forbid(unsafe_code)]
#![allow(dead_code, reason = "the rest of the program uses what this target does not")]

#[path = "../../../shadow-cli/src"]
mod program {
    pub(crate) mod args;
    pub(crate) mod specs;
}

/// The part of the program's errors that its specs make.
mod error {
    /// Why a command cannot be carried out.
    #[derive(Debug, thiserror::Error)]
    pub(crate) enum CliError {
        /// There is no such thing.
        #[error("there is no {kind} {asked}; {}", crate::specs::inventory(kind, names))]
        NoSuch { kind: &'static str, asked: String, names: Vec<String> },
    }
}

use std::ffi::OsString;

use clap::Parser;
use glam::{DVec3, Vec3};
use libfuzzer_sys::fuzz_target;
use shadow_math::{Camera, CameraError, Projection, bounds::Aabb};

// The modules find each other at the crate's root, where the program has them.
use self::program::{args, specs};
use crate::{
    args::{Args, with_hint},
    specs::{
        BackendList, BackendPair, ByteSize, CameraChoice, LightSpec, PictureSize, Selector, Show, bias_metres, bytes_text,
        exposure_value, map_size, seconds, spec_of,
    },
};

/// Scenes that a camera may be in: the origin, and half the size in metres.
const SCENES: [(DVec3, f32); 5] = [
    (DVec3::ZERO, 3.0),
    (DVec3::new(500.0, 0.0, -20.0), 10.0),
    (DVec3::new(6.4e6, 3.0, -2e6), 1000.0),
    (DVec3::ZERO, 1e-4),
    (DVec3::ZERO, 1e9),
];

/// The largest turn, in radians: a pixel at a thousand pixels from the centre. Also the largest share by which an angle of view changes.
const MAX_TURN: f64 = 1e-3;

/// The finest step of an angle of view that is printed, in radians: half of 1e-12 degrees, and the rounding near 180 degrees.
const ANGLE_STEP: f64 = 2e-14;

/// The result of a parser, if there is one; an error can be told in one line, if the text is one.
fn parsed<T, E: std::error::Error>(text: &str, result: Result<T, E>) -> Option<T> {
    match result {
        Ok(value) => Some(value),
        Err(error) => {
            let message = error.to_string();
            assert!(!message.is_empty() && (text.contains('\n') || !message.contains('\n')), "{message:?}");
            None
        }
    }
}

fuzz_target!(|bytes: &[u8]| {
    if bytes.contains(&0) {
        read_arguments(bytes);
    } else if let Ok(text) = std::str::from_utf8(bytes) {
        read_spec(text);
    }
});

/// Reads a command line whose arguments end in zeros.
fn read_arguments(bytes: &[u8]) {
    let arguments = bytes.strip_suffix(&[0]).unwrap_or(bytes).split(|&byte| byte == 0).map(os_string);
    if let Err(usage) = Args::try_parse_from(std::iter::once("shadow".into()).chain(arguments)).and_then(Args::into_command) {
        assert!(!with_hint(usage).to_string().is_empty());
    }
}

/// Reads a text as each of the small languages.
fn read_spec(text: &str) {
    if let Some(size) = parsed(text, text.parse::<PictureSize>()) {
        assert_eq!(format!("{}x{}", size.width, size.height).parse(), Ok(size));
    }
    if let Some(size) = parsed(text, map_size(text)) {
        assert_eq!(map_size(&size.to_string()), Ok(size));
    }
    if let Some(ByteSize(size)) = parsed(text, text.parse()) {
        assert!(size > 0 && !bytes_text(size).is_empty());
        assert_eq!(size.to_string().parse(), Ok(ByteSize(size)));
    }
    if let Some(Show::Visibility(selector) | Show::ShadowMap(selector, _)) = parsed(text, text.parse()) {
        find(&selector);
    }
    if let Some(pair) = parsed(text, text.parse::<BackendPair>()) {
        assert_ne!(pair.first, pair.second);
    }
    if let Some(BackendList(list)) = parsed(text, text.parse()) {
        assert!((1..=2).contains(&list.len()));
    }
    parsed(text, bias_metres(text));
    parsed(text, exposure_value(text));
    parsed(text, seconds(text));
    if let Some(light) = parsed(text, text.parse::<LightSpec>()) {
        assert_eq!(light.text, text);
        for (origin, _) in SCENES {
            parsed(text, light.to_light(origin).validate());
        }
    }
    match parsed(text, text.parse()) {
        Some(CameraChoice::Selected(selector)) => find(&selector),
        Some(CameraChoice::Placed(camera)) => print_camera(|origin, radius| camera.to_camera(origin, radius)),
        None => {}
    }
}

#[cfg(unix)]
fn os_string(bytes: &[u8]) -> OsString {
    std::os::unix::ffi::OsStringExt::from_vec(bytes.to_vec())
}

#[cfg(not(unix))]
fn os_string(bytes: &[u8]) -> OsString {
    String::from_utf8_lossy(bytes).into_owned().into()
}

/// What is found has the number or the name that was asked for.
fn find(selector: &Selector) {
    let names = ["sun", "", "lamp"].map(String::from);
    let found = selector.find("light", &names);
    match (selector, &found) {
        (Selector::Index(index), Ok(found)) => assert_eq!(index, found),
        (Selector::Name(name), Ok(found)) => assert_eq!(*name, names[*found]),
        (_, Err(error)) => assert!(!error.to_string().is_empty()),
    }
}

/// Prints a camera, given for each origin and radius, as `shadow plan` does. What is printed is a camera that shows the same, and
/// can be printed again.
fn print_camera(camera: impl Fn(DVec3, f64) -> Result<Camera, CameraError>) {
    for (origin, half_size) in SCENES {
        let bounds = Aabb::new(Vec3::splat(-half_size), Vec3::splat(half_size));
        let radius = f64::from(bounds.radius());
        let Ok(camera) = camera(origin, radius) else { continue };
        let Some(written) = spec_of(&camera, origin, bounds) else { continue };
        let Ok(CameraChoice::Placed(read)) = written.text.parse() else { panic!("`{}` is no camera", written.text) };
        let read = read.to_camera(origin, radius).unwrap_or_else(|error| panic!("{}: {error}", written.text));
        assert_same(&read, &camera, origin, radius, &written.text);
        if written.is_level {
            let roll = (read.orientation * DVec3::X - camera.orientation * DVec3::X).length();
            assert!(roll <= MAX_TURN, "{}: the camera rolls by {roll}", written.text);
        }
        let again = spec_of(&read, origin, bounds).map(|written| written.text);
        assert!(again.is_some(), "{} is printed once and not again", written.text);
    }
}

/// That a camera which was printed and read is the camera.
fn assert_same(read: &Camera, camera: &Camera, origin: DVec3, radius: f64, text: &str) {
    /// The largest shift of the eye, as a share of the scene's radius or of its distance from zero, in which numbers round.
    const MAX_SHIFT: f64 = 2e-6;
    let shift = (read.eye - camera.eye).length();
    let size = radius.max(1e-6 * camera.eye.length()).max(1e-6 * origin.length());
    assert!(shift <= MAX_SHIFT * size, "{text}: the eye moves by {shift} m");
    let turn = (read.direction() - camera.direction()).length();
    assert!(turn <= MAX_TURN, "{text}: the direction turns by {turn}");
    let (Projection::Perspective { vertical_fov: a, .. }, Projection::Perspective { vertical_fov: b, .. }) =
        (read.projection, camera.projection)
    else {
        panic!("{text}: a camera of the command line is perspective")
    };
    let narrow = b.min(core::f64::consts::PI - b);
    assert!((a - b).abs() <= MAX_TURN * narrow + ANGLE_STEP, "{text}: the angle of view was {b} and is {a}");
}
