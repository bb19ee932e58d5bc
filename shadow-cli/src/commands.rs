//! The commands, a module each.

mod render;
mod compare;
mod bench;
mod info;
mod plan;
mod measure;
mod tune;
mod settings;
mod devices;
mod probe;
mod completions;
mod man;

use serde::Serialize;

use crate::{
    args::{Args, Command},
    error::CliError,
    resolve::Job,
};

/// What picture a report is of: the head of every such report.
#[derive(Clone, Copy, Debug, Serialize)]
struct PictureReport<'a> {
    scene: &'a str,
    notes: &'a [String],
    /// How many triangles are drawn.
    triangles: usize,
    /// Width and height in pixels.
    width: u32,
    height: u32,
}

impl<'a> PictureReport<'a> {
    fn of(job: &'a Job) -> Self {
        Self {
            scene: &job.scene_name,
            notes: &job.notes,
            triangles: job.scene.triangles().len(),
            width: job.plan.camera.width,
            height: job.plan.camera.height,
        }
    }
}

/// How a command that did its work ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// It is done, or the answer is yes.
    Done,
    /// The thing that was asked about is not so.
    NotSo,
}

/// Runs the command that was typed.
pub(crate) fn run(args: Args) -> Result<Verdict, CliError> {
    match args.into_command()? {
        Command::Render(args) => render::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Bench(args) => bench::run(&args),
        Command::Info(args) => info::run(&args),
        Command::Plan(args) => plan::run(&args),
        Command::Measure(args) => measure::run(&args),
        Command::Tune(args) => tune::run(&args),
        Command::Settings(args) => settings::run(&args),
        Command::Devices(args) => devices::run(&args),
        Command::Probe(args) => probe::run(&args),
        Command::Completions(args) => completions::run(&args),
        Command::Man(args) => man::run(&args),
    }
}
