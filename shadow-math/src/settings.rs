//! A technique is a product of five choices, and this is the type that says them.
//!
//! The article "Shadow Mapping in Ogre" (Chong 2006, section 2) divides the variants of shadow mapping into categories that
//! "work quite independently"; bias and filtering are two more.
//! Each enum grows as techniques are added; a combination without a meaning is refused by the plan with
//! [`PlanError`](crate::PlanError), never replaced.

/// Where do the samples of a map go?
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Fit {
    /// Over all that the light reaches, whatever the camera sees: the light-space box of the scene's bounds for a
    /// directional light, the cone for a spot light, a cube face each for the others.
    #[default]
    Uniform,
}

/// How many maps share the view?
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Split {
    /// As few as can cover the light: one for a directional light and for a spot light of at most
    /// [70 degrees](crate::light::MAX_SINGLE_MAP_OUTER_ANGLE), the six faces of a cube for any other.
    #[default]
    Single,
    /// The six faces of a cube around every light; refused for a directional light, which is nowhere.
    Cube,
}

/// What does a texel remember?
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Store {
    /// The depth of the nearest caster as a 32-bit float, z / w, 0 at the near plane.
    #[default]
    Depth32,
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
        back_faces: false,
    };
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

/// How a light's shadow is mapped.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct ShadowSettings {
    /// Where the samples go.
    pub fit: Fit,
    /// How many maps share the view.
    pub split: Split,
    /// What a texel remembers.
    pub store: Store,
    /// How self-shadowing is avoided.
    pub bias: Bias,
    /// How depth tests are averaged.
    pub filter: Filter,
    /// How far the filter reaches, in texels, for those that have [radii](Filter::radii); `None` is the filter's own default.
    pub filter_radius: Option<f32>,
    /// Width and height of each map in texels, from [`MIN_MAP_SIZE`] to [`MAX_MAP_SIZE`].
    pub map_size: u32,
}

/// The smallest map: below it the guard band around the fit would leave no map.
pub const MIN_MAP_SIZE: u32 = 16;
/// The largest map: the rasteriser's edge functions are proven free of overflow up to here.
pub const MAX_MAP_SIZE: u32 = 16_384;

impl Default for ShadowSettings {
    fn default() -> Self {
        Self {
            fit: Fit::default(),
            split: Split::default(),
            store: Store::default(),
            bias: Bias::default(),
            filter: Filter::default(),
            filter_radius: None,
            map_size: 2048,
        }
    }
}
