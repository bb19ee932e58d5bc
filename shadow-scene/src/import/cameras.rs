//! Cameras.

use glam::{DAffine3, DMat3, DQuat};
use gltf::json::{camera::Type, validation::Checked};
use shadow_math::{Camera, Projection};

use super::{document::Document, error::Result, nodes::Hierarchy};
use crate::builder::SceneBuilder;

/// Adds the cameras of the drawn nodes.
pub(super) fn add(document: &Document, hierarchy: &Hierarchy, builder: &mut SceneBuilder) -> Result<()> {
    for &node in &hierarchy.drawn {
        let node_json = &document.root.nodes[node];
        let (Some(index), Some(world_from_node)) = (node_json.camera, hierarchy.world_from_node(node)) else { continue };
        // `Document` guarantees the index.
        let json = &document.root.cameras[index.value()];
        let place = format!("cameras[{index}]");
        let projection = projection(json).map_err(|problem| document.invalid(&place, problem))?;
        let orientation = orientation(world_from_node).ok_or_else(|| {
            document
                .invalid(format_args!("nodes[{node}]"), "a camera's node must not be scaled to nothing; give it another scale")
        })?;
        let camera = Camera { eye: world_from_node.translation - builder.origin(), orientation, projection };
        camera.validate().map_err(|error| document.invalid(place, error))?;
        let name = json.name.as_ref().or(node_json.name.as_ref()).cloned().unwrap_or_default();
        builder.add_camera(name, camera);
    }
    Ok(())
}

/// The projection; its ranges are checked with the camera.
fn projection(json: &gltf::json::Camera) -> core::result::Result<Projection, &'static str> {
    match (&json.type_, &json.perspective, &json.orthographic) {
        (Checked::Valid(Type::Perspective), Some(perspective), _) => {
            // The viewport's aspect ratio is used, but a file must not contain nonsense.
            if perspective.aspect_ratio.is_some_and(|aspect| aspect.is_nan() || aspect <= 0.0) {
                return Err("the aspect ratio must be above 0; leave it out for the viewport's");
            }
            Ok(Projection::Perspective {
                vertical_fov: perspective.yfov.into(),
                near: perspective.znear.into(),
                far: perspective.zfar.map(f64::from),
            })
        }
        (Checked::Valid(Type::Orthographic), _, Some(orthographic)) => {
            if orthographic.xmag == 0.0 {
                return Err("xmag must not be 0; it is half the width of the view in metres");
            }
            Ok(Projection::Orthographic {
                // A negative one would turn the picture over; glTF advises against it.
                half_height: orthographic.ymag.abs().into(),
                near: orthographic.znear.into(),
                far: orthographic.zfar.into(),
            })
        }
        _ => Err("the projection that its type names is missing; export the file again"),
    }
}

/// The rotation from view to world space: the node's, without scale, shear and mirroring. `None` if a scale of 0 leaves
/// no direction.
fn orientation(world_from_node: DAffine3) -> Option<DQuat> {
    let matrix = world_from_node.matrix3;
    let back = matrix.z_axis.try_normalize()?;
    let right = matrix.y_axis.try_normalize()?.cross(back).try_normalize()?;
    Some(DQuat::from_mat3(&DMat3::from_cols(right, back.cross(right), back)))
}
