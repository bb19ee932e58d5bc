//! The receiver's side: is this point lit?
//!
//! Mirrored by `visibility.wgsl`.

use glam::{Vec2, Vec3};

use crate::{
    bias::{depth_bias, needed_depth, normal_offset},
    filter::filtered_test,
    fit::cube_face_of,
    plan::{LightPlan, SPLIT_CUBE, ViewPlan, toward_light},
    vector::{normalized, row_times_point},
};

/// The way to the shadow maps.
pub trait MapAccess {
    /// The depth that texel `(x, y)` of a layer holds; 1 where nothing was drawn. Coordinates lie inside the layer.
    fn fetch_texel(&self, layer: u32, x: u32, y: u32) -> f32;
}

/// A point of a surface that asks whether it is lit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receiver {
    /// The point, in metres relative to the scene's origin.
    pub point: Vec3,
    /// The geometric normal of its triangle, turned to the viewer; of any length above 0.
    pub normal: Vec3,
}

/// [`Lookup::view`] of a receiver whose visibility is known without a map.
pub const NO_VIEW: u32 = u32::MAX;

/// What a receiver asks of the maps: one comparison depth at one place of one view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lookup {
    /// The index of the view, among all views of the frame; [`NO_VIEW`] if no map is asked.
    pub view: u32,
    /// The answer where no map is asked.
    pub known: f32,
    /// Where, in texels of the view's layer.
    pub texel: Vec2,
    /// The receiver's depth.
    pub depth: f32,
    /// The bias.
    pub bias: f32,
}

/// A lookup whose answer is known without a map.
#[inline(always)]
fn known(visibility: f32) -> Lookup {
    Lookup { view: NO_VIEW, known: visibility, texel: Vec2::ZERO, depth: 0.0, bias: 0.0 }
}

/// What a receiver asks of the maps of a light. `views` are all views of the frame.
///
/// The bias may move the lookup away from the receiver, along its normal. Known without a map are: 0 where the surface does not face the light; 1 behind the light, nearer than the near plane and outside
/// the map. What lies beyond the far plane is compared at the far plane's depth.
#[inline(always)]
#[must_use]
pub fn lookup(light: &LightPlan, views: &[ViewPlan], receiver: &Receiver) -> Lookup {
    let toward = toward_light(light, receiver.point);
    if !(receiver.normal.dot(toward) > 0.0) {
        return known(0.0);
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
    let needed = needed_depth(light, view, receiver.point, receiver.normal, w);
    let offset = normal_offset(light, view, receiver.point, normal, needed, w);
    let mut bias = depth_bias(light, view, needed, w);
    if offset > 0.0 {
        bias = 0.0;
    }
    let point = receiver.point + normal * offset;
    let w = row_times_point(view.clip_w, point);
    let x = row_times_point(view.clip_x, point) / w;
    let y = row_times_point(view.clip_y, point) / w;
    let z = row_times_point(view.clip_z, point) / w;
    let texel = Vec2::new(x * view.texel_scale[0] + view.texel_offset[0], y * view.texel_scale[1] + view.texel_offset[1]);
    let left = view.rect[0] as f32;
    let top = view.rect[1] as f32;
    let inside = texel.x >= left && texel.y >= top && texel.x < left + view.rect[2] as f32 && texel.y < top + view.rect[3] as f32;
    if !inside || z < 0.0 {
        return known(1.0);
    }
    Lookup { view: view_index, known: 0.0, texel, depth: z.min(1.0), bias }
}

/// A normal of unit length, of one of any length above 0 that f32 can hold: scaled first, so that its square can be taken.
#[inline(always)]
#[must_use]
pub fn unit_normal(normal: Vec3) -> Vec3 {
    let largest = normal.x.abs().max(normal.y.abs()).max(normal.z.abs());
    normalized(normal / largest)
}

/// How much of a light reaches a receiver: from 0, shadowed, to 1, lit.
///
/// `views` are all views of the frame. This is the one function through which every pixel of either renderer goes.
#[inline(always)]
#[must_use]
pub fn visibility(light: &LightPlan, views: &[ViewPlan], maps: &impl MapAccess, receiver: &Receiver) -> f32 {
    let lookup = lookup(light, views, receiver);
    if lookup.view == NO_VIEW {
        return lookup.known;
    }
    filtered_test(maps, &views[lookup.view as usize], light.filter, lookup.texel, lookup.depth, lookup.bias)
}
