//! The files that the program writes: exact numbers, whole or not at all.

use std::{path::Path, process::Command};

use shadow_cpu::{CpuRenderer, RasterRules};
use shadow_math::ShadowSettings;
use shadow_scene::{Frame, FramePlan, LayerName, Request, builtin};

use crate::program::{Folder, program};

/// The fence as the program draws it at 64 x 36 pixels with maps of 32 x 32 texels.
fn fence() -> Frame {
    let scene = builtin::by_name("fence").expect("it is built in");
    let settings = ShadowSettings { map_size: 32, ..ShadowSettings::default() };
    let plan = FramePlan::new(&scene, &scene.cameras()[0].camera, &settings, 64, 36, None).expect("it can be planned");
    let renderer = CpuRenderer::new(0, RasterRules::default()).expect("the threads start");
    renderer.render(&renderer.prepare(&scene), &plan, Request::ALL).expect("it can be drawn").frame
}

fn bits(values: &[f32]) -> Vec<u32> {
    values.iter().map(|value| value.to_bits()).collect()
}

/// What `--output x.exr` holds is what the renderer computed, to the bit.
#[test]
fn exr_files_hold_the_numbers_as_they_were_computed() {
    let folder = Folder::new("exr");
    let frame = fence();
    let layers = [
        ("depth", LayerName::Depth),
        ("visibility", LayerName::Visibility { light: 0 }),
        ("shadow-map", LayerName::ShadowMap { light: 0, view: 0 }),
    ];
    let draw = |show: &str| {
        let file = format!("{show}.exr");
        folder.json(&[
            "render",
            "builtin:fence",
            "--size",
            "64x36",
            "--map-size",
            "32",
            "--show",
            show,
            "--output",
            &file,
            "--json",
        ]);
        image::open(folder.path().join(&file)).unwrap_or_else(|error| panic!("{file}: {error}"))
    };
    for (show, name) in layers {
        let layer = frame.layer(name).expect("every layer was asked for");
        let read = draw(show);
        assert_eq!((read.width(), read.height()), (layer.width, layer.height), "{show}");
        let expected: Vec<f32> = frame.floats(name).expect("it has numbers").iter().flat_map(|&value| [value; 3]).collect();
        assert!(expected.iter().any(|&value| value != expected[0]), "{show} is not all the same");
        assert!(bits(read.into_rgb32f().as_raw()) == bits(&expected), "{show} differs");
    }
    let expected = frame.color().expect("there is a picture").as_flattened();
    assert!(bits(draw("color").into_rgba32f().as_raw()) == bits(expected), "color differs");
}

/// A new file has the permissions of any new file, and replaces an old one.
#[cfg(unix)]
#[test]
fn new_files_have_the_usual_permissions() {
    use std::os::unix::fs::PermissionsExt;

    let folder = Folder::new("permissions");
    let usual = folder.path().join("usual");
    std::fs::write(&usual, "").expect("the folder can be written");
    std::fs::write(folder.path().join("shadow.png"), "old").expect("the folder can be written");
    folder.json(&["render", "--size", "16x9", "--map-size", "16", "--json"]);
    let mode = |path: &Path| std::fs::metadata(path).expect("the file is there").permissions().mode() & 0o777;
    assert_eq!(mode(&folder.path().join("shadow.png")), mode(&usual));
    assert_eq!(folder.files(), ["shadow.png", "usual"]);
    assert_eq!(folder.picture("shadow.png").dimensions(), (16, 9));
}

/// Where a disk is full, or a file may grow no further, the old file stays and no part of the new one does.
#[cfg(unix)]
#[test]
fn a_failure_while_writing_leaves_the_old_file() {
    let folder = Folder::new("disk-full");
    let old = folder.path().join("shadow.exr");
    std::fs::write(&old, "old").expect("the folder can be written");
    // A limit of one block on the size of files; without the trap the system would end the program instead of failing the write.
    let script = "trap '' XFSZ; ulimit -f 1; exec \"$0\" \"$@\"";
    let output = Command::new("sh")
        .args(["-c", script])
        .arg(program())
        .args(["render", "--size", "64x36", "--map-size", "16", "--output", "shadow.exr"])
        .current_dir(folder.path())
        .output()
        .expect("a shell runs");
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(stderr.contains("shadow.exr"), "{stderr}");
    assert_eq!(folder.files(), ["shadow.exr"]);
    assert_eq!(std::fs::read_to_string(&old).expect("the old file is there"), "old");
}

/// Interrupted in the middle of writing, the program removes what it wrote and says so by its exit code.
#[cfg(unix)]
#[test]
fn an_interruption_leaves_no_half_written_file() {
    for signal in ["INT", "TERM"] {
        let folder = Folder::new(&format!("interrupted-{signal}"));
        // A machine may write the file faster than the signal arrives. It will not do so every time.
        let was_interrupted = (0..20).any(|_| {
            let mut child = Command::new(program())
                .args(["render", "--show", "shadow-map", "--map-size", "2048", "--size", "16x9", "--output", "shadow.exr"])
                .stdout(std::process::Stdio::null())
                .current_dir(folder.path())
                .spawn()
                .expect("the program runs");
            let is_writing = || folder.files().iter().any(|name| name.starts_with(".shadow-"));
            while !is_writing() && child.try_wait().expect("the program can be asked").is_none() {
                std::thread::yield_now();
            }
            let sent = Command::new("kill").args(["-s", signal, &child.id().to_string()]).status().expect("kill runs").success();
            let status = child.wait().expect("the program ends");
            match status.code() {
                Some(130) => assert!(folder.files().is_empty(), "{signal}: {:?}", folder.files()),
                Some(0) => assert_eq!(folder.files(), ["shadow.exr"], "{signal}"),
                other => panic!("{signal}: the exit code is {other:?}"),
            }
            let _ = std::fs::remove_file(folder.path().join("shadow.exr"));
            sent && status.code() == Some(130)
        });
        assert!(was_interrupted, "{signal} never came before the file was complete");
    }
}
