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
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Bias {
    /// By what the receiver's plane needs under the filter, and no more: as depth, or along the normal where that costs less. There is nothing
    /// to tune ([`bias`](crate::bias) has the derivation).
    #[default]
    Automatic,
    /// Not at all.
    None,
    /// By the same length everywhere.
    Constant {
        /// The length in metres along the view axis of the light, at least 0.
        metres: f32,
    },
    /// By what the receiver's plane needs under the filter, and no more (Chong 2006, section 1.2, made exact).
    Slope {
        /// A factor on the need: 1 is enough and no more, less leaves acne, more opens gaps.
        scale: f32,
        /// A length in metres along the view axis of the light on top of it, at least 0.
        metres: f32,
    },
}

/// How are depth tests averaged?
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Filter {
    /// One test, of the texel that the point falls into.
    Hard,
    /// Four tests, weighted by the point's distance to their centres.
    #[default]
    Bilinear,
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
            map_size: 2048,
        }
    }
}
