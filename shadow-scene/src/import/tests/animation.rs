//! Animations: closed forms of every interpolation, the choice of a pose, and the key data that are refused.

use core::f64::consts::FRAC_1_SQRT_2;

use super::*;
use crate::import::{Choice, ImportOptions, import_slice_with};

impl File {
    /// Adds an animation of one channel of node 0.
    fn animate(&mut self, path: &str, interpolation: &str, times: &[f32], kind: &str, values: &[f32]) {
        let (input, output) = (self.float_accessor("SCALAR", times), self.float_accessor(kind, values));
        let animation = json!({
            "samplers": [{"input": input, "output": output, "interpolation": interpolation}],
            "channels": [{"sampler": 0, "target": {"node": 0, "path": path}}],
        });
        if self.json["animations"].is_null() {
            self.json["animations"] = json!([]);
        }
        self.json["animations"].as_array_mut().unwrap().push(animation);
    }

    fn import_at(&self, time: f64) -> Result<Scene, ImportError> {
        self.import_as(&ImportOptions { time, ..ImportOptions::default() })
    }

    fn import_as(&self, options: &ImportOptions) -> Result<Scene, ImportError> {
        import_slice_with("test.glb", &self.bytes(), options)
    }
}

/// Where the first corner of the first triangle is in the file's world.
fn first_corner(scene: &Scene) -> Vec3 {
    (corners(scene, 0)[0].as_dvec3() + scene.origin()).as_vec3()
}

/// Asserts where the first corner of the first triangle is, which lies at the origin of its node, at some times.
fn assert_moves(file: &File, places: &[(f64, [f32; 3])]) {
    for &(time, place) in places {
        let found = first_corner(&file.import_at(time).unwrap());
        assert!(found.distance(Vec3::from_array(place)) < 1e-6, "at {time} s: {found}, not {place:?}");
    }
}

#[test]
fn translations_follow_their_keys() {
    let mut file = File::triangle();
    file.json["nodes"][0]["translation"] = json!([9, 9, 9]);
    let (times, values) = ([1.0, 2.0, 4.0], [0.0, 0.0, 0.0, 8.0, 0.0, 0.0, 8.0, 2.0, 0.0]);
    file.animate("translation", "LINEAR", &times, "VEC3", &values);
    let ends = [(0.0, [0.0; 3]), (1.0, [0.0; 3]), (2.0, [8.0, 0.0, 0.0]), (4.0, [8.0, 2.0, 0.0]), (99.0, [8.0, 2.0, 0.0])];
    assert_moves(&file, &ends);
    assert_moves(&file, &[(1.25, [2.0, 0.0, 0.0]), (3.5, [8.0, 1.5, 0.0])]);
    file.json["animations"][0]["samplers"][0]["interpolation"] = "STEP".into();
    assert_moves(&file, &ends);
    assert_moves(&file, &[(1.25, [0.0; 3]), (3.99, [8.0, 0.0, 0.0])]);
    // Linear is what a sampler is that does not say.
    file.json["animations"][0]["samplers"][0].as_object_mut().unwrap().remove("interpolation");
    assert_moves(&file, &[(1.25, [2.0, 0.0, 0.0])]);
}

/// Tangents are in units a second, so that the cubic through the values and slopes of t^3 is t^3 whatever the keys.
#[test]
fn cubic_splines_reproduce_a_cubic() {
    let mut file = File::triangle();
    let cube = |t: f32| [[3.0 * t * t, 0.0, 1.0], [t * t * t, 5.0, t], [3.0 * t * t, 0.0, 1.0]].concat();
    file.animate("translation", "CUBICSPLINE", &[0.0, 0.5, 3.0], "VEC3", &[0.0, 0.5, 3.0].map(cube).concat());
    for t in [0.0, 0.2, 0.5, 1.7, 2.9, 3.0_f32] {
        let found = first_corner(&file.import_at(t.into()).unwrap());
        assert!(found.distance(Vec3::new(t * t * t, 5.0, t)) < 1e-5, "at {t} s: {found}");
    }
}

#[test]
fn rotations_take_the_shorter_way_at_an_even_pace() {
    let half = FRAC_1_SQRT_2 as f32;
    let x_axis = |file: &File, time: f64| corners(&file.import_at(time).unwrap(), 0)[1];
    // A quarter turn about z; then the same with the opposite quaternion, which is the same rotation, and not of unit length.
    for end in [[0.0, 0.0, half, half], [0.0, 0.0, -2.0, -2.0]] {
        let mut file = File::triangle();
        file.animate("rotation", "LINEAR", &[0.0, 3.0], "VEC4", &[[0.0, 0.0, 0.0, 1.0], end].concat());
        for (time, degrees) in [(0.0, 0.0), (1.0, 30.0), (2.0, 60.0), (3.0, 90.0_f32)] {
            let expected = Vec3::new(degrees.to_radians().cos(), degrees.to_radians().sin(), 0.0);
            assert!(x_axis(&file, time).distance(expected) < 1e-6, "{end:?} at {time} s: {}", x_axis(&file, time));
        }
    }
    // Fractions in 16 bits, and a spline without slopes, whose middle is the mean of its ends at unit length.
    let mut file = File::triangle();
    file.animate("rotation", "CUBICSPLINE", &[0.0, 1.0], "VEC4", &[0.0; 24]);
    let words = [[0; 4], [0, 0, 0, 32_767], [0; 4], [0; 4], [0, 0, 23_170, 23_170], [0; 4_usize]].concat();
    let words: Vec<i16> = words;
    let output = file.accessor(5122, "VEC4", 6, bytemuck::cast_slice(&words));
    file.json["accessors"][output]["normalized"] = true.into();
    file.json["animations"][0]["samplers"][0]["output"] = output.into();
    let expected = Vec3::new(45_f32.to_radians().cos(), 45_f32.to_radians().sin(), 0.0);
    assert!(x_axis(&file, 0.5).distance(expected) < 1e-4, "{}", x_axis(&file, 0.5));
}

#[test]
fn weights_of_morph_targets_follow_their_keys() {
    let mut file = File::triangle();
    let deltas = [1.0, 10.0].map(|x| file.float_accessor("VEC3", &[x, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]));
    file.primitive()["targets"] = json!([{"POSITION": deltas[0]}, {"POSITION": deltas[1]}]);
    file.json["meshes"][0]["weights"] = json!([7, 7]);
    file.animate("weights", "LINEAR", &[0.0, 1.0], "SCALAR", &[0.0, 1.0, 1.0, 0.5]);
    assert_moves(&file, &[(0.0, [10.0, 0.0, 0.0]), (0.5, [8.0, 0.0, 0.0]), (1.0, [6.0, 0.0, 0.0])]);
    file.json["meshes"][0]["primitives"][0].as_object_mut().unwrap().remove("targets");
    assert!(file.error().contains("animations[0].channels[0]: moves the weights of nodes[0]"), "{}", file.error());
}

#[test]
fn joints_move_the_skin() {
    let mut file = File::triangle();
    file.json["nodes"] = json!([{"translation": [0, 1, 0], "children": [1]}, {}, {"mesh": 0, "skin": 0}]);
    file.json["scenes"] = json!([{"nodes": [0, 2]}]);
    file.json["skins"] = json!([{"joints": [1]}]);
    let joints = file.accessor(UNSIGNED_BYTE, "VEC4", 3, &[0; 12]);
    file.primitive()["attributes"]["JOINTS_0"] = joints.into();
    file.floats("WEIGHTS_0", "VEC4", &[1.0, 0.0, 0.0, 0.0].repeat(3));
    file.animate("scale", "LINEAR", &[0.0, 1.0], "VEC3", &[1.0, 1.0, 1.0, 3.0, 3.0, 3.0]);
    let scene = file.import_at(0.5).unwrap();
    assert_eq!(corners(&scene, 0), [Vec3::Y, Vec3::new(2.0, 1.0, 0.0), Vec3::new(0.0, 3.0, 0.0)]);
}

#[test]
fn the_first_animation_is_posed_unless_another_is_chosen() {
    let mut file = File::triangle();
    file.animate("translation", "LINEAR", &[0.0, 2.0], "VEC3", &[1.0, 0.0, 0.0, 3.0, 0.0, 0.0]);
    file.animate("translation", "LINEAR", &[0.0, 0.5], "VEC3", &[0.0, 5.0, 0.0, 0.0, 6.0, 0.0]);
    file.json["animations"][1]["name"] = "Up".into();
    let at = |animation: Option<Choice>, time| file.import_as(&ImportOptions { animation, time, ..ImportOptions::default() });
    assert_eq!(first_corner(&file.scene()), Vec3::X, "the first one at 0 s");
    let up = [Choice::Index(1), Choice::Name("Up".into())];
    for choice in up {
        let scene = at(Some(choice), 0.25).unwrap();
        assert_eq!(first_corner(&scene), Vec3::new(0.0, 5.5, 0.0));
        let facts = scene.source();
        assert_eq!((facts.animation, facts.time), (Some(1), 0.25));
        assert_eq!(facts.animations.iter().map(|a| a.seconds).collect::<Vec<_>>(), [2.0, 0.5]);
        assert_eq!((facts.animations[1].name.as_str(), facts.animations[1].channels), ("Up", 1));
    }
    let late = at(Some(Choice::Index(1)), 7.0).unwrap();
    assert_eq!((first_corner(&late), late.source().time), (Vec3::new(0.0, 6.0, 0.0), 0.5));
    assert!(late.notes()[0].contains("`Up` ends at 0.5 s"), "{:?}", late.notes());
    let refused = |animation, time| at(animation, time).unwrap_err().to_string();
    let unknown = refused(Some(Choice::Name("Down".into())), 0.0);
    assert!(unknown.contains("no animation `Down`; choose one of 0, 1 (`Up`)"), "{unknown}");
    assert!(refused(Some(Choice::Index(2)), 0.0).contains("no animation 2; choose one of"));
    for time in [-0.5, f64::NAN, f64::INFINITY] {
        assert!(refused(None, time).contains("0 or more"), "{time}");
    }

    let still = File::triangle();
    assert_eq!(still.scene().source().animation, None);
    assert!(still.import_at(1.0).unwrap_err().to_string().contains("has no animations; leave out the time"));
    let options = ImportOptions { animation: Some(Choice::Index(0)), ..ImportOptions::default() };
    let message = still.import_as(&options).unwrap_err().to_string();
    assert!(message.contains("no animation 0; the file has no animations"), "{message}");
}

#[test]
fn key_data_that_break_the_rules_are_refused_in_every_animation() {
    type Change = fn(&mut File);
    let cases: [(Change, &str); 9] = [
        (|f| f.json["animations"][1]["samplers"][0]["interpolation"] = "CUBICSPLINE".into(), "samplers[0].output: accessors"),
        (|f| f.animate("scale", "LINEAR", &[0.0, 0.0], "VEC3", &[1.0; 6]), "as the time of key 1, which is not after"),
        (|f| f.animate("scale", "LINEAR", &[-1.0, 0.0], "VEC3", &[1.0; 6]), "-1 s as the time of key 0"),
        (|f| f.animate("scale", "LINEAR", &[0.0, f32::NAN], "VEC3", &[1.0; 6]), "NaN s as the time of key 1"),
        (|f| f.animate("scale", "LINEAR", &[0.0, 1.0], "VEC3", &[1.0; 3]), "count of 1, but 2 keys with 1 values"),
        (|f| f.animate("scale", "LINEAR", &[0.0, 1.0], "VEC3", &[f32::INFINITY; 6]), "not finite"),
        (|f| f.animate("rotation", "LINEAR", &[0.0, 1.0], "VEC3", &[1.0; 6]), "must be [Vec4]"),
        (|f| f.json["animations"][1]["channels"][0]["sampler"] = 3.into(), "animations[1].channels[0]"),
        (
            |f| {
                let channel = f.json["animations"][1]["channels"][0].clone();
                f.json["animations"][1]["channels"].as_array_mut().unwrap().push(channel);
            },
            "animations[1].channels[1]: a channel before it moves the same property of nodes[0]",
        ),
    ];
    for (change, message) in cases {
        let mut file = File::triangle();
        for _ in 0..2 {
            file.animate("translation", "LINEAR", &[0.0, 1.0], "VEC3", &[0.0; 6]);
        }
        file.scene();
        change(&mut file);
        assert!(file.error().contains(message), "{} has no `{message}`", file.error());
    }
    let mut file = File::triangle();
    file.json["nodes"][0]["matrix"] = json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
    file.animate("translation", "LINEAR", &[0.0], "VEC3", &[0.0; 3]);
    assert!(file.error().contains("moves nodes[0], which has a matrix"), "{}", file.error());
    let mut file = File::triangle();
    file.animate("rotation", "LINEAR", &[0.0], "VEC4", &[0.0; 4]);
    assert!(file.error().contains("is no rotation"), "{}", file.error());
}

/// Channels that point at something by KHR_animation_pointer have no node; the numbers of the others stay those of the file.
#[test]
fn channels_without_a_node_are_left_out() {
    let mut file = File::triangle();
    file.animate("translation", "LINEAR", &[0.0, 1.0], "VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    let pointer =
        json!({"sampler": 0, "target": {"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": "/nodes/0"}}}});
    file.json["animations"][0]["channels"].as_array_mut().unwrap().insert(0, pointer);
    file.json["extensionsUsed"] = json!(["KHR_animation_pointer"]);
    let scene = file.import_at(0.5).unwrap();
    assert_eq!(corners(&scene, 0)[0], Vec3::new(0.5, 0.0, 0.0));
    assert!(scene.notes()[0].contains("KHR_animation_pointer"), "{:?}", scene.notes());
    file.json["animations"][0]["channels"][1]["target"]["path"] = "weights".into();
    assert!(file.error().contains("animations[0].channels[1]"), "{}", file.error());
}
