//! How the time of a frame grows with triangles, texels, pixels and hidden layers, on both renderers: prints the tables of the documents.
//!
//! ```text
//! cargo run --release -p shadow-tests --example scaling -- [--frames N] [TABLE...]
//! ```
//!
//! with the tables `triangles`, `maps`, `pixels` and `hidden`; without any, all of them. The scene is `builtin::waves`: a sheet of 16 by 9 m
//! that covers the same part of the picture and of the map however many triangles it has, so that more are smaller. It has one directional
//! light, the slope bias and the bilinear filter.
#![allow(clippy::print_stdout, reason = "the tables are its output")]

use std::{
    env,
    error::Error,
    fs,
    process::{Command, ExitCode},
    time::Instant,
};

use shadow_cpu::{CpuRenderer, RasterRules};
use shadow_gpu::{GpuError, GpuRenderer, GpuScene};
use shadow_math::ShadowSettings;
use shadow_scene::{FramePlan, Request, Scene, StageTimes, builtin};

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// How many frames of each backend are counted if nothing else is said: an odd number, whose median is one of them.
const FRAMES: usize = 7;
/// What a table does not vary.
const PICTURE: (u32, u32) = (1920, 1080);
const MAP_SIZE: u32 = 2048;
const TRIANGLES: u32 = 200_000;
/// How many triangles a layer of the hidden ones has, and how far below the one above it lies, in metres: what sticks out at the edges of 15
/// layers is less than a hundredth of the sheet.
const TRIANGLES_PER_LAYER: u32 = 100_000;
const LAYER_DISTANCE: f32 = 0.01;
/// What makes a process of this program draw on the CPU alone and say how much memory it had: see [`peak_of`].
const MEMORY: &str = "--memory";
/// Whether the nearest layer is drawn first or last.
const FRONT_TO_BACK: &str = "front-to-back";
const BACK_TO_FRONT: &str = "back-to-front";
/// The program's own statistics, and what makes the high-water mark the memory that is resident now (proc(5)).
const STATUS: &str = "/proc/self/status";
const CLEAR_REFS: &str = "/proc/self/clear_refs";
const RESET_PEAK: &str = "5";
const KIB_PER_MIB: f64 = 1024.0;

/// One row of a table.
#[derive(Clone, Copy, Debug)]
struct Case {
    /// Of each layer.
    triangles: u32,
    layers: u32,
    is_front_first: bool,
    picture: (u32, u32),
    map_size: u32,
}

impl Case {
    const BASE: Self = Self { triangles: TRIANGLES, layers: 1, is_front_first: true, picture: PICTURE, map_size: MAP_SIZE };

    fn scene(&self) -> Scene {
        let mut heights: Vec<f32> = (0..self.layers).map(|layer| -LAYER_DISTANCE * layer as f32).collect();
        if !self.is_front_first {
            heights.reverse();
        }
        builtin::waves(self.triangles, &heights)
    }

    fn plan(&self, scene: &Scene) -> Result<FramePlan> {
        let settings = ShadowSettings { map_size: self.map_size, ..ShadowSettings::default() };
        let (width, height) = self.picture;
        Ok(FramePlan::new(scene, &scene.cameras()[0].camera, &settings, width, height, None)?)
    }

    /// The case as arguments of a process that measures its memory, and back.
    fn to_arguments(self) -> [String; 6] {
        let order = if self.is_front_first { FRONT_TO_BACK } else { BACK_TO_FRONT };
        let (width, height) = self.picture;
        let [triangles, layers, width, height, map_size] =
            [self.triangles, self.layers, width, height, self.map_size].map(|number| number.to_string());
        [triangles, layers, order.into(), width, height, map_size]
    }

    fn from_arguments(arguments: &[String]) -> Result<Self> {
        let [triangles, layers, order, width, height, map_size] = arguments else {
            return Err("a case has six arguments".into());
        };
        Ok(Self {
            triangles: triangles.parse()?,
            layers: layers.parse()?,
            is_front_first: order == FRONT_TO_BACK,
            picture: (width.parse()?, height.parse()?),
            map_size: map_size.parse()?,
        })
    }
}

/// A table: what it is about, what its first column is of, and its rows.
struct Table {
    name: &'static str,
    title: String,
    column: &'static str,
    rows: Vec<(String, Case)>,
}

/// Digits in groups of three.
fn grouped(number: u32) -> String {
    let digits = number.to_string();
    let groups: Vec<&str> = digits.as_bytes().rchunks(3).rev().map(|group| std::str::from_utf8(group).unwrap_or("")).collect();
    groups.join(",")
}

fn tables() -> [Table; 4] {
    let base = Case::BASE;
    let (width, height) = PICTURE;
    let triangles = [1_000, 10_000, 100_000, 200_000, 500_000, 1_000_000, 2_000_000, 4_000_000];
    let maps = [256, 512, 1024, 2048, 4096, 8192];
    let pictures = [(320, 180), (640, 360), (1280, 720), (1920, 1080), (2560, 1440), (3840, 2160)];
    let hidden = [true, false].into_iter().flat_map(|is_front_first| {
        [1, 2, 4, 8, 16].map(|layers| {
            let order = if is_front_first { "nearest first" } else { "nearest last" };
            let case = Case { triangles: TRIANGLES_PER_LAYER, layers, is_front_first, ..base };
            (format!("{layers}, {order}"), case)
        })
    });
    [
        Table {
            name: "triangles",
            title: format!("Triangles of the same total area ({width} x {height} pixels, map of {MAP_SIZE} x {MAP_SIZE})"),
            column: "triangles",
            rows: triangles.map(|triangles| (grouped(triangles), Case { triangles, ..base })).to_vec(),
        },
        Table {
            name: "maps",
            title: format!("Texels ({} triangles, {width} x {height} pixels)", grouped(TRIANGLES)),
            column: "map",
            rows: maps.map(|map_size| (format!("{map_size} x {map_size}"), Case { map_size, ..base })).to_vec(),
        },
        Table {
            name: "pixels",
            title: format!("Pixels ({} triangles, map of {MAP_SIZE} x {MAP_SIZE})", grouped(TRIANGLES)),
            column: "picture",
            rows: pictures.map(|picture| (format!("{} x {}", picture.0, picture.1), Case { picture, ..base })).to_vec(),
        },
        Table {
            name: "hidden",
            title: format!(
                "Layers of {} triangles behind each other, as camera and light see them ({width} x {height} pixels, map of \
                 {MAP_SIZE} x {MAP_SIZE})",
                grouped(TRIANGLES_PER_LAYER)
            ),
            column: "layers, order in which they are drawn",
            rows: hidden.collect(),
        },
    ]
}

/// Draws the case on the GPU and waits for each stage, as the CPU renderer's own times are taken.
async fn draw_on_gpu(renderer: &GpuRenderer, scene: &GpuScene, plan: &FramePlan) -> std::result::Result<StageTimes, GpuError> {
    let start = Instant::now();
    let camera = renderer.camera(scene, plan).await?;
    let camera_done = Instant::now();
    let maps = renderer.shadow_maps(scene, plan).await?;
    let maps_done = Instant::now();
    let visibility = renderer.visibility(scene, plan, &camera, &maps).await?;
    let _color = renderer.color(scene, plan, &camera, &visibility).await?;
    let shading_done = Instant::now();
    let milliseconds = |from: Instant, to: Instant| (to - from).as_secs_f64() * 1e3;
    Ok(StageTimes {
        prepare: 0.0,
        camera: milliseconds(start, camera_done),
        shadow_maps: milliseconds(camera_done, maps_done),
        shading: milliseconds(maps_done, shading_done),
    })
}

fn median(times: &[StageTimes], stage: impl Fn(&StageTimes) -> f64) -> f64 {
    let mut values: Vec<f64> = times.iter().map(stage).collect();
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len().is_multiple_of(2) { 0.5 * (values[middle - 1] + values[middle]) } else { values[middle] }
}

/// The times of a case, frame by frame.
struct Times {
    cpu: Vec<StageTimes>,
    /// What the adapter does not allow, if it is that.
    gpu: std::result::Result<Vec<StageTimes>, String>,
}

/// What the adapter does not allow as a sentence; other errors end the program.
fn or_limit<T>(result: std::result::Result<T, GpuError>) -> Result<std::result::Result<T, String>> {
    match result {
        Ok(value) => Ok(Ok(value)),
        Err(error @ GpuError::Limit { .. }) => Ok(Err(error.to_string())),
        Err(error) => Err(error.into()),
    }
}

/// Times both renderers in turn, so that a disturbance of the machine, or its clock slowing down, hits both.
fn time(cpu: &CpuRenderer, gpu: &GpuRenderer, case: &Case, frames: usize) -> Result<Times> {
    let scene = case.scene();
    let plan = case.plan(&scene)?;
    let prepared = cpu.prepare(&scene);
    let uploaded = or_limit(pollster::block_on(gpu.upload(&scene)))?;
    let mut times = Times { cpu: Vec::with_capacity(frames), gpu: Ok(Vec::with_capacity(frames)) };
    // The first frame of each is not counted: it gets the memory that later ones use again.
    for round in 0..=frames {
        let on_cpu = cpu.draw(&prepared, &plan, Request::COLOR)?.times;
        let on_gpu = match &uploaded {
            Ok(uploaded) => or_limit(pollster::block_on(draw_on_gpu(gpu, uploaded, &plan)))?,
            Err(limit) => Err(limit.clone()),
        };
        if round > 0 {
            times.cpu.push(on_cpu);
        }
        match (on_gpu, &mut times.gpu) {
            (Ok(on_gpu), Ok(all)) if round > 0 => all.push(on_gpu),
            (Err(limit), all) => *all = Err(limit),
            _ => {}
        }
    }
    Ok(times)
}

/// The most memory, in MiB, that a process had resident which has the scene and draws frames on the CPU alone: with the scene and everything
/// else. It is a process of its own, since memory that another case left would be used again and not be seen. `None` where the system does
/// not tell.
fn peak_of(case: &Case) -> Result<Option<f64>> {
    let output = Command::new(env::current_exe()?).arg(MEMORY).args(case.to_arguments()).output()?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned().into());
    }
    Ok(String::from_utf8(output.stdout)?.trim().parse().ok())
}

/// The other side of [`peak_of`]. What making the scene took beyond the scene itself is not counted.
fn measure_memory(case: &Case) -> Result<()> {
    let scene = case.scene();
    let plan = case.plan(&scene)?;
    let cpu = CpuRenderer::new(0, RasterRules::default())?;
    let is_reset = fs::write(CLEAR_REFS, RESET_PEAK).is_ok();
    let prepared = cpu.prepare(&scene);
    for _ in 0..2 {
        drop(cpu.draw(&prepared, &plan, Request::COLOR)?);
    }
    let status = fs::read_to_string(STATUS).unwrap_or_default();
    let kib = status.lines().find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix("kB")?.trim().parse::<f64>().ok());
    match kib.filter(|_| is_reset) {
        Some(kib) => println!("{}", kib / KIB_PER_MIB),
        None => println!("unknown"),
    }
    Ok(())
}

fn print_table(table: &Table, cpu: &CpuRenderer, gpu: &GpuRenderer, frames: usize) -> Result<()> {
    println!("\n### {}\n", table.title);
    println!("| {} | CPU depth pass | CPU frame | GPU depth pass | GPU frame | GPU / CPU | CPU memory |", table.column);
    println!("|---|---|---|---|---|---|---|");
    let mut limits = Vec::new();
    for (name, case) in &table.rows {
        let memory = peak_of(case)?.map_or_else(|| "unknown".into(), |mib| format!("{mib:.0} MiB"));
        let Times { cpu, gpu } = time(cpu, gpu, case, frames)?;
        let medians = |times: &[StageTimes]| [median(times, |times| times.shadow_maps), median(times, StageTimes::frame)];
        let [cpu_depth, cpu_frame] = medians(&cpu);
        let of_gpu = match &gpu {
            Ok(times) => {
                let [gpu_depth, gpu_frame] = medians(times);
                format!("{gpu_depth:.1} | {gpu_frame:.1} | {:.2}", gpu_frame / cpu_frame)
            }
            Err(limit) => {
                limits.push(format!("{name}: {limit}"));
                "- | - | -".into()
            }
        };
        println!("| {name} | {cpu_depth:.1} | {cpu_frame:.1} | {of_gpu} | {memory} |");
    }
    for limit in limits {
        println!("\n{limit}");
    }
    Ok(())
}

fn run(arguments: &[String]) -> Result<()> {
    if let [first, case @ ..] = arguments
        && first == MEMORY
    {
        return measure_memory(&Case::from_arguments(case)?);
    }
    let tables = tables();
    let mut frames = FRAMES;
    let mut chosen = Vec::new();
    let mut arguments = arguments.iter();
    while let Some(argument) = arguments.next() {
        if argument == "--frames" {
            frames = arguments.next().ok_or("--frames needs a number")?.parse()?;
        } else if tables.iter().any(|table| table.name == argument) {
            chosen.push(argument.as_str());
        } else {
            let names: Vec<_> = tables.iter().map(|table| table.name).collect();
            return Err(format!("there is no table `{argument}`; there are {}", names.join(", ")).into());
        }
    }
    if frames == 0 {
        return Err("--frames must be at least 1".into());
    }
    let cpu = CpuRenderer::new(0, RasterRules::default())?;
    let gpu = pollster::block_on(GpuRenderer::new(None))?;
    println!(
        "Milliseconds, medians of {frames} frames of each in turn after one that is not counted; CPU with {} threads, GPU renderer on {}. \
         CPU memory is the most that a process had resident which has the scene and draws it on the CPU.",
        cpu.threads(),
        gpu.adapter().name
    );
    for table in tables.iter().filter(|table| chosen.is_empty() || chosen.contains(&table.name)) {
        print_table(table, &cpu, &gpu, frames)?;
    }
    Ok(())
}

#[allow(clippy::print_stderr, reason = "errors are told where they are read")]
fn main() -> ExitCode {
    let arguments: Vec<String> = env::args().skip(1).collect();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
