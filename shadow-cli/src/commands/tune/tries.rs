//! Which biases are tried on a light, and in which order.

use shadow_cpu::measure::{ENGINES, Onset, Rule, Trial, Trials};
use shadow_math::MapAccess;

use super::{BiasReport, CurvesReport, length};

/// The curve of the automatic bias is tried at so many equal steps from nothing to all of it.
const SCALES: u32 = 16;
/// Where acne begins is then found by halving a step so many times: to a thousandth of the bias.
const SCALE_HALVINGS: u32 = 6;
/// The smallest constant bias that is tried, as an exponent of two on the scene's diagonal, whose whole length is the largest: a millionth.
const LEAST_EXPONENT: f32 = -20.0;
/// The least constant without acne is found by halving the range of exponents so many times: to 0.7 % of it.
const CONSTANT_HALVINGS: u32 = 11;
/// The curve of the constant bias: so many octaves below its least length without acne, and above.
const OCTAVES: [i8; 12] = [-8, -7, -6, -5, -4, -3, -2, -1, 0, 1, 2, 3];
/// How many shares of the automatic bias are tried, at most.
pub(super) const TRIED_SHARES: u32 = SCALES + 1 + SCALE_HALVINGS;
/// How many rules are tried for each light, at most: the shares, the two ends of the constants' range and what lies between, the curve, the constant that was tuned and the
/// engines. Whatever is left out counts as done.
pub(super) const STEPS_OF_LIGHT: u64 =
    (TRIED_SHARES + 2 + CONSTANT_HALVINGS) as u64 + OCTAVES.len() as u64 + 1 + ENGINES.len() as u64;

/// What was tried on a light.
pub(super) struct Tries {
    pub(super) rules: Vec<BiasReport>,
    pub(super) onset: Option<Onset>,
    pub(super) curves: CurvesReport,
}

impl Tries {
    /// Tries everything on a light. `diagonal` is the scene's, in metres; `step` is called [`STEPS_OF_LIGHT`] times.
    pub(super) fn on<M: MapAccess + Sync>(trials: &Trials<'_, M>, index: usize, diagonal: f32, step: &dyn Fn()) -> Self {
        let done = std::cell::Cell::new(0);
        let tick = || {
            done.set(done.get() + 1);
            step();
        };
        let attempt = |rule: Rule| {
            let trial = trials.try_rule(index, rule);
            tick();
            trial
        };
        let scaled = |scale: f32| Rule::Automatic { scale };
        let scales: Vec<(f32, Trial)> =
            (0..=SCALES).map(|scale| scale as f32 / SCALES as f32).map(|scale| (scale, attempt(scaled(scale)))).collect();
        // The largest share with acne, unless that is all of the bias.
        let last_with_acne = scales.iter().rposition(|(_, trial)| trial.acne() > 0);
        let onset = last_with_acne.and_then(|last| {
            let from = Onset { with_acne: scales[last].0, without: scales.get(last + 1)?.0 };
            Some(trials.onset(index, from, SCALE_HALVINGS, scaled, tick))
        });

        let of_exponent = |exponent: f32| Rule::Metres(diagonal * exponent.exp2());
        let (least, most) = (attempt(of_exponent(LEAST_EXPONENT)), attempt(of_exponent(0.0)));
        let can_be_tuned = least.acne() > 0 && most.acne() == 0;
        let tuned = can_be_tuned.then(|| {
            let from = Onset { with_acne: LEAST_EXPONENT, without: 0.0 };
            trials.onset(index, from, CONSTANT_HALVINGS, of_exponent, tick).without
        });
        let constants: Vec<Trial> = tuned.map_or_else(Vec::new, |tuned| {
            OCTAVES.iter().map(|&octave| attempt(of_exponent(tuned + f32::from(octave)))).collect()
        });

        // The last of the shares is all of the bias.
        let automatic = scales.last().map(|(_, trial)| *trial);
        let report = |name: String, trial: &Trial| BiasReport::new(name, trial, automatic.as_ref().unwrap_or(trial));
        let mut rules: Vec<BiasReport> = scales.last().map(|(_, trial)| report("automatic".into(), trial)).into_iter().collect();
        rules.extend(tuned.map(|exponent| {
            let metres = diagonal * exponent.exp2();
            let trial = attempt(of_exponent(exponent));
            let name = format!("constant, tuned to {}", length(f64::from(metres)));
            BiasReport { amount: Some(metres), ..report(name, &trial) }
        }));
        rules.extend(ENGINES.iter().map(|engine| {
            let trial = trials.try_engine(index, engine);
            tick();
            BiasReport {
                what: Some(engine.what),
                casts_back_faces: Some(engine.casts_back_faces),
                ..report(engine.name.into(), &trial)
            }
        }));
        let of_amount =
            |name: &str, amount: f32, trial: &Trial| BiasReport { amount: Some(amount), ..report(name.into(), trial) };
        let curves = CurvesReport {
            automatic: scales.iter().map(|(scale, trial)| of_amount("automatic", *scale, trial)).collect(),
            constant: constants
                .iter()
                .filter_map(|trial| {
                    let Rule::Metres(metres) = trial.rule else { return None };
                    Some(of_amount("constant", metres, trial))
                })
                .collect(),
        };
        for _ in done.get()..STEPS_OF_LIGHT {
            step();
        }
        Self { rules, onset, curves }
    }
}
