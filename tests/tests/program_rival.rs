//! Another tracer on the same rays, as `shadow bench --rival` sends them.

use std::{path::Path, process::Command};

use shadow_tests::report::say;

use crate::program::Folder;

#[test]
fn embree_meets_what_the_tracer_meets() {
    let folder = Folder::new("rival");
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("embree/rays.cpp");
    let rival = folder.path().join("rays");
    let mut compiler = Command::new("c++");
    compiler.args(["-std=c++17", "-O2", "-o"]).arg(&rival).arg(&source).args(["-lembree3", "-lpthread"]);
    if !compiler.output().is_ok_and(|output| output.status.success()) {
        say(
            "embree_meets_what_the_tracer_meets: not run, Embree 3 or a C++ compiler is missing (on Debian: apt-get install g++ libembree-dev)",
        );
        return;
    }
    let program = rival.display().to_string();
    let scene = ["bench", "builtin:box-on-plane", "--backends", "trace", "--size", "160x90", "--frames", "1"];
    let report = folder.json(&[&scene[..], &["--rival", &program, "--json"]].concat());
    let rival = &report["rival"];
    for kind in ["camera", "shadow"] {
        let met = |of: &serde_json::Value| of["met"].as_i64().unwrap_or_else(|| panic!("{kind} has no count: {rival}"));
        let ours = met(&rival[kind]);
        assert!(ours > 100, "{kind}: {ours}");
        for way in ["single", "packets"] {
            // Rays that pass an outline within single precision may differ; in a picture of 14,400 pixels there are a few.
            let theirs = met(&rival[kind][way]);
            assert!((ours - theirs).abs() <= 14, "{kind}, {way}: {ours} and {theirs}");
            assert!(rival[kind][way]["million_rays_per_second"].as_f64() > Some(0.0));
        }
    }
}

#[test]
fn a_rival_that_does_not_answer_is_named() {
    let folder = Folder::new("no-rival");
    for (backends, rival, part) in [
        ("cpu", "true", "add trace to --backends"),
        ("trace", "./not-there", "cannot be started"),
        ("trace", "true", "PROGRAM THREADS ROUNDS"),
        ("trace", "false", "it failed"),
    ] {
        let scene = ["bench", "--backends", backends, "--size", "16x9", "--frames", "1", "--rival", rival];
        let output = folder.run(&scene);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{rival}: {stderr}");
        assert!(stderr.contains("--rival") && stderr.contains(part), "{rival}: {stderr}");
    }
}
