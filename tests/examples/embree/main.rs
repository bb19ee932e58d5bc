//! The tracer beside Embree: the same mesh and the same rays, one after the other on the same threads.
//!
//! ```text
//! cargo run --release -p shadow-tests --example embree -- SCENE [--eye X,Y,Z --target X,Y,Z]
//! ```
//!
//! A ray goes through every pixel of 1280 x 720 and, from what it meets, one to the sun. `rays.cpp` sends them through Embree 3 (Debian's `libembree-dev`), with its
//! robust flag, one at a time and in packets of eight; where there is no Embree or no C++ compiler, the tracer's figures stand alone. Embree works in single precision: a few
//! rays that pass an edge meet something there and nothing here.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "the example's report")]

use std::{
    env,
    error::Error,
    fs,
    io::{BufWriter, Write},
    path::{Path, PathBuf},
    process::Command,
    sync::atomic::{AtomicUsize, Ordering},
    time::Instant,
};

use glam::DVec3;
use shadow_cpu::trace::{CameraView, Ray, Rays, Tracer};
use shadow_math::{Camera, Projection};
use shadow_scene::{NO_TRIANGLE, Scene, import};

const WIDTH: u32 = 1280;
const HEIGHT: u32 = 720;
const THREADS: usize = 2;
/// Rounds of which the best counts: a busy machine only ever makes work slower.
const ROUNDS: usize = 7;
/// What a thread takes at a time: a row of the picture.
const CHUNK: usize = WIDTH as usize;
/// The sun's rays go this way.
const TO_SUN: DVec3 = DVec3::new(0.4, 1.0, 0.3);

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [file, options @ ..] = &arguments[..] else {
        return Err("usage: embree SCENE [--eye X,Y,Z --target X,Y,Z]".into());
    };
    let scene = import(Path::new(file))?;
    let camera = match options {
        [] => scene.cameras()[0].camera,
        [eye, from, target, to] if eye == "--eye" && target == "--target" => {
            let projection = Projection::Perspective { vertical_fov: 0.8, near: 1e-3, far: None };
            Camera::look_at(point(from)? - scene.origin(), point(to)? - scene.origin(), projection)?
        }
        _ => return Err("the options are --eye X,Y,Z --target X,Y,Z".into()),
    };

    let start = Instant::now();
    let tracer = Tracer::new(&scene, THREADS)?;
    println!("{file}: {} triangles, tree built in {:.2} s", tracer.triangle_count(), start.elapsed().as_secs_f64());
    let view = CameraView::new(&camera, WIDTH, HEIGHT);
    let camera_rays: Vec<Ray> = (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| view.ray(x, y))).collect();
    let seen = tracer.camera(view, &|| {});
    let from_surface = seen.hits.iter().zip(&camera_rays).filter(|(hit, _)| hit.triangle != NO_TRIANGLE);
    let shadow_rays: Vec<Ray> = from_surface.filter_map(|(hit, ray)| tracer.surface_point(hit, *ray).along(TO_SUN)).collect();

    let ours = [
        ("camera", best_rate(&tracer, &camera_rays, |rays, ray| rays.closest(ray).is_some())),
        ("shadow", best_rate(&tracer, &shadow_rays, |rays, ray| rays.is_blocked(ray))),
    ];
    let theirs = embree(&scene, &camera_rays, &shadow_rays)?;
    println!("million rays a second, {THREADS} threads, best of {ROUNDS}");
    println!("{:8} {:>12} {:>14} {:>8} {:>15}", "rays", "the tracer", "Embree single", "ratio", "Embree packets");
    for (kind, (rate, met)) in ours {
        let of = |way: &str| theirs.iter().find(|line| line.kind == kind && line.way == way);
        match (of("single"), of("packets")) {
            (Some(single), Some(packets)) => println!(
                "{kind:8} {rate:12.2} {:14.2} {:8.2} {:15.2}   ({met} met something, {} in Embree)",
                single.rate,
                rate / single.rate,
                packets.rate,
                single.met
            ),
            _ => println!("{kind:8} {rate:12.2}   ({met} met something)"),
        }
    }
    Ok(())
}

/// Three numbers separated by commas, in metres of the file's world space.
fn point(text: &str) -> Result<DVec3, Box<dyn Error>> {
    let numbers = text.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>()?;
    let numbers: [f64; 3] = numbers.try_into().map_err(|_| format!("`{text}` is not X,Y,Z"))?;
    Ok(numbers.into())
}

/// Millions of rays a second in the best round, and how many rays `meets` says yes of.
fn best_rate(tracer: &Tracer<'_>, rays: &[Ray], meets: impl Fn(&mut Rays<'_>, Ray) -> bool + Sync) -> (f64, usize) {
    let mut best = f64::INFINITY;
    let mut met = 0;
    for _ in 0..ROUNDS {
        let start = Instant::now();
        let (next, found) = (AtomicUsize::new(0), AtomicUsize::new(0));
        std::thread::scope(|scope| {
            for _ in 0..THREADS {
                scope.spawn(|| {
                    let mut of_thread = tracer.rays();
                    let mut count = 0;
                    loop {
                        let first = next.fetch_add(CHUNK, Ordering::Relaxed);
                        let Some(chunk) = rays.get(first..rays.len().min(first + CHUNK)).filter(|chunk| !chunk.is_empty()) else {
                            break;
                        };
                        count += chunk.iter().filter(|ray| meets(&mut of_thread, **ray)).count();
                    }
                    found.fetch_add(count, Ordering::Relaxed);
                });
            }
        });
        best = best.min(start.elapsed().as_secs_f64());
        met = found.into_inner();
    }
    (rays.len() as f64 / best / 1e6, met)
}

/// What Embree made of a kind of rays.
struct Line {
    kind: String,
    way: String,
    rate: f64,
    met: usize,
}

/// Sends the rays through Embree; nothing where it cannot be built.
fn embree(scene: &Scene, camera_rays: &[Ray], shadow_rays: &[Ray]) -> Result<Vec<Line>, Box<dyn Error>> {
    let folder = env::temp_dir().join(format!("shadow-embree-{}", std::process::id()));
    fs::create_dir_all(&folder)?;
    let lines = embree_in(&folder, scene, camera_rays, shadow_rays);
    fs::remove_dir_all(&folder)?;
    lines
}

fn embree_in(folder: &Path, scene: &Scene, camera_rays: &[Ray], shadow_rays: &[Ray]) -> Result<Vec<Line>, Box<dyn Error>> {
    let program = folder.join("rays");
    let source = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("examples/embree/rays.cpp");
    let compiler = Command::new("c++")
        .args(["-std=c++17", "-O2", "-o"])
        .arg(&program)
        .arg(&source)
        .args(["-lembree3", "-lpthread"])
        .output();
    if !compiler.as_ref().is_ok_and(|output| output.status.success()) {
        eprintln!("Embree's program cannot be built (on Debian: apt-get install g++ libembree-dev); the tracer stands alone");
        return Ok(Vec::new());
    }
    let file = folder.join("rays.bin");
    let mut out = BufWriter::new(fs::File::create(&file)?);
    let positions = &scene.vertices().positions;
    for count in [positions.len(), scene.triangles().len(), camera_rays.len(), shadow_rays.len()] {
        out.write_all(&u32::try_from(count)?.to_le_bytes())?;
    }
    out.write_all(bytemuck::cast_slice(positions))?;
    out.write_all(bytemuck::cast_slice(scene.triangles()))?;
    for ray in camera_rays.iter().chain(shadow_rays) {
        // In single precision a ray begins far enough off its surface only if it is lifted: by a millionth of the scene.
        let origin = ray.origin() + ray.direction() * (1e-6 * f64::from(scene.bounds().radius()));
        out.write_all(bytemuck::cast_slice(&[origin.as_vec3(), ray.direction().as_vec3()]))?;
    }
    out.flush()?;
    let output = Command::new(&program).arg(&file).args([THREADS.to_string(), ROUNDS.to_string()]).output()?;
    if !output.status.success() {
        return Err(format!("Embree's program failed: {}", String::from_utf8_lossy(&output.stderr)).into());
    }
    let text = String::from_utf8(output.stdout)?;
    let line = |line: &str| {
        let [kind, way, rate, met] = line.split_whitespace().collect::<Vec<_>>()[..] else { return None };
        Some(Line { kind: kind.into(), way: way.into(), rate: rate.parse().ok()?, met: met.parse().ok()? })
    };
    Ok(text.lines().filter_map(line).collect())
}
