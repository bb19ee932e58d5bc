//! What many measurements of the same thing say: the middle, and how far they lie apart.

use serde::Serialize;

/// The middle of some measurements and how far they lie apart.
///
/// A busy machine only ever makes work slower, so that the distribution has a tail on one side: the median and the quartiles hardly
/// move with a few disturbed measurements, as a mean and a deviation would.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Spread {
    /// The smallest.
    pub(crate) min: f64,
    /// A quarter of the measurements lie below.
    pub(crate) lower_quartile: f64,
    /// Half of them lie below.
    pub(crate) median: f64,
    /// Three quarters of them lie below.
    pub(crate) upper_quartile: f64,
    /// The largest.
    pub(crate) max: f64,
}

impl Spread {
    /// The spread of some measurements; all 0 if there are none.
    pub(crate) fn of(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        Self {
            min: quantile(&values, 0.0),
            lower_quartile: quantile(&values, 0.25),
            median: quantile(&values, 0.5),
            upper_quartile: quantile(&values, 0.75),
            max: quantile(&values, 1.0),
        }
    }
}

/// The value below which that share of sorted values lies, interpolated linearly between neighbours.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return 0.0 };
    let place = share * last as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(last);
    sorted[below] + (sorted[above] - sorted[below]) * place.fract()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quartiles_lie_between_neighbours() {
        let spread = Spread::of(vec![40.0, 10.0, 20.0, 30.0]);
        assert_eq!((spread.min, spread.max), (10.0, 40.0));
        assert_eq!((spread.lower_quartile, spread.median, spread.upper_quartile), (17.5, 25.0, 32.5));
        let spread = Spread::of(vec![5.0, 1.0, 9.0]);
        assert_eq!((spread.lower_quartile, spread.median, spread.upper_quartile), (3.0, 5.0, 7.0));
    }

    #[test]
    fn one_disturbed_measurement_moves_only_the_maximum() {
        let calm = Spread::of(vec![1.0; 9]);
        let disturbed = Spread::of([vec![1.0; 8], vec![100.0]].concat());
        assert_eq!(Spread { max: 1.0, ..disturbed }, calm);
    }

    #[test]
    fn one_measurement_is_all_of_its_spread_and_none_is_zero() {
        let one = Spread::of(vec![7.0]);
        assert_eq!((one.min, one.lower_quartile, one.median, one.max), (7.0, 7.0, 7.0, 7.0));
        assert_eq!(Spread::of(Vec::new()).median, 0.0);
    }
}
