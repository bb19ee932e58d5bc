//! The plan's data. `plan.wgsl` repeats these structs; a test compares every offset.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};

use crate::{
    caster::CASTER_PLAIN,
    depth::{DEPTH_LINEAR, DEPTH_Z_OVER_W, LAYER_FIRST},
    fit::FitOutcome,
    settings::MAX_CASCADES,
};

/// The most views of one light: as many cascades as there can be, two more than a cube has faces.
pub const MAX_VIEWS_PER_LIGHT: usize = MAX_CASCADES;

/// [`LightPlan::kind`] of a directional light.
pub const LIGHT_DIRECTIONAL: u32 = 0;
/// [`LightPlan::kind`] of a spot light.
pub const LIGHT_SPOT: u32 = 1;
/// [`LightPlan::kind`] of a point light.
pub const LIGHT_POINT: u32 = 2;

/// [`LightPlan::split`]: one view.
pub const SPLIT_SINGLE: u32 = 0;
/// [`LightPlan::split`]: six views, in the order of [`CUBE_FACES`](crate::fit::CUBE_FACES).
pub const SPLIT_CUBE: u32 = 1;
/// [`LightPlan::split`]: a view for each range of distances from the camera.
pub const SPLIT_CASCADES: u32 = 2;

/// [`LightPlan::selection`]: the cascade whose distances have the receiver's.
pub const SELECT_BY_DEPTH: u32 = 0;
/// [`LightPlan::selection`]: the first cascade whose map has the receiver, and all that its filter looks at.
pub const SELECT_BY_CONTAINMENT: u32 = 1;

/// [`LightPlan::bias`] without any part.
pub const BIAS_NONE: u32 = 0;
/// A bit of [`LightPlan::bias`]: a length.
pub const BIAS_CONSTANT: u32 = 1;
/// A bit of [`LightPlan::bias`]: what the receiver's plane needs.
pub const BIAS_SLOPE: u32 = 2;
/// [`LightPlan::bias`] by itself: what the receiver's plane needs, as depth or along the normal.
pub const BIAS_AUTOMATIC: u32 = 4;
/// A bit of [`LightPlan::bias`]: a step along the normal.
pub const BIAS_NORMAL_OFFSET: u32 = 8;
/// A bit of [`LightPlan::bias`]: taps are compared with the receiver's plane.
pub const BIAS_RECEIVER_PLANE: u32 = 16;
/// A bit of [`LightPlan::bias`]: differences in the map.
pub const BIAS_RECEIVER_GRADIENT: u32 = 32;
/// A bit of [`LightPlan::bias`]: of single-sided casters the map has the back faces alone.
pub const BIAS_BACK_FACES: u32 = 64;

/// A bit of [`LightPlan::bias`]: casters are drawn deeper by a polygon offset.
pub const BIAS_POLYGON_OFFSET: u32 = 128;
/// A bit of [`LightPlan::bias`]: casters are drawn deeper as the article's shader does.
pub const BIAS_OGRE_2006: u32 = 256;

/// [`CameraPlan::composition`]: each light is added by its visibility.
pub const COMPOSE_ADDITIVE: u32 = 0;
/// [`CameraPlan::composition`]: all lights are added, and each shadow darkens the sum.
pub const COMPOSE_MODULATIVE: u32 = 1;
/// [`CameraPlan::composition`]: all lights are added, and nothing is shadowed.
pub const COMPOSE_UNSHADOWED: u32 = 2;
/// [`CameraPlan::composition`]: what shadows multiply the picture by, and no light.
pub const COMPOSE_FACTOR: u32 = 3;

/// [`LightPlan::filter`]: one test.
pub const FILTER_HARD: u32 = 0;
/// [`LightPlan::filter`]: four tests, weighted bilinearly.
pub const FILTER_BILINEAR: u32 = 1;
/// [`LightPlan::filter`]: a square of tests, weighted by the same kernel on both axes, with bilinear edges.
pub const FILTER_SEPARABLE: u32 = 2;
/// [`LightPlan::filter`]: a texel and its four neighbours.
pub const FILTER_CROSS: u32 = 3;
/// [`LightPlan::filter`]: tests at places in a disc, which is turned from pixel to pixel.
pub const FILTER_DISC: u32 = 4;
/// [`LightPlan::filter`]: tests all over the pixel's image in the map.
pub const FILTER_FOOTPRINT: u32 = 5;

/// [`LightPlan::terminator`]: light ends where the facet turns away.
pub const TERMINATOR_HARD: u32 = 0;
/// [`LightPlan::terminator`]: light fades out towards there.
pub const TERMINATOR_SOFT: u32 = 1;

/// The rays through the pixels of a view: `(origin, direction)` at pixel coordinates `(x, y)` are `a + a_dx x + a_dy y` each.
///
/// Pixel centres lie at + 0.5. Directions are not normalised. The fourth components are padding, but for origins in a [`ViewPlan`].
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct PixelRays {
    /// The origin at pixel coordinate (0, 0), in metres relative to the scene's origin.
    pub origin: [f32; 4],
    /// What a step in x adds to the origin.
    pub origin_dx: [f32; 4],
    /// What a step in y adds to the origin.
    pub origin_dy: [f32; 4],
    /// The direction at pixel coordinate (0, 0).
    pub direction: [f32; 4],
    /// What a step in x adds to the direction.
    pub direction_dx: [f32; 4],
    /// What a step in y adds to the direction.
    pub direction_dy: [f32; 4],
}

/// How the picture is taken.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct CameraPlan {
    /// The x row of the matrix from world to clip space.
    pub clip_x: [f32; 4],
    /// The y row.
    pub clip_y: [f32; 4],
    /// The z row: reversed, 1 at the near plane.
    pub clip_z: [f32; 4],
    /// The w row.
    pub clip_w: [f32; 4],
    /// The rays through the pixels.
    pub rays: PixelRays,
    /// Illuminance that arrives from everywhere, linear colour, in lux.
    pub ambient: [f32; 3],
    /// What radiance is multiplied by: 1 over the luminance, in candela per square metre, that becomes white.
    pub exposure: f32,
    /// Width of the picture in pixels.
    pub width: u32,
    /// Height of the picture in pixels.
    pub height: u32,
    /// How many lights there are.
    pub light_count: u32,
    /// The first of them that is drawn.
    pub first_light: u32,
    /// What shadows are multiplied by, linear; for [`COMPOSE_MODULATIVE`] and [`COMPOSE_FACTOR`].
    pub shadow_color: [f32; 3],
    /// [`COMPOSE_ADDITIVE`] or another of its kind.
    pub composition: u32,
}

/// How a light shines and is shadowed.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct LightPlan {
    /// The unit vector toward a directional light; the position of another, in metres relative to the scene's origin.
    pub position: [f32; 3],
    /// [`LIGHT_DIRECTIONAL`], [`LIGHT_SPOT`] or [`LIGHT_POINT`].
    pub kind: u32,
    /// Colour times intensity: lux for a directional light, candela for another.
    pub intensity: [f32; 3],
    /// 1 over the range in 1 / m; 0 for no range.
    pub inverse_range: f32,
    /// The unit vector along a spot light's axis, the way the light travels; otherwise zero.
    pub axis: [f32; 3],
    /// A spot light's angular falloff is `saturate(cos * cone_scale + cone_offset)` squared.
    pub cone_scale: f32,
    /// See `cone_scale`; 1 with a scale of 0 for lights without a cone.
    pub cone_offset: f32,
    /// The index of the light's first view.
    pub first_view: u32,
    /// The number of its views.
    pub view_count: u32,
    /// [`SPLIT_SINGLE`], [`SPLIT_CUBE`] or [`SPLIT_CASCADES`]: how a receiver chooses among the views.
    pub split: u32,
    /// [`BIAS_AUTOMATIC`], or any of the other bits together.
    pub bias: u32,
    /// A length in metres along the view axis that is added to the bias.
    pub bias_metres: f32,
    /// A factor on the filter's support in the slope bias.
    pub slope_scale: f32,
    /// [`FILTER_HARD`], [`FILTER_BILINEAR`], [`FILTER_SEPARABLE`], [`FILTER_CROSS`], [`FILTER_DISC`] or [`FILTER_FOOTPRINT`].
    pub filter: u32,
    /// How many weights a separable filter's kernel has, or how many places a disc.
    pub filter_taps: u32,
    /// How far the filter reaches, in texels on each axis; a disc's places alone, without the texels that they fall into.
    pub filter_reach: f32,
    /// What the weights add up to on one axis: a separable filter's.
    pub filter_total: f32,
    /// A step along the normal, in texels times the sine.
    pub normal_texels: f32,
    /// The most that a tap's depth is corrected by, in metres.
    pub plane_metres: f32,
    /// A share of the stored depth that is added to it.
    pub gradient_fixed: f32,
    /// The most that differences of stored depths count.
    pub gradient_clamp: f32,
    /// A factor on these differences.
    pub gradient_scale: f32,
    /// [`TERMINATOR_HARD`] or [`TERMINATOR_SOFT`].
    pub terminator: u32,
    /// By how many texels lookups are moved on both axes: what mixed conventions do.
    pub texel_shift: f32,
    /// Where the texels of the light's picture begin among the scene's words.
    pub picture_first_word: u32,
    /// Width of the picture in texels; 0 for no picture.
    pub picture_width: u32,
    /// The x row of the matrix from world space to the picture, whose coordinates run from 0 to 1.
    pub picture_x: [f32; 4],
    /// The y row.
    pub picture_y: [f32; 4],
    /// The w row.
    pub picture_w: [f32; 4],
    /// Height of the picture in texels.
    pub picture_height: u32,
    /// [`SELECT_BY_DEPTH`] or [`SELECT_BY_CONTAINMENT`]: how a receiver chooses among cascades.
    pub selection: u32,
    /// How far a lookup must be from the rim of a map to be contained in it, in texels.
    pub guard_texels: f32,
    /// The distance from the camera, along its axis in metres, beyond which nothing is shadowed; `f32::MAX` for none.
    pub shadow_far: f32,
    /// The row that takes points to their distance from the camera along its axis, in metres.
    pub view_distance: [f32; 4],
    /// Where each cascade ends, in metres from the camera along its axis: increasing, and `f32::MAX` for cascades that are not there.
    pub split_far: [[f32; 4]; 2],
    /// Over how many metres before its end each cascade is blended with the next one; by containment, over which share of half its map.
    pub split_band: [[f32; 4]; 2],
    /// A separable filter's weights, which are whole numbers, or a disc's places, x and y side by side, in texels.
    pub filter_table: [[f32; 4]; 8],
}

/// One shadow map: where it looks, where it is stored, and what its texels mean.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct ViewPlan {
    /// The x row of the matrix from world to clip space.
    pub clip_x: [f32; 4],
    /// The y row.
    pub clip_y: [f32; 4],
    /// The depth row: z, of the kind that `depth_kind` names.
    pub clip_z: [f32; 4],
    /// The w row: exactly (0, 0, 0, 1) for an orthographic view.
    pub clip_w: [f32; 4],
    /// The first column of the matrix from (texel x, texel y, depth, 1) to homogeneous world space.
    pub world_from_texel_x: [f32; 4],
    /// The second column.
    pub world_from_texel_y: [f32; 4],
    /// The third column.
    pub world_from_depth: [f32; 4],
    /// The rays through the texels, for casters that are tested at each texel. Origins are homogeneous: see [`texel_ray`](crate::caster::texel_ray).
    pub rays: PixelRays,
    /// NDC x and y times this, plus `texel_offset`, are texels of the layer.
    pub texel_scale: [f32; 2],
    /// See `texel_scale`.
    pub texel_offset: [f32; 2],
    /// The bound on rounding, in texels: wherever the receiver is, and divided by its w.
    pub rounding_texels: [f32; 2],
    /// The bound on rounding, in depth: wherever the receiver is, and divided by its w.
    pub rounding_depth: [f32; 2],
    /// `metres` before a receiver, along the view's axis, take up `depth_factor * metres / (w * (distance - w_per_metre * metres))` of depth.
    pub depth_factor: f32,
    /// 1 for light from a place, 0 for parallel light.
    pub w_per_metre: f32,
    /// The distances of the near and far planes along the axis, in metres.
    pub depth_range: [f32; 2],
    /// Width and height of a texel in metres: at w = 1; of a warped view, where most of what is seen is.
    pub texel_metres: [f32; 2],
    /// The layer of the map array.
    pub layer: u32,
    /// [`DEPTH_Z_OVER_W`](crate::depth::DEPTH_Z_OVER_W), [`DEPTH_REVERSED`](crate::depth::DEPTH_REVERSED) or [`DEPTH_LINEAR`](crate::depth::DEPTH_LINEAR). The latter two have a reversed depth row.
    pub depth_kind: u32,
    /// [`LAYER_FIRST`](crate::depth::LAYER_FIRST), [`LAYER_SECOND`](crate::depth::LAYER_SECOND) or [`LAYER_MIDPOINT`](crate::depth::LAYER_MIDPOINT).
    pub depth_layer: u32,
    /// How many steps stored depth has from 0 to 1; 0 for floats.
    pub depth_steps: f32,
    /// The depth range over the distance of the near plane: what turns reversed depth into a distance.
    pub range_over_near: f32,
    /// The bound on rounding of linear depth, in metres; 0 for others, whose bound is one in depth.
    pub rounding_metres: f32,
    /// Linear depth is `w * linear_scale + linear_offset`.
    pub linear_scale: f32,
    /// See `linear_scale`.
    pub linear_offset: f32,
    /// [`CASTER_PLAIN`](crate::caster::CASTER_PLAIN) or another of its kind.
    pub caster_kind: u32,
    /// A factor on the slopes by which casters are drawn deeper.
    pub caster_slope: f32,
    /// How many units deeper casters are drawn.
    pub caster_units: f32,
    /// The most by which slopes and units draw them deeper.
    pub caster_limit: f32,
    /// The depth that a perspective view's depth tends to far away; 0 for an orthographic view.
    pub caster_asymptote: f32,
    /// What its difference to a depth, squared, is multiplied by to draw casters deeper.
    pub caster_push: f32,
    /// How far a rasteriser moves a vertex on either axis, in texels: half a step of its sub-pixel grid.
    pub snap_texels: f32,
    /// 1 for a view whose w is no distance along its axis: its texels have other widths from place to place.
    pub is_warped: u32,
    /// How the view came about: what [`ViewPlan::outcome`] tells.
    pub fit_outcome: u32,
    /// What a depth as it is drawn is multiplied by to become one of the view's own; 0 where both are the same, in views that are not pancaked.
    pub drawn_scale: f32,
    /// The depth row by which casters are drawn, whose near and far planes enclose them all: `clip_z`, but in pancaked views.
    pub drawn_z: [f32; 4],
    /// What is added to a drawn depth times `drawn_scale`.
    pub drawn_offset: f32,
    /// The greatest w over `distance` of a point that chooses this map because it is in it; `f32::MAX` for any.
    pub farthest_w: f32,
    /// Padding to a multiple of 16 bytes.
    pub padding_0: u32,
    /// Padding.
    pub padding_1: u32,
    /// The row that takes points to their distance from the light along the view's axis, in metres: `clip_w` where nothing is warped, and 1 everywhere for parallel light.
    pub distance: [f32; 4],
    /// The half-space outside of which the view's matrix means nothing, as a row that is at least 0 inside: casters there are not drawn, and receivers are lit.
    pub half_space: [f32; 4],
    /// The rectangle within the layer: x, y, width, height in texels; empty for a view of nothing, which has no layer.
    pub rect: [u32; 4],
}

impl ViewPlan {
    /// How the view came about.
    #[must_use]
    pub fn outcome(&self) -> FitOutcome {
        FitOutcome::of_code(self.fit_outcome).unwrap_or_default()
    }

    /// Whether the view means nothing in a part of the world.
    #[must_use]
    pub fn has_half_space(&self) -> bool {
        self.half_space != [0.0, 0.0, 0.0, 1.0]
    }

    /// Whether there is a map: something is seen in it.
    #[must_use]
    pub fn has_map(&self) -> bool {
        self.rect[2] > 0
    }

    /// Whether the map holds the smallest depth that is drawn, as it is drawn: nothing has to be done to it.
    #[must_use]
    pub fn holds_drawn_depth(&self) -> bool {
        self.depth_kind == DEPTH_Z_OVER_W && self.has_plain_casters() && self.depth_layer == LAYER_FIRST
    }

    /// Whether what is drawn is what the map holds, be it the smallest depth or the largest.
    #[must_use]
    pub fn has_plain_casters(&self) -> bool {
        self.depth_kind != DEPTH_LINEAR && self.depth_steps == 0.0 && self.caster_kind == CASTER_PLAIN && !self.is_pancaked()
    }

    /// Whether casters before the near plane and behind the far plane are drawn, onto these planes.
    #[must_use]
    pub fn is_pancaked(&self) -> bool {
        self.drawn_scale > 0.0
    }

    /// The rows by which casters are drawn.
    #[must_use]
    pub fn drawn_rows(&self) -> [[f32; 4]; 4] {
        [self.clip_x, self.clip_y, self.drawn_z, self.clip_w]
    }

    /// The matrix from world to clip space, z from 0 to 1, for a renderer that wants it whole. Exactly the rows of the plan.
    #[must_use]
    pub fn clip_from_world(&self) -> Mat4 {
        Mat4::from_cols_array_2d(&[self.clip_x, self.clip_y, self.clip_z, self.clip_w]).transpose()
    }
}

/// The vector from a point to the light: of unit length for a directional light, else in metres. Mirrored by `light.wgsl`.
#[inline(always)]
#[must_use]
pub fn toward_light(light: &LightPlan, point: Vec3) -> Vec3 {
    let position = Vec3::new(light.position[0], light.position[1], light.position[2]);
    if light.kind == LIGHT_DIRECTIONAL {
        return position;
    }
    position - point
}
