//! A preset as a settings file.

use crate::{
    presets::{Engine, Kind},
    settings_file::SettingsReport,
};

/// The settings file of an engine's defaults for a kind of light, with what it does not say and the same as options.
pub(super) fn text(engine: Engine, kind: Kind) -> String {
    let name = format!("{}, {}", engine.name(), kind.name());
    let settings = SettingsReport::of(&name, &engine.settings(kind));
    let mut head = format!(
        "# The defaults of {} for {} lights, as far as settings can say them.\n# To measure them against the truth: shadow measure SCENE --settings THIS_FILE\n",
        engine.name(),
        kind.name()
    );
    let differences = engine.differences(kind);
    if !differences.is_empty() {
        head.push_str("#\n# Not as there:\n");
        for sentence in differences {
            head.push_str(&format!("# - {sentence}\n"));
        }
    }
    head.push_str(&format!("#\n# The same as options: {}\n", settings.options()));
    settings.file(&head)
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;
    use crate::{
        args::{Args, Command},
        backend::Place,
        console::Console,
        resolve::Job,
        settings_file::parse,
    };

    /// A printed preset is the preset, as a file and as options.
    #[test]
    fn what_is_printed_says_the_same() {
        for (engine, kind) in Engine::ALL.into_iter().flat_map(|engine| Kind::ALL.map(|kind| (engine, kind))) {
            let text = text(engine, kind);
            let (name, settings) = parse(&text).expect(&text);
            assert_eq!((name, settings), (Some(format!("{}, {}", engine.name(), kind.name())), engine.settings(kind)), "{text}");
            let options = text.lines().find_map(|line| line.strip_prefix("# The same as options: ")).expect("they are there");
            let line = format!("shadow plan {options}");
            let command = Args::try_parse_from(line.split_whitespace()).expect(&line).command;
            let args = if let Some(Command::Plan(args)) = command { Some(args) } else { None };
            let args = args.expect("the line asks for a plan");
            let job =
                Job::resolve(&args.picture, &args.bias, Place::NOWHERE, &Console::new(true)).expect("the options go together");
            assert_eq!(job.shadowing.of_first(&job.scene), engine.settings(kind), "{line}");
        }
    }
}
