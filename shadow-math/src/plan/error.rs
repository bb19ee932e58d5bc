//! Why a plan cannot be made.

use crate::{
    camera::CameraError,
    light::LightError,
    settings::{Filter, FilterRadii, Fit, MAX_CASCADES, MAX_MAP_SIZE, MAX_NORMAL_TEXELS, MIN_MAP_SIZE, SUBPIXEL_BITS, Store},
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
    /// Cascades were asked for where the light takes the six faces of a cube.
    CascadesOfCube,
    /// The fit, or the split, depends on who looks, and nobody does.
    NoCamera,
    /// The number of cascades is out of range.
    CascadeCount(u32),
    /// The practical scheme's parameter is not from 0 to 1.
    Lambda(f32),
    /// The padding of cascades, in metres, is negative or not finite.
    Padding(f32),
    /// The share of a cascade that is blended with the next one is not from 0 to 1.
    Blend(f32),
    /// A distance at which a cascade is to end, in metres, is not above the one before.
    SplitDistance(f32),
    /// A fit or splits by what is visible, without samples of it.
    NoSamples,
    /// A cascade's map is larger than the maps of the settings, or too small.
    CascadeMapSize {
        /// Its size in texels.
        size: u32,
        /// The size in texels of the settings' maps.
        most: u32,
    },
    /// The factor of a warp is negative or not finite.
    LispsmFactor(f32),
    /// Stabilised cascades have a fit of their own.
    StabilisedFit(Fit),
    /// Stabilised cascades would end where the picture has as many samples before as behind.
    StabilisedHistogram,
    /// Only cascades of parallel light can stand still.
    StabilisedLight,
    /// The maps of stabilised cascades are not a power of two wide.
    StabilisedMapSize(u32),
    /// A fit that is for one map alone, in cascades.
    FitOfCascades(Fit),
    /// A fit that is for one map alone, in a cube.
    FitOfCube(Fit),
    /// The distance in metres up to which there are shadows is not above 0.
    ShadowDistance(f32),
    /// The plane has no normal, or is not finite.
    Plane([f32; 4]),
    /// What is stored has no meaning in a warped view.
    StoreOfFit {
        /// The fit.
        fit: Fit,
        /// What is stored.
        store: Store,
    },
    /// The bias has no meaning in a warped view.
    BiasOfFit {
        /// The fit.
        fit: Fit,
        /// The part of the bias.
        bias: &'static str,
    },
    /// Two surfaces are to be told apart where both can be drawn onto one plane.
    PancakeOfTwo(Store),
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
                    "ogre-2006" | "ogre-2006-corrected" => ("adds to depth that grows away from the light", "depth32, depth24 or depth16"),
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
            Self::CascadesOfCube => f.write_str(
                "this light takes the six faces of a cube, which cascades do not split further; give it settings of its own (--light-settings) with the split single or cube, or leave cascades out",
            ),
            Self::NoCamera => f.write_str("this fit or split follows the camera; plan with a camera, or take the uniform fit and a single map without pancaking"),
            Self::CascadeCount(count) => {
                write!(f, "{count} cascades are out of range; choose from 1 to {MAX_CASCADES}")
            }
            Self::Lambda(lambda) => write!(
                f,
                "a lambda of {lambda} is out of range; it lies between 0 (cascades of one depth) and 1 (each deeper than the one before by the same factor)"
            ),
            Self::Padding(metres) => write!(f, "cascades padded by {metres} m make no sense; the length must be finite and at least 0"),
            Self::Blend(share) => write!(f, "a blend of {share} makes no sense; it is the share of a cascade, from 0 (none) to 1 (all of it)"),
            Self::SplitDistance(metres) => write!(
                f,
                "a cascade cannot end at {metres} m; the distances must be finite, above 0 and increasing"
            ),
            Self::NoSamples => f.write_str("fits and splits by samples need the points that the camera sees, and it sees none; draw the camera's pass first, or fit to the frustum"),
            Self::CascadeMapSize { size, most } => write!(
                f,
                "a cascade's map of {size} texels is out of range; choose from {MIN_MAP_SIZE} to the settings' map size, which is {most}"
            ),
            Self::LispsmFactor(factor) => write!(
                f,
                "a warp's factor of {factor} makes no sense; it must be finite and at least 0 (1 is the best by the paper, more warps less, 0 not at all)"
            ),
            Self::StabilisedFit(fit) => write!(
                f,
                "stabilised cascades are fitted to spheres, which the fit {} would undo; take the fit uniform, or leave stabilisation out",
                fit.name()
            ),
            Self::StabilisedHistogram => f.write_str("cascades that end by the picture's samples change with every picture, and cannot stand still; take the splits practical or distances, or leave stabilisation out"),
            Self::StabilisedLight => f.write_str("only cascades of a directional light can stand still: light from a place spreads, and its texels with it; give this light settings of its own (--light-settings), or leave stabilisation out"),
            Self::StabilisedMapSize(size) => {
                let below = 1_u32 << size.max(&1).ilog2();
                write!(
                    f,
                    "stabilised cascades need maps of a power of two, so that whole texels are exact, and {size} is none; take {below} or {}",
                    below.saturating_mul(2)
                )
            }
            Self::FitOfCascades(fit) => write!(f, "the fit {} makes one map of all that is seen, which cascades split; take another fit, or one map", fit.name()),
            Self::FitOfCube(fit) => write!(f, "the fit {} makes one map of all that is seen, whatever the light, which a cube's faces split; take another fit, or leave the cube out", fit.name()),
            Self::ShadowDistance(metres) => write!(f, "shadows up to {metres} m from the camera make no sense; the distance must be finite and above 0"),
            Self::Plane(plane) => write!(
                f,
                "the plane {},{},{},{} has no normal, or is not finite; give nx,ny,nz,d with nx x + ny y + nz z + d = 0, such as 0,1,0,0 for the floor y = 0",
                plane[0], plane[1], plane[2], plane[3]
            ),
            Self::StoreOfFit { fit, store } => {
                let why = match store {
                    Store::Linear => "keeps the distance along a view's axis, which a warped view's w is not",
                    _ => "has steps of centimetres there, for most of its range lies between the light and the highest caster",
                };
                write!(f, "the store {} {why}; take depth32 or reversed32, or another fit than {}", store.name(), fit.name())
            }
            Self::BiasOfFit { fit, bias } => write!(
                f,
                "the bias {bias} pushes casters along a view's axis, which the fit {} warps; take another bias, or another fit",
                fit.name()
            ),
            Self::PancakeOfTwo(store) => write!(
                f,
                "the store {} keeps two surfaces apart, and pancaking draws both onto the near plane where they lie before it; take another store, or leave pancaking out",
                store.name()
            ),
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
