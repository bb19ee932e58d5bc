//! Tests of the import as a whole: small files in, meaning out.

mod refusals;
mod animation;
mod limits;
mod extensions;

use std::path::{Path, PathBuf};

use glam::{DQuat, DVec3, EulerRot, Quat, Vec2, Vec3, Vec4};
use serde_json::{Value, json};
use shadow_math::{LightKind, Projection};

use super::{ImportError, import, import_slice};
use crate::scene::{Alpha, Scene, Wrap};

const UNSIGNED_BYTE: u32 = 5121;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;

/// A file under construction. It starts with one mesh of one primitive in one node, and no attribute.
struct File {
    json: Value,
    bin: Vec<u8>,
}

impl File {
    fn new() -> Self {
        let json = json!({
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {}}]}],
            "accessors": [],
            "bufferViews": [],
        });
        Self { json, bin: Vec::new() }
    }

    /// The triangle (0,0,0), (1,0,0), (0,1,0), whose front faces +z, without normals.
    fn triangle() -> Self {
        let mut file = Self::new();
        file.floats("POSITION", "VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        file
    }

    fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    fn view(&mut self, bytes: &[u8]) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let views = self.json["bufferViews"].as_array_mut().unwrap();
        views.push(json!({"buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len()}));
        self.bin.extend_from_slice(bytes);
        views.len() - 1
    }

    fn accessor(&mut self, component: u32, kind: &str, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        let accessors = self.json["accessors"].as_array_mut().unwrap();
        accessors.push(json!({"bufferView": view, "componentType": component, "type": kind, "count": count}));
        accessors.len() - 1
    }

    fn float_accessor(&mut self, kind: &str, values: &[f32]) -> usize {
        let width = match kind {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        self.accessor(FLOAT, kind, values.len() / width, bytemuck::cast_slice(values))
    }

    /// Adds an attribute of floats to the primitive.
    fn floats(&mut self, name: &str, kind: &str, values: &[f32]) {
        let accessor = self.float_accessor(kind, values);
        self.primitive()["attributes"][name] = accessor.into();
    }

    fn indices(&mut self, values: &[u16]) {
        let accessor = self.accessor(UNSIGNED_SHORT, "SCALAR", values.len(), bytemuck::cast_slice(values));
        self.primitive()["indices"] = accessor.into();
    }

    fn material(&mut self, material: Value) {
        self.json["materials"] = json!([material]);
        self.primitive()["material"] = 0.into();
    }

    /// A texture of 2 x 1 texels, red and half transparent green.
    fn texture(&mut self) {
        let mut png = Vec::new();
        let image = image::RgbaImage::from_raw(2, 1, vec![255, 0, 0, 255, 0, 255, 0, 128]).unwrap();
        image.write_to(&mut std::io::Cursor::new(&mut png), image::ImageFormat::Png).unwrap();
        let view = self.view(&png);
        self.json["images"] = json!([{"bufferView": view, "mimeType": "image/png"}]);
        self.json["textures"] = json!([{"source": 0}]);
    }

    /// The bytes of the file as a binary container.
    fn bytes(&self) -> Vec<u8> {
        let mut bin = self.bin.clone();
        bin.resize(bin.len().next_multiple_of(4), 0);
        let mut json = self.json.clone();
        json["buffers"] = json!([{"byteLength": self.bin.len()}]);
        let mut text = json.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let chunk = |kind: &[u8; 4], body: &[u8]| [&(body.len() as u32).to_le_bytes()[..], kind, body].concat();
        let chunks = [chunk(b"JSON", &text), chunk(b"BIN\0", &bin)].concat();
        [b"glTF", &2_u32.to_le_bytes()[..], &(12 + chunks.len() as u32).to_le_bytes(), &chunks].concat()
    }

    fn import(&self) -> Result<Scene, ImportError> {
        import_slice("test.glb", &self.bytes())
    }

    fn scene(&self) -> Scene {
        self.import().unwrap()
    }

    /// The message of the error that the import ends with.
    fn error(&self) -> String {
        self.import().unwrap_err().to_string()
    }
}

/// The corners of a triangle.
fn corners(scene: &Scene, triangle: usize) -> [Vec3; 3] {
    scene.triangles()[triangle].map(|vertex| scene.vertices().positions[vertex as usize])
}

/// The direction that a triangle's front faces.
fn front(scene: &Scene, triangle: usize) -> Vec3 {
    let [a, b, c] = corners(scene, triangle);
    (b - a).cross(c - a).normalize()
}

#[test]
fn missing_normals_are_made_flat() {
    let mut file = File::new();
    // Two triangles that share an edge and stand at a right angle.
    file.floats("POSITION", "VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
    file.indices(&[0, 1, 2, 0, 3, 1]);
    let scene = file.scene();
    assert_eq!(scene.vertices().positions.len(), 6, "flat normals need vertices of their own");
    assert_eq!(scene.vertices().normals, [Vec3::Z, Vec3::Z, Vec3::Z, Vec3::Y, Vec3::Y, Vec3::Y]);
}

#[test]
fn mirrored_nodes_keep_their_fronts_outside() {
    for scale in
        [[-1.0_f32, 1.0, 1.0], [2.0, -3.0, 1.0], [-1.0, -1.0, -1.0], [1.0, 1.0, -0.5], [-1.0, -1.0, 1.0], [1e-30, 1e-30, -1e-30]]
    {
        let mut file = File::triangle();
        file.floats("NORMAL", "VEC3", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
        file.json["nodes"][0]["scale"] = json!(scale);
        let scene = file.scene();
        // The triangle lies in z = 0 and faced +z, so after the mirror it faces where +z went.
        let expected = if scale[2] < 0.0 { Vec3::NEG_Z } else { Vec3::Z };
        let [a, b, c] = corners(&scene, 0).map(|corner| corner / scale[2].abs());
        assert_eq!((b - a).cross(c - a).normalize(), expected, "{scale:?}");
        assert_eq!(scene.vertices().normals, [expected; 3], "{scale:?}");
    }
}

#[test]
fn normals_stay_perpendicular_under_shear_and_uneven_scale() {
    let mut file = File::new();
    file.floats("POSITION", "VEC3", &[0.0, 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, 1.0]);
    let normal = Vec3::new(-1.0, -1.0, 0.0).normalize();
    file.floats("NORMAL", "VEC3", &[normal, normal, normal].map(|n| n.to_array()).concat());
    file.json["nodes"][0]["matrix"] = json!([4, 0, 0, 0, 1, 1, 0, 0, 0, 2, -3, 0, 5, 6, 7, 1]);
    let scene = file.scene();
    let normal = scene.vertices().normals[0];
    assert!(normal.distance(front(&scene, 0)) < 1e-6, "{normal} is not {}", front(&scene, 0));
}

#[test]
fn singular_matrices_give_no_nan() {
    for scale in [[0.0, 1.0, 1.0], [1.0, 1.0, 0.0], [0.0, 0.0, 0.0]] {
        let mut file = File::triangle();
        let normals = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, f32::NAN, 0.0, 1.0];
        file.floats("NORMAL", "VEC3", &normals);
        file.json["nodes"][0]["scale"] = json!(scale);
        let scene = file.scene();
        let normals = &scene.vertices().normals;
        assert!(normals.iter().all(|n| *n == Vec3::ZERO || (n.length() - 1.0).abs() < 1e-6), "{normals:?}");
        assert_eq!(normals[1], Vec3::ZERO, "zero stays zero");
        assert!(scene.notes().iter().any(|note| note.contains("not a finite number")), "{:?}", scene.notes());
    }
}

#[test]
fn a_matrix_and_its_parts_give_the_same_scene() {
    let rotation = DQuat::from_euler(EulerRot::YXZ, 0.4, -1.2, 2.5);
    let (translation, scale) = (DVec3::new(10.0, -2.0, 0.5), DVec3::new(0.5, 3.0, -2.0));
    let mut parts = File::triangle();
    parts.json["nodes"][0]["translation"] = json!(translation.to_array());
    parts.json["nodes"][0]["rotation"] = json!(rotation.to_array());
    parts.json["nodes"][0]["scale"] = json!(scale.to_array());
    let mut whole = File::triangle();
    let matrix = glam::DMat4::from_scale_rotation_translation(scale, rotation, translation);
    whole.json["nodes"][0]["matrix"] = json!(matrix.to_cols_array());
    let (parts, whole) = (parts.scene(), whole.scene());
    for (a, b) in parts.vertices().positions.iter().zip(&whole.vertices().positions) {
        assert!(a.distance(*b) < 1e-5, "{a} is not {b}");
    }
    assert_eq!(parts.triangles(), whole.triangles());
}

#[test]
fn transforms_multiply_down_the_hierarchy() {
    let mut file = File::triangle();
    file.json["nodes"] = json!([
        {"children": [1], "translation": [10, 0, 0], "rotation": [0, 0, (0.5_f64).sqrt(), (0.5_f64).sqrt()]},
        {"mesh": 0, "translation": [1, 0, 0], "scale": [2, 2, 2], "name": "leaf"},
    ]);
    let scene = file.scene();
    // The child lies at (1, 0, 0) of a parent that is turned by a quarter about z.
    let expected = [Vec3::new(10.0, 1.0, 0.0), Vec3::new(10.0, 3.0, 0.0), Vec3::new(8.0, 1.0, 0.0)];
    for (found, expected) in corners(&scene, 0).into_iter().zip(expected) {
        assert!(found.distance(expected) < 1e-5, "{found} is not {expected}");
    }
    assert_eq!(scene.instances()[0].name, "leaf");
}

#[test]
fn a_scene_far_from_zero_gets_an_origin_and_keeps_its_millimetres() {
    let mut file = File::triangle();
    // 6378 km from zero, f32 has steps of half a metre.
    file.json["nodes"][0]["translation"] = json!([6_378_137.125, 0.0, 0.001]);
    file.json["nodes"][0]["camera"] = 0.into();
    file.json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}]);
    let scene = file.scene();
    assert_eq!(scene.origin(), DVec3::new(6_378_138.0, 1.0, 0.0));
    assert_eq!(corners(&scene, 0)[0], Vec3::new(-0.875, -1.0, 0.001));
    assert_eq!(scene.cameras()[0].camera.eye, DVec3::new(-0.875, -1.0, 0.001));
}

#[test]
fn strips_and_fans_wind_like_their_first_triangle() {
    // A strip in zigzag and a fan around its first vertex, both facing +z.
    let strip = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.0, 2.0, 0.0];
    let fan = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0, -1.0, 1.0, 0.0];
    for (mode, positions) in [(5, strip), (6, fan)] {
        let mut file = File::new();
        file.floats("POSITION", "VEC3", &positions);
        file.primitive()["mode"] = mode.into();
        let scene = file.scene();
        assert_eq!(scene.triangles().len(), 3, "mode {mode}");
        for triangle in 0..3 {
            assert_eq!(front(&scene, triangle), Vec3::Z, "mode {mode}, triangle {triangle}");
        }
    }
}

#[test]
fn points_lines_and_incomplete_triangles_are_left_out_with_a_note() {
    let mut file = File::triangle();
    let lines = json!({"attributes": {"POSITION": 0}, "mode": 1});
    let nothing = json!({"attributes": {}});
    file.json["meshes"][0]["primitives"].as_array_mut().unwrap().extend([lines, nothing]);
    file.indices(&[0, 1, 2, 0, 1]);
    let scene = file.scene();
    assert_eq!(scene.triangles().len(), 1);
    for part in ["points or lines", "no positions", "incomplete triangle"] {
        assert!(scene.notes().iter().any(|note| note.starts_with("1 primitive") && note.contains(part)), "{part}");
    }
}

#[test]
fn indices_of_every_width_mean_the_same() {
    for (component, bytes) in [
        (UNSIGNED_BYTE, vec![2, 0, 1]),
        (UNSIGNED_SHORT, vec![2, 0, 0, 0, 1, 0]),
        (UNSIGNED_INT, vec![2, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0]),
    ] {
        let mut file = File::triangle();
        file.floats("NORMAL", "VEC3", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
        let accessor = file.accessor(component, "SCALAR", 3, &bytes);
        file.primitive()["indices"] = accessor.into();
        assert_eq!(file.scene().triangles(), [[2, 0, 1]], "component type {component}");
    }
}

#[test]
fn vertices_that_no_triangle_uses_do_not_enter_the_scene() {
    let mut file = File::new();
    file.floats("POSITION", "VEC3", &[1e30, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    file.floats("NORMAL", "VEC3", &[0.0, 0.0, 1.0].repeat(4));
    file.indices(&[1, 2, 3]);
    let scene = file.scene();
    assert_eq!(scene.vertices().positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert_eq!(scene.triangles(), [[0, 1, 2]]);
}

#[test]
fn sparse_accessors_replace_what_they_name() {
    let mut file = File::triangle();
    let indices = file.view(&[2, 0]);
    let values = file.view(bytemuck::cast_slice(&[0.0_f32, 7.0, 0.0]));
    file.json["accessors"][0]["sparse"] = json!({
        "count": 1,
        "indices": {"bufferView": indices, "componentType": UNSIGNED_SHORT},
        "values": {"bufferView": values},
    });
    assert_eq!(corners(&file.scene(), 0), [Vec3::ZERO, Vec3::X, 7.0 * Vec3::Y]);
    file.json["accessors"][0]["sparse"]["count"] = 2.into();
    assert!(file.error().contains("do not fit"), "{}", file.error());
}

#[test]
fn quantized_attributes_are_read_as_their_extension_says() {
    let mut file = File::new();
    let positions: [i16; 12] = [0, 0, 0, 99, 200, 0, 0, 99, 0, -300, 0, 99];
    let accessor = file.accessor(5122, "VEC3", 3, bytemuck::cast_slice(&positions));
    let view = file.json["bufferViews"].as_array().unwrap().len() - 1;
    file.json["bufferViews"][view]["byteStride"] = 8.into();
    file.primitive()["attributes"]["POSITION"] = accessor.into();
    // -127 and -128 both stand for -1.
    let normals: [i8; 12] = [0, 0, 127, 0, 0, -127, 0, 0, 0, 0, -128, 0];
    let accessor = file.accessor(5120, "VEC3", 3, bytemuck::cast_slice(&normals));
    file.json["bufferViews"][accessor]["byteStride"] = 4.into();
    file.json["accessors"][accessor]["normalized"] = true.into();
    file.primitive()["attributes"]["NORMAL"] = accessor.into();
    file.json["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
    file.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let scene = file.scene();
    assert_eq!(corners(&scene, 0), [Vec3::ZERO, Vec3::new(200.0, 0.0, 0.0), Vec3::new(0.0, -300.0, 0.0)]);
    assert_eq!(scene.vertices().normals, [Vec3::Z, Vec3::NEG_Y, Vec3::NEG_Z]);
}

#[test]
fn vertex_colours_of_every_type_are_read() {
    let thirds: [u16; 12] = [65_535, 0, 13_107, 65_535, 0, 0, 0, 0, 0, 0, 0, 0];
    let bytes: [u8; 12] = [255, 0, 51, 255, 0, 0, 0, 0, 0, 0, 0, 0];
    let rgb: [f32; 9] = [1.0, 0.0, 0.2, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let cases: [(u32, &str, &[u8]); 3] = [
        (UNSIGNED_SHORT, "VEC4", bytemuck::cast_slice(&thirds)),
        (UNSIGNED_BYTE, "VEC4", &bytes),
        (FLOAT, "VEC3", bytemuck::cast_slice(&rgb)),
    ];
    for (component, kind, bytes) in cases {
        let mut file = File::triangle();
        let accessor = file.accessor(component, kind, 3, bytes);
        file.json["accessors"][accessor]["normalized"] = (component != FLOAT).into();
        file.primitive()["attributes"]["COLOR_0"] = accessor.into();
        let color = file.scene().vertices().colors[0];
        assert!(color.distance(Vec4::new(1.0, 0.0, 0.2, 1.0)) < 1e-6, "{component}: {color}");
    }
    let mut file = File::triangle();
    let accessor = file.accessor(UNSIGNED_BYTE, "VEC4", 3, &bytes);
    file.primitive()["attributes"]["COLOR_0"] = accessor.into();
    assert!(file.error().contains("not normalized"), "{}", file.error());
}

#[test]
fn materials_bring_colour_alpha_sides_and_roughness() {
    let mut file = File::triangle();
    file.material(json!({
        "name": "leaf",
        "alphaMode": "MASK",
        "doubleSided": true,
        "pbrMetallicRoughness": {"baseColorFactor": [0.25, 0.5, 1.0000001, 0.75], "roughnessFactor": 0.5},
    }));
    let scene = file.scene();
    let material = &scene.materials()[0];
    assert_eq!(material.base_color, Vec4::new(0.25, 0.5, 1.0, 0.75));
    assert_eq!((material.alpha, material.double_sided, material.roughness), (Alpha::Mask { cutoff: 0.5 }, true, 0.5));
    assert_eq!(material.name, "leaf");

    file.json["materials"][0]["alphaMode"] = "BLEND".into();
    let scene = file.scene();
    assert_eq!(scene.materials()[0].alpha, Alpha::Opaque);
    assert!(scene.notes()[0].contains("1 material is blended"), "{:?}", scene.notes());
}

#[test]
fn textures_bring_texels_wrap_modes_and_their_own_coordinates() {
    let mut file = File::triangle();
    file.texture();
    file.json["samplers"] = json!([{"wrapS": 33071, "wrapT": 33648}]);
    file.json["textures"][0]["sampler"] = 0.into();
    file.material(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "texCoord": 1}}}));
    file.floats("TEXCOORD_0", "VEC2", &[9.0; 6]);
    file.floats("TEXCOORD_1", "VEC2", &[0.0, 0.0, 0.5, 0.25, 2.0, -1.0]);
    let scene = file.scene();
    let texture = scene.materials()[0].texture.unwrap();
    assert_eq!((texture.wrap_u, texture.wrap_v), (Wrap::ClampToEdge, Wrap::MirroredRepeat));
    assert_eq!(scene.images()[0].texels, [[255, 0, 0, 255], [0, 255, 0, 128]]);
    assert_eq!(scene.vertices().uvs, [Vec2::ZERO, Vec2::new(0.5, 0.25), Vec2::new(2.0, -1.0)]);

    file.json["textures"][0]["sampler"].take();
    let texture = file.scene().materials()[0].texture.unwrap();
    assert_eq!((texture.wrap_u, texture.wrap_v), (Wrap::Repeat, Wrap::Repeat));
}

#[test]
fn texture_transforms_scale_then_turn_then_move() {
    let mut file = File::triangle();
    file.texture();
    let transform = json!({"offset": [0.5, 0.0], "rotation": core::f64::consts::FRAC_PI_2, "scale": [2.0, 1.0]});
    let info = json!({"index": 0, "extensions": {"KHR_texture_transform": transform}});
    file.material(json!({"pbrMetallicRoughness": {"baseColorTexture": info}}));
    file.floats("TEXCOORD_0", "VEC2", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    let uvs = file.scene().vertices().uvs.clone();
    // A quarter turn counter-clockwise takes the direction of u to that of -v, since v points down.
    for (found, expected) in uvs.iter().zip([Vec2::new(0.5, 0.0), Vec2::new(0.5, -2.0), Vec2::new(1.5, 0.0)]) {
        assert!(found.distance(expected) < 1e-6, "{found} is not {expected}");
    }
}

#[test]
fn an_image_is_read_once_and_only_if_it_is_used() {
    let mut file = File::triangle();
    file.texture();
    file.json["images"].as_array_mut().unwrap().push(json!({"uri": "missing.png"}));
    file.json["textures"] = json!([{"source": 0}, {"source": 0}, {"source": 1}]);
    file.json["materials"] = json!([
        {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}},
        {"pbrMetallicRoughness": {"baseColorTexture": {"index": 1}}},
        {"pbrMetallicRoughness": {"baseColorTexture": {"index": 2}}},
        {"emissiveTexture": {"index": 2}},
    ]);
    file.floats("TEXCOORD_0", "VEC2", &[0.0; 6]);
    let mut primitive = file.primitive().clone();
    for material in [0, 1, 3] {
        primitive["material"] = material.into();
        file.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(primitive.clone());
    }
    let scene = file.scene();
    assert_eq!((scene.images().len(), scene.materials().len()), (1, 4), "three materials and the default one");
}

#[test]
fn images_of_other_formats_and_oversized_ones_are_refused() {
    let mut file = File::triangle();
    file.texture();
    file.material(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}));
    for (bytes, message) in [(&b"GIF89a...."[..], "format Gif; convert it to PNG or JPEG"), (b"nothing", "neither PNG nor JPEG")]
    {
        let view = file.view(bytes);
        file.json["images"][0]["bufferView"] = view.into();
        assert!(file.error().contains(message) && file.error().contains("images[0]"), "{}", file.error());
    }
    let mut png = Vec::new();
    let image = image::GrayImage::new(16_385, 1);
    image.write_to(&mut std::io::Cursor::new(&mut png), image::ImageFormat::Png).unwrap();
    let view = file.view(&png);
    file.json["images"][0]["bufferView"] = view.into();
    assert!(file.error().contains("is 16385 x 1 texels; each side must be between 1 and 16384"), "{}", file.error());
}

#[test]
fn lights_stand_and_point_as_their_nodes_do() {
    let mut file = File::triangle();
    let quarter = Quat::from_rotation_x(-core::f32::consts::FRAC_PI_2);
    file.json["nodes"] = json!([
        {"mesh": 0, "children": [1, 2, 3], "translation": [0, 10, 0], "scale": [3, 3, 3]},
        {"extensions": {"KHR_lights_punctual": {"light": 0}}, "rotation": quarter.to_array()},
        {"extensions": {"KHR_lights_punctual": {"light": 1}}, "translation": [1, 0, 0], "name": "bulb"},
        {"extensions": {"KHR_lights_punctual": {"light": 2}}},
    ]);
    file.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "directional", "color": [1, 0.5, 0.25], "intensity": 1000, "name": "sun"},
        {"type": "point", "range": 4},
        {"type": "spot", "intensity": 7, "spot": {"innerConeAngle": 0.25, "outerConeAngle": 0.5}},
    ]}});
    let scene = file.scene();
    let lights = scene.lights();
    let LightKind::Directional { direction } = lights[0].light.kind else { panic!("{lights:?}") };
    assert!(direction.distance(Vec3::NEG_Y) < 1e-6, "-z turned by -90 degrees about x is -y: {direction}");
    assert_eq!((lights[0].light.color, lights[0].light.intensity), (Vec3::new(1.0, 0.5, 0.25), 1000.0));
    assert_eq!(lights[0].name, "sun");
    // Lengths that belong to the light are not scaled.
    assert_eq!(lights[1].light.kind, LightKind::Point { position: Vec3::new(3.0, 10.0, 0.0), range: Some(4.0) });
    assert_eq!((&*lights[1].name, lights[1].light.intensity), ("bulb", 1.0));
    let LightKind::Spot { position, direction, inner, outer, range } = lights[2].light.kind else { panic!("{lights:?}") };
    assert_eq!((position, direction, inner, outer, range), (10.0 * Vec3::Y, Vec3::NEG_Z, 0.25, 0.5, None));

    file.json["extensions"]["KHR_lights_punctual"]["lights"][2]["spot"]["innerConeAngle"] = 0.5.into();
    let message = file.error();
    assert!(message.contains("extensions.KHR_lights_punctual.lights[2]") && message.contains("28.6"), "{message}");
}

#[test]
fn cameras_lose_their_scale_and_keep_their_names() {
    let mut file = File::triangle();
    file.json["nodes"] = json!([
        {"mesh": 0},
        {"camera": 0, "translation": [0, 0, 5], "scale": [-2, 3, 4]},
        {"camera": 1, "name": "from the side", "rotation": Quat::from_rotation_y(core::f32::consts::FRAC_PI_2).to_array()},
    ]);
    file.json["scenes"] = json!([{"nodes": [0, 1, 2]}]);
    file.json["cameras"] = json!([
        {"type": "perspective", "name": "main", "perspective": {"yfov": 0.5, "znear": 0.25, "zfar": 100}},
        {"type": "orthographic", "orthographic": {"xmag": 4, "ymag": 3, "znear": 0, "zfar": 50}},
    ]);
    let scene = file.scene();
    let [main, side] = scene.cameras() else { panic!("{:?}", scene.cameras()) };
    assert_eq!((&*main.name, &*side.name), ("main", "from the side"));
    assert_eq!(main.camera.projection, Projection::Perspective { vertical_fov: 0.5, near: 0.25, far: Some(100.0) });
    assert!(main.camera.direction().distance(DVec3::NEG_Z) < 1e-12, "a mirrored node does not mirror the picture");
    assert!((main.camera.orientation * DVec3::Y).distance(DVec3::Y) < 1e-12);
    assert_eq!(side.camera.projection, Projection::Orthographic { half_height: 3.0, near: 0.0, far: 50.0 });
    assert!(side.camera.direction().distance(DVec3::NEG_X) < 1e-6);

    file.json["cameras"][0]["perspective"]["zfar"] = 0.1.into();
    assert!(file.error().contains("cameras[0]: the camera's near plane at 0.25 m and far plane at 0.1"), "{}", file.error());
}

#[test]
fn only_the_default_scene_is_drawn() {
    let mut file = File::triangle();
    file.json["nodes"] = json!([{"mesh": 0, "name": "first"}, {"mesh": 0, "name": "second"}]);
    file.json["scenes"] = json!([{"nodes": [0]}, {"nodes": [1]}]);
    file.json["scene"] = 1.into();
    assert_eq!(file.scene().instances()[0].name, "second");
    file.json.as_object_mut().unwrap().remove("scene");
    assert_eq!(file.scene().instances()[0].name, "first");
    file.json.as_object_mut().unwrap().remove("scenes");
    assert_eq!(file.scene().instances().len(), 2, "without scenes every root node is drawn");
}

#[test]
fn skins_stand_in_their_rest_pose_and_their_node_is_ignored() {
    let mut file = File::triangle();
    file.json["nodes"] = json!([
        {"mesh": 0, "skin": 0, "translation": [100, 0, 0]},
        {"translation": [0, 0, 5], "children": [2]},
        {"translation": [0, 2, 0]},
    ]);
    file.json["scenes"] = json!([{"nodes": [0, 1]}]);
    file.json["skins"] = json!([{"joints": [1, 2]}]);
    let joints = file.accessor(UNSIGNED_BYTE, "VEC4", 3, &[0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 9]);
    file.primitive()["attributes"]["JOINTS_0"] = joints.into();
    // The first vertex belongs to both joints, the second to the second, the third has no weight at all.
    file.floats("WEIGHTS_0", "VEC4", &[0.5, 0.5, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let expected = [Vec3::new(0.0, 1.0, 5.0), Vec3::new(1.0, 2.0, 5.0), Vec3::new(0.0, 1.0, 5.0)];
    assert_eq!(corners(&file.scene(), 0), expected);

    // The inverse bind matrix of the first joint undoes its transform.
    let mut matrices = [glam::Mat4::from_translation(Vec3::new(0.0, 0.0, -5.0)); 2];
    matrices[1] = glam::Mat4::from_translation(Vec3::new(0.0, -2.0, -5.0));
    let matrices = file.float_accessor("MAT4", bytemuck::cast_slice(&matrices.map(|m| m.to_cols_array())));
    file.json["skins"][0]["inverseBindMatrices"] = matrices.into();
    assert_eq!(corners(&file.scene(), 0), [Vec3::ZERO, Vec3::X, Vec3::Y]);

    file.json["skins"][0]["joints"] = json!([1]);
    assert!(file.error().contains("names joint 1, but skins[0] has only 1"), "{}", file.error());
}

#[test]
fn morph_targets_are_added_with_their_default_weights() {
    let mut file = File::triangle();
    let deltas = file.float_accessor("VEC3", &[0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 4.0]);
    file.primitive()["targets"] = json!([{"POSITION": deltas}, {"POSITION": deltas}]);
    assert_eq!(corners(&file.scene(), 0), [Vec3::ZERO, Vec3::X, Vec3::Y], "without weights nothing is added");
    file.json["meshes"][0]["weights"] = json!([0.5, 0]);
    assert_eq!(corners(&file.scene(), 0), [Vec3::ZERO, 2.0 * Vec3::X, Vec3::new(0.0, 1.0, 2.0)]);
    file.json["nodes"][0]["weights"] = json!([0, -0.5]);
    assert_eq!(corners(&file.scene(), 0), [Vec3::ZERO, Vec3::ZERO, Vec3::new(0.0, 1.0, -2.0)], "the node's weights win");
}

#[test]
fn instances_stand_where_their_accessors_say() {
    let mut file = File::triangle();
    let translations = file.float_accessor("VEC3", &[0.0, 0.0, 0.0, 5.0, 0.0, 0.0]);
    let scales = file.float_accessor("VEC3", &[1.0, 1.0, 1.0, 1.0, 1.0, -1.0]);
    let attributes = json!({"TRANSLATION": translations, "SCALE": scales});
    file.json["nodes"][0]["extensions"] = json!({"EXT_mesh_gpu_instancing": {"attributes": attributes}});
    file.json["nodes"][0]["translation"] = json!([0, 1, 0]);
    let scene = file.scene();
    assert_eq!(scene.instances().len(), 2);
    assert_eq!((corners(&scene, 0)[0], front(&scene, 0)), (Vec3::Y, Vec3::Z));
    assert_eq!((corners(&scene, 1)[0], front(&scene, 1)), (Vec3::new(5.0, 1.0, 0.0), Vec3::NEG_Z));
}

#[test]
fn extensions_are_noted_or_refused_with_the_way_out() {
    let mut file = File::triangle();
    file.json["extensionsUsed"] = json!(["KHR_materials_clearcoat", "ACME_fog", "KHR_texture_transform"]);
    file.json["extensionsRequired"] = json!(["KHR_materials_clearcoat"]);
    let scene = file.scene();
    let note = &scene.notes()[0];
    assert!(note.ends_with("left out: KHR_materials_clearcoat, ACME_fog"), "{note}");
    for (name, way_out) in [("KHR_texture_basisu", "gltf-transform ktxdecompress"), ("ACME_fog", "export the file without it")] {
        file.json["extensionsRequired"] = json!([name]);
        let message = file.error();
        assert!(message.contains(name) && message.contains(way_out) && message.contains("extensionsRequired[0]"), "{message}");
    }
}

#[test]
fn extras_and_attributes_of_applications_are_passed_over() {
    let mut file = File::triangle();
    for extras in [json!("text"), json!(7), json!([1, {"a": null}]), json!({"a": 1}), json!(true)] {
        file.json["nodes"][0]["extras"] = extras.clone();
        file.json["extras"] = extras;
        file.scene();
    }
    file.floats("_TEMPERATURE", "SCALAR", &[1.0, 2.0, 3.0]);
    file.scene();
}

#[test]
fn images_of_every_colour_type_become_the_same_texels() {
    let gray = image::GrayImage::from_raw(2, 1, vec![0, 200]).unwrap();
    let dynamic = image::DynamicImage::ImageLuma8(gray);
    let (rgb, wide) = (dynamic.to_rgb8().into(), dynamic.to_rgba16().into());
    for image in [dynamic, rgb, wide] {
        let mut file = File::triangle();
        file.texture();
        let mut png = Vec::new();
        image.write_to(&mut std::io::Cursor::new(&mut png), image::ImageFormat::Png).unwrap();
        let view = file.view(&png);
        file.json["images"][0]["bufferView"] = view.into();
        file.material(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}));
        assert_eq!(file.scene().images()[0].texels, [[0, 0, 0, 255], [200, 200, 200, 255]], "{:?}", image.color());
    }
}
