// What a pixel sees of a triangle: mirrors shadow-cpu/src/resolve.rs.

fn turned_to_viewer(v: vec3f, geometric_normal: vec3f, ray: Ray) -> vec3f {
    if dot3(geometric_normal, ray.direction) > 0.0 {
        return -v;
    }
    return v;
}
