//! What is told: reports on standard output, everything else on standard error.

use std::{
    io::{self, IsTerminal, Write},
    time::Duration,
};

use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

use crate::error::CliError;

/// How often the spinner turns.
const SPINNER_TICK: Duration = Duration::from_millis(100);

/// The bar: what is done, how much of it, and how long the rest will take.
const BAR: &str = "{msg} {bar:30} {pos}/{len}, {eta} left";

/// What is said while the work goes on, on standard error.
pub(crate) struct Console {
    spinner: ProgressBar,
}

impl Console {
    /// With a spinner on a terminal, unless a program reads the report.
    pub(crate) fn new(json: bool) -> Self {
        if json || !io::stderr().is_terminal() {
            return Self { spinner: ProgressBar::hidden() };
        }
        let spinner = ProgressBar::new_spinner();
        spinner.enable_steady_tick(SPINNER_TICK);
        Self { spinner }
    }

    /// Says what is being done.
    pub(crate) fn stage(&self, what: impl Into<String>) {
        self.spinner.set_message(what.into());
    }

    /// Shows a bar of `steps` in place of the spinner. It is drawn by [`Self::step`] alone: nothing runs beside what is being timed.
    pub(crate) fn bar(&self, steps: u64) {
        self.spinner.disable_steady_tick();
        if let Ok(style) = ProgressStyle::with_template(BAR) {
            self.spinner.set_style(style);
        }
        self.spinner.set_length(steps);
        self.spinner.set_position(0);
    }

    /// One step of the bar is done.
    pub(crate) fn step(&self) {
        self.spinner.inc(1);
    }

    /// Says something that a person should know.
    pub(crate) fn note(&self, note: &str) {
        self.spinner.suspend(|| complain(&format!("note: {note}")));
    }

    /// Ends the spinner, so that the report has the terminal for itself.
    pub(crate) fn finish(&self) {
        self.spinner.finish_and_clear();
    }
}

impl Drop for Console {
    /// Also where a command fails, no spinner stays behind before the message.
    fn drop(&mut self) {
        self.finish();
    }
}

/// Says a sentence on standard error under the program's name.
pub(crate) fn complain(sentence: &str) {
    // There is nowhere left to report that standard error is closed.
    let _ = writeln!(io::stderr().lock(), "shadow: {sentence}");
}

/// Makes a panic a sentence without a backtrace: it is a defect, whatever was asked for.
pub(crate) fn report_panics_as_defects() {
    std::panic::set_hook(Box::new(|panic| {
        let payload = panic.payload();
        let what = payload.downcast_ref::<&str>().copied().or_else(|| payload.downcast_ref::<String>().map(String::as_str));
        let what = what.unwrap_or("no reason given");
        let place = panic.location().map(|place| format!(" ({}:{})", place.file(), place.line())).unwrap_or_default();
        complain(&format!("this is a defect of the program, please report it: {what}{place}"));
    }));
}

/// Writes a report for people to standard output.
pub(crate) fn print(text: &str) -> Result<(), CliError> {
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).map_err(CliError::Stdout)
}

/// Writes a report for programs to standard output.
pub(crate) fn print_json(report: &impl Serialize) -> Result<(), CliError> {
    print(&to_json(report).map_err(CliError::Stdout)?)
}

/// A report as JSON text that ends with a line break.
pub(crate) fn to_json(report: &impl Serialize) -> io::Result<String> {
    let mut text = serde_json::to_string_pretty(report)?;
    text.push('\n');
    Ok(text)
}

/// A number of things: the plural is the singular with an s.
pub(crate) fn count(number: usize, thing: &str) -> String {
    if number == 1 { format!("1 {thing}") } else { format!("{number} {thing}s") }
}

/// A table: columns as wide as their widest cell, flush left where `is_left` says so of the column's index and right elsewhere.
pub(crate) fn table(rows: &[Vec<String>], is_left: impl Fn(usize) -> bool) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for row in rows {
        let cells = row.iter().enumerate().map(|(column, cell)| {
            let width = widths.get(column).copied().unwrap_or(0);
            if is_left(column) { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
        });
        text.push_str(cells.collect::<Vec<_>>().join("  ").trim_end());
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_line_up() {
        let rows = [["layer", "n", "verdict"], ["color", "1000", "equal"]].map(|row| row.map(String::from).to_vec());
        assert_eq!(table(&rows, |column| column != 1), "layer     n  verdict\ncolor  1000  equal\n");
    }
}
