//! Pictures that explain a frame: computed from its layers, whichever backend drew them.

use glam::Vec2;
use shadow_cpu::{
    RasterRules,
    measure::{Cause, FrameAliasing, Judge},
    trace::{CameraView, Tracer},
};
use shadow_math::{
    MapAccess, Receiver,
    bias::{needed_depth, normal_offset, normal_step},
    depth::{DEPTH_LINEAR, DEPTH_Z_OVER_W, comparable_depth, linear_bias},
    filter::taps::for_each_weighted_tap,
    plan::{BIAS_AUTOMATIC, BIAS_NONE, COMPOSE_UNSHADOWED, CameraPlan, LightPlan},
    vector::{row_times_point, unit_normal},
    visibility::{Lookup, NO_VIEW, footprint, lookup},
};
use shadow_scene::{Frame, FrameMaps, FramePlan, LayerName, NO_TRIANGLE, Request, StageTimes};

use crate::{
    args::{Backend, MachineArgs},
    backend::{OpenBackend, RenderedFrame},
    colors::{STRETCH_LEGEND, color_of, heat, stretch_color},
    console::Console,
    error::CliError,
    memory::{self, Work},
    picture::{Picture, encode_color, pictures},
    resolve::{Job, view_names},
    specs::Selector,
};

/// What is shown of a frame beside its layers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DebugView {
    MiniScreen,
    LightView,
    DistanceMatch,
    Unshadowed,
    Shadows,
    Texels,
    Bias,
    Taps,
    Aliasing,
    Cause,
}

impl DebugView {
    /// Every view with the name that the command line has for it.
    pub(crate) const ALL: [(&'static str, Self); 10] = [
        ("mini-screen", Self::MiniScreen),
        ("light-view", Self::LightView),
        ("distance-match", Self::DistanceMatch),
        ("unshadowed", Self::Unshadowed),
        ("shadows", Self::Shadows),
        ("texels", Self::Texels),
        ("bias", Self::Bias),
        ("taps", Self::Taps),
        ("aliasing", Self::Aliasing),
        ("cause", Self::Cause),
    ];

    /// Whether it is one of a light.
    pub(crate) fn is_of_light(self) -> bool {
        !matches!(self, Self::Unshadowed | Self::Shadows | Self::Cause)
    }

    /// Whether it is one of a light's view.
    pub(crate) fn is_of_view(self) -> bool {
        matches!(self, Self::MiniScreen | Self::LightView)
    }
}

/// A debug view, of a light and a view of it.
pub(crate) struct Wanted<'a> {
    pub(crate) view: DebugView,
    pub(crate) light: &'a Selector,
    pub(crate) light_view: usize,
}

/// A picture that explains, and what it says in a sentence.
pub(crate) struct Explained {
    pub(crate) picture: Picture,
    pub(crate) width: u32,
    pub(crate) height: u32,
    /// What its colours mean, in this picture.
    pub(crate) legend: String,
    pub(crate) rendered: RenderedFrame,
}

/// How much larger a frame of a map on the picture is than nothing, in pixels.
const FRAME_PIXELS: u32 = 2;
/// What share of the picture's height a map on it takes.
const MINI_SHARE: u32 = 3;
/// By what the darker texels of a grid are dimmed.
const DARKER_TEXEL: f32 = 0.55;

/// Of how many percent of the pixels the brightest colour is more than the bias.
const HIGH_PERCENT: usize = 95;

/// Draws a debug view.
pub(crate) fn explain(
    wanted: &Wanted<'_>,
    job: &Job,
    backend: Backend,
    machine: &MachineArgs,
    console: &Console,
) -> Result<Explained, CliError> {
    let names: Vec<String> = job.scene.lights().iter().map(|light| light.name.clone()).collect();
    let light = if wanted.view.is_of_light() { wanted.light.find("light", &names)? } else { 0 };
    if wanted.view.is_of_light() && job.plan.lights[light].view_count == 0 {
        return Err(CliError::LightWithoutMaps { light: wanted.light.clone() });
    }
    if wanted.view.is_of_view() {
        let views = view_names(job.plan.views_of(light).len());
        Selector::Index(wanted.light_view).find("view", &views)?;
        let view = &job.plan.views_of(light)[wanted.light_view];
        if !view.has_map() {
            return Err(CliError::ViewOfNothing { light: wanted.light.clone(), view: wanted.light_view });
        }
        if wanted.view == DebugView::LightView && view.is_warped != 0 {
            return Err(CliError::WarpedLightView { light: wanted.light.clone() });
        }
    }
    let plan = plan_for(wanted, light, &job.plan);
    memory::check_plan(job, &plan, Work::Explain(backend))?;
    let (open, once) = OpenBackend::open(backend, job, machine, RasterRules::default(), console)?;
    console.stage(format!("rendering on {}", open.place()));
    let (frame, times) = open.render(&plan, Request::ALL, console)?;
    let times = StageTimes { prepare: once.prepare, ..times };
    let colors = frame.color().ok_or(CliError::Layer { backend: backend.name(), layer: LayerName::Color })?;
    let (width, height) = (plan.camera.width, plan.camera.height);
    let of_pixels = |pixels: Vec<[u8; 3]>| Picture::of_pixels(width, height, pixels);
    let (picture, legend) = match wanted.view {
        DebugView::LightView | DebugView::Unshadowed => {
            (of_pixels(colors.iter().map(|&color| encode_color(color)).collect()), String::new())
        }
        DebugView::MiniScreen => {
            let name = LayerName::ShadowMap { light: light as u32, view: wanted.light_view as u32 };
            let layer = frame.layer(name).ok_or(CliError::Layer { backend: backend.name(), layer: name })?;
            let [map] = pictures([layer], &plan);
            let base = colors.iter().map(|&color| encode_color(color)).collect();
            (of_pixels(with_mini_screen(base, width, height, &map)), "the map is white where it is nearest to the light".into())
        }
        DebugView::Shadows => {
            let lit_plan = FramePlan { camera: CameraPlan { composition: COMPOSE_UNSHADOWED, ..plan.camera }, ..plan.clone() };
            let (lit, _) = open.render(&lit_plan, Request::COLOR, console)?;
            let lit = lit.color().ok_or(CliError::Layer { backend: backend.name(), layer: LayerName::Color })?;
            let taken = |(lit, shadowed): (&[f32; 4], &[f32; 4])| {
                encode_color([lit[0] - shadowed[0], lit[1] - shadowed[1], lit[2] - shadowed[2], 1.0].map(|c| c.max(0.0)))
            };
            (of_pixels(lit.iter().zip(colors).map(taken).collect()), "black is where shadows take nothing".into())
        }
        DebugView::Cause => causes(job, &plan, &frame, console, &of_pixels)?,
        DebugView::Aliasing => {
            let missing = CliError::Layer { backend: backend.name(), layer: LayerName::Triangle };
            let triangles = frame.triangles().ok_or(missing)?;
            let (pixels, legend) = stretches(job, &plan, light, triangles, machine.threads as usize)?;
            (of_pixels(pixels), legend)
        }
        DebugView::DistanceMatch | DebugView::Texels | DebugView::Bias | DebugView::Taps => {
            let seen = SeenLight { job, plan: &plan, light, frame: &frame };
            let missing = CliError::Layer { backend: backend.name(), layer: LayerName::Triangle };
            let (pixels, legend) = seen.explain(wanted.view).ok_or(missing)?;
            (of_pixels(pixels), legend)
        }
    };
    let rendered = RenderedFrame { backend, adapter: open.adapter().cloned(), frame, times, sampling: open.sampling() };
    Ok(Explained { picture, width, height, legend, rendered })
}

/// The plan of the frame that a view is made of.
fn plan_for(wanted: &Wanted<'_>, light: usize, plan: &FramePlan) -> FramePlan {
    let mut plan = plan.clone();
    match wanted.view {
        DebugView::Unshadowed => plan.camera.composition = COMPOSE_UNSHADOWED,
        DebugView::LightView => {
            let view = plan.views_of(light)[wanted.light_view];
            // The camera's depth is reversed; a view that is not so becomes it by w - z.
            let reversed = |z: f32, w: f32| if view.depth_kind == DEPTH_Z_OVER_W { w - z } else { z };
            // All casters are shown, as they are drawn.
            let clip_z = [0, 1, 2, 3].map(|i| reversed(view.drawn_z[i], view.clip_w[i]));
            plan.camera = CameraPlan {
                clip_x: view.clip_x,
                clip_y: view.clip_y,
                clip_z,
                clip_w: view.clip_w,
                rays: view.rays,
                width: view.rect[2],
                height: view.rect[3],
                ..plan.camera
            };
        }
        _ => {}
    }
    plan
}

/// A picture with a smaller one in its lower right corner.
fn with_mini_screen(mut pixels: Vec<[u8; 3]>, width: u32, height: u32, map: &Picture) -> Vec<[u8; 3]> {
    let side = (height / MINI_SHARE).min(width).max(1);
    let (left, top) = (width - side, height - side);
    for y in 0..side {
        for x in 0..side {
            let is_frame = x < FRAME_PIXELS || y < FRAME_PIXELS;
            let pixel = &mut pixels[((top + y) * width + left + x) as usize];
            *pixel = if is_frame {
                [255, 220, 0]
            } else {
                map.nearest(f64::from(x) / f64::from(side), f64::from(y) / f64::from(side))
            };
        }
    }
    pixels
}

/// Why pixels are wrong, in the colours of the causes.
fn causes(
    job: &Job,
    plan: &FramePlan,
    frame: &Frame,
    console: &Console,
    of_pixels: &dyn Fn(Vec<[u8; 3]>) -> Picture,
) -> Result<(Picture, String), CliError> {
    console.stage("tracing the truth");
    let tracer = Tracer::new(&job.scene, 0)?;
    let view = CameraView::new(&job.camera, plan.camera.width, plan.camera.height);
    console.bar(2 * u64::from(view.height()));
    let judge = Judge::new(&tracer, view, job.light_samples.unwrap_or_default(), &|| console.step());
    let judgement = judge.judge(plan, frame)?;
    let colors = frame.color().unwrap_or_default();
    let pixels = colors.iter().zip(judgement.causes()).map(|(&color, cause)| match Cause::of_number(cause) {
        Some(cause) => color_of(cause),
        None => {
            let [r, g, b] = encode_color(color).map(u16::from);
            [((r + g + b) / 9) as u8; 3]
        }
    });
    let total = judgement.total();
    let counts = Cause::ALL.iter().filter(|&&cause| total.count(cause) > 0).map(|&cause| {
        let [r, g, b] = color_of(cause);
        format!("{} {} (#{r:02x}{g:02x}{b:02x})", total.count(cause), cause.name())
    });
    let counts: Vec<String> = counts.collect();
    let legend = if counts.is_empty() { "no pixel is wrong".into() } else { format!("wrong pixels: {}", counts.join(", ")) };
    Ok((of_pixels(pixels.collect()), legend))
}

/// Over how many pixels the texels of a light smear, as pixels, and what that comes to.
fn stretches(
    job: &Job,
    plan: &FramePlan,
    light: usize,
    triangles: &[u32],
    threads: usize,
) -> Result<(Vec<[u8; 3]>, String), CliError> {
    let aliasing = FrameAliasing::of(&job.scene, plan, triangles, threads)?;
    let of_light = &aliasing.lights[light];
    let pixels = of_light.stretches.iter().map(|&stretch| stretch_color(stretch)).collect();
    let statistics = of_light.statistics;
    let numbers = if statistics.pixels == 0 {
        "no pixel asks a map".into()
    } else {
        format!(
            "m, in pixels to a texel: median {:.2}, 95 % below {:.2}, at most {:.2}; above 1 in {:.1} % of {} pixels, without {} that the light grazes; {:.1} % of the map's texels are seen by none",
            statistics.median,
            statistics.percentile_95,
            statistics.max,
            100.0 * statistics.share_above_one(),
            statistics.pixels,
            statistics.grazing,
            100.0 * statistics.waste(),
        )
    };
    Ok((pixels, format!("{STRETCH_LEGEND}; {numbers}")))
}

/// A frame as one light sees it.
struct SeenLight<'a> {
    job: &'a Job,
    plan: &'a FramePlan,
    light: usize,
    frame: &'a Frame,
}

impl SeenLight<'_> {
    /// The pixels of a view, and what they mean; `None` if the frame lacks a layer.
    fn explain(&self, view: DebugView) -> Option<(Vec<[u8; 3]>, String)> {
        let triangles = self.frame.triangles()?;
        let colors = self.frame.color()?;
        let maps = FrameMaps::of(self.frame, self.plan)?;
        let width = self.plan.camera.width as usize;
        let light = &self.plan.lights[self.light];
        let receivers = triangles.iter().enumerate().map(|(pixel, &triangle)| {
            let place = [(pixel % width) as u32, (pixel / width) as u32];
            (triangle != NO_TRIANGLE).then(|| self.job.scene.receiver(triangle, &self.plan.camera.rays, place))
        });
        Some(match view {
            DebugView::Texels => {
                let dimmed = receivers.zip(colors).map(|(receiver, color)| {
                    let found = receiver.map(|receiver| lookup(light, &self.plan.views, &receiver));
                    let is_dark = found.is_some_and(|found| {
                        let [x, y] = found.texel.floor().to_array();
                        found.view != NO_VIEW && (x as i64 + y as i64) % 2 != 0
                    });
                    let share = if is_dark { DARKER_TEXEL } else { 1.0 };
                    encode_color([color[0] * share, color[1] * share, color[2] * share, 1.0])
                });
                (dimmed.collect(), "texels of the map are light and dark in turn".into())
            }
            DebugView::DistanceMatch => {
                let matched = receivers.zip(colors).map(|(receiver, &color)| {
                    let Some(receiver) = receiver else { return encode_color(color) };
                    self.match_color(light, &receiver, &maps).unwrap_or([40; 3])
                });
                let legend = "green is where the map's distance is the surface's own, blue where something is nearer to the light, red where the map has something farther, grey where no map is asked";
                (matched.collect(), legend.into())
            }
            DebugView::Taps => {
                let counts: Vec<u32> = receivers
                    .map(|receiver| {
                        let Some(receiver) = receiver else { return 0 };
                        let found = lookup(light, &self.plan.views, &receiver);
                        let mut count = 0;
                        if found.view != NO_VIEW {
                            for_each_weighted_tap(light, &found, |_| count += 1);
                        }
                        count
                    })
                    .collect();
                let most = counts.iter().copied().max().unwrap_or(0);
                let pixels = counts.iter().map(|&count| heat(count as f32 / most.max(1) as f32)).collect();
                (pixels, format!("black is 0 tests, white {most}"))
            }
            _ => {
                let metres: Vec<f32> =
                    receivers.map(|receiver| receiver.map_or(0.0, |receiver| self.bias_metres(light, &receiver))).collect();
                // The few that are seen edge-on would leave everything else dark.
                let mut sorted: Vec<f32> = metres.iter().copied().filter(|&metres| metres > 0.0 && metres.is_finite()).collect();
                sorted.sort_unstable_by(f32::total_cmp);
                let high = sorted.get(sorted.len() * HIGH_PERCENT / 100).copied().unwrap_or(0.0);
                let most = sorted.last().copied().unwrap_or(0.0);
                let pixels = metres.iter().map(|metres| heat(metres / high.max(f32::MIN_POSITIVE))).collect();
                (
                    pixels,
                    format!(
                        "black is no bias, white {high} m and more; the most is {most} m; casters that are drawn deeper and what is read off the map are not part of it"
                    ),
                )
            }
        })
    }

    /// Whether the map's depth at a receiver is its own; `None` where no map is asked.
    fn match_color(&self, light: &LightPlan, receiver: &Receiver, maps: &FrameMaps<'_>) -> Option<[u8; 3]> {
        let plain = LightPlan { bias: BIAS_NONE, ..*light };
        let found = lookup(&plain, &self.plan.views, receiver);
        let view = self.plan.views.get(found.view as usize)?;
        let last = view.rect[2].min(view.rect[3]) as f32 - 1.0;
        let texel = found.texel.clamp(Vec2::ZERO, Vec2::splat(last));
        let stored = comparable_depth(view, maps.fetch_texel(view.layer, texel.x as u32, texel.y as u32));
        // As much as the receiver's own plane may change over the taps of its filter, and no more, counts as the same.
        let needing = LightPlan { bias: BIAS_AUTOMATIC, slope_scale: 1.0, ..*light };
        let w = row_times_point(view.clip_w, receiver.point);
        let sides = footprint(&needing, view, receiver, w);
        let needed = needed_depth(&needing, view, receiver.point, receiver.normal, w, sides);
        let needed = linear_bias(view, w, needed.min(1.0));
        let difference = found.depth - stored;
        Some(if difference.abs() <= needed {
            [30, 200, 60]
        } else if difference > 0.0 {
            [40, 70, 190]
        } else {
            [210, 50, 40]
        })
    }

    /// How far before a receiver its own depth is compared, in metres along the axis of the view, and how far its lookup is moved along the normal: both together.
    fn bias_metres(&self, light: &LightPlan, receiver: &Receiver) -> f32 {
        let found: Lookup = lookup(light, &self.plan.views, receiver);
        let Some(view) = self.plan.views.get(found.view as usize) else { return 0.0 };
        let w = row_times_point(view.clip_w, receiver.point);
        let normal = unit_normal(receiver.normal);
        let sides = footprint(light, view, receiver, w);
        let needed = needed_depth(light, view, receiver.point, receiver.normal, w, sides);
        let moved =
            normal_offset(light, view, receiver.point, normal, needed, w) + normal_step(light, view, receiver.point, normal, w);
        let linear = view.depth_kind == DEPTH_LINEAR;
        let along = if linear {
            found.bias / view.linear_scale
        } else {
            view.metres_of_depth(receiver.point.as_dvec3(), f64::from(found.bias)) as f32
        };
        moved + along
    }
}
