//! Fits and splits, as users of the program meet them.

use serde_json::Value;

use crate::program::Folder;

const SUN: [&str; 2] = ["--light", "directional:dir=1,-2,1;lux=20000"];

/// The views of the first light of a plan.
fn views(plan: &Value) -> &Vec<Value> {
    plan["lights"][0]["views"].as_array().expect("a light has views")
}

#[test]
fn a_plan_says_what_became_of_each_view() {
    let folder = Folder::new("cameras-plan");
    let plan = |options: &[&str]| folder.json(&[&["plan", "--json", "--map-size", "512"], &SUN[..], options].concat());
    let warped = plan(&["--fit", "lispsm"]);
    assert_eq!(views(&warped)[0]["outcome"], "fitted");
    assert_eq!(views(&warped)[0]["is_warped"], true);
    let cascades =
        plan(&["--split", "cascades", "--cascades", "3", "--lambda", "0.5", "--cascade-sizes", "512,256", "--fit", "focused"]);
    let light = &cascades["lights"][0];
    assert_eq!(light["split"], "cascades");
    let sizes: Vec<_> = views(&cascades).iter().map(|view| view["size"].as_u64()).collect();
    assert_eq!(sizes, [Some(512), Some(256), Some(256)], "the last size goes on");
    let ends: Vec<f64> = light["cascade_ends"].as_array().into_iter().flatten().filter_map(Value::as_f64).collect();
    assert!(ends.len() == 2 && ends[0] < ends[1], "{ends:?}");
    // A sun that shines along the floor leaves nothing of it to a plane-optimal map.
    let fallen = folder.json(&[
        "plan",
        "--json",
        "--fit",
        "plane-optimal",
        "--plane",
        "0,1,0,0",
        "--light",
        "directional:dir=1,0,0;lux=1",
    ]);
    assert_eq!(views(&fallen)[0]["outcome"], "light-in-plane");
    assert!(fallen["notes"].to_string().contains("shines along it"), "{}", fallen["notes"]);
}

/// What stands in for what is not there is said: the plane that was found, and cascades without a map.
#[test]
fn a_plan_says_what_was_found_and_what_is_missing() {
    let folder = Folder::new("cameras-found");
    let plan = |options: &[&str]| folder.json(&[&["plan", "--json"], &SUN[..], options].concat());
    let found = plan(&["--fit", "plane-optimal"]);
    let numbers = |plan: &Value| -> Vec<f64> {
        plan["lights"][0]["plane"].as_array().into_iter().flatten().filter_map(Value::as_f64).collect()
    };
    assert_eq!(numbers(&found), [0.0, 1.0, 0.0, 0.0], "the demo's ground");
    assert_eq!(numbers(&plan(&["--fit", "plane-optimal", "--plane", "0,2,0,-1"])), [0.0, 2.0, 0.0, -1.0]);
    assert!(plan(&["--fit", "focused"])["lights"][0]["plane"].is_null());
    let is_noted = |plan: &Value| plan["notes"].to_string().contains("3 of 4 cascades have no map");
    // The demo's camera sees from 3 to 20 m.
    let (beyond, before) =
        (plan(&["--split", "cascades", "--splits", "30,40,50"]), plan(&["--split", "cascades", "--splits", "1,2,3"]));
    assert!(is_noted(&beyond) && is_noted(&before));
    assert_eq!((views(&beyond).len(), views(&before).len()), (1, 4));
    assert!(!is_noted(&plan(&["--split", "cascades", "--splits", "5,10,15"])));
}

/// Where no pixel asks a map there is no m: not the best one.
#[test]
fn what_nobody_asks_has_no_aliasing() {
    let folder = Folder::new("cameras-unasked");
    let options = ["--size", "64x36", "--map-size", "64", "--filter", "hard", "--frames", "1", "--backend", "cpu"];
    let unasked = [&["measure", "--shadow-distance", "0.5"], &options[..], &SUN[..]].concat();
    let report = folder.json(&[&unasked[..], &["--json"]].concat());
    let aliasing = &report["techniques"][0]["aliasing"];
    assert_eq!(aliasing["pixels"], 0);
    for key in ["median", "percentile_95", "max", "share_above_one"] {
        assert!(aliasing[key].is_null(), "{key}: {aliasing}");
    }
    let output = folder.run(&unasked);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let row = text.lines().find(|line| line.starts_with("command line")).expect("the technique has a row");
    assert!(row.contains("  -  "), "{row}");
}

#[test]
fn a_plan_is_drawn() {
    let folder = Folder::new("cameras-draw");
    let output = folder.run(&[&["plan", "--split", "cascades", "--draw", "cameras.svg"], &SUN[..]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let drawing = std::fs::read_to_string(folder.path().join("cameras.svg")).expect("it was drawn");
    assert!(drawing.starts_with("<svg") && drawing.ends_with("</svg>\n"));
    assert!(["from above", "from the side", "map 3"].into_iter().all(|said| drawing.contains(said)), "{drawing}");
    assert!(!drawing.contains("NaN") && !drawing.contains("inf"), "every place is a number");
    // Of a map that reaches beyond the horizon all 17 lines that lead there are drawn up to it, and those across that lie before it.
    let beyond = ["plan", "--fit", "plane-optimal", "--light", "directional:dir=0.2,-1,0;lux=1000", "--draw", "horizon.svg"];
    assert_eq!(folder.run(&beyond).status.code(), Some(0));
    let drawing = std::fs::read_to_string(folder.path().join("horizon.svg")).expect("it was drawn");
    let lines = drawing.matches("side0)\"><line ").count();
    assert!(lines > 17 + 10 && lines <= 17 + 17, "{lines} lines from above");
    assert_eq!(drawing.matches("<circle ").count(), 2, "the camera, in both drawings");
    let refused = folder.refusal(&["plan", "--draw", "cameras.png"]);
    assert!(refused.contains(".svg"), "{refused}");
}

#[test]
fn choices_without_a_meaning_are_refused_with_a_way_out() {
    let folder = Folder::new("cameras-refused");
    for (options, parts) in [
        (&["--lambda", "0.5"][..], ["--lambda", "--split cascades"]),
        (&["--plane", "0,1,0,0"], ["--plane", "--fit plane-optimal"]),
        (&["--fit", "best"], ["best", "plane-optimal"]),
        (&["--fit", "plane-optimal", "--plane", "0,0,0,1"], ["0,0,0,1", "0,1,0,0"]),
        (&["--split", "cascades", "--cascades", "9"], ["9", "1..=8"]),
        (&["--split", "cascades", "--splits", "5,20"], ["2 distances", "there are 4"]),
        (&["--split", "cascades", "--splits", "5,4,3"], ["4 m", "increasing"]),
        (&["--split", "cascades", "--lambda", "2"], ["2", "between 0"]),
        (&["--split", "cascades", "--padding", "-1"], ["-1 m", "at least 0"]),
        (&["--split", "cascades", "--stabilise", "--fit", "lispsm"], ["lispsm", "uniform"]),
        (&["--split", "cascades", "--stabilise", "--map-size", "1000"], ["512", "1024"]),
        (&["--split", "cascades", "--cascade-sizes", "4096"], ["4096", "2048"]),
        (&["--split", "cascades", "--lispsm-factors", "2"], ["--lispsm-factors", "--fit lispsm"]),
        (&["--split", "cascades", "--fit", "plane-optimal"], ["plane-optimal", "one map"]),
        (&["--fit", "lispsm", "--store", "linear"], ["linear", "lispsm"]),
        (&["--fit", "plane-optimal", "--store", "depth16"], ["depth16", "centimetres"]),
        (&["--fit", "lispsm", "--bias", "ogre-2006"], ["ogre-2006", "lispsm"]),
        (&["--shadow-distance", "0"], ["0 m", "above 0"]),
    ] {
        let refused = folder.refusal(&[&["render", "--size", "32x18"], &SUN[..], options].concat());
        assert!(parts.iter().all(|part| refused.contains(part)), "{options:?}: {refused}");
    }
    let lamp = folder.refusal(&["render", "--split", "cascades", "--light", "point:pos=0,4,0;cd=100"]);
    assert!(lamp.contains("--light-settings"), "{lamp}");
    let warped = folder.refusal(&[&["render", "--fit", "lispsm", "--show", "light-view"], &SUN[..]].concat());
    assert!(warped.contains("warped") && warped.contains("shadow-map"), "{warped}");
    let small = ["--size", "4000x4000", "--fit", "focused", "--fit-from", "samples", "--memory-limit", "20MiB"];
    let memory = folder.refusal(&[&["render"], &small[..]].concat());
    assert!(memory.contains("pass before the plan") && memory.contains("--size"), "{memory}");
}

/// What is seen from below the ground, or in the sky, is nothing; that is a picture, too.
#[test]
fn a_camera_that_sees_nothing_draws_nothing() {
    let folder = Folder::new("cameras-nothing");
    let away = ["--camera", "eye=0,3,3;target=0,30,3.1;fov=40", "--size", "32x18", "--output", "sky.png"];
    for options in [
        &["--fit", "focused", "--fit-from", "samples"][..],
        &["--split", "cascades", "--splits", "histogram"],
        &["--fit", "plane-optimal"],
    ] {
        let output = folder.run(&[&["render"], &SUN[..], &away[..], options].concat());
        assert_eq!(output.status.code(), Some(0), "{options:?}: {}", String::from_utf8_lossy(&output.stderr));
    }
}
