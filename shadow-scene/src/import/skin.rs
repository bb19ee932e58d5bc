//! Skins in a pose: section 3.7.3 of the glTF 2.0 specification.

use glam::{DAffine3, DMat3, DVec3};
use gltf::json::mesh::Semantic;

use super::{
    accessor::{Accessor, Format},
    attributes::Source,
    buffers::Buffers,
    document::Document,
    error::Result,
    nodes::{Hierarchy, affine_from_columns},
};

/// A skin whose joints stand where the pose puts them.
#[derive(Debug)]
pub(super) struct Skin {
    index: usize,
    /// For each joint, the matrix from the mesh in its bind pose to the world.
    world_from_bind: Vec<DAffine3>,
}

impl Skin {
    /// Reads the skin `index` of the file.
    pub(super) fn read(document: &Document, buffers: &Buffers<'_>, hierarchy: &Hierarchy, index: usize) -> Result<Self> {
        // `Document` guarantees the indices.
        let json = &document.root.skins[index];
        if json.joints.is_empty() {
            return Err(document
                .invalid(format_args!("skins[{index}].joints"), "a skin must have at least 1 joint; export the file again"));
        }
        let place = format!("skins[{index}].inverseBindMatrices");
        let inverse_binds = json
            .inverse_bind_matrices
            .map(|accessor| Accessor::open(document, buffers, accessor.value(), Format::MATRIX, &place))
            .transpose()?;
        if let Some(matrices) = &inverse_binds
            && matrices.count() < json.joints.len()
        {
            let problem =
                format!("there are {} matrices for {} joints; export the file again", matrices.count(), json.joints.len());
            return Err(document.invalid(place, problem));
        }
        let world_from_bind = json.joints.iter().enumerate().map(|(j, joint)| {
            let world_from_joint = hierarchy.world_from_node(joint.value()).ok_or_else(|| {
                document.invalid(
                    format_args!("skins[{index}].joints[{j}]"),
                    format_args!("nodes[{joint}] lies on a loop of nodes, so that it has no place; export the file again"),
                )
            })?;
            let joint_from_bind = match &inverse_binds {
                None => DAffine3::IDENTITY,
                Some(matrices) => affine_from_columns(&matrices.vector(j).map(f64::from)).ok_or_else(|| {
                    document.invalid(&place, format_args!("the last row of matrix {j} must be 0 0 0 1; export the file again"))
                })?,
            };
            let world_from_bind = world_from_joint * joint_from_bind;
            if world_from_bind.is_finite() {
                Ok(world_from_bind)
            } else {
                Err(document.invalid(&place, format_args!("matrix {j} is not finite; export the file again")))
            }
        });
        Ok(Self { index, world_from_bind: world_from_bind.collect::<Result<_>>()? })
    }

    /// The matrix from the bind pose to the world for each of the vertices `sources` of a primitive; `None` if the
    /// primitive has no joints, so that it is not skinned after all.
    pub(super) fn world_from_vertices(
        &self,
        document: &Document,
        source: &Source<'_>,
        sources: &[u32],
    ) -> Result<Option<Vec<DAffine3>>> {
        let place = &source.place;
        let mut sets = Vec::new();
        for set in 0.. {
            let joints = source.attribute(Semantic::Joints(set), Format::JOINTS, None)?;
            let weights = source.attribute(Semantic::Weights(set), Format::WEIGHTS, None)?;
            let (joints, weights) = match (joints, weights) {
                (None, None) => break,
                (Some(joints), Some(weights)) => (joints, weights),
                _ => {
                    return Err(document.invalid(
                        format_args!("{place}.attributes"),
                        format_args!("has only one of JOINTS_{set} and WEIGHTS_{set}; export the file again"),
                    ));
                }
            };
            let joints_place = format!("{place}.attributes.JOINTS_{set}");
            let weights_place = format!("{place}.attributes.WEIGHTS_{set}");
            let last = sources.iter().max().map_or(0, |&last| last as usize);
            for (accessor, place) in [(&joints, &joints_place), (&weights, &weights_place)] {
                if accessor.count() <= last {
                    let problem =
                        format!("there is no element for vertex {last}, only {}; export the file again", accessor.count());
                    return Err(document.invalid(place, problem));
                }
            }
            sets.push((joints, weights, joints_place));
        }
        if sets.is_empty() {
            return Ok(None);
        }
        source.claim(sources.len() as u64 * size_of::<DAffine3>() as u64)?;
        sources.iter().map(|&vertex| self.blend(document, &sets, vertex as usize)).collect::<Result<_>>().map(Some)
    }

    /// The mean of a vertex's joints, by weight. A vertex without weights belongs to its first joint.
    fn blend(&self, document: &Document, sets: &[(Accessor<'_>, Accessor<'_>, String)], vertex: usize) -> Result<DAffine3> {
        /// A sum of weights below this is rounding: a file's weights are 8-bit fractions at the coarsest.
        const MIN_SUM: f64 = 1e-4;
        let mut sum = 0.0;
        let mut matrix = DMat3::ZERO;
        let mut translation = DVec3::ZERO;
        for (joints, weights, place) in sets {
            for (c, weight) in weights.vector::<4>(vertex).into_iter().enumerate() {
                if weight == 0.0 || !weight.is_finite() {
                    continue;
                }
                let joint = self.joint(document, joints.integer(vertex, c), vertex, place)?;
                let weight = f64::from(weight);
                sum += weight;
                matrix += joint.matrix3 * weight;
                translation += joint.translation * weight;
            }
        }
        if sum >= MIN_SUM {
            return Ok(DAffine3 { matrix3: matrix * sum.recip(), translation: translation / sum });
        }
        // `world_from_vertices` calls this with at least one set.
        let (joints, _, place) = &sets[0];
        self.joint(document, joints.integer(vertex, 0), vertex, place)
    }

    fn joint(&self, document: &Document, joint: u32, vertex: usize, place: &str) -> Result<DAffine3> {
        self.world_from_bind.get(joint as usize).copied().ok_or_else(|| {
            document.invalid(
                place,
                format_args!(
                    "vertex {vertex} names joint {joint}, but skins[{}] has only {}; export the file again",
                    self.index,
                    self.world_from_bind.len()
                ),
            )
        })
    }
}
