//! `shadow settings`: its options.

use clap::Args as ClapArgs;

use super::SceneArgs;
use crate::{
    convert::{GivenBias, System},
    presets::{Engine, Kind},
    specs::{LightSpec, Selector, angle, distance, map_size},
};

/// The angle between normal and light where none is given, in degrees: half-way, where sine and cosine are alike and a slope of one texel is a texel.
pub(crate) const DEFAULT_ANGLE_DEGREES: f32 = 45.0;

/// `shadow settings`.
#[derive(Debug, ClapArgs)]
pub(crate) struct SettingsArgs {
    /// Which scene.
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// Print the defaults of an engine, as far as a settings file can say them, in place of those of this program
    #[arg(long, value_enum, value_name = "NAME", conflicts_with = "convert", help_heading = "Shadows")]
    pub(crate) preset: Option<Engine>,

    /// The kind of light whose defaults are printed: a file has those of one kind [default: directional]
    #[arg(long, value_enum, value_name = "KIND", requires = "preset", help_heading = "Shadows")]
    pub(crate) kind: Option<Kind>,

    /// Convert a bias: ENGINE for its defaults, or ENGINE:NAME=VALUE;NAME=VALUE with the engine's own names
    ///
    /// The engines are metres, ogre-2006, ogre-1.12, ogre-13, mjp, filament, bevy, three, babylon and godot; `shadow settings --help` has
    /// their names at its end.
    #[arg(long, value_name = "FROM", requires = "to", help_heading = "Conversion")]
    pub(crate) convert: Option<GivenBias>,

    /// The engine into whose numbers the bias is converted, or metres
    #[arg(long, value_name = "ENGINE", requires = "convert", help_heading = "Conversion")]
    pub(crate) to: Option<System>,

    /// A light in place of the scene's own; can be given several times
    ///
    /// `shadow help render` says how it is written, such as directional:dir=-1,-2,-1;lux=20000.
    #[arg(long = "light", value_name = "SPEC", requires = "convert", help_heading = "Conversion")]
    pub(crate) lights: Vec<LightSpec>,

    /// The light for which is converted, by its name or number [default: the first]
    #[arg(long, value_name = "NAME|N", requires = "convert", help_heading = "Conversion")]
    pub(crate) of_light: Option<Selector>,

    /// Width and height of its shadow map in texels, from 16 to 16384 [default: 2048]
    #[arg(long, value_name = "TEXELS", value_parser = map_size, requires = "convert", help_heading = "Conversion")]
    pub(crate) map_size: Option<u32>,

    /// How far the surface is from the light along its axis, in metres, as `shadow plan` counts it [default: the middle of the range of depth]
    #[arg(
        long,
        value_name = "METRES",
        value_parser = distance,
        allow_negative_numbers = true,
        requires = "convert",
        help_heading = "Conversion"
    )]
    pub(crate) at: Option<f32>,

    /// The angle between the surface's normal and the light, in degrees, from 0 to below 90 [default: 45]
    #[arg(
        long,
        value_name = "DEGREES",
        value_parser = angle,
        allow_negative_numbers = true,
        requires = "convert",
        help_heading = "Conversion"
    )]
    pub(crate) angle: Option<f32>,

    /// Report the conversion as JSON on standard output
    ///
    /// An object with `scene`, `notes`, `light` (its `index`, `name` and `kind`), `map_size`, `depth_range` and `texel` in metres (the latter
    /// where the surface is), `at`, `angle`, `from` and `to` (each with its `engine` and its `parameters` by name; null for one that no number
    /// of can do it), and `components`. Each of these has its `name` (`constant`, `normal`, `slope`), its length in `metres` and `texels`, and
    /// the `problem` that the target has with it (null for none).
    #[arg(long, requires = "convert")]
    pub(crate) json: bool,
}

impl SettingsArgs {
    /// The first choice of a scene that was made, by its name; without a conversion there is no scene.
    pub(crate) fn scene_option(&self) -> Option<&'static str> {
        let SceneArgs { source, part, animation, time, memory_limit } = &self.scene;
        let given = [
            (source.is_some(), "SCENE"),
            (part.is_some(), "--scene"),
            (animation.is_some(), "--animation"),
            (time.is_some(), "--time"),
            (memory_limit.is_some(), "--memory-limit"),
        ];
        given.into_iter().find(|(is_given, _)| *is_given).map(|(_, name)| name)
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use crate::args::{Args, with_hint};

    fn parse(line: &str) -> Result<Args, clap::Error> {
        Args::try_parse_from(line.split_whitespace())
    }

    /// A preset is all of what it says; the way out is told.
    #[test]
    fn presets_stand_by_themselves() {
        for option in [
            "--filter hard",
            "--filter-radius 2",
            "--store depth16",
            "--texels direct3d",
            "--terminator soft",
            "--map-size 64",
            "--bias none",
            "--bias-constant 1",
            "--bias-scale 1",
            "--bias-normal 1",
            "--bias-limit 1",
            "--bias-gradient 1,1,1",
            "--bias-offset 1,1",
            "--bias-push 1",
        ] {
            for command in ["render", "compare", "bench", "plan", "measure"] {
                let usage = parse(&format!("shadow {command} --preset bevy {option}")).expect_err(option);
                let told = with_hint(usage).to_string();
                let name = option.split(' ').next().unwrap_or_default();
                assert!(told.contains(name) && told.contains("shadow settings --preset NAME"), "{told}");
            }
        }
        for line in ["bench --filters all", "measure --settings a.toml"] {
            assert!(parse(&format!("shadow {line} --preset bevy")).is_err(), "{line}");
        }
        assert!(parse("shadow tune --preset bevy").is_err(), "biases are tried there, not chosen");
        assert!(parse("shadow render --preset unity").expect_err("there is no such preset").to_string().contains("babylon"));
        for line in ["--kind spot", "--preset bevy --convert bevy --to three", "--convert bevy", "--to three", "--at 3", "--json"]
        {
            assert!(parse(&format!("shadow settings {line}")).is_err(), "{line}");
        }
    }
}
