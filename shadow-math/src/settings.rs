//! A technique is a product of five choices (where samples go, how many maps there are, what they store, the bias and the filter), and this is the type that says them, with what else a lookup and its shading can vary.
//!
//! The article "Shadow Mapping in Ogre" (Chong 2006, section 2) divides the variants of shadow mapping into categories that
//! "work quite independently"; bias and filtering are two more.
//! Each enum grows as techniques are added; a combination without a meaning is refused by the plan with
//! [`PlanError`](crate::PlanError), never replaced.

mod light_camera;

pub use light_camera::{Cascades, DEFAULT_LAMBDA, Fit, FitFrom, MAX_CASCADES, Selection, Split, SplitScheme};

/// What does a texel remember?
///
/// [`depth`](crate::depth) says what each is. Whatever the map's format would be elsewhere, its texels are kept as 32-bit floats here, of which the narrower formats use some values alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Store {
    /// The depth of the nearest caster as a 32-bit float, z / w, 0 at the near plane.
    #[default]
    Depth32,
    /// The same, rounded to a whole number of 2^24 - 1 steps.
    Depth24,
    /// The same, rounded to a whole number of 65,535 steps.
    Depth16,
    /// 1 - z / w as a 32-bit float: 1 at the near plane, 0 at the far plane.
    Reversed32,
    /// The distance along the view axis as a 32-bit float, 0 at the near plane and 1 at the far plane. For a directional light z / w is that.
    Linear,
    /// The depth of the second surface: of closed casters the side that is turned away from the light (Wang and Molnar 1994). Where there is none, nothing: an open caster that nothing lies behind casts
    /// no shadow, and what lies right behind an open caster is lit.
    Second,
    /// Half-way between the first and the second surface (Woo 1992); nothing where there is no second.
    Midpoint,
}

impl Store {
    /// Every store.
    pub const ALL: [Self; 7] =
        [Self::Depth32, Self::Depth24, Self::Depth16, Self::Reversed32, Self::Linear, Self::Second, Self::Midpoint];

    /// The name in settings files and on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Depth32 => "depth32",
            Self::Depth24 => "depth24",
            Self::Depth16 => "depth16",
            Self::Reversed32 => "reversed32",
            Self::Linear => "linear",
            Self::Second => "second",
            Self::Midpoint => "midpoint",
        }
    }

    /// How many steps there are from 0 to 1; 0 for floats.
    #[must_use]
    pub fn steps(self) -> f32 {
        match self {
            Self::Depth24 => 16_777_215.0,
            Self::Depth16 => 65_535.0,
            _ => 0.0,
        }
    }
}

/// Where do lookups think that texels are?
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Texels {
    /// Texel centres lie half-way between whole numbers, as in OpenGL, Vulkan, WebGPU and Direct3D from version 10: where maps are drawn.
    #[default]
    #[cfg_attr(feature = "serde", serde(rename = "opengl"))]
    OpenGl,
    /// Pixel centres lie at whole numbers, as in Direct3D up to version 9: such programs add half a texel to their texture coordinates. On maps that are drawn by the other convention that is half a texel too
    /// much, and this shows what the mistake costs: outlines are off by half a texel on both axes, and no bias but the receiver plane's reckons with it.
    #[cfg_attr(feature = "serde", serde(rename = "direct3d"))]
    Direct3d,
}

impl Texels {
    /// How far lookups are moved, in texels on both axes.
    #[must_use]
    pub fn shift(self) -> f32 {
        match self {
            Self::OpenGl => 0.0,
            Self::Direct3d => 0.5,
        }
    }
}

/// How is self-shadowing avoided?
///
/// [`bias`](crate::bias) says what each does, and where it comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Bias {
    /// By what the receiver's plane needs under the filter, and no more: as depth, or along the normal where that costs less. There is nothing
    /// to tune ([`bias`](crate::bias) has the derivation).
    #[default]
    Automatic,
    /// By parts that are chosen and add up; without any, not at all.
    Parts(BiasParts),
}

impl Bias {
    /// Not at all: surfaces shadow themselves.
    pub const NONE: Self = Self::Parts(BiasParts::NONE);

    /// By the same length everywhere, in metres along the view axis of the light, at least 0.
    #[must_use]
    pub const fn constant(metres: f32) -> Self {
        Self::Parts(BiasParts { constant: Some(metres), ..BiasParts::NONE })
    }

    /// By a factor on what the receiver's plane needs under the filter, and a length on top of it: see [`BiasParts::slope`] and [`BiasParts::constant`].
    #[must_use]
    pub const fn slope(scale: f32, metres: f32) -> Self {
        Self::Parts(BiasParts { slope: Some(scale), constant: Some(metres), ..BiasParts::NONE })
    }
}

/// Biases that add up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, rename_all = "kebab-case"))]
pub struct BiasParts {
    /// A length in metres along the view axis of the light, at least 0.
    pub constant: Option<f32>,
    /// A factor on what the receiver's plane needs under the filter (Chong 2006, section 1.2, made exact), at least 0: 1 is enough and no more, less leaves acne, more opens
    /// gaps.
    pub slope: Option<f32>,
    /// A step along the normal before the lookup, in texels times the sine of the angle between normal and light; from 0 to [`MAX_NORMAL_TEXELS`].
    pub normal_offset: Option<f32>,
    /// Each tap is compared with the depth that the receiver's plane has there. No tap is corrected by more than this length in metres, above 0: near edge-on, a plane's depth
    /// tells nothing of what lies beside it. Cannot be combined with `slope`, which is for taps that are not corrected.
    pub receiver_plane: Option<f32>,
    /// What OGRE 1.12's sample does in its receiver.
    pub receiver_gradient: Option<ReceiverGradient>,
    /// Casters are drawn deeper, as hardware does it. Neither for stores of two surfaces nor for linear depth, which is none of hardware's formats.
    pub polygon_offset: Option<PolygonOffset>,
    /// Casters are drawn deeper, as the article's shader of 2006 does it, or as its text asks for. For stores of z / w alone, and not beside a polygon offset.
    pub ogre_2006: Option<Ogre2006>,
    /// Of single-sided casters only the back faces are drawn into the map: a closed caster's own thickness is then the bias of its lit side. Where it is thin, open or touches
    /// what it shadows, the acne is on the other side, or light leaks in. OGRE and three.js do so by default.
    pub back_faces: bool,
}

impl BiasParts {
    /// No part.
    pub const NONE: Self = Self {
        constant: None,
        slope: None,
        normal_offset: None,
        receiver_plane: None,
        receiver_gradient: None,
        polygon_offset: None,
        ogre_2006: None,
        back_faces: false,
    };
}

/// How much deeper casters are drawn: `slope * max(|dz/dx|, |dz/dy|) + units * r`, with differences from texel to texel and a unit r of one step of the format.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, rename_all = "kebab-case"))]
pub struct PolygonOffset {
    /// A factor on the larger of the two slopes; at least 0.
    pub slope: f32,
    /// How many units; at least 0.
    pub units: f32,
    /// The most that it may be in depth, at least 0; 0 is no limit.
    pub clamp: f32,
}

impl Default for PolygonOffset {
    /// A slope of 2, which a bilinear lookup needs whichever way a plane leans, and the 4 units that are customary beside it.
    fn default() -> Self {
        Self { slope: 2.0, units: 4.0, clamp: 0.0 }
    }
}

/// The caster shader of "Shadow Mapping in Ogre" (Chong 2006).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, rename_all = "kebab-case"))]
pub struct Ogre2006 {
    /// A push away from the light along its axis, in metres, at least 0, taken to the first order.
    pub metres: f32,
    /// As published, the shader adds a quarter of the larger slope from texel to texel, where its text asks for a bilinear lookup's need: the sum of both. True adds that.
    pub is_corrected: bool,
}

impl Default for Ogre2006 {
    /// The shader's own push of one unit.
    fn default() -> Self {
        Self { metres: 1.0, is_corrected: false }
    }
}

/// A bias that is read off the map: `scale * min(clamp, max(|d_right - d_left|, |d_below - d_above|)) + fixed * d` of the depths d in and around the lookup's texel.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, rename_all = "kebab-case"))]
pub struct ReceiverGradient {
    /// A share of the texel's own depth; at least 0.
    pub fixed: f32,
    /// The most that differences count, in depth; at least 0.
    pub clamp: f32,
    /// A factor on differences; at least 0.
    pub scale: f32,
}

impl Default for ReceiverGradient {
    /// The sample's own numbers, whose scale of 0 leaves the differences out.
    fn default() -> Self {
        Self { fixed: 0.0005, clamp: 0.0098, scale: 0.0 }
    }
}

/// The longest step along the normal, in texels.
pub const MAX_NORMAL_TEXELS: f32 = 8.0;

/// How are depth tests averaged?
///
/// [`filter`](crate::filter) says what each is, and where it comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Filter {
    /// One test, of the texel that the point falls into.
    Hard,
    /// Four tests, weighted by the point's distance to their centres.
    #[default]
    Bilinear,
    /// The texel that the point falls into and its four neighbours, alike.
    Cross5,
    /// The mean over a square of 3 texels, with bilinear edges.
    Box3,
    /// The same over 4 texels.
    Box4,
    /// The same over 5 texels.
    Box5,
    /// The same over 6 texels.
    Box6,
    /// The same over 7 texels.
    Box7,
    /// The same over 8 texels.
    Box8,
    /// The same over 9 texels.
    Box9,
    /// A bell curve out to the radius, with bilinear edges.
    Gaussian,
    /// The witness kernel of 3 texels.
    Witness3,
    /// The witness kernel of 5 texels.
    Witness5,
    /// The witness kernel of 7 texels.
    Witness7,
    /// Sixteen tests in a disc, at places that keep a distance from each other, turned from pixel to pixel.
    Poisson,
    /// Sixteen tests in a disc, along a sunflower's spiral, turned from pixel to pixel.
    Vogel,
    /// Tests all over the pixel's own image in the map, a parallelogram.
    Footprint,
}

impl Filter {
    /// Every filter.
    pub const ALL: [Self; 17] = [
        Self::Hard,
        Self::Bilinear,
        Self::Cross5,
        Self::Box3,
        Self::Box4,
        Self::Box5,
        Self::Box6,
        Self::Box7,
        Self::Box8,
        Self::Box9,
        Self::Gaussian,
        Self::Witness3,
        Self::Witness5,
        Self::Witness7,
        Self::Poisson,
        Self::Vogel,
        Self::Footprint,
    ];

    /// The name in settings files and on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Hard => "hard",
            Self::Bilinear => "bilinear",
            Self::Cross5 => "cross5",
            Self::Box3 => "box3",
            Self::Box4 => "box4",
            Self::Box5 => "box5",
            Self::Box6 => "box6",
            Self::Box7 => "box7",
            Self::Box8 => "box8",
            Self::Box9 => "box9",
            Self::Gaussian => "gaussian",
            Self::Witness3 => "witness3",
            Self::Witness5 => "witness5",
            Self::Witness7 => "witness7",
            Self::Poisson => "poisson",
            Self::Vogel => "vogel",
            Self::Footprint => "footprint",
        }
    }

    /// Between which radii in texels the filter can be set, and to what it is by itself; `None` for a filter whose size is its own.
    #[must_use]
    pub fn radii(self) -> Option<FilterRadii> {
        match self {
            Self::Gaussian => Some(FilterRadii { least: 1.0, most: 4.0, default: 2.0 }),
            Self::Poisson | Self::Vogel => Some(FilterRadii { least: 0.5, most: 16.0, default: 2.5 }),
            _ => None,
        }
    }
}

/// The radii that a filter can have, in texels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilterRadii {
    /// The smallest.
    pub least: f32,
    /// The largest.
    pub most: f32,
    /// What it is if nothing is said.
    pub default: f32,
}

/// What becomes of light where a smooth mesh's facets turn away from it?
///
/// A facet that faces away is in its own shadow, while the smooth normal may still face the light: at the terminator, where day becomes night, shadows end in
/// the facets' zigzag.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Terminator {
    /// Light ends where the facet turns away, all at once.
    #[default]
    Hard,
    /// Light fades out before any facet can turn away, by [`softened_terminator`](crate::shade::softened_terminator): nothing is left of the zigzag, and the terminator moves toward the light, on coarse meshes by more.
    Soft,
}

/// How do shadows of several lights come together in the picture?
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Composition {
    /// Each light is added where it is seen: OGRE's additive light masking.
    #[default]
    Additive,
    /// All lights are added, seen or not, and what a light does not reach is darkened: multiplied by a colour, linear, each part from 0 to 1. OGRE's modulative shadows, whose colour is
    /// [`OGRE_SHADOW_COLOR`] unless a program says otherwise. Highlights stay visible in shadow, and where two shadows overlap it is darker than ambient light makes it.
    Modulative([f32; 3]),
}

/// The grey that OGRE multiplies by where it is not told another colour.
pub const OGRE_SHADOW_COLOR: [f32; 3] = [0.25; 3];

/// How a light's shadow is mapped.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct ShadowSettings {
    /// Where the samples go.
    pub fit: Fit,
    /// How many maps share the view.
    pub split: Split,
    /// What fits follow.
    pub fit_from: FitFrom,
    /// The plane of the plane-optimal fit, as `(normal, offset)` with `normal . point + offset = 0` for points in metres from the world's origin, whatever the scene's own is; the normal is of any length above 0. `None` for the one that is found.
    pub plane: Option<[f32; 4]>,
    /// Whether the depth of maps is for what is seen alone, and casters beyond are [drawn onto its planes](crate::fit::ViewFit::pancaked): finer steps for maps of 16 and 24 bits.
    pub pancake: bool,
    /// How far from the camera, along its axis in metres, there are shadows; `None` for as far as anything is seen.
    pub shadow_distance: Option<f32>,
    /// What a texel remembers.
    pub store: Store,
    /// Where lookups think that texels are.
    pub texels: Texels,
    /// How self-shadowing is avoided.
    pub bias: Bias,
    /// How depth tests are averaged.
    pub filter: Filter,
    /// How far the filter reaches, in texels, for those that have [radii](Filter::radii); `None` is the filter's own default.
    pub filter_radius: Option<f32>,
    /// What becomes of light where facets turn away.
    pub terminator: Terminator,
    /// Width and height of each map in texels, from [`MIN_MAP_SIZE`] to [`MAX_MAP_SIZE`].
    pub map_size: u32,
    /// Bits of the sub-pixel grid that the renderers snap vertices to, of those that draw the plan the fewest; one of [`SUBPIXEL_BITS`]. The biases that follow the receiver's plane leave half a step of it to
    /// rasterisers whose depth planes go through snapped vertices.
    pub subpixel_bits: u32,
}

/// Bits of sub-pixel grids: 4 is the least that Vulkan allows; Direct3D requires 8, which hardware and lavapipe have.
pub const SUBPIXEL_BITS: core::ops::RangeInclusive<u32> = 4..=8;

/// The smallest map: below it the guard band around the fit would leave no map.
pub const MIN_MAP_SIZE: u32 = 16;
/// The largest map: the rasteriser's edge functions are proven free of overflow up to here.
pub const MAX_MAP_SIZE: u32 = 16_384;

impl Default for ShadowSettings {
    fn default() -> Self {
        Self {
            fit: Fit::default(),
            split: Split::default(),
            fit_from: FitFrom::default(),
            plane: None,
            pancake: false,
            shadow_distance: None,
            store: Store::default(),
            texels: Texels::default(),
            bias: Bias::default(),
            filter: Filter::default(),
            filter_radius: None,
            terminator: Terminator::default(),
            map_size: 2048,
            subpixel_bits: *SUBPIXEL_BITS.end(),
        }
    }
}
