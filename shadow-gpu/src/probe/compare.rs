//! The weights of the comparison sampler: one texel that passes the test among others that do not, and a lookup that moves past it.

use super::{
    DepthFormat, Measured,
    rig::{Drawing, Rig},
    triangles::{Random, rectangle},
    unmeasured,
};

/// Width and height of the texture in texels: a power of two, so that places between its texels are exact.
const SIZE: u32 = 16;

/// Column and row of the texel that passes.
const TEXEL: f64 = 7.0;

/// The depths of that texel and of the others.
const DEPTHS: [f64; 2] = [0.75, 0.25];

/// References between the two depths: half-way, and nearer to either.
const REFERENCES: [f32; 3] = [0.5, 0.375, 0.625];

/// Steps of a texel in which a lookup moves.
const STEPS: u32 = 4096;

/// Steps of a texel in which it moves on the second look, where the first saw every step: as fine as coordinates across the texture are exact in single precision.
const FINE_STEPS: f64 = 1_048_576.0;

/// How far weights may be from bilinear ones and still be called that: a step of the four bits that is the least of what is used.
const BILINEAR_TOLERANCE: f64 = 1.0 / 16.0;

/// What a comparison sampler with linear filtering averages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ComparisonFilter {
    /// The tests of four texels, with bilinear weights.
    Bilinear,
    /// Nothing: it tests the nearest texel.
    Nearest,
}

impl ComparisonFilter {
    /// How many texels are tested.
    #[must_use]
    pub const fn taps(self) -> u32 {
        match self {
            Self::Bilinear => 4,
            Self::Nearest => 1,
        }
    }
}

/// In how fine steps weights go from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WeightSteps {
    /// The steps are `2^-bits`.
    pub bits: u32,
    /// Whether they may be finer than that: no step was seen.
    pub or_finer: bool,
}

/// What the comparison sampler does.
#[derive(Clone, Debug, PartialEq)]
pub struct ComparisonRules {
    /// What it averages.
    pub filter: Measured<ComparisonFilter>,
    /// Whether it compares first and averages the results; the other order has no meaning for shadows.
    pub compares_first: Measured<bool>,
    /// In how fine steps its weights go.
    pub steps: Measured<WeightSteps>,
    /// How far its weights are from exact bilinear ones at worst.
    pub worst_weight_error: Measured<f64>,
}

/// The shares that passed, for lookups at these distances from the texel's centre, in texels.
async fn shares(rig: &Rig, format: DepthFormat, reference: f32, places: &[[f64; 2]]) -> Measured<Vec<f32>> {
    let texel = rectangle(SIZE, [TEXEL; 2], [TEXEL + 1.0; 2], DEPTHS[0]);
    let drawing = Drawing { format, clear: DEPTHS[1] as f32, ..Drawing::new(&texel) };
    let coordinate = |distance: f64| ((TEXEL + 0.5 + distance) / f64::from(SIZE)) as f32;
    let points: Vec<_> = places.iter().map(|[right, down]| [coordinate(*right), coordinate(*down), reference]).collect();
    rig.compare(SIZE, &drawing, &points).await
}

/// The exact bilinear weight of a texel at this distance.
fn bilinear([right, down]: [f64; 2]) -> f64 {
    (1.0 - right.abs()).max(0.0) * (1.0 - down.abs()).max(0.0)
}

/// How far shares are from bilinear weights at worst.
fn worst_error(places: &[[f64; 2]], shares: &[f32]) -> f64 {
    places.iter().zip(shares).map(|(place, share)| (f64::from(*share) - bilinear(*place)).abs()).fold(0.0, f64::max)
}

/// How many different numbers there are.
fn distinct(numbers: &[f32]) -> u32 {
    let mut sorted = numbers.to_vec();
    sorted.sort_by(f32::total_cmp);
    sorted.dedup();
    sorted.len() as u32
}

/// A lookup that moves to the right from the texel's centre to the next one's.
fn line() -> Vec<[f64; 2]> {
    (0..=STEPS).map(|step| [f64::from(step) / f64::from(STEPS), 0.0]).collect()
}

/// Lookups scattered around the texel, as far as the centres of its neighbours: round places alone could hide how weights are rounded.
fn scattered() -> Vec<[f64; 2]> {
    let mut random = Random(1);
    let mut place = || f64::from(random.below(2 * FINE_STEPS as u32)) / FINE_STEPS - 1.0;
    (0..STEPS).map(|_| [place(), place()]).collect()
}

/// In how fine steps the shares along [`line`] go; where each of them is another, a closer look says.
async fn steps(rig: &Rig, format: DepthFormat, along: &[f32]) -> Measured<WeightSteps> {
    let count = distinct(along);
    if count <= STEPS {
        // Of n bits there are 2^n + 1 weights from 0 to 1, or 2^n if 1 is not among them.
        return Ok(WeightSteps { bits: f64::from(count - 1).log2().round() as u32, or_finer: false });
    }
    /// Where the closer look begins: no round number, at which weights could be round too.
    const BEGIN: f64 = 0.3125;
    let closer: Vec<_> = (0..STEPS).map(|step| [BEGIN + f64::from(step) / FINE_STEPS, 0.0]).collect();
    let count = distinct(&shares(rig, format, REFERENCES[0], &closer).await?);
    let bits = (f64::from(count) * FINE_STEPS / f64::from(STEPS)).log2().round() as u32;
    Ok(WeightSteps { bits, or_finer: count == STEPS })
}

/// Measures what the comparison sampler does with a format.
pub(super) async fn measure(rig: &Rig, format: DepthFormat) -> ComparisonRules {
    let (line, scattered) = (line(), scattered());
    let looked = async {
        let along = shares(rig, format, REFERENCES[0], &line).await?;
        let around = shares(rig, format, REFERENCES[0], &scattered).await?;
        Ok((along, around))
    };
    let (along, around) = match looked.await {
        Ok(shares) => shares,
        Err(reason) => {
            let error = || Err(Clone::clone(&reason));
            return ComparisonRules {
                filter: error(),
                compares_first: Err(reason.clone()),
                steps: Err(reason.clone()),
                worst_weight_error: Err(reason),
            };
        }
    };
    let worst = worst_error(&line, &along).max(worst_error(&scattered, &around));
    let is_test = |share: &f32| *share == 0.0 || *share == 1.0;
    if along.iter().chain(&around).all(is_test) && distinct(&along) > 1 {
        let none = || "the sampler does not average".to_string();
        return ComparisonRules {
            filter: Ok(ComparisonFilter::Nearest),
            compares_first: unmeasured(none()),
            steps: unmeasured(none()),
            worst_weight_error: Ok(worst),
        };
    }
    let filter = if worst <= BILINEAR_TOLERANCE {
        Ok(ComparisonFilter::Bilinear)
    } else {
        unmeasured(format!("its weights are up to {worst:.3} from bilinear ones"))
    };
    let compares_first = async {
        // Comparing first, the reference takes no part as long as it is between the two depths.
        let low = shares(rig, format, REFERENCES[1], &line).await?;
        let high = shares(rig, format, REFERENCES[2], &line).await?;
        Ok(low == along && high == along)
    };
    ComparisonRules {
        filter,
        compares_first: compares_first.await,
        steps: steps(rig, format, &along).await,
        worst_weight_error: Ok(worst),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_texels_weights_are_those_of_its_four_lookups() {
        assert_eq!(bilinear([0.25, -0.5]), 0.375);
        assert_eq!(bilinear([1.5, 0.0]), 0.0);
        let sum: f64 = [[0.3, 0.2], [-0.7, 0.2], [0.3, -0.8], [-0.7, -0.8]].map(bilinear).iter().sum();
        assert!((sum - 1.0).abs() < 1e-15);
    }

    #[test]
    fn coarse_weights_are_far_from_bilinear() {
        let line = line();
        let quantised: Vec<f32> = line.iter().map(|place| (bilinear(*place) * 256.0).round() as f32 / 256.0).collect();
        assert_eq!(distinct(&quantised), 257);
        assert_eq!(worst_error(&line, &quantised), 0.5 / 256.0);
    }
}
