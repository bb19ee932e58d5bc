//! `shadow plan`: how a picture would be made.

use glam::DVec3;
use serde::Serialize;
use shadow_math::{
    Filter, Fit, Store,
    fit::FitOutcome,
    plan::{LightPlan, SPLIT_CASCADES, SPLIT_CUBE, ViewPlan},
};
use shadow_scene::SceneLight;

use super::Verdict;
use crate::{
    args::PlanArgs,
    backend::Place,
    bias::{BiasNames, summary},
    console::{Console, print, print_json, table},
    error::CliError,
    light_camera::{self, LightCameraArgs},
    light_drawing::light_drawing,
    output::{check_drawing_path, write_text},
    resolve::{Job, kind_name, view_names},
    specs::spec_of,
};

/// The rows of a matrix that multiplies column vectors.
type Rows = [[f32; 4]; 4];

/// The report for programs.
#[derive(Debug, Serialize)]
struct Report<'a> {
    scene: &'a str,
    notes: &'a [String],
    triangles: usize,
    /// The point in metres of the file's world space that all matrices take coordinates relative to.
    origin: [f64; 3],
    /// The exposure value, EV at ISO 100.
    exposure: f32,
    /// Width and height of every map in texels.
    map_size: u32,
    camera: CameraReport<'a>,
    lights: Vec<LightReport<'a>>,
}

/// How the picture is taken.
#[derive(Debug, Serialize)]
struct CameraReport<'a> {
    name: &'a str,
    /// The camera as `--camera` takes it; null where there is no such description.
    spec: Option<String>,
    /// Whether the description shows the same; a rolled camera's does not.
    #[serde(skip)]
    is_level: bool,
    width: u32,
    height: u32,
    /// From metres relative to the origin to clip space with reversed depth.
    clip_from_world: Rows,
}

/// How a light is shadowed.
#[derive(Debug, Serialize)]
struct LightReport<'a> {
    light: usize,
    name: &'a str,
    kind: &'static str,
    fit: Fit,
    split: &'static str,
    store: Store,
    bias: BiasReport,
    filter: Filter,
    /// The light's cameras as a settings file has them.
    cameras: LightCameraArgs,
    /// The same in a few words.
    #[serde(skip)]
    cameras_summary: String,
    /// The plane of a plane-optimal fit, given or found, as `nx x + ny y + nz z + d = 0` in the coordinates of the file; null for other fits.
    plane: Option<[f64; 4]>,
    /// Where each cascade ends, in metres from the camera along its axis; empty without cascades. The last one goes on to wherever shadows end.
    cascade_ends: Vec<f32>,
    views: Vec<ViewReport>,
}

/// How self-shadowing is avoided.
#[derive(Debug, Serialize)]
struct BiasReport {
    name: String,
    /// A length along the view axis of the light that is added, in metres.
    metres: f32,
    /// The factor on what the receiver's plane needs; 0 where that is not asked.
    slope_scale: f32,
    /// The bias in a line.
    #[serde(skip)]
    summary: String,
}

/// One shadow map.
#[derive(Debug, Serialize)]
struct ViewReport {
    view: usize,
    /// The face of the cube, such as `+x`; empty where there is no cube.
    name: String,
    /// The layer of the map array; null for a view in which nothing is seen, which has none.
    layer: Option<u32>,
    /// `fitted`, `nothing-visible`, or why the view is the uniform one.
    outcome: &'static str,
    /// Whether w is something else than the distance along the axis.
    is_warped: bool,
    /// Width and height of the map in texels.
    size: u32,
    /// `orthographic` or `perspective`.
    projection: &'static str,
    /// From metres relative to the origin to clip space, depth 0 at the near plane.
    clip_from_world: Rows,
    /// The distances of the near and the far plane along the axis, in metres.
    depth_range: [f32; 2],
    /// Whether casters before and behind these planes are drawn onto them.
    is_pancaked: bool,
    /// Width and height of a texel, in metres: everywhere for an orthographic view, 1 m from the light for a perspective one.
    texel_metres: [f32; 2],
    rounding: RoundingReport,
}

/// The bounds on rounding.
#[derive(Debug, Serialize)]
struct RoundingReport {
    /// In texels: the first number holds wherever the receiver is, the second is divided by its w and added.
    texels: [f32; 2],
    /// In depth, likewise.
    depth: [f32; 2],
}

impl<'a> Report<'a> {
    fn of(job: &'a Job) -> Self {
        let camera = &job.plan.camera;
        let lights = job.scene.lights().iter().zip(&job.plan.lights).enumerate();
        let written = spec_of(&job.camera, job.scene.origin(), job.scene.bounds());
        Self {
            scene: &job.scene_name,
            notes: &job.notes,
            triangles: job.scene.triangles().len(),
            origin: DVec3::to_array(&job.scene.origin()),
            exposure: job.plan.ev,
            map_size: job.plan.map_size,
            camera: CameraReport {
                name: &job.camera_name,
                is_level: written.as_ref().is_some_and(|written| written.is_level),
                spec: written.map(|written| written.text),
                width: camera.width,
                height: camera.height,
                clip_from_world: [camera.clip_x, camera.clip_y, camera.clip_z, camera.clip_w],
            },
            lights: lights.map(|(index, (light, plan))| LightReport::of(job, index, light, plan)).collect(),
        }
    }
}

impl<'a> LightReport<'a> {
    fn of(job: &Job, light: usize, scene_light: &'a SceneLight, plan: &LightPlan) -> Self {
        let views = job.plan.views_of(light);
        let settings = &job.of_lights[light];
        Self {
            light,
            name: &scene_light.name,
            kind: kind_name(&scene_light.light.kind),
            fit: settings.fit,
            split: match plan.split {
                SPLIT_CUBE => "cube",
                SPLIT_CASCADES => "cascades",
                _ => "single",
            },
            store: settings.store,
            bias: BiasReport {
                name: BiasNames::of(settings.bias).0.to_string(),
                metres: plan.bias_metres,
                slope_scale: plan.slope_scale,
                summary: summary(settings.bias),
            },
            filter: settings.filter,
            cameras: LightCameraArgs::saying(settings),
            cameras_summary: light_camera::summary(settings),
            plane: (settings.fit == Fit::PlaneOptimal)
                .then(|| settings.plane.map(|plane| plane.map(f64::from)).or(job.plane.map(|plane| plane.to_array())))
                .flatten(),
            cascade_ends: match plan.split {
                SPLIT_CASCADES => plan.split_far.as_flattened()[..views.len() - 1].to_vec(),
                _ => Vec::new(),
            },
            views: views
                .iter()
                .zip(view_names(views.len()))
                .enumerate()
                .map(|(index, (view, name))| ViewReport::of(index, name, view))
                .collect(),
        }
    }
}

impl ViewReport {
    fn of(index: usize, name: String, view: &ViewPlan) -> Self {
        Self {
            view: index,
            name,
            layer: view.has_map().then_some(view.layer),
            outcome: match view.outcome() {
                FitOutcome::Fitted => "fitted",
                FitOutcome::NothingVisible => "nothing-visible",
                FitOutcome::FellBackToUniform { why } => why.name(),
            },
            is_warped: view.is_warped != 0,
            size: view.rect[2],
            projection: if view.w_per_metre == 0.0 { "orthographic" } else { "perspective" },
            clip_from_world: [view.clip_x, view.clip_y, view.clip_z, view.clip_w],
            depth_range: view.depth_range,
            is_pancaked: view.is_pancaked(),
            texel_metres: view.texel_metres,
            rounding: RoundingReport { texels: view.rounding_texels, depth: view.rounding_depth },
        }
    }
}

/// Plans the picture and reports.
pub(super) fn run(args: &PlanArgs) -> Result<Verdict, CliError> {
    let console = Console::new(args.json);
    if let Some(path) = &args.draw {
        check_drawing_path(path)?;
    }
    let job = Job::resolve(&args.picture, &args.bias, Place::NOWHERE, &console)?;
    if let Some(path) = &args.draw {
        write_text(path, &light_drawing(&job.scene, &job.camera, &job.plan, "side"))?;
    }
    console.finish();
    let report = Report::of(&job);
    let written = args.draw.as_ref().map(|path| format!("wrote {}\n", path.display())).unwrap_or_default();
    if args.json { print_json(&report) } else { print(&(text(&report) + &written)) }?;
    Ok(Verdict::Done)
}

/// The report for people.
fn text(report: &Report<'_>) -> String {
    let CameraReport { name, spec, is_level, width, height, .. } = &report.camera;
    let mut text = format!(
        "{}: {} triangles, camera `{name}`, {width} x {height} pixels at EV {:.1}, shadow maps of {size} x {size} texels\n",
        report.scene,
        report.triangles,
        report.exposure,
        size = report.map_size
    );
    let heading = ["light", "view", "projection", "near", "far", "texel", "bias", "filter"].map(String::from).to_vec();
    let mut rows = vec![heading];
    for light in &report.lights {
        if light.views.is_empty() {
            let mut row = vec![format!("{} {} `{}`", light.light, light.kind, light.name), "casts no shadows".into()];
            row.resize(rows[0].len(), String::new());
            rows.push(row);
        }
        for view in &light.views {
            if view.outcome == "nothing-visible" {
                let mut row =
                    vec![format!("{} {} `{}`", light.light, light.kind, light.name), format!("{} {}", view.view, view.name)];
                row.push("nothing is seen".into());
                row.resize(rows[0].len(), String::new());
                rows.push(row);
                continue;
            }
            let at = if view.is_warped {
                " in the middle"
            } else if view.projection == "perspective" {
                " at 1 m"
            } else {
                ""
            };
            rows.push(vec![
                format!("{} {} `{}`", light.light, light.kind, light.name),
                format!("{} {}", view.view, view.name).trim().into(),
                format!(
                    "{}{}{}",
                    view.projection,
                    if view.is_warped { ", warped" } else { "" },
                    if view.is_pancaked { ", pancaked" } else { "" }
                ),
                format!("{:.3} m", view.depth_range[0]),
                format!("{:.3} m", view.depth_range[1]),
                format!("{:.2} x {:.2} mm{at}", 1e3 * view.texel_metres[0], 1e3 * view.texel_metres[1]),
                light.bias.summary.clone(),
                light.filter.name().into(),
            ]);
        }
    }
    text.push_str(&table(&rows, |column| !(3..=5).contains(&column)));
    for light in report.lights.iter().filter(|light| !light.cameras_summary.is_empty()) {
        let ends: Vec<String> = light.cascade_ends.iter().map(|end| format!("{end:.2}")).collect();
        let ends =
            if ends.is_empty() { String::new() } else { format!("; cascades end at {} m from the camera", ends.join(", ")) };
        let plane = light.plane.map_or_else(String::new, |plane| {
            // No number is minus 0.
            let [x, y, z, d] = plane.map(|number| (number * 1e4).round() / 1e4 + 0.0);
            format!(" of the plane {x},{y},{z},{d}")
        });
        text.push_str(&format!("light {}{}{plane}{ends}\n", light.light, light.cameras_summary.replacen(',', ":", 1)));
    }
    if let Some(spec) = spec {
        let roll = if *is_level { "" } else { " (which is level, as this one is not)" };
        text.push_str(&format!("to vary the camera, begin with --camera '{spec}'{roll}\n"));
    }
    text.push_str("--json has the matrices and the bounds on rounding\n");
    text
}
