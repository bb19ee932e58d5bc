//! The program itself, as its users run it.

use std::{
    env,
    path::{Path, PathBuf},
    process::{Command, Output},
    sync::OnceLock,
};

use serde_json::Value;
use shadow_gpu::DriverRules;
use shadow_tests::renderers;

/// The program, built once in the profile of the tests.
pub(crate) fn program() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    PROGRAM.get_or_init(|| {
        // Tests run from the folder `deps` beside the programs of their profile.
        let tests = env::current_exe().expect("the tests know where they are");
        let profile = tests.parent().and_then(Path::parent).expect("the tests lie in a profile's folder");
        let is_release = profile.file_name().is_some_and(|name| name == "release");
        let target = profile.parent().expect("a profile lies in a target folder");
        let mut build = Command::new(env!("CARGO"));
        build.args(["build", "--package", "shadow-cli", "--target-dir"]).arg(target);
        if is_release {
            build.arg("--release");
        }
        if cfg!(feature = "gles") {
            build.args(["--features", "gles"]);
        }
        assert!(build.status().expect("cargo runs").success(), "the program builds");
        profile.join(format!("shadow{}", env::consts::EXE_SUFFIX))
    })
}

/// A folder of a test's own, removed at its end.
pub(crate) struct Folder(PathBuf);

impl Folder {
    pub(crate) fn new(name: &str) -> Self {
        let path = env::temp_dir().join(format!("shadow-tests-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&path).expect("the temporary folder can be written");
        Self(path)
    }

    /// Where it is.
    pub(crate) fn path(&self) -> &Path {
        &self.0
    }

    /// Runs the program in the folder.
    pub(crate) fn run(&self, arguments: &[&str]) -> Output {
        Command::new(program()).args(arguments).current_dir(&self.0).output().expect("the program runs")
    }

    /// Runs the program, which must succeed, and reads what it prints as JSON.
    pub(crate) fn json(&self, arguments: &[&str]) -> Value {
        let output = self.run(arguments);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {stderr}");
        serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{arguments:?}: {error}"))
    }

    /// Runs the program, which must refuse, and gives its sentence.
    pub(crate) fn refusal(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {stderr}");
        assert!(output.stdout.is_empty(), "{arguments:?}: nothing is printed beside the error");
        assert!(!stderr.contains("panicked"), "{arguments:?}: {stderr}");
        stderr
    }

    /// Reads a picture in it.
    pub(crate) fn picture(&self, name: &str) -> image::RgbImage {
        image::open(self.0.join(name)).unwrap_or_else(|error| panic!("{name}: {error}")).into_rgb8()
    }

    /// The names in it, in order.
    pub(crate) fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(&self.0).expect("the folder can be read");
        let mut names: Vec<_> =
            entries.map(|entry| entry.expect("the folder can be read").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

#[test]
fn without_arguments_it_draws_the_demo_and_says_where() {
    let folder = Folder::new("demo");
    let output = folder.run(&[]);
    assert_eq!(output.status.code(), Some(0));
    assert!(String::from_utf8_lossy(&output.stdout).contains("shadow.png"));
    assert_eq!(folder.files(), ["shadow.png"], "and leaves nothing else behind");
    let picture = folder.picture("shadow.png");
    assert_eq!(picture.dimensions(), (1280, 720));
    let colors: std::collections::HashSet<_> = picture.pixels().collect();
    assert!(colors.len() > 1000, "a picture, not a blank: {} colours", colors.len());
}

#[test]
fn both_backends_draw_the_same_picture() {
    let folder = Folder::new("backends");
    for backend in ["cpu", "gpu"] {
        let file = format!("{backend}.png");
        let report = folder.json(&["render", "--backend", backend, "--size", "320x180", "--output", &file, "--json"]);
        assert_eq!(report["backend"], backend);
        assert_eq!(report["adapter"].is_null(), backend == "cpu");
        assert_eq!((report["width"].as_u64(), report["height"].as_u64()), (Some(320), Some(180)));
        assert!(report["triangles"].as_u64().is_some_and(|count| count > 1000));
        let times = &report["milliseconds"];
        for stage in ["prepare", "shadow_maps", "camera", "shading", "total"] {
            assert!(times[stage].as_f64().is_some_and(|time| time >= 0.0), "{stage} in {times}");
        }
        assert_eq!(report["output"], file);
    }
    let (cpu, gpu) = (folder.picture("cpu.png"), folder.picture("gpu.png"));
    let steps = |(a, b): (&u8, &u8)| a.abs_diff(*b);
    let far_apart = cpu.as_raw().iter().zip(gpu.as_raw()).map(steps).filter(|&steps| steps > 1).count();
    // By itself the CPU backend follows its default rules, whatever adapter there is: where that has others, outlines differ.
    let allowed = if renderers::gpu().adapter().rules == DriverRules::Lavapipe22 { 0 } else { cpu.as_raw().len() / 200 };
    assert!(far_apart <= allowed, "{far_apart} channels differ");
}

#[test]
fn compare_reports_every_layer() {
    let folder = Folder::new("compare");
    let report = folder.json(&["compare", "--size", "160x90", "--map-size", "256", "--output", "layers", "--json"]);
    assert_eq!(report["agree"], true);
    let is_exact = renderers::gpu().adapter().rules.are_complete();
    assert_eq!(report["contract"], if is_exact { "exact" } else { "tolerance" });
    let layers = report["layers"].as_array().expect("there are layers");
    let names: Vec<_> = layers.iter().filter_map(|layer| layer["name"].as_str()).collect();
    assert_eq!(names, ["triangle", "depth", "shadow-map:0:0", "shadow-map:1:0", "visibility:0", "visibility:1", "color"]);
    for layer in layers {
        for field in ["pixels", "differing", "left_out", "max_difference", "within_contract"] {
            assert!(!layer[field].is_null(), "{field} of {layer}");
        }
    }
    assert!(folder.0.join("layers/shadow-map-0-0-difference.png").exists(), "{:?}", folder.files());
}

#[test]
fn bench_times_every_stage_of_both_backends() {
    let folder = Folder::new("bench");
    let sizes = ["--size", "64x36", "--map-size", "64", "--frames", "3", "--json"];
    let report = folder.json(&[&["bench", "builtin:fence"], &sizes[..]].concat());
    assert_eq!((report["frames"].as_u64(), report["map_size"].as_u64(), report["width"].as_u64()), (Some(3), Some(64), Some(64)));
    assert!(report["triangles"].as_u64().is_some_and(|count| count > 0));
    let backends = report["backends"].as_array().expect("there are backends");
    assert_eq!(backends.iter().filter_map(|backend| backend["backend"].as_str()).collect::<Vec<_>>(), ["cpu", "gpu"]);
    assert!(backends[0]["adapter"].is_null());
    assert_eq!(backends[1]["adapter"], renderers::gpu().adapter().name);
    for backend in backends {
        for stage in ["shadow_maps", "camera", "shading", "total"] {
            let median = backend["milliseconds"][stage].as_f64().expect("every stage has a median");
            let of_spread = |field: &str| backend["spread"][stage][field].as_f64().expect("every stage has a spread");
            assert!(median > 0.0 && of_spread("min") <= median && median <= of_spread("max"), "{stage} in {backend}");
        }
        for part in ["open", "prepare", "first_frame"] {
            assert!(backend["milliseconds_once"][part].as_f64().is_some_and(|time| time > 0.0), "{part} in {backend}");
        }
        if cfg!(target_os = "linux") {
            assert!(backend["peak_bytes"].as_u64().is_some_and(|bytes| bytes > 0), "{backend}");
        }
    }
    assert!(report["ratios"]["total"].as_f64().is_some_and(|ratio| ratio > 0.0), "{report}");
    assert!(report["ratios"]["of"].as_str().is_some_and(|of| of.starts_with("milliseconds of gpu divided by")), "{report}");
    let alone = folder.json(&[&["bench", "builtin:fence", "--backends", "cpu", "--threads", "1"], &sizes[..]].concat());
    assert!(alone["ratios"].is_null() && alone["backends"].as_array().is_some_and(|backends| backends.len() == 1));
    assert_eq!(alone["backends"][0]["threads"], 1);
    assert!(folder.files().is_empty(), "nothing is written: {:?}", folder.files());
}

#[test]
fn bench_counts_the_rays_of_the_tracer() {
    let folder = Folder::new("bench-rays");
    let sizes = ["--size", "64x36", "--frames", "2", "--json"];
    let report = folder.json(&[&["bench", "--backends", "trace"], &sizes[..]].concat());
    let backend = &report["backends"][0];
    for kind in ["camera", "shadow"] {
        assert!(backend["million_rays_per_second"][kind].as_f64().is_some_and(|rate| rate > 0.0), "{backend}");
    }
    assert_eq!((&backend["adapter"], backend["threads"].as_u64().is_some()), (&Value::Null, true));
}

#[test]
fn bench_times_filters() {
    let folder = Folder::new("bench-filters");
    let choices = ["bench", "--filters", "box3,vogel", "--size", "64x36", "--map-size", "128", "--frames", "2", "--json"];
    let report = folder.json(&choices);
    let filters = report["filters"].as_array().expect("filters are timed");
    let of = |index: usize| (filters[index]["filter"].as_str().unwrap_or_default(), filters[index]["tests"].as_u64());
    assert_eq!([of(0), of(1), of(2)], [("hard", Some(1)), ("box3", Some(16)), ("vogel", Some(16))]);
    for backend in filters.iter().flat_map(|filter| filter["backends"].as_array().into_iter().flatten()) {
        assert!(backend["shading_milliseconds"].as_f64().is_some_and(|time| time > 0.0), "{backend}");
    }
}

/// Techniques side by side, from files: what was planted in each is found, and the page holds all of it.
#[test]
fn measure_tells_techniques_apart() {
    let folder = Folder::new("measure");
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("the folder can be written to");
    write("without.toml", "bias = \"none\"\nmap-size = 256\n");
    write("with.toml", "name = \"a <b> & c\"\nmap-size = 256\n");
    let sizes = ["--size", "160x90", "--frames", "1"];
    for backend in ["cpu", "gpu"] {
        let files = [
            "measure",
            "--settings",
            "without.toml",
            "--settings",
            "with.toml",
            "--backend",
            backend,
            "--report",
            "page",
            "--json",
        ];
        let report = folder.json(&[&files, &sizes[..]].concat());
        let techniques = report["techniques"].as_array().expect("there are techniques");
        assert_eq!(techniques.len(), 2);
        let acne = |index: usize| techniques[index]["causes"]["acne"].as_u64().expect("acne is counted");
        assert!(acne(0) > 1000 && acne(1) == 0, "{backend}: {} and {}", acne(0), acne(1));
        assert_eq!(techniques[1]["settings"]["bias"], "automatic");
        for technique in techniques {
            let causes = technique["causes"].as_object().expect("causes have names");
            assert_eq!(causes.len(), 8);
            let sum: u64 = causes.values().filter_map(Value::as_u64).sum();
            assert_eq!(technique["wrong"].as_u64(), Some(sum));
            assert!(technique["rmse"].as_f64().is_some_and(|rmse| rmse > 0.0 && rmse < 1.0));
            assert!(technique["milliseconds"]["total"].as_f64().is_some_and(|time| time > 0.0));
            assert_eq!(technique["map_bytes"], 2 * 256 * 256 * 4);
            assert_eq!(technique["lights"].as_array().map(Vec::len), Some(2));
            // The uniform fit does not look at the camera, so that nothing changes while it moves.
            for motion in ["move", "turn", "zoom"] {
                assert_eq!(technique["stability"][motion], 0.0, "{motion}");
            }
        }
        let page = std::fs::read_to_string(folder.path().join("page/index.html")).expect("the page is there");
        assert!(page.contains("a &lt;b&gt; &amp; c") && !page.contains("a <b>"), "names are text, not markup");
        assert!(page.matches("data:image/png;base64,").count() >= 8 && page.ends_with("</html>\n"));
        assert!(!page.contains("http"), "the page asks for nothing from elsewhere");
    }
    let text = String::from_utf8_lossy(&folder.run(&[&["measure", "--map-size", "64"], &sizes[..]].concat()).stdout).into_owned();
    assert!(text.contains("command line") && text.contains("peter panning") && text.contains("terminator"), "{text}");
}

/// The certificate holds on either backend, names where acne begins, and shows engines' defaults that fail.
#[test]
fn tune_certifies_the_automatic_bias() {
    let folder = Folder::new("tune");
    let choices = ["tune", "--size", "320x180", "--map-size", "512", "--json", "--backend"];
    let reports = ["cpu", "gpu"].map(|backend| {
        let page = format!("{backend}.html");
        let report = folder.json(&[&choices[..], &[backend, "--output", &page]].concat());
        assert_eq!(report["holds"], true, "{backend}");
        let lights = report["lights"].as_array().expect("there are lights");
        assert_eq!(lights.len(), 2);
        for light in lights {
            assert_eq!(light["acne"], 0);
            let onset = |key: &str| light["onset"][key].as_f64().expect("acne begins somewhere");
            assert!(onset("with_acne") < onset("without") && onset("without") <= 1.0, "{}", light["onset"]);
            let needed = |key: &str| light["needed"][key].as_f64().expect("planes need something");
            assert!(needed("filter") > needed("snap") && needed("snap") > 0.0 && needed("rounding") > 0.0);
            let rules = light["rules"].as_array().expect("rules are tried");
            let of_name = |name: &str| rules.iter().find(|rule| rule["name"] == name).expect("it is tried");
            assert_eq!(of_name("automatic")["fails"], serde_json::json!([]));
            // For a sun Godot's shaders take a hundredth of its bias in metres; the lamp's step along the normal is long.
            if light["name"] == lights[0]["name"] {
                assert!(of_name("MJP")["acne"].as_u64() < of_name("Godot 4")["acne"].as_u64(), "{rules:?}");
            }
            let of_bevy = of_name("Bevy")["fails"].as_array().expect("it fails");
            assert!(of_bevy.contains(&"shift".into()) && !of_bevy.contains(&"acne".into()), "{of_bevy:?}");
            let curve = light["curves"]["automatic"].as_array().expect("shares are tried");
            let acne = |index: usize| curve[index]["acne"].as_u64().expect("acne is counted");
            assert!(curve.len() == 17 && acne(0) > 1000 && acne(0) > acne(8) && acne(16) == 0, "{curve:?}");
            // Without a bias, but with back faces in the map, most of a closed scene is lit.
            assert!(of_name("three.js")["acne"].as_u64().is_some_and(|of_back_faces| of_back_faces < acne(0) / 10));
        }
        let page = std::fs::read_to_string(folder.path().join(&page)).expect("the page is there");
        assert!(page.contains("<svg") && page.contains("Filament") && !page.contains("http"));
        report["lights"].clone()
    });
    // On a driver that has the CPU backend's default rules the maps are the same to the bit, and with them everything that is asked of them.
    if renderers::gpu().adapter().rules == DriverRules::Lavapipe22 {
        assert_eq!(reports[0], reports[1]);
    }
    let alone = ["tune", "--size", "32x18", "--light", "spot:pos=0,50,0;dir=0,1,0;outer=30;cd=1", "--output", "away.json"];
    let text = String::from_utf8_lossy(&folder.run(&alone).stdout).into_owned();
    assert!(text.contains("no pixel faces this light") && text.contains("the automatic bias holds"), "{text}");
    let written = std::fs::read_to_string(folder.path().join("away.json")).expect("the numbers are there");
    assert_eq!(serde_json::from_str::<Value>(&written).expect("it is JSON")["lights"][0]["onset"], Value::Null);
}

#[test]
fn settings_files_are_printed_and_refused_by_line() {
    let folder = Folder::new("settings");
    let printed = folder.run(&["settings"]).stdout;
    std::fs::write(folder.path().join("default.toml"), &printed).expect("the folder can be written to");
    let sizes = ["--size", "32x18", "--frames", "1"];
    let report = folder.json(&[&["measure", "--settings", "default.toml", "--json"], &sizes[..]].concat());
    assert_eq!(report["techniques"][0]["settings"]["map-size"], 2048);
    let faulty = String::from_utf8_lossy(&printed).replace("bilinear\"\n", "soft\"\n");
    std::fs::write(folder.path().join("faulty.toml"), &faulty).expect("the folder can be written to");
    let line = faulty.lines().position(|line| line.starts_with("filter")).expect("there is a filter") + 1;
    let sentence = folder.refusal(&["measure", "--settings", "faulty.toml"]);
    for part in [format!("line {line}"), "faulty.toml".into(), "soft".into(), "bilinear".into(), "hard".into()] {
        assert!(sentence.contains(&part), "`{part}` in: {sentence}");
    }
    let twice = folder.refusal(&["measure", "--settings", "default.toml", "--settings", "default.toml"]);
    assert!(twice.contains("default"), "{twice}");
}

#[test]
fn the_plan_names_its_matrices_and_lengths() {
    let folder = Folder::new("plan");
    let light = "point:pos=0,3,0;cd=100;range=20";
    let report = folder.json(&["plan", "--light", light, "--bias", "constant", "--bias-constant", "0.02", "--json"]);
    let views = report["lights"][0]["views"].as_array().expect("the light has views");
    assert_eq!(views.len(), 6, "a point light has the faces of a cube");
    for view in views {
        let rows = view["clip_from_world"].as_array().expect("the matrix is a list of rows");
        assert_eq!(rows.iter().map(|row| row.as_array().map_or(0, Vec::len)).collect::<Vec<_>>(), [4, 4, 4, 4]);
    }
}

#[test]
fn devices_lists_the_adapter_of_the_tests() {
    let folder = Folder::new("devices");
    let report = folder.json(&["devices", "--json"]);
    let name = renderers::gpu().adapter().name.clone();
    assert!(report.to_string().contains(&name), "{name} in {report}");
}

/// Completions and manual pages know every command, and what they print is what a shell and man(1) read.
#[test]
fn completions_and_manual_pages_know_the_commands() {
    let folder = Folder::new("completions");
    let print = |arguments: &[&str]| {
        let output = folder.run(arguments);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}");
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = print(&["completions", shell]);
        for part in ["compare", "bench", "map-size"] {
            assert!(script.contains(part), "`{part}` in the completions for {shell}");
        }
    }
    let page = print(&["man"]);
    for part in [".TH shadow 1", "shadow\\-bench(1)", "Exit codes"] {
        assert!(page.contains(part), "`{part}` in {page}");
    }
    assert!(print(&["man", "bench"]).contains("\\-\\-frames"));
}

/// Every refusal names what is wrong and what to do instead, and leaves no file behind.
#[test]
fn wrong_requests_are_refused_with_a_sentence() {
    let folder = Folder::new("refusals");
    let cases: &[(&[&str], &[&str])] = &[
        (&["render", "missing.glb"], &["missing.glb"]),
        (&["render", "--size", "0x10"], &["0x10", "16384"]),
        (&["render", "--size", "20000x10"], &["20000", "16384", "smaller"]),
        (&["render", "--bias-constant", "1cm"], &["1cm", "metres", "0.01"]),
        (&["render", "--camera", "eye=1,1,1;target=0,0,0;fov=90deg"], &["90deg", "degrees"]),
        (&["render", "--map-size", "1"], &["16"]),
        (&["render", "--map-size", "100000"], &["16384"]),
        (&["render", "--bias", "none", "--bias-constant", "1"], &["--bias-constant"]),
        (&["render", "--bias", "constant", "--bias-constant", "-1"], &["-1"]),
        (&["render", "--light", "laser:pos=0,0,0"], &["laser", "directional", "spot", "point"]),
        (&["render", "--light", "point:pos=0,0,0"], &["cd"]),
        (&["render", "--light", "spot:pos=0,1,0;dir=0,-1,0;outer=95;cd=1"], &["95", "90"]),
        (&["render", "--light", "directional:dir=0,0,0;lux=1"], &["direction"]),
        (&["render", "--camera", "eye=1,1,1;target=1,1,1"], &["direction"]),
        (&["render", "--camera", "9"], &["9", "camera"]),
        (&["render", "--exposure", "nan"], &["nan"]),
        (&["render", "--show", "visibility:7"], &["7", "2 lights"]),
        (&["render", "--light-samples", "64"], &["--light-samples", "trace"]),
        (&["render", "--backend", "trace", "--show", "shadow-map"], &["shadow maps", "cpu", "gpu"]),
        (&["render", "--light", "point:pos=0,1,0;cd=1;radius=0"], &["radius", "positive"]),
        (&["render", "--light", "directional:dir=0,-1,0;lux=1;diameter=180"], &["180", "between"]),
        (&["compare", "--backends", "cpu,trace"], &["measure"]),
        (&["measure", "--backend", "trace"], &["truth", "cpu"]),
        (&["render", "--filter", "box3", "--filter-radius", "2"], &["box3", "vogel"]),
        (&["bench", "--filters", "hard,soft"], &["soft", "witness7"]),
        (&["bench", "--filters", "hard,hard"], &["hard", "twice"]),
        (&["bench", "--filters", "all", "--filter", "hard"], &["--filters", "--filter"]),
        (&["bench", "--filters", "all", "--backends", "trace"], &["cpu", "gpu"]),
        (&["render", "--filter", "gaussian", "--filter-radius", "9"], &["9", "1 to 4"]),
        (&["render", "--filter", "box9", "--map-size", "32"], &["32 texels", "box9", "larger map"]),
        (&["tune", "--backend", "trace"], &["truth", "cpu"]),
        (&["tune", "--output", "bias.pdf"], &["bias.pdf", ".html", ".json"]),
        (&["tune", "--output", "missing/bias.html"], &["missing"]),
        (&["tune", "--bias", "none"], &["--bias"]),
        (&["measure", "--settings", "missing.toml"], &["missing.toml"]),
        (&["measure", "--settings", "missing.toml", "--bias", "none"], &["--settings", "--bias"]),
        (&["render", "--output", "picture.bmp"], &["bmp", ".png", ".exr"]),
        (&["man", "draw"], &["draw", "render", "compare"]),
        (&["completions", "tcsh"], &["tcsh", "bash", "zsh"]),
        (&["render", "--backend", "gpu", "--adapter", "no such adapter"], &["no such adapter"]),
        (&["compare", "--backends", "cpu,cpu"], &["itself"]),
        (&["bench", "--frames", "0"], &["10000"]),
        (&["bench", "--backends", "tpu"], &["tpu", "cpu", "gpu"]),
        (&["bench", "--backends", "cpu", "--adapter", "llvmpipe"], &["llvmpipe", "--backend"]),
    ];
    for (arguments, words) in cases {
        let sentence = folder.refusal(arguments).to_lowercase();
        for word in *words {
            assert!(sentence.contains(&word.to_lowercase()), "{arguments:?}: `{word}` is not in: {sentence}");
        }
    }
    assert!(folder.files().is_empty(), "{:?}", folder.files());
}

/// What every command's help must teach: its options, and at least one example.
#[test]
fn help_teaches() {
    let folder = Folder::new("help");
    for command in ["render", "compare", "bench", "plan", "measure", "tune"] {
        let output = folder.run(&[command, "--help"]);
        let help = String::from_utf8_lossy(&output.stdout);
        for part in ["Examples:", "--light", "--camera", "--map-size", "--filter", "lux", "cd"] {
            assert!(help.contains(part), "`{part}` in the help of {command}");
        }
    }
}
