//! Animations: key frames, all of them checked, and the pose that one of them has at a time.
//!
//! The formulas are those of appendix C of the glTF 2.0 specification, in double precision.

use core::fmt::Display;
use std::collections::{HashMap, HashSet};

use glam::{DQuat, DVec3};
use gltf::json::{
    animation::{Animation, Interpolation, Property},
    validation::Checked,
};

use super::{
    accessor::{Accessor, Format},
    buffers::Buffers,
    document::Document,
    error::{ImportError, Result},
    nodes::unit_quaternion,
    notes::Notes,
    options::ImportOptions,
};
use crate::source::SourceFacts;

/// What an animation sets of a node; what is `None` stays as the node has it.
#[derive(Clone, Debug, Default)]
pub(super) struct NodePose {
    pub(super) translation: Option<DVec3>,
    pub(super) rotation: Option<DQuat>,
    pub(super) scale: Option<DVec3>,
    /// One weight for each morph target.
    pub(super) weights: Option<Vec<f64>>,
}

/// What an animation sets at a time. That of the rest pose sets nothing.
#[derive(Debug, Default)]
pub(super) struct Pose {
    nodes: HashMap<usize, NodePose>,
}

impl Pose {
    /// What is set of a node.
    pub(super) fn node(&self, node: usize) -> Option<&NodePose> {
        self.nodes.get(&node)
    }

    /// Checks all animations and reads the pose that the options choose.
    pub(super) fn read(
        document: &Document,
        buffers: &Buffers<'_>,
        options: &ImportOptions,
        facts: &mut SourceFacts,
        notes: &mut Notes,
    ) -> Result<Self> {
        let time = options.time;
        if !(time.is_finite() && time >= 0.0) {
            return Err(ImportError::Time { file: document.file().into(), time });
        }
        let animations = &document.root.animations;
        let chosen = match &options.animation {
            Some(choice) => Some(document.choose("animation", choice, animations.iter().map(|a| a.name.as_deref()))?),
            None if animations.is_empty() && time > 0.0 => {
                return Err(ImportError::NoAnimation { file: document.file().into(), time });
            }
            None => (!animations.is_empty()).then_some(0),
        };
        let mut checker = Checker { document, buffers, ends: HashMap::new(), finite: HashSet::new() };
        let mut pose = Self::default();
        for (index, animation) in animations.iter().enumerate() {
            let tracks = checker.tracks(index, animation)?;
            let seconds = tracks.iter().map(|track| track.end).fold(0.0, f64::max);
            // `facts::of` has made an entry for each animation.
            facts.animations[index].seconds = seconds;
            if chosen != Some(index) {
                continue;
            }
            facts.animation = chosen;
            facts.time = time.min(seconds);
            if time > seconds {
                let name = animation.name.as_deref().map_or_else(|| index.to_string(), |name| format!("`{name}`"));
                notes.pose = Some(format!("animation {name} ends at {seconds} s; its last pose is drawn, not one at {time} s"));
            }
            for track in &tracks {
                track.pose(document, time, pose.nodes.entry(track.node).or_default())?;
            }
        }
        Ok(pose)
    }
}

/// What checking has found out so far: a file may use the same keys any number of times.
struct Checker<'a, 'b> {
    document: &'a Document,
    buffers: &'a Buffers<'b>,
    /// The last time of the accessors of times that are known to be good.
    ends: HashMap<usize, f64>,
    /// The accessors of values that are known to be finite.
    finite: HashSet<usize>,
}

impl<'a> Checker<'a, '_> {
    /// The tracks of an animation, checked. Channels without a node have none: glTF has them ignored.
    fn tracks(&mut self, index: usize, animation: &Animation) -> Result<Vec<Track<'a>>> {
        for (s, sampler) in animation.samplers.iter().enumerate() {
            self.end(sampler.input.value(), &format!("animations[{index}].samplers[{s}].input"))?;
        }
        let mut targets = HashSet::new();
        let mut tracks = Vec::new();
        for (c, channel) in animation.channels.iter().enumerate() {
            let place = format!("animations[{index}].channels[{}]", self.document.channel_number(index, c));
            let Some(sampler) = animation.samplers.get(channel.sampler.value()) else {
                let problem = format!(
                    "names sampler {}, but the animation has {}; export the file again",
                    channel.sampler,
                    animation.samplers.len()
                );
                return Err(self.document.invalid(format_args!("{place}.sampler"), problem));
            };
            // `Document` guarantees that both are valid.
            let (Checked::Valid(property), Checked::Valid(interpolation)) = (channel.target.path, sampler.interpolation) else {
                return Err(self.document.invalid(place, "has no valid path or interpolation; export the file again"));
            };
            let node = channel.target.node.value();
            if !targets.insert((node, property as u8)) {
                let problem = format!("a channel before it moves the same property of nodes[{node}]; export the file again");
                return Err(self.document.invalid(place, problem));
            }
            let sampler_place = format!("animations[{index}].samplers[{}]", channel.sampler);
            let keys = Keys { input: sampler.input.value(), output: sampler.output.value(), interpolation };
            tracks.push(self.track(node, property, &keys, &sampler_place, &place)?);
        }
        Ok(tracks)
    }

    /// The last of the times in an accessor, which must not be negative and must increase. `place` is what names it.
    fn end(&mut self, accessor: usize, place: &str) -> Result<f64> {
        if let Some(&end) = self.ends.get(&accessor) {
            return Ok(end);
        }
        let times = Accessor::open(self.document, self.buffers, accessor, Format::TIMES, place)?;
        let mut previous = None;
        // Times that the file leaves out are all 0, so that only the last key is ever met.
        let count = if times.is_left_out() { 0 } else { times.count() };
        for i in 0..count {
            let time = times.number(i, 0);
            let problem = match previous {
                _ if !(time.is_finite() && time >= 0.0) => "which is not a finite time of 0 s or more",
                Some(previous) if time <= previous => "which is not after the key before it",
                _ => {
                    previous = Some(time);
                    continue;
                }
            };
            let problem = format!("accessors[{accessor}] has {time} s as the time of key {i}, {problem}; export the file again");
            return Err(self.document.invalid(place, problem));
        }
        let end = previous.unwrap_or_default();
        self.ends.insert(accessor, end);
        Ok(end)
    }

    /// The track of one channel. `place` is that of its sampler, `channel` its own.
    fn track(&mut self, node: usize, property: Property, keys: &Keys, place: &str, channel: &str) -> Result<Track<'a>> {
        let (format, width) = match property {
            Property::Translation | Property::Scale => (Format::KEY_VECTOR, 3),
            Property::Rotation => (Format::KEY_ROTATION, 4),
            Property::MorphTargetWeights => (Format::KEY_WEIGHTS, self.morph_targets(node)),
        };
        if width == 0 {
            let problem = format!("moves the weights of nodes[{node}], which has no morph targets; export the file again");
            return Err(self.document.invalid(channel, problem));
        }
        if property != Property::MorphTargetWeights && self.document.node_value(node, "matrix").is_some() {
            let problem =
                format!("moves nodes[{node}], which has a matrix; give the node translation, rotation and scale in its place");
            return Err(self.document.invalid(channel, problem));
        }
        let end = self.end(keys.input, &format!("{place}.input"))?;
        let times = Accessor::open(self.document, self.buffers, keys.input, Format::TIMES, format_args!("{place}.input"))?;
        let output_place = format!("{place}.output");
        let values = Accessor::open(self.document, self.buffers, keys.output, format, &output_place)?;
        let track = Track { node, property, interpolation: keys.interpolation, times, values, width, end, place: output_place };

        let expected = (track.times.count() * track.values_per_key()).checked_mul(track.elements_per_value());
        if expected != Some(track.values.count()) {
            let problem = format!(
                "accessors[{}] has a count of {}, but {} keys with {} values of {} elements each need {}; export the file again",
                keys.output,
                track.values.count(),
                track.times.count(),
                track.values_per_key(),
                track.elements_per_value(),
                expected.map_or_else(|| "more than can be counted".into(), |count| count.to_string()),
            );
            return Err(self.document.invalid(&track.place, problem));
        }
        if self.finite.insert(keys.output) && !track.values.is_left_out() {
            let components = track.values.width();
            let bad = (0..track.values.count()).find(|&i| (0..components).any(|c| !track.values.number(i, c).is_finite()));
            if let Some(i) = bad {
                let problem = format!("accessors[{}] has an element {i} that is not finite; export the file again", keys.output);
                return Err(self.document.invalid(&track.place, problem));
            }
        }
        Ok(track)
    }

    /// How many morph targets the mesh of a node has.
    fn morph_targets(&self, node: usize) -> usize {
        // `Document` guarantees the indices.
        let root = &self.document.root;
        let mesh = root.nodes[node].mesh.map(|mesh| &root.meshes[mesh.value()]);
        let targets = mesh.into_iter().flat_map(|mesh| &mesh.primitives).filter_map(|primitive| primitive.targets.as_ref());
        targets.map(Vec::len).max().unwrap_or(0)
    }
}

/// Where the keys of a sampler are, and how to go from one to the next.
struct Keys {
    input: usize,
    output: usize,
    interpolation: Interpolation,
}

/// The keys of one property of one node, checked.
struct Track<'a> {
    node: usize,
    property: Property,
    interpolation: Interpolation,
    times: Accessor<'a>,
    values: Accessor<'a>,
    /// How many numbers a value has.
    width: usize,
    /// The time of the last key in seconds.
    end: f64,
    /// The JSON path of the values.
    place: String,
}

impl Track<'_> {
    /// A cubic spline has a tangent before and one after the value of each key.
    fn values_per_key(&self) -> usize {
        if self.interpolation == Interpolation::CubicSpline { 3 } else { 1 }
    }

    /// Weights are stored one by one, everything else as vectors.
    fn elements_per_value(&self) -> usize {
        if self.property == Property::MorphTargetWeights { self.width } else { 1 }
    }

    /// Sets the track's property at a time.
    fn pose(&self, document: &Document, time: f64, pose: &mut NodePose) -> Result<()> {
        let [x, y, z] = [0, 1, 2].map(|c| if c < self.width { self.number_at(time, c) } else { 0.0 });
        match self.property {
            Property::Translation => pose.translation = Some(DVec3::new(x, y, z)),
            Property::Scale => pose.scale = Some(DVec3::new(x, y, z)),
            Property::Rotation => pose.rotation = Some(self.rotation_at(document, time)?),
            Property::MorphTargetWeights => pose.weights = Some((0..self.width).map(|c| self.number_at(time, c)).collect()),
        }
        Ok(())
    }

    /// The number `c` of value `slot` of key `key`: values are the only ones, or lie between the two tangents.
    fn number(&self, key: usize, slot: usize, c: usize) -> f64 {
        let value = key * self.values_per_key() + slot;
        match self.elements_per_value() {
            1 if self.property != Property::MorphTargetWeights => self.values.number(value, c),
            elements => self.values.number(value * elements + c, 0),
        }
    }

    /// The number `c` of the value proper of a key.
    fn value(&self, key: usize, c: usize) -> f64 {
        self.number(key, self.values_per_key() / 2, c)
    }

    /// The key at or before a time, the share of the way to the next key, and the seconds between the two. Before the
    /// first key and after the last one the way is nought.
    fn segment(&self, time: f64) -> (usize, f64, f64) {
        let time_of = |key: usize| self.times.number(key, 0);
        // How many keys lie at or before the time, by bisection.
        let (mut low, mut high) = (0, self.times.count());
        while low < high {
            let middle = low.midpoint(high);
            if time_of(middle) <= time { low = middle + 1 } else { high = middle }
        }
        if low == 0 || low == self.times.count() {
            return (low.saturating_sub(1), 0.0, 0.0);
        }
        let (start, length) = (time_of(low - 1), time_of(low) - time_of(low - 1));
        (low - 1, (time - start) / length, length)
    }

    /// The number `c` of the value at a time; rotations with linear interpolation are not taken number by number.
    fn number_at(&self, time: f64, c: usize) -> f64 {
        let (key, t, length) = self.segment(time);
        if t == 0.0 {
            return self.value(key, c);
        }
        match self.interpolation {
            Interpolation::Step => self.value(key, c),
            Interpolation::Linear => (1.0 - t) * self.value(key, c) + t * self.value(key + 1, c),
            Interpolation::CubicSpline => {
                const TANGENT_IN: usize = 0;
                const TANGENT_OUT: usize = 2;
                let (t2, t3) = (t * t, t * t * t);
                (2.0 * t3 - 3.0 * t2 + 1.0) * self.value(key, c)
                    + length * (t3 - 2.0 * t2 + t) * self.number(key, TANGENT_OUT, c)
                    + (3.0 * t2 - 2.0 * t3) * self.value(key + 1, c)
                    + length * (t3 - t2) * self.number(key + 1, TANGENT_IN, c)
            }
        }
    }

    /// The rotation at a time.
    fn rotation_at(&self, document: &Document, time: f64) -> Result<DQuat> {
        let unit = |xyzw: [f64; 4], what: &dyn Display| {
            unit_quaternion(xyzw).ok_or_else(|| {
                let problem = format!("{what} is {xyzw:?}, which is no rotation; export the file again");
                document.invalid(&self.place, problem)
            })
        };
        let (key, t, _) = self.segment(time);
        if self.interpolation != Interpolation::Linear || t == 0.0 {
            return unit([0, 1, 2, 3].map(|c| self.number_at(time, c)), &format_args!("the value at {time} s"));
        }
        let key_value = |key: usize| unit([0, 1, 2, 3].map(|c| self.value(key, c)), &format_args!("the value of key {key}"));
        Ok(slerp(key_value(key)?, key_value(key + 1)?, t))
    }
}

/// The rotation at the share `t` of the shorter way from `a` to `b`, both of unit length.
fn slerp(a: DQuat, b: DQuat, t: f64) -> DQuat {
    /// Below this angle, in radians, arc and chord are the same to double precision, and sines would be divided by almost 0.
    const SMALL_ANGLE: f64 = 1e-6;
    let dot = a.dot(b);
    // A quaternion and its opposite are the same rotation; of the two, the nearer one makes the shorter way.
    let b = if dot < 0.0 { -b } else { b };
    let angle = dot.abs().min(1.0).acos();
    let mixed = if angle < SMALL_ANGLE { a * (1.0 - t) + b * t } else { a * (angle * (1.0 - t)).sin() + b * (angle * t).sin() };
    mixed.normalize()
}
