// The plan: mirrors shadow-math/src/plan/data.rs. A test compares every offset and constant.

const LIGHT_DIRECTIONAL: u32 = 0u;
const LIGHT_SPOT: u32 = 1u;
const LIGHT_POINT: u32 = 2u;

const SPLIT_SINGLE: u32 = 0u;
const SPLIT_CUBE: u32 = 1u;
const SPLIT_CASCADES: u32 = 2u;

const SELECT_BY_DEPTH: u32 = 0u;
const SELECT_BY_CONTAINMENT: u32 = 1u;

const BIAS_NONE: u32 = 0u;
const BIAS_CONSTANT: u32 = 1u;
const BIAS_SLOPE: u32 = 2u;
const BIAS_AUTOMATIC: u32 = 4u;
const BIAS_NORMAL_OFFSET: u32 = 8u;
const BIAS_RECEIVER_PLANE: u32 = 16u;
const BIAS_RECEIVER_GRADIENT: u32 = 32u;
const BIAS_BACK_FACES: u32 = 64u;
const BIAS_POLYGON_OFFSET: u32 = 128u;
const BIAS_OGRE_2006: u32 = 256u;

const COMPOSE_ADDITIVE: u32 = 0u;
const COMPOSE_MODULATIVE: u32 = 1u;
const COMPOSE_UNSHADOWED: u32 = 2u;
const COMPOSE_FACTOR: u32 = 3u;

const FILTER_HARD: u32 = 0u;
const FILTER_BILINEAR: u32 = 1u;
const FILTER_SEPARABLE: u32 = 2u;
const FILTER_CROSS: u32 = 3u;
const FILTER_DISC: u32 = 4u;
const FILTER_FOOTPRINT: u32 = 5u;

const TERMINATOR_HARD: u32 = 0u;
const TERMINATOR_SOFT: u32 = 1u;

struct PixelRays {
    origin: vec4f,
    origin_dx: vec4f,
    origin_dy: vec4f,
    direction: vec4f,
    direction_dx: vec4f,
    direction_dy: vec4f,
}

struct CameraPlan {
    clip_x: vec4f,
    clip_y: vec4f,
    clip_z: vec4f,
    clip_w: vec4f,
    rays: PixelRays,
    ambient: vec3f,
    exposure: f32,
    width: u32,
    height: u32,
    light_count: u32,
    first_light: u32,
    shadow_color: vec3f,
    composition: u32,
}

struct LightPlan {
    position: vec3f,
    kind: u32,
    intensity: vec3f,
    inverse_range: f32,
    axis: vec3f,
    cone_scale: f32,
    cone_offset: f32,
    first_view: u32,
    view_count: u32,
    split: u32,
    bias: u32,
    bias_metres: f32,
    slope_scale: f32,
    filter_kind: u32,
    filter_taps: u32,
    filter_reach: f32,
    filter_total: f32,
    normal_texels: f32,
    plane_metres: f32,
    gradient_fixed: f32,
    gradient_clamp: f32,
    gradient_scale: f32,
    terminator: u32,
    texel_shift: f32,
    picture_first_word: u32,
    picture_width: u32,
    picture_x: vec4f,
    picture_y: vec4f,
    picture_w: vec4f,
    picture_height: u32,
    selection: u32,
    guard_texels: f32,
    shadow_far: f32,
    view_distance: vec4f,
    split_far: array<vec4f, 2>,
    split_band: array<vec4f, 2>,
    filter_table: array<vec4f, 8>,
}

struct ViewPlan {
    clip_x: vec4f,
    clip_y: vec4f,
    clip_z: vec4f,
    clip_w: vec4f,
    world_from_texel_x: vec4f,
    world_from_texel_y: vec4f,
    world_from_depth: vec4f,
    rays: PixelRays,
    texel_scale: vec2f,
    texel_offset: vec2f,
    rounding_texels: vec2f,
    rounding_depth: vec2f,
    depth_factor: f32,
    w_per_metre: f32,
    depth_range: vec2f,
    texel_metres: vec2f,
    layer: u32,
    depth_kind: u32,
    depth_layer: u32,
    depth_steps: f32,
    range_over_near: f32,
    rounding_metres: f32,
    linear_scale: f32,
    linear_offset: f32,
    caster_kind: u32,
    caster_slope: f32,
    caster_units: f32,
    caster_limit: f32,
    caster_asymptote: f32,
    caster_push: f32,
    snap_texels: f32,
    is_warped: u32,
    fit_outcome: u32,
    drawn_scale: f32,
    drawn_z: vec4f,
    drawn_offset: f32,
    farthest_w: f32,
    padding_0: u32,
    padding_1: u32,
    distance: vec4f,
    half_space: vec4f,
    rect: vec4u,
}
