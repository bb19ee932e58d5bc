//! How far a share that was found by sampling can be from the true one.
//!
//! Of `n` independent samples, each of which sees the light with probability p, k see it. The interval of Clopper and Pearson ("The use of confidence or
//! fiducial limits illustrated in the case of the binomial", Biometrika 1934) reaches from the p for which k or more had half the doubt's probability to
//! that for which k or fewer had: it holds the true share at least as often as it says, whatever that is. Stratified samples have
//! different probabilities each; their sum lies no farther from its mean than that of n equal ones (Hoeffding 1956), so that the interval holds for them as well.

/// How often, among pixels, the true share lies in the interval.
pub const CONFIDENCE: f64 = 0.95;

/// The intervals for all outcomes of a number of samples.
#[derive(Clone, Debug)]
pub struct Intervals(Vec<[f64; 2]>);

impl Intervals {
    /// The intervals of `samples` samples that hold the true share with probability `confidence`, between 0 and 1, or more.
    #[must_use]
    pub fn new(samples: u32, confidence: f64) -> Self {
        let doubt = 0.5 * (1.0 - confidence);
        let upper = |lit: u32| if lit == samples { 1.0 } else { share_with_tail(samples, lit, doubt) };
        // What is true of those that see the light is true, the other way round, of those that do not.
        Self((0..=samples).map(|lit| [1.0 - upper(samples - lit), upper(lit)]).collect())
    }

    /// The least and the largest share when `lit` samples saw the light; all there is for more than were taken.
    #[must_use]
    pub fn of(&self, lit: u32) -> [f64; 2] {
        self.0.get(lit as usize).copied().unwrap_or([0.0, 1.0])
    }

    /// The width of the widest interval.
    #[must_use]
    pub fn widest(&self) -> f64 {
        self.0.iter().map(|[least, most]| most - least).fold(0.0, f64::max)
    }
}

/// The share p at which `lit` or fewer of `samples` have probability `doubt`: by bisection, since the probability falls with p.
fn share_with_tail(samples: u32, lit: u32, doubt: f64) -> f64 {
    /// Halvings: as many as f64 has bits.
    const STEPS: u32 = 53;
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..STEPS {
        let middle = 0.5 * (low + high);
        if lower_tail(samples, lit, middle) > doubt {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// The probability that `lit` or fewer of `samples` see the light when each does with probability `share`, strictly between 0 and 1.
fn lower_tail(samples: u32, lit: u32, share: f64) -> f64 {
    let (share_log, other_log) = (share.ln(), (-share).ln_1p());
    // The logarithm of the number of ways to choose, built up term by term.
    let mut ways_log = 0.0;
    let mut sum = 0.0;
    for k in 0..=lit {
        if k > 0 {
            ways_log += (f64::from(samples - k + 1) / f64::from(k)).ln();
        }
        sum += (ways_log + f64::from(k) * share_log + f64::from(samples - k) * other_log).exp();
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the closed forms of the ends, and tables: none of 10 gives at most 1 - 0.025^(1/10) = 0.3085, 5 of 10 gives 0.1871 to 0.8129
    /// (Clopper and Pearson 1934, table of confidence belts for 0.95).
    #[test]
    fn intervals_are_those_of_the_tables() {
        let intervals = Intervals::new(10, 0.95);
        let [least, most] = intervals.of(0);
        assert_eq!(least, 0.0);
        assert!((most - (1.0 - 0.025_f64.powf(0.1))).abs() < 1e-12, "{most}");
        assert_eq!(intervals.of(10)[1], 1.0);
        assert!((intervals.of(10)[0] - 0.025_f64.powf(0.1)).abs() < 1e-12);
        let [least, most] = intervals.of(5);
        assert!((least - 0.1871).abs() < 5e-5 && (most - 0.8129).abs() < 5e-5, "{least} to {most}");
        let [least, most] = intervals.of(1);
        assert!((least - 0.0025).abs() < 5e-5 && (most - 0.4450).abs() < 5e-5, "{least} to {most}");
    }

    /// The probability that the interval holds the true share, summed over all outcomes, is never below what is promised.
    #[test]
    fn the_true_share_lies_inside_as_often_as_promised() {
        let samples = 64;
        let intervals = Intervals::new(samples, 0.95);
        for step in 1..200 {
            let share = f64::from(step) / 200.0;
            let probability =
                |lit: u32| lower_tail(samples, lit, share) - if lit == 0 { 0.0 } else { lower_tail(samples, lit - 1, share) };
            let held: f64 = (0..=samples)
                .filter(|&lit| {
                    let [least, most] = intervals.of(lit);
                    (least..=most).contains(&share)
                })
                .map(probability)
                .sum();
            assert!(held >= 0.95, "{held} at {share}");
        }
    }
}
