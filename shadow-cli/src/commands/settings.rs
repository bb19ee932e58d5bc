//! `shadow settings`: a settings file, or what a bias is in other numbers.

mod conversion;
mod preset;

use super::Verdict;
use crate::{args::SettingsArgs, console::print, error::CliError, presets::Kind, settings_file::DEFAULT_TEXT};

/// Prints the default settings or a preset with comments, or converts a bias.
pub(super) fn run(args: &SettingsArgs) -> Result<Verdict, CliError> {
    if let (Some(given), Some(to)) = (&args.convert, args.to) {
        return conversion::run(args, given, to);
    }
    if let Some(option) = args.scene_option() {
        return Err(CliError::SceneOfSettings(option));
    }
    match args.preset {
        Some(engine) => print(&preset::text(engine, args.kind.unwrap_or(Kind::Directional)))?,
        None => print(DEFAULT_TEXT)?,
    }
    Ok(Verdict::Done)
}
