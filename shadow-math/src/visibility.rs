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
        BIAS_RECEIVER_GRADIENT, BIAS_RECEIVER_PLANE, FILTER_DISC, FILTER_FOOTPRINT, LightPlan, SELECT_BY_DEPTH, SPLIT_CASCADES,
        SPLIT_CUBE, ViewPlan, toward_light,
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

/// Which views a receiver asks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// The index of the view, among all views of the frame; [`NO_VIEW`] if no map is asked.
    pub first: u32,
    /// The index of the view that it is blended with; looked at where `share` is above 0.
    pub second: u32,
    /// How much of the answer is the second view's, from 0 to 1.
    pub share: f32,
    /// The answer where no map is asked.
    pub known: f32,
}

/// Which views of a light a receiver asks. `views` are all views of the frame.
///
/// Known without a map are: 0 where the surface does not face the light; 1 for a light without views, from which nothing is shadowed, and beyond the distance up to which there are shadows.
#[inline(always)]
#[must_use]
pub fn choose_views(light: &LightPlan, views: &[ViewPlan], receiver: &Receiver) -> Choice {
    let toward = toward_light(light, receiver.point);
    if !(receiver.normal.dot(toward) > 0.0) {
        return Choice { first: NO_VIEW, second: NO_VIEW, share: 0.0, known: 0.0 };
    }
    if light.view_count == 0 {
        return Choice { first: NO_VIEW, second: NO_VIEW, share: 0.0, known: 1.0 };
    }
    let mut distance = 0.0;
    if light.split == SPLIT_CASCADES || light.shadow_far < f32::MAX {
        distance = row_times_point(light.view_distance, receiver.point);
        if distance > light.shadow_far {
            return Choice { first: NO_VIEW, second: NO_VIEW, share: 0.0, known: 1.0 };
        }
    }
    let mut choice = Choice { first: light.first_view, second: NO_VIEW, share: 0.0, known: 0.0 };
    if light.split == SPLIT_CUBE {
        choice.first += cube_face_of(-toward);
    }
    if light.split == SPLIT_CASCADES {
        let last = light.view_count - 1;
        let mut cascade = 0;
        if light.selection == SELECT_BY_DEPTH {
            while cascade < last && distance > light.split_far[cascade as usize / 4][cascade as usize % 4] {
                cascade += 1;
            }
            let band = light.split_band[cascade as usize / 4][cascade as usize % 4];
            if band > 0.0 {
                let rest = light.split_far[cascade as usize / 4][cascade as usize % 4] - distance;
                choice.share = (1.0 - rest / band).max(0.0);
            }
        } else {
            while cascade < last
                && !(distance_to_rim(light, &views[(light.first_view + cascade) as usize], receiver.point) >= 0.0)
            {
                cascade += 1;
            }
            let band = light.split_band[cascade as usize / 4][cascade as usize % 4];
            if band > 0.0 {
                let rest = distance_to_rim(light, &views[(light.first_view + cascade) as usize], receiver.point);
                choice.share = (1.0 - rest / band).max(0.0);
            }
        }
        choice.first += cascade;
        if choice.share > 0.0 {
            choice.second = choice.first + 1;
        }
    }
    choice
}

/// How far a point is from the rim of a view's map, less the guard band, as a share of half the map: 1 in the middle, below 0 in the band and outside. Below 0 behind the light, too, where there is no map, and beyond what a
/// warp was fitted to.
#[inline(always)]
fn distance_to_rim(light: &LightPlan, view: &ViewPlan, point: Vec3) -> f32 {
    let w = row_times_point(view.clip_w, point);
    if w <= 0.0 || view.rect[2] == 0 || w > view.farthest_w * row_times_point(view.distance, point) {
        return -1.0;
    }
    let x = row_times_point(view.clip_x, point) / w;
    let y = row_times_point(view.clip_y, point) / w;
    // NDC reaches from -1 to 1: half a map is 1.
    let guard = light.guard_texels * 2.0 / view.rect[2] as f32;
    (1.0 - x.abs().max(y.abs())) - guard
}

/// What a receiver asks of the map of a light that it asks first. `views` are all views of the frame.
///
/// The bias may move the lookup away from the receiver, along its normal. Known without a map is what [`choose_views`] says, and 1 behind the light, nearer than the near plane and outside
/// the map. What lies beyond the far plane is compared at the far plane's depth.
#[inline(always)]
#[must_use]
pub fn lookup(light: &LightPlan, views: &[ViewPlan], receiver: &Receiver) -> Lookup {
    let choice = choose_views(light, views, receiver);
    if choice.first == NO_VIEW {
        return known(choice.known);
    }
    lookup_in_view(light, &views[choice.first as usize], choice.first, receiver)
}

/// What a receiver that faces the light asks of one view.
#[inline(always)]
#[must_use]
pub fn lookup_in_view(light: &LightPlan, view: &ViewPlan, view_index: u32, receiver: &Receiver) -> Lookup {
    let w = row_times_point(view.clip_w, receiver.point);
    if w <= 0.0 || row_times_point(view.half_space, receiver.point) < 0.0 {
        return known(1.0);
    }
    let normal = unit_normal(receiver.normal);
    let footprint = footprint(light, view, receiver, w);
    let needed = needed_depth(light, view, receiver.point, receiver.normal, w, footprint);
    let offset = normal_offset(light, view, receiver.point, normal, needed, w);
    let axis_distance = row_times_point(view.distance, receiver.point);
    let mut bias = linear_bias(view, w, depth_bias(light, view, needed, w, axis_distance));
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
        slope_limit = plane_limit(light, view, w, axis_distance);
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
/// `views` are all views of the frame. In the band between two cascades it is a mean of what both say. This is the one function through which every pixel of either renderer goes.
#[inline(always)]
#[must_use]
pub fn visibility(light: &LightPlan, views: &[ViewPlan], maps: &impl MapAccess, receiver: &Receiver) -> f32 {
    let choice = choose_views(light, views, receiver);
    if choice.first == NO_VIEW {
        return choice.known;
    }
    let first = visibility_in_view(light, views, maps, choice.first, receiver);
    if choice.share > 0.0 {
        let second = visibility_in_view(light, views, maps, choice.second, receiver);
        return first + (second - first) * choice.share;
    }
    first
}

/// How much of a light one of its views says reaches a receiver that faces it.
#[inline(always)]
#[must_use]
pub fn visibility_in_view(
    light: &LightPlan,
    views: &[ViewPlan],
    maps: &impl MapAccess,
    view_index: u32,
    receiver: &Receiver,
) -> f32 {
    let view = &views[view_index as usize];
    let mut lookup = lookup_in_view(light, view, view_index, receiver);
    if lookup.view == NO_VIEW {
        return lookup.known;
    }
    if light.bias & BIAS_RECEIVER_GRADIENT != 0 {
        lookup.bias += stored_gradient(maps, view, light, lookup.texel);
    }
    filtered_test(maps, view, light, &lookup)
}
