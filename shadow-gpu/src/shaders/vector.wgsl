// Vectors: mirrors shadow-math/src/vector.rs.

// Sums are written out wherever the order of a built-in's is the driver's choice.
fn dot3(a: vec3f, b: vec3f) -> f32 {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

fn cross3(a: vec3f, b: vec3f) -> vec3f {
    return vec3f(a.y * b.z - b.y * a.z, a.z * b.x - b.z * a.x, a.x * b.y - b.x * a.y);
}

fn row_times_point(row: vec4f, point: vec3f) -> f32 {
    return row.x * point.x + row.y * point.y + row.z * point.z + row.w;
}

fn row_times_vector(row: vec4f, vector: vec3f) -> f32 {
    return row.x * vector.x + row.y * vector.y + row.z * vector.z;
}

fn normalized(v: vec3f) -> vec3f {
    let squared = v.x * v.x + v.y * v.y + v.z * v.z;
    if squared <= 0.0 {
        return v;
    }
    return v / sqrt(squared);
}

fn unit_normal(normal: vec3f) -> vec3f {
    let largest = max(max(abs(normal.x), abs(normal.y)), abs(normal.z));
    return normalized(normal / largest);
}
