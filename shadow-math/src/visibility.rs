//! The receiver's side: is this point lit?
//!
//! Mirrored by `visibility.wgsl`.

use glam::{Vec2, Vec3};

use crate::{
    bias::{depth_bias, depth_gradient, needed_depth, normal_offset, normal_step, plane_limit},
    depth::{DEPTH_REVERSED, depth_limits, linear_bias, receiver_depth},
    filter::{filtered_test, stored_gradient, turn::turn_of_pixel},
    fit::cube_face_of,
    plan::{
        BIAS_RECEIVER_GRADIENT, BIAS_RECEIVER_PLANE, FILTER_DISC, FILTER_FOOTPRINT, LightPlan, SPLIT_CUBE, ViewPlan, toward_light,
    },
    vector::{row_times_point, row_times_vector, unit_normal},
};

/// The way to the shadow maps.
pub trait MapAccess {
    /// What texel `(x, y)` of a layer holds; where nothing was drawn that is 1, or 0 with reversed depth. Coordinates lie inside the layer.
    fn fetch_texel(&self, layer: u32, x: u32, y: u32) -> f32;
}

/// A point of a surface that asks whether it is lit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receiver {
    /// The point, in metres relative to the scene's origin.
    pub point: Vec3,
    /// The geometric normal of its triangle, turned to the viewer; of any length above 0.
    pub normal: Vec3,
    /// The pixel that shows it, by which discs are turned.
    pub pixel: [u32; 2],
    /// How far the point moves on its plane from a pixel to the next one on the right, and to the next one below, in metres: what a footprint is made of. Other
    /// filters do not look at it.
    pub steps: [Vec3; 2],
}

impl Receiver {
    /// A point of a surface that no pixel shows: its footprint is a point.
    #[must_use]
    pub const fn new(point: Vec3, normal: Vec3) -> Self {
        Self { point, normal, pixel: [0, 0], steps: [Vec3::ZERO; 2] }
    }
}

/// [`Lookup::view`] of a receiver whose visibility is known without a map.
pub const NO_VIEW: u32 = u32::MAX;

/// What a receiver asks of the maps: one comparison depth at one place of one view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lookup {
    /// The index of the view, among all views of the frame; [`NO_VIEW`] if no map is asked.
    pub view: u32,
    /// The answer where no map is asked.
    pub known: f32,
    /// Where, in texels of the view's layer.
    pub texel: Vec2,
    /// The receiver's depth, in the [order](crate::depth::comparable_depth) in which depths are compared.
    pub depth: f32,
    /// The bias.
    pub bias: f32,
    /// The cosine and sine of the angle by which a disc is turned; (1, 0) with other filters.
    pub turn: Vec2,
    /// The sides of the pixel's image in the map, in texels; zero with other filters than the footprint.
    pub footprint: [Vec2; 2],
    /// How depth changes from texel to texel on the receiver's plane, for taps that are compared with that; zero without a receiver plane.
    pub slope: Vec2,
    /// The most that a tap's depth is corrected by.
    pub slope_limit: f32,
}

/// A lookup whose answer is known without a map.
#[inline(always)]
fn known(visibility: f32) -> Lookup {
    Lookup {
        view: NO_VIEW,
        known: visibility,
        texel: Vec2::ZERO,
        depth: 0.0,
        bias: 0.0,
        turn: Vec2::X,
        footprint: [Vec2::ZERO; 2],
        slope: Vec2::ZERO,
        slope_limit: 0.0,
    }
}

/// What a receiver asks of the maps of a light. `views` are all views of the frame.
///
/// The bias may move the lookup away from the receiver, along its normal. Known without a map are: 0 where the surface does not face the light; 1 for a light without views, from which nothing is shadowed, behind the light, nearer than the near plane and outside
/// the map. What lies beyond the far plane is compared at the far plane's depth.
#[inline(always)]
#[must_use]
pub fn lookup(light: &LightPlan, views: &[ViewPlan], receiver: &Receiver) -> Lookup {
    let toward = toward_light(light, receiver.point);
    if !(receiver.normal.dot(toward) > 0.0) {
        return known(0.0);
    }
    if light.view_count == 0 {
        return known(1.0);
    }
    let mut view_index = light.first_view;
    if light.split == SPLIT_CUBE {
        view_index += cube_face_of(-toward);
    }
    lookup_in_view(light, &views[view_index as usize], view_index, receiver)
}

/// What a receiver that faces the light asks of one view; the second half of [`lookup`].
#[inline(always)]
#[must_use]
pub fn lookup_in_view(light: &LightPlan, view: &ViewPlan, view_index: u32, receiver: &Receiver) -> Lookup {
    let w = row_times_point(view.clip_w, receiver.point);
    if w <= 0.0 {
        return known(1.0);
    }
    let normal = unit_normal(receiver.normal);
    let footprint = footprint(light, view, receiver, w);
    let needed = needed_depth(light, view, receiver.point, receiver.normal, w, footprint);
    let offset = normal_offset(light, view, receiver.point, normal, needed, w);
    let mut bias = linear_bias(view, w, depth_bias(light, view, needed, w));
    if offset > 0.0 {
        bias = 0.0;
    }
    let mut slope = Vec2::ZERO;
    let mut slope_limit = 0.0;
    if light.bias & BIAS_RECEIVER_PLANE != 0 {
        slope = depth_gradient(view, receiver.point, receiver.normal);
        if view.depth_kind == DEPTH_REVERSED {
            slope = -slope;
        }
        slope_limit = plane_limit(light, view, w);
    }
    let point = receiver.point + normal * (offset + normal_step(light, view, receiver.point, normal, w));
    let w = row_times_point(view.clip_w, point);
    let x = row_times_point(view.clip_x, point) / w;
    let y = row_times_point(view.clip_y, point) / w;
    let z = receiver_depth(view, row_times_point(view.clip_z, point) / w, w);
    let [nearest, farthest] = depth_limits(view);
    let texel = Vec2::new(
        x * view.texel_scale[0] + view.texel_offset[0] + light.texel_shift,
        y * view.texel_scale[1] + view.texel_offset[1] + light.texel_shift,
    );
    let left = view.rect[0] as f32;
    let top = view.rect[1] as f32;
    let inside = texel.x >= left && texel.y >= top && texel.x < left + view.rect[2] as f32 && texel.y < top + view.rect[3] as f32;
    if !inside || z < nearest {
        return known(1.0);
    }
    let mut turn = Vec2::X;
    if light.filter == FILTER_DISC {
        turn = turn_of_pixel(receiver.pixel);
    }
    Lookup { view: view_index, known: 0.0, texel, depth: z.min(farthest), bias, turn, footprint, slope, slope_limit }
}

/// The sides of a receiver's pixel in a view's map, in texels; zero where the filter does not look at them. `w` is the receiver's.
///
/// A point that moves by `d` moves in the map by `(r_x . d - x r_w . d) / w`, with the matrix's rows r and the point's place x before: the quotient rule.
#[inline(always)]
#[must_use]
pub fn footprint(light: &LightPlan, view: &ViewPlan, receiver: &Receiver, w: f32) -> [Vec2; 2] {
    if light.filter != FILTER_FOOTPRINT {
        return [Vec2::ZERO; 2];
    }
    let x = row_times_point(view.clip_x, receiver.point) / w;
    let y = row_times_point(view.clip_y, receiver.point) / w;
    let side = |step: Vec3| {
        let along_w = row_times_vector(view.clip_w, step);
        let moved_x = (row_times_vector(view.clip_x, step) - x * along_w) / w;
        let moved_y = (row_times_vector(view.clip_y, step) - y * along_w) / w;
        Vec2::new(moved_x * view.texel_scale[0], moved_y * view.texel_scale[1])
    };
    [side(receiver.steps[0]), side(receiver.steps[1])]
}

/// How much of a light reaches a receiver: from 0, shadowed, to 1, lit.
///
/// `views` are all views of the frame. This is the one function through which every pixel of either renderer goes.
#[inline(always)]
#[must_use]
pub fn visibility(light: &LightPlan, views: &[ViewPlan], maps: &impl MapAccess, receiver: &Receiver) -> f32 {
    let mut lookup = lookup(light, views, receiver);
    if lookup.view == NO_VIEW {
        return lookup.known;
    }
    let view = &views[lookup.view as usize];
    if light.bias & BIAS_RECEIVER_GRADIENT != 0 {
        lookup.bias += stored_gradient(maps, view, light, lookup.texel);
    }
    filtered_test(maps, view, light, &lookup)
}
