//! The node hierarchy: which nodes are drawn, and where each stands in the world.

use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3};

use super::{document::Document, error::Result};

/// Where the nodes stand.
#[derive(Debug)]
pub(super) struct Hierarchy {
    /// The nodes of the scene that is drawn, parents before their children, in the order of the file.
    pub(super) drawn: Vec<usize>,
    /// The matrix from each node's space to the world; `None` for nodes that no root leads to.
    world_from_node: Vec<Option<DAffine3>>,
}

impl Hierarchy {
    /// The matrix from a node's space to the world; `None` if no root leads to the node.
    pub(super) fn world_from_node(&self, node: usize) -> Option<DAffine3> {
        self.world_from_node.get(node).copied().flatten()
    }

    /// Places the nodes of a scene, or all nodes if it is `None`; and after them those outside of it, since they may be
    /// joints.
    pub(super) fn place(document: &Document, scene: Option<usize>) -> Result<Self> {
        let root = &document.root;
        let mut is_child = vec![false; root.nodes.len()];
        for child in root.nodes.iter().flat_map(|node| node.children.iter().flatten()) {
            // `Document` guarantees this and every other index of a node.
            is_child[child.value()] = true;
        }
        let orphans = (0..root.nodes.len()).filter(|&node| !is_child[node]);
        let mut hierarchy = Self { drawn: Vec::new(), world_from_node: vec![None; root.nodes.len()] };
        if let Some(scene) = scene {
            // `Document::scene` gives only scenes that exist.
            for (i, node) in root.scenes[scene].nodes.iter().enumerate() {
                hierarchy.descend(document, node.value(), &format!("scenes[{scene}].nodes[{i}]"))?;
            }
        } else {
            for node in orphans.clone() {
                hierarchy.descend(document, node, &format!("nodes[{node}]"))?;
            }
        }
        let drawn = hierarchy.drawn.len();
        for node in orphans {
            // What is wrong with nodes that are not drawn need not be reported: they are then not placed.
            if hierarchy.world_from_node[node].is_none() {
                let _ = hierarchy.descend(document, node, "");
            }
        }
        hierarchy.drawn.truncate(drawn);
        Ok(hierarchy)
    }

    /// Places a node and all below it. The stack is explicit, because a file may nest as deeply as it likes.
    fn descend(&mut self, document: &Document, start: usize, place: &str) -> Result<()> {
        let mut pending = vec![(start, None, DAffine3::IDENTITY)];
        while let Some((node, parent, world_from_parent)) = pending.pop() {
            // Each node is entered once, so this ends whatever the file says.
            if self.world_from_node[node].is_some() {
                let place = parent.map_or_else(|| place.to_owned(), |parent| format!("nodes[{parent}].children"));
                let problem =
                    format!("nodes[{node}] is reached a second time; nodes must form trees, without loops or shared branches");
                return Err(document.invalid(place, problem));
            }
            let world_from_node = world_from_parent * parent_from_node(document, node)?;
            if !world_from_node.is_finite() {
                return Err(
                    document.invalid(format_args!("nodes[{node}]"), "the product of its and its parents' matrices overflows")
                );
            }
            self.world_from_node[node] = Some(world_from_node);
            self.drawn.push(node);
            // The last one pushed is the first one taken.
            let children = document.root.nodes[node].children.iter().flatten().rev();
            pending.extend(children.map(|child| (child.value(), Some(node), world_from_node)));
        }
        Ok(())
    }
}

/// The matrix of a node's own transform, at the precision the file has.
fn parent_from_node(document: &Document, node: usize) -> Result<DAffine3> {
    if let Some(matrix) = document.node_numbers::<16>(node, "matrix") {
        return affine_from_columns(&matrix).ok_or_else(|| {
            document.invalid(format_args!("nodes[{node}].matrix"), "the last row must be 0 0 0 1; export the file again")
        });
    }
    let translation = document.node_numbers(node, "translation").map_or(DVec3::ZERO, DVec3::from_array);
    let scale = document.node_numbers(node, "scale").map_or(DVec3::ONE, DVec3::from_array);
    let rotation = match document.node_numbers(node, "rotation") {
        None => DQuat::IDENTITY,
        Some(rotation) => unit_quaternion(rotation).ok_or_else(|| {
            document.invalid(
                format_args!("nodes[{node}].rotation"),
                format_args!("{rotation:?} is no rotation; a quaternion must have a length of 1 (leave it out for none)"),
            )
        })?,
    };
    Ok(DAffine3::from_scale_rotation_translation(scale, rotation, translation))
}

/// A quaternion of unit length in the direction of `[x, y, z, w]`; `None` if it has none.
pub(super) fn unit_quaternion(xyzw: [f64; 4]) -> Option<DQuat> {
    let vector = glam::DVec4::from_array(xyzw);
    // Its largest component first, so that no square overflows.
    let largest = vector.abs().max_element();
    (vector / largest).try_normalize().map(DQuat::from_vec4)
}

/// A matrix from its 16 numbers, column by column; `None` if it is not affine.
pub(super) fn affine_from_columns(columns: &[f64; 16]) -> Option<DAffine3> {
    /// How far the last row may be from 0 0 0 1: far above the rounding of exporters, far below any perspective.
    const TOLERANCE: f64 = 1e-5;
    let matrix = DMat4::from_cols_array(columns);
    let last_row = matrix.row(3);
    ((last_row - glam::DVec4::W).abs().max_element() <= TOLERANCE)
        .then(|| DAffine3 { matrix3: DMat3::from_mat4(matrix), translation: matrix.w_axis.truncate() })
}
