//! How a view came about.

/// What became of a fit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FitOutcome {
    /// The fit that was asked for.
    #[default]
    Fitted,
    /// The fit that was asked for does not exist here. In place of a warp the map covers the same without one; in place of a plane's it is the uniform one.
    FellBackToUniform {
        /// What stands in its way.
        why: FallBack,
    },
    /// The camera sees nothing that could be shadowed in this view: it has no map, and what asks it is lit.
    NothingVisible,
}

/// Why a fit does not exist.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum FallBack {
    /// The camera looks along the light: no direction in the map is the one away from the camera, and the best warp is none.
    LightAlongView = 2,
    /// The light lies in the plane, or shines along it.
    LightInPlane = 3,
    /// The camera lies in the plane.
    CameraInPlane = 4,
    /// Nothing of the plane is seen.
    PlaneOutOfView = 5,
    /// What is seen is so small, or so far from the scene's origin, that nothing is left of its size.
    NoExtent = 6,
    /// The scene has no plane that the camera sees.
    NoPlane = 7,
}

impl FallBack {
    const ALL: [Self; 6] =
        [Self::LightAlongView, Self::LightInPlane, Self::CameraInPlane, Self::PlaneOutOfView, Self::NoExtent, Self::NoPlane];

    /// The name in JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::LightAlongView => "light-along-view",
            Self::LightInPlane => "light-in-plane",
            Self::CameraInPlane => "camera-in-plane",
            Self::PlaneOutOfView => "plane-out-of-view",
            Self::NoExtent => "no-extent",
            Self::NoPlane => "no-plane",
        }
    }
}

impl core::fmt::Display for FallBack {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::LightAlongView => "the camera looks along the light, where the best warp is none",
            Self::LightInPlane => "the light lies in the plane or shines along it",
            Self::CameraInPlane => "the camera lies in the plane",
            Self::PlaneOutOfView => "the camera sees nothing of the plane that faces the light",
            Self::NoExtent => "what is seen has no extent that could be told from rounding",
            Self::NoPlane => "the camera sees no plane",
        })
    }
}

impl FitOutcome {
    /// The number in a plan.
    #[must_use]
    pub fn code(self) -> u32 {
        match self {
            Self::Fitted => 0,
            Self::NothingVisible => 1,
            Self::FellBackToUniform { why } => why as u32,
        }
    }

    /// The outcome with this number in a plan; `None` for a number that none has.
    #[must_use]
    pub fn of_code(code: u32) -> Option<Self> {
        match code {
            0 => Some(Self::Fitted),
            1 => Some(Self::NothingVisible),
            _ => FallBack::ALL.into_iter().find(|why| *why as u32 == code).map(|why| Self::FellBackToUniform { why }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_outcome_has_a_number_of_its_own() {
        let fall_backs = FallBack::ALL.into_iter().map(|why| FitOutcome::FellBackToUniform { why });
        for outcome in [FitOutcome::Fitted, FitOutcome::NothingVisible].into_iter().chain(fall_backs) {
            assert_eq!(FitOutcome::of_code(outcome.code()), Some(outcome));
        }
        assert_eq!(FitOutcome::of_code(99), None);
    }
}
