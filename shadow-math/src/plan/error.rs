//! Why a plan cannot be made.

use crate::{
    camera::CameraError,
    light::LightError,
    settings::{Filter, FilterRadii, MAX_MAP_SIZE, MAX_NORMAL_TEXELS, MIN_MAP_SIZE, SUBPIXEL_BITS, Store},
};

/// Why a plan cannot be made.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PlanError {
    /// The light cannot be used.
    Light(LightError),
    /// The camera cannot be used.
    Camera(CameraError),
    /// The camera's numbers, or what follows from them, are not finite in single precision.
    CameraOverflow,
    /// The light's numbers, or those of its views, are not finite in single precision, or vanish there.
    LightOverflow,
    /// The map's size in texels is out of range.
    MapSize(u32),
    /// The number of bits of the sub-pixel grid is out of range.
    SubpixelBits(u32),
    /// The bias, in metres, is negative or not finite.
    BiasMetres(f32),
    /// The factor on the slope bias is negative or not finite.
    SlopeScale(f32),
    /// The step along the normal, in texels, is out of range.
    NormalTexels(f32),
    /// The most that a receiver plane corrects, in metres, is not above 0 or not finite.
    PlaneMetres(f32),
    /// A number of the receiver's gradient is negative or not finite.
    ReceiverGradient(f32),
    /// The slope bias is for taps that are compared with the receiver's own depth, and a receiver plane corrects them.
    SlopeWithReceiverPlane,
    /// A picture that the scene does not have.
    MissingPicture {
        /// Its index.
        index: u32,
        /// How many there are.
        count: usize,
    },
    /// A picture for a light that is no spot light, or too wide a one.
    PictureOfOtherLight,
    /// A number of a polygon offset is negative or not finite.
    PolygonOffset(f32),
    /// A polygon offset and the article's caster shader both draw casters deeper.
    TwoCasterBiases,
    /// The bias has no meaning with what the map stores.
    BiasOfOtherStores {
        /// The part of the bias.
        bias: &'static str,
        /// What is stored.
        store: Store,
    },
    /// The filter's radius in texels is out of its range.
    FilterRadius {
        /// The filter, which says its [radii](Filter::radii).
        filter: Filter,
        /// The radius.
        radius: f32,
    },
    /// A radius was given for a filter whose size is its own.
    RadiusOfFixedFilter(Filter),
    /// The filter and the bias reach so far that nothing is left of a map of this size.
    MapTooSmallForFilter {
        /// The map's size in texels.
        size: u32,
        /// The filter.
        filter: Filter,
        /// How many texels must stay free on each side.
        guard: u32,
    },
    /// A cube was asked for around a directional light.
    CubeAroundDirection,
    /// There is nothing that could cast a shadow: the scene's bounds are empty.
    EmptyBounds,
    /// The caller lent too few views.
    Views {
        /// How many the light needs.
        needed: usize,
        /// How many there are.
        given: usize,
    },
    /// The picture has no pixels.
    PictureSize {
        /// The width in pixels.
        width: u32,
        /// The height in pixels.
        height: u32,
    },
}

impl core::fmt::Display for PlanError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Light(error) => error.fmt(f),
            Self::Camera(error) => error.fmt(f),
            Self::CameraOverflow => f.write_str(
                "the camera's position, angle of view or planes are too large or too small for single precision; choose others",
            ),
            Self::LightOverflow => f.write_str(
                "the light's position, range or cone, or the scene's size, is too large or too small for single precision; choose others",
            ),
            Self::MapSize(size) => {
                write!(
                    f,
                    "a shadow map of {size} texels is out of range; choose a map size from {MIN_MAP_SIZE} to {MAX_MAP_SIZE}"
                )
            }
            Self::SubpixelBits(bits) => {
                write!(
                    f,
                    "a sub-pixel grid of {bits} bits is out of range; choose from {} to {}",
                    SUBPIXEL_BITS.start(),
                    SUBPIXEL_BITS.end()
                )
            }
            Self::BiasMetres(metres) => write!(f, "a bias of {metres} m makes no sense; it must be finite and at least 0"),
            Self::SlopeScale(scale) => {
                write!(
                    f,
                    "a slope bias scaled by {scale} makes no sense; the scale must be finite and at least 0 (1 is enough and no more)"
                )
            }
            Self::NormalTexels(texels) => write!(
                f,
                "a step of {texels} texels along the normal is out of range; choose one from 0 to {MAX_NORMAL_TEXELS}"
            ),
            Self::PlaneMetres(metres) => {
                write!(f, "a receiver plane that corrects by at most {metres} m makes no sense; the limit must be finite and above 0")
            }
            Self::ReceiverGradient(number) => {
                write!(f, "a receiver gradient with {number} makes no sense; its numbers must be finite and at least 0")
            }
            Self::SlopeWithReceiverPlane => f.write_str(
                "the slope bias and the receiver plane are two remedies for the same slope; leave one of them out",
            ),
            Self::MissingPicture { index, count } => {
                write!(f, "the light is to project picture {index}, but the scene has {count} images, counted from 0")
            }
            Self::PictureOfOtherLight => f.write_str(
                "only a spot light whose outer angle is at most 70 degrees can project a picture; choose another light, or leave the picture out",
            ),
            Self::PolygonOffset(number) => {
                write!(f, "a polygon offset with {number} makes no sense; its slope, units and clamp must be finite and at least 0")
            }
            Self::TwoCasterBiases => {
                f.write_str("polygon-offset and ogre-2006 both draw casters deeper; leave one of them out")
            }
            Self::BiasOfOtherStores { bias, store } => {
                let (why, stores) = match *bias {
                    "polygon-offset" => ("is an offset of a depth format's steps", "depth32, depth24, depth16 or reversed32"),
                    "ogre-2006" => ("adds to depth that grows away from the light", "depth32, depth24 or depth16"),
                    "receiver-gradient" => ("takes a share of depth that grows away from the light", "any store but reversed32"),
                    _ => ("needs depth that is flat over a plane's image", "any store but linear"),
                };
                write!(f, "the bias {bias} {why}, which the store {} does not have; take {stores}, or another bias", store.name())
            }
            Self::FilterRadius { filter, radius } => {
                let name = filter.name();
                match filter.radii() {
                    Some(FilterRadii { least, most, .. }) => write!(
                        f,
                        "a radius of {radius} texels is out of range for the filter {name}; choose one from {least} to {most}"
                    ),
                    None => write!(f, "the filter {name} has a size of its own, and takes no radius of {radius} texels"),
                }
            }
            Self::RadiusOfFixedFilter(filter) => write!(
                f,
                "the filter {} has a size of its own; leave the radius out, or take gaussian, poisson or vogel",
                filter.name()
            ),
            Self::MapTooSmallForFilter { size, filter, guard } => write!(
                f,
                "of a shadow map of {size} texels nothing is left when {guard} stay free on each side for the filter {}; choose a larger map or a smaller filter",
                filter.name()
            ),
            Self::CubeAroundDirection => {
                f.write_str("a directional light has no position that a cube could surround; use a single map for it")
            }
            Self::EmptyBounds => f.write_str("the scene's bounds are empty, so there is nothing to fit a shadow map to"),
            Self::Views { needed, given } => write!(f, "the light needs {needed} views, but only {given} were lent"),
            Self::PictureSize { width, height } => {
                write!(f, "a picture of {width} x {height} pixels has nothing in it; both must be at least 1")
            }
        }
    }
}

impl core::error::Error for PlanError {}

impl From<LightError> for PlanError {
    fn from(error: LightError) -> Self {
        Self::Light(error)
    }
}

impl From<CameraError> for PlanError {
    fn from(error: CameraError) -> Self {
        Self::Camera(error)
    }
}
