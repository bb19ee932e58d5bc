//! What was typed: the commands and their options, checked one by one but not yet against a scene or a machine.
//!
//! The doc comments of this file are the program's help.

mod filter;
mod help;
mod plan;
mod probe;
mod settings;
mod shadow;

use std::path::PathBuf;

use clap::{
    Args as ClapArgs, Parser, Subcommand, ValueEnum,
    builder::{OsStringValueParser, PossibleValuesParser, TypedValueParser},
    error::{ContextKind, ContextValue, ErrorKind},
};
use clap_complete::Shell;
use shadow_cpu::trace::Sampling;
use shadow_scene::Choice;

use self::help::{
    BENCH_HELP, COMPARE_EXAMPLES, COMPLETIONS_EXAMPLES, EXAMPLES, INFO_EXAMPLES, MAN_EXAMPLES, MEASURE_HELP, PLAN_EXAMPLES,
    RENDER_EXAMPLES, SETTINGS_HELP, SHOW_HELP, SHOW_LONG_HELP, TUNE_HELP,
};
pub(crate) use self::{
    filter::{FilterList, FilterName},
    plan::PlanArgs,
    probe::ProbeArgs,
    settings::{DEFAULT_ANGLE_DEGREES, SettingsArgs},
    shadow::{BiasArgs, LightSettings, ShadowArgs},
};
use crate::specs::{
    BackendList, BackendPair, ByteSize, CameraChoice, LightSpec, PictureSize, SceneSource, Show, exposure_value, light_samples,
    seconds,
};

/// Checkable shadow mapping: the same shadows from two independent renderers
///
/// `shadow` renders a scene with shadow maps, on the CPU or on the GPU. Both renderers follow one plan, and `shadow compare` checks that
/// they agree, image by image. A scene is a glTF 2.0 file (.gltf or .glb) with its lights and cameras; without one, a built-in demo is
/// drawn. Lengths are metres, angles degrees, light is measured in lux (directional) or candela (spot, point).
///
/// Without any argument, `shadow` draws the demo to shadow.png.
#[derive(Debug, Parser)]
#[command(name = "shadow", version, after_help = EXAMPLES, max_term_width = 110)]
pub(crate) struct Args {
    /// What to do; nothing is `render`.
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
}

impl Args {
    /// The command; without one, the demo is rendered with every default.
    pub(crate) fn into_command(self) -> Result<Command, clap::Error> {
        match self.command {
            Some(command) => Ok(command),
            None => DefaultArgs::try_parse_from(["shadow"]).map(|args| Command::Render(args.render)),
        }
    }
}

/// A usage error with a hint for those who name a scene without a command, or a preset beside what it says.
pub(crate) fn with_hint(mut usage: clap::Error) -> clap::Error {
    if usage.kind() == ErrorKind::ArgumentConflict && usage.to_string().contains("'--preset <") {
        let hint = "to change a preset, print it with `shadow settings --preset NAME`: as a file for `shadow measure --settings`, and as options";
        usage.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![hint.into()]));
        return usage;
    }
    let Some(ContextValue::String(typed)) = usage.get(ContextKind::InvalidSubcommand) else { return usage };
    // A command has no dot, colon or slash in it, and a scene's name has one.
    if usage.kind() == ErrorKind::InvalidSubcommand && typed.contains(['.', ':', '/', '\\']) {
        let hint = format!("to draw a scene, write `shadow render {typed}`");
        usage.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![hint.into()]));
    }
    usage
}

/// The options of `shadow render` by themselves: clap fills in the defaults.
#[derive(Debug, Parser)]
struct DefaultArgs {
    #[command(flatten)]
    render: RenderArgs,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Draw one picture of a scene, or its numbers
    ///
    /// Draws the scene, or one of the layers that the picture is made of, and writes it: as a PNG file to look at, or as an OpenEXR file
    /// with the exact numbers.
    #[command(after_help = RENDER_EXAMPLES)]
    Render(RenderArgs),
    /// Check that two renderers agree, layer by layer
    ///
    /// Renders the scene with both backends and compares every layer: the triangles that the camera sees, their depth, all shadow maps,
    /// the visibility of every light, and the color.
    ///
    /// On a driver whose rules are known exactly (lavapipe of Mesa 22.3, SwiftShader) the contract is `exact`: any differing bit breaks it. On any
    /// other it is `tolerance`: WebGPU leaves drivers choices about edges and rounding, so pixels where one of them decides are left out
    /// and counted by their reason, and the rest must agree.
    ///
    /// The exit code is 0 if the backends agree and 1 if they do not.
    #[command(after_help = COMPARE_EXAMPLES)]
    Compare(CompareArgs),
    /// Time the renderers on the same frame
    ///
    /// Draws the same frame again and again with each backend and says how long each stage takes. Nothing is written, and nothing is
    /// read back from the adapter.
    #[command(after_long_help = BENCH_HELP)]
    Bench(BenchArgs),
    /// Show what is in a scene
    ///
    /// Counts what the scene has and what is drawn of it, gives its bounds, lights, cameras, animations and extensions, and guesses in which
    /// unit it was made.
    ///
    /// glTF's unit is the metre, and so shadows are computed in metres; many files are in centimetres or millimetres all the same. The
    /// guess goes by the diagonal of the bounds: metres up to 100 m, metres or centimetres up to 1 km, centimetres up to 20 km,
    /// millimetres beyond, kilometres below 1 cm. It is a guess: a town is larger than 1 km in metres too.
    #[command(after_help = INFO_EXAMPLES)]
    Info(InfoArgs),
    /// Show the plan that both renderers follow
    ///
    /// Shows how the picture would be made, without making it: the camera's matrix and, for every light and every view of it, the matrix,
    /// the depth range and the texel size in metres, the bias, and the bounds on rounding. Matrices map points relative to the scene's
    /// origin, which is given too; they are lists of rows and multiply column vectors.
    #[command(after_help = PLAN_EXAMPLES)]
    Plan(PlanArgs),
    /// Measure techniques against the truth, and say why pixels are wrong
    ///
    /// Renders the scene with one or more techniques and traces what its shadows should be. Every pixel whose visibility is not the truth is
    /// counted under one cause.
    #[command(after_long_help = MEASURE_HELP)]
    Measure(MeasureArgs),
    /// Certify the automatic bias on a scene, beside the defaults of engines
    ///
    /// Renders the scene with the automatic bias, judges it against rays, and asks the same maps again with less bias, with a constant one and as other
    /// engines do by default: how much acne is left, and how far from what casts them shadows begin.
    ///
    /// The exit code is 0 if the automatic bias leaves no acne and 1 if it does.
    #[command(after_long_help = TUNE_HELP)]
    Tune(TuneArgs),
    /// Print a settings file, with comments, or convert a bias between engines
    ///
    /// Prints all that a settings file can say, in TOML: the defaults, or with --preset those of an engine. Change what is to differ, leave
    /// out the rest, and give the file to `shadow measure --settings`.
    ///
    /// With --convert it prints no file, but what a bias in one engine's numbers is in metres and in another's, for a light of a scene.
    #[command(after_long_help = SETTINGS_HELP)]
    Settings(SettingsArgs),
    /// List the graphics adapters that the GPU backend can use
    Devices(DevicesArgs),
    /// Measure what a graphics adapter does where WebGPU leaves it a choice
    ///
    /// Draws small pictures and reads them back: the sub-pixel grid and edge rule, which plane depth is read from and how exactly, the units of the
    /// pipeline's depth bias, the weights of the comparison sampler, and what depth formats keep. What cannot be measured is said to be so. A
    /// warning follows where a technique here would depend on what was found.
    #[command(after_help = probe::PROBE_EXAMPLES)]
    Probe(ProbeArgs),
    /// Print what a shell needs to complete commands and options
    #[command(after_help = COMPLETIONS_EXAMPLES)]
    Completions(CompletionsArgs),
    /// Print a manual page
    ///
    /// Prints the manual page of the program, or of one of its commands, in the form that man(1) reads.
    #[command(after_help = MAN_EXAMPLES)]
    Man(ManArgs),
}

/// The names of the commands.
pub(crate) const COMMANDS: [&str; 12] =
    ["render", "compare", "bench", "info", "plan", "measure", "tune", "settings", "devices", "probe", "completions", "man"];

/// Which scene: the choices that all commands on scenes share.
#[derive(Debug, ClapArgs)]
pub(crate) struct SceneArgs {
    /// The scene: a .gltf or .glb file, or builtin:NAME
    ///
    /// The built-in scenes are demo, box-on-plane, fence, tilted-plane and grazing; without a scene it is the demo.
    #[arg(value_name = "SCENE", value_parser = OsStringValueParser::new().map(SceneSource::from))]
    pub(crate) source: Option<SceneSource>,

    /// One of the scenes of a file that has several, by its name or number [default: the file's own]
    ///
    /// Numbers count from 0; `shadow info` lists the scenes. A scene whose name is a number goes by its number.
    #[arg(long = "scene", value_name = "NAME|N", help_heading = "Scene")]
    pub(crate) part: Option<Choice>,

    /// The animation whose pose is drawn, by its name or number [default: the first]
    ///
    /// Numbers count from 0; `shadow info` lists the animations and how long they are.
    #[arg(long, value_name = "NAME|N", help_heading = "Scene")]
    pub(crate) animation: Option<Choice>,

    /// The time of the pose, in seconds from the beginning of the animation [default: 0]
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true, help_heading = "Scene")]
    pub(crate) time: Option<f64>,

    /// The most memory that meshes, textures, shadow maps and frames may take together, such as 6GiB [default: 3/4 of the machine's]
    ///
    /// An amount with KiB, MiB, GiB or TiB, or a number of bytes. Left out, it is three quarters of the machine's memory, or of what a
    /// control group (a container) allows; 16 GiB where the system does not tell, which is anywhere but on Linux. What would take
    /// more is refused before it is begun, with what takes how much. While a file is read its limit is the same.
    #[arg(long, value_name = "SIZE", help_heading = "Scene")]
    pub(crate) memory_limit: Option<ByteSize>,
}

/// What picture of which scene: the choices that all commands on pictures share.
#[derive(Debug, ClapArgs)]
pub(crate) struct PictureArgs {
    /// Which scene.
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// Width and height of the picture in pixels, each from 1 to 16384
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "1280x720", help_heading = "Picture")]
    pub(crate) size: PictureSize,

    /// The camera: its name or number in the scene, or a place [default: the scene's first]
    ///
    /// Numbers count from 0. A place is `eye=X,Y,Z;target=X,Y,Z;fov=DEGREES`, with points in metres of the file's world space, where y is
    /// up; fov is the vertical angle of view, 45 if left out. A camera whose name is a number or has an equals sign goes by its number.
    #[arg(long, value_name = "CAMERA", allow_hyphen_values = true, help_heading = "Picture")]
    pub(crate) camera: Option<CameraChoice>,

    /// A light in place of the scene's own; can be given several times
    ///
    /// Each kind of light takes:
    ///
    ///   directional:dir=X,Y,Z;lux=N;diameter=DEGREES
    ///   spot:pos=X,Y,Z;dir=X,Y,Z;inner=DEGREES;outer=DEGREES;cd=N;range=METRES
    ///   point:pos=X,Y,Z;cd=N;range=METRES
    ///
    /// and each also color=R,G,B (linear; white if left out).
    ///
    /// A light can have a size, which shadow maps do not see and the tracer
    /// does: the diameter of a directional light in the sky (0.53 for the
    /// sun), the radius=METRES of a spot or point light, or width=METRES and
    /// height=METRES of a spot light that is a rectangle across its axis.
    ///
    /// A spot light of at most 70 degrees can project a picture,
    /// picture=FILE: a PNG or JPEG file that fills the square around its
    /// outer cone and multiplies its color. One that darkens outwards is its
    /// falloff.
    ///
    /// dir is the way the light travels, pos its place in metres of the
    /// file's world space. A spot light's angles are measured from its axis:
    /// full brightness up to inner (0 if left out), none beyond outer (at
    /// most 90). There is no light beyond range; left out, there is no such
    /// limit.
    #[arg(long = "light", value_name = "SPEC", verbatim_doc_comment, help_heading = "Picture")]
    pub(crate) lights: Vec<LightSpec>,

    /// Exposure value (EV at ISO 100): 15 suits a sunny day, 5 a lit room [default: by the lights]
    ///
    /// From -64 to 64; every step up halves the brightness. Without it the exposure is chosen by a fixed rule from the lights, the same
    /// on every backend.
    #[arg(long, value_name = "EV", value_parser = exposure_value, allow_negative_numbers = true, help_heading = "Picture")]
    pub(crate) exposure: Option<f32>,

    /// How its lights are shadowed.
    #[command(flatten)]
    pub(crate) shadows: ShadowArgs,
}

/// What renders: the choices that all commands that render share.
#[derive(Clone, Debug, Default, ClapArgs)]
pub(crate) struct MachineArgs {
    /// Take the graphics adapter whose name contains NAME (`shadow devices` lists them)
    #[arg(long, value_name = "NAME", help_heading = "Backend")]
    pub(crate) adapter: Option<String>,

    /// Threads of the CPU backend, at most 1024; 0 is one for each core
    #[arg(
        long,
        value_name = "N",
        default_value_t = 0,
        value_parser = clap::value_parser!(u32).range(0..=1024),
        help_heading = "Backend"
    )]
    pub(crate) threads: u32,
}

/// Which renderer, and how rays are sent to lights: the choices of commands that render with one backend and may trace.
#[derive(Clone, Copy, Debug, ClapArgs)]
pub(crate) struct RenderingArgs {
    /// What renders
    #[arg(long, value_enum, value_name = "BACKEND", default_value_t = Backend::Cpu, help_heading = "Backend")]
    pub(crate) backend: Backend,

    /// Rays of the tracer to each light that has a size: a square number from 1 to 4096 [default: 64]
    ///
    /// They are spread over the light, one in each cell of a square grid. A light without a size takes a single ray.
    #[arg(long, value_name = "N", value_parser = light_samples, help_heading = "Backend")]
    pub(crate) light_samples: Option<Sampling>,
}

/// `shadow render`.
#[derive(Debug, ClapArgs)]
pub(crate) struct RenderArgs {
    /// What picture of which scene.
    #[command(flatten)]
    pub(crate) picture: PictureArgs,

    /// Its bias.
    #[command(flatten)]
    pub(crate) bias: BiasArgs,

    /// What to draw.
    #[arg(long, value_name = "LAYER", default_value = "color", help = SHOW_HELP, long_help = SHOW_LONG_HELP, help_heading = "Picture")]
    pub(crate) show: Show,

    /// The file to write; its name must end in .png or .exr
    ///
    /// PNG is a picture to look at. EXR has the numbers, exactly as they were computed, as 32-bit floats: color is linear red, green, blue
    /// and alpha after exposure; the other layers have one number, in red, green and blue alike. depth is reversed, 1 at the camera's near
    /// plane and 0 at infinity or the far plane, and where there is nothing. shadow-map is 0 at the light's near plane and 1 at its far
    /// plane, and where there is nothing. visibility is 0 in shadow and 1 in light. `shadow plan --json` has the matrices that turn depths
    /// into metres. A file that is already there is replaced once the new one is complete.
    #[arg(short, long, value_name = "FILE", default_value = "shadow.png", help_heading = "Picture")]
    pub(crate) output: PathBuf,

    /// The backend, and how the tracer samples.
    #[command(flatten)]
    pub(crate) rendering: RenderingArgs,

    /// Adapter and threads.
    #[command(flatten)]
    pub(crate) machine: MachineArgs,

    /// Report as JSON on standard output
    ///
    /// An object with `scene`, `notes`, `backend`, `adapter` (null for the CPU), `triangles`, `width` and `height` of what was drawn,
    /// `milliseconds` (`prepare` once per scene; `shadow_maps`, `camera` and `shading`, whose sum is `total`), `light_samples` (null where no
    /// light was sampled: `count`, and the `widest_interval` that holds a pixel's true visibility with a `confidence` of 0.95) and `output`.
    #[arg(long)]
    pub(crate) json: bool,
}

/// `shadow compare`.
#[derive(Debug, ClapArgs)]
pub(crate) struct CompareArgs {
    /// What picture of which scene.
    #[command(flatten)]
    pub(crate) picture: PictureArgs,

    /// Its bias.
    #[command(flatten)]
    pub(crate) bias: BiasArgs,

    /// The two backends to compare
    #[arg(long, value_name = "A,B", default_value = "cpu,gpu", help_heading = "Backend")]
    pub(crate) backends: BackendPair,

    /// Adapter and threads.
    #[command(flatten)]
    pub(crate) machine: MachineArgs,

    /// A folder for pictures of every layer, of the differences, and comparison.json
    ///
    /// It is made if it is not there. Every layer becomes three pictures, LAYER-cpu.png, LAYER-gpu.png and LAYER-difference.png;
    /// comparison.json is the report of --json. A difference is black where the two are equal and otherwise at least dark grey, white being
    /// the largest difference of the layer.
    #[arg(short, long, value_name = "FOLDER", help_heading = "Picture")]
    pub(crate) output: Option<PathBuf>,

    /// Report as JSON on standard output
    ///
    /// An object with `scene`, `notes`, `agree`, `contract` (`exact` or `tolerance`), `backends`, `adapter`, and for each of `layers` its `name`, `pixels`, `differing` (in any bit), `left_out` (pixels by reason), `max_difference` (null where one of
    /// the values is not a number and the other is), `violations` and `within_contract`.
    #[arg(long)]
    pub(crate) json: bool,
}

/// `shadow bench`.
#[derive(Debug, ClapArgs)]
pub(crate) struct BenchArgs {
    /// What picture of which scene.
    #[command(flatten)]
    pub(crate) picture: PictureArgs,

    /// Its bias.
    #[command(flatten)]
    pub(crate) bias: BiasArgs,

    /// The backends to time, in turn: any of cpu, gpu and trace
    #[arg(long, value_name = "LIST", default_value = "cpu,gpu", help_heading = "Backend")]
    pub(crate) backends: BackendList,

    /// Adapter and threads.
    #[command(flatten)]
    pub(crate) machine: MachineArgs,

    /// Time filters in place of backends: their names with commas, or all
    ///
    /// Each is drawn in turn on each backend, and compared with a hard test: how long visibility and shading take together, and how long each further
    /// depth test takes of that.
    #[arg(long, value_name = "LIST", conflicts_with_all = ["filter", "filter_radius", "preset"], help_heading = "Shadows")]
    pub(crate) filters: Option<FilterList>,

    /// A program that sends the same rays through another tracer, with --backends trace
    ///
    /// It is started as `PROGRAM THREADS ROUNDS`, finds the mesh and the rays on its standard input, and writes how many millions of them it sends a second. tests/embree/rays.cpp is
    /// such a program for Embree 3 (on Debian: `c++ -O2 rays.cpp -lembree3 -lpthread -o rays`).
    #[arg(long, value_name = "PROGRAM", conflicts_with = "filters", help_heading = "Backend")]
    pub(crate) rival: Option<PathBuf>,

    /// Frames of each backend that are timed, from 1 to 10000
    #[arg(long, value_name = "N", default_value_t = 15, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(crate) frames: u32,

    /// Report as JSON on standard output
    ///
    /// An object with `scene`, `notes`, `triangles`, `width`, `height`, `shadow_maps` (how many), `map_size`, `frames`, `backends` and
    /// `ratios`. Each backend has its name as `backend`, its `adapter` (null for the CPU) and `threads` (null for the GPU), the medians in `milliseconds`
    /// (`shadow_maps`, `camera`, `shading`, `total`), for each of these the `spread` (`min`, `lower_quartile`, `median`, `upper_quartile`, `max`),
    /// `milliseconds_once` (`open`, `prepare`, `first_frame`) and `peak_bytes` (null where the system does not tell). `ratios` says `of` what,
    /// and has the same stages and their `spread`; it is null unless there are two backends. `million_rays_per_second` (`camera`, `shadow`) is null but for trace.
    /// `rival` is null without --rival; otherwise its `program`, `threads` and `rounds`, and for `camera` and `shadow` how many `rays` were sent and `met` something, our `tracer`'s millions of rays a
    /// second, and for `single` rays and `packets` the other's `million_rays_per_second` and how many `met`.
    ///
    /// With --filters an object with `scene`, `notes`, `triangles`, `width`, `height`, `map_size`, `frames`, `lookups` (pixels times lights) and `filters`: each has its `filter`, its
    /// `tests` a lookup (null where they vary) and for each of its `backends` the `backend`, the median `shading_milliseconds`, and `nanoseconds_per_further_test` (null for one test).
    #[arg(long)]
    pub(crate) json: bool,
}

/// `shadow info`.
#[derive(Debug, ClapArgs)]
pub(crate) struct InfoArgs {
    /// Which scene.
    #[command(flatten)]
    pub(crate) scene: SceneArgs,

    /// Report as JSON on standard output
    ///
    /// An object with `scene`, `notes`, `generator`, `triangles`, `vertices` and `instances` that are drawn, `meshes`, `primitives`,
    /// `materials` (`opaque`, `mask`, `blend`), `textures`, `images`, `lights` (`name`, `kind`, `intensity`, `unit`), `cameras`, `scenes`, `drawn_scene`,
    /// `animations` (`name`, `seconds`, `channels`), `drawn_animation`, `time`, `skins`, `bounds` (`min`, `max`, `size`, `diagonal`, in metres of the
    /// file's world space), `units_guess` (`kilometres`, `metres`, `metres-or-centimetres`, `centimetres`, `millimetres`), `extensions_used` and
    /// `extensions_ignored`. A light or camera that stands in for one that the scene lacks is not listed;
    /// `bounds` and `units_guess` are null if nothing is drawn.
    #[arg(long)]
    pub(crate) json: bool,
}

/// `shadow measure`.
#[derive(Debug, ClapArgs)]
pub(crate) struct MeasureArgs {
    /// What picture of which scene.
    #[command(flatten)]
    pub(crate) picture: PictureArgs,

    /// Its bias.
    #[command(flatten)]
    pub(crate) bias: BiasArgs,

    /// A settings file: a technique to measure; can be given several times [default: the technique that the options below say]
    ///
    /// `shadow settings` prints one. The name of a technique is the file's, unless the file has another.
    #[arg(
        long,
        value_name = "FILE",
        conflicts_with_all = [
            "preset", "map_size", "filter", "filter_radius", "store", "texels", "terminator", "bias", "bias_constant", "bias_scale", "bias_normal", "bias_limit", "bias_gradient",
            "bias_offset", "bias_push", "fit", "fit_from", "plane", "split", "cascades", "splits", "lambda", "padding", "cascade_blend", "cascade_select", "stabilise", "cascade_sizes", "cascade_fits",
            "lispsm_factors", "pancake", "shadow_distance"
        ],
        help_heading = "Shadows"
    )]
    pub(crate) settings: Vec<PathBuf>,

    /// The backend, and how the tracer samples.
    #[command(flatten)]
    pub(crate) rendering: RenderingArgs,

    /// Adapter and threads.
    #[command(flatten)]
    pub(crate) machine: MachineArgs,

    /// Frames of each technique that are timed, from 1 to 10000
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(crate) frames: u32,

    /// A folder for a page to read: index.html, with pictures, heat maps and error against cost
    ///
    /// The page holds everything it shows, so that it can be moved and sent. The folder is made if it is not there.
    #[arg(long, value_name = "FOLDER", help_heading = "Picture")]
    pub(crate) report: Option<PathBuf>,

    /// Report as JSON on standard output
    ///
    /// An object with `scene`, `notes`, `triangles`, `width`, `height`, `backend`, `adapter` (null for the CPU), `light_samples` (null where no light has a size), `report` (null without one) and
    /// `techniques`. Each of these has its `settings` (as a settings file has them, with the `name`; those of the first light), `pixels` (judged: those that show something a light can reach, once for
    /// each light), `wrong`, `causes` (pixels by cause), `at_terminator` (pixels whose two normals disagree about facing the light, wrong or not), `rmse`,
    /// `milliseconds` (medians: `shadow_maps`, `camera`, `shading`, `total`), `map_bytes`, `stability` (`move`, `turn`, `zoom`, `light`: shares that change for no
    /// reason; `other_maps`: the share that asks other maps after a move or turn, and is not counted), `aliasing` (`pixels` that are counted and `grazing` ones that are not, `median`, `percentile_95`, `max` and `share_above_one` of m, which are null if none is counted, and `waste`, the share of texels that nobody sees)
    /// and `lights` (for each its `name`, `settings`, `pixels`, `wrong`, `causes`, `at_terminator`, `rmse` and `aliasing`).
    #[arg(long)]
    pub(crate) json: bool,
}

/// `shadow tune`.
#[derive(Debug, ClapArgs)]
pub(crate) struct TuneArgs {
    /// What picture of which scene.
    #[command(flatten)]
    pub(crate) picture: PictureArgs,

    /// The file to write: a page to read, whose name ends in .html, or the report of --json, in .json
    ///
    /// The page holds everything it shows, so that it can be moved and sent. A file that is already there is replaced once the new one is
    /// complete.
    #[arg(short, long, value_name = "FILE", default_value = "certificate.html", help_heading = "Picture")]
    pub(crate) output: PathBuf,

    /// What renders
    #[arg(long, value_enum, value_name = "BACKEND", default_value_t = Backend::Cpu, help_heading = "Backend")]
    pub(crate) backend: Backend,

    /// Adapter and threads.
    #[command(flatten)]
    pub(crate) machine: MachineArgs,

    /// Report as JSON on standard output
    ///
    /// An object with `scene`, `notes`, `triangles`, `width`, `height`, `backend`, `adapter` (null for the CPU), `map_size`, `filter`, `holds` (whether there is no
    /// acne), `output` and `lights`. Each light has its `name`, `kind`, `maps`, the `acne` of the frame that was rendered, `by_slivers` (pixels shadowed by texels that slivers were drawn into wrongly), `at_terminator` (pixels whose two normals disagree about facing the light), the medians of the
    /// `needed` gap by its parts (`filter`, `snap`, `rounding`, in metres), `onset` (the shares of the automatic bias between which acne begins, `with_acne` and `without`; null where
    /// there is none without any bias, or some with all of it), and its `rules` and `curves` (`automatic`, `constant`), lists of biases that were tried. Each of these has its
    /// `name`, `what` and `casts_back_faces` (of an engine's), `amount` (a share, or the metres of a constant), `acne`, `peter_panning`, `leak`, `gap` and `shift` (`pixels`, `median`,
    /// `percentile_95` and `max`, in metres; null where nothing is shadowed any more), `wider` and `shifted` (pixels where they exceed those of the automatic bias) and
    /// `fails` (any of `acne`, `light`, `gap` and `shift`).
    #[arg(long)]
    pub(crate) json: bool,
}

/// `shadow devices`.
#[derive(Debug, Default, ClapArgs)]
pub(crate) struct DevicesArgs {
    /// Report as JSON on standard output: a list `devices`
    #[arg(long)]
    pub(crate) json: bool,
}

/// `shadow completions`.
#[derive(Debug, ClapArgs)]
pub(crate) struct CompletionsArgs {
    /// The shell
    #[arg(value_enum, value_name = "SHELL")]
    pub(crate) shell: Shell,
}

/// `shadow man`.
#[derive(Debug, ClapArgs)]
pub(crate) struct ManArgs {
    /// The command whose page is printed; without one it is the program's
    #[arg(value_name = "COMMAND", value_parser = PossibleValuesParser::new(COMMANDS))]
    pub(crate) command: Option<String>,
}

/// A renderer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Backend {
    /// The processor's cores
    Cpu,
    /// A graphics adapter: Vulkan, Metal or Direct3D 12
    Gpu,
    /// The ray tracer: no shadow maps, but what the shadows should be
    Trace,
}

impl Backend {
    /// The name on the command line and in reports.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Cpu => "cpu",
            Self::Gpu => "gpu",
            Self::Trace => "trace",
        }
    }
}

#[cfg(test)]
mod tests {
    use shadow_math::Filter;

    use super::*;
    use crate::bias::BiasNames;

    fn parse(line: &str) -> Result<Args, clap::Error> {
        Args::try_parse_from(line.split_whitespace())
    }

    #[test]
    fn the_definition_is_consistent() {
        use clap::CommandFactory;
        Args::command().debug_assert();
        let commands: Vec<_> = Args::command().get_subcommands().map(|command| command.get_name().to_string()).collect();
        assert_eq!(commands, COMMANDS);
    }

    #[test]
    fn nothing_is_render_with_its_defaults() {
        let Command::Render(args) = parse("shadow").unwrap().into_command().unwrap() else { panic!("not render") };
        assert_eq!(args.picture.scene.source, None);
        assert_eq!(args.output, PathBuf::from("shadow.png"));
        assert_eq!((args.rendering.backend, args.show), (Backend::Cpu, Show::Color));
        assert_eq!(
            (args.picture.shadows.filter, args.bias.bias.clone(), args.picture.shadows.map_size),
            (FilterName(Filter::Bilinear), BiasNames::default(), 2048)
        );
    }

    #[test]
    fn a_scene_without_a_command_is_told_the_command() {
        let hint = |line: &str| with_hint(parse(line).unwrap_err()).to_string();
        assert!(hint("shadow house.glb").contains("shadow render house.glb"));
        assert!(!hint("shadow draw").contains("shadow render"));
        assert!(!hint("shadow measure --settings a --bias none").contains("settings --preset"));
        assert!(!hint("shadow --fast").contains("shadow render"));
    }

    #[test]
    fn negative_numbers_are_values_and_not_options() {
        let Some(Command::Plan(args)) = parse("shadow plan --exposure -2.5").unwrap().command else { panic!("not plan") };
        assert_eq!(args.picture.exposure, Some(-2.5));
        assert!(parse("shadow plan --light directional:dir=-1,-2,-3;lux=1 --camera eye=-1,-1,-1;target=0,0,0").is_ok());
    }

    #[test]
    fn values_out_of_range_are_refused_with_the_range() {
        for (line, expected) in [
            ("shadow render --map-size 8", "from 16 to 16384"),
            ("shadow render --threads 1025", "0..=1024"),
            ("shadow render --size 0x5", "1 to 16384"),
            ("shadow render --size 20000x5", "20000 pixels are more than the limit of 16384"),
            ("shadow render --bias-constant 1cm", "the bias is in metres, here 0.01"),
            ("shadow render --exposure 12ev", "here 12"),
            ("shadow render --time 250ms", "the time is in seconds, here 0.25"),
            ("shadow render --camera eye=1,2,3;target=0,0,0;fov=50deg", "fov is in degrees, here 50"),
            ("shadow render --memory-limit 6G", "6GiB"),
            ("shadow compare --backends cpu,cpu", "comparing a backend with itself proves nothing"),
            ("shadow bench --frames 0", "1..=10000"),
            ("shadow bench --backends cpu,cpu", "at most once"),
            ("shadow compare --backends cpu,trace", "shadow measure"),
            ("shadow render --backend trace --light-samples 60", "49 or 64"),
            ("shadow render --backend trace --light-samples 0", "from 1 to 4096"),
            ("shadow render --filter soft", "bilinear"),
            ("shadow render --bias automatic+slope", "by itself"),
            ("shadow render --bias receiver-gradient --bias-gradient 1,2", "commas"),
        ] {
            let error = parse(line).unwrap_err();
            assert_eq!(error.exit_code(), 2, "{line}");
            assert!(error.to_string().contains(expected), "{line}: {error}");
        }
    }
}
