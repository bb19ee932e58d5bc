//! The node hierarchy: which nodes are drawn, and where each stands in the world.

use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3};

use serde_json::Value;

use super::{
    animation::{NodePose, Pose},
    document::Document,
    error::Result,
};

/// Where the nodes stand.
#[derive(Debug)]
pub(super) struct Hierarchy {
    /// The nodes of the scene that is drawn, parents before their children, in the order of the file.
    pub(super) drawn: Vec<usize>,
    /// Whether each node is hidden, by itself or a parent (KHR_node_visibility).
    hidden: Vec<bool>,
    /// The matrix from each node's space to the world; `None` for nodes that no root leads to.
    world_from_node: Vec<Option<DAffine3>>,
}

impl Hierarchy {
    /// The matrix from a node's space to the world; `None` if no root leads to the node.
    pub(super) fn world_from_node(&self, node: usize) -> Option<DAffine3> {
        self.world_from_node.get(node).copied().flatten()
    }

    /// The drawn nodes that are not hidden: cameras are not hidden with their node, all else is.
    pub(super) fn visible(&self) -> impl Iterator<Item = usize> {
        self.drawn.iter().copied().filter(|&node| !self.hidden[node])
    }

    /// Places the nodes of a scene, or all nodes if it is `None`, in a pose; and after them those outside of it, since they may be
    /// joints.
    pub(super) fn place(document: &Document, scene: Option<usize>, pose: &Pose) -> Result<Self> {
        let root = &document.root;
        let mut is_child = vec![false; root.nodes.len()];
        for child in root.nodes.iter().flat_map(|node| node.children.iter().flatten()) {
            // `Document` guarantees this and every other index of a node.
            is_child[child.value()] = true;
        }
        let orphans = (0..root.nodes.len()).filter(|&node| !is_child[node]);
        let mut hierarchy =
            Self { drawn: Vec::new(), hidden: vec![false; root.nodes.len()], world_from_node: vec![None; root.nodes.len()] };
        if let Some(scene) = scene {
            // `Document::scene` gives only scenes that exist.
            for (i, node) in root.scenes[scene].nodes.iter().enumerate() {
                hierarchy.descend(document, pose, node.value(), &format!("scenes[{scene}].nodes[{i}]"))?;
            }
        } else {
            for node in orphans.clone() {
                hierarchy.descend(document, pose, node, &format!("nodes[{node}]"))?;
            }
        }
        let drawn = hierarchy.drawn.len();
        for node in orphans {
            // What is wrong with nodes that are not drawn need not be reported: they are then not placed.
            if hierarchy.world_from_node[node].is_none() {
                let _ = hierarchy.descend(document, pose, node, "");
            }
        }
        hierarchy.drawn.truncate(drawn);
        Ok(hierarchy)
    }

    /// Places a node and all below it. The stack is explicit, because a file may nest as deeply as it likes.
    fn descend(&mut self, document: &Document, pose: &Pose, start: usize, place: &str) -> Result<()> {
        let mut pending = vec![(start, None, DAffine3::IDENTITY)];
        while let Some((node, parent, world_from_parent)) = pending.pop() {
            // Each node is entered once, so this ends whatever the file says.
            if self.world_from_node[node].is_some() {
                let place = parent.map_or_else(|| place.to_owned(), |parent| format!("nodes[{parent}].children"));
                let problem =
                    format!("nodes[{node}] is reached a second time; nodes must form trees, without loops or shared branches");
                return Err(document.invalid(place, problem));
            }
            let world_from_node = world_from_parent * parent_from_node(document, node, pose.node(node))?;
            if !world_from_node.is_finite() {
                return Err(
                    document.invalid(format_args!("nodes[{node}]"), "the product of its and its parents' matrices overflows")
                );
            }
            self.world_from_node[node] = Some(world_from_node);
            self.hidden[node] = parent.is_some_and(|parent: usize| self.hidden[parent]) || is_hidden(document, node)?;
            self.drawn.push(node);
            // The last one pushed is the first one taken.
            let children = document.root.nodes[node].children.iter().flatten().rev();
            pending.extend(children.map(|child| (child.value(), Some(node), world_from_node)));
        }
        Ok(())
    }
}

/// Whether a node hides itself and all below it.
fn is_hidden(document: &Document, node: usize) -> Result<bool> {
    const EXTENSION: &str = "KHR_node_visibility";
    let extension = document.node_value(node, "extensions").and_then(|extensions| extensions.get(EXTENSION));
    match extension.map(|extension| (extension.is_object(), extension.get("visible"))) {
        None | Some((true, None)) => Ok(false),
        Some((true, Some(Value::Bool(visible)))) => Ok(!visible),
        Some(_) => Err(document.invalid(
            format_args!("nodes[{node}].extensions.{EXTENSION}"),
            "must be an object with `visible` true or false; export the file again",
        )),
    }
}

/// The matrix of a node's own transform, at the precision the file has; what its pose sets stands in place of that.
fn parent_from_node(document: &Document, node: usize, pose: Option<&NodePose>) -> Result<DAffine3> {
    // An animation never moves a node that has a matrix: `Pose::read` has refused that.
    if let Some(matrix) = document.node_numbers::<16>(node, "matrix") {
        return affine_from_columns(&matrix).ok_or_else(|| {
            document.invalid(format_args!("nodes[{node}].matrix"), "the last row must be 0 0 0 1; export the file again")
        });
    }
    let numbers = |property| document.node_numbers(node, property).map(DVec3::from_array);
    let translation = pose.and_then(|pose| pose.translation).or_else(|| numbers("translation")).unwrap_or(DVec3::ZERO);
    let scale = pose.and_then(|pose| pose.scale).or_else(|| numbers("scale")).unwrap_or(DVec3::ONE);
    let rotation = match (pose.and_then(|pose| pose.rotation), document.node_numbers(node, "rotation")) {
        (Some(rotation), _) => rotation,
        (None, None) => DQuat::IDENTITY,
        (None, Some(rotation)) => unit_quaternion(rotation).ok_or_else(|| {
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
