//! The small languages of the command line: sizes, layers, lights, cameras, scenes and backends. Parsing only: nothing here looks at a
//! scene, but for [`Selector::find`], which is lent the names to choose from.

mod error;
mod pairs;
mod selector;
mod light;
mod camera;
mod units;
mod bytes;

use std::{ffi::OsString, path::PathBuf, str::FromStr};

use clap::ValueEnum;
use shadow_cpu::trace::Sampling;
use shadow_math::settings::{MAX_MAP_SIZE, MIN_MAP_SIZE};

pub(crate) use self::{
    bytes::{ByteSize, bytes_text},
    camera::{CameraChoice, spec_of},
    error::SpecError,
    light::LightSpec,
    selector::{Selector, inventory},
    units::{angle, bias_metres, distance, exposure_value, seconds},
};
use crate::{args::Backend, debug_view::DebugView};

/// The largest width and height of a picture in pixels.
const MAX_PICTURE_SIZE: u32 = 16_384;

/// Width and height of a picture in pixels, each from 1 to 16384.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PictureSize {
    /// The width in pixels.
    pub(crate) width: u32,
    /// The height in pixels.
    pub(crate) height: u32,
}

impl FromStr for PictureSize {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        let side = |text: &str| text.parse::<u64>().ok().filter(|&side| side > 0);
        let sides = text.split_once(['x', 'X']).and_then(|(width, height)| Some((side(width)?, side(height)?)));
        let (width, height) = sides.ok_or_else(|| SpecError::Size(text.into()))?;
        let too_large = |side| SpecError::SizeTooLarge { size: text.into(), side };
        let checked = |side| u32::try_from(side).ok().filter(|&side| side <= MAX_PICTURE_SIZE).ok_or_else(|| too_large(side));
        Ok(Self { width: checked(width)?, height: checked(height)? })
    }
}

/// The value of `--map-size`: texels, within the limits of [`shadow_math::settings`].
pub(crate) fn map_size(text: &str) -> Result<u32, SpecError> {
    let size = text.parse().ok().filter(|size| (MIN_MAP_SIZE..=MAX_MAP_SIZE).contains(size));
    size.ok_or_else(|| SpecError::MapSize(text.into()))
}

/// What `render` draws.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Show {
    /// The picture.
    Color,
    /// How much of a light reaches each pixel.
    Visibility(Selector),
    /// How far away each pixel is.
    Depth,
    /// A shadow map: the light and the number of its view.
    ShadowMap(Selector, usize),
    /// A view that explains the frame, of a light and of one of its views.
    Debug(DebugView, Selector, usize),
}

impl FromStr for Show {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        let (layer, rest) = text.split_once(':').map_or((text, None), |(layer, rest)| (layer, Some(rest)));
        Ok(match (layer, rest) {
            ("color", None) => Self::Color,
            ("depth", None) => Self::Depth,
            ("visibility", light) => Self::Visibility(Selector::new(light.unwrap_or("0"))),
            ("shadow-map", rest) => {
                let (light, view) = rest.map_or(("0", "0"), |rest| rest.split_once(':').unwrap_or((rest, "0")));
                Self::ShadowMap(Selector::new(light), view.parse().map_err(|_| SpecError::View(view.into()))?)
            }
            (name, rest) => {
                let found = DebugView::ALL.into_iter().find(|(known, _)| *known == name);
                let (_, view) = found.ok_or_else(|| SpecError::Layer(text.into()))?;
                let (light, number) = match rest {
                    None => ("0", "0"),
                    Some(rest) if view.is_of_view() => rest.split_once(':').unwrap_or((rest, "0")),
                    Some(rest) if view.is_of_light() => (rest, "0"),
                    Some(_) => return Err(SpecError::Layer(text.into())),
                };
                Self::Debug(view, Selector::new(light), number.parse().map_err(|_| SpecError::View(number.into()))?)
            }
        })
    }
}

/// The most samples that a light with a size may take.
pub(crate) const MAX_LIGHT_SAMPLES: u32 = 4096;

/// How many rays are sent to a light that has a size: a square number.
pub(crate) fn light_samples(text: &str) -> Result<Sampling, SpecError> {
    let failed = || SpecError::LightSamples(text.into());
    let given = text.parse::<u32>().ok().filter(|given| (1..=MAX_LIGHT_SAMPLES).contains(given)).ok_or_else(failed)?;
    let side = given.isqrt();
    if side * side == given {
        return Ok(Sampling { side });
    }
    Err(SpecError::LightSamplesNotSquare { given, below: side * side, above: (side + 1) * (side + 1) })
}

/// Where a scene comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum SceneSource {
    /// The built-in scene of that name.
    Builtin(String),
    /// A file.
    File(PathBuf),
}

impl From<OsString> for SceneSource {
    /// Paths need not be Unicode.
    fn from(text: OsString) -> Self {
        match text.to_str().and_then(|text| text.strip_prefix("builtin:")) {
            Some(name) => Self::Builtin(name.into()),
            None => Self::File(text.into()),
        }
    }
}

/// Two different backends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BackendPair {
    /// The first.
    pub(crate) first: Backend,
    /// The second, not the same.
    pub(crate) second: Backend,
}

impl FromStr for BackendPair {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        let failed = || SpecError::Backends(text.into());
        let backends = text.split(',').map(|name| Backend::from_str(name.trim(), false)).collect::<Result<Vec<_>, _>>();
        match backends.map_err(|_| failed())?[..] {
            [first, second] if first == second => Err(SpecError::SameBackend),
            [Backend::Trace, _] | [_, Backend::Trace] => Err(SpecError::CompareTrace),
            [first, second] => Ok(Self { first, second }),
            _ => Err(failed()),
        }
    }
}

/// Some of the backends, in the order in which they were named.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct BackendList(pub(crate) Vec<Backend>);

impl FromStr for BackendList {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        let failed = || SpecError::BackendList(text.into());
        let backends = text.split(',').map(|name| Backend::from_str(name.trim(), false)).collect::<Result<Vec<_>, _>>();
        let backends = backends.map_err(|_| failed())?;
        let is_repeated = backends.iter().enumerate().any(|(index, backend)| backends[..index].contains(backend));
        if is_repeated { Err(failed()) } else { Ok(Self(backends)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!("1280x720".parse(), Ok(PictureSize { width: 1280, height: 720 }));
        assert_eq!("1X16384".parse(), Ok(PictureSize { width: 1, height: 16_384 }));
        for bad in ["", "x", "1280", "0x720", "1280x0", "-1x5", "1x2x3", "1.5x2", "1920x1080px"] {
            assert_eq!(bad.parse::<PictureSize>(), Err(SpecError::Size(bad.into())));
        }
        for (bad, side) in [("16385x1", 16_385), ("1x99999999999", 99_999_999_999)] {
            let error = bad.parse::<PictureSize>().unwrap_err();
            assert_eq!(error, SpecError::SizeTooLarge { size: bad.into(), side });
            assert!(error.to_string().contains("16384"), "{error}");
        }
        assert_eq!((map_size("16"), map_size("16384")), (Ok(16), Ok(16_384)));
        for bad in ["15", "16385", "2k", "2048px", "-1", ""] {
            assert_eq!(map_size(bad), Err(SpecError::MapSize(bad.into())));
        }
    }

    #[test]
    fn layers() {
        let first = Selector::Index(0);
        assert_eq!("color".parse(), Ok(Show::Color));
        assert_eq!("depth".parse(), Ok(Show::Depth));
        assert_eq!("visibility".parse(), Ok(Show::Visibility(first.clone())));
        assert_eq!("visibility:sun".parse(), Ok(Show::Visibility(Selector::Name("sun".into()))));
        assert_eq!("shadow-map".parse(), Ok(Show::ShadowMap(first, 0)));
        assert_eq!("shadow-map:2".parse(), Ok(Show::ShadowMap(Selector::Index(2), 0)));
        assert_eq!("shadow-map:2:5".parse(), Ok(Show::ShadowMap(Selector::Index(2), 5)));
        assert_eq!("shadow-map:0:x".parse::<Show>(), Err(SpecError::View("x".into())));
        for bad in ["", "colour", "color:1", "depth:0"] {
            assert_eq!(bad.parse::<Show>(), Err(SpecError::Layer(bad.into())));
        }
    }

    #[test]
    fn scenes_are_built_in_or_files() {
        assert_eq!(SceneSource::from(OsString::from("builtin:fence")), SceneSource::Builtin("fence".into()));
        assert_eq!(SceneSource::from(OsString::from("a/fence.glb")), SceneSource::File("a/fence.glb".into()));
    }

    #[test]
    fn backends_come_in_different_pairs() {
        assert_eq!("gpu,cpu".parse(), Ok(BackendPair { first: Backend::Gpu, second: Backend::Cpu }));
        assert_eq!("gpu,gpu".parse::<BackendPair>(), Err(SpecError::SameBackend));
        assert_eq!("cpu,trace".parse::<BackendPair>(), Err(SpecError::CompareTrace));
        for bad in ["cpu", "cpu,gpu,cpu", "cpu,rays", ""] {
            assert_eq!(bad.parse::<BackendPair>(), Err(SpecError::Backends(bad.into())));
        }
    }

    #[test]
    fn backends_come_in_lists_without_repetition() {
        assert_eq!("gpu".parse(), Ok(BackendList(vec![Backend::Gpu])));
        assert_eq!("gpu, cpu".parse(), Ok(BackendList(vec![Backend::Gpu, Backend::Cpu])));
        assert_eq!("trace".parse(), Ok(BackendList(vec![Backend::Trace])));
        for bad in ["", "cpu,cpu", "cpu,gpu,cpu", "cpu,", "rays"] {
            assert_eq!(bad.parse::<BackendList>(), Err(SpecError::BackendList(bad.into())));
        }
    }
}
