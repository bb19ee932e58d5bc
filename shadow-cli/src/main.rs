//! The program `shadow`: checkable shadow mapping on the command line.
//!
//! `main` is the storyboard: what was typed ([`args`]) becomes a job ([`resolve`]), a command runs it ([`commands`]), and its verdict
//! becomes the exit code: 0 done, 1 the thing asked about is not so, 2 it could not be done. An interruption ends it with 130
//! ([`interrupt`]).

#![forbid(unsafe_code)]

mod debug_view;
mod colors;
mod args;
mod specs;
mod bias;
mod light_camera;
mod light_drawing;
mod feedback;
mod settings_file;
mod presets;
mod shadowing;
mod convert;
mod resolve;
mod backend;
mod commands;
mod picture;
mod page;
mod plot;
mod exr;
mod output;
mod interrupt;
mod console;
mod machine;
mod memory;
mod resident;
mod statistics;
mod error;

use std::process::ExitCode;

use clap::Parser;

use crate::{args::Args, commands::Verdict, error::CliError};

/// The exit code of a comparison, or any other question, whose answer is no.
const NOT_SO: u8 = 1;
/// The exit code of a request that is wrong or cannot be carried out.
const FAILED: u8 = 2;

fn main() -> ExitCode {
    console::report_panics_as_defects();
    interrupt::remove_unfinished_files_when_interrupted();
    let args = match Args::try_parse() {
        Ok(args) => args,
        Err(usage) => {
            let usage = args::with_hint(usage);
            // A closed pipe is no reason to fail: there is nobody left to tell.
            let _ = usage.print();
            return u8::try_from(usage.exit_code()).map_or(ExitCode::FAILURE, ExitCode::from);
        }
    };
    match std::panic::catch_unwind(|| commands::run(args)) {
        Ok(Ok(Verdict::Done)) => ExitCode::SUCCESS,
        Ok(Ok(Verdict::NotSo)) => ExitCode::from(NOT_SO),
        Ok(Err(error)) if error.is_broken_pipe() => ExitCode::SUCCESS,
        Ok(Err(error)) => fail(&error),
        // The panic has reported itself.
        Err(_) => ExitCode::from(FAILED),
    }
}

/// Says what went wrong and gives the exit code for it.
fn fail(error: &CliError) -> ExitCode {
    console::complain(&error::chain(error));
    ExitCode::from(FAILED)
}
