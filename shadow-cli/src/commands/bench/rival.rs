//! Another tracer beside ours: a program that is sent the same mesh and the same rays.
//!
//! The program is started as `PROGRAM THREADS ROUNDS`. On its standard input it finds, little-endian: four u32 (vertices, triangles, camera rays, shadow rays), three f32
//! a vertex, three u32 a triangle, and seven f32 a ray (origin, direction, and where it ends in units of the direction). It writes a line for each kind of ray and each
//! way in which it sends them: `camera` or `shadow`, `single` or `packets`, millions of rays a second in its best round, and how many of them met something.

use std::{
    io::{BufWriter, Write},
    path::Path,
    process::{Command, Stdio},
    sync::atomic::{AtomicUsize, Ordering},
    time::Instant,
};

use serde::Serialize;
use shadow_cpu::trace::{CameraView, Ray, Rays, Tracer};
use shadow_math::{LightKind, glam::DVec3};
use shadow_scene::{NO_TRIANGLE, Scene};

use crate::{
    console::{Console, table},
    error::CliError,
};

/// Rounds of which the best counts: a busy machine only ever makes work slower.
const ROUNDS: u32 = 7;
/// How many rays a thread takes at a time: a row of most pictures.
const CHUNK: usize = 1280;
/// By what share of the scene's radius the rays that are sent to others are lifted off where they begin. Such tracers work in single precision, in which a surface is about as rough as this.
const LIFT: f64 = 1e-6;

/// Our tracer and another one on the same rays.
#[derive(Debug, Serialize)]
pub(super) struct RivalReport {
    /// The program as it was typed.
    program: String,
    threads: usize,
    rounds: u32,
    camera: KindReport,
    shadow: KindReport,
}

/// One kind of ray.
#[derive(Debug, Serialize)]
struct KindReport {
    /// How many rays were sent.
    rays: usize,
    /// How many of them met something, in our tracer.
    met: usize,
    /// Ours, in millions of rays a second.
    tracer: f64,
    single: TheirRate,
    packets: TheirRate,
}

/// What another program made of the rays.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct TheirRate {
    million_rays_per_second: f64,
    met: u64,
}

/// A ray for each pixel, and one from what each of them meets to every light that the surface faces.
fn rays_of(tracer: &Tracer<'_>, view: CameraView) -> [Vec<Ray>; 2] {
    let camera: Vec<Ray> = (0..view.height()).flat_map(|y| (0..view.width()).map(move |x| view.ray(x, y))).collect();
    let seen = tracer.camera(view, &|| {});
    let mut shadow = Vec::new();
    for (hit, ray) in seen.hits.iter().zip(&camera).filter(|(hit, _)| hit.triangle != NO_TRIANGLE) {
        let point = tracer.surface_point(hit, *ray);
        shadow.extend(tracer.scene().lights().iter().filter_map(|light| match light.light.kind {
            LightKind::Directional { direction } => point.along(-direction.as_dvec3()),
            LightKind::Spot { position, .. } | LightKind::Point { position, .. } => point.toward(position.as_dvec3()),
        }));
    }
    [camera, shadow]
}

/// Sends the rays of a picture through our tracer and through another program.
pub(super) fn race(program: &Path, tracer: &Tracer<'_>, view: CameraView, console: &Console) -> Result<RivalReport, CliError> {
    console.stage(format!("sending the same rays to {}", program.display()));
    let [camera, shadow] = rays_of(tracer, view);
    let threads = tracer.threads();
    let theirs = theirs(program, tracer.scene(), [&camera, &shadow], threads)
        .map_err(|problem| CliError::Rival { program: program.into(), problem })?;
    let [camera_rates, shadow_rates] = theirs;
    let report = |rays: &[Ray], meets: fn(&mut Rays<'_>, Ray) -> bool, [single, packets]: [TheirRate; 2]| {
        let (tracer, met) = best_rate(tracer, rays, meets);
        KindReport { rays: rays.len(), met, tracer, single, packets }
    };
    Ok(RivalReport {
        program: program.display().to_string(),
        threads,
        rounds: ROUNDS,
        camera: report(&camera, |rays, ray| rays.closest(ray).is_some(), camera_rates),
        shadow: report(&shadow, |rays, ray| rays.is_blocked(ray), shadow_rates),
    })
}

impl RivalReport {
    /// A table for people.
    pub(super) fn text(&self) -> String {
        let mut rows = vec![["rays", "sent", "met", "tracer", "single", "ratio", "packets", "met"].map(String::from).to_vec()];
        for (name, kind) in [("camera", &self.camera), ("shadow", &self.shadow)] {
            rows.push(vec![
                name.into(),
                kind.rays.to_string(),
                kind.met.to_string(),
                format!("{:.2}", kind.tracer),
                format!("{:.2}", kind.single.million_rays_per_second),
                format!("{:.2}", kind.tracer / kind.single.million_rays_per_second),
                format!("{:.2}", kind.packets.million_rays_per_second),
                kind.single.met.to_string(),
            ]);
        }
        format!(
            "\nthe same rays through {}, one at a time and in packets: millions a second on {} threads, best of {} rounds\n{}",
            self.program,
            self.threads,
            self.rounds,
            table(&rows, |column| column == 0)
        )
    }
}

/// Millions of rays a second in the best round, and how many rays `meets` says yes of.
fn best_rate(tracer: &Tracer<'_>, rays: &[Ray], meets: fn(&mut Rays<'_>, Ray) -> bool) -> (f64, usize) {
    let mut best = f64::INFINITY;
    let mut met = 0;
    for _ in 0..ROUNDS {
        let start = Instant::now();
        let (next, found) = (AtomicUsize::new(0), AtomicUsize::new(0));
        std::thread::scope(|scope| {
            for _ in 0..tracer.threads() {
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

/// What the other program makes of camera rays and of shadow rays: one at a time, and in packets.
fn theirs(program: &Path, scene: &Scene, rays: [&[Ray]; 2], threads: usize) -> Result<[[TheirRate; 2]; 2], String> {
    let mut child = Command::new(program)
        .args([threads.to_string(), ROUNDS.to_string()])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|error| format!("it cannot be started: {error}"))?;
    let pipe = child.stdin.take().ok_or("it has no standard input")?;
    // A program that ends early closes the pipe; why it ended says more than that.
    let sent = send(pipe, scene, rays);
    let output = child.wait_with_output().map_err(|error| format!("it cannot be waited for: {error}"))?;
    if !output.status.success() {
        return Err(format!("it failed ({}): {}", output.status, String::from_utf8_lossy(&output.stderr).trim()));
    }
    sent.map_err(|error| format!("it did not take the rays: {error}"))?;
    parse(&String::from_utf8_lossy(&output.stdout))
}

/// Writes the mesh and the rays.
fn send(pipe: impl Write, scene: &Scene, rays: [&[Ray]; 2]) -> Result<(), Box<dyn std::error::Error>> {
    let mut out = BufWriter::new(pipe);
    let positions = &scene.vertices().positions;
    for count in [positions.len(), scene.triangles().len(), rays[0].len(), rays[1].len()] {
        out.write_all(&u32::try_from(count)?.to_le_bytes())?;
    }
    for position in positions {
        write_floats(&mut out, &position.to_array())?;
    }
    for corner in scene.triangles().as_flattened() {
        out.write_all(&corner.to_le_bytes())?;
    }
    let lift = LIFT * f64::from(scene.bounds().radius());
    for ray in rays.into_iter().flatten() {
        let (origin, DVec3 { x, y, z }) = (ray.origin() + ray.direction() * lift, ray.direction());
        write_floats(&mut out, &[origin.x, origin.y, origin.z, x, y, z, ray.end()].map(|number| number as f32))?;
    }
    out.flush()?;
    Ok(())
}

fn write_floats(out: &mut impl Write, numbers: &[f32]) -> std::io::Result<()> {
    numbers.iter().try_for_each(|number| out.write_all(&number.to_le_bytes()))
}

/// The rates in a program's output.
fn parse(text: &str) -> Result<[[TheirRate; 2]; 2], String> {
    let find = |kind: &str, way: &str| {
        let line = text.lines().find_map(|line| {
            let [of, by, rate, met] = line.split_whitespace().collect::<Vec<_>>()[..] else { return None };
            let is_asked_for = of == kind && by == way;
            Some(TheirRate { million_rays_per_second: rate.parse().ok()?, met: met.parse().ok()? }).filter(|_| is_asked_for)
        });
        line.ok_or_else(|| format!("it wrote no line `{kind} {way} MILLIONS MET`"))
    };
    Ok([[find("camera", "single")?, find("camera", "packets")?], [find("shadow", "single")?, find("shadow", "packets")?]])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_found_by_their_names() {
        let text = "shadow packets 4 40\ncamera single 1.5 10\nnoise\ncamera packets 2 20\nshadow single 3 30\n";
        let rates = parse(text).expect("all four lines are there");
        assert_eq!(rates.as_flattened().iter().map(|rate| rate.met).collect::<Vec<_>>(), [10, 20, 30, 40]);
        assert_eq!(rates[0][0].million_rays_per_second, 1.5);
        let problem = parse("camera single 1 2").expect_err("three lines are missing");
        assert!(problem.contains("camera packets"), "{problem}");
    }

    #[test]
    fn what_is_sent_has_the_counts_before_the_numbers() {
        let scene = shadow_scene::builtin::by_name("tilted-plane").expect("it is built in");
        let ray = Ray::between(DVec3::ZERO, DVec3::new(0.0, 4.0, 0.0));
        let mut sent = Vec::new();
        send(&mut sent, &scene, [&[ray], &[]]).expect("a vector takes all");
        let (vertices, triangles) = (scene.vertices().positions.len(), scene.triangles().len());
        assert_eq!(sent.len(), 16 + 12 * vertices + 12 * triangles + 28);
        let last: Vec<f32> =
            sent[sent.len() - 16..].chunks(4).map(|word| f32::from_le_bytes(word.try_into().expect("four bytes"))).collect();
        assert_eq!(last, [0.0, 1.0, 0.0, 4.0]);
    }
}
