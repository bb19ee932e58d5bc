//! Where samples go, and how many maps share them: the article's second and third categories.

/// The most cascades of one light.
pub const MAX_CASCADES: usize = 8;

/// Where do the samples of a map go?
///
/// [`fit`](crate::fit) says what each is, and where it comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Fit {
    /// Over all that the light reaches, whatever the camera sees: the light-space box of the scene's bounds for a
    /// directional light, the cone for a spot light, a cube face each for the others. A cascade's is the box of what it covers.
    #[default]
    Uniform,
    /// Over what the camera sees and something can shadow: the smallest rectangle, turned as need be, around its image.
    Focused,
    /// As focused, and warped so that what is near to the camera has more of the samples (Wimmer, Scherzer and Purgathofer 2004).
    Lispsm,
    /// One sample for each pixel of a plane: camera and light agree on all of its points (Chong and Gortler 2004).
    PlaneOptimal,
    /// What OGRE's default setup does: a box around a place before the camera, a cone, or 120 degrees toward there.
    OgreUniform,
    /// As LiSPSM with the warp that OGRE computes by itself.
    OgreLispsm,
}

impl Fit {
    /// Every fit.
    pub const ALL: [Self; 6] =
        [Self::Uniform, Self::Focused, Self::Lispsm, Self::PlaneOptimal, Self::OgreUniform, Self::OgreLispsm];

    /// The name in settings files and on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Uniform => "uniform",
            Self::Focused => "focused",
            Self::Lispsm => "lispsm",
            Self::PlaneOptimal => "plane-optimal",
            Self::OgreUniform => "ogre-uniform",
            Self::OgreLispsm => "ogre-lispsm",
        }
    }

    /// Whether there is one map of all that is seen, for any kind of light: it cannot be split.
    #[must_use]
    pub fn makes_one_map(self) -> bool {
        matches!(self, Self::PlaneOptimal | Self::OgreUniform)
    }

    /// Whether views are warped: their w is no distance along the axis.
    #[must_use]
    pub fn is_warped(self) -> bool {
        matches!(self, Self::Lispsm | Self::PlaneOptimal | Self::OgreLispsm)
    }
}

/// What do fits follow?
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum FitFrom {
    /// All that the camera could see: its frustum, within the scene's bounds.
    #[default]
    Frustum,
    /// What it does see: the points of its pixels (Lauritzen, Salvi and Lefohn, "Sample Distribution Shadow Maps", 2011).
    Samples,
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
    /// A map for each range of distances from the camera (Engel 2006; Zhang et al. 2006); refused for lights that take a cube.
    Cascades(Cascades),
}

/// How the camera's view is split into cascades.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct Cascades {
    /// How many, from 1 to [`MAX_CASCADES`].
    pub count: u32,
    /// Where each ends.
    pub scheme: SplitScheme,
    /// By how much each cascade reaches beyond its ends, in metres; at least 0. What lies within can be looked up in either.
    pub padding: f32,
    /// The share of each cascade, before its end, over which it is blended with the next one; from 0 to 1.
    pub blend: f32,
    /// How receivers choose.
    pub selection: Selection,
    /// Whether the texels of each map stay where they are while the camera moves and turns: for directional lights and the uniform fit, with maps of a power of two.
    pub stabilised: bool,
    /// The size of each cascade's map in texels, a square's side; `None` for the settings' `map_size`, which none may exceed.
    pub map_sizes: [Option<u32>; MAX_CASCADES],
    /// The fit of each cascade; `None` for the settings' `fit`.
    pub fits: [Option<Fit>; MAX_CASCADES],
    /// What the warp's parameter is multiplied by in each cascade, of those that LiSPSM fits: 1 is the best by Wimmer et al., more warps less, and 0 does not warp at all, as OGRE has it.
    pub lispsm_factors: [f32; MAX_CASCADES],
}

impl Default for Cascades {
    /// Four by the practical scheme, as most engines begin.
    fn default() -> Self {
        Self {
            count: 4,
            scheme: SplitScheme::default(),
            padding: 0.0,
            blend: 0.0,
            selection: Selection::default(),
            stabilised: false,
            map_sizes: [None; MAX_CASCADES],
            fits: [None; MAX_CASCADES],
            lispsm_factors: [1.0; MAX_CASCADES],
        }
    }
}

/// Where cascades end.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum SplitScheme {
    /// All are equally deep.
    Uniform,
    /// Each is deeper than the one before by the same factor.
    Logarithmic,
    /// Between both: the parameter is 0 for uniform and 1 for logarithmic (Zhang et al. 2006).
    Practical(f32),
    /// At these distances from the camera along its axis, in metres, increasing; the last cascade ends with the range of shadows.
    Explicit([f32; MAX_CASCADES - 1]),
    /// Where each has as many of the visible samples.
    Histogram,
}

impl Default for SplitScheme {
    fn default() -> Self {
        Self::Practical(DEFAULT_LAMBDA)
    }
}

/// The share of the logarithmic scheme in the practical one. Logarithmic splits are best for a plane that runs away from the camera (Lloyd et al. 2006), and leave cascades unused where nothing is near to it.
pub const DEFAULT_LAMBDA: f32 = 0.8;

/// How a receiver chooses among cascades.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Selection {
    /// By its distance from the camera along its axis.
    #[default]
    Depth,
    /// The first whose map has it, and all that its filter looks at.
    Containment,
}
