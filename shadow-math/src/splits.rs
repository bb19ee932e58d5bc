//! Where the range of a view is split into cascades.

#[cfg(not(feature = "std"))]
use crate::float::FloatFuncs;

/// The distance of split `i` of `count` cascades between `near` and `far`, in metres along the view's axis.
///
/// `lambda n (f / n)^(i / m) + (1 - lambda) (n + (f - n) i / m)`: the practical split scheme (Zhang, Sun, Xu and Lun 2006, "Parallel-split shadow
/// maps for large-scale virtual environments", section 4). `lambda`, from 0 to 1, is the share of the logarithmic scheme, under which the projection's
/// aliasing is the same in all cascades; what remains is uniform, without which the first cascades come out too short to be of use.
///
/// Needs `0 < near < far` and `i` at most `count`. Split 0 is exactly `near` and split `count` exactly `far`.
#[must_use]
pub fn practical_split(near: f64, far: f64, lambda: f64, i: usize, count: usize) -> f64 {
    if i == 0 || i >= count {
        return if i == 0 { near } else { far };
    }
    let share = i as f64 / count as f64;
    lambda * near * (far / near).powf(share) + (1.0 - lambda) * (near + (far - near) * share)
}

/// All splits of the practical scheme: `out` has one more than there are cascades. See [`practical_split`].
pub fn practical_splits(near: f64, far: f64, lambda: f64, out: &mut [f64]) {
    let count = out.len().saturating_sub(1);
    for (i, split) in out.iter_mut().enumerate() {
        *split = practical_split(near, far, lambda, i, count);
    }
}

/// The bin of a histogram that a distance along the view's axis, in metres, belongs to.
///
/// The `bins` bins are logarithmic: each reaches from a distance to the same multiple of it. What lies before `near` counts in the first one, and what
/// lies beyond `far` in the last. Needs `0 < near < far` and at least one bin; NaN counts in the first.
#[must_use]
pub fn histogram_bin(distance: f64, near: f64, far: f64, bins: usize) -> usize {
    let place = (distance / near).log2() / (far / near).log2() * bins as f64;
    // The conversion takes what is less than 0, and NaN, for 0.
    (place as usize).min(bins - 1)
}

/// The distance, in metres along the view's axis, at which a bin begins. Bin `bins` would begin at `far`.
///
/// The inverse of [`histogram_bin`], but that a distance within a rounding of it can count in the bin before.
#[must_use]
pub fn histogram_edge(bin: usize, near: f64, far: f64, bins: usize) -> f64 {
    edge_at(bin as f64, near, far, bins)
}

/// The distance at a place among the bins.
fn edge_at(place: f64, near: f64, far: f64, bins: usize) -> f64 {
    near * (far / near).powf(place / bins as f64)
}

/// Splits such that all cascades have the same number of samples, as far as each can be at least one bin long.
///
/// `histogram` has the number of samples in each bin of [`histogram_bin`], at least one bin; `out`, one more than there are cascades, is in metres along
/// the view's axis, from exactly `near` to exactly `far`, and strictly increasing. Needs `0 < near < far`.
///
/// To place splits by the distances that a picture has is Lauritzen, Salvi and Lefohn's idea (2011, "Sample distribution shadow maps"); equal shares are
/// the plainest way to: where half of the picture is one wall, half of the cascades are about that wall. Within a bin the samples count as spread evenly,
/// on the logarithmic scale on which bins are equally long. So without samples, and with as many in each bin, the splits are logarithmic.
///
/// Where a share would be shorter than a bin, about which the histogram knows nothing, a cascade takes a whole one, or its part of all bins
/// if there are more cascades than bins; its neighbours give what it takes.
pub fn quantile_splits(histogram: &[u32], near: f64, far: f64, out: &mut [f64]) {
    let (bins, count) = (histogram.len(), out.len().saturating_sub(1));
    let [first, inner @ .., last] = out else {
        out.fill(near);
        return;
    };
    (*first, *last) = (near, far);
    let total: u64 = histogram.iter().copied().map(u64::from).sum();
    let shortest = (bins as f64 / count as f64).min(1.0);
    let (mut bin, mut before, mut previous) = (0, 0.0, 0.0_f64);
    for (i, split) in inner.iter_mut().enumerate() {
        let done = i + 1;
        let share = done as f64 / count as f64;
        let quantile = if total == 0 {
            share * bins as f64
        } else {
            let wanted = share * total as f64;
            while bin + 1 < bins && before + f64::from(histogram[bin]) < wanted {
                before += f64::from(histogram[bin]);
                bin += 1;
            }
            let within = (wanted - before) / f64::from(histogram[bin].max(1));
            bin as f64 + within.max(0.0).min(1.0)
        };
        // Beyond the cascades before it and short of the room that those after it need.
        let latest = bins as f64 - (count - done) as f64 * shortest;
        let place = quantile.max(previous + shortest).min(latest);
        previous = place;
        *split = edge_at(place, near, far, bins);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Tables of OGRE 1.12.10 (`PSSMShadowCameraSetup::calculateSplitPoints`), which computes in single precision: lambda, and the splits.
    const TABLES: &[(f32, &[f32])] = &[
        (0.95, &[100.0, 2620.0005, 12835.002, 100000.0]),
        (0.95, &[1.0, 63.73472, 297.6247, 3000.0]),
        (0.95, &[1.0, 44.5683, 127.058655, 497.60455, 3000.0]),
        (0.95, &[0.5, 14.512501, 200.0]),
        (0.95, &[0.1, 2.6200006, 12.835002, 100.0]),
        (0.5, &[0.1, 125.537506, 255.02501, 425.0125, 1000.0]),
        (0.0, &[0.1, 250.07501, 500.05002, 750.025, 1000.0]),
        (1.0, &[0.1, 1.0, 10.0, 100.0, 1000.0]),
        (0.95, &[1.0, 8.546556, 17.879745, 31.44971, 55.066643, 102.50871, 206.44905, 444.36792, 1000.0]),
    ];

    #[test]
    fn the_practical_scheme_is_that_of_ogre() {
        for (lambda, table) in TABLES {
            let mut splits = [0.0; 9];
            let splits = &mut splits[..table.len()];
            let (near, far) = (f64::from(table[0]), f64::from(table[table.len() - 1]));
            practical_splits(near, far, f64::from(*lambda), splits);
            assert_eq!((splits[0], splits[splits.len() - 1]), (near, far));
            for (split, theirs) in splits.iter().zip(*table) {
                let theirs = f64::from(*theirs);
                // The share, the power and the sum are rounded to 24 bits: some ten times 2^-24.
                assert!((split - theirs).abs() <= 6e-7 * theirs, "{split} is not {theirs}");
            }
        }
    }

    #[test]
    fn bins_begin_at_their_edges() {
        for bin in 0..64 {
            let edge = histogram_edge(bin, 0.1, 500.0, 64);
            // A rounding beyond the edge, which is one of some units in the last place.
            assert_eq!(histogram_bin(edge * (1.0 + 1e-12), 0.1, 500.0, 64), bin);
            assert_eq!(histogram_bin(edge * (1.0 - 1e-12), 0.1, 500.0, 64), bin.saturating_sub(1));
        }
        assert_eq!(histogram_bin(1e9, 0.1, 500.0, 64), 63);
        assert_eq!(histogram_bin(-1.0, 0.1, 500.0, 64), 0);
        assert_eq!(histogram_bin(f64::NAN, 0.1, 500.0, 64), 0);
    }

    #[test]
    fn samples_that_are_spread_evenly_give_logarithmic_splits() {
        for histogram in [[0; 12], [7; 12]] {
            let mut splits = [0.0; 4];
            quantile_splits(&histogram, 1.0, 1000.0, &mut splits);
            for (split, expected) in splits.iter().zip([1.0, 10.0, 100.0, 1000.0]) {
                // Rounding of a power.
                assert!((split - expected).abs() < 1e-12 * expected, "{splits:?}");
            }
        }
    }

    #[test]
    fn a_wall_draws_the_splits_to_itself_but_no_closer_than_a_bin() {
        let mut histogram = [0; 10];
        histogram[5] = 1000;
        let mut splits = [0.0; 5];
        quantile_splits(&histogram, 1.0, 1024.0, &mut splits);
        // Bins begin at the powers of 2. The quantiles are at 5.25, 5.5 and 5.75; the second and the third give way.
        let expected = [1.0, 5.25_f64.exp2(), 6.25_f64.exp2(), 7.25_f64.exp2(), 1024.0];
        for (split, expected) in splits.iter().zip(expected) {
            // Rounding of a power.
            assert!((split - expected).abs() < 1e-12 * expected, "{splits:?}");
        }
        let mut few = [0.0; 5];
        quantile_splits(&[9, 0], 1.0, 16.0, &mut few);
        assert_eq!(few, [1.0, 2.0, 4.0, 8.0, 16.0], "with more cascades than bins each takes half a bin");
        quantile_splits(&[9, 0], 1.0, 16.0, &mut few[..2]);
        assert_eq!(few[..2], [1.0, 16.0]);
    }

    proptest! {
        #[test]
        fn shares_are_equal_where_no_cascade_is_a_bin_long(
            histogram in prop::collection::vec(0..100_u32, 1..64),
            count in 1..9_usize,
            far in 1.5..1e5_f64,
        ) {
            let mut splits = [0.0; 9];
            let splits = &mut splits[..=count];
            quantile_splits(&histogram, 1.0, far, splits);
            prop_assert_eq!((splits[0], splits[count]), (1.0, far));
            let bins = histogram.len() as f64;
            let places: std::vec::Vec<_> = splits.iter().map(|split| split.log2() / far.log2() * bins).collect();
            let samples_before = |place: f64| {
                let in_bin = |(bin, samples): (usize, &u32)| f64::from(*samples) * (place - bin as f64).max(0.0).min(1.0);
                histogram.iter().enumerate().map(in_bin).sum::<f64>()
            };
            let total = samples_before(bins);
            let shortest = (bins / count as f64).min(1.0);
            // Rounding of powers and logarithms, of places up to 64 and samples up to 6400.
            let (slack, samples_slack) = (1e-9, 1e-6);
            for i in 0..count {
                prop_assert!(places[i + 1] - places[i] >= shortest - slack, "{:?}", places);
            }
            if places.windows(2).all(|pair| pair[1] - pair[0] > shortest + slack) {
                for (i, place) in places.iter().enumerate() {
                    let share = total * i as f64 / count as f64;
                    prop_assert!((samples_before(*place) - share).abs() < samples_slack, "{} of {} before {}", share, total, place);
                }
            }
        }

        #[test]
        fn splits_increase(lambda in 0.0..=1.0_f64, near in 1e-3..10.0_f64, span in 1.01..1e6_f64, count in 1..9_usize) {
            let mut splits = [0.0; 9];
            let splits = &mut splits[..=count];
            practical_splits(near, near * span, lambda, splits);
            prop_assert!(splits.windows(2).all(|pair| pair[0] < pair[1]), "{:?}", splits);
        }
    }
}
