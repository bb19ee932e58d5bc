//! Layers as pictures that a person can read.

use std::io::{self, Write};

use glam::{Vec4, Vec4Swizzles};
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use shadow_math::{
    depth::{DEPTH_LINEAR, DEPTH_REVERSED},
    srgb::encode_pixel,
};
use shadow_scene::{FramePlan, Layer, LayerName, NO_TRIANGLE, Pixels};

/// The grey of the farthest distance: dark, and yet not the black of nothing at all.
const FARTHEST_GREY: f64 = 40.0;
/// The grey of the smallest difference: dark, and yet plain beside the black of equality.
const SMALLEST_DIFFERENCE_GREY: f64 = 64.0;

/// An 8-bit picture, rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Picture {
    width: u32,
    height: u32,
    samples: Samples,
}

/// The samples of a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Samples {
    /// One byte a pixel.
    Grey(Vec<u8>),
    /// Red, green and blue, sRGB.
    Rgb(Vec<[u8; 3]>),
}

impl Picture {
    /// Writes the picture as PNG.
    pub(crate) fn write_png(&self, file: impl Write) -> io::Result<()> {
        let (bytes, color) = match &self.samples {
            Samples::Grey(bytes) => (bytes.as_slice(), ExtendedColorType::L8),
            Samples::Rgb(pixels) => (pixels.as_flattened(), ExtendedColorType::Rgb8),
        };
        PngEncoder::new(file).write_image(bytes, self.width, self.height, color).map_err(io::Error::other)
    }

    /// A picture of these colours, sRGB, rows from the top: as many as its size says.
    pub(crate) fn of_pixels(width: u32, height: u32, pixels: Vec<[u8; 3]>) -> Self {
        Self { width, height, samples: Samples::Rgb(pixels) }
    }

    /// The pixel at a place from 0 to 1 on each axis, rows from the top.
    pub(crate) fn nearest(&self, x: f64, y: f64) -> [u8; 3] {
        let at = |share: f64, size: u32| ((share * f64::from(size)) as u32).min(size.saturating_sub(1));
        let index = at(y, self.height) as usize * self.width as usize + at(x, self.width) as usize;
        match &self.samples {
            Samples::Grey(bytes) => [bytes[index]; 3],
            Samples::Rgb(pixels) => pixels[index],
        }
    }

    fn grey(layer: &Layer, bytes: impl Iterator<Item = u8>) -> Self {
        Self { width: layer.width, height: layer.height, samples: Samples::Grey(bytes.collect()) }
    }

    fn rgb(layer: &Layer, pixels: impl Iterator<Item = [u8; 3]>) -> Self {
        Self { width: layer.width, height: layer.height, samples: Samples::Rgb(pixels.collect()) }
    }
}

/// The pictures of the same layer of one or more frames of a plan, all on the scale of their common range.
///
/// Colour is sRGB; visibility is grey, black where shadowed; depth and shadow maps are grey, white at the nearest distance and dark at
/// the farthest, black where there is nothing; triangles have a colour each, chosen by their index.
pub(crate) fn pictures<const N: usize>(layers: [&Layer; N], plan: &FramePlan) -> [Picture; N] {
    let scale = DistanceScale::of(&layers, plan);
    layers.map(|layer| match &layer.pixels {
        Pixels::Rgba(values) => Picture::rgb(layer, values.iter().map(|&color| encode_color(color))),
        Pixels::Id(values) => Picture::rgb(layer, values.iter().map(|&triangle| triangle_color(triangle))),
        Pixels::Float(values) => match &scale {
            Some(scale) => Picture::grey(layer, values.iter().map(|&depth| scale.grey(depth))),
            None => Picture::grey(layer, values.iter().map(|&visibility| unit_grey(visibility))),
        },
    })
}

/// The picture of where two frames differ in a layer, and by how much.
///
/// It is black where all bits are equal and at least dark grey where they are not; white is the largest difference of the layer, and
/// the only one where triangles differ or a value is not a number. Colour differs channel by channel; alpha counts for all three.
/// Layers that are not of the same kind differ everywhere.
pub(crate) fn difference(first: &Layer, second: &Layer) -> Picture {
    match (&first.pixels, &second.pixels) {
        (Pixels::Float(a), Pixels::Float(b)) => {
            let differences: Vec<f64> = a.iter().zip(b).map(|(&a, &b)| float_difference(a, b)).collect();
            let largest = largest_finite(&differences);
            Picture::grey(first, differences.into_iter().map(|difference| amplify(difference, largest)))
        }
        (Pixels::Rgba(a), Pixels::Rgba(b)) => {
            let channels = |(a, b): (&[f32; 4], &[f32; 4])| {
                let alpha = float_difference(a[3], b[3]);
                [0, 1, 2].map(|channel| float_difference(a[channel], b[channel]).max(alpha))
            };
            let differences: Vec<[f64; 3]> = a.iter().zip(b).map(channels).collect();
            let largest = largest_finite(differences.as_flattened());
            Picture::rgb(first, differences.into_iter().map(|pixel| pixel.map(|difference| amplify(difference, largest))))
        }
        (Pixels::Id(a), Pixels::Id(b)) => Picture::grey(first, a.iter().zip(b).map(|(a, b)| if a == b { 0 } else { 255 })),
        _ => Picture::grey(first, (0..first.pixels.len()).map(|_| 255)),
    }
}

/// A linear colour as sRGB.
pub(crate) fn encode_color(color: [f32; 4]) -> [u8; 3] {
    let [red, green, blue, _] = encode_pixel(Vec4::from_array(color));
    [red, green, blue]
}

/// A value from 0 to 1 as a grey; NaN is black.
fn unit_grey(value: f32) -> u8 {
    (value * 255.0).round() as u8
}

/// A colour that tells a triangle from its neighbours; black for none.
fn triangle_color(triangle: u32) -> [u8; 3] {
    if triangle == NO_TRIANGLE {
        return [0; 3];
    }
    // Fibonacci hashing: consecutive indices land far apart. No channel is dark, so that no triangle looks like nothing.
    let [_, red, green, blue] = triangle.wrapping_mul(0x9e37_79b9).to_be_bytes();
    [red, green, blue].map(|channel| 64 + channel / 4 * 3)
}

/// How distances become greys.
#[derive(Debug)]
struct DistanceScale {
    /// What the depths mean.
    depth_of_distance: DepthOfDistance,
    /// The depth of pixels where there is nothing.
    empty: f32,
    /// The smallest and the largest value of [`DepthOfDistance::coordinate`] that occurs.
    range: [f64; 2],
}

impl DistanceScale {
    /// The scale of depth layers and shadow maps; `None` for layers that are no distances.
    fn of(layers: &[&Layer], plan: &FramePlan) -> Option<Self> {
        let (clip_z, clip_w, empty) = match layers.first()?.name {
            LayerName::Depth => (plan.camera.clip_z, plan.camera.clip_w, 0.0),
            LayerName::ShadowMap { light, view } => {
                let view = plan.views_of(light as usize).get(view as usize)?;
                let empty = if view.depth_kind == DEPTH_REVERSED { 0.0 } else { 1.0 };
                if view.depth_kind == DEPTH_LINEAR {
                    return Some(Self::with(DepthOfDistance::Linear { sign: 1.0 }, layers, empty));
                }
                (view.clip_z, view.clip_w, empty)
            }
            _ => return None,
        };
        let depth_of_distance = DepthOfDistance::new(Vec4::from_array(clip_z), Vec4::from_array(clip_w), empty == 0.0);
        Some(Self::with(depth_of_distance, layers, empty))
    }

    /// The scale over all distances that occur.
    fn with(depth_of_distance: DepthOfDistance, layers: &[&Layer], empty: f32) -> Self {
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        for layer in layers {
            let Pixels::Float(values) = &layer.pixels else { continue };
            for &depth in values.iter().filter(|&&depth| depth != empty) {
                let coordinate = depth_of_distance.coordinate(depth);
                if coordinate.is_finite() {
                    range = [range[0].min(coordinate), range[1].max(coordinate)];
                }
            }
        }
        Self { depth_of_distance, empty, range }
    }

    /// White at the nearest distance, dark at the farthest, black where there is nothing or no number.
    fn grey(&self, depth: f32) -> u8 {
        let coordinate = self.depth_of_distance.coordinate(depth);
        if depth == self.empty || coordinate.is_nan() {
            return 0;
        }
        let [nearest, farthest] = self.range;
        let share = if farthest > nearest { ((coordinate - nearest) / (farthest - nearest)).clamp(0.0, 1.0) } else { 0.0 };
        (255.0 + (FARTHEST_GREY - 255.0) * share).round() as u8
    }
}

/// How the depth of a view depends on the distance along its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
enum DepthOfDistance {
    /// Parallel rays: depth is linear in the distance, and grows or falls with it.
    Linear {
        /// 1 if depth grows with the distance, -1 if it falls.
        sign: f64,
    },
    /// Perspective: `depth = limit + factor / distance`.
    Reciprocal {
        /// The depth at infinity.
        limit: f64,
        /// The factor in metres.
        factor: f64,
    },
}

impl DepthOfDistance {
    /// From the z and w rows of the matrix from world to clip space, and whether depth is reversed. w is the distance of a perspective
    /// view, and the direction of the z row is then a multiple of that of the w row.
    fn new(clip_z: Vec4, clip_w: Vec4, is_reversed: bool) -> Self {
        let (z, w) = (clip_z.as_dvec4(), clip_w.as_dvec4());
        let axis = w.xyz();
        if axis.length_squared() == 0.0 {
            return Self::Linear { sign: if is_reversed { -1.0 } else { 1.0 } };
        }
        let limit = z.xyz().dot(axis) / axis.length_squared();
        Self::Reciprocal { limit, factor: z.w - limit * w.w }
    }

    /// A coordinate that grows with the distance: the logarithm of the distance for perspective, the depth itself for parallel rays.
    fn coordinate(self, depth: f32) -> f64 {
        let depth = f64::from(depth);
        match self {
            Self::Linear { sign } => sign * depth,
            Self::Reciprocal { limit, factor } => (factor / (depth - limit)).ln(),
        }
    }
}

/// How much two numbers differ; 0 only if all bits are equal, infinite if just one is a number.
fn float_difference(a: f32, b: f32) -> f64 {
    if a.to_bits() == b.to_bits() {
        return 0.0;
    }
    let difference = (f64::from(a) - f64::from(b)).abs();
    if difference.is_nan() { f64::INFINITY } else { difference.max(f64::MIN_POSITIVE) }
}

/// The largest difference that is finite.
fn largest_finite(differences: &[f64]) -> f64 {
    differences.iter().copied().filter(|difference| difference.is_finite()).fold(0.0, f64::max)
}

/// The grey of a difference, as a share of the largest.
fn amplify(difference: f64, largest: f64) -> u8 {
    if difference == 0.0 {
        return 0;
    }
    if !difference.is_finite() {
        return 255;
    }
    (SMALLEST_DIFFERENCE_GREY + (255.0 - SMALLEST_DIFFERENCE_GREY) * (difference / largest)).round() as u8
}

#[cfg(test)]
mod tests {
    use shadow_math::{ShadowSettings, exposure::Exposure, plan::plan_camera};
    use shadow_scene::builtin;

    use super::*;

    fn layer(name: LayerName, width: u32, pixels: Pixels) -> Layer {
        let height = pixels.len() as u32 / width;
        Layer { name, width, height, pixels }
    }

    fn demo_plan() -> FramePlan {
        let scene = builtin::demo();
        FramePlan::new(&scene, &scene.cameras()[0].camera, &ShadowSettings::default(), 16, 9, None).unwrap()
    }

    fn grey(picture: &Picture) -> &[u8] {
        match &picture.samples {
            Samples::Grey(bytes) => bytes,
            Samples::Rgb(_) => panic!("not grey"),
        }
    }

    #[test]
    fn visibility_is_black_in_shadow_and_white_in_light() {
        let visibility = layer(LayerName::Visibility { light: 0 }, 4, Pixels::Float(vec![0.0, 1.0, 0.5, f32::NAN]));
        let [picture] = pictures([&visibility], &demo_plan());
        assert_eq!(grey(&picture), [0, 255, 128, 0]);
    }

    #[test]
    fn near_is_bright_far_is_dark_and_nothing_is_black() {
        let plan = demo_plan();
        // The depth at a distance, by the camera's own rows: a point straight ahead of the eye.
        let (z, w) = (Vec4::from_array(plan.camera.clip_z), Vec4::from_array(plan.camera.clip_w));
        let eye = Vec4::from_array(plan.camera.rays.origin).truncate();
        let depth_at = |distance: f32| {
            let point = (eye + distance * w.truncate()).extend(1.0);
            z.dot(point) / w.dot(point)
        };
        let depths = vec![depth_at(2.0), depth_at(8.0), depth_at(4.0), 0.0];
        let [picture] = pictures([&layer(LayerName::Depth, 2, Pixels::Float(depths))], &plan);
        let greys = grey(&picture);
        assert_eq!((greys[0], greys[1], greys[3]), (255, FARTHEST_GREY as u8, 0));
        // 4 m is halfway between 2 m and 8 m on a logarithmic scale.
        assert!(greys[2].abs_diff(148) <= 1, "{greys:?}");
    }

    #[test]
    fn reversed_depth_of_parallel_rays_keeps_near_bright() {
        let projection = shadow_math::Projection::Orthographic { half_height: 1.0, near: 0.0, far: 10.0 };
        let camera = shadow_math::Camera { projection, ..builtin::demo().cameras()[0].camera };
        let plan = FramePlan { camera: plan_camera(&camera, 2, 2, Exposure::default(), 1).unwrap(), ..demo_plan() };
        let [picture] = pictures([&layer(LayerName::Depth, 2, Pixels::Float(vec![0.9, 0.1, 0.5, 0.0]))], &plan);
        assert_eq!(grey(&picture), [255, 40, 148, 0]);
    }

    #[test]
    fn a_shadow_map_spreads_what_it_holds_and_leaves_the_rest_black() {
        let name = LayerName::ShadowMap { light: 0, view: 0 };
        let [picture] = pictures([&layer(name, 4, Pixels::Float(vec![0.25, 0.75, 1.0, 0.5]))], &demo_plan());
        assert_eq!(grey(&picture), [255, 40, 0, 148]);
        // A map that holds one depth only, or none, has no range to spread.
        let [flat, empty] =
            pictures([&layer(name, 1, Pixels::Float(vec![0.5])), &layer(name, 1, Pixels::Float(vec![1.0]))], &demo_plan());
        assert_eq!((grey(&flat), grey(&empty)), (&[255][..], &[0][..]));
    }

    #[test]
    fn frames_share_one_scale() {
        let name = LayerName::ShadowMap { light: 0, view: 0 };
        let first = layer(name, 2, Pixels::Float(vec![0.2, 0.4]));
        let second = layer(name, 2, Pixels::Float(vec![0.2, 0.6]));
        let [first, second] = pictures([&first, &second], &demo_plan());
        assert_eq!(grey(&first)[0], grey(&second)[0]);
        assert!(grey(&first)[1] > grey(&second)[1]);
    }

    #[test]
    fn differences_are_black_only_where_all_bits_are_equal() {
        let name = LayerName::Visibility { light: 0 };
        let first = layer(name, 5, Pixels::Float(vec![0.5, 0.5, 0.0, 0.5, f32::NAN]));
        let second = layer(name, 5, Pixels::Float(vec![0.5, 0.5 + f32::EPSILON, -0.0, 0.0, f32::NAN]));
        assert_eq!(grey(&difference(&first, &second)), [0, 64, 64, 255, 0]);
        let third = layer(name, 5, Pixels::Float(vec![f32::NAN; 5]));
        assert_eq!(grey(&difference(&first, &third)), [255, 255, 255, 255, 0]);
    }

    #[test]
    fn a_difference_in_alpha_alone_shows() {
        let first = layer(LayerName::Color, 2, Pixels::Rgba(vec![[0.1, 0.2, 0.3, 1.0], [0.0; 4]]));
        let second = layer(LayerName::Color, 2, Pixels::Rgba(vec![[0.1, 0.2, 0.3, 0.5], [0.0, 0.25, 0.0, 0.0]]));
        let picture = difference(&first, &second);
        assert_eq!(picture.samples, Samples::Rgb(vec![[255; 3], [0, 160, 0]]));
    }

    #[test]
    fn triangles_differ_or_not() {
        let first = layer(LayerName::Triangle, 2, Pixels::Id(vec![1, NO_TRIANGLE]));
        let second = layer(LayerName::Triangle, 2, Pixels::Id(vec![1, 0]));
        assert_eq!(grey(&difference(&first, &second)), [0, 255]);
        assert_eq!(triangle_color(NO_TRIANGLE), [0; 3]);
        assert_ne!(triangle_color(0), triangle_color(1));
    }

    #[test]
    fn what_is_written_can_be_read() {
        let colors = layer(LayerName::Color, 2, Pixels::Rgba(vec![[1.0, 0.0, 0.0, 1.0], [0.0, 0.18, 9.0, 1.0]]));
        let [picture] = pictures([&colors], &demo_plan());
        let mut png = Vec::new();
        picture.write_png(&mut png).unwrap();
        let read = image::load_from_memory(&png).unwrap().into_rgb8();
        assert_eq!((read.dimensions(), read.as_raw().as_slice()), ((2, 1), &[255, 0, 0, 0, 118, 255][..]));
    }
}
