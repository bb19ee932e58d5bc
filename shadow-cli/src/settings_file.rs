//! Settings files: how lights are shadowed, in TOML.
//!
//! Every key may be left out, and is then as [`ShadowSettings::default`] has it. What is wrong is refused with its line, what stands there and
//! what could.

use std::{fs, ops::Range, path::Path};

use serde::{Deserialize, Serialize};
use serde_json::Value;
use shadow_math::{
    Filter, Fit, FitFrom, Selection, ShadowSettings, Store, Terminator, Texels,
    plan::check_settings,
    settings::{FilterRadii, MAX_MAP_SIZE, MAX_NORMAL_TEXELS, MIN_MAP_SIZE},
};
use toml::Spanned;

use crate::{
    bias::{BiasNames, BiasNumbers, Meaningless, summary},
    error::CliError,
    light_camera::{self, LightCameraArgs, LightCameraError, SplitsSpec},
};

/// The default settings with comments, as `shadow settings` prints them.
pub(crate) const DEFAULT_TEXT: &str = r#"# How lights are shadowed. Every key may be left out; these are the defaults.
# To measure it against the truth: shadow measure SCENE --settings THIS_FILE

# What reports call it; left out, it is the file's name.
# name = "default"

# Where the samples of a map go: "uniform" (over all that the light reaches), "focused" (what the camera sees and something can shadow), "lispsm" (the same, with more samples near the camera),
# "plane-optimal" (a texel for each pixel of a plane), "ogre-uniform" (what OGRE covers by itself) or "ogre-lispsm" (with OGRE's own warp).
fit = "uniform"

# What fits follow: "frustum" (all that the camera could see) or "samples" (what its pixels show).
# fit-from = "frustum"

# The plane of "plane-optimal", normal and offset, in the coordinates of the file; left out, it is the one that most pixels show.
# plane = [0.0, 1.0, 0.0, 0.0]

# How many maps share the view: "single" (as few as can cover the light), "cube" (six around a spot or point light) or "cascades" (one for each range of distances from the camera).
split = "single"

# With "cascades": how many, from 1 to 8.
# cascades = 4

# Where cascades end: "uniform", "logarithmic", "practical", "histogram" (as many samples in each), or a list of distances in metres, one fewer than cascades.
# splits = "practical"

# The share of logarithmic in "practical", from 0 to 1.
# lambda = 0.8

# By how many metres each cascade reaches beyond its ends.
# padding = 0.0

# The share of each cascade, before its end, that is blended with the next one.
# cascade-blend = 0.0

# How points choose a cascade: by "depth" or by "containment".
# cascade-select = "depth"

# Whether the texels of cascades stand still while the camera moves and turns: with "uniform", for directional lights, and with maps of a power of two.
# stabilise = false

# Map sizes, fits and factors on the best warp of each cascade; the last of a list goes on.
# cascade-sizes = [2048, 1024, 512]
# cascade-fits = ["lispsm", "focused"]
# lispsm-factors = [1.0]

# Whether the depth of maps is for what is seen alone, and casters beyond are drawn onto its near and far planes: not for "second" and "midpoint".
# pancake = false

# How far from the camera there are shadows, in metres; left out, as far as anything is seen.
# shadow-distance = 100.0

# What a texel remembers: "depth32", "depth24" or "depth16" (the nearest caster's depth, as a float or rounded to so many bits), "reversed32" (1 minus that), "linear" (the distance along
# the light's axis), "second" (the second surface's depth) or "midpoint" (half-way between the first and the second).
store = "depth32"

# Where lookups think that texel centres are: "opengl" (half-way between whole numbers, as maps are drawn) or "direct3d" (at whole numbers, as before version 10).
texels = "opengl"

# How depth tests are averaged: "hard" (one test), "bilinear" (four), "cross5", "box3" to "box9", "gaussian", "witness3", "witness5", "witness7", "poisson", "vogel"
# or "footprint"; `shadow help render` says what each is.
filter = "bilinear"

# How far "gaussian" (from 1 to 4), "poisson" or "vogel" (from 0.5 to 16) reach, in texels.
# filter-radius = 2.5

# How surfaces are kept from shadowing themselves:
#   "automatic"          what the receiver's plane needs under the filter, by depth or along its normal: nothing to tune
#   "none"               not at all
# or some of these parts, joined by plus signs, which add up:
#   "constant"           bias-constant everywhere
#   "slope"              what the plane needs by depth alone, times bias-scale, plus bias-constant
#   "normal-offset"      a step of bias-normal along the normal
#   "receiver-plane"     each tap is compared with the plane's depth there, corrected by at most bias-limit; not with "slope"
#   "receiver-gradient"  what OGRE 1.12's sample reads off the map
#   "back-faces"         of single-sided casters the map has the back faces alone
# or draw casters deeper; one of:
#   "polygon-offset"       as hardware does it: bias-offset
#   "ogre-2006"            as the shader of "Shadow Mapping in Ogre" does it, pushed by bias-push
#   "ogre-2006-corrected"  as its text asks for
bias = "automatic"

# Metres along the light's view axis, with "constant" (0.01 if left out) or "slope" (0 if left out).
# bias-constant = 0.01

# A factor on what the plane needs, with "slope": 1 is enough and no more.
# bias-scale = 1.0

# Texels times the sine of the angle between normal and light, with "normal-offset", from 0 to 8.
# bias-normal = 1.0

# Metres, with "receiver-plane".
# bias-limit = 0.1

# The share of the stored depth, the clamp on differences and their scale, with "receiver-gradient".
# bias-gradient = [0.0005, 0.0098, 0.0]

# A factor on the larger slope, units of the format's steps, and a clamp in depth (0 for none), with "polygon-offset".
# bias-offset = [2.0, 4.0, 0.0]

# Metres, with "ogre-2006" or "ogre-2006-corrected".
# bias-push = 1.0

# What becomes of light where the facets of smooth meshes turn away from it: "hard" (it ends) or "soft" (it fades out).
terminator = "hard"

# Width and height of each map in texels, from 16 to 16384.
map-size = 2048
"#;

/// How one technique shadows lights, and what it is called.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NamedSettings {
    /// The name in reports.
    pub(crate) name: String,
    /// The settings.
    pub(crate) settings: ShadowSettings,
}

/// A settings file as it is written.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default, rename_all = "kebab-case")]
struct File {
    name: Option<String>,
    fit: Option<Fit>,
    fit_from: Option<FitFrom>,
    plane: Option<[f32; 4]>,
    split: Option<String>,
    cascades: Option<u32>,
    splits: Option<SplitsSpec>,
    lambda: Option<f32>,
    padding: Option<f32>,
    cascade_blend: Option<f32>,
    cascade_select: Option<Selection>,
    stabilise: bool,
    cascade_sizes: Option<Vec<u32>>,
    cascade_fits: Option<Vec<Fit>>,
    lispsm_factors: Option<Vec<f32>>,
    pancake: bool,
    shadow_distance: Option<f32>,
    store: Store,
    texels: Texels,
    filter: Filter,
    filter_radius: Option<Spanned<f32>>,
    bias: Option<Spanned<String>>,
    bias_constant: Option<Spanned<f32>>,
    bias_scale: Option<Spanned<f32>>,
    bias_normal: Option<Spanned<f32>>,
    bias_limit: Option<Spanned<f32>>,
    bias_gradient: Option<Spanned<[f32; 3]>>,
    bias_offset: Option<Spanned<[f32; 3]>>,
    bias_push: Option<Spanned<f32>>,
    terminator: Terminator,
    map_size: Option<Spanned<u32>>,
}

/// What is wrong with a settings file, and where.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {problem}")]
pub(crate) struct SettingsError {
    /// The line, from 1.
    line: usize,
    /// What stands there, and what could.
    problem: String,
}

/// Reads a settings file.
pub(crate) fn read(path: &Path) -> Result<NamedSettings, CliError> {
    let text = fs::read_to_string(path).map_err(|source| CliError::ReadSettings { path: path.into(), source })?;
    let settings = parse(&text).map_err(|source| CliError::Settings { path: path.into(), source })?;
    let stem = path.file_stem().map_or_else(|| path.display().to_string(), |stem| stem.to_string_lossy().into_owned());
    Ok(NamedSettings { name: settings.0.unwrap_or(stem), settings: settings.1 })
}

/// The name, if there is one, and the settings of a text.
pub(crate) fn parse(text: &str) -> Result<(Option<String>, ShadowSettings), SettingsError> {
    let at = |span: Option<Range<usize>>, problem: String| {
        let start = span.map_or(0, |span| span.start.min(text.len()));
        // A span lies on characters' borders; were it not so, the line would be that of the whole text.
        let line = text.get(..start).map_or(1, |before| before.matches('\n').count() + 1);
        SettingsError { line, problem }
    };
    let file: File = toml::from_str(text).map_err(|error| at(error.span(), error.message().trim().replace('\n', ", ")))?;
    let names = match &file.bias {
        None => BiasNames::default(),
        Some(bias) => bias.get_ref().parse().map_err(|problem| at(Some(bias.span()), problem))?,
    };
    let number = |key: &str, number: &Option<Spanned<f32>>, is_sound: fn(f32) -> bool, what: &str| match number {
        Some(number) if !is_sound(*number.get_ref()) => {
            Err(at(Some(number.span()), format!("{key} = {} makes no sense; it is {what}", number.get_ref())))
        }
        number => Ok(number.as_ref().map(|number| *number.get_ref())),
    };
    let is_length = |metres: f32| metres.is_finite() && metres >= 0.0;
    let gradient = file.bias_gradient.as_ref();
    if let Some(gradient) = gradient.filter(|gradient| !gradient.get_ref().iter().all(|&number| is_length(number))) {
        return Err(at(Some(gradient.span()), "bias-gradient makes no sense; its numbers are finite and at least 0".into()));
    }
    let offset = file.bias_offset.as_ref();
    if let Some(offset) = offset.filter(|offset| !offset.get_ref().iter().all(|&number| is_length(number))) {
        return Err(at(Some(offset.span()), "bias-offset makes no sense; its numbers are finite and at least 0".into()));
    }
    let numbers = BiasNumbers {
        constant: number("bias-constant", &file.bias_constant, is_length, "a length in metres, finite and at least 0")?,
        scale: number("bias-scale", &file.bias_scale, is_length, "finite and at least 0")?,
        normal: number(
            "bias-normal",
            &file.bias_normal,
            |texels| (0.0..=MAX_NORMAL_TEXELS).contains(&texels),
            "a number of texels from 0 to 8",
        )?,
        limit: number(
            "bias-limit",
            &file.bias_limit,
            |metres| metres.is_finite() && metres > 0.0,
            "a length in metres, finite and above 0",
        )?,
        gradient: gradient.map(|gradient| *gradient.get_ref()),
        offset: file.bias_offset.as_ref().map(|offset| *offset.get_ref()),
        push: number("bias-push", &file.bias_push, is_length, "a length in metres, finite and at least 0")?,
    };
    let bias = names.with(&numbers).map_err(|Meaningless { key, use_with }| {
        let spans = [
            ("bias-constant", file.bias_constant.as_ref().map(Spanned::span)),
            ("bias-scale", file.bias_scale.as_ref().map(Spanned::span)),
            ("bias-normal", file.bias_normal.as_ref().map(Spanned::span)),
            ("bias-limit", file.bias_limit.as_ref().map(Spanned::span)),
            ("bias-gradient", gradient.map(Spanned::span)),
            ("bias-offset", offset.map(Spanned::span)),
            ("bias-push", file.bias_push.as_ref().map(Spanned::span)),
        ];
        let span = spans.into_iter().find(|(name, _)| *name == key).and_then(|(_, span)| span);
        let use_with: Vec<_> = use_with.iter().map(|name| format!("\"{name}\"")).collect();
        let use_with = use_with.join(" or ");
        at(span, format!("{key} has no meaning with bias = \"{names}\"; use it with {use_with}, or leave it out"))
    })?;
    let map_size = match &file.map_size {
        None => ShadowSettings::default().map_size,
        Some(size) if (MIN_MAP_SIZE..=MAX_MAP_SIZE).contains(size.get_ref()) => *size.get_ref(),
        Some(size) => {
            let problem =
                format!("map-size = {} is out of range; choose from {MIN_MAP_SIZE} to {MAX_MAP_SIZE} texels", size.get_ref());
            return Err(at(Some(size.span()), problem));
        }
    };
    let cameras = LightCameraArgs {
        fit: file.fit,
        fit_from: file.fit_from,
        plane: file.plane,
        split: file.split,
        cascades: file.cascades,
        splits: file.splits,
        lambda: file.lambda,
        padding: file.padding,
        cascade_blend: file.cascade_blend,
        cascade_select: file.cascade_select,
        stabilise: file.stabilise,
        cascade_sizes: file.cascade_sizes,
        cascade_fits: file.cascade_fits,
        lispsm_factors: file.lispsm_factors,
        pancake: file.pancake,
        shadow_distance: file.shadow_distance,
    };
    let File { name, store, texels, filter, terminator, .. } = file;
    if let Some(radius) = &file.filter_radius {
        let problem = match filter.radii() {
            None => Some(format!(
                "filter-radius has no meaning with filter = \"{}\"; use it with \"gaussian\", \"poisson\" or \"vogel\", or leave it out",
                filter.name()
            )),
            Some(FilterRadii { least, most, .. }) if !(*radius.get_ref() >= least && *radius.get_ref() <= most) => {
                Some(format!("filter-radius = {} is out of range; choose from {least} to {most} texels", radius.get_ref()))
            }
            Some(_) => None,
        };
        if let Some(problem) = problem {
            return Err(at(Some(radius.span()), problem));
        }
    }
    let filter_radius = file.filter_radius.map(Spanned::into_inner);
    let settings =
        ShadowSettings { store, texels, bias, filter, filter_radius, terminator, map_size, ..ShadowSettings::default() };
    let settings = cameras.of(settings).map_err(|error| {
        let (key, problem) = match error {
            LightCameraError::Meaningless(Meaningless { key, use_with }) => {
                let use_with: Vec<String> = use_with.iter().map(|said| said.replacen(' ', " = \"", 1) + "\"").collect();
                (key, format!("{key} has no meaning here; use it with {}, or leave it out", use_with.join(" or ")))
            }
            LightCameraError::Value { key, problem } => (key, format!("{key}: {problem}")),
        };
        SettingsError { line: line_of(text, key), problem }
    })?;
    check_settings(&settings).map_err(|error| {
        let key = light_camera::key_of(&error);
        SettingsError { line: line_of(text, key), problem: error.to_string() }
    })?;
    Ok((name, settings))
}

/// The line of a text, from 1, on which a key stands; the first where it stands nowhere.
fn line_of(text: &str, key: &str) -> usize {
    let is_key = |line: &str| line.trim_start().strip_prefix(key).is_some_and(|rest| rest.trim_start().starts_with('='));
    text.lines().position(is_key).map_or(1, |line| line + 1)
}

/// Settings as a settings file would have them, for reports.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) struct SettingsReport {
    name: String,
    #[serde(flatten)]
    cameras: LightCameraArgs,
    store: Store,
    texels: Texels,
    filter: Filter,
    #[serde(skip_serializing_if = "Option::is_none")]
    filter_radius: Option<f32>,
    bias: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    bias_constant: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    bias_scale: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    bias_normal: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    bias_limit: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    bias_gradient: Option<[f32; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    bias_offset: Option<[f32; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    bias_push: Option<f32>,
    terminator: Terminator,
    map_size: u32,
    /// The bias in a line.
    #[serde(skip)]
    bias_summary: String,
    /// The light's cameras in a few words.
    #[serde(skip)]
    camera_summary: String,
}

impl SettingsReport {
    /// The settings of a technique that is called `name`.
    pub(crate) fn of(name: &str, settings: &ShadowSettings) -> Self {
        // The grid is a matter of the adapter, not of the technique.
        let ShadowSettings { store, texels, bias, filter, filter_radius, terminator, map_size, .. } = *settings;
        let filter_radius = filter.radii().map(|radii| filter_radius.unwrap_or(radii.default));
        let (names, BiasNumbers { constant, scale, normal, limit, gradient, offset, push }) = BiasNames::of(bias);
        Self {
            name: name.into(),
            cameras: LightCameraArgs::saying(settings),
            camera_summary: light_camera::summary(settings),
            store,
            texels,
            filter,
            filter_radius,
            bias: names.to_string(),
            bias_constant: constant,
            bias_scale: scale,
            bias_normal: normal,
            bias_limit: limit,
            bias_gradient: gradient,
            bias_offset: offset,
            bias_push: push,
            terminator,
            map_size,
            bias_summary: summary(bias),
        }
    }

    /// The keys and values of a settings file, in its own notation.
    ///
    /// TOML writes these numbers, strings and lists as JSON does.
    fn entries(&self) -> Vec<(String, Value)> {
        match serde_json::to_string(self).ok().and_then(|text| serde_json::from_str(&text).ok()) {
            Some(Value::Object(map)) => map.into_iter().collect(),
            _ => Vec::new(),
        }
    }

    /// A settings file that says them, with the comments of the default one under a head of its own.
    pub(crate) fn file(&self, head: &str) -> String {
        let entries = self.entries();
        let entry = |line: &str| {
            let key = line.trim_start_matches("# ").split_once(" = ")?.0;
            entries.iter().find(|(name, _)| name == key)
        };
        let lines = DEFAULT_TEXT.lines().skip_while(|line| !line.is_empty()).map(|line| match entry(line) {
            Some((key, value)) => format!("{key} = {value}\n"),
            None => format!("{line}\n"),
        });
        [head.to_string()].into_iter().chain(lines).collect()
    }

    /// The options of the command line that say them, but for those that are at their defaults.
    pub(crate) fn options(&self) -> String {
        let defaults = Self::of(&self.name, &ShadowSettings::default()).entries();
        let is_chosen = |entry: &&(String, Value)| !defaults.contains(entry);
        let option = |(key, value): &(String, Value)| match value {
            Value::String(text) => format!("--{key} {text}"),
            Value::Array(values) => {
                let text = |value: &Value| value.as_str().map_or_else(|| value.to_string(), String::from);
                format!("--{key} {}", values.iter().map(text).collect::<Vec<_>>().join(","))
            }
            Value::Bool(true) => format!("--{key}"),
            value => format!("--{key} {value}"),
        };
        self.entries().iter().filter(is_chosen).map(option).collect::<Vec<_>>().join(" ")
    }

    /// What the technique is called.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// What differs from the defaults least often: map size, filter and bias, for a line of a table.
    pub(crate) fn summary(&self) -> String {
        let radius = self.filter_radius.map_or_else(String::new, |radius| format!(" {radius}"));
        let store = if self.store == Store::default() { String::new() } else { format!(", {}", self.store.name()) };
        let texels = if self.texels == Texels::Direct3d { ", texels as in direct3d" } else { "" };
        let terminator = if self.terminator == Terminator::Soft { ", soft terminator" } else { "" };
        let cameras = &self.camera_summary;
        format!(
            "{} texels{cameras}, {}{radius}, {}{store}{texels}{terminator}",
            self.map_size,
            self.filter.name(),
            self.bias_summary
        )
    }
}

#[cfg(test)]
mod tests {
    use shadow_math::{Bias, Split, settings::BiasParts};

    use super::*;

    fn settings(text: &str) -> ShadowSettings {
        parse(text).expect(text).1
    }

    fn problem(text: &str) -> String {
        parse(text).expect_err(text).to_string()
    }

    #[test]
    fn the_printed_default_is_the_default() {
        assert_eq!(settings(DEFAULT_TEXT), ShadowSettings::default());
        assert_eq!(settings(""), ShadowSettings::default());
        // What is commented out can be taken in.
        let taken_in = DEFAULT_TEXT
            .replace("bias = \"automatic\"", "bias = \"slope+normal-offset+receiver-gradient+polygon-offset\"")
            .replace("# bias-limit = 0.1", "")
            .replace("# bias-push = 1.0", "")
            .replace("# bias-", "bias-")
            .replace("filter = \"bilinear\"", "filter = \"vogel\"")
            .replace("# filter-", "filter-")
            .replace("# name", "name");
        let (name, settings) = parse(&taken_in).expect("the comments are settings too");
        let receiver_gradient = Some(shadow_math::settings::ReceiverGradient::default());
        let (slope, constant, normal_offset) = (Some(1.0), Some(0.01), Some(1.0));
        let polygon_offset = Some(shadow_math::settings::PolygonOffset::default());
        let parts = BiasParts { slope, constant, normal_offset, receiver_gradient, polygon_offset, ..BiasParts::NONE };
        assert_eq!((name.as_deref(), settings.bias), (Some("default"), Bias::Parts(parts)));
    }

    #[test]
    fn every_choice_can_be_made() {
        assert_eq!(settings("filter = \"hard\"\nmap-size = 512").filter, Filter::Hard);
        assert_eq!(settings("bias = \"constant\"").bias, Bias::constant(0.01));
        assert_eq!(settings("bias = \"constant\"\nbias-constant = 0").bias, Bias::constant(0.0));
        let half = BiasParts { slope: Some(0.5), ..BiasParts::NONE };
        assert_eq!(settings("bias-scale = 0.5\nbias = \"slope\"").bias, Bias::Parts(half));
        assert_eq!(settings("split = \"cube\"").split, Split::Cube);
    }

    #[test]
    fn what_is_wrong_is_refused_with_its_line_its_value_and_the_choices() {
        for (text, line, parts) in [
            ("filter = \"hard\"\nsoftness = 3", 2, ["softness", "map-size"]),
            ("\n\nfilter = \"soft\"", 3, ["soft", "bilinear"]),
            ("filter = \"box3\"\nfilter-radius = 2", 2, ["box3", "\"vogel\""]),
            ("filter = \"gaussian\"\n\nfilter-radius = 5", 3, ["5 is out", "1 to 4"]),
            ("\nsplit = \"tiles\"", 2, ["tiles", "cascades"]),
            ("split = \"single\"\nlambda = 0.5", 2, ["lambda", "split = \"cascades\""]),
            ("split = \"cascades\"\nsplits = \"halves\"", 2, ["halves", "histogram"]),
            ("split = \"cascades\"\nsplits = [1.0, 2.0]", 2, ["2 distances", "there are 4"]),
            ("split = \"cascades\"\nsplits = \"uniform\"\nlambda = 1", 3, ["lambda", "splits = \"practical\""]),
            ("fit = \"focused\"\nplane = [0, 1, 0, 0]", 2, ["plane", "fit = \"plane-optimal\""]),
            ("fit = \"best\"", 1, ["best", "plane-optimal"]),
            ("split = \"cascades\"\nlambda = 3.0", 2, ["3", "between 0"]),
            ("split = \"cascades\"\n\npadding = -1.0", 3, ["-1 m", "at least 0"]),
            ("cascade-blend = 2.0\nsplit = \"cascades\"", 1, ["blend of 2", "from 0"]),
            ("split = \"cascades\"\ncascades = 9", 2, ["9 cascades", "1 to 8"]),
            ("split = \"cascades\"\nsplits = [5.0, 4.0, 6.0]", 2, ["4 m", "increasing"]),
            ("split = \"cascades\"\ncascade-sizes = [4096]", 2, ["4096", "2048"]),
            ("fit = \"lispsm\"\nsplit = \"cascades\"\nlispsm-factors = [-1.0]", 3, ["-1", "at least 0"]),
            ("split = \"cascades\"\nfit = \"focused\"\nstabilise = true", 3, ["focused", "uniform"]),
            ("split = \"cascades\"\nmap-size = 1000\nstabilise = true", 3, ["1000", "512 or 1024"]),
            ("fit = \"plane-optimal\"\nsplit = \"cascades\"", 2, ["plane-optimal", "one map"]),
            ("fit = \"plane-optimal\"\nplane = [0, 0, 0, 1]", 2, ["0,0,0,1", "no normal"]),
            ("shadow-distance = 0.0", 1, ["0 m", "above 0"]),
            ("fit = \"lispsm\"\nstore = \"linear\"", 2, ["linear", "lispsm"]),
            ("fit = \"lispsm\"\nbias = \"ogre-2006\"", 2, ["ogre-2006", "lispsm"]),
            ("store = \"midpoint\"\npancake = true", 2, ["midpoint", "near plane"]),
            ("bias = \"flat\"", 1, ["flat", "receiver-plane"]),
            ("\nbias = \"slope+receiver-plane\"", 2, ["slope", "leave one"]),
            ("bias = \"normal-offset\"\nbias-normal = 9", 2, ["9", "from 0 to 8"]),
            ("bias = \"receiver-plane\"\nbias-limit = 0", 2, ["0", "above 0"]),
            ("bias = \"receiver-gradient\"\nbias-gradient = [1, 2, -3]", 2, ["bias-gradient", "at least 0"]),
            ("map-size = 8", 1, ["map-size = 8", "16 to 16384"]),
            ("map-size = \"large\"", 1, ["large", "u32"]),
            ("bias = \"constant\"\nbias-constant = -1", 2, ["-1", "at least 0"]),
            ("bias = \"slope\"\n\nbias-scale = nan", 3, ["NaN", "finite"]),
            ("bias = \"polygon-offset\"\nbias-offset = [1, -2, 0]", 2, ["bias-offset", "at least 0"]),
            ("bias-push = 2", 1, ["bias-push", "\"ogre-2006\""]),
            ("store = \"depth8\"", 1, ["depth8", "depth16"]),
            ("bias-constant = 0.1", 1, ["bias = \"automatic\"", "\"constant\" or \"slope\""]),
            ("bias = \"none\"\nbias-constant = 0.1", 2, ["bias = \"none\"", "\"constant\""]),
            ("bias = \"constant\"\nbias-scale = 2.0", 2, ["bias = \"constant\"", "\"slope\""]),
            ("bias = \n", 1, ["", ""]),
            ("bias = \"slope\"\nbias = \"none\"", 2, ["duplicate", "key"]),
        ] {
            let found = problem(text);
            assert!(found.starts_with(&format!("line {line}: ")), "{text}: {found}");
            assert!(parts.iter().all(|part| found.contains(part)), "{text}: {found}");
        }
    }
}
