//! `shadow man`: the manual pages.

use std::io;

use clap::CommandFactory;
use clap_mangen::{
    Man,
    roff::{Roff, line_break, roman},
};

use super::Verdict;
use crate::{
    args::{Args, ManArgs},
    console::print,
    error::CliError,
};

/// Prints the page of the program, or of one of its commands.
pub(super) fn run(args: &ManArgs) -> Result<Verdict, CliError> {
    print(&page(args.command.as_deref()).map_err(CliError::Stdout)?)?;
    Ok(Verdict::Done)
}

/// A page as roff source. The names of commands were checked when they were typed.
fn page(command: Option<&str>) -> io::Result<String> {
    // `shadow help` has no page: a page is help.
    let mut program = Args::command().disable_help_subcommand(true);
    // Building gives the commands their full names, such as shadow-render.
    program.build();
    let subject = command.and_then(|name| program.find_subcommand(name)).unwrap_or(&program).clone();
    let notes = subject.get_after_long_help().or(subject.get_after_help()).map(ToString::to_string);
    let has_commands = subject.has_subcommands();
    let page = Man::new(subject);
    let mut roff = Vec::new();
    page.render_title(&mut roff)?;
    page.render_name_section(&mut roff)?;
    page.render_synopsis_section(&mut roff)?;
    page.render_description_section(&mut roff)?;
    page.render_options_section(&mut roff)?;
    if has_commands {
        page.render_subcommands_section(&mut roff)?;
    }
    if let Some(notes) = notes {
        // The lines are as they should look: columns, and commands that must not be broken.
        let lines: Vec<_> = notes.lines().flat_map(|line| [roman(line), line_break()]).collect();
        let none = std::iter::empty::<&str>;
        Roff::new().control("SH", ["NOTES"]).control("nf", none()).text(lines).control("fi", none()).to_writer(&mut roff)?;
    }
    Ok(String::from_utf8_lossy(&roff).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_has_a_page_of_its_own() {
        let main = page(None).unwrap();
        for command in crate::args::COMMANDS {
            assert!(main.contains(&format!("shadow\\-{command}(1)")), "{command} in {main}");
            let page = page(Some(command)).unwrap();
            assert!(page.contains(&format!(".TH shadow-{command} 1")), "{page}");
        }
        assert!(page(Some("render")).unwrap().contains("\\-\\-map\\-size"));
        assert!(!main.contains("shadow\\-help"), "there is no page for it");
    }

    #[test]
    fn examples_keep_their_lines() {
        let page = page(Some("plan")).unwrap();
        let notes = page.split(".nf\n").nth(1).and_then(|rest| rest.split(".fi").next()).unwrap();
        let example = notes.lines().find(|line| line.contains("shadow plan house.glb") && line.contains("4096"));
        assert!(example.is_some_and(|line| line.starts_with("  ")), "{notes}");
    }
}
