//! `shadow completions`: what a shell needs to complete commands and options.

use clap::CommandFactory;

use super::Verdict;
use crate::{
    args::{Args, CompletionsArgs},
    console::print,
    error::CliError,
};

/// Prints the completions for a shell.
pub(super) fn run(args: &CompletionsArgs) -> Result<Verdict, CliError> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Args::command(), "shadow", &mut script);
    print(&String::from_utf8_lossy(&script))?;
    Ok(Verdict::Done)
}
