//! Shapes in world space, from which scenes are built in code.
//!
//! All lengths are metres. Triangles wind counter-clockwise seen from outside, and closed shapes are closed to the bit:
//! vertices that are one point have equal coordinates. Colours are white.

use core::f32::consts::TAU;

use glam::{Quat, Vec2, Vec3, Vec4};

use crate::{builder::Mesh, scene::Vertices};

/// A flat quadrilateral, visible from the side where its corners run counter-clockwise.
///
/// The corners are those of the texture at the bottom left, bottom right, top right and top left. They should lie in a
/// plane and form a convex outline; the normal is that of the first three (zero if they lie on a line).
#[must_use]
pub fn quad(corners: [Vec3; 4]) -> Mesh {
    let [a, b, c, _] = corners;
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let uvs = [Vec2::new(0.0, 1.0), Vec2::new(1.0, 1.0), Vec2::new(1.0, 0.0), Vec2::new(0.0, 0.0)];
    mesh(corners.to_vec(), vec![normal; 4], uvs.to_vec(), vec![[0, 1, 2], [0, 2, 3]])
}

/// A square of side `2 * half_size` around `center`, visible from the side that `normal` points to.
///
/// Where the normal is vertical, the texture's u runs along x; otherwise it runs horizontally. A normal without
/// direction is taken for y.
#[must_use]
pub fn plane(center: Vec3, normal: Vec3, half_size: f32) -> Mesh {
    /// Length of the normal's horizontal part below which it counts as vertical.
    const MIN_HORIZONTAL: f32 = 1e-3;
    let normal = normal.try_normalize().unwrap_or(Vec3::Y);
    let horizontal = Vec3::Y.cross(normal);
    // Where y does not give a direction in the plane, x does.
    let right =
        if horizontal.length() < MIN_HORIZONTAL { Vec3::X.reject_from_normalized(normal) } else { horizontal }.normalize();
    let up = normal.cross(right);
    let (right, up) = (half_size * right, half_size * up);
    quad([center - right - up, center + right - up, center + right + up, center - right + up])
}

/// A box (`box` is a word of the language) with its middle at `center`, its half-extents along its own axes, turned by
/// `rotation`. Each face has normals and vertices of its own.
#[must_use]
pub fn cuboid(center: Vec3, half_extents: Vec3, rotation: Quat) -> Mesh {
    let mut all = Mesh::default();
    for axis in 0..3 {
        for sign in [1.0, -1.0] {
            // The three axes in cyclic order; the face's outward normal is the first. Turning the second over for the
            // negative faces keeps the corners counter-clockwise.
            let outward = sign * Vec3::AXES[axis];
            let right = sign * Vec3::AXES[(axis + 1) % 3];
            let up = Vec3::AXES[(axis + 2) % 3];
            // Products of exact signs with the half-extents: equal corners of two faces are equal to the bit.
            let corner = |u: f32, v: f32| center + rotation * ((outward + u * right + v * up) * half_extents);
            append(&mut all, quad([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]));
        }
    }
    all
}

/// A sphere of `segments` meridians (at least 3) and `segments / 2` rings (at least 2), with smooth normals.
#[must_use]
pub fn sphere(center: Vec3, radius: f32, segments: u32) -> Mesh {
    let segments = segments.max(3);
    let rings = (segments / 2).max(2);
    grid(rings, segments, |ring, segment| {
        // The poles and the seam are points that several vertices share, so they must be exact.
        let latitude = ring as f32 / rings as f32 * (0.5 * TAU);
        let (sine, cosine) = if ring == 0 {
            (0.0, 1.0)
        } else if ring == rings {
            (0.0, -1.0)
        } else {
            latitude.sin_cos()
        };
        let (z, x) = ((segment % segments) as f32 / segments as f32 * TAU).sin_cos();
        let normal = Vec3::new(sine * x, cosine, -sine * z);
        (center + radius * normal, normal)
    })
}

/// A tube of radius `tube` around a (2, 3) torus knot, with smooth normals.
///
/// The knot winds on a torus around the z axis through `center`, with radii `major` and `minor`. It stays clear of itself
/// for a tube of less than about half of `minor`. `segments` (at least 3) quadrilaterals lie along it and
/// `segments / 10` (at least 3) around it.
#[must_use]
pub fn torus_knot(center: Vec3, major: f32, minor: f32, tube: f32, segments: u32) -> Mesh {
    let segments = segments.max(3);
    let sides = (segments / 10).max(3);
    // The curve and its derivative by the parameter.
    let curve = |t: f32| {
        let (sin2, cos2) = (2.0 * t).sin_cos();
        let (sin3, cos3) = (3.0 * t).sin_cos();
        let distance = major + minor * cos3;
        let point = Vec3::new(distance * cos2, distance * sin2, minor * sin3);
        let tangent = Vec3::new(
            -2.0 * distance * sin2 - 3.0 * minor * sin3 * cos2,
            2.0 * distance * cos2 - 3.0 * minor * sin3 * sin2,
            3.0 * minor * cos3,
        );
        (point, tangent)
    };
    grid(segments, sides, |segment, side| {
        let (point, tangent) = curve((segment % segments) as f32 / segments as f32 * TAU);
        // The knot never runs along the line from the middle, so the two span a plane, which turns with the knot and
        // returns to where it was.
        let across = tangent.cross(point).normalize();
        let outward = across.cross(tangent).normalize();
        let (sine, cosine) = ((side % sides) as f32 / sides as f32 * TAU).sin_cos();
        // Clockwise along the knot, which is to the right seen from outside with the knot running down.
        let normal = cosine * outward - sine * across;
        (center + point + tube * normal, normal)
    })
}

/// A rectangle of `2 * half_size` metres in x and z around `center`, visible from above, with smooth waves of `height` metres up and down.
///
/// There are six of them along x and four along z, whatever the number of quadrilaterals along each, `cells` (at least 1): two
/// triangles a quadrilateral.
#[must_use]
pub fn waves(center: Vec3, half_size: Vec2, height: f32, cells: [u32; 2]) -> Mesh {
    /// How many waves there are along x and z.
    const WAVES: Vec2 = Vec2::new(6.0, 4.0);
    let [columns, rows] = cells.map(|count| count.max(1));
    let per_metre = WAVES * TAU / (2.0 * half_size);
    grid(rows, columns, |row, column| {
        let at = half_size * (2.0 * Vec2::new(column as f32 / columns as f32, row as f32 / rows as f32) - 1.0);
        let ((sin_x, cos_x), (sin_z, cos_z)) = ((per_metre.x * at.x).sin_cos(), (per_metre.y * at.y).sin_cos());
        let position = center + Vec3::new(at.x, height * sin_x * sin_z, at.y);
        let slope = height * per_metre * Vec2::new(cos_x * sin_z, sin_x * cos_z);
        (position, Vec3::new(-slope.x, 1.0, -slope.y).normalize())
    })
}

/// A grid of `rows` by `columns` quadrilaterals from a function that gives position and normal of each of its points.
///
/// Seen from outside, rows run down and columns to the right. Quadrilaterals that a pole makes into triangles become one.
fn grid(rows: u32, columns: u32, point: impl Fn(u32, u32) -> (Vec3, Vec3)) -> Mesh {
    let mut positions = Vec::new();
    let mut normals = Vec::new();
    let mut uvs = Vec::new();
    let mut triangles = Vec::new();
    for row in 0..=rows {
        for column in 0..=columns {
            let (position, normal) = point(row, column);
            positions.push(position);
            normals.push(normal);
            uvs.push(Vec2::new(column as f32 / columns as f32, row as f32 / rows as f32));
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let top_left = row * (columns + 1) + column;
            let bottom_left = top_left + columns + 1;
            for triangle in [[top_left, bottom_left, bottom_left + 1], [top_left, bottom_left + 1, top_left + 1]] {
                let [a, b, c] = triangle.map(|vertex| positions[vertex as usize]);
                if a != b && b != c && c != a {
                    triangles.push(triangle);
                }
            }
        }
    }
    mesh(positions, normals, uvs, triangles)
}

fn mesh(positions: Vec<Vec3>, normals: Vec<Vec3>, uvs: Vec<Vec2>, triangles: Vec<[u32; 3]>) -> Mesh {
    let colors = vec![Vec4::ONE; positions.len()];
    Mesh { vertices: Vertices { positions, normals, uvs, colors }, triangles }
}

/// Adds the triangles of `more` to `all`.
pub(super) fn append(all: &mut Mesh, more: Mesh) {
    let base = all.vertices.positions.len() as u32;
    all.triangles.extend(more.triangles.into_iter().map(|triangle| triangle.map(|vertex| vertex + base)));
    all.vertices.positions.extend(more.vertices.positions);
    all.vertices.normals.extend(more.vertices.normals);
    all.vertices.uvs.extend(more.vertices.uvs);
    all.vertices.colors.extend(more.vertices.colors);
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;

    fn corners(mesh: &Mesh) -> impl Iterator<Item = [Vec3; 3]> {
        mesh.triangles.iter().map(|triangle| triangle.map(|vertex| mesh.vertices.positions[vertex as usize]))
    }

    /// Every edge, by the bits of its ends, is run through once in each direction.
    fn is_closed(mesh: &Mesh) -> bool {
        // Adding 0 makes a negative zero positive.
        let bits = |p: Vec3| (p + 0.0).to_array().map(f32::to_bits);
        let mut balance: HashMap<_, (u32, u32)> = HashMap::new();
        for [a, b, c] in corners(mesh) {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let (from, to) = (bits(from), bits(to));
                let entry = balance.entry((from.min(to), from.max(to))).or_default();
                if from < to { entry.0 += 1 } else { entry.1 += 1 }
            }
        }
        balance.values().all(|&runs| runs == (1, 1))
    }

    /// Six times the volume: positive if the triangles wind counter-clockwise seen from outside.
    fn volume(mesh: &Mesh) -> f32 {
        corners(mesh).map(|[a, b, c]| a.dot(b.cross(c))).sum::<f32>() / 6.0
    }

    /// Every vertex normal lies on the side of its triangles' fronts.
    fn normals_agree_with_winding(mesh: &Mesh) -> bool {
        mesh.triangles.iter().zip(corners(mesh)).all(|(triangle, [a, b, c])| {
            let front = (b - a).cross(c - a);
            triangle.iter().all(|&vertex| {
                let normal = mesh.vertices.normals[vertex as usize];
                (normal.length() - 1.0).abs() < 1e-5 && normal.dot(front) > 0.0
            })
        })
    }

    #[test]
    fn solids_are_closed_and_face_outwards() {
        let turn = Quat::from_euler(glam::EulerRot::YXZ, 0.7, -0.3, 0.2);
        let center = Vec3::new(0.3, 1.0, -2.0);
        let solids = [
            ("box", cuboid(center, Vec3::new(1.0, 0.5, 0.25), turn), 1.0, 1e-5),
            ("straight box", cuboid(Vec3::ZERO, Vec3::ONE, Quat::IDENTITY), 8.0, 1e-5),
            // Inscribed, so a little less than 4/3 pi r^3.
            ("sphere", sphere(center, 0.7, 96), 2.0 / 3.0 * TAU * 0.343, 4e-3),
            ("coarsest sphere", sphere(Vec3::ZERO, 1.0, 0), 1.0, 1.0),
            // The volume of a tube is its cross-section times the length of the curve (Pappus).
            ("knot", torus_knot(center, 0.62, 0.28, 0.11, 300), knot_length(0.62, 0.28) * 0.5 * TAU * 0.0121, 1e-2),
        ];
        for (name, solid, expected, tolerance) in solids {
            assert!(is_closed(&solid), "{name}");
            assert!(normals_agree_with_winding(&solid), "{name}");
            let volume = volume(&solid);
            assert!((volume / expected - 1.0).abs() <= tolerance, "{name}: {volume} m^3 instead of {expected}");
        }
    }

    /// The length of the knot's curve, by chords.
    fn knot_length(major: f32, minor: f32) -> f32 {
        let point = |i: u32| {
            let t = i as f32 / 5000.0 * TAU;
            let distance = major + minor * (3.0 * t).cos();
            Vec3::new(distance * (2.0 * t).cos(), distance * (2.0 * t).sin(), minor * (3.0 * t).sin())
        };
        (0..5000).map(|i| point(i).distance(point(i + 1))).sum()
    }

    #[test]
    fn spheres_have_their_radius_and_radial_normals() {
        let center = Vec3::new(1.0, 2.0, 3.0);
        let sphere = sphere(center, 0.5, 32);
        for (position, normal) in sphere.vertices.positions.iter().zip(&sphere.vertices.normals) {
            assert!(((position - center).length() - 0.5).abs() < 1e-6);
            assert!((center + 0.5 * normal).distance(*position) < 1e-6);
        }
    }

    #[test]
    fn planes_face_their_normal_and_have_their_size() {
        for normal in [Vec3::Y, Vec3::NEG_Y, Vec3::X, Vec3::NEG_Z, Vec3::new(1.0, 2.0, -0.5), Vec3::new(1e-5, 1.0, 0.0)] {
            let plane = plane(Vec3::ONE, normal, 3.0);
            assert!(normals_agree_with_winding(&plane), "{normal}");
            assert!(plane.vertices.normals[0].distance(normal.normalize()) < 1e-6, "{normal}");
            let area: f32 = corners(&plane).map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length()).sum();
            assert!((area - 36.0).abs() < 1e-4, "{normal}: {area}");
        }
    }

    #[test]
    fn waves_have_their_size_and_face_up() {
        let waves = waves(Vec3::Y, Vec2::new(8.0, 4.0), 0.5, [96, 64]);
        assert_eq!(waves.triangles.len(), 2 * 96 * 64);
        assert!(normals_agree_with_winding(&waves));
        assert!(corners(&waves).all(|[a, b, c]| (b - a).cross(c - a).y > 0.0));
        let (min, max) = waves.vertices.positions.iter().fold((Vec3::MAX, Vec3::MIN), |(min, max), p| (min.min(*p), max.max(*p)));
        assert!(min.distance(Vec3::new(-8.0, 0.5, -4.0)) < 1e-5 && max.distance(Vec3::new(8.0, 1.5, 4.0)) < 1e-5, "{min} {max}");
    }

    #[test]
    fn a_horizontal_plane_has_its_texture_upright_seen_from_the_south() {
        let plane = plane(Vec3::ZERO, Vec3::Y, 1.0);
        let corner = plane.vertices.uvs.iter().position(|&uv| uv == Vec2::ZERO).unwrap();
        assert_eq!(plane.vertices.positions[corner], Vec3::new(-1.0, 0.0, -1.0));
    }
}
