//! Every function that WGSL repeats, over thousands of inputs in a compute shader, against its Rust twin.
//!
//! The statements hand plain inputs to the function under test and nothing else: a constant beside it would be folded into it by
//! the driver's compiler, and the numbers would say nothing about the function. What an input has to be is computed in Rust.

mod world;

use std::sync::OnceLock;

use glam::{DVec3, Vec2, Vec3, Vec4};
use shadow_gpu::DriverRules;
use shadow_math::{
    Bias, Camera, Cascades, Filter, Fit, Light, LightKind, MapAccess, Projection, Receiver, Selection, ShadowSettings, Split,
    Store, Terminator, Texels, approx,
    bias::{
        MAX_DEPTH_BIAS, OFFSET_SLOPE, depth_bias, depth_gradient, needed_depth, normal_offset, normal_step, plane_limit,
        texel_width,
    },
    bounds::Aabb,
    caster::{CASTER_POLYGON_OFFSET, caster_offset, pushed_depth, texel_ray},
    depth::{
        DEPTH_LINEAR, DEPTH_REVERSED, comparable_depth, depth_limits, depth_of_two, encoded_depth, linear_bias, receiver_depth,
    },
    filter::{
        depth_test, disc_place, filtered_test, footprint_counts, footprint_place, stored_gradient, support, tap_depth,
        taps::{for_each_test_place, for_each_weighted_tap},
        turn::turn_of_pixel,
    },
    fit::{Eye, Subject, cube_face_of},
    material::{
        DECODE_TABLE_LEN, FLAG_MASK, MaterialData, NO_TEXTURE, TextureData, WRAP_CLAMP, WRAP_MIRROR, WRAP_REPEAT, base_color,
        decode_texel, sample_texture, wrap_texel,
    },
    picture::{picture_color, plan_picture},
    plan::{
        BIAS_AUTOMATIC, BIAS_RECEIVER_GRADIENT, BIAS_RECEIVER_PLANE, BIAS_SLOPE, FILTER_BILINEAR, FILTER_SEPARABLE, LightPlan,
        MAX_VIEWS_PER_LIGHT, PixelRays, SELECT_BY_CONTAINMENT, SPLIT_CASCADES, SPLIT_SINGLE, ViewPlan, plan_light, toward_light,
    },
    settings::{BiasParts, Ogre2006, PolygonOffset, ReceiverGradient},
    shade::{MAX_DEVIATION, Surface, attenuation, light_reach, shade_ambient, shade_light, shadow_factor, softened_terminator},
    srgb::{decode_table, linear_to_srgb},
    triangle::{Ray, pixel_ray, pixel_steps, triangle_point, turned_to_viewer},
    vector::{normalized, row_times_point, row_times_vector, unit_normal},
    visibility::{Lookup, NO_VIEW, choose_views, lookup, lookup_in_view, visibility, visibility_in_view},
};
use shadow_tests::{
    mirror::{Globals, MIRRORS, evaluate, ulps},
    renderers::gpu,
};

use world::*;

/// How many inputs every function meets at least.
const COUNT: usize = 8192;

/// Width and height of the maps in texels.
const MAP_SIZE: u32 = 32;

/// A result of the Rust twin.
#[derive(Clone, Copy, Debug)]
struct Number {
    value: f32,
    /// The size of the terms that the value is computed from, for where they cancel; infinite where a
    /// decision hangs on the last bit.
    scale: f32,
}

impl From<f32> for Number {
    fn from(value: f32) -> Self {
        Self { value, scale: value.abs() }
    }
}

/// Lights, and vectors toward them from points around: once from the light itself.
fn lights_and_offsets(world: &World, random: &mut Random) -> Vec<f32> {
    let zero: Vec<_> = (0..world.globals.lights.len()).map(|light| [light as f32, 0.0, 0.0, 0.0]).collect();
    random.groups(&zero, |random| {
        let [light, x, y, z] = world.light_and_point(random);
        let toward = toward_light(world.light(light), Vec3::new(x, y, z));
        [light, toward.x, toward.y, toward.z]
    })
}

/// A function and how it is tested.
struct Mirror {
    /// The stem of the WGSL file.
    file: &'static str,
    /// The WGSL function, and the ones that only it calls.
    functions: &'static [&'static str],
    /// Calls the function.
    statements: &'static str,
    /// How many inputs one call takes.
    inputs_each: usize,
    /// At least [`COUNT`] groups of inputs.
    inputs: fn(&World, &mut Random) -> Vec<f32>,
    /// The same in Rust.
    twin: fn(&World, &[f32]) -> Vec<Number>,
    /// How far a driver of which only WGSL's promises are known may be off, in units in the last place of [`Number::scale`].
    /// On drivers whose rules are [complete](DriverRules::are_complete) it is none for every function.
    bound: u32,
    /// Why that far. WGSL promises correctly rounded `+ - *` that may be fused and reassociated, and 2.5 units for `/`.
    reason: &'static str,
}

/// The table. Every function of every mirror is in it: [`every_mirrored_function_is_tested`].
const TABLE: &[Mirror] = &[
    Mirror {
        file: "vector",
        functions: &["dot3"],
        statements: "output(0u, dot3(input3(0u), input3(3u)));",
        inputs_each: 6,
        inputs: |_, random| pairs_of_vectors(random),
        twin: |_, i| vec![sum(v3(i, 0).dot(v3(i, 3)), &[v3(i, 0) * v3(i, 3)])],
        bound: 6,
        reason: "three roundings of the terms on each side",
    },
    Mirror {
        file: "vector",
        functions: &["cross3"],
        statements: "output3(0u, cross3(input3(0u), input3(3u)));",
        inputs_each: 6,
        inputs: |_, random| pairs_of_vectors(random),
        twin: |_, i| {
            let (a, b) = (v3(i, 0), v3(i, 3));
            scaled(a.cross(b), magnitude_of_cross(a, b))
        },
        bound: 4,
        reason: "two roundings of the terms on each side",
    },
    Mirror {
        file: "vector",
        functions: &["row_times_vector"],
        statements: "output(0u, row_times_vector(vec4f(input3(0u), 7.0), input3(3u)));",
        inputs_each: 6,
        inputs: |_, random| pairs_of_vectors(random),
        twin: |_, i| vec![sum(row_times_vector([i[0], i[1], i[2], 7.0], v3(i, 3)), &[v3(i, 0) * v3(i, 3)])],
        bound: 6,
        reason: "three roundings of the terms on each side",
    },
    Mirror {
        file: "vector",
        functions: &["unit_normal"],
        statements: "output3(0u, unit_normal(input3(0u)));",
        inputs_each: 3,
        inputs: |_, random| {
            let edges = [[1e-30, 0.0, 0.0], [1e30, -1e30, 1e30], [0.0, -1e-38, 0.0]];
            random.groups(&edges, |random| random.vector(3.0).to_array())
        },
        twin: |_, i| unit_normal(v3(i, 0)).to_array().map(Number::from).to_vec(),
        bound: 6,
        reason: "two quotients, a sum and a square root",
    },
    Mirror {
        file: "vector",
        functions: &["row_times_point"],
        statements: "output(0u, row_times_point(vec4f(input3(0u), input(3u)), input3(4u)));",
        inputs_each: 7,
        inputs: |_, random| {
            random.groups(&[[0.0; 7], [1.0, -1.0, 0.0, 0.0, 0.5, 0.5, 9.0], [0.0, 0.0, 0.0, 1.0, 1e30, -1e30, 3.0]], |random| {
                random.numbers(9.0)
            })
        },
        twin: |_, i| {
            let row = [i[0], i[1], i[2], i[3]];
            vec![Number { value: row_times_point(row, v3(i, 4)), scale: magnitude_of_row(row, v3(i, 4)) }]
        },
        bound: 8,
        reason: "four roundings of the terms on each side",
    },
    Mirror {
        file: "vector",
        functions: &["normalized"],
        statements: "output3(0u, normalized(input3(0u)));",
        inputs_each: 3,
        inputs: |_, random| {
            let edges = [[0.0; 3], [-0.0, 0.0, 0.0], [1e-12, 0.0, 0.0], [0.0, -1e15, 1e15], [1e-30, 1e-30, 0.0], [3.0, 0.0, 4.0]];
            random.groups(&edges, |random| random.vector(10.0).to_array())
        },
        twin: |_, i| numbers(normalized(v3(i, 0)).to_array()),
        bound: 12,
        reason: "a sum of squares, a square root of 4.5 units and a division",
    },
    Mirror {
        file: "light",
        functions: &["toward_light"],
        statements: "output3(0u, toward_light(u32(input(0u)), input3(1u)));",
        inputs_each: 4,
        inputs: |world, random| random.groups::<4>(&[], |random| world.light_and_point(random)),
        twin: |world, i| numbers(toward_light(world.light(i[0]), v3(i, 1)).to_array()),
        bound: 0,
        reason: "one correctly rounded subtraction",
    },
    Mirror {
        file: "caster",
        functions: &["texel_ray"],
        statements: "let ray = texel_ray(u32(input(0u)), input(1u), input(2u));
            output3(0u, ray.origin);
            output3(3u, ray.direction);",
        inputs_each: 3,
        inputs: |world, random| world.views_and_texels(random),
        twin: |world, i| {
            let view = world.view(i[0]);
            let rays = &view.rays;
            let ray = texel_ray(view, i[1], i[2]);
            let terms =
                |a: [f32; 4], dx: [f32; 4], dy: [f32; 4]| v3(&a, 0).abs() + (v3(&dx, 0) * i[1]).abs() + (v3(&dy, 0) * i[2]).abs();
            // A homogeneous origin is divided by what the same sum makes of its fourth components.
            let by = rays.origin[3] + rays.origin_dx[3] * i[1] + rays.origin_dy[3] * i[2];
            let by_terms = rays.origin[3].abs() + (rays.origin_dx[3] * i[1]).abs() + (rays.origin_dy[3] * i[2]).abs();
            let homogeneous = view.is_warped != 0 && view.w_per_metre == 0.0;
            let lost = if homogeneous { by_terms / (by * by) } else { 1.0 };
            let origin = scaled(ray.origin, terms(rays.origin, rays.origin_dx, rays.origin_dy) * lost);
            let direction = scaled(ray.direction, terms(rays.direction, rays.direction_dx, rays.direction_dy));
            [origin, direction].concat()
        },
        bound: 16,
        reason: "four roundings of the terms on each side, and those of a divisor",
    },
    Mirror {
        file: "triangle",
        functions: &["pixel_ray"],
        statements: "let ray = pixel_ray(views[u32(input(0u))].rays, input(1u), input(2u));
            output3(0u, ray.origin);
            output3(3u, ray.direction);",
        inputs_each: 3,
        inputs: |world, random| world.views_and_texels(random),
        twin: |world, i| {
            let rays = world.view(i[0]).rays;
            let ray = pixel_ray(&rays, i[1], i[2]);
            let terms =
                |a: [f32; 4], dx: [f32; 4], dy: [f32; 4]| v3(&a, 0).abs() + (v3(&dx, 0) * i[1]).abs() + (v3(&dy, 0) * i[2]).abs();
            let origin = scaled(ray.origin, terms(rays.origin, rays.origin_dx, rays.origin_dy));
            let direction = scaled(ray.direction, terms(rays.direction, rays.direction_dx, rays.direction_dy));
            [origin, direction].concat()
        },
        bound: 8,
        reason: "four roundings of the terms on each side",
    },
    Mirror {
        file: "triangle",
        functions: &["triangle_point"],
        statements: "let hit = triangle_point(Ray(input3(0u), input3(3u)), input3(6u), input3(9u), input3(12u));
            output3(0u, hit.point);
            output3(3u, hit.normal);
            output(6u, hit.u);
            output(7u, hit.v);",
        inputs_each: 15,
        inputs: |_, random| random.groups(&degenerate_triangles(), rays_and_triangles),
        twin: |_, i| {
            let [origin, direction, v0, v1, v2] = [0, 3, 6, 9, 12].map(|first| v3(i, first));
            let hit = triangle_point(Ray { origin, direction }, v0, v1, v2);
            let (e1, e2, s) = (v1 - v0, v2 - v0, origin - v0);
            let determinant = e1.cross(e2).dot(direction).abs();
            // How much the weights move when every product is rounded anew: what cancels, over what it is divided by.
            let (normal, q) = (magnitude_of_cross(e1, e2), magnitude_of_cross(s, direction));
            let lost = (e1.abs().dot(q) + e2.abs().dot(q) + 2.0 * normal.dot(direction.abs())) / determinant;
            let point = v0.abs() + (e1.abs() + e2.abs()) * (1.0 + lost);
            let weights = [hit.u, hit.v].map(|value| Number { value, scale: 1.0 + lost });
            [scaled(hit.point, point), scaled(hit.normal, normal), weights.to_vec()].concat()
        },
        bound: 24,
        reason: "some ten roundings one after the other on each side, and a division",
    },
    Mirror {
        file: "triangle",
        functions: &["turned_to_viewer"],
        statements: "output3(0u, turned_to_viewer(input3(0u), input3(3u), Ray(input3(6u), input3(9u))));",
        inputs_each: 12,
        inputs: |_, random| {
            let mut edge_on = [0.0; 12];
            edge_on[..6].copy_from_slice(&[1.0, 2.0, 3.0, 0.0, 1.0, 0.0]);
            edge_on[9] = 1.0;
            random.groups(&[[0.0; 12], edge_on], |random| random.numbers(5.0))
        },
        twin: |_, i| {
            let (v, normal, direction) = (v3(i, 0), v3(i, 3), v3(i, 9));
            let turned = turned_to_viewer(v, normal, Ray { origin: v3(i, 6), direction });
            let near = is_tie(normal.dot(direction), normal.abs().dot(direction.abs()));
            scaled(turned, if near { Vec3::INFINITY } else { v.abs() })
        },
        bound: 0,
        reason: "a sign, except where the surface is seen edge-on",
    },
    Mirror {
        file: "triangle",
        functions: &["pixel_steps", "plane_step"],
        statements: "let zero = vec4f(0.0, 0.0, 0.0, 0.0);
            let rays = PixelRays(zero, vec4f(input3(12u), 0.0), zero, zero, zero, vec4f(input3(15u), 0.0));
            let steps = pixel_steps(rays, Ray(input3(0u), input3(3u)), input3(6u), input3(9u));
            output3(0u, steps.x);
            output3(3u, steps.y);",
        inputs_each: 18,
        inputs: |_, random| {
            random.groups::<18>(&[], |random| {
                let mut group = random.numbers::<18>(5.0);
                let (direction, normal) = (v3(&group, 3), v3(&group, 9));
                // Rays that do not nearly run along the plane.
                if normal.dot(direction).abs() < 0.2 * normal.length() * direction.length() {
                    group[9..12].copy_from_slice(&(direction + 0.5 * normal).to_array());
                }
                group
            })
        },
        twin: |_, i| {
            let pad = |first: usize| v3(i, first).extend(0.0).to_array();
            let rays = PixelRays { origin_dx: pad(12), direction_dy: pad(15), ..PixelRays::default() };
            let ray = Ray { origin: v3(i, 0), direction: v3(i, 3) };
            let (point, normal) = (v3(i, 6), v3(i, 9));
            let steps = pixel_steps(&rays, ray, point, normal);
            let across = 1.0 + normal.length() * ray.direction.length() / normal.dot(ray.direction).abs();
            let distance = (point - ray.origin).abs().element_sum() * across;
            let scales = [v3(i, 12).length() * across * across, v3(i, 15).length() * distance * across * across];
            let numbers = |step: usize| steps[step].to_array().map(|value| Number { value, scale: scales[step] });
            [numbers(0), numbers(1)].concat()
        },
        bound: 64,
        reason: "two quotients of dot products that may be five times as small as their terms",
    },
    Mirror {
        file: "depth",
        functions: &["encoded_depth", "nearest_whole"],
        statements: "output(0u, encoded_depth(u32(input(0u)), input(1u)));",
        inputs_each: 2,
        inputs: |world, random| {
            random.groups::<2>(&[], |random| {
                let drawn = [0.0, 1.0, 0.5, random.unit(), random.unit() * 1e-6][random.below(5) as usize];
                [random.below(world.globals.views.len() as u32) as f32, drawn]
            })
        },
        twin: |world, i| {
            let view = world.view(i[0]);
            // One step of rounded depth, where a product lies on the border between two.
            let step = if view.depth_steps > 0.0 { f32::INFINITY } else { 1.0 };
            let moved = if view.is_pancaked() { (i[1] * view.drawn_scale + view.drawn_offset).clamp(0.0, 1.0) } else { i[1] };
            let scaled = moved * view.depth_steps;
            let is_border = (scaled - scaled.floor() - 0.5).abs() < 0.01;
            // What is moved onto a pancaked view's planes is a difference of numbers as large as its scale.
            let scale = if is_border { step } else { 1.0 + 2.0 * view.drawn_scale };
            vec![Number { value: encoded_depth(view, i[1]), scale }]
        },
        bound: 4,
        reason: "a quotient of two sums, of which one has a product",
    },
    Mirror {
        file: "depth",
        functions: &["comparable_depth", "receiver_depth", "depth_limits"],
        statements: "let view = u32(input(0u));
            output(0u, comparable_depth(view, input(1u)));
            output(1u, receiver_depth(view, input(1u), input(2u)));
            output(2u, depth_limits(view).x);
            output(3u, depth_limits(view).y);",
        inputs_each: 3,
        inputs: |world, random| {
            random.groups::<3>(&[], |random| {
                [random.below(world.globals.views.len() as u32) as f32, random.unit(), random.within(0.01, 20.0)]
            })
        },
        twin: |world, i| {
            let view = world.view(i[0]);
            let [nearest, farthest] = depth_limits(view);
            let terms = i[2] * view.linear_scale + view.linear_offset.abs();
            let received = Number { value: receiver_depth(view, i[1], i[2]), scale: terms.max(1.0) };
            let exact = |value: f32| Number { value, scale: 1.0 };
            vec![exact(comparable_depth(view, i[1])), received, exact(nearest), exact(farthest)]
        },
        bound: 2,
        reason: "a product and a sum",
    },
    Mirror {
        file: "depth",
        functions: &["linear_bias", "depth_of_two"],
        statements: "let view = u32(input(0u));
            output(0u, linear_bias(view, input(1u), input(2u)));
            output(1u, depth_of_two(view, input(2u), input(3u)));",
        inputs_each: 4,
        inputs: |world, random| {
            random.groups::<4>(&[], |random| {
                let view = random.below(world.globals.views.len() as u32) as f32;
                [view, random.within(0.1, 20.0), [0.0, 1.0, random.unit(), 1e-4][random.below(4) as usize], random.unit()]
            })
        },
        twin: |world, i| {
            let view = world.view(i[0]);
            let of_two = Number { value: depth_of_two(view, i[2], i[3]), scale: 1.0 };
            vec![Number::from(linear_bias(view, i[1], i[2])), of_two]
        },
        bound: 8,
        reason: "a quotient, four products and a sum",
    },
    Mirror {
        file: "caster",
        functions: &["caster_offset", "corner_depth", "depth_unit"],
        statements: "output(0u, caster_offset(u32(input(0u)), input3(1u), input3(4u), input3(7u)));",
        inputs_each: 10,
        inputs: |world, random| {
            random.groups::<10>(&[], |random| {
                let view = random.below(world.globals.views.len() as u32) as f32;
                let (a, b) = (random.vector(6.0), random.vector(1.0));
                // Some triangles have no area.
                let c = if random.below(16) == 0 { b } else { random.vector(1.0) };
                let (b, c) = (a + b, a + c);
                [view, a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z]
            })
        },
        twin: |world, i| {
            let (view, a, b, c) = (world.view(i[0]), v3(i, 1), v3(i, 4), v3(i, 7));
            let value = caster_offset(view, a, b, c);
            let slope = magnitude_of_gradient(view, a, (b - a).cross(c - a));
            let of_normal = 4.0 * ((b - a).abs().dot((c - a).abs()) + a.abs().max_element() * (b - a).abs().max_element());
            let steep = (slope.x + slope.y) * (1.0 + of_normal / (b - a).cross(c - a).length());
            // The unit doubles where the largest depth of a corner crosses a power of two.
            let depth = |p: Vec3| (row_times_point(view.clip_z, p) / row_times_point(view.clip_w, p)).clamp(0.0, 1.0);
            let mantissa = depth(a).max(depth(b)).max(depth(c)).to_bits() & 0x7f_ffff;
            let doubles = view.caster_kind == CASTER_POLYGON_OFFSET && view.depth_steps == 0.0 && !(16..0x7f_fff0).contains(&mantissa);
            let scale = if doubles { f32::INFINITY } else { steep * view.caster_slope + view.caster_units };
            let scale = if view.is_pancaked() { scale / view.drawn_scale } else { scale };
            vec![Number { value, scale: if scale.is_nan() { f32::INFINITY } else { scale } }]
        },
        bound: 64,
        reason: "the gradient of a normal that is itself a difference of products",
    },
    Mirror {
        file: "caster",
        functions: &["pushed_depth"],
        statements: "output(0u, pushed_depth(u32(input(0u)), input(1u), input(2u)));",
        inputs_each: 3,
        inputs: |world, random| {
            random.groups::<3>(&[], |random| {
                let view = random.below(world.globals.views.len() as u32) as f32;
                [view, random.within(-0.1, 1.1), [0.0, 1.0, random.unit(), 1e-3][random.below(4) as usize]]
            })
        },
        twin: |world, i| {
            let view = world.view(i[0]);
            let scale = 2.0 + view.caster_asymptote * view.caster_asymptote * view.caster_push;
            vec![Number { value: pushed_depth(view, i[1], i[2]), scale }]
        },
        bound: 8,
        reason: "three sums and two products",
    },
    Mirror {
        file: "gradient",
        functions: &["depth_gradient", "normal_derivative"],
        statements: "let gradient = depth_gradient(u32(input(0u)), input3(1u), input3(4u));
            output(0u, gradient.x);
            output(1u, gradient.y);",
        inputs_each: 7,
        inputs: |world, random| {
            let view = world.light(NOON).first_view as f32;
            let edges = [
                [view, 1.0, 2.0, 3.0, 1.0, 0.0, 0.0],
                [view, 1.0, 2.0, 3.0, 0.0, 0.0, 0.0],
                [view, 1.0, 2.0, 3.0, 0.0, 1.0, 0.0],
            ];
            random.groups(&edges, |random| {
                let view = random.below(world.globals.views.len() as u32) as f32;
                let (p, n) = (random.vector(6.0), random.vector(2.0));
                [view, p.x, p.y, p.z, n.x, n.y, n.z]
            })
        },
        twin: |world, i| {
            let (view, point, normal) = (world.view(i[0]), v3(i, 1), v3(i, 4));
            let gradient = depth_gradient(view, point, normal);
            let scale = magnitude_of_gradient(view, point, normal);
            vec![Number { value: gradient.x, scale: scale.x }, Number { value: gradient.y, scale: scale.y }]
        },
        bound: 24,
        reason: "seven roundings of each dot product's terms on each side, and a division",
    },
    Mirror {
        file: "bias",
        functions: &["depth_bias", "metres_to_depth"],
        statements: "let needed = needed_depth(u32(input(0u)), u32(input(1u)), input3(2u), input3(5u), input(8u), NO_FOOTPRINT);
            output(0u, depth_bias(u32(input(0u)), u32(input(1u)), needed, input(8u), input(9u)));",
        inputs_each: 10,
        inputs: |world, random| {
            let view = world.light(NOON).first_view as f32;
            let edge_on = [NOON, view, 1.0, 2.0, 3.0, 1.0, 0.0, 0.0, 1.0, 1.0];
            // So near that the constant bias reaches back to the light.
            let reaching = (0..world.globals.lights.len()).map(|light| {
                let first = world.globals.lights[light].first_view as f32;
                [light as f32, first, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.005, 0.005]
            });
            let edges: Vec<_> = [edge_on].into_iter().chain(reaching).collect();
            random.groups(&edges, |random| {
                let [light, x, y, z] = world.light_and_point(random);
                let plan = world.light(light);
                let view = plan.first_view + random.below(plan.view_count);
                let normal = random.vector(1.0);
                let view_plan = world.view(view as f32);
                let [w, distance] = [view_plan.clip_w, view_plan.distance].map(|row| row_times_point(row, Vec3::new(x, y, z)).abs().max(1e-3));
                [light, view as f32, x, y, z, normal.x, normal.y, normal.z, w, distance]
            })
        },
        twin: |world, i| {
            let (light, view, point, normal, w, distance) = (world.light(i[0]), world.view(i[1]), v3(i, 2), v3(i, 5), i[8], i[9]);
            let none = [Vec2::ZERO; 2];
            let value = depth_bias(light, view, needed_depth(light, view, point, normal, w, none), w, distance);
            vec![Number { value, scale: magnitude_of_bias(light, view, point, normal, [w, distance], none) }]
        },
        bound: 48,
        reason: "those of the gradient, and three more divisions",
    },
    Mirror {
        file: "bias",
        functions: &["needed_depth", "normal_offset"],
        statements: "let point = input3(1u);
            let normal = unit_normal(input3(4u));
            let view = lights[u32(input(0u))].first_view;
            let w = row_times_point(views[view].clip_w, point);
            let sides = Footprint(vec2f(input(9u), input(10u)), vec2f(input(11u), input(12u)));
            let needed = needed_depth(u32(input(0u)), view, point, normal, w, sides);
            output(0u, needed);
            output(1u, normal_offset(u32(input(0u)), view, point, normal, needed, w));",
        inputs_each: 15,
        inputs: |world, _| {
            // Only the automatic bias moves lookups so, and it only at grazing angles.
            let is_automatic = |group: &&[f32; 15]| world.light(group[0]).bias == BIAS_AUTOMATIC;
            let automatic = world.receivers.iter().filter(is_automatic);
            automatic.chain(world.receivers.iter().take(COUNT)).copied().collect::<Vec<_>>().concat()
        },
        twin: |world, i| {
            let (light, receiver) = receiver(world, i);
            let view = &world.globals.views[light.first_view as usize];
            let normal = unit_normal(receiver.normal);
            let w = row_times_point(view.clip_w, receiver.point);
            let sides = [Vec2::new(i[9], i[10]), Vec2::new(i[11], i[12])];
            let needed = needed_depth(light, view, receiver.point, normal, w, sides);
            let offset = normal_offset(light, view, receiver.point, normal, needed, w);
            let [needed_scale, offset_scale] = magnitude_of_need(light, view, receiver.point, normal, w, sides);
            vec![Number { value: needed, scale: needed_scale }, Number { value: offset, scale: offset_scale }]
        },
        bound: 64,
        reason: "the gradient of a normal that is itself rounded, and three more products and a quotient",
    },
    Mirror {
        file: "filter",
        functions: &["support"],
        statements: "let sides = Footprint(vec2f(input(3u), input(4u)), vec2f(input(5u), input(6u)));
            output(0u, support(u32(input(0u)), vec2f(input(1u), input(2u)), sides));",
        inputs_each: 7,
        inputs: |world, random| {
            let edges = [[0.0; 7], [0.0, f32::MAX, f32::MAX, 1.0, 1.0, 1.0, 1.0]];
            random.groups(&edges, |random| {
                let light = random.below(world.globals.lights.len() as u32) as f32;
                let [a, b] = [random.vector(0.1), random.vector(9.0)];
                [light, a.x, a.y, a.z * 90.0, b.x, b.y, b.z]
            })
        },
        twin: |world, i| {
            let sides = [Vec2::new(i[3], i[4]), Vec2::new(i[5], i[6])];
            let scale = 1.0 + sides[0].abs().element_sum() + sides[1].abs().element_sum();
            vec![Number { value: support(world.light(i[0]), Vec2::new(i[1], i[2]), sides), scale }]
        },
        bound: 16,
        reason: "two quotients, two products of each side, and a square root",
    },
    Mirror {
        file: "bias",
        functions: &["normal_step", "plane_limit", "texel_width", "column_step", "across"],
        statements: "let point = input3(1u);
            let normal = unit_normal(input3(4u));
            let view = lights[u32(input(0u))].first_view;
            let w = row_times_point(views[view].clip_w, point);
            output(0u, normal_step(u32(input(0u)), view, point, normal, w));
            let along = row_times_point(views[view].distance, point);
            output(1u, plane_limit(u32(input(0u)), view, max(w, 0.5), max(along, 0.5)));
            output(2u, texel_width(u32(input(0u)), view, point, w));",
        inputs_each: 15,
        inputs: |world, _| world.receivers.concat(),
        twin: |world, i| {
            let (light, receiver) = receiver(world, i);
            let view = &world.globals.views[light.first_view as usize];
            let normal = unit_normal(receiver.normal);
            let w = row_times_point(view.clip_w, receiver.point);
            let step = normal_step(light, view, receiver.point, normal, w);
            // The sine of small angles is lost in one minus the cosine's square.
            let width = texel_width(light, view, receiver.point, w);
            let texel = if view.is_warped == 0 {
                view.texel_metres[0].max(view.texel_metres[1]) * magnitude_of_row(view.clip_w, receiver.point)
            } else {
                let column = |column: [f32; 4]| v3(&column, 0).abs().element_sum() + column[3].abs() * receiver.point.abs().element_sum();
                (column(view.world_from_texel_x) + column(view.world_from_texel_y)) * magnitude_of_row(view.clip_w, receiver.point)
            };
            let along = row_times_point(view.distance, receiver.point);
            let limit = plane_limit(light, view, w.max(0.5), along.max(0.5));
            let scale = 1.0 + limit.abs() * (1.0 + light.plane_metres) * 4.0;
            let lost = if normal.is_finite() { light.normal_texels * texel * 4096.0 } else { f32::INFINITY };
            vec![Number { value: step, scale: lost }, Number { value: limit, scale }, Number { value: width, scale: texel }]
        },
        bound: 64,
        reason: "a square root of what is left of one",
    },
    Mirror {
        file: "filter",
        functions: &["tap_depth", "tap_test"],
        statements: "let asked = Lookup(lights[u32(input(0u))].first_view, 0.0, vec2f(input(1u), input(2u)), input(3u), 0.0, vec2f(1.0, 0.0), NO_FOOTPRINT, vec2f(input(4u), input(5u)),
            input(6u));
            output(0u, tap_depth(u32(input(0u)), asked, i32(input(7u)), i32(input(8u))));",
        inputs_each: 9,
        inputs: |world, random| {
            random.groups::<9>(&[], |random| {
                let light = random.below(world.globals.lights.len() as u32) as f32;
                let [x, y] = [random.within(0.0, 32.0), random.within(0.0, 32.0)];
                let [slope_x, slope_y] = [random.within(-0.1, 0.1), random.within(-0.1, 0.1)];
                [light, x, y, random.unit(), slope_x, slope_y, random.unit() * 0.2, (x + random.within(-3.0, 3.0)).floor(), y.floor()]
            })
        },
        twin: |world, i| {
            let lookup = Lookup {
                texel: Vec2::new(i[1], i[2]),
                depth: i[3],
                slope: Vec2::new(i[4], i[5]),
                slope_limit: i[6],
                ..Lookup::default()
            };
            let view = &world.globals.views[world.light(i[0]).first_view as usize];
            vec![Number { value: tap_depth(world.light(i[0]), view, &lookup, i[7] as i32, i[8] as i32), scale: 4.0 }]
        },
        bound: 16,
        reason: "differences of texels, times a slope",
    },
    Mirror {
        file: "filter",
        functions: &["stored_gradient", "stored"],
        statements: "output(0u, stored_gradient(u32(input(1u)), u32(input(0u)), vec2f(input(2u), input(3u))));",
        inputs_each: 4,
        inputs: |world, random| {
            random.groups::<4>(&[], |random| {
                let lights = world.globals.lights.iter().enumerate().filter(|(_, light)| light.bias & BIAS_RECEIVER_GRADIENT != 0);
                let lights: Vec<f32> = lights.map(|(index, _)| index as f32).collect();
                let [view, x, y] = world.view_and_texel(random);
                [lights[random.below(lights.len() as u32) as usize], view, x, y]
            })
        },
        twin: |world, i| {
            let value = stored_gradient(&world.map(), world.view(i[1]), world.light(i[0]), Vec2::new(i[2], i[3]));
            let at_border = (Vec2::new(i[2], i[3]) - Vec2::new(i[2], i[3]).round()).abs().min_element() == 0.0;
            vec![Number { value, scale: if at_border { 4.0 } else { 1.0 } }]
        },
        bound: 8,
        reason: "differences of depths, a product and a sum",
    },
    Mirror {
        file: "filter",
        functions: &["turn_of_pixel"],
        statements: "let turn = turn_of_pixel(vec2u(u32(input(0u)), u32(input(1u))));
            output(0u, turn.x);
            output(1u, turn.y);",
        inputs_each: 2,
        inputs: |_, random| random.groups::<2>(&[], |random| [random.below(9999) as f32, random.below(9999) as f32]),
        twin: |_, i| turn_of_pixel([i[0] as u32, i[1] as u32]).to_array().map(Number::from).to_vec(),
        bound: 0,
        reason: "a table",
    },
    Mirror {
        file: "filter",
        functions: &["depth_test"],
        statements: "output(0u, depth_test(u32(input(0u)), i32(input(1u)), i32(input(2u)), input(3u), input(4u)));",
        inputs_each: 5,
        inputs: |world, random| {
            random.groups::<5>(&[], |random| {
                let [view, x, y] = world.view_and_texel(random).map(f32::floor);
                let bias = random.bias();
                [view, x, y, world.depth_near(random, view, x, y, bias), bias]
            })
        },
        twin: |world, i| {
            let value = depth_test(&world.map(), world.view(i[0]), i[1] as i32, i[2] as i32, i[3], i[4]);
            let (view, texel) = (i[0] as u32, Vec2::new(i[1], i[2]));
            let lookup = Lookup { view, texel, depth: i[3], bias: i[4], ..Lookup::default() };
            vec![Number { value, scale: world.scale_of_tests(&LightPlan::default(), &lookup, 0.0) }]
        },
        bound: 0,
        reason: "0 or 1, except where the depths tie",
    },
    Mirror {
        file: "filter",
        functions: &["disc_place", "footprint_place", "footprint_count"],
        statements: "let sides = Footprint(vec2f(input(6u), input(7u)), vec2f(input(8u), input(9u)));
            let asked = Lookup(0u, 0.0, vec2f(input(2u), input(3u)), 0.0, 0.0, vec2f(input(4u), input(5u)), sides, vec2f(0.0, 0.0), 0.0);
            let of_disc = disc_place(u32(input(0u)), asked, u32(input(1u)));
            output(0u, of_disc.x);
            output(1u, of_disc.y);
            let counts = vec2u(footprint_count(asked.footprint.x), footprint_count(asked.footprint.y));
            output(2u, f32(counts.x));
            let at = vec2u(u32(input(1u)) % counts.x, u32(input(1u)) % counts.y);
            let of_footprint = footprint_place(asked, at, counts);
            output(3u, of_footprint.x);
            output(4u, of_footprint.y);",
        inputs_each: 10,
        inputs: |world, random| {
            random.groups::<10>(&[], |random| {
                let light = random.below(world.globals.lights.len() as u32) as f32;
                let [_, x, y] = world.view_and_texel(random);
                let turn = turn_of_pixel([random.below(4), random.below(4)]);
                let [a, b] = [random.vector(4.0), random.vector(4.0)];
                [light, random.below(16) as f32, x, y, turn.x, turn.y, a.x, a.y, b.x, b.y]
            })
        },
        twin: |world, i| {
            let lookup = Lookup {
                texel: Vec2::new(i[2], i[3]),
                turn: Vec2::new(i[4], i[5]),
                footprint: [Vec2::new(i[6], i[7]), Vec2::new(i[8], i[9])],
                ..Lookup::default()
            };
            let tap = i[1] as u32;
            let light = world.light(i[0]);
            let of_disc = disc_place(light, &lookup, tap);
            let counts = footprint_counts(&lookup);
            let of_footprint = footprint_place(&lookup, [tap % counts[0], tap % counts[1]], counts);
            // A side of a whole number of half texels is a choice of its own.
            let is_choice = lookup.footprint.iter().any(|side| (2.0 * side.abs().max_element()).fract() < 1e-6);
            let choice = if is_choice { f32::INFINITY } else { 1.0 };
            let reach = 32.0 + light.filter_table.as_flattened().iter().fold(0.0_f32, |most, x| most.max(x.abs()));
            [(of_disc.x, reach), (of_disc.y, reach), (counts[0] as f32, choice), (of_footprint.x, 40.0 * choice), (of_footprint.y, 40.0 * choice)]
                .map(|(value, scale)| Number { value, scale })
                .to_vec()
        },
        bound: 4,
        reason: "two products and two sums, the larger of which are texels",
    },
    Mirror {
        file: "filter",
        functions: &[
            "filtered_test",
            "test_at",
            "bilinear_test",
            "kernel_weight",
            "separable_test",
            "cross_test",
            "disc_test",
            "footprint_test",
        ],
        statements: "let sides = Footprint(vec2f(input(8u), input(9u)), vec2f(input(10u), input(11u)));
            let asked = Lookup(u32(input(1u)), 0.0, vec2f(input(2u), input(3u)), input(4u), input(5u), vec2f(input(6u), input(7u)), sides, vec2f(input(12u), input(13u)), input(14u));
            output(0u, filtered_test(u32(input(0u)), asked));",
        inputs_each: 15,
        inputs: |world, random| {
            random.groups::<15>(&[], |random| {
                let light = random.below(world.globals.lights.len() as u32) as f32;
                let [view, x, y] = world.view_and_texel(random);
                let bias = random.bias();
                let turn = turn_of_pixel([random.below(4), random.below(4)]);
                let size = if random.below(2) == 0 { 1.0 } else { 12.0 };
                let [a, b] = [random.vector(size), random.vector(size)];
                let depth = world.depth_near(random, view, x.floor(), y.floor(), bias);
                let slopes = [random.within(-0.05, 0.05), random.within(-0.05, 0.05), random.unit() * 0.1];
                [light, view, x, y, depth, bias, turn.x, turn.y, a.x, a.y, b.x, b.y, slopes[0], slopes[1], slopes[2]]
            })
        },
        twin: |world, i| {
            let light = world.light(i[0]);
            let lookup = Lookup {
                view: i[1] as u32,
                known: 0.0,
                texel: Vec2::new(i[2], i[3]),
                depth: i[4],
                bias: i[5],
                turn: Vec2::new(i[6], i[7]),
                footprint: [Vec2::new(i[8], i[9]), Vec2::new(i[10], i[11])],
                slope: Vec2::new(i[12], i[13]),
                slope_limit: i[14],
            };
            let value = filtered_test(&world.map(), world.view(i[1]), light, &lookup);
            // A turned place may be rounded over a border; a place that is given may not.
            let mut is_choice = false;
            if light.filter > FILTER_SEPARABLE {
                for_each_test_place(light, &lookup, |place| is_choice |= (place - place.round()).abs().min_element() < 1e-4);
            }
            let scale = world.scale_of_tests(light, &lookup, 0.0);
            vec![Number { value, scale: if is_choice { f32::INFINITY } else { scale } }]
        },
        bound: 64,
        reason: "a hundred weighted zeros and ones",
    },
    Mirror {
        file: "visibility",
        functions: &["cube_face_of"],
        statements: "output(0u, f32(cube_face_of(input3(0u))));",
        inputs_each: 3,
        inputs: |_, random| {
            let ties = (0..27_u8).map(|i| [i % 3, i / 3 % 3, i / 9].map(|x| f32::from(x) - 1.0));
            let edges: Vec<_> = ties.chain([[-0.0; 3]]).collect();
            random.groups(&edges, |random| random.vector(3.0).to_array())
        },
        twin: |_, i| vec![(cube_face_of(v3(i, 0)) as f32).into()],
        bound: 0,
        reason: "comparisons of the inputs themselves",
    },
    Mirror {
        file: "visibility",
        functions: &["choose_views", "distance_to_rim"],
        statements: "let choice = choose_views(u32(input(0u)), Receiver(input3(1u), input3(4u), vec2u(0u, 0u), PixelSteps(input3(9u), input3(12u))));
            output(0u, select(f32(choice.first), -1.0, choice.first == NO_VIEW));
            output(1u, select(f32(choice.second), -1.0, choice.second == NO_VIEW));
            output(2u, choice.share);
            output(3u, choice.known);",
        inputs_each: 15,
        inputs: |world, _| world.receivers.concat(),
        twin: |world, i| {
            let (light, receiver) = receiver(world, i);
            let choice = choose_views(light, &world.globals.views, &receiver);
            let scale = if world.is_near_choice(light, &receiver) { f32::INFINITY } else { 1.0 };
            let index = |view: u32| if view == NO_VIEW { -1.0 } else { view as f32 };
            // What is left of a band, in its own widths: a difference of distances over it.
            let band = light.split_band.as_flattened().iter().copied().fold(f32::INFINITY, |least, band| if band > 0.0 { least.min(band) } else { least });
            let lost = magnitude_of_row(light.view_distance, receiver.point).max(64.0) / band.min(1.0);
            let share = Number { value: choice.share, scale: if choice.share > 0.0 { scale * lost } else { scale } };
            let [first, second, known] = [index(choice.first), index(choice.second), choice.known].map(|value| Number { value, scale });
            vec![first, second, share, known]
        },
        bound: 48,
        reason: "choices are exact but where a cascade ends; a share is what is left of a difference",
    },
    Mirror {
        file: "visibility",
        functions: &["lookup", "lookup_in_view", "known_lookup", "footprint", "footprint_side"],
        statements: "let found = lookup(u32(input(0u)), Receiver(input3(1u), input3(4u), vec2u(u32(input(7u)), u32(input(8u))), PixelSteps(input3(9u), input3(12u))));
            output(0u, select(f32(found.view), -1.0, found.view == NO_VIEW));
            output(1u, found.known);
            output(2u, found.texel.x);
            output(3u, found.texel.y);
            output(4u, found.depth);
            output(5u, found.bias);
            output(6u, found.turn.x);
            output(7u, found.footprint.x.x);
            output(8u, found.footprint.y.y);
            output(9u, found.slope.x);
            output(10u, found.slope_limit);",
        inputs_each: 15,
        inputs: |world, _| world.receivers.concat(),
        twin: |world, i| {
            let (light, receiver) = receiver(world, i);
            let found = lookup(light, &world.globals.views, &receiver);
            let scale = world.scale_of_lookup(light, &receiver);
            let view = if found.view == NO_VIEW { -1.0 } else { found.view as f32 };
            let [x, y, depth, bias] =
                [(found.texel.x, scale[0]), (found.texel.y, scale[1]), (found.depth, scale[2]), (found.bias, scale[3])]
                    .map(|(value, scale)| Number { value, scale });
            // Any number may be infinitely wrong only together with the choice among the answers.
            let choice = if scale[0].is_finite() { 1.0 } else { f32::INFINITY };
            let [view, known] = [view, found.known].map(|value| Number { value, scale: choice });
            let turn = Number { value: found.turn.x, scale: choice };
            let sides = world.scale_of_footprint(light, &receiver);
            // A gradient has a mirror of its own, and so has the limit.
            let [slope, limit] = [found.slope.x, found.slope_limit].map(|value| Number { value, scale: choice * (1.0 + value.abs()) * 1e3 });
            let side = |value, scale: f32| Number { value, scale: scale * choice };
            vec![view, known, x, y, depth, bias, turn, side(found.footprint[0].x, sides), side(found.footprint[1].y, sides), slope, limit]
        },
        bound: 48,
        reason: "a quotient of two rows, and the bias; the answer's kind is exact but at the borders",
    },
    Mirror {
        file: "visibility",
        functions: &["visibility", "visibility_in_view"],
        statements: "output(0u, visibility(u32(input(0u)), Receiver(input3(1u), input3(4u), vec2u(u32(input(7u)), u32(input(8u))), PixelSteps(input3(9u), input3(12u)))));",
        inputs_each: 15,
        inputs: |world, _| world.receivers.concat(),
        twin: |world, i| {
            let (light, receiver) = receiver(world, i);
            let views = &world.globals.views;
            let value = visibility(light, views, &world.map(), &receiver);
            let choice = choose_views(light, views, &receiver);
            if choice.share > 0.0 {
                // A mean of two, each of which jumps: those that are the same are looked at.
                let [first, second] = [choice.first, choice.second].map(|view| visibility_in_view(light, views, &world.map(), view, &receiver));
                let is_decided = first == second && !world.is_near_jump(light, &receiver);
                return vec![Number { value, scale: if is_decided { 1.0 } else { f32::INFINITY } }];
            }
            let scale = world.scale_of_lookup(light, &receiver);
            let found = lookup(light, views, &receiver);
            // The contract's: a hard test jumps at a texel's border.
            let mut at_border = false;
            for_each_test_place(light, &found, |place| at_border |= (place - place.round()).abs().min_element() < 1.0 / 256.0);
            let known = found.view == NO_VIEW;
            let tests = if known {
                1.0
            } else {
                // What rounding may add to both sides of the comparison.
                let lost = 48.0 * (unit_of(scale[2]) + unit_of(scale[3]));
                world.scale_of_tests(light, &found, lost)
            };
            let undecided = !scale[0].is_finite() || (at_border && !known);
            vec![Number { value, scale: if undecided { f32::INFINITY } else { tests } }]
        },
        bound: 1 << 15,
        reason: "1/256, as the contract says of pictures, except where a test ties or a lookup lies on a border",
    },
    Mirror {
        file: "approx",
        functions: &["approx_log2"],
        statements: "output(0u, approx_log2(input(0u)));",
        inputs_each: 1,
        inputs: |_, random| {
            let edges = [
                1.0,
                2.0,
                0.5,
                f32::MIN_POSITIVE,
                f32::MAX,
                std::f32::consts::FRAC_1_SQRT_2,
                std::f32::consts::SQRT_2,
                1.000_000_1,
            ];
            random.groups(&edges.map(|x| [x]), |random| [random.positive()])
        },
        twin: |_, i| vec![approx::log2(i[0]).into()],
        bound: 16,
        reason: "a division, and a series in which each term has its rounding",
    },
    Mirror {
        file: "approx",
        functions: &["approx_exp2"],
        statements: "output(0u, approx_exp2(input(0u)));",
        inputs_each: 1,
        inputs: |_, random| {
            let edges = [0.0, 1.0, -1.0, 0.5, -0.5, 0.499_999_97, -126.0, -126.000_01, -127.0, 127.0, 127.4, 200.0, 1e30, -1e30];
            random.groups(&edges.map(|x| [x]), |random| [random.within(-140.0, 140.0)])
        },
        twin: |_, i| vec![approx::exp2(i[0]).into()],
        bound: 8,
        reason: "a series in which each term has its rounding",
    },
    Mirror {
        file: "approx",
        functions: &["approx_pow"],
        statements: "output(0u, approx_pow(input(0u), input(1u)));",
        inputs_each: 2,
        inputs: |_, random| {
            let bases = [0.0, -0.0, -1.0, f32::NAN, f32::MIN_POSITIVE, 1e-40, 1.0, 0.999_999_9];
            let edges: Vec<_> = bases.into_iter().flat_map(|x| [1.0, 2.0, 2048.0, 0.0].map(|y| [x, y])).collect();
            random.groups(&edges, |random| {
                if random.below(2) == 0 {
                    [random.unit(), random.within(1.0, 2048.0)]
                } else {
                    [random.positive(), random.within(-2.0, 2.0)]
                }
            })
        },
        twin: |_, i| {
            let value = approx::pow(i[0], i[1]);
            vec![Number { value, scale: value * (1.0 + (i[1] * i[0].log2()).abs()) }]
        },
        bound: 24,
        reason: "the logarithm's error times the exponent",
    },
    Mirror {
        file: "srgb",
        functions: &["linear_to_srgb"],
        statements: "output(0u, linear_to_srgb(input(0u)));",
        inputs_each: 1,
        inputs: |_, random| {
            let limit = 0.003_130_8_f32;
            let edges =
                [0.0, 1.0, -1.0, 7.0, limit, limit.next_up(), limit.next_down(), f32::INFINITY, f32::NEG_INFINITY, f32::NAN];
            random.groups(&edges.map(|x| [x]), |random| {
                [if random.below(4) == 0 { random.unit() * 0.01 } else { random.unit() * 1.1 }]
            })
        },
        twin: |_, i| {
            let value = linear_to_srgb(i[0]);
            vec![Number { value, scale: value + 0.055 }]
        },
        bound: 96,
        reason: "a power whose exponent is at most 4",
    },
    Mirror {
        file: "material",
        functions: &["wrap_texel"],
        statements: "output(0u, f32(wrap_texel(i32(input(0u)), i32(input(1u)), u32(input(2u)))));",
        inputs_each: 3,
        inputs: |_, random| {
            random.groups::<3>(&[], |random| {
                let size = [1, 2, 3, 5, 16, 1024][random.below(6) as usize];
                let reach = if random.below(2) == 0 { 3 * size + 1 } else { 8_388_609 };
                let index = random.below(2 * reach + 1) as i32 - reach as i32;
                [index as f32, size as f32, random.below(WRAP_MIRROR + 1) as f32]
            })
        },
        twin: |_, i| vec![(wrap_texel(i[0] as i32, i[1] as i32, i[2] as u32) as f32).into()],
        bound: 0,
        reason: "integers",
    },
    Mirror {
        file: "material",
        functions: &["decode_texel"],
        statements: "let color = decode_texel(u32(input(0u)) << 16u | u32(input(1u)));
            output3(0u, color.xyz);
            output(3u, color.w);",
        inputs_each: 2,
        inputs: |_, random| {
            // Every byte as alpha and as blue, then as green and as red.
            let edges: Vec<_> =
                (0..=255_u16).flat_map(|byte| [[257.0 * f32::from(byte), 0.0], [0.0, 257.0 * f32::from(byte)]]).collect();
            random.groups(&edges, |random| [random.below(65_536) as f32, random.below(65_536) as f32])
        },
        twin: |world, i| numbers(decode_texel(&world.globals.words, (i[0] as u32) << 16 | i[1] as u32).to_array()),
        bound: 0,
        reason: "a table",
    },
    Mirror {
        file: "material",
        functions: &["sample_texture"],
        statements: "let color = sample_texture(materials[u32(input(0u))].texture, vec2f(input(1u), input(2u)));
            output3(0u, color.xyz);
            output(3u, color.w);",
        inputs_each: 3,
        inputs: |world, random| random.groups(&world.edges_of_textures(), |random| world.texture_coordinates(random)),
        twin: |world, i| {
            let texture = world.globals.materials[i[0] as usize].texture;
            let color = sample_texture(&world.globals.words, &texture, Vec2::new(i[1], i[2]));
            color.to_array().map(|value| Number { value, scale: texel_distance(&texture, i[1], i[2]) }).to_vec()
        },
        bound: 4,
        reason: "the rounding of the texel coordinate, over which no colour changes by more than 1 a texel",
    },
    Mirror {
        file: "material",
        functions: &["base_color"],
        statements: "let color = base_color(u32(input(0u)), vec2f(input(1u), input(2u)), vec4f(input3(3u), input(6u)));
            output3(0u, color.xyz);
            output(3u, color.w);",
        inputs_each: 7,
        inputs: |world, random| {
            let plain = world.globals.materials.len() as f32 - 1.0;
            random.groups(&[[plain, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8], [0.0; 7]], |random| {
                let [mut material, u, v] = world.texture_coordinates(random);
                if random.below(8) == 0 {
                    material = plain;
                }
                [material, u, v, random.unit(), random.unit(), random.unit(), random.unit()]
            })
        },
        twin: |world, i| {
            let material = &world.globals.materials[i[0] as usize];
            let color = base_color(material, &world.globals.words, Vec2::new(i[1], i[2]), Vec4::new(i[3], i[4], i[5], i[6]));
            color.to_array().map(|value| Number { value, scale: texel_distance(&material.texture, i[1], i[2]) }).to_vec()
        },
        bound: 6,
        reason: "those of the texture, and two products",
    },
    Mirror {
        file: "picture",
        functions: &["picture_color"],
        statements: "output3(0u, picture_color(u32(input(0u)), input3(1u)));",
        inputs_each: 4,
        inputs: |world, random| {
            let lights = &world.globals.lights;
            let projecting: Vec<usize> = (0..lights.len()).filter(|&light| lights[light].picture_width > 0).collect();
            random.groups::<4>(&[], |random| {
                // Points around the cone of a light with a picture; some of them, and lights without one, anywhere.
                let light = projecting[random.below(projecting.len() as u32) as usize];
                let [other, x, y, z] = world.light_and_point(random);
                if random.below(4) == 0 {
                    return [other, x, y, z];
                }
                let plan = &lights[light];
                let distance = random.within(0.5, 12.0);
                let point = Vec3::from(plan.position) + (Vec3::from(plan.axis) + random.vector(0.6)) * distance;
                [light as f32, point.x, point.y, point.z]
            })
        },
        twin: |world, i| {
            let (light, point) = (world.light(i[0]), v3(i, 1));
            let value = picture_color(&world.globals.words, light, point);
            if light.picture_width == 0 {
                return scaled(value, Vec3::ONE);
            }
            // Beside an edge of the picture, and where a place is as rough as a texel, rounding decides.
            let w = row_times_point(light.picture_w, point);
            let terms = |row: [f32; 4]| magnitude_of_row(row, point) / w.abs();
            let place = |row: [f32; 4]| row_times_point(row, point) / w;
            let is_edge = light.picture_width > 0
                && (w.abs() < 1e-3
                    || [light.picture_x, light.picture_y].into_iter().any(|row| {
                        let near = 1e-5 * (1.0 + terms(row));
                        place(row).abs() < near || (place(row) - 1.0).abs() < near
                    }));
            let scale = 1.0 + (terms(light.picture_x) + terms(light.picture_y)) * light.picture_width.max(light.picture_height) as f32;
            scaled(value, Vec3::splat(if is_edge || !scale.is_finite() { f32::INFINITY } else { scale }))
        },
        bound: 64,
        reason: "a place that is rounded, in texels, and a bilinear sample",
    },
    Mirror {
        file: "shade",
        functions: &["attenuation"],
        statements: "output(0u, attenuation(u32(input(0u)), input3(1u)));",
        inputs_each: 4,
        inputs: lights_and_offsets,
        twin: |world, i| {
            let light = world.light(i[0]);
            vec![Number { value: attenuation(light, v3(i, 1)), scale: magnitude_of_attenuation(light, v3(i, 1)) }]
        },
        bound: 32,
        reason: "a square root and divisions; the cone's edge is as steep as its scale",
    },
    Mirror {
        file: "shade",
        functions: &["light_reach"],
        statements: "output(0u, light_reach(u32(input(0u)), input3(1u)));",
        inputs_each: 4,
        inputs: lights_and_offsets,
        twin: |world, i| {
            let light = world.light(i[0]);
            let toward = v3(i, 1);
            // Attenuation is this over the distance's square.
            let scale = magnitude_of_attenuation(light, toward) * toward.length_squared().max(1.0);
            vec![Number { value: light_reach(light, toward), scale: scale.max(1.0) }]
        },
        bound: 32,
        reason: "a square root and divisions; the cone's edge is as steep as its scale",
    },
    Mirror {
        file: "shade",
        functions: &["softened_terminator"],
        statements: "output(0u, softened_terminator(input(0u), input(1u)));",
        inputs_each: 2,
        inputs: |_, random| {
            let edges = [[0.0; 2], [1.0; 2], [0.5, 0.0], [0.25, 0.25], [0.5, 0.25]];
            random.groups(&edges, |random| [random.unit(), random.within(0.0, MAX_DEVIATION)])
        },
        // The share is a difference over the deviation.
        twin: |_, i| vec![Number { value: softened_terminator(i[0], i[1]), scale: 1.0 + i[0] / i[1].max(1e-3) }],
        bound: 8,
        reason: "a difference, a quotient and three products",
    },
    Mirror {
        file: "shade",
        functions: &["shade_light"],
        statements: "let surface = Surface(input3(1u), input3(4u), input(7u), input3(8u), input3(11u), input(14u));
            output3(0u, shade_light(u32(input(0u)), surface, input(15u)));",
        inputs_each: 16,
        inputs: |world, random| random.groups::<16>(&[], |random| world.light_and_surface(random)),
        twin: |world, i| {
            let (light, surface) = (world.light(i[0]), surface(&i[1..]));
            let toward = toward_light(light, surface.point);
            let specular = (surface.shininess + 8.0) * (surface.shininess + 8.0);
            let scale = Vec3::from(light.intensity) * (surface.base_color + specular) * magnitude_of_attenuation(light, toward);
            scaled(shade_light(light, &surface, i[15]), scale)
        },
        bound: 64,
        reason: "a power of a rounded cosine: its error times the exponent",
    },
    Mirror {
        file: "shade",
        functions: &["shadow_factor"],
        statements: "output3(0u, shadow_factor(input3(0u), input(3u), input(4u)));",
        inputs_each: 5,
        inputs: |_, random| random.groups::<5>(&[[0.0; 5], [1.0; 5]], |random| [random.unit(), random.unit(), random.unit(), random.unit(), random.unit()]),
        twin: |_, i| scaled(shadow_factor(v3(i, 0), i[3], i[4]), Vec3::ONE),
        bound: 3,
        reason: "three sums and two products",
    },
    Mirror {
        file: "shade",
        functions: &["shade_ambient"],
        statements: "let surface = Surface(input3(3u), input3(6u), input(9u), input3(10u), input3(13u), input(16u));
            output3(0u, shade_ambient(input3(0u), surface));",
        inputs_each: 17,
        inputs: |world, random| {
            random.groups(&[[0.0; 17]], |random| {
                let ambient = (random.vector(1.0) * 20_000.0).abs();
                let mut group = [0.0; 17];
                group[..3].copy_from_slice(&ambient.to_array());
                group[3..].copy_from_slice(&world.light_and_surface(random)[1..15]);
                group
            })
        },
        twin: |_, i| numbers(shade_ambient(v3(i, 0), &surface(&i[3..])).to_array()),
        bound: 4,
        reason: "two products in either order",
    },
];

macro_rules! files {
    ($($file:ident),* $(,)?) => {
        /// The files that have a test of their own below.
        const TESTED_FILES: &[&str] = &[$(stringify!($file)),*];

        /// One test a file.
        mod every_function_of {
            $(
                #[test]
                fn $file() {
                    super::check_file(stringify!($file));
                }
            )*
        }
    };
}

files!(vector, light, triangle, depth, gradient, caster, bias, filter, visibility, approx, srgb, material, picture, shade);

fn check_file(file: &str) {
    let mut problems = Vec::new();
    for mirror in TABLE.iter().filter(|mirror| mirror.file == file) {
        let (inputs, expected) = mirror.in_rust();
        let actual = mirror.on_the_gpu(&inputs);
        let rules = gpu().adapter().rules;
        problems.extend(mirror.judge(rules, &inputs, &expected, &actual).err());
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn every_mirrored_function_is_tested() {
    for file in MIRRORS {
        for function in file.source.lines().filter_map(|line| line.strip_prefix("fn ")?.split('(').next()) {
            let tested = TABLE.iter().any(|mirror| mirror.file == file.stem && mirror.functions.contains(&function));
            assert!(tested, "{}.wgsl: nothing compares `{function}` with its Rust twin", file.stem);
        }
        let has_functions = file.source.lines().any(|line| line.starts_with("fn "));
        assert_eq!(
            TESTED_FILES.contains(&file.stem),
            has_functions,
            "{}.wgsl: the list of tested files is not up to date",
            file.stem
        );
    }
    for mirror in TABLE {
        let file =
            MIRRORS.iter().find(|file| file.stem == mirror.file).unwrap_or_else(|| panic!("there is no {}.wgsl", mirror.file));
        for function in mirror.functions {
            assert!(file.source.contains(&format!("fn {function}(")), "{}.wgsl has no function `{function}`", mirror.file);
        }
        assert!(!mirror.reason.is_empty(), "the bound of {} has no reason", mirror.functions[0]);
    }
}

/// Inputs that all give the same answer would not tell a function from a constant.
#[test]
fn the_inputs_reach_different_answers() {
    for mirror in TABLE {
        let (inputs, expected) = mirror.in_rust();
        assert!(inputs.len() / mirror.inputs_each >= COUNT, "{} meets few inputs", mirror.functions[0]);
        let outputs_each = expected.len() / (inputs.len() / mirror.inputs_each);
        for output in 0..outputs_each {
            let first = expected[output].value.to_bits();
            let others =
                expected.iter().skip(output).step_by(outputs_each).filter(|number| number.value.to_bits() != first).count();
            assert!(others * 50 >= COUNT, "{}: output {output} is nearly always {}", mirror.functions[0], f32::from_bits(first));
        }
        let undecided = expected.iter().filter(|number| !number.scale.is_finite()).count();
        assert!(undecided * 2 < expected.len(), "{}: most of the answers are left to the driver", mirror.functions[0]);
    }
}

/// Every way through a lookup is taken often, for every kind of light.
#[test]
fn receivers_take_every_way() {
    let world = World::get();
    let is_finer = |view: &&ViewPlan| view.drawn_scale > 1.25;
    assert!(world.globals.views.iter().filter(is_finer).count() > 20, "too few views are pancaked");
    for index in 0..world.globals.lights.len() {
        let (mut turned_away, mut outside, mut compared, mut lit, mut shadowed) = (0, 0, 0, 0, 0);
        let of_light = world.receivers.iter().filter(|group| group[0] == index as f32);
        for group in of_light {
            let (light, receiver) = receiver(world, group);
            let found = lookup(light, &world.globals.views, &receiver);
            let value = visibility(light, &world.globals.views, &world.map(), &receiver);
            match (found.view == NO_VIEW, found.known) {
                (true, 0.0) => turned_away += 1,
                (true, _) => outside += 1,
                _ => compared += 1,
            }
            lit += usize::from(found.view != NO_VIEW && value == 1.0);
            shadowed += usize::from(found.view != NO_VIEW && value == 0.0);
        }
        let plan = &world.globals.lights[index];
        // Nothing lies outside of a cube.
        let outside_wanted = plan.split == SPLIT_SINGLE;
        // Of a hundred tests of a noisy map some pass and some do not.
        let is_narrow = plan.filter <= FILTER_BILINEAR;
        // Of z / w that begins near a light a step of 16 bits is most of the way, and the bias reckons with it.
        let is_coarse = world.globals.views[plan.first_view as usize].depth_steps == Store::Depth16.steps();
        for (what, count, wanted) in [
            ("turned away", turned_away, true),
            ("outside", outside, outside_wanted),
            ("compared", compared, true),
            ("lit", lit, is_narrow),
            ("shadowed", shadowed, is_narrow && !is_coarse),
        ] {
            assert!(!wanted || count >= 5, "light {index}: only {count} receivers are {what}");
        }
    }
}

/// The comparison must see a function that is not the twin, on a driver of either kind.
#[test]
fn a_function_that_is_not_the_twin_is_seen() {
    let scaled_input = "output3(0u, cross3(input3(0u), input3(3u)) * input(6u));";
    let altered = [
        ("dot3", "let a = input3(0u); let b = input3(3u); output(0u, a.x * b.x + a.y * b.y - a.z * b.z);"),
        ("cross3", "output3(0u, cross3(input3(3u), input3(0u)));"),
        ("row_times_point", "output(0u, row_times_point(vec4f(input3(0u), input(6u)), input3(4u)));"),
        ("cube_face_of", "output(0u, f32(cube_face_of(-input3(0u))));"),
        ("depth_test", "output(0u, depth_test(u32(input(0u)), i32(input(2u)), i32(input(1u)), input(3u), input(4u)));"),
        ("approx_log2", "output(0u, log2(input(0u)) + input(0u));"),
        ("wrap_texel", "output(0u, f32(wrap_texel(i32(input(0u)) + 1, i32(input(1u)), u32(input(2u)))));"),
        (
            "visibility",
            "var receiver = Receiver(input3(1u), input3(4u), vec2u(u32(input(7u)), u32(input(8u))), PixelSteps(input3(9u), input3(12u))); receiver.normal = -receiver.normal;
            output(0u, visibility(u32(input(0u)), receiver));",
        ),
    ];
    for (function, statements) in altered {
        let mirror = Mirror { statements, ..*mirror_of(function) };
        let (inputs, expected) = mirror.in_rust();
        let actual = mirror.on_the_gpu(&inputs);
        for rules in [DriverRules::Lavapipe22, DriverRules::Unknown] {
            let verdict = mirror.judge(rules, &inputs, &expected, &actual);
            assert!(verdict.is_err(), "{function}: an altered function passes as its twin under {rules:?}");
        }
    }
    // One unit in the last place, which comes as an input since a constant would not survive the compiler.
    let mirror = Mirror { statements: scaled_input, inputs_each: 7, ..*mirror_of("cross3") };
    let pairs = pairs_of_vectors(&mut Random::new("a unit in the last place"));
    for (factor, differs) in [(1.0, false), (1.000_000_1, true)] {
        let inputs: Vec<f32> = pairs.chunks_exact(6).flat_map(|pair| pair.iter().copied().chain([factor])).collect();
        let expected: Vec<_> = inputs.chunks_exact(7).flat_map(|group| (mirror.twin)(World::get(), group)).collect();
        let actual = mirror.on_the_gpu(&inputs);
        let verdict = mirror.judge(DriverRules::Lavapipe22, &inputs, &expected, &actual);
        if gpu().adapter().rules.are_complete() {
            assert_eq!(verdict.is_err(), differs, "a factor of {factor}: {verdict:?}");
        }
    }
}

/// The judgement itself, on numbers that no driver takes part in.
#[test]
fn the_judgement_tells_right_from_wrong() {
    let mirror = mirror_of("dot3");
    let inputs = [1.0; 6];
    let expected = [Number { value: 3.0, scale: 3.0 }];
    let judge = |rules, actual: f32| mirror.judge(rules, &inputs, &expected, &[actual]).is_ok();
    let (known, unknown) = (DriverRules::Lavapipe22, DriverRules::Unknown);
    assert!(judge(known, 3.0) && judge(unknown, 3.0));
    assert!(!judge(known, 3.0_f32.next_up()) && judge(unknown, 3.0_f32.next_up()));
    let six_units = (0..6).fold(3.0_f32, |x, _| x.next_up());
    assert!(judge(unknown, six_units) && !judge(unknown, six_units.next_up()));
    for wrong in [-3.0, 0.0, f32::NAN, f32::INFINITY] {
        assert!(!judge(known, wrong) && !judge(unknown, wrong), "{wrong} passes for 3");
    }
    assert!(mirror.judge(known, &inputs, &expected, &[]).is_err(), "no numbers at all pass");
    assert!(mirror.judge(known, &[], &[], &[]).is_err(), "no inputs at all pass");
    // What WGSL does not promise is compared only where it is known.
    let infinite = [f32::INFINITY; 6];
    assert!(
        mirror.judge(unknown, &infinite, &expected, &[7.0]).is_ok() && mirror.judge(known, &infinite, &expected, &[7.0]).is_err()
    );
}

fn mirror_of(function: &str) -> &'static Mirror {
    TABLE.iter().find(|mirror| mirror.functions[0] == function).unwrap_or_else(|| panic!("the table has no {function}"))
}

impl Mirror {
    /// The inputs, and what Rust makes of them.
    fn in_rust(&self) -> (Vec<f32>, Vec<Number>) {
        let world = World::get();
        let inputs = (self.inputs)(world, &mut Random::new(self.functions[0]));
        assert_eq!(inputs.len() % self.inputs_each, 0, "{}: the groups of inputs are of another size", self.functions[0]);
        let expected = inputs.chunks_exact(self.inputs_each).flat_map(|group| (self.twin)(world, group)).collect();
        (inputs, expected)
    }

    fn on_the_gpu(&self, inputs: &[f32]) -> Vec<f32> {
        let world = World::get();
        let outputs_each = (self.twin)(world, &inputs[..self.inputs_each]).len();
        evaluate(gpu(), &world.globals, self.statements, inputs, self.inputs_each, outputs_each)
    }

    /// Whether the numbers agree as far as the driver's rules demand; else which do not.
    fn judge(&self, rules: DriverRules, inputs: &[f32], expected: &[Number], actual: &[f32]) -> Result<(), String> {
        let groups = inputs.len() / self.inputs_each;
        if groups == 0 || expected.len() != actual.len() || expected.is_empty() {
            return Err(format!("{}: {} numbers against {}", self.functions[0], expected.len(), actual.len()));
        }
        let outputs_each = expected.len() / groups;
        let (mut wrong, mut worst, mut first) = (0, 0, None);
        for (index, (number, &actual)) in expected.iter().zip(actual).enumerate() {
            let group = &inputs[index / outputs_each * self.inputs_each..][..self.inputs_each];
            // WGSL lets a driver assume that there are neither infinities nor NaN, and flush subnormal numbers.
            let promised = group.iter().all(|x| x.is_normal() || *x == 0.0) && number.value.is_finite();
            let promised = promised && number.scale.is_finite();
            let agree = match rules {
                DriverRules::Lavapipe22 => ulps(number.value, actual) == 0,
                // It takes subnormal numbers for zeros.
                DriverRules::SwiftShader => !promised || ulps(number.value, actual) == 0,
                DriverRules::Unknown => {
                    let allowed = self.bound as f32 * unit_of(number.scale);
                    !promised || (number.value - actual).abs() <= allowed
                }
            };
            if !agree {
                wrong += 1;
                worst = worst.max(ulps(number.value, actual));
                first.get_or_insert_with(|| {
                    let output = index % outputs_each;
                    format!(
                        "output {output} of {group:?} is {actual:?} and should be {:?}, scale {:?}",
                        number.value, number.scale
                    )
                });
            }
        }
        match first {
            None => Ok(()),
            Some(first) => Err(format!(
                "{}: {wrong} of {} numbers differ, by up to {worst} units in the last place; {first} \
                (unknown drivers may be off by {} for {})",
                self.functions[0],
                expected.len(),
                self.bound,
                self.reason
            )),
        }
    }
}
