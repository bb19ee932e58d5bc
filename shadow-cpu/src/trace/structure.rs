//! The tree of boxes around the scene's triangles: eight children a node, up to eight triangles a leaf.
//!
//! The crate `obvhs` builds a binary tree by locally ordered clustering (Meister and Bittner 2018) with reinsertion (Meister and Bittner
//! 2018b), and splits the boxes of large triangles first. Here it is folded into nodes of eight, whose boxes a ray meets in one go, and
//! leaves whose triangles lie side by side in vectors.

use glam::{DVec3, Vec3A};
use obvhs::{
    BvhBuildParams,
    bvh2::{Bvh2, builder::build_bvh2_from_tris},
    triangle::Triangle,
};
use shadow_scene::{Pass, Scene};

use crate::kernel::LANES;

/// In [`Node::children`]: the child is a leaf, and the other bits are its index.
pub(super) const LEAF: u32 = 1 << 31;

/// [`Leaf::triangle`] of a lane that holds none.
pub(super) const NO_LANE: u32 = u32::MAX;

/// Eight boxes and what they hold. A box that does not exist is inside out, and no ray meets it.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// Each box's planes: lower x, upper x, lower y, upper y, lower z, upper z.
    pub(super) planes: [[f32; LANES]; 6],
    /// The index of a node, or of a leaf with the bit [`LEAF`].
    pub(super) children: [u32; LANES],
}

/// Up to eight triangles, corner by corner and coordinate by coordinate.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Leaf {
    /// `corners[corner][axis]`, in metres relative to the scene's origin. Lanes without a triangle repeat one that is there.
    pub(super) corners: [[[f32; LANES]; 3]; 3],
    /// The triangle of each lane in the scene, or [`NO_LANE`].
    pub(super) triangle: [u32; LANES],
}

/// The tree.
#[derive(Debug)]
pub(super) struct Structure {
    /// The nodes; the first is the root, and there is always one.
    pub(super) nodes: Vec<Node>,
    /// The leaves.
    pub(super) leaves: Vec<Leaf>,
    /// How many children can wait while a ray goes down: all but one of each node on the longest way.
    pub(super) stack_size: usize,
    /// The largest coordinate of any corner, in metres: what errors of rounding are measured by.
    pub(super) extent: f32,
    /// How many of the scene's triangles are held: those with an area.
    pub(super) triangle_count: usize,
}

impl Structure {
    pub(super) fn new(scene: &Scene) -> Self {
        let positions = &scene.vertices().positions;
        let mut held = Vec::new();
        let mut triangles = Vec::new();
        // What has no area is in no pass: neither renderer draws it, and it hides nothing.
        for index in Pass::ALL.into_iter().flat_map(|pass| scene.pass_triangles(pass)) {
            let [v0, v1, v2] = scene.triangles()[index as usize].map(|corner| positions[corner as usize].into());
            held.push(index);
            triangles.push(Triangle { v0, v1, v2 });
        }
        let extent = triangles.iter().flat_map(|triangle| [triangle.v0, triangle.v1, triangle.v2]);
        let extent = extent.fold(Vec3A::ZERO, |most, corner| most.max(corner.abs())).max_element();
        if triangles.is_empty() {
            return Self { nodes: vec![Node::EMPTY], leaves: Vec::new(), stack_size: LANES, extent, triangle_count: 0 };
        }
        let tree = build_bvh2_from_tris(&triangles, build_parameters(triangles.len()), &mut std::time::Duration::default());
        let mut fold = Fold { tree: &tree, triangles: &triangles, held: &held, nodes: Vec::new(), leaves: Vec::new() };
        let depth = fold.root();
        let Fold { nodes, leaves, .. } = fold;
        Self { nodes, leaves, stack_size: (LANES - 1) * depth + 1, extent, triangle_count: held.len() }
    }
}

/// How much work the builder spends: with a single core a million triangles take about two seconds.
fn build_parameters(triangle_count: usize) -> BvhBuildParams {
    /// Above this many triangles, splitting and a thorough search would take longer than most pictures.
    const MANY: usize = 4_000_000;
    let preset = if triangle_count > MANY { BvhBuildParams::fast_build() } else { BvhBuildParams::medium_build() };
    // Leaves are made here, of eight: the builder should not make any of its own.
    BvhBuildParams { max_prims_per_leaf: 1, ..preset }
}

impl Node {
    const EMPTY: Self = {
        let (lower, upper) = ([f32::INFINITY; LANES], [f32::NEG_INFINITY; LANES]);
        Self { planes: [lower, upper, lower, upper, lower, upper], children: [LEAF; LANES] }
    };
}

/// Folds a binary tree into nodes of eight.
struct Fold<'a> {
    tree: &'a Bvh2,
    triangles: &'a [Triangle],
    held: &'a [u32],
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
}

impl Fold<'_> {
    /// Folds the whole tree; how many nodes the longest way down has.
    fn root(&mut self) -> usize {
        self.nodes.push(Node::EMPTY);
        // Children wait here rather than in recursive calls: a tree over degenerate input can be as deep as it likes.
        let mut pending = vec![(0_usize, 0_usize, 1_usize)];
        let sizes = self.sizes();
        let mut deepest = 1;
        while let Some((binary, node, depth)) = pending.pop() {
            deepest = deepest.max(depth);
            let children = self.children(binary, &sizes);
            let mut folded = Node::EMPTY;
            for (lane, &child) in children.iter().enumerate() {
                let bounds = self.tree.nodes[child].aabb();
                for axis in 0..3 {
                    folded.planes[2 * axis][lane] = bounds.min[axis];
                    folded.planes[2 * axis + 1][lane] = bounds.max[axis];
                }
                folded.children[lane] = if sizes[child] as usize <= LANES {
                    self.leaves.push(self.leaf(child));
                    LEAF | (self.leaves.len() - 1) as u32
                } else {
                    self.nodes.push(Node::EMPTY);
                    pending.push((child, self.nodes.len() - 1, depth + 1));
                    (self.nodes.len() - 1) as u32
                };
            }
            self.nodes[node] = folded;
        }
        deepest
    }

    /// How many triangles lie below each node of the binary tree.
    fn sizes(&self) -> Vec<u32> {
        let nodes = &self.tree.nodes;
        let mut sizes = vec![0; nodes.len()];
        let mut order = vec![0];
        let mut next = 0;
        while let Some(&node) = order.get(next) {
            next += 1;
            if !nodes[node].is_leaf() {
                let first = nodes[node].first_index as usize;
                order.extend([first, first + 1]);
            }
        }
        for &node in order.iter().rev() {
            let first = nodes[node].first_index as usize;
            sizes[node] = if nodes[node].is_leaf() { nodes[node].prim_count } else { sizes[first] + sizes[first + 1] };
        }
        sizes
    }

    /// Up to eight nodes of the binary tree that together hold what `binary` holds: the largest are opened first.
    fn children(&self, binary: usize, sizes: &[u32]) -> Vec<usize> {
        let nodes = &self.tree.nodes;
        let mut children = vec![binary];
        while children.len() < LANES {
            let openable = children.iter().enumerate().filter(|&(_, &child)| sizes[child] as usize > LANES);
            let area = |child: usize| nodes[child].aabb().half_area();
            let Some((slot, &child)) = openable.max_by(|(_, a), (_, b)| area(**a).total_cmp(&area(**b))) else { break };
            let first = nodes[child].first_index as usize;
            children[slot] = first;
            children.push(first + 1);
        }
        children
    }

    /// The triangles below a node, at most eight.
    fn leaf(&self, binary: usize) -> Leaf {
        let mut leaf = Leaf { corners: [[[0.0; LANES]; 3]; 3], triangle: [NO_LANE; LANES] };
        let mut pending = vec![binary];
        let mut count = 0;
        while let Some(node) = pending.pop() {
            let node = &self.tree.nodes[node];
            let first = node.first_index as usize;
            if !node.is_leaf() {
                pending.extend([first + 1, first]);
                continue;
            }
            for &primitive in &self.tree.primitive_indices[first..first + node.prim_count as usize] {
                let primitive = primitive as usize;
                // Boxes of a split triangle that end in the same leaf need it once.
                if !leaf.triangle[..count].contains(&self.held[primitive]) {
                    leaf.set(count, self.held[primitive], &self.triangles[primitive]);
                    count += 1;
                }
            }
        }
        for lane in count..LANES {
            for corner in &mut leaf.corners {
                for axis in corner {
                    axis[lane] = axis[0];
                }
            }
        }
        leaf
    }
}

impl Leaf {
    /// A corner of a lane's triangle, in metres relative to the scene's origin.
    #[inline(always)]
    pub(super) fn corner(&self, corner: usize, lane: usize) -> DVec3 {
        let [x, y, z] = &self.corners[corner];
        DVec3::new(f64::from(x[lane]), f64::from(y[lane]), f64::from(z[lane]))
    }

    fn set(&mut self, lane: usize, index: u32, triangle: &Triangle) {
        self.triangle[lane] = index;
        for (corner, position) in [triangle.v0, triangle.v1, triangle.v2].into_iter().enumerate() {
            for axis in 0..3 {
                self.corners[corner][axis][lane] = position[axis];
            }
        }
    }
}
