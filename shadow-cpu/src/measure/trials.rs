//! Trying biases on the maps of one frame: what acne each leaves, and what gaps.

use shadow_math::{MapAccess, Receiver, plan::LightPlan, plan::ViewPlan};
use shadow_scene::FramePlan;

use super::{
    cause::{Cause, Counts},
    gaps::Price,
    judge::Judge,
    rule::{EngineRule, Rule},
};

/// By how much a gap or a shift may exceed that of the automatic bias and still count as no wider, as a factor: lengths are small differences of depths in f32.
pub const WIDER: f32 = 1.02;

/// A length in metres below which it counts as none: a micrometre, more than rounding makes of nothing in scenes of some metres.
const LEAST: f32 = 1e-6;

/// A frame's plan and maps, on which biases can be tried: the maps do not depend on the bias, which is a matter of the receivers alone.
#[derive(Debug)]
pub struct Trials<'a, M> {
    judge: &'a Judge<'a>,
    plan: &'a FramePlan,
    triangles: &'a [u32],
    maps: &'a M,
    /// The same maps with the back faces of single-sided casters alone.
    back_faces: &'a M,
    /// The prices of the automatic bias, light by light, pixel by pixel.
    automatic: Vec<Vec<Price>>,
}

/// What a rule makes of one light's shadows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trial {
    /// The rule.
    pub rule: Rule,
    /// Wrong pixels by cause.
    pub counts: Counts,
    /// How far shadows begin from what casts them.
    pub gaps: Lengths,
    /// How far outlines are moved.
    pub shifts: Lengths,
    /// Pixels whose gap is wider than that of the automatic bias there, by more than [`WIDER`].
    pub wider: u64,
    /// Pixels whose outlines are moved farther than by the automatic bias there, by more than [`WIDER`].
    pub shifted: u64,
}

impl Trial {
    /// How many pixels shadow themselves.
    #[must_use]
    pub fn acne(&self) -> u64 {
        self.counts.count(Cause::Acne)
    }
}

/// Lengths in metres, over the pixels that ask a map under the automatic bias; all 0 if none does.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lengths {
    /// How many pixels ask.
    pub pixels: u64,
    /// Half of them are at most this.
    pub median: f32,
    /// 95 of 100 are at most this.
    pub percentile_95: f32,
    /// The longest.
    pub max: f32,
}

impl Lengths {
    /// Of lengths pixel by pixel, those that are NaN left out.
    #[must_use]
    pub fn of(lengths: impl IntoIterator<Item = f32>) -> Self {
        let mut lengths: Vec<f32> = lengths.into_iter().filter(|length| !length.is_nan()).collect();
        if lengths.is_empty() {
            return Self::default();
        }
        let last = lengths.len() - 1;
        let mut at = |share: f64| *lengths.select_nth_unstable_by((share * last as f64).round() as usize, f32::total_cmp).1;
        Self { median: at(0.5), percentile_95: at(0.95), max: at(1.0), pixels: last as u64 + 1 }
    }
}

/// Where acne begins between two amounts of a bias.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Onset {
    /// The largest amount that was tried and left acne.
    pub with_acne: f32,
    /// The smallest amount above it that was tried and left none.
    pub without: f32,
}

impl<'a, M: MapAccess + Sync> Trials<'a, M> {
    /// For a plan of the judge's scene and view, its maps, the same maps with back faces alone, and the triangles that the renderer's camera sees.
    ///
    /// # Panics
    ///
    /// If they are not of the judge's scene and view.
    #[must_use]
    pub fn new(judge: &'a Judge<'a>, plan: &'a FramePlan, triangles: &'a [u32], maps: &'a M, back_faces: &'a M) -> Self {
        let mut trials = Self { judge, plan, triangles, maps, back_faces, automatic: Vec::new() };
        trials.automatic = (0..plan.lights.len()).map(|light| trials.prices(light, Rule::Automatic { scale: 1.0 })).collect();
        trials
    }

    /// Tries a rule on a light.
    #[must_use]
    pub fn try_rule(&self, light: usize, rule: Rule) -> Trial {
        self.try_on(light, rule, self.maps)
    }

    /// Tries an engine's default on a light, on a map of those faces that the engine draws.
    #[must_use]
    pub fn try_engine(&self, light: usize, engine: &EngineRule) -> Trial {
        let maps = if engine.casts_back_faces { self.back_faces } else { self.maps };
        self.try_on(light, engine.of(&self.plan.lights[light]), maps)
    }

    fn try_on(&self, light: usize, rule: Rule, maps: &M) -> Trial {
        let prices = self.prices(light, rule);
        let count = |is_more: fn(&Price, &Price) -> bool| {
            prices.iter().zip(&self.automatic[light]).filter(|(price, automatic)| is_more(price, automatic)).count() as u64
        };
        Trial {
            rule,
            counts: self.counts(light, rule, maps),
            gaps: Lengths::of(prices.iter().map(|price| price.gap)),
            shifts: Lengths::of(prices.iter().map(|price| price.shift)),
            wider: count(|price, automatic| price.gap > WIDER * automatic.gap + LEAST),
            shifted: count(|price, automatic| price.shift > WIDER * automatic.shift + LEAST),
        }
    }

    /// Where acne begins as an amount of bias shrinks from `without`, which leaves none, to `with_acne`, which leaves some: by halving the interval so
    /// many times. `on_try` is called after each.
    #[must_use]
    pub fn onset(&self, light: usize, from: Onset, halvings: u32, rule: impl Fn(f32) -> Rule, on_try: impl Fn()) -> Onset {
        (0..halvings).fold(from, |onset, _| {
            let middle = 0.5 * (onset.with_acne + onset.without);
            let has_acne = self.counts(light, rule(middle), self.maps).count(Cause::Acne) > 0;
            on_try();
            if has_acne { Onset { with_acne: middle, ..onset } } else { Onset { without: middle, ..onset } }
        })
    }

    fn counts(&self, light: usize, rule: Rule, maps: &M) -> Counts {
        let ask = |light: &LightPlan, views: &[ViewPlan], receiver: &Receiver| rule.ask(light, views, receiver);
        self.judge.judge_rule(self.plan, light, self.triangles, maps, &ask).counts
    }

    fn prices(&self, light: usize, rule: Rule) -> Vec<Price> {
        let ask = |light: &LightPlan, views: &[ViewPlan], receiver: &Receiver| rule.ask(light, views, receiver);
        self.judge.prices(self.plan, light, self.triangles, &ask)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_those_of_pixels_that_ask() {
        let mut gaps: Vec<f32> = (0..=100_u8).map(f32::from).collect();
        gaps.extend([f32::NAN; 7]);
        gaps.reverse();
        assert_eq!(Lengths::of(gaps), Lengths { pixels: 101, median: 50.0, percentile_95: 95.0, max: 100.0 });
        assert_eq!(Lengths::of([f32::NAN]), Lengths::default());
    }
}
