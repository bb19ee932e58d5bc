//! Settings files: how lights are shadowed, in TOML.
//!
//! Every key may be left out, and is then as [`ShadowSettings::default`] has it. What is wrong is refused with its line, what stands there and
//! what could.

use std::{fs, ops::Range, path::Path};

use serde::{Deserialize, Serialize};
use shadow_math::{
    Bias, Filter, Fit, ShadowSettings, Split, Store,
    settings::{FilterRadii, MAX_MAP_SIZE, MIN_MAP_SIZE},
};
use toml::Spanned;

use crate::error::CliError;

/// The constant bias in metres if none is given: a centimetre.
pub(crate) const DEFAULT_CONSTANT_METRES: f32 = 0.01;

/// The default settings with comments, as `shadow settings` prints them.
pub(crate) const DEFAULT_TEXT: &str = r#"# How lights are shadowed. Every key may be left out; these are the defaults.
# To measure it against the truth: shadow measure SCENE --settings THIS_FILE

# What reports call it; left out, it is the file's name.
# name = "default"

# Where the samples of a map go: "uniform" (over all that the light reaches).
fit = "uniform"

# How many maps share the view: "single" (as few as can cover the light) or "cube" (six around a spot or point light).
split = "single"

# What a texel remembers: "depth32" (the nearest caster's depth, a 32-bit float).
store = "depth32"

# How depth tests are averaged: "hard" (one test), "bilinear" (four), "cross5", "box3" to "box9", "gaussian", "witness3", "witness5", "witness7", "poisson", "vogel"
# or "footprint"; `shadow help render` says what each is.
filter = "bilinear"

# How far "gaussian" (from 1 to 4), "poisson" or "vogel" (from 0.5 to 16) reach, in texels.
# filter-radius = 2.5

# How surfaces are kept from shadowing themselves:
#   "automatic"  what the receiver's plane needs under the filter, by depth or along its normal: nothing to tune
#   "slope"      the same by depth alone, times bias-scale, plus bias-constant
#   "constant"   bias-constant everywhere
#   "none"       not at all
bias = "automatic"

# Metres along the light's view axis, with "constant" (0.01 if left out) or "slope" (0 if left out).
# bias-constant = 0.01

# A factor on what the plane needs, with "slope": 1 is enough and no more.
# bias-scale = 1.0

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

/// The names of the biases.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
enum BiasName {
    Automatic,
    Slope,
    Constant,
    None,
}

/// A settings file as it is written.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default, rename_all = "kebab-case")]
struct File {
    name: Option<String>,
    fit: Fit,
    split: Split,
    store: Store,
    filter: Filter,
    filter_radius: Option<Spanned<f32>>,
    bias: Option<Spanned<BiasName>>,
    bias_constant: Option<Spanned<f32>>,
    bias_scale: Option<Spanned<f32>>,
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
fn parse(text: &str) -> Result<(Option<String>, ShadowSettings), SettingsError> {
    let at = |span: Option<Range<usize>>, problem: String| {
        let start = span.map_or(0, |span| span.start.min(text.len()));
        // A span lies on characters' borders; were it not so, the line would be that of the whole text.
        let line = text.get(..start).map_or(1, |before| before.matches('\n').count() + 1);
        SettingsError { line, problem }
    };
    let file: File = toml::from_str(text).map_err(|error| at(error.span(), error.message().trim().replace('\n', ", ")))?;
    let bias_name = file.bias.as_ref().map_or(BiasName::Automatic, |bias| *bias.get_ref());
    let length = |default: f32| match &file.bias_constant {
        None => Ok(default),
        Some(metres) if metres.get_ref().is_finite() && *metres.get_ref() >= 0.0 => Ok(*metres.get_ref()),
        Some(metres) => Err(at(
            Some(metres.span()),
            format!("bias-constant = {} makes no sense; it is a length in metres, finite and at least 0", metres.get_ref()),
        )),
    };
    let meaningless = |key: &str, span: Range<usize>, with: &str, use_with: &str| {
        at(Some(span), format!("{key} has no meaning with bias = \"{with}\"; use it with {use_with}, or leave it out"))
    };
    if let (Some(metres), BiasName::Automatic | BiasName::None) = (&file.bias_constant, bias_name) {
        return Err(meaningless("bias-constant", metres.span(), name_of(bias_name), "\"constant\" or \"slope\""));
    }
    if let (Some(scale), BiasName::Automatic | BiasName::None | BiasName::Constant) = (&file.bias_scale, bias_name) {
        return Err(meaningless("bias-scale", scale.span(), name_of(bias_name), "\"slope\""));
    }
    let bias = match bias_name {
        BiasName::Automatic => Bias::Automatic,
        BiasName::None => Bias::None,
        BiasName::Constant => Bias::Constant { metres: length(DEFAULT_CONSTANT_METRES)? },
        BiasName::Slope => {
            let scale = match &file.bias_scale {
                None => 1.0,
                Some(scale) if scale.get_ref().is_finite() && *scale.get_ref() >= 0.0 => *scale.get_ref(),
                Some(scale) => {
                    let problem = format!("bias-scale = {} makes no sense; it is finite and at least 0", scale.get_ref());
                    return Err(at(Some(scale.span()), problem));
                }
            };
            Bias::Slope { scale, metres: length(0.0)? }
        }
    };
    let map_size = match &file.map_size {
        None => ShadowSettings::default().map_size,
        Some(size) if (MIN_MAP_SIZE..=MAX_MAP_SIZE).contains(size.get_ref()) => *size.get_ref(),
        Some(size) => {
            let problem =
                format!("map-size = {} is out of range; choose from {MIN_MAP_SIZE} to {MAX_MAP_SIZE} texels", size.get_ref());
            return Err(at(Some(size.span()), problem));
        }
    };
    let File { name, fit, split, store, filter, .. } = file;
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
    Ok((name, ShadowSettings { fit, split, store, bias, filter, filter_radius, map_size }))
}

fn name_of(bias: BiasName) -> &'static str {
    match bias {
        BiasName::Automatic => "automatic",
        BiasName::Slope => "slope",
        BiasName::Constant => "constant",
        BiasName::None => "none",
    }
}

/// Settings as a settings file would have them, for reports.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) struct SettingsReport {
    name: String,
    fit: Fit,
    split: Split,
    store: Store,
    filter: Filter,
    #[serde(skip_serializing_if = "Option::is_none")]
    filter_radius: Option<f32>,
    bias: BiasName,
    #[serde(skip_serializing_if = "Option::is_none")]
    bias_constant: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    bias_scale: Option<f32>,
    map_size: u32,
}

impl From<&NamedSettings> for SettingsReport {
    fn from(named: &NamedSettings) -> Self {
        let ShadowSettings { fit, split, store, bias, filter, filter_radius, map_size } = named.settings;
        let filter_radius = filter.radii().map(|radii| filter_radius.unwrap_or(radii.default));
        let (bias, bias_constant, bias_scale) = match bias {
            Bias::Constant { metres } => (BiasName::Constant, Some(metres), None),
            Bias::Slope { scale, metres } => (BiasName::Slope, Some(metres), Some(scale)),
            Bias::None => (BiasName::None, None, None),
            // The only one that is left; those to come have names of their own.
            _ => (BiasName::Automatic, None, None),
        };
        Self { name: named.name.clone(), fit, split, store, filter, filter_radius, bias, bias_constant, bias_scale, map_size }
    }
}

impl SettingsReport {
    /// What the technique is called.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// What differs from the defaults least often: map size, filter and bias, for a line of a table.
    pub(crate) fn summary(&self) -> String {
        let length = self.bias_constant.filter(|&metres| metres > 0.0).map_or_else(String::new, |metres| format!(" {metres} m"));
        let scale = self.bias_scale.filter(|&scale| scale != 1.0).map_or_else(String::new, |scale| format!(" x {scale}"));
        let radius = self.filter_radius.map_or_else(String::new, |radius| format!(" {radius}"));
        format!("{} texels, {}{radius}, {}{scale}{length}", self.map_size, self.filter.name(), name_of(self.bias))
    }
}

#[cfg(test)]
mod tests {
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
            .replace("bias = \"automatic\"", "bias = \"slope\"")
            .replace("# bias-", "bias-")
            .replace("filter = \"bilinear\"", "filter = \"vogel\"")
            .replace("# filter-", "filter-")
            .replace("# name", "name");
        let (name, settings) = parse(&taken_in).expect("the comments are settings too");
        assert_eq!((name.as_deref(), settings.bias), (Some("default"), Bias::Slope { scale: 1.0, metres: 0.01 }));
    }

    #[test]
    fn every_choice_can_be_made() {
        assert_eq!(settings("filter = \"hard\"\nmap-size = 512").filter, Filter::Hard);
        assert_eq!(settings("bias = \"constant\"").bias, Bias::Constant { metres: 0.01 });
        assert_eq!(settings("bias = \"constant\"\nbias-constant = 0").bias, Bias::Constant { metres: 0.0 });
        assert_eq!(settings("bias-scale = 0.5\nbias = \"slope\"").bias, Bias::Slope { scale: 0.5, metres: 0.0 });
        assert_eq!(settings("split = \"cube\"").split, Split::Cube);
    }

    #[test]
    fn what_is_wrong_is_refused_with_its_line_its_value_and_the_choices() {
        for (text, line, parts) in [
            ("filter = \"hard\"\nsoftness = 3", 2, ["softness", "map-size"]),
            ("\n\nfilter = \"soft\"", 3, ["soft", "bilinear"]),
            ("filter = \"box3\"\nfilter-radius = 2", 2, ["box3", "\"vogel\""]),
            ("filter = \"gaussian\"\n\nfilter-radius = 5", 3, ["5 is out", "1 to 4"]),
            ("map-size = 8", 1, ["map-size = 8", "16 to 16384"]),
            ("map-size = \"large\"", 1, ["large", "u32"]),
            ("bias = \"constant\"\nbias-constant = -1", 2, ["-1", "at least 0"]),
            ("bias = \"slope\"\n\nbias-scale = nan", 3, ["NaN", "finite"]),
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
