//! OGRE's numbers, and our own words for what they were computed from.

use std::sync::OnceLock;

use glam::{DMat4, DQuat, DVec2, DVec3, DVec4, Vec3};
use serde::Deserialize;
use shadow_math::{Camera, Light, LightKind, Projection, bounds::Aabb, fit::Eye, frustum::Frustum, polytope::Polytope};

/// Numbers are in single precision, as OGRE had them.
type Vector = [f32; 3];
type Matrix = [[f32; 4]; 4];

/// The file.
#[derive(Debug, Deserialize)]
pub(crate) struct File {
    pub(crate) split_tables: Vec<SplitTable>,
    pub(crate) cases: Vec<Case>,
}

/// What OGRE's `calculateSplitPoints` gives.
#[derive(Debug, Deserialize)]
pub(crate) struct SplitTable {
    pub(crate) split_count: usize,
    pub(crate) near: f32,
    pub(crate) far: f32,
    pub(crate) lambda: f32,
    pub(crate) points: Vec<f32>,
}

/// One shadow camera.
#[derive(Debug, Deserialize)]
pub(crate) struct Case {
    pub(crate) id: String,
    pub(crate) setup: String,
    pub(crate) tags: Vec<String>,
    pub(crate) params: Params,
    camera: Viewer,
    pub(crate) light: Lamp,
    pub(crate) scene: Scene,
    pub(crate) intermediate: Intermediate,
    pub(crate) result: Computed,
}

/// What the setup was told.
#[derive(Debug, Deserialize)]
pub(crate) struct Params {
    pub(crate) optimal_adjust_factor: Option<f32>,
    pub(crate) use_simple_n_opt: Option<bool>,
    #[serde(rename = "camera_light_direction_threshold_deg_effective")]
    threshold_degrees: Option<f32>,
    plane: Option<[f32; 4]>,
    pub(crate) split_near: Option<f32>,
    pub(crate) split_far: Option<f32>,
    pub(crate) lambda: Option<f32>,
    pub(crate) manual_splits: Option<bool>,
    pub(crate) split_padding: Option<f32>,
    pub(crate) split_points: Option<Vec<f32>>,
    pub(crate) optimal_adjust_factors: Option<Vec<f32>>,
    pub(crate) iteration: Option<usize>,
}

/// The camera.
#[derive(Debug, Deserialize)]
struct Viewer {
    position: Vector,
    orientation_wxyz: [f32; 4],
    fovy_rad: f32,
    aspect: f32,
    near: f32,
    far: f32,
}

/// The light.
#[derive(Debug, Deserialize)]
pub(crate) struct Lamp {
    #[serde(rename = "type")]
    pub(crate) kind: String,
    position: Option<Vector>,
    direction: Option<Vector>,
    pub(crate) node_direction: Option<Vector>,
    spot_outer_rad: Option<f32>,
    attenuation_range: f32,
    pub(crate) shadow_far_distance: f32,
    pub(crate) shadow_far_clip_setting: f32,
    derived_shadow_near_clip: f32,
    derived_shadow_far_clip: f32,
}

/// A box.
#[derive(Clone, Copy, Debug, Deserialize)]
pub(crate) struct Bounds {
    min: Vector,
    max: Vector,
}

/// The scene, and the settings that are the scene manager's.
#[derive(Debug, Deserialize)]
pub(crate) struct Scene {
    caster_aabb: Option<Bounds>,
    receiver_aabb: Option<Bounds>,
    pub(crate) dir_light_texture_offset: f32,
    pub(crate) dir_light_extrusion_distance: f32,
    pub(crate) shadow_texture_size: [u32; 2],
}

/// What OGRE computes on its way.
#[derive(Debug, Deserialize)]
pub(crate) struct Intermediate {
    standard_view: Option<Matrix>,
    standard_proj: Option<Matrix>,
    scene_bb_merged: Option<Bounds>,
    clip_planes: Option<Vec<[f32; 4]>>,
    body_b: Option<Vec<Vector>>,
    body_lvs: Option<Vec<Vector>>,
    near_camera_point: Option<Vector>,
    pub(crate) ls_view_dir: Option<Vector>,
    pub(crate) opt_adjust_tweak: Option<f32>,
    pub(crate) n_opt_simple: Option<f32>,
    pub(crate) n_opt_general: Option<f32>,
    pub(crate) split_near_padded: Option<f32>,
    pub(crate) split_far_padded: Option<f32>,
    pub(crate) plane_view_hull: Option<Vec<[f32; 4]>>,
}

/// The shadow camera.
#[derive(Debug, Deserialize)]
pub(crate) struct Computed {
    view: Matrix,
    proj: Matrix,
    pub(crate) custom_proj: bool,
}

/// The file, read once.
pub(crate) fn file() -> &'static File {
    static FILE: OnceLock<File> = OnceLock::new();
    FILE.get_or_init(|| serde_json::from_str(include_str!("../data/ogre-1.12.10.json")).expect("the file is as described here"))
}

/// The cases that pass a test, which must be so many: no case is lost without notice.
pub(crate) fn cases(count: usize, test: impl Fn(&Case) -> bool) -> Vec<&'static Case> {
    let found: Vec<_> = file().cases.iter().filter(|case| test(case)).collect();
    assert_eq!(found.len(), count, "{:?}", found.iter().map(|case| &case.id).collect::<Vec<_>>());
    found
}

/// The case of a name.
pub(crate) fn case(id: &str) -> &'static Case {
    cases(1, |case| case.id == id)[0]
}

fn vector(numbers: Vector) -> DVec3 {
    Vec3::from_array(numbers).as_dvec3()
}

fn matrix(rows: &Matrix) -> DMat4 {
    DMat4::from_cols_array_2d(&rows.map(|row| row.map(f64::from))).transpose()
}

fn points(given: Option<&Vec<Vector>>) -> Vec<DVec3> {
    given.expect("the setup has bodies").iter().copied().map(vector).collect()
}

impl Bounds {
    fn aabb(given: Option<Self>) -> Aabb {
        given.map_or(Aabb::EMPTY, |bounds| Aabb::new(bounds.min.into(), bounds.max.into()))
    }
}

impl Case {
    pub(crate) fn has_tag(&self, tag: &str) -> bool {
        self.tags.iter().any(|given| given == tag)
    }

    /// The camera. In a cascade it is the viewer's own, not the cascade's slice of it.
    pub(crate) fn camera(&self) -> Camera {
        let Viewer { position, orientation_wxyz: [w, x, y, z], fovy_rad, near, far, .. } = self.camera;
        let [x, y, z, w] = [x, y, z, w].map(f64::from);
        let projection = Projection::Perspective {
            vertical_fov: f64::from(fovy_rad),
            near: f64::from(near),
            far: (far > 0.0).then_some(f64::from(far)),
        };
        Camera { eye: vector(position), orientation: DQuat::from_xyzw(x, y, z, w).normalize(), projection }
    }

    /// The camera with its aspect ratio.
    pub(crate) fn eye(&self) -> Eye<'static> {
        Eye { camera: self.camera(), aspect: f64::from(self.camera.aspect), samples: &[], plane: None }
    }

    /// The distances of the camera's near and far planes, or of a cascade's, in metres; 0 for no far plane.
    pub(crate) fn planes(&self) -> [f64; 2] {
        let Intermediate { split_near_padded, split_far_padded, .. } = self.intermediate;
        [split_near_padded.unwrap_or(self.camera.near), split_far_padded.unwrap_or(self.camera.far)].map(f64::from)
    }

    /// What is seen between those distances. OGRE takes a hundred thousand for an infinite one.
    pub(crate) fn frustum(&self) -> Frustum {
        let [near, far] = self.planes();
        let eye = self.eye();
        Frustum::slice(&eye.camera, eye.aspect, near, if far > 0.0 { far } else { 1e5 }).expect("the planes enclose something")
    }

    /// The light. OGRE gives a spot light's whole angle; what it calls a point light's direction has no place here.
    pub(crate) fn light(&self) -> Light {
        let Lamp { position, direction, spot_outer_rad, attenuation_range, .. } = self.light;
        let of = |given: Option<Vector>| given.map(Vec3::from_array).expect("this kind of light has it");
        let range = Some(attenuation_range);
        let kind = match self.light.kind.as_str() {
            "directional" => LightKind::Directional { direction: of(direction) },
            "spot" => {
                let outer = 0.5 * spot_outer_rad.expect("a spot light has a cone");
                LightKind::Spot { position: of(position), direction: of(direction), inner: 0.0, outer, range }
            }
            other => {
                assert_eq!(other, "point", "{}", self.id);
                LightKind::Point { position: of(position), range }
            }
        };
        Light { kind, color: Vec3::ONE, intensity: 1.0 }
    }

    /// The light as a homogeneous point.
    pub(crate) fn light_point(&self) -> DVec4 {
        match self.light().kind {
            LightKind::Directional { direction } => (-direction.as_dvec3()).extend(0.0),
            LightKind::Spot { position, .. } | LightKind::Point { position, .. } => position.as_dvec3().extend(1.0),
        }
    }

    /// The distances of the light's own near and far planes, in metres.
    pub(crate) fn light_planes(&self) -> [f64; 2] {
        [self.light.derived_shadow_near_clip, self.light.derived_shadow_far_clip].map(f64::from)
    }

    /// The vector of length 1 along which OGRE takes the light to shine: of a point light, that of the node it hangs on.
    pub(crate) fn direction_for_ogre(&self) -> DVec3 {
        vector(self.light.direction.or(self.light.node_direction).expect("every light has either")).normalize()
    }

    /// The angle in radians within which the warp is tweaked.
    pub(crate) fn threshold(&self) -> f64 {
        f64::from(self.params.threshold_degrees.expect("the setup has a threshold")).to_radians()
    }

    /// The factor of the warp's parameter: in cascades, the cascade's.
    pub(crate) fn adjust_factor(&self) -> f64 {
        let of_cascade = || Some(self.params.optimal_adjust_factors.as_ref()?[self.params.iteration?]);
        f64::from(self.params.optimal_adjust_factor.or_else(of_cascade).expect("the setup has a factor"))
    }

    /// The plane of the plane-optimal setup.
    pub(crate) fn plane(&self) -> DVec4 {
        DVec4::from_array(self.params.plane.expect("the setup has a plane").map(f64::from))
    }

    pub(crate) fn casters(&self) -> Aabb {
        Bounds::aabb(self.scene.caster_aabb)
    }

    pub(crate) fn receivers(&self) -> Aabb {
        Bounds::aabb(self.scene.receiver_aabb)
    }

    /// Casters, receivers and the camera in one box.
    pub(crate) fn merged(&self) -> Aabb {
        Bounds::aabb(self.intermediate.scene_bb_merged)
    }

    /// The planes of the light's frustum that OGRE clips bodies by.
    pub(crate) fn clip_planes(&self) -> Vec<DVec4> {
        let planes = self.intermediate.clip_planes.as_ref().map_or(&[][..], Vec::as_slice);
        planes.iter().map(|plane| DVec4::from_array(plane.map(f64::from))).collect()
    }

    pub(crate) fn body_b(&self) -> Vec<DVec3> {
        points(self.intermediate.body_b.as_ref())
    }

    pub(crate) fn body_lvs(&self) -> Vec<DVec3> {
        points(self.intermediate.body_lvs.as_ref())
    }

    /// The visible point that is nearest to the camera.
    pub(crate) fn nearest(&self) -> DVec3 {
        vector(self.intermediate.near_camera_point.expect("the setup has a nearest point"))
    }

    /// OGRE's matrix before it is focused, z from -1 to 1.
    pub(crate) fn standard(&self) -> DMat4 {
        let Intermediate { standard_view, standard_proj, .. } = &self.intermediate;
        let of = |given: &Option<Matrix>| matrix(given.as_ref().expect("the setup has a standard matrix"));
        of(standard_proj) * of(standard_view)
    }

    /// OGRE's matrix from world to clip space, z from -1 to 1.
    pub(crate) fn clip_from_world(&self) -> DMat4 {
        matrix(&self.result.proj) * matrix(&self.result.view)
    }

    /// From world to the camera's clip space in x and y: its depth is our own.
    pub(crate) fn camera_clip_from_world(&self) -> DMat4 {
        let eye = self.eye();
        eye.camera.clip_from_view(eye.aspect, shadow_math::spaces::ClipDepth::MinusOneToOne) * eye.camera.view_from_world()
    }

    /// Points of the camera's frustum, and of the casters' and receivers' boxes: corners, and what lies between them.
    pub(crate) fn sample_points(&self) -> Vec<DVec3> {
        let boxes = [self.casters(), self.receivers()].into_iter().filter(|bounds| !bounds.is_empty());
        let mut points: Vec<_> =
            boxes.flat_map(|bounds| inner_points(bounds.corners().map(|corner| corner.as_dvec3()))).collect();
        points.extend(inner_points(self.frustum().corners));
        points
    }
}

/// Eight corners, and the midpoints of every two.
fn inner_points(corners: [DVec3; 8]) -> Vec<DVec3> {
    (0..8).flat_map(|a| (0..=a).map(move |b| corners[a].midpoint(corners[b]))).collect()
}

/// Where a matrix takes a point in NDC; `None` behind the eye.
pub(crate) fn ndc(clip_from_world: DMat4, point: DVec3) -> Option<DVec3> {
    let clip = clip_from_world * point.extend(1.0);
    (clip.w > 0.0).then(|| clip.truncate() / clip.w)
}

/// The distance in NDC x and y, as a share of the farther one from the middle where that lies outside the map: rounding of OGRE's matrices grows with what they are applied to.
pub(crate) fn apart(a: DVec2, b: DVec2) -> f64 {
    (a - b).abs().max_element() / a.abs().max_element().max(1.0)
}

/// How far two hulls of points reach at most differently, in any of a thousand directions evenly over the sphere; infinite if only one is empty.
pub(crate) fn support_difference(a: &[DVec3], b: &[DVec3]) -> f64 {
    /// The turn from one point of the spiral to the next.
    const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
    if a.is_empty() || b.is_empty() {
        return if a.len() == b.len() { 0.0 } else { f64::INFINITY };
    }
    let reach = |points: &[DVec3], direction: DVec3| points.iter().map(|p| direction.dot(*p)).fold(f64::NEG_INFINITY, f64::max);
    let directions = (0..1000_u16).map(|i| {
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / 1000.0;
        let (s, c) = (GOLDEN_ANGLE * f64::from(i)).sin_cos();
        DVec3::new(c * (1.0 - z * z).sqrt(), s * (1.0 - z * z).sqrt(), z)
    });
    directions.map(|direction| (reach(a, direction) - reach(b, direction)).abs()).fold(0.0, f64::max)
}

/// The diagonal of the box around some points, in metres.
pub(crate) fn size(points: &[DVec3]) -> f64 {
    let [min, max] =
        points.iter().fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[min, max], point| [min.min(*point), max.max(*point)]);
    (max - min).length()
}

/// A body cut by planes.
pub(crate) fn clipped(mut body: Polytope, planes: &[DVec4]) -> Polytope {
    for plane in planes {
        body.clip(*plane);
    }
    body
}
