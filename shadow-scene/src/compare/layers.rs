//! The comparison itself, layer by layer.

use glam::{DVec3, Vec4};
use shadow_math::{
    Receiver,
    depth::{DEPTH_LINEAR, comparable_depth},
    filter::{
        stored_gradient, tap_depth,
        taps::{for_each_test_place, for_each_weighted_tap},
    },
    plan::{BIAS_RECEIVER_GRADIENT, ViewPlan},
    srgb::encode_pixel,
    vector::row_times_point,
    visibility::{Lookup, NO_VIEW, choose_views, lookup_in_view},
};

use super::{CompareError, Comparison, Contract, LayerComparison, LeftOut, tolerance};
use crate::{
    frame::{Frame, FrameMaps, Layer, LayerName, NO_TRIANGLE, Pixels},
    frame_plan::FramePlan,
    scene::Scene,
};

/// Compares two frames of the same scene and plan.
///
/// # Errors
///
/// [`CompareError`] where there is nothing to compare, or the frames do not have the same layers in the same sizes. The tolerance contract
/// also needs the triangle, depth and map layers to say where visibility may differ.
pub fn compare(
    first: &Frame,
    second: &Frame,
    scene: &Scene,
    plan: &FramePlan,
    contract: Contract,
) -> Result<Comparison, CompareError> {
    if first.source == second.source {
        return Err(CompareError::SameSource(first.source.clone()));
    }
    let pairs = pair_layers(first, second)?;
    let layers = match contract {
        Contract::Exact => pairs.iter().map(|&(a, b)| exact(a, b)).collect(),
        Contract::Tolerance => {
            let judge = Judge { first, second, scene, plan };
            pairs.iter().map(|&(a, b)| judge.layer(a, b)).collect::<Result<_, _>>()?
        }
    };
    Ok(Comparison { contract, layers })
}

/// The layers of both frames side by side, checked to be comparable.
fn pair_layers<'a>(first: &'a Frame, second: &'a Frame) -> Result<Vec<(&'a Layer, &'a Layer)>, CompareError> {
    if first.layers.is_empty() && second.layers.is_empty() {
        return Err(CompareError::Empty);
    }
    if let Some(extra) = second.layers.iter().find(|layer| first.layer(layer.name).is_none()) {
        return Err(CompareError::Missing { name: extra.name, which: "second" });
    }
    first
        .layers
        .iter()
        .map(|a| {
            let name = a.name;
            let b = second.layer(name).ok_or(CompareError::Missing { name, which: "first" })?;
            if (a.width, a.height) != (b.width, b.height) {
                return Err(CompareError::Size { name, first: (a.width, a.height), second: (b.width, b.height) });
            }
            let count = a.width as usize * a.height as usize;
            let same_kind = core::mem::discriminant(&a.pixels) == core::mem::discriminant(&b.pixels);
            if !same_kind || a.pixels.len() != count || b.pixels.len() != count || count == 0 {
                return Err(CompareError::Values { name });
            }
            Ok((a, b))
        })
        .collect()
}

/// The bytes of one pixel of a layer.
fn bytes_per_pixel(pixels: &Pixels) -> usize {
    match pixels {
        Pixels::Float(_) | Pixels::Id(_) => 4,
        Pixels::Rgba(_) => 16,
    }
}

fn count_differing(a: &Layer, b: &Layer) -> usize {
    let size = bytes_per_pixel(&a.pixels);
    a.pixels.as_bytes().chunks_exact(size).zip(b.pixels.as_bytes().chunks_exact(size)).filter(|(a, b)| a != b).count()
}

/// The distance of two values: infinite where only one of them is a number.
fn distance(a: f32, b: f32) -> f64 {
    if a.to_bits() == b.to_bits() {
        return 0.0;
    }
    let difference = (f64::from(a) - f64::from(b)).abs();
    if difference.is_nan() { f64::INFINITY } else { difference }
}

fn exact(a: &Layer, b: &Layer) -> LayerComparison {
    let differing = count_differing(a, b);
    let max_difference = match (&a.pixels, &b.pixels) {
        (Pixels::Float(a), Pixels::Float(b)) => largest(a.iter().zip(b).map(|(&a, &b)| distance(a, b))),
        (Pixels::Rgba(a), Pixels::Rgba(b)) => largest(a.iter().flatten().zip(b.iter().flatten()).map(|(&a, &b)| distance(a, b))),
        _ => f64::from(u8::from(differing > 0)),
    };
    LayerComparison {
        name: a.name,
        pixels: a.pixels.len(),
        differing,
        left_out: LeftOut::default(),
        max_difference,
        violations: differing,
        within_contract: differing == 0,
    }
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, f64::max)
}

/// Judges layers within tolerances.
struct Judge<'a> {
    first: &'a Frame,
    second: &'a Frame,
    scene: &'a Scene,
    plan: &'a FramePlan,
}

/// Collects the verdicts on the pixels of a layer.
#[derive(Default)]
struct Tally {
    left_out: LeftOut,
    /// Ties under a bias that is below the rounding bound: there may be any number of these.
    ties_without_bias: usize,
    max_difference: f64,
    violations: usize,
}

impl Tally {
    fn finish(self, a: &Layer, b: &Layer, allowance: usize) -> LayerComparison {
        let counted = self.left_out.total() - self.ties_without_bias;
        LayerComparison {
            name: a.name,
            pixels: a.pixels.len(),
            differing: count_differing(a, b),
            left_out: self.left_out,
            max_difference: self.max_difference,
            violations: self.violations,
            within_contract: self.violations == 0 && counted <= allowance,
        }
    }
}

/// Why a pixel's visibility may differ.
enum Excuse {
    CameraCoverage,
    MapCoverage,
    Tie { bias_is_below_rounding: bool },
}

impl Judge<'_> {
    fn layer(&self, a: &Layer, b: &Layer) -> Result<LayerComparison, CompareError> {
        match (&a.pixels, &b.pixels) {
            (Pixels::Id(ids_a), Pixels::Id(ids_b)) => self.triangles(a, b, ids_a, ids_b),
            (Pixels::Float(values_a), Pixels::Float(values_b)) => match a.name {
                LayerName::Visibility { light } => self.visibility(a, b, light, values_a, values_b),
                LayerName::Depth => self.depth(a, b, values_a, values_b),
                _ => Ok(self.map(a, b, values_a, values_b)),
            },
            (Pixels::Rgba(colors_a), Pixels::Rgba(colors_b)) => self.color(a, b, colors_a, colors_b),
            _ => Err(CompareError::Values { name: a.name }),
        }
    }

    fn needed(&self, name: LayerName, needed: LayerName) -> Result<(&[f32], &[f32]), CompareError> {
        match (self.first.floats(needed), self.second.floats(needed)) {
            (Some(a), Some(b)) => Ok((a, b)),
            _ => Err(CompareError::Needs { name, needed }),
        }
    }

    fn needed_triangles(&self, name: LayerName) -> Result<(&[u32], &[u32]), CompareError> {
        match (self.first.triangles(), self.second.triangles()) {
            (Some(a), Some(b)) => Ok((a, b)),
            _ => Err(CompareError::Needs { name, needed: LayerName::Triangle }),
        }
    }

    /// Different triangles are allowed within a sub-pixel step of an edge of either, and where both surfaces are equally deep.
    fn triangles(&self, a: &Layer, b: &Layer, ids_a: &[u32], ids_b: &[u32]) -> Result<LayerComparison, CompareError> {
        let (depth_a, depth_b) = self.needed(a.name, LayerName::Depth)?;
        let mut tally = Tally::default();
        for (i, (&id_a, &id_b)) in ids_a.iter().zip(ids_b).enumerate() {
            if id_a == id_b {
                continue;
            }
            let both_seen = id_a != NO_TRIANGLE && id_b != NO_TRIANGLE;
            let equally_deep = both_seen && distance(depth_a[i], depth_b[i]) <= tolerance::DEPTH;
            let (x, y) = (i as u32 % a.width, i as u32 / a.width);
            if equally_deep || self.is_at_edge(id_a, x, y) || self.is_at_edge(id_b, x, y) {
                tally.left_out.camera_coverage += 1;
            } else {
                tally.violations += 1;
                tally.max_difference = 1.0;
            }
        }
        Ok(tally.finish(a, b, tolerance::coverage_allowance(ids_a.len())))
    }

    /// Whether the centre of a pixel lies within a sub-pixel step of the line through an edge of a triangle.
    fn is_at_edge(&self, triangle: u32, x: u32, y: u32) -> bool {
        let Some(corners) = self.scene.triangles().get(triangle as usize) else { return false };
        let camera = &self.plan.camera;
        // Homogeneous pixel coordinates; the line through two of them is their product, wherever the eye is.
        let pixel = corners.map(|corner| {
            let point = self.scene.vertices().positions[corner as usize];
            let row = |row| f64::from(row_times_point(row, point));
            let w = row(camera.clip_w);
            let half = (0.5 * f64::from(camera.width), 0.5 * f64::from(camera.height));
            DVec3::new(row(camera.clip_x) * half.0 + w * half.0, w * half.1 - row(camera.clip_y) * half.1, w)
        });
        let center = DVec3::new(f64::from(x) + 0.5, f64::from(y) + 0.5, 1.0);
        (0..3).any(|i| {
            let line = pixel[i].cross(pixel[(i + 1) % 3]);
            line.dot(center).abs() <= tolerance::SUBPIXEL_STEP * core::f64::consts::SQRT_2 * line.truncate().length()
        })
    }

    /// Camera depths agree where the triangles do.
    fn depth(&self, a: &Layer, b: &Layer, values_a: &[f32], values_b: &[f32]) -> Result<LayerComparison, CompareError> {
        let (ids_a, ids_b) = self.needed_triangles(a.name)?;
        let mut tally = Tally::default();
        for i in 0..values_a.len() {
            if ids_a[i] != ids_b[i] {
                tally.left_out.camera_coverage += 1;
                continue;
            }
            let difference = distance(values_a[i], values_b[i]);
            tally.max_difference = tally.max_difference.max(difference);
            tally.violations += usize::from(difference > depth_tolerance(values_a, values_b, a.width, i));
        }
        Ok(tally.finish(a, b, tolerance::coverage_allowance(values_a.len())))
    }

    /// Depths of a map agree but at a few texels, whose coverage is taken to differ.
    fn map(&self, a: &Layer, b: &Layer, values_a: &[f32], values_b: &[f32]) -> LayerComparison {
        let view = self.view_of(a.name);
        let mut tally = Tally::default();
        for i in 0..values_a.len() {
            let difference = distance(values_a[i], values_b[i]);
            if difference == f64::INFINITY {
                tally.violations += 1;
                tally.max_difference = difference;
            } else if difference > map_tolerance(view, values_a, values_b, a.width, i) {
                tally.left_out.map_coverage += 1;
            } else {
                tally.max_difference = tally.max_difference.max(difference);
            }
        }
        tally.finish(a, b, tolerance::coverage_allowance(values_a.len()))
    }

    /// The view that a map is of.
    fn view_of(&self, name: LayerName) -> Option<&ViewPlan> {
        let LayerName::ShadowMap { light, view } = name else { return None };
        self.plan.views.get((self.plan.lights.get(light as usize)?.first_view + view) as usize)
    }

    fn visibility(
        &self,
        a: &Layer,
        b: &Layer,
        light: u32,
        values_a: &[f32],
        values_b: &[f32],
    ) -> Result<LayerComparison, CompareError> {
        let (ids_a, ids_b) = self.needed_triangles(a.name)?;
        let mut tally = Tally::default();
        for i in 0..values_a.len() {
            let difference = distance(values_a[i], values_b[i]);
            if difference > f64::from(tolerance::VISIBILITY) && difference.is_finite() {
                let excuse = if ids_a[i] != ids_b[i] {
                    Some(Excuse::CameraCoverage)
                } else {
                    self.excuse(light, ids_a[i], i as u32 % a.width, i as u32 / a.width)?
                };
                match excuse {
                    Some(Excuse::CameraCoverage) => tally.left_out.camera_coverage += 1,
                    Some(Excuse::MapCoverage) => tally.left_out.map_coverage += 1,
                    Some(Excuse::Tie { bias_is_below_rounding }) => {
                        tally.left_out.tie += 1;
                        tally.ties_without_bias += usize::from(bias_is_below_rounding);
                    }
                    None => {
                        tally.violations += 1;
                        tally.max_difference = tally.max_difference.max(difference);
                    }
                }
            } else {
                tally.violations += usize::from(difference == f64::INFINITY);
                tally.max_difference = tally.max_difference.max(difference);
            }
        }
        Ok(tally.finish(a, b, tolerance::left_out_allowance(values_a.len())))
    }

    /// Why the visibility of a pixel that shows the same triangle in both frames may differ, from its taps; `None` if it may not.
    fn excuse(&self, light: u32, triangle: u32, x: u32, y: u32) -> Result<Option<Excuse>, CompareError> {
        if triangle == NO_TRIANGLE {
            return Ok(None);
        }
        let receiver = self.scene.receiver(triangle, &self.plan.camera.rays, [x, y]);
        let plan = &self.plan.lights[light as usize];
        let choice = choose_views(plan, &self.plan.views, &receiver);
        // Between two cascades both count.
        let asked = [Some(choice.first), (choice.share > 0.0).then_some(choice.second)];
        for index in asked.into_iter().flatten().filter(|index| *index != NO_VIEW) {
            let found = lookup_in_view(plan, &self.plan.views[index as usize], index, &receiver);
            if let Some(excuse) = self.excuse_of_lookup(light, &receiver, &found)? {
                return Ok(Some(excuse));
            }
        }
        Ok(None)
    }

    /// Why what a lookup finds may differ.
    fn excuse_of_lookup(&self, light: u32, receiver: &Receiver, found: &Lookup) -> Result<Option<Excuse>, CompareError> {
        if found.view == NO_VIEW {
            return Ok(None);
        }
        let plan = &self.plan.lights[light as usize];
        let view = &self.plan.views[found.view as usize];
        let name = LayerName::ShadowMap { light, view: found.view - plan.first_view };
        let (map_a, map_b) = self.needed(LayerName::Visibility { light }, name)?;
        let size = self.plan.map_size;
        let inside = |v: i32| v >= 0 && v < view.rect[2] as i32;
        let mut taps = Vec::new();
        for_each_weighted_tap(plan, found, |tap| taps.push(tap));
        // The bias that is read off the maps may differ with them.
        let read_off = |frame| {
            let maps = FrameMaps::of(frame, self.plan).filter(|_| plan.bias & BIAS_RECEIVER_GRADIENT != 0);
            maps.map_or(0.0, |maps| f64::from(stored_gradient(&maps, view, plan, found.texel)))
        };
        let (bias_a, bias_b) = (read_off(self.first), read_off(self.second));
        let mut tie = false;
        for tap in taps.iter().filter(|tap| inside(tap.x) && inside(tap.y)) {
            let index = tap.y as usize * size as usize + tap.x as usize;
            let allowed = map_tolerance(Some(view), map_a, map_b, size, index);
            if distance(map_a[index], map_b[index]) > allowed {
                return Ok(Some(Excuse::MapCoverage));
            }
            let compared = f64::from(tap_depth(plan, view, found, tap.x, tap.y)) - f64::from(found.bias) - bias_a;
            let margin = compared - f64::from(comparable_depth(view, map_a[index]));
            tie |= margin.abs() <= allowed + (bias_a - bias_b).abs();
        }
        let w = row_times_point(view.clip_w, receiver.point);
        let reach = tolerance::TEXEL_BORDER.max(view.rounding_texels[0] + view.rounding_texels[1] / w);
        let border = |coordinate: f32| (coordinate - coordinate.round()).abs() < reach;
        // Bilinear and separable filters are continuous over a texel's border; a single test is not.
        for_each_test_place(plan, found, |place| tie |= border(place.x) || border(place.y));
        let rounding = view.rounding_depth[0] + view.rounding_depth[1] / w;
        Ok(tie.then_some(Excuse::Tie { bias_is_below_rounding: found.bias < rounding }))
    }

    /// Colours agree in 8 bits but where the camera's coverage differs, or the comparison of a light's visibility leaves the pixel out.
    fn color(&self, a: &Layer, b: &Layer, colors_a: &[[f32; 4]], colors_b: &[[f32; 4]]) -> Result<LayerComparison, CompareError> {
        let (ids_a, ids_b) = self.needed_triangles(a.name)?;
        let visibilities = (0..self.plan.lights.len() as u32)
            .map(|light| self.needed(a.name, LayerName::Visibility { light }))
            .collect::<Result<Vec<_>, _>>()?;
        let mut tally = Tally::default();
        for i in 0..colors_a.len() {
            let numbers_differ = colors_a[i].iter().zip(&colors_b[i]).any(|(a, b)| a.is_nan() != b.is_nan());
            let (pixel_a, pixel_b) = (encode_pixel(Vec4::from(colors_a[i])), encode_pixel(Vec4::from(colors_b[i])));
            let alpha = distance(colors_a[i][3], colors_b[i][3]);
            let steps = pixel_a.iter().zip(&pixel_b).map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0);
            let difference = if numbers_differ { f64::INFINITY } else { (f64::from(steps) / 255.0).max(alpha) };
            if difference <= f64::from(tolerance::COLOR_STEPS) / 255.0 {
                tally.max_difference = tally.max_difference.max(difference);
            } else if ids_a[i] != ids_b[i] && difference.is_finite() {
                tally.left_out.camera_coverage += 1;
            } else if let Some(excuse) =
                self.excuse_of_light(&visibilities, ids_a[i], i, a.width)?.filter(|_| difference.is_finite())
            {
                tally.left_out.tie += 1;
                tally.ties_without_bias += usize::from(matches!(excuse, Excuse::Tie { bias_is_below_rounding: true }));
            } else {
                tally.violations += 1;
                tally.max_difference = tally.max_difference.max(difference);
            }
        }
        // Each light may leave out pixels of its own.
        Ok(tally.finish(a, b, tolerance::left_out_allowance(colors_a.len()) * visibilities.len().max(1)))
    }

    /// Why the comparison of some light's visibility leaves a pixel out, if one does.
    fn excuse_of_light(
        &self,
        visibilities: &[(&[f32], &[f32])],
        triangle: u32,
        pixel: usize,
        width: u32,
    ) -> Result<Option<Excuse>, CompareError> {
        for (light, (a, b)) in (0..).zip(visibilities) {
            let differs = distance(a[pixel], b[pixel]) > f64::from(tolerance::VISIBILITY);
            if differs && let Some(excuse) = self.excuse(light, triangle, pixel as u32 % width, pixel as u32 / width)? {
                return Ok(Some(excuse));
            }
        }
        Ok(None)
    }
}

/// How far two depths at a pixel may lie apart: a fixed part, and a sub-pixel step times the slope that the frames show there.
fn depth_tolerance(first: &[f32], second: &[f32], width: u32, index: usize) -> f64 {
    let slope = slope_at(first, width, index).max(slope_at(second, width, index));
    tolerance::DEPTH + tolerance::SUBPIXEL_STEP * slope
}

/// The same for what a map of a view holds: whole numbers can be a step apart, and linear depth is off by as much more than the reversed depth that it is made of as it changes faster, which is by `w^2 / (near far)`.
fn map_tolerance(view: Option<&ViewPlan>, first: &[f32], second: &[f32], width: u32, index: usize) -> f64 {
    let allowed = depth_tolerance(first, second, width, index);
    let Some(view) = view else { return allowed };
    // What is off by so much as it is drawn is off by as much more as the view's own planes are nearer to each other.
    let drawn = tolerance::DEPTH * f64::from(view.drawn_scale).max(1.0);
    let mut more = drawn - tolerance::DEPTH;
    if view.depth_steps > 0.0 {
        more += 1.0 / f64::from(view.depth_steps);
    }
    if view.depth_kind == DEPTH_LINEAR {
        let [near, far] = view.depth_range.map(f64::from);
        let w = near + (far - near) * f64::from(first[index].max(second[index]).clamp(0.0, 1.0));
        more += drawn * (w * w / (near * far)).max(1.0);
    }
    allowed + more
}

/// The slope of the surface at a pixel, in depth per pixel: on each axis the smaller difference to a neighbour, since the larger one can be the
/// jump of a silhouette; the sum of both axes.
fn slope_at(depths: &[f32], width: u32, index: usize) -> f64 {
    let width = width as usize;
    let x = index % width;
    let step = |neighbor: Option<usize>| {
        let difference = neighbor.and_then(|neighbor| depths.get(neighbor)).map(|&depth| distance(depth, depths[index]));
        difference.filter(|difference| difference.is_finite())
    };
    let axis = |before: Option<usize>, after: Option<usize>| match (step(before), step(after)) {
        (Some(a), Some(b)) => a.min(b),
        (a, b) => a.or(b).unwrap_or(0.0),
    };
    let left = (x > 0).then(|| index - 1);
    let right = (x + 1 < width).then_some(index + 1);
    axis(left, right) + axis(index.checked_sub(width), Some(index + width))
}
