// How fast depth changes over a plane's image: mirrors shadow-math/src/gradient.rs.

const MAX_GRADIENT: f32 = 3.40282347e+38;

fn normal_derivative(column: vec4f, point: vec3f, normal: vec3f) -> f32 {
    let x = column.x - point.x * column.w;
    let y = column.y - point.y * column.w;
    let z = column.z - point.z * column.w;
    return normal.x * x + normal.y * y + normal.z * z;
}

fn depth_gradient(view: u32, point: vec3f, normal: vec3f) -> vec2f {
    let along_x = normal_derivative(views[view].world_from_texel_x, point, normal);
    let along_y = normal_derivative(views[view].world_from_texel_y, point, normal);
    let along_depth = normal_derivative(views[view].world_from_depth, point, normal);
    if along_depth == 0.0 {
        return vec2f(MAX_GRADIENT, MAX_GRADIENT);
    }
    return vec2f(-(along_x / along_depth), -(along_y / along_depth));
}
