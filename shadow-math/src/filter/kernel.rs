//! What a plan says of a light's filter: kernels and places, computed once in double precision.

#[cfg(not(feature = "std"))]
use crate::float::FloatFuncs;
use crate::{
    plan::{FILTER_BILINEAR, FILTER_CROSS, FILTER_DISC, FILTER_FOOTPRINT, FILTER_HARD, FILTER_SEPARABLE, LightPlan, PlanError},
    settings::Filter,
};

/// The most weights of a separable kernel.
pub const MAX_KERNEL: usize = 9;
/// How many places a disc has: as many as the plan's table holds.
pub const DISC_TAPS: usize = 16;

/// The witness kernels' weights, whole numbers as the lecture on filtering has them; they add up to 4, 12 and 52.
const WITNESS: [&[u8]; 3] = [&[1, 2, 1], &[1, 3, 4, 3, 1], &[1, 5, 12, 16, 12, 5, 1]];

/// What a Gaussian's weights add up to on one axis: its square is the largest whole number up to which f32 holds all.
const GAUSSIAN_TOTAL: f64 = 4096.0;
/// A Gaussian's standard deviation, as a share of its radius: two of them hold 95 % of it.
const GAUSSIAN_DEVIATION: f64 = 0.5;

/// Sixteen places in the unit disc, each at least 0.42 from all others and 0.01 from their mean to the disc's middle: the best of 4000 sets that were thrown at random.
const POISSON: [[f32; 2]; DISC_TAPS] = [
    [0.443_896, -0.021_485],
    [0.589_145, -0.608_864],
    [0.626_374, 0.695_822],
    [-0.912_552, -0.041_213],
    [0.057_918, 0.526_539],
    [0.900_705, -0.147_218],
    [0.082_920, -0.498_212],
    [-0.320_233, 0.338_031],
    [-0.512_567, -0.223_222],
    [0.858_850, 0.325_859],
    [-0.842_415, -0.486_803],
    [0.086_142, 0.973_802],
    [-0.062_568, -0.010_908],
    [-0.546_852, 0.805_478],
    [0.047_364, -0.953_649],
    [-0.483_419, -0.828_116],
];

/// The angle by which each place of a sunflower's spiral is turned from the one before, in radians (Vogel 1979).
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;

/// Writes a filter into a light's plan.
pub(crate) fn set_filter(plan: &mut LightPlan, filter: Filter, radius: Option<f32>) -> Result<(), PlanError> {
    let radius = match (filter.radii(), radius) {
        (None, None) => 0.0,
        (None, Some(_)) => return Err(PlanError::RadiusOfFixedFilter(filter)),
        (Some(radii), None) => radii.default,
        (Some(radii), Some(radius)) if radius >= radii.least && radius <= radii.most => radius,
        (Some(_), Some(radius)) => return Err(PlanError::FilterRadius { filter, radius }),
    };
    let mut square = |weights: &[f32]| {
        plan.filter = FILTER_SEPARABLE;
        plan.filter_taps = weights.len() as u32;
        plan.filter_reach = 0.5 * (weights.len() as f32 + 1.0);
        plan.filter_total = weights.iter().sum();
        plan.filter_table.as_flattened_mut()[..weights.len()].copy_from_slice(weights);
    };
    match filter {
        Filter::Hard => (plan.filter, plan.filter_reach) = (FILTER_HARD, 0.5),
        Filter::Bilinear => (plan.filter, plan.filter_reach) = (FILTER_BILINEAR, 1.0),
        Filter::Cross5 => (plan.filter, plan.filter_reach) = (FILTER_CROSS, 1.5),
        Filter::Footprint => (plan.filter, plan.filter_reach) = (FILTER_FOOTPRINT, 0.5),
        Filter::Box3 => square(&[1.0; 3]),
        Filter::Box4 => square(&[1.0; 4]),
        Filter::Box5 => square(&[1.0; 5]),
        Filter::Box6 => square(&[1.0; 6]),
        Filter::Box7 => square(&[1.0; 7]),
        Filter::Box8 => square(&[1.0; 8]),
        Filter::Box9 => square(&[1.0; 9]),
        Filter::Witness3 => square(&whole(WITNESS[0])[..3]),
        Filter::Witness5 => square(&whole(WITNESS[1])[..5]),
        Filter::Witness7 => square(&whole(WITNESS[2])[..7]),
        Filter::Gaussian => {
            let (weights, count) = gaussian(f64::from(radius));
            square(&weights[..count]);
        }
        Filter::Poisson => disc(plan, radius, |place| POISSON[place].map(f64::from)),
        Filter::Vogel => disc(plan, radius, |place| {
            let (angle, distance) = (place as f64 * GOLDEN_ANGLE, ((place as f64 + 0.5) / DISC_TAPS as f64).sqrt());
            [distance * angle.cos(), distance * (angle - core::f64::consts::FRAC_PI_2).cos()]
        }),
    }
    Ok(())
}

/// Whole numbers as f32, with zeros behind them.
fn whole(weights: &[u8]) -> [f32; MAX_KERNEL] {
    let mut numbers = [0.0; MAX_KERNEL];
    for (number, &weight) in numbers.iter_mut().zip(weights) {
        *number = f32::from(weight);
    }
    numbers
}

/// A Gaussian's weights at whole texels out to its radius, rounded to whole numbers that add up to [`GAUSSIAN_TOTAL`], and how many they are.
fn gaussian(radius: f64) -> ([f32; MAX_KERNEL], usize) {
    let half = radius.floor() as usize;
    let count = 2 * half + 1;
    let deviation = GAUSSIAN_DEVIATION * radius;
    let bell = |texel: usize| {
        let distance = texel as f64 - half as f64;
        (-0.5 * (distance / deviation) * (distance / deviation) * core::f64::consts::LOG2_E).exp2()
    };
    let sum: f64 = (0..count).map(bell).sum();
    let mut weights = [0.0; MAX_KERNEL];
    let mut rest = GAUSSIAN_TOTAL;
    for texel in 0..half {
        let weight = (bell(texel) / sum * GAUSSIAN_TOTAL + 0.5).floor();
        weights[texel] = weight as f32;
        weights[count - 1 - texel] = weight as f32;
        rest -= 2.0 * weight;
    }
    // The middle takes what rounding left over.
    weights[half] = rest as f32;
    (weights, count)
}

/// Writes the places of a disc into a plan: `place` has them in the unit disc.
fn disc(plan: &mut LightPlan, radius: f32, place: impl Fn(usize) -> [f64; 2]) {
    plan.filter = FILTER_DISC;
    plan.filter_taps = DISC_TAPS as u32;
    plan.filter_reach = radius;
    let table = plan.filter_table.as_flattened_mut();
    for tap in 0..DISC_TAPS {
        let place = place(tap).map(|coordinate| (f64::from(radius) * coordinate) as f32);
        table[2 * tap..][..2].copy_from_slice(&place);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(filter: Filter, radius: Option<f32>) -> LightPlan {
        let mut plan = LightPlan::default();
        set_filter(&mut plan, filter, radius).expect("the filter can be planned");
        plan
    }

    /// A witness kernel of n texels is the box of the one before with a box of two, weighted as the lecture has it; what is asked of it here are its tables.
    #[test]
    fn kernels_are_whole_symmetric_and_complete() {
        for filter in Filter::ALL {
            let plan = plan(filter, None);
            if plan.filter != FILTER_SEPARABLE {
                continue;
            }
            let count = plan.filter_taps as usize;
            let weights = &plan.filter_table.as_flattened()[..count];
            assert!(weights.iter().all(|&weight| weight > 0.0 && weight.fract() == 0.0), "{filter:?}: {weights:?}");
            assert!(weights.iter().eq(weights.iter().rev()), "{filter:?}: {weights:?}");
            assert_eq!(plan.filter_total, weights.iter().sum::<f32>());
            // Whole numbers up to here are exact in f32, and so is every sum of them.
            assert!(plan.filter_total * plan.filter_total <= 16_777_216.0);
        }
        assert_eq!(plan(Filter::Witness7, None).filter_total, 52.0);
        assert_eq!(plan(Filter::Gaussian, Some(4.0)).filter_taps, 9);
    }

    #[test]
    fn a_gaussian_is_one() {
        let plan = plan(Filter::Gaussian, Some(3.0));
        let weights = &plan.filter_table.as_flattened()[..7];
        for (texel, weight) in weights.iter().enumerate() {
            let distance = (texel as f32 - 3.0) / 1.5;
            let expected = weights[3] * (-0.5 * distance * distance).exp();
            // Each weight is rounded to a whole number, and the middle takes the rest: three at most.
            assert!((weight - expected).abs() <= 2.5, "{texel}: {weight} {expected}");
        }
    }

    #[test]
    fn places_lie_in_the_disc_and_apart() {
        for filter in [Filter::Poisson, Filter::Vogel] {
            let plan = plan(filter, Some(1.0));
            let places: [[f32; 2]; DISC_TAPS] = bytemuck::cast(plan.filter_table);
            for (index, a) in places.iter().enumerate() {
                assert!(a[0].hypot(a[1]) <= 1.0, "{filter:?} {index}: {a:?}");
                for b in &places[..index] {
                    assert!((a[0] - b[0]).hypot(a[1] - b[1]) > 0.25, "{filter:?}: {a:?} {b:?}");
                }
            }
            let mean: [f32; 2] = [0, 1].map(|axis| places.iter().map(|place| place[axis]).sum::<f32>() / DISC_TAPS as f32);
            assert!(mean[0].hypot(mean[1]) < 0.05, "{filter:?}: {mean:?}");
        }
    }

    #[test]
    fn radii_out_of_range_or_without_meaning_are_refused() {
        let mut plan = LightPlan::default();
        for radius in [0.9, 4.1, f32::NAN] {
            let error = set_filter(&mut plan, Filter::Gaussian, Some(radius)).expect_err("it is out of range");
            assert!(matches!(error, PlanError::FilterRadius { filter: Filter::Gaussian, .. }), "{error}");
        }
        let error = set_filter(&mut plan, Filter::Box3, Some(1.0)).expect_err("it has no meaning");
        assert_eq!(error, PlanError::RadiusOfFixedFilter(Filter::Box3));
    }
}
