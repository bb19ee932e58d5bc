//! Meshes: primitives read, deformed into their pose, and placed in the world.

use glam::{DAffine3, DMat3, DVec3, Vec2, Vec3, Vec4};
use gltf::json::{
    mesh::{Mode, Primitive, Semantic},
    validation::Checked,
};

use super::{
    accessor::{Accessor, Format},
    animation::Pose,
    attributes::{Source, open_parallel},
    budget::Use,
    buffers::Buffers,
    document::Document,
    error::Result,
    instancing,
    materials::UvSource,
    nodes::Hierarchy,
    notes::Notes,
    skin::Skin,
};

/// Bytes that a vertex takes: as a [`Part`], and as a vertex of the scene.
const VERTEX_BYTES: u64 = (size_of::<DVec3>() + size_of::<Vec3>() + 24 + 2 * size_of::<Vec3>() + 24) as u64;

/// Bytes that a triangle takes: as a [`Part`], in the scene with its material, and while the scene sorts them.
const TRIANGLE_BYTES: u64 = 12 + 16 + 16;

/// Bytes that an index takes while triangles are made of it.
const INDEX_BYTES: u64 = 4;

/// Bytes that a corner of a triangle takes before it is known which vertices the triangles use.
const CORNER_BYTES: u64 = 3 * 4;

/// A primitive in the world, in double precision, since the scene's origin is chosen when all of them are known.
#[derive(Debug)]
pub(super) struct Part {
    /// The node's or mesh's name.
    pub(super) name: String,
    /// The JSON path, for messages.
    pub(super) place: String,
    /// The index of the material in the file; `None` for glTF's default one.
    pub(super) material: Option<usize>,
    /// World positions in metres.
    pub(super) positions: Vec<DVec3>,
    /// World normals, of unit length or zero.
    pub(super) normals: Vec<Vec3>,
    /// Texture coordinates of the base colour texture, its transform applied.
    pub(super) uvs: Vec<Vec2>,
    /// Vertex colours.
    pub(super) colors: Vec<Vec4>,
    /// Counter-clockwise from the front.
    pub(super) triangles: Vec<[u32; 3]>,
}

/// Reads what the drawn nodes show.
pub(super) fn collect(
    document: &Document,
    buffers: &Buffers<'_>,
    hierarchy: &Hierarchy,
    pose: &Pose,
    notes: &mut Notes,
) -> Result<Vec<Part>> {
    let mut reader = Reader { document, buffers, notes };
    let mut parts = Vec::new();
    for node in hierarchy.visible() {
        // `Document` guarantees the indices; drawn nodes are placed.
        let json = &document.root.nodes[node];
        let (Some(mesh), Some(world_from_node)) = (json.mesh, hierarchy.world_from_node(node)) else { continue };
        let mesh_json = &document.root.meshes[mesh.value()];
        let skin = json.skin.map(|skin| Skin::read(document, buffers, hierarchy, skin.value())).transpose()?;
        let world_from_instances = instancing::world_from_instances(document, buffers, node, world_from_node)?;
        let weights = match pose.node(node).and_then(|pose| pose.weights.as_ref()) {
            Some(weights) => weights.clone(),
            None => json.weights.iter().chain(&mesh_json.weights).next().into_iter().flatten().copied().map(f64::from).collect(),
        };
        let name = json.name.as_ref().or(mesh_json.name.as_ref()).cloned().unwrap_or_default();
        for (i, primitive) in mesh_json.primitives.iter().enumerate() {
            let place = format!("meshes[{mesh}].primitives[{i}]");
            let source = Source::open(document, buffers, mesh.value(), i)?;
            let Some(local) = reader.read(&source, &weights, world_from_instances.len())? else { continue };
            let material = primitive.material.map(|material| material.value());
            let blended = match &skin {
                Some(skin) => skin.world_from_vertices(document, &source, &local.sources)?,
                None => None,
            };
            if let Some(world_from_vertices) = blended {
                parts.push(local.placed(&Placement::Skinned(world_from_vertices), name.clone(), place, material));
                continue;
            }
            for &world_from_instance in &world_from_instances {
                parts.push(local.placed(&Placement::Rigid(world_from_instance), name.clone(), place.clone(), material));
            }
        }
    }
    Ok(parts)
}

/// How a primitive comes into the world.
enum Placement {
    /// All of it by one matrix.
    Rigid(DAffine3),
    /// Each vertex by its own.
    Skinned(Vec<DAffine3>),
}

/// A primitive in its mesh's space, reduced to the vertices that its triangles use.
struct Local {
    /// The index in the file of each vertex.
    sources: Vec<u32>,
    positions: Vec<DVec3>,
    /// `None` asks for flat normals; every triangle then has vertices of its own.
    normals: Option<Vec<DVec3>>,
    uvs: Vec<Vec2>,
    colors: Vec<Vec4>,
    triangles: Vec<[u32; 3]>,
}

struct Reader<'a, 'b> {
    document: &'a Document,
    buffers: &'a Buffers<'b>,
    notes: &'a mut Notes,
}

impl<'a> Reader<'a, '_> {
    /// Reads a primitive; `None` if it has nothing to draw.
    fn read(&mut self, source: &Source<'_>, weights: &[f64], instances: usize) -> Result<Option<Local>> {
        let (primitive, place) = (source.primitive, source.place.as_str());
        // `Document` guarantees that it is valid.
        let Checked::Valid(mode) = primitive.mode else { return Ok(None) };
        if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            self.notes.points_or_lines += 1;
            return Ok(None);
        }
        let Some(positions) = source.attribute(Semantic::Positions, Format::VECTOR, None)? else {
            self.notes.without_positions += 1;
            return Ok(None);
        };
        let count = positions.count();
        let triangles = self.corners(source, mode, count)?;
        if triangles.is_empty() {
            return Ok(None);
        }

        let normals = source.attribute(Semantic::Normals, Format::VECTOR, Some(count))?;
        let corner_bytes = CORNER_BYTES * 3 * triangles.len() as u64;
        self.buffers.budget().claim(Use::Meshes, corner_bytes, place)?;
        let (sources, triangles) = if normals.is_some() { compact(&triangles) } else { flatten(&triangles) };
        self.buffers.budget().release(corner_bytes);
        self.claim(sources.len(), triangles.len(), instances, place)?;

        let mut local = Local {
            positions: self.positions(&positions, &sources, place)?,
            normals: normals.map(|normals| self.vectors(&normals, &sources).collect()),
            uvs: self.uvs(source, &sources, count)?,
            colors: self.colors(source, &sources, count)?,
            sources,
            triangles,
        };
        self.morph(&mut local, primitive, weights, count, place)?;
        Ok(Some(local))
    }

    /// Claims the memory of a primitive, once for itself and once for each of its instances.
    fn claim(&self, vertices: usize, triangles: usize, instances: usize, place: &str) -> Result<()> {
        let each = (vertices as u64 * VERTEX_BYTES).saturating_add(triangles as u64 * TRIANGLE_BYTES);
        self.buffers.budget().claim(Use::Meshes, each.saturating_mul(instances as u64 + 1), place)
    }

    /// The triangles, as vertices of the file.
    fn corners(&mut self, source: &Source<'_>, mode: Mode, count: usize) -> Result<Vec<[u32; 3]>> {
        let place = format!("{}.indices", source.place);
        // Of a strip or fan each index but two makes a triangle.
        let claim = |indices: usize| {
            let corners = if mode == Mode::Triangles { 1 } else { 3 };
            let bytes = indices as u64 * (INDEX_BYTES + corners * INDEX_BYTES);
            self.buffers.budget().claim(Use::Meshes, bytes, &place)
        };
        if let Some(triangles) = source.triangles() {
            if let Some(&vertex) = triangles.iter().flatten().find(|&&vertex| vertex as usize >= count) {
                let problem =
                    format!("the compressed triangles name vertex {vertex}, but there are only {count}; export the file again");
                return Err(self.document.invalid(place, problem));
            }
            return Ok(triangles);
        }
        let indices: Vec<u32> = match source.primitive.indices {
            None => {
                claim(count)?;
                // More vertices than 32 bits can count would not fit a buffer that was read.
                (0..count as u32).collect()
            }
            Some(accessor) => {
                let indices = Accessor::open_counted(self.document, self.buffers, accessor.value(), Format::INDICES, &place)?;
                claim(indices.count())?;
                let restart = indices.largest_integer();
                let fail = |i: usize, index: u32| {
                    let why = if index == restart {
                        "the value that restarts a primitive, which glTF forbids".to_owned()
                    } else {
                        format!("but there are only {count} vertices")
                    };
                    self.document.invalid(
                        &place,
                        format_args!("accessors[{accessor}] has {index} as its element {i}, {why}; export the file again"),
                    )
                };
                (0..indices.count())
                    .map(|i| match indices.integer(i, 0) {
                        index if index != restart && (index as usize) < count => Ok(index),
                        index => Err(fail(i, index)),
                    })
                    .collect::<Result<_>>()?
            }
        };
        let complete = if mode == Mode::Triangles { indices.len().is_multiple_of(3) } else { indices.len() >= 3 };
        if !complete {
            self.notes.incomplete_triangles += 1;
        }
        // The orders are those of section 3.7.2.1 of the specification.
        Ok(match mode {
            Mode::TriangleStrip => indices
                .windows(3)
                .enumerate()
                .map(|(i, v)| if i % 2 == 0 { [v[0], v[1], v[2]] } else { [v[0], v[2], v[1]] })
                .collect(),
            Mode::TriangleFan => indices.get(1..).unwrap_or_default().windows(2).map(|v| [v[0], v[1], indices[0]]).collect(),
            _ => indices.as_chunks::<3>().0.to_vec(),
        })
    }

    fn positions(&self, accessor: &Accessor<'_>, sources: &[u32], place: &str) -> Result<Vec<DVec3>> {
        let read = |&source: &u32| {
            let position = Vec3::from_array(accessor.vector(source as usize));
            if position.is_finite() {
                Ok(position.as_dvec3())
            } else {
                Err(self.document.invalid(
                    format_args!("{place}.attributes.POSITION"),
                    format_args!("vertex {source} is at {position}, which is not a finite point; export the file again"),
                ))
            }
        };
        sources.iter().map(read).collect()
    }

    /// Vectors of which those that are not finite become zero.
    fn vectors(&mut self, accessor: &Accessor<'_>, sources: &[u32]) -> impl Iterator<Item = DVec3> {
        sources.iter().map(|&source| {
            let vector = Vec3::from_array(accessor.vector(source as usize));
            if vector.is_finite() {
                vector.as_dvec3()
            } else {
                self.notes.not_finite += 1;
                DVec3::ZERO
            }
        })
    }

    /// Texture coordinates as the base colour texture wants them.
    fn uvs(&mut self, source: &Source<'_>, sources: &[u32], count: usize) -> Result<Vec<Vec2>> {
        let uv_source = match source.primitive.material {
            None => None,
            Some(material) => UvSource::of(self.document, material.value())?,
        };
        let Some(uv_source) = uv_source else { return Ok(vec![Vec2::ZERO; sources.len()]) };
        let semantic = Semantic::TexCoords(uv_source.set);
        let Some(accessor) = source.attribute(semantic, Format::UV, Some(count))? else {
            self.notes.without_uvs += 1;
            return Ok(vec![Vec2::ZERO; sources.len()]);
        };
        let mut not_finite = 0;
        let uvs = sources
            .iter()
            .map(|&i| {
                let uv = uv_source.transform.transform_point2(Vec2::from_array(accessor.vector(i as usize)));
                if uv.is_finite() {
                    uv
                } else {
                    not_finite += 1;
                    Vec2::ZERO
                }
            })
            .collect();
        self.notes.not_finite += not_finite;
        Ok(uvs)
    }

    /// Vertex colours; white where there are none.
    fn colors(&mut self, source: &Source<'_>, sources: &[u32], count: usize) -> Result<Vec<Vec4>> {
        let Some(accessor) = source.attribute(Semantic::Colors(0), Format::COLOR, Some(count))? else {
            return Ok(vec![Vec4::ONE; sources.len()]);
        };
        let mut not_finite = 0;
        let colors = sources
            .iter()
            .map(|&i| {
                let color = if accessor.width() == 3 {
                    Vec3::from_array(accessor.vector(i as usize)).extend(1.0)
                } else {
                    Vec4::from_array(accessor.vector(i as usize))
                };
                if color.is_finite() {
                    // A surface reflects no negative light.
                    color.max(Vec4::ZERO)
                } else {
                    not_finite += 1;
                    Vec4::ZERO
                }
            })
            .collect();
        self.notes.not_finite += not_finite;
        Ok(colors)
    }

    /// Adds the morph targets, each with its weight.
    fn morph(&mut self, local: &mut Local, primitive: &Primitive, weights: &[f64], count: usize, place: &str) -> Result<()> {
        let targets = primitive.targets.iter().flatten();
        for (t, (target, &weight)) in targets.zip(weights).enumerate() {
            // Most targets have no weight in most poses, and then need not be read.
            if weight == 0.0 {
                continue;
            }
            if let Some(positions) = target.positions {
                let place = format!("{place}.targets[{t}].POSITION");
                let deltas = open_parallel(self.document, self.buffers, positions.value(), Format::VECTOR, count, place)?;
                for (position, delta) in local.positions.iter_mut().zip(self.vectors(&deltas, &local.sources)) {
                    *position += weight * delta;
                }
            }
            if let (Some(normals), Some(local_normals)) = (target.normals, &mut local.normals) {
                let place = format!("{place}.targets[{t}].NORMAL");
                let deltas = open_parallel(self.document, self.buffers, normals.value(), Format::VECTOR, count, place)?;
                for (normal, delta) in local_normals.iter_mut().zip(self.vectors(&deltas, &local.sources)) {
                    *normal += weight * delta;
                }
            }
        }
        Ok(())
    }
}

/// The vertices that triangles use, each once, in the order of the file, and the triangles in terms of them.
fn compact(triangles: &[[u32; 3]]) -> (Vec<u32>, Vec<[u32; 3]>) {
    let end = triangles.iter().flatten().max().map_or(0, |&last| last as usize + 1);
    let mut renamed = vec![0; end];
    for &vertex in triangles.iter().flatten() {
        renamed[vertex as usize] = 1;
    }
    let mut sources = Vec::new();
    for (vertex, name) in renamed.iter_mut().enumerate() {
        if *name == 1 {
            *name = sources.len() as u32;
            sources.push(vertex as u32);
        }
    }
    (sources, triangles.iter().map(|triangle| triangle.map(|vertex| renamed[vertex as usize])).collect())
}

/// Three vertices of its own for every triangle.
fn flatten(triangles: &[[u32; 3]]) -> (Vec<u32>, Vec<[u32; 3]>) {
    // The caller's limit keeps the number of corners far below 32 bits.
    let renamed = (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    (triangles.as_flattened().to_vec(), renamed)
}

impl Local {
    /// The primitive in the world.
    fn placed(&self, placement: &Placement, name: String, place: String, material: Option<usize>) -> Part {
        let positions: Vec<DVec3> = match placement {
            Placement::Rigid(world) => self.positions.iter().map(|&p| world.transform_point3(p)).collect(),
            Placement::Skinned(worlds) => {
                self.positions.iter().zip(worlds).map(|(&p, world)| world.transform_point3(p)).collect()
            }
        };
        let mirrored = match placement {
            Placement::Rigid(world) => orientation(world.matrix3) < 0.0,
            // Joints may disagree; the majority decides.
            Placement::Skinned(worlds) => worlds.iter().map(|world| orientation(world.matrix3)).sum::<f64>() < 0.0,
        };
        let mut triangles = self.triangles.clone();
        if mirrored {
            for triangle in &mut triangles {
                triangle.swap(1, 2);
            }
        }
        let normals = match (&self.normals, placement) {
            (None, _) => flat_normals(&positions, &triangles),
            (Some(normals), Placement::Rigid(world)) => {
                let matrix = normal_matrix(world.matrix3);
                normals.iter().map(|&normal| unit_or_zero(matrix * normal)).collect()
            }
            (Some(normals), Placement::Skinned(worlds)) => {
                normals.iter().zip(worlds).map(|(&n, world)| unit_or_zero(normal_matrix(world.matrix3) * n)).collect()
            }
        };
        Part { name, place, material, positions, normals, uvs: self.uvs.clone(), colors: self.colors.clone(), triangles }
    }
}

/// A matrix divided by its largest element, so that products of its elements neither overflow nor vanish; the scale of
/// a normal matrix does not matter. The zero matrix stays.
fn scaled(matrix: DMat3) -> DMat3 {
    let largest = matrix.to_cols_array().iter().fold(0.0, |largest: f64, element| largest.max(element.abs()));
    if largest > 0.0 { matrix * largest.recip() } else { matrix }
}

/// 1 for a matrix that keeps the winding, -1 for one that mirrors, 0 for a singular one.
fn orientation(matrix: DMat3) -> f64 {
    let determinant = scaled(matrix).determinant();
    if determinant == 0.0 { 0.0 } else { determinant.signum() }
}

/// The matrix that takes normals along, up to a positive factor.
///
/// That is the inverse transpose: the cofactors divided by the determinant, of which only the sign matters. The cofactors
/// exist for a singular matrix too: flattened onto a plane, normals become the plane's.
fn normal_matrix(matrix: DMat3) -> DMat3 {
    let m = scaled(matrix);
    let cofactors = DMat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis));
    if orientation(matrix) < 0.0 { -cofactors } else { cofactors }
}

/// The vector at unit length in f32, or zero if it has no direction.
fn unit_or_zero(vector: DVec3) -> Vec3 {
    // Divided by its largest component first, so that a short vector's squares do not vanish.
    let largest = vector.abs().max_element();
    (vector / largest).try_normalize().map_or(Vec3::ZERO, DVec3::as_vec3)
}

/// The normal of its triangle for each vertex; every triangle must have vertices of its own, in order.
fn flat_normals(positions: &[DVec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut normals = vec![Vec3::ZERO; positions.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|vertex| positions[vertex as usize]);
        let normal = unit_or_zero((b - a).cross(c - a));
        for &vertex in triangle {
            normals[vertex as usize] = normal;
        }
    }
    normals
}
