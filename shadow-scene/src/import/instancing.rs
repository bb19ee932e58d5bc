//! EXT_mesh_gpu_instancing: one node that shows its mesh many times.

use glam::{DAffine3, DQuat, DVec3};

use super::{
    accessor::{Accessor, Format},
    budget::Use,
    buffers::Buffers,
    document::Document,
    error::Result,
    nodes::unit_quaternion,
};

const EXTENSION: &str = "EXT_mesh_gpu_instancing";

/// The matrices from the mesh's space to the world, one per instance; the node's own if it is not instanced.
pub(super) fn world_from_instances(
    document: &Document,
    buffers: &Buffers<'_>,
    node: usize,
    world_from_node: DAffine3,
) -> Result<Vec<DAffine3>> {
    let Some(extension) = document.node_value(node, "extensions").and_then(|extensions| extensions.get(EXTENSION)) else {
        return Ok(vec![world_from_node]);
    };
    let place = format!("nodes[{node}].extensions.{EXTENSION}.attributes");
    let open = |name: &str, format: Format| {
        let Some(index) = extension["attributes"].get(name) else { return Ok(None) };
        let place = format!("{place}.{name}");
        let index = index.as_u64().and_then(|index| usize::try_from(index).ok());
        let index = index.ok_or_else(|| document.invalid(&place, "is not the index of an accessor; export the file again"))?;
        Accessor::open_counted(document, buffers, index, format, place).map(Some)
    };
    let translations = open("TRANSLATION", Format::VECTOR)?;
    let rotations = open("ROTATION", Format::ROTATION)?;
    let scales = open("SCALE", Format::VECTOR)?;

    let mut counts = [&translations, &rotations, &scales].into_iter().flatten().map(Accessor::count);
    let Some(count) = counts.next() else {
        return Err(document.invalid(place, "names none of TRANSLATION, ROTATION and SCALE; export the file again"));
    };
    if counts.any(|other| other != count) {
        return Err(document.invalid(place, "name accessors of different counts; export the file again"));
    }
    // Memory for the matrices below.
    buffers.budget().claim(Use::Meshes, count as u64 * size_of::<DAffine3>() as u64, &place)?;
    let vector = |accessor: &Option<Accessor<'_>>, i: usize, default: DVec3| {
        accessor.as_ref().map_or(default, |accessor| DVec3::from_array(accessor.vector(i).map(f64::from)))
    };
    (0..count)
        .map(|i| {
            let rotation = match &rotations {
                None => DQuat::IDENTITY,
                Some(rotations) => unit_quaternion(rotations.vector(i).map(f64::from)).ok_or_else(|| {
                    document.invalid(&place, format_args!("the ROTATION of instance {i} has no direction; export the file again"))
                })?,
            };
            let node_from_instance = DAffine3::from_scale_rotation_translation(
                vector(&scales, i, DVec3::ONE),
                rotation,
                vector(&translations, i, DVec3::ZERO),
            );
            let world_from_instance = world_from_node * node_from_instance;
            if world_from_instance.is_finite() {
                Ok(world_from_instance)
            } else {
                Err(document.invalid(&place, format_args!("the transform of instance {i} is not finite; export the file again")))
            }
        })
        .collect()
}
