//! Where samples go and how many maps there are, as it is said: on the command line and in settings files alike.

use clap::{Args as ClapArgs, builder::PossibleValuesParser};
use serde::{Deserialize, Serialize};
use shadow_math::{
    Cascades, Fit, FitFrom, PlanError, Selection, ShadowSettings, Split, SplitScheme,
    settings::{DEFAULT_LAMBDA, MAX_CASCADES},
};

use crate::bias::Meaningless;

/// What can be said of a light's cameras; `None` for what is not.
#[derive(Clone, Debug, Default, PartialEq, ClapArgs, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default, rename_all = "kebab-case")]
pub(crate) struct LightCameraArgs {
    /// Where the samples of a map go: uniform, focused, lispsm, plane-optimal, ogre-uniform or ogre-lispsm [default: uniform]
    ///
    /// uniform covers all that the light reaches. focused covers what the camera sees and something can shadow: the smallest rectangle around its image. lispsm warps that, so that what is near to the
    /// camera has more of the samples (Wimmer et al. 2004). plane-optimal gives each pixel of a plane one texel, whatever the light (Chong and Gortler 2004); what lies off the plane has other texels. ogre-uniform covers what OGRE
    /// covers by itself, and ogre-lispsm is lispsm with OGRE's own warp, for comparison.
    #[arg(long, value_name = "FIT", value_parser = fit, help_heading = "Light cameras")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) fit: Option<Fit>,

    /// What fits follow: frustum (all that the camera could see) or samples (what its pixels show) [default: frustum]
    ///
    /// With samples the camera's pass is drawn first, and the points of its pixels bound the fit, as Sample Distribution Shadow Maps have it.
    #[arg(long, value_name = "frustum|samples", value_parser = fit_from, help_heading = "Light cameras")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) fit_from: Option<FitFrom>,

    /// The plane of plane-optimal: nx x + ny y + nz z + d = 0 in metres and the coordinates of the file, such as 0,1,0,0 for the floor y = 0 [default: the plane that most pixels show]
    #[arg(long, value_name = "NX,NY,NZ,D", value_parser = plane, allow_negative_numbers = true, allow_hyphen_values = true, help_heading = "Light cameras")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) plane: Option<[f32; 4]>,

    /// How many maps share the view: single (as few as can cover the light), cube (six around a spot or point light) or cascades (one for each range of distances from the camera) [default: single]
    #[arg(long, value_name = "SPLIT", value_parser = PossibleValuesParser::new(SPLITS), help_heading = "Light cameras")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) split: Option<String>,

    /// How many cascades, from 1 to 8 [default: 4]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MAX_CASCADES as i64), help_heading = "Light cameras")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) cascades: Option<u32>,

    /// Where cascades end: uniform, logarithmic, practical, histogram (as many samples in each), or distances in metres with commas, one fewer than cascades [default: practical]
    #[arg(long, value_name = "SCHEME|D1,D2..", value_parser = split_distances, allow_hyphen_values = true, help_heading = "Light cameras")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) splits: Option<SplitsSpec>,

    /// The share of logarithmic in practical splits, from 0 (uniform) to 1 [default: 0.8]
    #[arg(long, value_name = "X", allow_negative_numbers = true, help_heading = "Light cameras")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) lambda: Option<f32>,

    /// By how many metres each cascade reaches beyond its ends [default: 0]
    #[arg(long, value_name = "METRES", allow_negative_numbers = true, help_heading = "Light cameras")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) padding: Option<f32>,

    /// The share of each cascade, before its end, that is blended with the next one, from 0 to 1 [default: 0]
    #[arg(long, value_name = "SHARE", allow_negative_numbers = true, help_heading = "Light cameras")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) cascade_blend: Option<f32>,

    /// How points choose a cascade: depth (by their distance from the camera) or containment (the first whose map has them) [default: depth]
    #[arg(long, value_name = "depth|containment", value_parser = selection, help_heading = "Light cameras")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) cascade_select: Option<Selection>,

    /// Cascades whose texels stand still while the camera moves and turns: for directional lights, the fit uniform and maps of a power of two
    #[arg(long, help_heading = "Light cameras")]
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub(crate) stabilise: bool,

    /// The map size of each cascade in texels, with commas, at most --map-size; the last goes on [default: --map-size]
    #[arg(long, value_name = "T1,T2..", value_delimiter = ',', help_heading = "Light cameras")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) cascade_sizes: Option<Vec<u32>>,

    /// The fit of each cascade, with commas; the last goes on [default: --fit]
    #[arg(long, value_name = "F1,F2..", value_delimiter = ',', value_parser = fit, help_heading = "Light cameras")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) cascade_fits: Option<Vec<Fit>>,

    /// Factors on the parameter of the warp in each cascade of lispsm, with commas; the last goes on [default: 1]
    ///
    /// 1 is the best by the paper, more warps less, less warps more, and 0 does not warp at all. For a single map take --split cascades --cascades 1.
    #[arg(long, value_name = "X1,X2..", value_delimiter = ',', allow_negative_numbers = true, help_heading = "Light cameras")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) lispsm_factors: Option<Vec<f32>>,

    /// Give the depth of maps to what is seen alone, and draw casters beyond onto its near and far planes
    ///
    /// Steps of depth16 and depth24 are then shares of what is seen, and not of the way to the highest caster. Not for the stores second and midpoint.
    #[arg(long, help_heading = "Light cameras")]
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub(crate) pancake: bool,

    /// How far from the camera, along its axis in metres, there are shadows [default: as far as anything is seen]
    #[arg(long, value_name = "METRES", allow_negative_numbers = true, help_heading = "Light cameras")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) shadow_distance: Option<f32>,
}

/// The names of splits.
const SPLITS: [&str; 3] = ["single", "cube", "cascades"];

/// Where cascades end, as it is said.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(untagged)]
pub(crate) enum SplitsSpec {
    /// A scheme's name.
    Scheme(String),
    /// Distances in metres.
    Distances(Vec<f32>),
}

/// What is said of light cameras that makes no sense.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum LightCameraError {
    /// A key that has no meaning beside the others.
    Meaningless(Meaningless),
    /// A key whose value is none.
    Value {
        /// The key.
        key: &'static str,
        /// What stands there, and what could.
        problem: String,
    },
}

impl LightCameraArgs {
    /// Settings with these cameras.
    pub(crate) fn of(&self, settings: ShadowSettings) -> Result<ShadowSettings, LightCameraError> {
        let wrong = |key, problem| LightCameraError::Value { key, problem };
        let fit = self.fit.unwrap_or_default();
        let is_cascades = self.split.as_deref() == Some("cascades");
        let meaningless = |key, use_with| Err(LightCameraError::Meaningless(Meaningless { key, use_with }));
        if self.plane.is_some() && fit != Fit::PlaneOptimal {
            return meaningless("plane", &["fit plane-optimal"]);
        }
        let of_cascades = [
            ("cascades", self.cascades.is_some()),
            ("splits", self.splits.is_some()),
            ("lambda", self.lambda.is_some()),
            ("padding", self.padding.is_some()),
            ("cascade-blend", self.cascade_blend.is_some()),
            ("cascade-select", self.cascade_select.is_some()),
            ("stabilise", self.stabilise),
            ("cascade-sizes", self.cascade_sizes.is_some()),
            ("cascade-fits", self.cascade_fits.is_some()),
            ("lispsm-factors", self.lispsm_factors.is_some()),
        ];
        if let Some((key, _)) = of_cascades.into_iter().find(|(_, is_said)| *is_said && !is_cascades) {
            return meaningless(key, &["split cascades"]);
        }
        let split = match self.split.as_deref() {
            None | Some("single") => Split::Single,
            Some("cube") => Split::Cube,
            Some("cascades") => Split::Cascades(self.cascades()?),
            Some(other) => {
                let names = SPLITS.join(", ");
                return Err(wrong("split", format!("`{other}` is not a split; take one of {names}")));
            }
        };
        let fit_from = self.fit_from.unwrap_or_default();
        // Maps of all that the light reaches, or of a plane, do not ask what is seen; depth for what is seen alone does.
        if fit_from == FitFrom::Samples {
            if matches!(split, Split::Cascades(Cascades { stabilised: true, .. })) {
                let problem = "cascades that stand still hold the view at every turn, and follow no samples; take frustum, or leave stabilisation out";
                return Err(wrong("fit-from", problem.into()));
            }
            let asks_nobody = matches!(fit, Fit::Uniform | Fit::OgreUniform | Fit::PlaneOptimal) && !self.pancake;
            if asks_nobody && !is_cascades {
                return meaningless("fit-from", &["fit focused", "fit lispsm"]);
            }
        }
        let Self { plane, pancake, shadow_distance, .. } = *self;
        Ok(ShadowSettings { fit, fit_from, split, plane, pancake, shadow_distance, ..settings })
    }

    fn cascades(&self) -> Result<Cascades, LightCameraError> {
        let wrong = |key, problem| LightCameraError::Value { key, problem };
        let default = Cascades::default();
        let count = self.cascades.unwrap_or(default.count);
        let lists = [
            ("cascade-sizes", self.cascade_sizes.as_ref().map_or(0, Vec::len)),
            ("cascade-fits", self.cascade_fits.as_ref().map_or(0, Vec::len)),
            ("lispsm-factors", self.lispsm_factors.as_ref().map_or(0, Vec::len)),
        ];
        if let Some((key, len)) = lists.into_iter().find(|(_, len)| *len > count as usize) {
            return Err(wrong(
                key,
                format!("{len} values for {count} cascades; give one for each, or fewer, of which the last goes on"),
            ));
        }
        let is_lispsm = match self.cascade_fits.as_deref() {
            Some(fits @ [_, ..]) => fits.contains(&Fit::Lispsm),
            _ => self.fit == Some(Fit::Lispsm),
        };
        if self.lispsm_factors.is_some() && !is_lispsm {
            return Err(LightCameraError::Meaningless(Meaningless {
                key: "lispsm-factors",
                use_with: &["fit lispsm", "cascade-fits lispsm"],
            }));
        }
        let lambda = self.lambda.unwrap_or(DEFAULT_LAMBDA);
        let scheme = match &self.splits {
            None => SplitScheme::Practical(lambda),
            Some(SplitsSpec::Scheme(name)) => match name.as_str() {
                "uniform" => SplitScheme::Uniform,
                "logarithmic" => SplitScheme::Logarithmic,
                "practical" => SplitScheme::Practical(lambda),
                "histogram" => SplitScheme::Histogram,
                _ => return Err(wrong("splits", not_a_scheme(name))),
            },
            Some(SplitsSpec::Distances(distances)) => {
                if distances.len() + 1 != count as usize {
                    let problem = format!(
                        "{} distances end {ends} cascades, and there are {count}{}: give one distance fewer than cascades, for the last one ends with the shadows; or take {ends} cascades",
                        distances.len(),
                        if self.cascades.is_none() { " by default" } else { "" },
                        ends = distances.len() + 1
                    );
                    return Err(wrong("splits", problem));
                }
                let mut ends = [0.0; MAX_CASCADES - 1];
                for (end, distance) in ends.iter_mut().zip(distances) {
                    *end = *distance;
                }
                SplitScheme::Explicit(ends)
            }
        };
        if self.lambda.is_some() && !matches!(scheme, SplitScheme::Practical(_)) {
            return Err(LightCameraError::Meaningless(Meaningless { key: "lambda", use_with: &["splits practical"] }));
        }
        Ok(Cascades {
            count,
            scheme,
            padding: self.padding.unwrap_or(default.padding),
            blend: self.cascade_blend.unwrap_or(default.blend),
            selection: self.cascade_select.unwrap_or_default(),
            stabilised: self.stabilise,
            map_sizes: going_on(self.cascade_sizes.as_deref()),
            fits: going_on(self.cascade_fits.as_deref()),
            lispsm_factors: going_on(self.lispsm_factors.as_deref()).map(|factor| factor.unwrap_or(1.0)),
        })
    }

    /// What would have to be said for these settings.
    pub(crate) fn saying(settings: &ShadowSettings) -> Self {
        let default = Cascades::default();
        let ShadowSettings { fit, fit_from, plane, pancake, shadow_distance, split, .. } = *settings;
        let mut said = Self {
            fit: Some(fit),
            fit_from: (fit_from != FitFrom::default()).then_some(fit_from),
            plane,
            pancake,
            shadow_distance,
            split: Some(split_name(&split).into()),
            ..Self::default()
        };
        let Split::Cascades(cascades) = split else { return said };
        let count = cascades.count as usize;
        said.cascades = Some(cascades.count);
        (said.splits, said.lambda) = match cascades.scheme {
            SplitScheme::Uniform => (Some(SplitsSpec::Scheme("uniform".into())), None),
            SplitScheme::Logarithmic => (Some(SplitsSpec::Scheme("logarithmic".into())), None),
            SplitScheme::Histogram => (Some(SplitsSpec::Scheme("histogram".into())), None),
            SplitScheme::Explicit(ends) => (Some(SplitsSpec::Distances(ends[..count - 1].to_vec())), None),
            SplitScheme::Practical(lambda) => (Some(SplitsSpec::Scheme("practical".into())), Some(lambda)),
            _ => (None, None),
        };
        said.padding = (cascades.padding != default.padding).then_some(cascades.padding);
        said.cascade_blend = (cascades.blend != default.blend).then_some(cascades.blend);
        said.cascade_select = (cascades.selection != default.selection).then_some(cascades.selection);
        said.stabilise = cascades.stabilised;
        said.cascade_sizes = of_cascades(&cascades.map_sizes[..count], settings.map_size);
        said.cascade_fits = of_cascades(&cascades.fits[..count], fit);
        let has_factors = cascades.lispsm_factors != default.lispsm_factors;
        said.lispsm_factors = has_factors.then(|| cascades.lispsm_factors[..count].to_vec());
        said
    }
}

/// The key of a settings file that an error is about.
pub(crate) fn key_of(error: &PlanError) -> &'static str {
    match error {
        PlanError::MapSize(_) => "map-size",
        PlanError::Plane(_) => "plane",
        PlanError::ShadowDistance(_) => "shadow-distance",
        PlanError::CascadeCount(_) => "cascades",
        PlanError::Lambda(_) => "lambda",
        PlanError::Padding(_) => "padding",
        PlanError::Blend(_) => "cascade-blend",
        PlanError::SplitDistance(_) => "splits",
        PlanError::CascadeMapSize { .. } => "cascade-sizes",
        PlanError::LispsmFactor(_) => "lispsm-factors",
        PlanError::StabilisedFit(_) | PlanError::StabilisedHistogram | PlanError::StabilisedMapSize(_) => "stabilise",
        PlanError::FitOfCascades(_) | PlanError::FitOfCube(_) => "split",
        PlanError::StoreOfFit { .. } => "store",
        PlanError::BiasOfFit { .. } | PlanError::BiasOfOtherStores { .. } => "bias",
        PlanError::PancakeOfTwo(_) => "pancake",
        _ => "name",
    }
}

/// The name of a split.
fn split_name(split: &Split) -> &'static str {
    match split {
        Split::Cube => SPLITS[1],
        Split::Cascades(_) => SPLITS[2],
        _ => SPLITS[0],
    }
}

/// The cameras of some settings in a few words, after a comma; nothing for one uniform map.
pub(crate) fn summary(settings: &ShadowSettings) -> String {
    let mut text = String::new();
    let mut fits = vec![settings.fit];
    if let Split::Cascades(cascades) = settings.split {
        fits = cascades.fits[..cascades.count as usize].iter().map(|fit| fit.unwrap_or(settings.fit)).collect();
    }
    if fits.iter().any(|fit| *fit != Fit::default()) {
        let is_one = fits.iter().all(|fit| *fit == fits[0]);
        let names: Vec<&str> = fits[..if is_one { 1 } else { fits.len() }].iter().map(|fit| fit.name()).collect();
        text.push_str(&format!(", {}", names.join("/")));
    }
    if settings.fit_from == FitFrom::Samples {
        text.push_str(" to samples");
    }
    match settings.split {
        Split::Cube => text.push_str(", a cube"),
        Split::Cascades(cascades) => {
            let stabilised = if cascades.stabilised { "stabilised " } else { "" };
            text.push_str(&format!(", {} {stabilised}cascades", cascades.count));
        }
        _ => {}
    }
    if settings.pancake {
        text.push_str(", pancaked");
    }
    text
}

/// A list in as many places as there can be cascades: its last value goes on.
fn going_on<T: Copy, const N: usize>(values: Option<&[T]>) -> [Option<T>; N] {
    let values = values.unwrap_or(&[]);
    core::array::from_fn(|place| values.get(place).or(values.last()).copied())
}

/// The values of cascades, of which those that have none take the settings' own; `None` if that is all of them.
fn of_cascades<T: Copy>(values: &[Option<T>], of_settings: T) -> Option<Vec<T>> {
    values.iter().any(Option::is_some).then(|| values.iter().map(|value| value.unwrap_or(of_settings)).collect())
}

/// A fit, by its name.
fn fit(text: &str) -> Result<Fit, String> {
    let names = Fit::ALL.map(Fit::name).join(", ");
    Fit::ALL.into_iter().find(|fit| fit.name() == text).ok_or_else(|| format!("`{text}` is not a fit; take one of {names}"))
}

/// What fits follow, by its name.
fn fit_from(text: &str) -> Result<FitFrom, String> {
    match text {
        "frustum" => Ok(FitFrom::Frustum),
        "samples" => Ok(FitFrom::Samples),
        _ => Err(format!("`{text}` is nothing that fits follow; take frustum or samples")),
    }
}

/// A way to choose a cascade, by its name.
fn selection(text: &str) -> Result<Selection, String> {
    match text {
        "depth" => Ok(Selection::Depth),
        "containment" => Ok(Selection::Containment),
        _ => Err(format!("`{text}` is no way to choose a cascade; take depth or containment")),
    }
}

/// Four numbers with commas.
fn plane(text: &str) -> Result<[f32; 4], String> {
    let numbers: Option<Vec<f32>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    let plane = numbers.and_then(|numbers| <[f32; 4]>::try_from(numbers).ok());
    let is_plane = |plane: &[f32; 4]| plane.iter().all(|number| number.is_finite()) && plane[..3].iter().any(|&n| n != 0.0);
    plane.filter(is_plane).ok_or_else(|| {
        format!("`{text}` is not a plane; write its normal and its offset as nx,ny,nz,d with nx x + ny y + nz z + d = 0, such as 0,1,0,0 for the floor y = 0")
    })
}

/// A scheme's name, or distances.
fn split_distances(text: &str) -> Result<SplitsSpec, String> {
    if ["uniform", "logarithmic", "practical", "histogram"].contains(&text) {
        return Ok(SplitsSpec::Scheme(text.into()));
    }
    let distances: Option<Vec<f32>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    distances.map(SplitsSpec::Distances).ok_or_else(|| not_a_scheme(text))
}

fn not_a_scheme(text: &str) -> String {
    format!(
        "`{text}` does not say where cascades end; take uniform, logarithmic, practical or histogram, or write distances in metres with commas, as 5,20,60"
    )
}

#[cfg(test)]
mod tests {
    use shadow_math::plan::check_settings;

    use super::*;

    /// What nobody asks for is refused, with what to do.
    #[test]
    fn what_would_do_nothing_is_refused() {
        let cascades = || LightCameraArgs { split: Some("cascades".into()), ..LightCameraArgs::default() };
        let samples = || LightCameraArgs { fit_from: Some(FitFrom::Samples), ..LightCameraArgs::default() };
        let refused = |args: LightCameraArgs| args.of(ShadowSettings::default()).expect_err("it does nothing");
        for fit in [Fit::Uniform, Fit::OgreUniform, Fit::PlaneOptimal] {
            let args = LightCameraArgs { fit: Some(fit), ..samples() };
            assert!(
                matches!(refused(args.clone()), LightCameraError::Meaningless(Meaningless { key: "fit-from", .. })),
                "{fit:?}"
            );
            assert!(LightCameraArgs { pancake: true, ..args }.of(ShadowSettings::default()).is_ok(), "depth follows samples");
        }
        let still = LightCameraArgs { stabilise: true, fit_from: Some(FitFrom::Samples), fit: Some(Fit::Lispsm), ..cascades() };
        assert!(
            matches!(refused(still), LightCameraError::Value { key: "fit-from", problem } if problem.contains("stabilisation"))
        );
        let factors = LightCameraArgs { fit: Some(Fit::Lispsm), lispsm_factors: Some(vec![3.0]), ..cascades() };
        assert!(factors.of(ShadowSettings::default()).is_ok());
        let unwarped = LightCameraArgs { cascade_fits: Some(vec![Fit::Focused]), ..factors.clone() };
        assert!(matches!(refused(unwarped), LightCameraError::Meaningless(Meaningless { key: "lispsm-factors", .. })));
        let one = LightCameraArgs { cascade_fits: Some(vec![Fit::Lispsm, Fit::Focused]), ..factors };
        let settings = one.of(ShadowSettings::default()).expect("the first is warped");
        assert_eq!(summary(&settings), ", lispsm/focused/focused/focused, 4 cascades");
    }

    /// What settings are said to be gives the same settings, as options and in a file.
    #[test]
    fn what_is_said_is_what_is_meant() {
        let mut sizes = [Some(512); MAX_CASCADES];
        sizes[..2].copy_from_slice(&[Some(2048), Some(1024)]);
        let mut ends = [0.0; MAX_CASCADES - 1];
        ends[..2].copy_from_slice(&[5.0, 20.5]);
        let cascades = Cascades::default();
        let splits = [
            Split::Single,
            Split::Cube,
            Split::Cascades(cascades),
            Split::Cascades(Cascades {
                count: 3,
                scheme: SplitScheme::Explicit(ends),
                padding: 0.5,
                stabilised: true,
                ..cascades
            }),
            Split::Cascades(Cascades {
                scheme: SplitScheme::Histogram,
                blend: 0.25,
                selection: Selection::Containment,
                ..cascades
            }),
            Split::Cascades(Cascades { map_sizes: sizes, lispsm_factors: [2.0; MAX_CASCADES], ..cascades }),
            Split::Cascades(Cascades { fits: [Some(Fit::Lispsm); MAX_CASCADES], scheme: SplitScheme::Uniform, ..cascades }),
            Split::Cascades(Cascades { scheme: SplitScheme::Practical(0.25), ..cascades }),
        ];
        for fit in Fit::ALL {
            for split in splits {
                let plane = (fit == Fit::PlaneOptimal).then_some([0.0, 1.0, 0.0, -0.5]);
                let mut settings = ShadowSettings {
                    fit,
                    split,
                    plane,
                    shadow_distance: Some(40.0),
                    pancake: fit != Fit::Focused,
                    fit_from: FitFrom::Samples,
                    ..ShadowSettings::default()
                };
                let said = LightCameraArgs::saying(&settings);
                if matches!(split, Split::Cascades(Cascades { lispsm_factors: [2.0, ..], .. })) && fit != Fit::Lispsm {
                    // Factors of a warp that is not there are refused.
                    assert!(said.of(ShadowSettings::default()).is_err());
                    continue;
                }
                if matches!(split, Split::Cascades(Cascades { stabilised: true, .. })) {
                    // So are samples for spheres that do not follow them.
                    assert!(said.of(ShadowSettings::default()).is_err());
                    settings.fit_from = FitFrom::Frustum;
                }
                let said = LightCameraArgs::saying(&settings);
                assert_eq!(said.of(ShadowSettings::default()), Ok(settings));
                let file = crate::settings_file::SettingsReport::of("it", &settings).file("# it");
                let read = crate::settings_file::parse(&file).map(|(_, settings)| settings);
                match check_settings(&settings) {
                    Ok(()) => assert_eq!(read, Ok(settings), "{file}"),
                    // What has no meaning together is said all the same, and refused where it is read.
                    Err(why) => assert!(read.is_err_and(|error| error.to_string().ends_with(&why.to_string())), "{file}"),
                }
            }
        }
    }
}
