//! `shadow settings --convert`: what a bias is in metres and in another engine's numbers, for a light of a scene.

use serde::{Serialize, Serializer, ser::SerializeMap};
use shadow_math::{ShadowSettings, plan::ViewPlan};

use crate::{
    args::{DEFAULT_ANGLE_DEGREES, SettingsArgs},
    commands::Verdict,
    console::{Console, print, print_json, table},
    convert::{Conversion, GivenBias, Place, System, convert},
    error::CliError,
    presets::Kind,
    resolve::{light_names, load, tell_notes, with_chosen_lights},
    shadowing::Shadowing,
    specs::Selector,
};

/// The least angle that no surface that faces the light has, in degrees.
const EDGE_ON: f32 = 90.0;
/// Digits of numbers for people: a length to a tenth of a thousandth of itself.
const DIGITS: i32 = 5;

/// The report for programs.
#[derive(Debug, Serialize)]
struct Report<'a> {
    scene: &'a str,
    notes: Vec<String>,
    light: LightReport<'a>,
    map_size: u32,
    /// The distances of the near and the far plane, in metres.
    depth_range: [f64; 2],
    /// The width of a texel at the place, in metres.
    texel: f64,
    /// The distance from the light along its axis, in metres.
    at: f64,
    /// The angle between normal and light, in degrees.
    angle: f64,
    from: SystemReport,
    to: SystemReport,
    components: Vec<ComponentReport>,
}

/// For which light.
#[derive(Debug, Serialize)]
struct LightReport<'a> {
    index: usize,
    name: &'a str,
    kind: &'static str,
}

/// A bias in an engine's numbers.
#[derive(Debug, Serialize)]
struct SystemReport {
    engine: &'static str,
    parameters: Numbers,
}

/// Numbers by the names of their parameters, in their order; null where no number does what is asked.
#[derive(Debug)]
struct Numbers(Vec<(&'static str, Option<f64>)>);

impl Serialize for Numbers {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, number) in &self.0 {
            map.serialize_entry(name, number)?;
        }
        map.end()
    }
}

/// One component of the bias.
#[derive(Debug, Serialize)]
struct ComponentReport {
    name: &'static str,
    /// For people.
    #[serde(skip)]
    title: &'static str,
    metres: f64,
    texels: f64,
    problem: Option<String>,
    /// The numbers that it was made of, and those that it becomes, for people.
    #[serde(skip)]
    from: String,
    #[serde(skip)]
    to: String,
}

/// Converts and reports.
pub(super) fn run(args: &SettingsArgs, given: &GivenBias, to: System) -> Result<Verdict, CliError> {
    let console = Console::new(args.json);
    let angle = args.angle.unwrap_or(DEFAULT_ANGLE_DEGREES);
    if !(0.0..EDGE_ON).contains(&angle) {
        return Err(CliError::Angle(angle));
    }
    let defaults = ShadowSettings::default();
    let settings = ShadowSettings { map_size: args.map_size.unwrap_or(defaults.map_size), ..defaults };
    let (scene_name, scene, _) = load(&args.scene, &console)?;
    let scene = with_chosen_lights(scene, &args.lights)?;
    let index = args.of_light.as_ref().unwrap_or(&Selector::Index(0)).find("light", &light_names(&scene))?;
    // No picture is made: any camera and size will do, and every scene has a camera.
    let camera = scene.cameras()[0].camera;
    let plan = Shadowing::alike(settings).plan(&scene, &camera, (1, 1), None)?;
    let light = &scene.lights()[index];
    let view = plan.views_of(index).first().ok_or_else(|| CliError::NoMap(light.name.clone()))?;
    let place = place(view, Kind::of(&light.light.kind), settings.map_size, args.at, angle)?;
    let conversion = convert(given, to, &place).map_err(CliError::Conversion)?;

    let mut notes = scene.notes().to_vec();
    for system in [given.system, to] {
        let remark = system.remark(place.kind).map(String::from);
        notes.extend(remark.filter(|remark| !notes.contains(remark)).into_iter().collect::<Vec<_>>());
    }
    tell_notes(&notes, &console);
    console.finish();
    let report = Report {
        scene: &scene_name,
        notes,
        light: LightReport { index, name: &light.name, kind: place.kind.name() },
        map_size: place.map_size,
        depth_range: [place.near, place.far],
        texel: place.texel,
        at: place.at,
        angle: f64::from(angle),
        components: components(&conversion, given.system, to, &place),
        from: SystemReport {
            engine: given.system.name(),
            parameters: Numbers(conversion.from.into_iter().map(|(name, number)| (name, Some(number))).collect()),
        },
        to: SystemReport { engine: to.name(), parameters: Numbers(conversion.to) },
    };
    if args.json { print_json(&report) } else { print(&text(&report)) }?;
    Ok(Verdict::Done)
}

/// A place on the axis of a view.
fn place(view: &ViewPlan, kind: Kind, map_size: u32, at: Option<f32>, degrees: f32) -> Result<Place, CliError> {
    let [near, far] = view.depth_range;
    let at = at.unwrap_or(0.5 * (near + far));
    if !(at > near && at <= far) {
        return Err(CliError::At { at, near, far });
    }
    let is_perspective = view.w_per_metre > 0.0;
    let scale = if is_perspective { f64::from(at) } else { 1.0 };
    Ok(Place {
        kind,
        is_perspective,
        map_size,
        texel: f64::from(view.texel_metres[0].max(view.texel_metres[1])) * scale,
        near: f64::from(near),
        far: f64::from(far),
        at: f64::from(at),
        angle: f64::from(degrees).to_radians(),
    })
}

/// The components, with the numbers of either side.
fn components(conversion: &Conversion, from: System, to: System, place: &Place) -> Vec<ComponentReport> {
    let list = |system: System, numbers: &[(&'static str, Option<f64>)], component| {
        let of_component =
            |name: &str| system.parameters().iter().any(|other| other.name == name && other.component == component);
        let shown = |number: Option<f64>| number.map_or_else(|| "none".into(), significant);
        let numbers = numbers.iter().filter(|(name, _)| of_component(name));
        let texts: Vec<String> = numbers.map(|(name, number)| format!("{name} = {}", shown(*number))).collect();
        if texts.is_empty() { "-".into() } else { texts.join(", ") }
    };
    let numbers: Vec<_> = conversion.from.iter().map(|(name, number)| (*name, Some(*number))).collect();
    let component = |converted: &crate::convert::Converted| ComponentReport {
        name: converted.component.name(),
        title: converted.component.title(),
        metres: converted.metres,
        texels: converted.metres / place.texel,
        problem: converted.problem.clone(),
        from: list(from, &numbers, converted.component),
        to: list(to, &conversion.to, converted.component),
    };
    conversion.components.iter().map(component).collect()
}

/// A number in as many digits as people read, without zeros at its end.
fn significant(number: f64) -> String {
    if number == 0.0 {
        return "0".into();
    }
    let places = DIGITS - 1 - number.abs().log10().floor() as i32;
    let places = usize::try_from(places).unwrap_or(0);
    let text = format!("{number:.places$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
}

/// The report for people.
fn text(report: &Report<'_>) -> String {
    let Report { scene, light, map_size, depth_range: [near, far], texel, at, angle, from, to, components, .. } = report;
    let mut text = format!(
        "{scene}: light {} `{}` ({}), {map_size} x {map_size} texels over {} to {} m\nat {} m, where a texel is {} mm, {angle} degrees between normal and light\n\n",
        light.index,
        light.name,
        light.kind,
        significant(*near),
        significant(*far),
        significant(*at),
        significant(1e3 * texel),
    );
    let heading = ["bias", "metres", "texels", from.engine, to.engine].map(String::from).to_vec();
    let row = |component: &ComponentReport| {
        vec![
            component.title.into(),
            significant(component.metres),
            significant(component.texels),
            component.from.clone(),
            component.to.clone(),
        ]
    };
    let rows: Vec<Vec<String>> = [heading].into_iter().chain(components.iter().map(row)).collect();
    text.push_str(&table(&rows, |column| column == 0 || column > 2));
    for component in components {
        if let Some(problem) = &component.problem {
            text.push_str(&format!("{}: {problem}; {} m are not converted\n", component.title, significant(component.metres)));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_for_people_are_short_and_right() {
        for (number, text) in [
            (0.0, "0"),
            (0.02, "0.02"),
            (-0.000_202_424_9, "-0.00020242"),
            (12.345_678, "12.346"),
            (123_456.7, "123457"),
            (100.0, "100"),
            (1.0 / 3.0, "0.33333"),
        ] {
            assert_eq!(significant(number), text);
        }
    }
}
