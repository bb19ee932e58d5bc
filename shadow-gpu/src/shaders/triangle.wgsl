// The surface behind a pixel: mirrors shadow-math/src/triangle.rs.

struct Ray {
    origin: vec3f,
    direction: vec3f,
}

struct TrianglePoint {
    point: vec3f,
    normal: vec3f,
    u: f32,
    v: f32,
}

fn pixel_ray(rays: PixelRays, x: f32, y: f32) -> Ray {
    let origin = rays.origin.xyz + rays.origin_dx.xyz * x + rays.origin_dy.xyz * y;
    let direction = rays.direction.xyz + rays.direction_dx.xyz * x + rays.direction_dy.xyz * y;
    return Ray(origin, direction);
}

fn triangle_point(ray: Ray, v0: vec3f, v1: vec3f, v2: vec3f) -> TrianglePoint {
    let e1 = v1 - v0;
    let e2 = v2 - v0;
    let normal = cross3(e1, e2);
    let s = ray.origin - v0;
    let q = cross3(s, ray.direction);
    let determinant = -dot3(normal, ray.direction);
    var inverse_determinant = 0.0;
    if determinant != 0.0 {
        inverse_determinant = 1.0 / determinant;
    }
    let u = min(max(dot3(e2, q) * inverse_determinant, 0.0), 1.0);
    let v = min(max(-dot3(e1, q) * inverse_determinant, 0.0), 1.0 - u);
    let point = v0 + e1 * u + e2 * v;
    return TrianglePoint(point, normal, u, v);
}

struct PixelSteps {
    x: vec3f,
    y: vec3f,
}

fn plane_step(origin: vec3f, direction: vec3f, ray: Ray, distance: f32, normal: vec3f, along: f32) -> vec3f {
    let moved = origin + direction * distance;
    return moved - ray.direction * (dot3(normal, moved) / along);
}

fn pixel_steps(rays: PixelRays, ray: Ray, point: vec3f, normal: vec3f) -> PixelSteps {
    let along = dot3(normal, ray.direction);
    let distance = dot3(normal, point - ray.origin) / along;
    return PixelSteps(
        plane_step(rays.origin_dx.xyz, rays.direction_dx.xyz, ray, distance, normal, along),
        plane_step(rays.origin_dy.xyz, rays.direction_dy.xyz, ray, distance, normal, along),
    );
}

fn turned_to_viewer(v: vec3f, geometric_normal: vec3f, ray: Ray) -> vec3f {
    if dot3(geometric_normal, ray.direction) > 0.0 {
        return -v;
    }
    return v;
}
