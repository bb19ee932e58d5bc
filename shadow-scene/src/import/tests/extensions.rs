//! Scenes that are chosen, nodes that are hidden, and materials of the older model.

use super::*;
use crate::import::{Choice, ImportOptions, import_slice_with};

#[test]
fn a_scene_is_chosen_by_number_or_name() {
    let mut file = File::triangle();
    file.json["nodes"] = json!([{"mesh": 0, "name": "first"}, {"mesh": 0, "name": "second"}]);
    file.json["scenes"] = json!([{"nodes": [0], "name": "day"}, {"nodes": [1]}, {"nodes": [0, 1], "name": "night"}]);
    file.json["asset"]["generator"] = "a test".into();
    let with = |scene| import_slice_with("test.glb", &file.bytes(), &ImportOptions { scene, ..ImportOptions::default() });
    for (choice, count, drawn) in
        [(None, 1, 0), (Some(Choice::Index(1)), 1, 1), (Some(Choice::Name("night".into())), 2, 2), (Some(Choice::Index(2)), 2, 2)]
    {
        let scene = with(choice.clone()).unwrap();
        assert_eq!((scene.instances().len(), scene.source().scene), (count, Some(drawn)), "{choice:?}");
        assert_eq!(scene.source().scenes, ["day", "", "night"]);
        assert_eq!((scene.source().nodes, scene.source().meshes, scene.source().primitives), (2, 1, 1));
        assert_eq!(scene.source().generator.as_deref(), Some("a test"));
    }
    let message = with(Some(Choice::Index(3))).unwrap_err().to_string();
    assert!(message.ends_with("there is no scene 3; choose one of 0 (`day`), 1, 2 (`night`)"), "{message}");
}

/// Hidden are meshes, instances and lights of the node and all below it, whatever those say; cameras are not.
#[test]
fn hidden_nodes_hide_all_below_them_but_cameras() {
    let mut file = File::triangle();
    let translations = file.float_accessor("VEC3", &[0.0, 0.0, 0.0, 5.0, 0.0, 0.0]);
    let hidden = json!({"KHR_node_visibility": {"visible": false}});
    file.json["extensionsUsed"] = json!(["KHR_node_visibility"]);
    file.json["extensionsRequired"] = json!(["KHR_node_visibility"]);
    file.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "point", "name": "lamp"}]}});
    file.json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}]);
    file.json["nodes"] = json!([
        {"mesh": 0, "children": [1], "extensions": hidden},
        {"mesh": 0, "children": [2], "extensions": {
            "KHR_node_visibility": {"visible": true},
            "EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": translations}},
        }},
        {"camera": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}},
        {"mesh": 0, "name": "seen", "extensions": {"KHR_node_visibility": {}}},
    ]);
    file.json["scenes"] = json!([{"nodes": [0, 3]}]);
    let scene = file.scene();
    assert_eq!(scene.instances().iter().map(|instance| instance.name.as_str()).collect::<Vec<_>>(), ["seen"]);
    assert!(scene.has_default_light() && !scene.has_default_camera());
    file.json["nodes"][0]["extensions"]["KHR_node_visibility"]["visible"] = true.into();
    let scene = file.scene();
    assert_eq!((scene.instances().len(), scene.lights()[0].name.as_str()), (4, "lamp"));
    file.json["nodes"][3]["extensions"]["KHR_node_visibility"]["visible"] = 1.into();
    assert!(file.error().contains("nodes[3].extensions.KHR_node_visibility: must be an object"), "{}", file.error());
}

#[test]
fn the_diffuse_colour_stands_for_the_base_colour() {
    let mut file = File::triangle();
    file.floats("TEXCOORD_1", "VEC2", &[0.5; 6]);
    file.texture();
    let extension = json!({
        "diffuseFactor": [0.25, 0.5, 2.0, 0.75], "glossinessFactor": 0.75, "specularFactor": [1, 0, 0],
        "diffuseTexture": {"index": 0, "texCoord": 1},
    });
    file.material(json!({
        "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1]},
        "extensions": {"KHR_materials_pbrSpecularGlossiness": extension},
    }));
    let scene = file.scene();
    let material = &scene.materials()[0];
    assert_eq!((material.base_color, material.roughness), (Vec4::new(0.25, 0.5, 1.0, 0.75), 0.25));
    assert!(material.texture.is_some() && scene.vertices().uvs[0] == Vec2::splat(0.5));
    let place = "materials[0].extensions.KHR_materials_pbrSpecularGlossiness";
    file.json["materials"][0]["extensions"]["KHR_materials_pbrSpecularGlossiness"]["diffuseTexture"]["index"] = 4.into();
    assert!(file.error().contains(&format!("{place}.diffuseTexture: names a texture")), "{}", file.error());
    file.json["materials"][0]["extensions"]["KHR_materials_pbrSpecularGlossiness"] = json!({"diffuseFactor": "red"});
    assert!(file.error().contains(place), "{}", file.error());
}
