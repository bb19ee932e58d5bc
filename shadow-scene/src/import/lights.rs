//! Lights: the extension KHR_lights_punctual.

use glam::{DVec3, Vec3};
use gltf::json::{extensions::scene::khr_lights_punctual::Type, validation::Checked};
use shadow_math::{Light, LightKind};

use super::{document::Document, error::Result, nodes::Hierarchy};
use crate::builder::SceneBuilder;

/// Adds the lights of the drawn nodes.
pub(super) fn add(document: &Document, hierarchy: &Hierarchy, builder: &mut SceneBuilder) -> Result<()> {
    let lights = document.root.extensions.as_ref().and_then(|extensions| extensions.khr_lights_punctual.as_ref());
    let lights = lights.map_or(&[][..], |extension| &extension.lights);
    for node in hierarchy.visible() {
        let node_json = &document.root.nodes[node];
        let extension = node_json.extensions.as_ref().and_then(|extensions| extensions.khr_lights_punctual.as_ref());
        let (Some(extension), Some(world_from_node)) = (extension, hierarchy.world_from_node(node)) else { continue };
        let index = extension.light.value();
        let place = format!("extensions.KHR_lights_punctual.lights[{index}]");
        // `Document` guarantees the index and that the type is valid.
        let (Some(json), true) = (lights.get(index), index < lights.len()) else {
            return Err(document.invalid(place, "does not exist; export the file again"));
        };
        let Checked::Valid(kind) = json.type_ else { return Err(document.invalid(place, "has no valid type")) };

        let position = (world_from_node.translation - builder.origin()).as_vec3();
        // Only its direction counts; unit length in f64 keeps a small scale from vanishing in f32.
        let direction = world_from_node.transform_vector3(DVec3::NEG_Z).normalize_or_zero().as_vec3();
        let kind = match kind {
            Type::Directional => LightKind::Directional { direction },
            Type::Point => LightKind::Point { position, range: json.range },
            Type::Spot => {
                let spot = json.spot.clone().unwrap_or_default();
                LightKind::Spot {
                    position,
                    direction,
                    inner: spot.inner_cone_angle,
                    outer: spot.outer_cone_angle,
                    range: json.range,
                }
            }
        };
        let light = Light { kind, color: Vec3::from_array(json.color), intensity: json.intensity };
        light.validate().map_err(|error| document.invalid(place, format_args!("{error} (nodes[{node}] shows it)")))?;
        let name = json.name.as_ref().or(node_json.name.as_ref()).cloned().unwrap_or_default();
        builder.add_light(name, light);
    }
    Ok(())
}
