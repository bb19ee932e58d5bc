//! `shadow settings`: the default settings file.

use super::Verdict;
use crate::{console::print, error::CliError, settings_file::DEFAULT_TEXT};

/// Prints the default settings with comments.
pub(super) fn run() -> Result<Verdict, CliError> {
    print(DEFAULT_TEXT)?;
    Ok(Verdict::Done)
}
