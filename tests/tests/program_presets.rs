//! Presets and conversions, as users of the program meet them.

use std::fs;

use serde_json::Value;

use crate::program::Folder;

/// The presets, by their names.
const PRESETS: [&str; 9] = ["ogre-2006", "ogre-1.12", "ogre-13", "mjp", "filament", "bevy", "three", "babylon", "godot"];
/// The kinds of light.
const KINDS: [&str; 3] = ["directional", "spot", "point"];
/// A light of each kind for the demo.
const LIGHTS: [&str; 3] = [
    "directional:dir=-1,-2,-1;lux=20000",
    "spot:pos=2,5,2;dir=-0.4,-1,-0.4;outer=35;cd=3000",
    "point:pos=-1,4,1;cd=2000;range=20",
];

/// The numbers of a list of objects under a key.
fn all<'a>(list: &'a Value, key: &'a str) -> Vec<&'a Value> {
    list.as_array().into_iter().flatten().map(|element| &element[key]).collect()
}

/// Both what the person reads and what a program reads says what is not as in the engine.
#[test]
fn every_preset_draws_every_kind_of_light_and_says_what_it_cannot() {
    let folder = Folder::new("presets-render");
    for preset in PRESETS {
        let lights = LIGHTS.map(|light| ["--light", light]).concat();
        let choices = ["render", "--preset", preset, "--size", "64x36", "--output", "preset.png", "--json"];
        let output = folder.run(&[&choices, &lights[..]].concat());
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(0), "{preset}: {stderr}");
        let report: Value = serde_json::from_slice(&output.stdout).expect("the report is JSON");
        let notes: Vec<&str> = report["notes"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
        for kind in KINDS {
            let start = format!("preset {preset}, {kind} lights: ");
            let note = notes.iter().find(|note| note.starts_with(&start)).expect(&start);
            assert!(note.len() > start.len() && stderr.contains(*note), "{preset}: {note}");
        }
        let colors: std::collections::HashSet<_> = folder.picture("preset.png").pixels().copied().collect();
        assert!(colors.len() > 100, "{preset}: a picture, not a blank: {} colours", colors.len());
        let refused = folder.refusal(&["render", "--preset", preset, "--filter", "hard"]);
        assert!(refused.contains("--filter") && refused.contains("shadow settings --preset NAME"), "{refused}");
    }
    let refused = folder.refusal(&["render", "--preset", "unity"]);
    assert!(PRESETS.iter().all(|preset| refused.contains(preset)), "{refused}");
}

/// Every light goes by its kind; maps are as large as the largest kind's that is there.
#[test]
fn a_preset_is_by_the_kind_of_light() {
    let folder = Folder::new("presets-kinds");
    let lights = LIGHTS.map(|light| ["--light", light]).concat();
    let plan = folder.json(&[&["plan", "--preset", "bevy", "--json"], &lights[..]].concat());
    assert_eq!(all(&plan["lights"], "filter"), ["witness5", "witness5", "gaussian"]);
    let metres: Vec<_> = plan["lights"].as_array().into_iter().flatten().map(|light| light["bias"]["metres"].as_f64()).collect();
    assert_eq!(
        metres.iter().map(|metres| metres.map(|metres| (1e4 * metres).round())).collect::<Vec<_>>(),
        [Some(200.0), Some(200.0), Some(800.0)]
    );
    assert_eq!(plan["map_size"], 2048);
    let alone = folder.json(&["plan", "--preset", "bevy", "--light", LIGHTS[2], "--json"]);
    assert_eq!(alone["map_size"], 1024, "a point light alone has the engine's size");
    let is_noted = |report: &Value| report["notes"].to_string().contains("as large as the largest");
    assert!(is_noted(&plan) && !is_noted(&alone), "{}", plan["notes"]);

    let sizes = ["--size", "32x18", "--frames", "1", "--light", LIGHTS[1], "--light", LIGHTS[2], "--json"];
    let report = folder.json(&[&["measure", "--preset", "three"], &sizes[..]].concat());
    let technique = &report["techniques"][0];
    assert_eq!(technique["settings"]["name"], "three");
    let stores: Vec<_> = all(&technique["lights"], "settings").into_iter().map(|settings| settings["store"].as_str()).collect();
    assert_eq!(stores, [Some("depth32"), Some("linear")]);
}

/// A printed preset is a settings file that `measure` reads, and measures as what it says.
#[test]
fn printed_presets_are_measured() {
    let folder = Folder::new("presets-files");
    let mut files = Vec::new();
    for (preset, kind) in PRESETS.iter().flat_map(|preset| KINDS.map(|kind| (*preset, kind))) {
        let printed = folder.run(&["settings", "--preset", preset, "--kind", kind]);
        assert_eq!(printed.status.code(), Some(0), "{preset} {kind}");
        let name = format!("{preset}-{kind}.toml");
        fs::write(folder.path().join(&name), &printed.stdout).expect("the folder can be written to");
        files.push(name);
    }
    assert_eq!(
        folder.run(&["settings", "--preset", "bevy"]).stdout,
        fs::read(folder.path().join("bevy-directional.toml")).unwrap_or_default()
    );
    let settings: Vec<&str> = files.iter().flat_map(|file| ["--settings", file]).collect();
    let choices = ["measure", "builtin:box-on-plane", "--size", "32x18", "--frames", "1", "--json"];
    let report = folder.json(&[&choices, &settings[..]].concat());
    let names: Vec<_> =
        all(&report["techniques"], "settings").into_iter().filter_map(|settings| settings["name"].as_str()).collect();
    assert_eq!(names.len(), files.len());
    for (name, file) in names.iter().zip(&files) {
        let (preset, kind) = name.split_once(", ").expect("a preset and a kind");
        assert_eq!(*file, format!("{preset}-{kind}.toml"));
    }
}

/// Both renderers draw what a preset says alike.
#[test]
fn renderers_agree_on_every_preset() {
    let folder = Folder::new("presets-compare");
    for preset in PRESETS {
        for lights in [&[][..], &["--light", LIGHTS[2]]] {
            let report = folder.json(&[&["compare", "--preset", preset, "--size", "96x54", "--json"], lights].concat());
            assert_eq!(report["agree"], true, "{preset} {lights:?}: {report}");
        }
    }
}

/// What a bias is for a light of a scene: the same numbers as from the plan, and back.
#[test]
fn biases_are_converted_for_a_light() {
    let folder = Folder::new("conversion");
    let number = |report: &Value, of: &str, name: &str| report[of]["parameters"][name].as_f64().unwrap_or(f64::NAN);
    let convert = |from: &str, to: &str, more: &[&str]| {
        folder.json(&[&["settings", "--convert", from, "--to", to, "--json"], more].concat())
    };
    let plan = folder.json(&["plan", "--map-size", "1024", "--light", LIGHTS[0], "--json"]);
    let view = &plan["lights"][0]["views"][0];
    let of_view = |key: &str, index: usize| view[key][index].as_f64().expect("the plan has lengths");
    let sun = ["--light", LIGHTS[0], "--map-size", "1024"];
    let report = convert("bevy", "three", &sun);
    let range = of_view("depth_range", 1) - of_view("depth_range", 0);
    assert!((number(&report, "to", "bias") + 0.02 / range).abs() < 1e-9, "{report}");
    let step = 1.8 * std::f64::consts::SQRT_2 * of_view("texel_metres", 0).max(of_view("texel_metres", 1));
    assert!((number(&report, "to", "normalBias") - step).abs() < 1e-7, "{report}");
    let back = format!("three:bias={};normalBias={}", number(&report, "to", "bias"), number(&report, "to", "normalBias"));
    let report = convert(&back, "bevy", &sun);
    assert!(
        (number(&report, "to", "depth") - 0.02).abs() < 1e-12 && (number(&report, "to", "normal") - 1.8).abs() < 1e-9,
        "{report}"
    );

    // One of several lights, chosen by its name, at a place.
    let lights = LIGHTS.map(|light| ["--light", light]).concat();
    let chosen = [&lights[..], &["--of-light", "point", "--at", "2.5", "--angle", "60"]].concat();
    let report = convert("godot", "bevy", &chosen);
    assert_eq!((&report["light"]["kind"], report["light"]["index"].as_u64()), (&Value::from("point"), Some(2)));
    assert!((number(&report, "to", "depth") - 0.1).abs() < 1e-12, "Godot's bias around points is in metres: {report}");

    // What has no parameter is said, in both reports.
    let report = convert("filament", "bevy", &sun);
    assert!(report["components"][2]["problem"].as_str().is_some_and(|problem| problem.contains("no parameter")), "{report}");
    let text = folder.run(&["settings", "--convert", "filament", "--to", "bevy"]).stdout;
    let text = String::from_utf8_lossy(&text);
    assert!(text.contains("bevy has no parameter for this") && text.contains("polygonOffsetSlope = 2"), "{text}");

    for (arguments, parts) in [
        (&["--convert", "unity:bias=1", "--to", "three"][..], ["unity", "babylon"]),
        (&["--convert", "bevy:bias=1", "--to", "three"], ["bias", "depth, normal"]),
        (&["--convert", "bevy:depth=-1", "--to", "three"], ["depth=-1", "at least 0"]),
        (&["--convert", "bevy", "--to", "unity"], ["unity", "babylon"]),
        (&["--convert", "bevy", "--to", "three", "--at", "9999"], ["9999", "from"]),
        (&["--convert", "bevy", "--to", "three", "--angle", "90"], ["90", "below 90"]),
        (&["--convert", "bevy", "--to", "three", "--of-light", "moon"], ["moon", "light"]),
        (&["--convert", "ogre-2006:units=9", "--to", "three", "--light", LIGHTS[2]], ["units=9", "quarter"]),
        (&["builtin:fence"], ["SCENE", "--convert"]),
    ] {
        let refused = folder.refusal(&[&["settings"], arguments].concat());
        assert!(parts.iter().all(|part| refused.contains(part)), "{arguments:?}: {refused}");
    }
}
