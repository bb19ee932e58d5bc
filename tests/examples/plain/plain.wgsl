// Shadow mapping as most programs have it: a depth pass, then forward shading with a comparison sampler.

struct Frame {
    clip_from_world: mat4x4f,
    map_from_world: mat4x4f,
    eye: vec4f,
    toward_light: vec4f,
    intensity: vec4f,
    ambient: vec4f,
}

struct Material {
    base_color: vec4f,
    alpha_cutoff: f32,
    shininess: f32,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var map: texture_depth_2d;
@group(0) @binding(2) var map_sampler: sampler_comparison;
@group(1) @binding(0) var<uniform> material: Material;
@group(1) @binding(1) var base_color: texture_2d<f32>;
@group(1) @binding(2) var base_color_sampler: sampler;

struct Corner {
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
}

struct Varyings {
    @builtin(position) clip: vec4f,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
}

@vertex
fn caster(@location(0) position: vec3f) -> @builtin(position) vec4f {
    return frame.map_from_world * vec4f(position, 1.0);
}

@vertex
fn masked_caster(corner: Corner) -> Varyings {
    return Varyings(frame.map_from_world * vec4f(corner.position, 1.0), corner.position, corner.normal, corner.uv);
}

@fragment
fn masked(varyings: Varyings) {
    if textureSample(base_color, base_color_sampler, varyings.uv).a * material.base_color.a < material.alpha_cutoff {
        discard;
    }
}

@vertex
fn receiver(corner: Corner) -> Varyings {
    return Varyings(frame.clip_from_world * vec4f(corner.position, 1.0), corner.position, corner.normal, corner.uv);
}

@fragment
fn forward(varyings: Varyings, @builtin(front_facing) is_front: bool) -> @location(0) vec4f {
    return shaded(varyings, is_front, material.base_color * textureSample(base_color, base_color_sampler, varyings.uv));
}

@fragment
fn masked_forward(varyings: Varyings, @builtin(front_facing) is_front: bool) -> @location(0) vec4f {
    let base = material.base_color * textureSample(base_color, base_color_sampler, varyings.uv);
    if base.a < material.alpha_cutoff {
        discard;
    }
    return shaded(varyings, is_front, base);
}

fn shaded(varyings: Varyings, is_front: bool, base: vec4f) -> vec4f {
    let in_map = frame.map_from_world * vec4f(varyings.position, 1.0);
    let texel = vec2f(0.5 + 0.5 * in_map.x, 0.5 - 0.5 * in_map.y);
    let visibility = textureSampleCompareLevel(map, map_sampler, texel, in_map.z);
    let normal = normalize(select(-varyings.normal, varyings.normal, is_front));
    let toward_viewer = normalize(frame.eye.xyz - varyings.position);
    let half_way = normalize(frame.toward_light.xyz + toward_viewer);
    let highlight = pow(max(dot(normal, half_way), 0.0), material.shininess);
    let cosine = max(dot(normal, frame.toward_light.xyz), 0.0);
    let reflected = 0.318 * base.rgb + 0.0016 * (material.shininess + 8.0) * highlight;
    return vec4f(frame.intensity.rgb * reflected * cosine * visibility + 0.318 * base.rgb * frame.ambient.rgb, 1.0);
}
