//! Why a pixel is wrong.

use std::ops::AddAssign;

/// Why a pixel's visibility is not the truth: the first of these that applies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Cause {
    /// The renderer and the rays see different triangles there: in the camera's picture or, by [`Counts::by_slivers`], in the light's map.
    Coverage = 1,
    /// The shading normal and the geometric normal disagree about facing the light, or single and double precision do.
    Terminator = 2,
    /// A tap leaves the part of the light's view that is this map's: its cube face, or the map itself.
    Seam = 3,
    /// The true shadow's edge runs between the pixel and its taps, and the filter mixes what lies on both sides.
    Filter = 4,
    /// The true shadow's edge runs between the pixel and its taps, and the lookup falls on the wrong side.
    Aliasing = 5,
    /// The pixel and all taps see the light, and yet there is shadow: the surface shadows itself.
    Acne = 6,
    /// The pixel and all taps are in shadow, and yet there is light, since what throws the shadow is nearer than the bias.
    PeterPanning = 7,
    /// The pixel and all taps are in shadow, and yet there is light, though what throws the shadow is farther than the bias.
    Leak = 8,
}

impl Cause {
    /// Every cause, in the order in which they are decided.
    pub const ALL: [Self; 8] =
        [Self::Coverage, Self::Terminator, Self::Seam, Self::Filter, Self::Aliasing, Self::Acne, Self::PeterPanning, Self::Leak];

    /// The name in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Coverage => "coverage",
            Self::Terminator => "terminator",
            Self::Seam => "seam",
            Self::Filter => "filter",
            Self::Aliasing => "aliasing",
            Self::Acne => "acne",
            Self::PeterPanning => "peter_panning",
            Self::Leak => "leak",
        }
    }

    /// The cause of this number, as [`LightJudgement::causes`](super::LightJudgement::causes) has it; `None` for 0, a pixel that is right, and beyond.
    #[must_use]
    pub fn of_number(number: u8) -> Option<Self> {
        Self::ALL.get(usize::from(number).checked_sub(1)?).copied()
    }
}

/// How many pixels there are of what, and how far they are off.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Counts {
    /// Pixels that show a surface which the light can reach: within its range and cone.
    pub judged: u64,
    /// Of these, pixels whose shading normal faces the light and whose geometric normal does not, or the other way round: a smooth mesh shows its
    /// facets there, whatever casts shadows. Few of them are wrong by their visibility, which goes by the geometric normal.
    pub at_terminator: u64,
    /// Of those whose cause is [`Cause::Coverage`], pixels that see the light as all their taps do, and are shadowed by texels into which a sliver was drawn at a depth that
    /// nothing has there. A rasteriser's depth plane has no [bound on rounding](shadow_math::rounding) for slivers, and for triangles that the light sees edge-on; no bias
    /// makes up for it.
    pub by_slivers: u64,
    /// Wrong pixels by cause, in the order of [`Cause::ALL`].
    pub causes: [u64; Cause::ALL.len()],
    /// The sum, over the pixels judged, of the squared distance of the visibility from the truth, that of the light's whole size.
    pub squared_error: f64,
}

impl Counts {
    /// How many pixels are wrong for that cause.
    #[must_use]
    pub fn count(&self, cause: Cause) -> u64 {
        self.causes[cause as usize - 1]
    }

    /// How many pixels are wrong.
    #[must_use]
    pub fn wrong(&self) -> u64 {
        self.causes.iter().sum()
    }

    /// The root of the mean squared error of visibility, from 0 to 1; 0 where nothing was judged.
    #[must_use]
    pub fn rmse(&self) -> f64 {
        if self.judged == 0 { 0.0 } else { (self.squared_error / self.judged as f64).sqrt() }
    }
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.judged += other.judged;
        self.at_terminator += other.at_terminator;
        self.squared_error += other.squared_error;
        self.by_slivers += other.by_slivers;
        for (count, more) in self.causes.iter_mut().zip(other.causes) {
            *count += more;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn causes_have_numbers_and_names_of_their_own() {
        for cause in Cause::ALL {
            assert_eq!(Cause::of_number(cause as u8), Some(cause));
            assert_eq!(Cause::ALL.iter().filter(|other| other.name() == cause.name()).count(), 1);
        }
        assert_eq!((Cause::of_number(0), Cause::of_number(9)), (None, None));
    }
}
