//! Why the program cannot do what was asked for, and how that is said.

use std::{error::Error, io, path::PathBuf};

use shadow_cpu::{CpuError, measure::JudgeError};
use shadow_gpu::GpuError;
use shadow_math::{CameraError, LightError};
use shadow_scene::{FramePlanError, ImportError, LayerName, compare::CompareError};

use crate::{
    memory::Limit,
    settings_file::SettingsError,
    specs::{Selector, bytes_text},
};

/// Why the program cannot do what was asked for. Each message names the value, the limit and the way out.
#[derive(Debug, thiserror::Error)]
pub(crate) enum CliError {
    /// The options make no sense together.
    #[error(transparent)]
    Usage(#[from] clap::Error),
    /// The scene's file.
    #[error(transparent)]
    Import(#[from] ImportError),
    /// The program that was to send the same rays did not.
    #[error("--rival {}: {problem}; it is started as `PROGRAM THREADS ROUNDS` and reads the rays from its standard input (tests/embree/rays.cpp is one, for Embree 3)", program.display())]
    Rival {
        /// The program.
        program: PathBuf,
        /// What went wrong.
        problem: String,
    },
    /// A colour without shadows that it could be the colour of.
    #[error(
        "--shadow-color has no meaning with additive composition, which leaves shadows to ambient light; use --composition modulative, or leave it out"
    )]
    ShadowColor,
    /// Settings of single lights, where techniques are compared.
    #[error(
        "--light-settings has no meaning here, where whole techniques are tried on all lights; leave it out, or use it with render, compare, bench or plan"
    )]
    LightSettings,
    /// Rules that are stated for z / w, on maps of something else.
    #[error(
        "--store {0} has no meaning with tune: what engines do is tried on maps of depth32, for which their rules are stated; leave it out (shadow measure judges every store)"
    )]
    TuneStore(&'static str),
    /// A view of a light's maps, of a light without any.
    #[error("light {light} casts no shadows and has no maps to show; choose another light, or leave --no-shadow out")]
    LightWithoutMaps {
        /// The light as it was asked for.
        light: Selector,
    },
    /// A picture that is no layer, as numbers.
    #[error("`{0}` is a picture and has no numbers that EXR could hold; write it to a .png file")]
    DebugViewAsNumbers(String),
    /// A view of shadow maps, where rays are sent.
    #[error("`{0}` is made of shadow maps, which --backend trace has none of; use --backend cpu or gpu")]
    DebugViewOfTrace(String),
    /// The picture that a light is to project cannot be read.
    #[error("cannot read the picture {}, which a light is to project (PNG, JPEG and EXR are known)", path.display())]
    ReadPicture {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: image::ImageError,
    },
    /// Rules that are stated for lookups where texels are.
    #[error(
        "--texels direct3d has no meaning with tune: what engines do is tried where texels are; leave it out (shadow measure shows what mixed conventions cost)"
    )]
    TuneTexels,
    /// Nothing to compare another tracer with.
    #[error("--rival is sent the rays of our tracer, which is not among the backends; add trace to --backends")]
    RivalWithoutTracer,
    /// There is no built-in scene of that name.
    #[error("there is no built-in scene `{name}`; there are: {}", names.join(", "))]
    Builtin {
        /// The name that was asked for.
        name: String,
        /// The names that there are.
        names: &'static [&'static str],
    },
    /// There is no light, view or camera of that number or name.
    #[error("there is no {kind} {asked}; {}", crate::specs::inventory(kind, names))]
    NoSuch {
        /// "light", "view" or "camera".
        kind: &'static str,
        /// The number or the quoted name that was asked for.
        asked: String,
        /// The names that there are, in order.
        names: Vec<String>,
    },
    /// A light of the command line cannot be used.
    #[error("--light `{spec}`")]
    Light {
        /// What was typed.
        spec: String,
        /// What is wrong with it.
        source: LightError,
    },
    /// A camera of the command line cannot be used.
    #[error("--camera `{spec}`")]
    Camera {
        /// What was typed.
        spec: String,
        /// What is wrong with it.
        source: CameraError,
    },
    /// A length for a bias that is none.
    #[error("--{key} has no meaning with --bias {bias}; use it with --bias {}, or leave it out", use_with.join(" or --bias "))]
    BiasNumber {
        /// The option, without its hyphens.
        key: &'static str,
        /// The bias that was chosen.
        bias: String,
        /// The biases that it goes with.
        use_with: &'static [&'static str],
    },
    /// A number without a meaning beside the other choices of the light's cameras.
    #[error("--{key} has no meaning here; use it with --{}, or leave it out", use_with.join(" or --"))]
    CameraNumber {
        /// The option, without its hyphens.
        key: &'static str,
        /// The options that it goes with.
        use_with: &'static [&'static str],
    },
    /// A choice of the light's cameras that is none.
    #[error("--{key}: {problem}")]
    CameraValue {
        /// The option, without its hyphens.
        key: &'static str,
        /// What stands there, and what could.
        problem: String,
    },
    /// An adapter for a renderer that has none.
    #[error(
        "--adapter `{0}` chooses a graphics adapter, but the gpu backend is not used; name gpu in --backend or --backends, or leave it out"
    )]
    AdapterOfCpu(String),
    /// Samples of lights for a renderer that takes none.
    #[error(
        "--light-samples is for the trace backend; shadow maps see a light's centre alone; name trace in --backend, or leave it out"
    )]
    LightSamplesOfMaps,
    /// A shadow map of the tracer.
    #[error("the trace backend has no shadow maps; take --backend cpu or gpu to look at one")]
    MapOfTrace,
    /// The plan.
    #[error(transparent)]
    Plan(#[from] FramePlanError),
    /// A choice among what is in a file, for a scene that came from none.
    #[error(
        "{option} chooses among what is in a file, but `builtin:{name}` is built in; name a .gltf or .glb file, or leave {option} out"
    )]
    NotAFile {
        /// The option.
        option: &'static str,
        /// The name of the built-in scene.
        name: String,
    },
    /// Reading a file would take too much memory.
    #[error("{0}; the limit is set by --memory-limit, such as --memory-limit 6GiB")]
    ImportMemory(ImportError),
    /// The scene, the maps and the frames would take too much memory.
    #[error(
        "{scene} would take about {} of memory, more than the limit of {limit}: {parts}; {way_out}, or allow more with --memory-limit",
        bytes_text(*needed)
    )]
    TooMuchMemory {
        /// What the scene is called.
        scene: String,
        /// How much it would take, in bytes.
        needed: u64,
        /// The limit.
        limit: Limit,
        /// What takes how much, the largest first.
        parts: String,
        /// What to do about the largest.
        way_out: &'static str,
    },
    /// The system does not have the memory.
    #[error("{scene} would take about {} of memory, which this system does not give: {parts}; {way_out}", bytes_text(*needed))]
    OutOfMemory {
        /// What the scene is called.
        scene: String,
        /// How much it would take, in bytes.
        needed: u64,
        /// What takes how much, the largest first.
        parts: String,
        /// What to do about the largest.
        way_out: &'static str,
    },
    /// A settings file cannot be read.
    #[error("cannot read the settings `{}`", path.display())]
    ReadSettings {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A settings file is wrong.
    #[error("`{}`", path.display())]
    Settings {
        /// The file.
        path: PathBuf,
        /// What is wrong, and where.
        source: SettingsError,
    },
    /// A technique cannot be planned for the scene.
    #[error("the settings `{name}`")]
    Technique {
        /// Its name.
        name: String,
        /// What is wrong.
        source: Box<CliError>,
    },
    /// A choice of a scene where none is read.
    #[error("{0} chooses a scene, which only --convert needs; add --convert FROM --to ENGINE, or leave it out")]
    SceneOfSettings(&'static str),
    /// A light without a map.
    #[error(
        "the light `{0}` has no shadow map, since nothing casts a shadow in it; choose another with --of-light, or a scene with objects"
    )]
    NoMap(String),
    /// A place that the light does not reach.
    #[error("--at {at} is not before the light; its depth goes from {near} m (not included) to {far} m")]
    At {
        /// The distance that was asked for, in metres.
        at: f32,
        /// The near plane's, in metres.
        near: f32,
        /// The far plane's, in metres.
        far: f32,
    },
    /// An angle at which a surface does not face the light.
    #[error("--angle {0} is not that of a surface which faces the light; choose from 0 to below 90 degrees")]
    Angle(f32),
    /// A bias that is no length.
    #[error("--convert {0}; take a smaller number, or another --at")]
    Conversion(String),
    /// Two techniques of the same name.
    #[error("two settings are called `{0}`; give one of them another name")]
    TechniqueName(String),
    /// The tracer has nothing to measure.
    #[error("the trace backend is the truth that others are measured by; take --backend cpu or gpu")]
    MeasureTrace,
    /// Rays have no filters.
    #[error("the trace backend has no shadow maps whose filters could be timed; take --backends cpu, gpu or cpu,gpu")]
    FiltersOfTrace,
    /// A frame cannot be judged: a defect of the renderer.
    #[error("the frame cannot be judged; this is a defect, please report it")]
    Judge(#[from] JudgeError),
    /// The CPU renderer.
    #[error(transparent)]
    Cpu(#[from] CpuError),
    /// The GPU renderer.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// A layer that was asked for is not in the frame, or not of the kind it should be: a defect of the renderer.
    #[error("the {backend} backend did not give back the layer {layer}; this is a defect, please report it")]
    Layer {
        /// The renderer.
        backend: &'static str,
        /// The layer.
        layer: LayerName,
    },
    /// The two frames cannot be compared.
    #[error("the two pictures cannot be compared")]
    Compare(#[from] CompareError),
    /// The output's name does not end in a format that can be written.
    #[error("cannot write `{}`: {}; choose a name that ends in .png (a picture) or .exr (the numbers)", path.display(), format_problem(path))]
    Format {
        /// The file.
        path: PathBuf,
    },
    /// A certificate's name does not end in a format that it can have.
    #[error("cannot write `{}`: a certificate is a page, whose name ends in .html, or numbers, in .json; choose one of these", path.display())]
    CertificateFormat {
        /// The file.
        path: PathBuf,
    },
    /// A map that was not made, since nothing is seen in it.
    #[error(
        "view {view} of light `{light}` has no map: the camera sees nothing in it that could be shadowed; `shadow plan` lists those that have one"
    )]
    ViewOfNothing {
        /// The light.
        light: Selector,
        /// The view's number.
        view: usize,
    },
    /// The picture of a warped view.
    #[error(
        "the maps of light `{light}` are warped, and no camera takes such a picture; look at --show shadow-map, or take the fit focused, which covers the same"
    )]
    WarpedLightView {
        /// The light.
        light: Selector,
    },
    /// A drawing whose name ends in something else than .svg.
    #[error("cannot write `{}`: the drawing is SVG; choose a name that ends in .svg", path.display())]
    DrawingName {
        /// The path.
        path: PathBuf,
    },
    /// The name of a report for programs does not end in its format.
    #[error("cannot write `{}`: the report is JSON; choose a name that ends in .json", path.display())]
    ReportFormat {
        /// The file.
        path: PathBuf,
    },
    /// The output cannot be written.
    #[error("cannot write `{}`", path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// Standard output is closed or cannot be written to.
    #[error("cannot write to standard output")]
    Stdout(#[source] io::Error),
}

impl CliError {
    /// Whether the reader of standard output went away, as `head` does: that is no failure.
    pub(crate) fn is_broken_pipe(&self) -> bool {
        matches!(self, Self::Stdout(source) if source.kind() == io::ErrorKind::BrokenPipe)
    }
}

/// What is wrong with the name of a picture.
fn format_problem(path: &std::path::Path) -> String {
    match path.extension() {
        Some(extension) => format!("the formats are PNG and OpenEXR, not .{}", extension.to_string_lossy()),
        None => "its name has no ending that says the format".into(),
    }
}

/// The error and its sources in one line. A source that its parent's message already contains is not repeated.
pub(crate) fn chain(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut next = error.source();
    while let Some(source) = next {
        let message = source.to_string();
        if !text.contains(&message) {
            text.push_str(": ");
            text.push_str(&message);
        }
        next = source.source();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_are_told_once() {
        let light = CliError::Light { spec: "point:…".into(), source: LightError::Range(-1.0) };
        let text = chain(&light);
        assert!(text.starts_with("--light `point:…`: the light's range is -1 m"), "{text}");
        assert_eq!(text.matches("-1 m").count(), 1);
        let read = ImportError::Read { file: "a.glb".into(), source: io::Error::from(io::ErrorKind::NotFound) };
        let text = chain(&CliError::Import(read));
        assert_eq!(text.matches("not found").count(), 1, "{text}");
    }

    #[test]
    fn only_a_closed_pipe_is_a_broken_pipe() {
        assert!(CliError::Stdout(io::ErrorKind::BrokenPipe.into()).is_broken_pipe());
        assert!(!CliError::Stdout(io::ErrorKind::StorageFull.into()).is_broken_pipe());
        assert!(!CliError::Write { path: "a".into(), source: io::ErrorKind::BrokenPipe.into() }.is_broken_pipe());
    }

    #[test]
    fn a_wrong_ending_is_named() {
        let text = CliError::Format { path: "a/b.jpg".into() }.to_string();
        for part in ["a/b.jpg", "not .jpg;", ".png", ".exr"] {
            assert!(text.contains(part), "`{part}` in {text}");
        }
        assert!(CliError::Format { path: "picture".into() }.to_string().contains("no ending"));
    }
}
