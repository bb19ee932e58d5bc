//! What the certificate of the automatic bias rests on: rules that are tried on the maps of one frame.

use std::{fmt::Write, time::Instant};

use shadow_cpu::{
    measure::{Cause, ENGINES, Judge, Onset, Rule, Trials},
    trace::{CameraView, Sampling, Tracer},
};
use shadow_math::{Filter, ShadowSettings};
use shadow_scene::{FramePlan, Scene, builtin, import};
use shadow_tests::{
    lights::{lit_by, one_of_each},
    renderers::{cpu, scene_files, scenes},
    report::say,
};

/// Lets `with` try rules on the maps of a scene.
fn on_trials<T>(
    scene: &Scene,
    settings: &ShadowSettings,
    (width, height): (u32, u32),
    with: impl FnOnce(&Trials<'_, shadow_cpu::resolve::ShadowMaps>, &FramePlan) -> T,
) -> T {
    let camera = scene.cameras()[0].camera;
    let tracer = Tracer::new(scene, 0).expect("threads start");
    let judge = Judge::new(&tracer, CameraView::new(&camera, width, height), Sampling { side: 1 }, &|| {});
    let plan = FramePlan::new(scene, &camera, settings, width, height, None).expect("the scene can be planned");
    let prepared = cpu().prepare(scene);
    let triangles = cpu().camera(&prepared, &plan).expect("the picture fits").triangles;
    let maps = cpu().shadow_maps(&prepared, &plan);
    with(&Trials::new(&judge, &plan, &triangles, &maps), &plan)
}

/// A tilted plane meets texels at every phase: its acne begins where the bias is a little less than h(g), and with h(g) there is none.
#[test]
fn on_a_plane_acne_begins_just_below_the_automatic_bias() {
    let scene = builtin::by_name("tilted-plane").expect("it is built in");
    for filter in [Filter::Hard, Filter::Bilinear] {
        let settings = ShadowSettings { filter, map_size: 256, ..ShadowSettings::default() };
        on_trials(&scene, &settings, (640, 360), |trials, _| {
            let scaled = |scale| Rule::Automatic { scale };
            assert_eq!(trials.try_rule(0, scaled(1.0)).acne(), 0);
            assert!(trials.try_rule(0, scaled(0.5)).acne() > 1000);
            let from = Onset { with_acne: 0.5, without: 1.0 };
            let onset = trials.onset(0, from, 10, scaled, || ());
            // Half a thousandth is the last halving. The taps' worst place is reached within a hundredth of a texel by one pixel in ten thousand.
            assert!(onset.without - onset.with_acne < 0.0006 && onset.with_acne > 0.97, "{filter:?}: {onset:?}");
        });
    }
}

/// What is wider is wider, and more of a constant leaves less acne.
#[test]
fn gaps_grow_and_acne_shrinks_with_the_bias() {
    let settings = ShadowSettings { map_size: 512, ..ShadowSettings::default() };
    on_trials(&builtin::demo(), &settings, (320, 180), |trials, _| {
        let lengths = [0.0, 1e-3, 1e-2, 0.1, 1.0];
        let tries = lengths.map(|metres| trials.try_rule(0, Rule::Metres(metres)));
        for (metres, pair) in lengths.into_iter().zip(tries.windows(2)) {
            assert!(pair[1].gaps.median > pair[0].gaps.median && pair[1].acne() <= pair[0].acne(), "{metres} m: {pair:?}");
            assert!(pair[1].wider >= pair[0].wider, "{metres} m: {pair:?}");
        }
        let automatic = trials.try_rule(0, Rule::Automatic { scale: 1.0 });
        assert_eq!((automatic.acne(), automatic.wider), (0, 0));
        let twice = trials.try_rule(0, Rule::Automatic { scale: 2.0 });
        assert!(twice.wider * 10 > twice.gaps.pixels * 9, "{twice:?}");
    });
}

/// Every engine's default fails on real scenes: by acne or by gaps wider than those of the automatic bias, which has neither.
#[test]
fn fixed_defaults_fail_where_the_automatic_bias_holds() {
    let Some(folder) = scenes("fixed_defaults_fail_where_the_automatic_bias_holds") else { return };
    let start = Instant::now();
    let mut frames = 0_u32;
    let mut failures = [[0_u32; 3]; ENGINES.len()];
    for file in scene_files(&folder).iter().filter(|file| !file.starts_with("invalid/")) {
        // Another test says which files are refused.
        let Ok(scene) = import(&folder.join(file)) else { continue };
        for (name, light) in one_of_each(&scene) {
            on_trials(&lit_by(&scene, name, light), &ShadowSettings::default(), (192, 108), |trials, plan| {
                let automatic = trials.try_rule(0, Rule::Automatic { scale: 1.0 });
                assert_eq!(automatic.acne(), 0, "{file}, {name}");
                // Where nothing asks a map, no bias has anything to do.
                if automatic.gaps.pixels == 0 {
                    return;
                }
                frames += 1;
                for (engine, failures) in ENGINES.iter().zip(&mut failures) {
                    let trial = trials.try_rule(0, engine.of(&plan.lights[0]));
                    let has_acne = trial.counts.count(Cause::Acne) > 0;
                    let is_wide = trial.gaps.median > 1.02 * automatic.gaps.median;
                    failures[0] += u32::from(has_acne);
                    failures[1] += u32::from(is_wide);
                    failures[2] += u32::from(has_acne || is_wide);
                }
            });
        }
    }
    let mut table = format!("of {frames} frames, by acne, by the gap, by either ({:.0} s):\n", start.elapsed().as_secs_f64());
    for (engine, [acne, gap, either]) in ENGINES.iter().zip(failures) {
        let _ = writeln!(table, "  {:10} {acne:4} {gap:4} {either:4}", engine.name);
    }
    say(&table);
    for (engine, [.., either]) in ENGINES.iter().zip(failures) {
        // The best of them, MJP's, is what planes need but for rounding and for steep slopes: it fails in a quarter of these small pictures.
        assert!(5 * either > frames, "{} fails in {either} of {frames} frames", engine.name);
    }
}
