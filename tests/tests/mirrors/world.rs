//! What the mirrored functions are fed: lights, views, a map and materials as scenes have them, and inputs up to the edges.

use super::*;

/// The unit in the last place of a number, not below that of the smallest normal one.
pub(super) fn unit_of(x: f32) -> f32 {
    let x = x.abs().clamp(f32::MIN_POSITIVE, f32::MAX.next_down());
    x.next_up() - x
}

/// What the functions read: real plans, a map and textures.
pub(super) struct World {
    pub(super) globals: Globals,
    /// Light, point, normal, pixel and steps of many receivers.
    pub(super) receivers: Vec<[f32; 15]>,
}

/// The light that shines straight down: its view's axes are those of the world, so planes can be seen exactly edge-on.
pub(super) const NOON: f32 = 0.0;

impl World {
    pub(super) fn get() -> &'static Self {
        static WORLD: OnceLock<World> = OnceLock::new();
        WORLD.get_or_init(|| {
            let mut random = Random::new("the world");
            let (mut lights, views) = plans();
            let mut depths = depths(views.len() as u32, &mut random);
            for (view, layer) in views.iter().zip(depths.chunks_exact_mut((MAP_SIZE * MAP_SIZE) as usize)) {
                if view.depth_kind == DEPTH_REVERSED {
                    layer.iter_mut().for_each(|depth| *depth = 1.0 - *depth);
                }
            }
            let (materials, words) = materials(&mut random);
            // Every third spot light that has a single view projects a picture, in turn those of the materials.
            let pictures: Vec<_> =
                materials.iter().map(|material| material.texture).filter(|texture| texture.first_word != NO_TEXTURE).collect();
            let spots = lights.iter_mut().filter(|light| light.split == SPLIT_SINGLE && light.axis != [0.0; 3]);
            for (index, light) in spots.enumerate().filter(|(index, _)| index % 3 == 0) {
                let texture = pictures[index % pictures.len()];
                let position = Vec3::from(light.position);
                let direction = Vec3::from(light.axis);
                let kind = LightKind::Spot { position, direction, inner: 0.0, outer: 0.6, range: None };
                let of_picture = Light { kind, color: Vec3::ONE, intensity: 1.0 };
                plan_picture(light, &of_picture, texture.first_word, texture.width, texture.height)
                    .expect("a spot light projects a picture");
            }
            let globals = Globals { lights, views, materials, words, map_size: MAP_SIZE, depths };
            let mut world = Self { globals, receivers: Vec::new() };
            world.receivers = (0..30 * COUNT).map(|index| world.new_receiver(index, &mut random)).collect();
            world.plant_ties();
            world
        })
    }

    pub(super) fn light(&self, index: f32) -> &LightPlan {
        &self.globals.lights[index as usize]
    }

    pub(super) fn view(&self, index: f32) -> &ViewPlan {
        &self.globals.views[index as usize]
    }

    pub(super) fn map(&self) -> Map<'_> {
        Map { depths: &self.globals.depths }
    }

    /// A receiver in or near the scene, mostly one that faces its light.
    pub(super) fn new_receiver(&self, index: usize, random: &mut Random) -> [f32; 15] {
        let lights = self.globals.lights.len();
        let light = (index % lights) as f32;
        let plan = &self.globals.lights[index % lights];
        let apex = Vec3::from(plan.position);
        let reach = if random.below(4) == 0 { 9.0 } else { 6.0 };
        let mut point = random.vector(reach);
        if plan.split == SPLIT_SINGLE && plan.axis != [0.0; 3] && random.below(4) > 0 {
            // In the cone, where a map can be asked.
            let distance = random.within(0.5, 12.0);
            point = apex + (Vec3::from(plan.axis) + random.vector(self.reach(plan))) * distance;
        }
        if index < lights {
            point = apex;
        }
        let mut normal = random.vector(1.0);
        let toward = toward_light(plan, point);
        if normal.dot(toward) < 0.0 && random.below(8) > 0 {
            normal = -normal;
        }
        if random.below(64) == 0 {
            normal = [Vec3::ZERO, toward.cross(normal), Vec3::X, Vec3::Y][random.below(4) as usize];
        }
        // Footprints of less than a texel, and of many.
        let length = if random.below(2) == 0 { 0.1 } else { 2.0 };
        let (right, below) = (random.vector(length), random.vector(length));
        let pixel = [random.below(64), random.below(64)].map(|x| x as f32);
        [
            light, point.x, point.y, point.z, normal.x, normal.y, normal.z, pixel[0], pixel[1], right.x, right.y, right.z,
            below.x, below.y, below.z,
        ]
    }

    /// A little more than half the width of a light's first view at a distance of 1 m.
    pub(super) fn reach(&self, light: &LightPlan) -> f32 {
        let view = &self.globals.views[light.first_view as usize];
        if view.w_per_metre > 0.0 { 0.65 * view.texel_metres[0] * MAP_SIZE as f32 } else { 1.0 }
    }

    /// Gives every fourth receiver's texel the depth that the receiver is just lit by, or the next one below, by which it is not.
    pub(super) fn plant_ties(&mut self) {
        // No more than leaves most of the noise as it is.
        for (index, group) in self.receivers.iter().enumerate().take(8 * COUNT).step_by(4) {
            let (light, receiver) = receiver(self, group);
            let found = lookup(light, &self.globals.views, &receiver);
            if found.view != NO_VIEW {
                let texel = found.texel.floor();
                let view = &self.globals.views[found.view as usize];
                let stored = comparable_depth(view, found.depth - found.bias);
                let nearer = if view.depth_kind == DEPTH_REVERSED { stored.next_up() } else { stored.next_down() };
                let texel =
                    (self.globals.views[found.view as usize].layer * MAP_SIZE + texel.y as u32) * MAP_SIZE + texel.x as u32;
                self.globals.depths[texel as usize] = if index % 8 == 0 { stored } else { nearer };
            }
        }
    }

    /// Views, and centres of their texels.
    pub(super) fn views_and_texels(&self, random: &mut Random) -> Vec<f32> {
        random.groups(&[[0.0; 3], [0.0, 0.5, 0.5]], |random| {
            let texel = [random.below(MAP_SIZE), random.below(MAP_SIZE)].map(|x| x as f32 + 0.5);
            [random.below(self.globals.views.len() as u32) as f32, texel[0], texel[1]]
        })
    }

    /// A light, and a point in or near the scene; now and then the light's own position.
    pub(super) fn light_and_point(&self, random: &mut Random) -> [f32; 4] {
        let light = random.below(self.globals.lights.len() as u32);
        let plan = &self.globals.lights[light as usize];
        let mut point = random.vector(8.0);
        match random.below(16) {
            0 => point = Vec3::from(plan.position),
            1..8 => {
                let direction = Vec3::from(plan.axis) + random.vector(self.reach(plan));
                point = Vec3::from(plan.position) + direction * random.within(0.01, 12.0);
            }
            _ => {}
        }
        [light as f32, point.x, point.y, point.z]
    }

    /// A light, a surface and a visibility.
    pub(super) fn light_and_surface(&self, random: &mut Random) -> [f32; 16] {
        let [light, x, y, z] = self.light_and_point(random);
        let toward = toward_light(self.light(light), Vec3::new(x, y, z)).normalize_or(Vec3::X);
        let normal = random.vector(1.0).normalize_or(Vec3::Y);
        // Some surfaces are flat.
        let deviation = if random.below(4) == 0 { 0.0 } else { random.within(0.01, MAX_DEVIATION) };
        // Half of the viewers look from where the highlight is.
        let mirrored = 2.0 * normal.dot(toward) * normal - toward;
        let viewer = if random.below(2) == 0 { random.vector(1.0) } else { mirrored + random.vector(0.1) }.normalize_or(Vec3::Z);
        let viewer = if random.below(64) == 0 { -toward } else { viewer };
        let shininess = [1.0, 2048.0, random.within(1.0, 2048.0), random.within(1.0, 40.0)][random.below(4) as usize];
        let visibility = [0.0, 1.0, random.unit(), 0.75][random.below(4) as usize];
        let base = [random.unit(), random.unit(), random.unit()];
        [
            light, x, y, z, normal.x, normal.y, normal.z, deviation, viewer.x, viewer.y, viewer.z, base[0], base[1], base[2],
            shininess, visibility,
        ]
    }

    /// A view, and a place in its layer: anywhere, on a border or a centre of a texel, or beyond the rectangle.
    pub(super) fn view_and_texel(&self, random: &mut Random) -> [f32; 3] {
        let view = random.below(self.globals.views.len() as u32);
        let coordinate = |random: &mut Random| match random.below(4) {
            0 => random.below(MAP_SIZE + 5) as f32 - 2.0,
            1 => random.below(MAP_SIZE + 5) as f32 - 1.5,
            _ => random.within(-2.0, MAP_SIZE as f32 + 2.0),
        };
        [view as f32, coordinate(random), coordinate(random)]
    }

    /// A depth to be compared with a texel: often just the one that is still lit, or the next one beyond.
    pub(super) fn depth_near(&self, random: &mut Random, view: f32, x: f32, y: f32, bias: f32) -> f32 {
        let inside = |x: f32| x >= 0.0 && x < MAP_SIZE as f32;
        if !inside(x) || !inside(y) {
            return random.unit();
        }
        let lit = comparable_depth(self.view(view), self.map().fetch_texel(self.view(view).layer, x as u32, y as u32)) + bias;
        match random.below(4) {
            0 => lit,
            1 => lit.next_up(),
            _ => comparable_depth(self.view(view), random.unit()),
        }
    }

    /// Infinite where a test around a texel ties, as rounding may decide it; else 1. `lost` is the rounding of the
    /// depth and the bias.
    pub(super) fn scale_of_tests(&self, light: &LightPlan, lookup: &Lookup, lost: f32) -> f32 {
        let view = &self.globals.views[lookup.view as usize];
        let inside = |x: i32| (0..MAP_SIZE as i32).contains(&x);
        let mut tie = false;
        for_each_weighted_tap(light, lookup, |tap| {
            tie |= inside(tap.x)
                && inside(tap.y)
                && (tap_depth(light, view, lookup, tap.x, tap.y)
                    - lookup.bias
                    - comparable_depth(view, self.map().fetch_texel(view.layer, tap.x as u32, tap.y as u32)))
                .abs()
                    < TIE + lost;
        });
        if tie { f32::INFINITY } else { 1.0 }
    }

    /// The view that a receiver asks first, or would if it faced the light.
    pub(super) fn asked(&self, light: &LightPlan, receiver: &Receiver) -> u32 {
        let facing = Receiver { normal: toward_light(light, receiver.point), ..*receiver };
        let choice = choose_views(light, &self.globals.views, &facing);
        if choice.first == NO_VIEW { light.first_view } else { choice.first }
    }

    /// Whether rounding may decide which view a receiver asks.
    pub(super) fn is_near_choice(&self, light: &LightPlan, receiver: &Receiver) -> bool {
        /// The least part of a map's half that the f32 rows of its matrix tell apart, many times over.
        const RIM: f32 = 1e-3;
        let toward = toward_light(light, receiver.point);
        let magnitude = receiver.normal.abs().dot(Vec3::from(light.position).abs() + receiver.point.abs());
        let mut near = is_tie(receiver.normal.dot(toward), magnitude);
        if light.split != SPLIT_CASCADES && light.shadow_far == f32::MAX {
            return near;
        }
        let terms = magnitude_of_row(light.view_distance, receiver.point);
        let distance = row_times_point(light.view_distance, receiver.point);
        let ends = light.split_far.as_flattened().iter().zip(light.split_band.as_flattened());
        for (&end, &band) in ends {
            near |= is_tie(distance - end, terms + end.min(1e6)) || is_tie(distance - (end - band), terms + end.min(1e6));
        }
        near |= is_tie(distance - light.shadow_far, terms + light.shadow_far.min(1e6));
        if light.selection == SELECT_BY_CONTAINMENT {
            for view in &self.globals.views[light.first_view as usize..][..light.view_count as usize] {
                let w = row_times_point(view.clip_w, receiver.point);
                let ndc = [view.clip_x, view.clip_y].map(|row| (row_times_point(row, receiver.point) / w).abs());
                let rim = 1.0 - ndc[0].max(ndc[1]) - light.guard_texels * 2.0 / view.rect[2] as f32;
                near |= rim.abs() < RIM || is_tie(w, magnitude_of_row(view.clip_w, receiver.point));
                // Any distance is near enough where there is no limit.
                let farthest = view.farthest_w * row_times_point(view.distance, receiver.point);
                let terms = magnitude_of_row(view.clip_w, receiver.point);
                let limit_terms = view.farthest_w * magnitude_of_row(view.distance, receiver.point);
                near |= view.farthest_w < f32::MAX && is_tie(w - farthest, terms + limit_terms);
                near |= light.split_band.as_flattened().iter().any(|&band| (rim - band).abs() < RIM);
            }
        }
        near
    }

    /// Whether rounding may decide anything of what a receiver between two cascades sees in either.
    pub(super) fn is_near_jump(&self, light: &LightPlan, receiver: &Receiver) -> bool {
        let choice = choose_views(light, &self.globals.views, receiver);
        [choice.first, choice.second].into_iter().any(|index| {
            let view = &self.globals.views[index as usize];
            let found = lookup_in_view(light, view, index, receiver);
            let mut at_border = false;
            for_each_test_place(light, &found, |place| at_border |= (place - place.round()).abs().min_element() < 1.0 / 256.0);
            let known = found.view == NO_VIEW;
            known || at_border || self.scale_of_tests(light, &found, 1e-4) == f32::INFINITY
        })
    }

    /// The sizes of the terms of a lookup's texel x and y, depth and bias; infinite where it is near to choosing another answer.
    pub(super) fn scale_of_lookup(&self, light: &LightPlan, receiver: &Receiver) -> [f32; 4] {
        let toward = toward_light(light, receiver.point);
        let magnitude = receiver.normal.abs().dot(Vec3::from(light.position).abs() + receiver.point.abs());
        let mut near = is_tie(receiver.normal.dot(toward), magnitude);
        let found = lookup(light, &self.globals.views, receiver);
        near |= self.is_near_choice(light, receiver);
        let view = &self.globals.views[self.asked(light, receiver) as usize];
        let w = row_times_point(view.clip_w, receiver.point);
        near |= is_tie(row_times_point(view.half_space, receiver.point), magnitude_of_row(view.half_space, receiver.point));
        near |= is_tie(w, magnitude_of_row(view.clip_w, receiver.point)) || w.is_nan();
        let quotient = |row: [f32; 4]| {
            let value = row_times_point(row, receiver.point) / w;
            let terms = magnitude_of_row(row, receiver.point) + value.abs() * magnitude_of_row(view.clip_w, receiver.point);
            (value, terms / w.abs())
        };
        let [x, y, z] = [view.clip_x, view.clip_y, view.clip_z].map(quotient);
        let scales =
            [x.1 * view.texel_scale[0].abs() + view.texel_offset[0], y.1 * view.texel_scale[1].abs() + view.texel_offset[1]];
        let texel = [x.0 * view.texel_scale[0] + view.texel_offset[0], y.0 * view.texel_scale[1] + view.texel_offset[1]]
            .map(|texel| texel + light.texel_shift);
        // Linear depth comes of w itself.
        let z = if view.depth_kind == DEPTH_LINEAR {
            let terms = magnitude_of_row(view.clip_w, receiver.point) * view.linear_scale + view.linear_offset.abs();
            (receiver_depth(view, z.0, w), terms)
        } else {
            (receiver_depth(view, z.0, w), z.1)
        };
        for axis in 0..2 {
            let first = view.rect[axis] as f32;
            let last = first + view.rect[axis + 2] as f32;
            near |= is_tie(texel[axis] - first, scales[axis]) || is_tie(texel[axis] - last, scales[axis]);
        }
        near |= is_tie(z.0 - depth_limits(view)[0], z.1);
        if near {
            return [f32::INFINITY; 4];
        }
        let bias = if found.view == NO_VIEW {
            0.0
        } else {
            let along = row_times_point(view.distance, receiver.point);
            let bias = magnitude_of_bias(light, view, receiver.point, receiver.normal, [w, along], found.footprint);
            // The slope of linear depth over z / w, where it is steepest: without a bias.
            if view.depth_kind == DEPTH_LINEAR { bias * (w * w / view.depth_factor * view.linear_scale) } else { bias }
        };
        [scales[0], scales[1], z.1, bias]
    }

    /// The size of the terms of a footprint's sides in texels.
    pub(super) fn scale_of_footprint(&self, light: &LightPlan, receiver: &Receiver) -> f32 {
        let view = &self.globals.views[self.asked(light, receiver) as usize];
        let w = row_times_point(view.clip_w, receiver.point);
        let steps = receiver.steps[0].abs().max(receiver.steps[1].abs());
        let row = |row: [f32; 4]| row_times_vector(row.map(f32::abs), steps);
        let place = |row: [f32; 4]| magnitude_of_row(row, receiver.point) / w.abs();
        let x = row(view.clip_x)
            + place(view.clip_x) * row(view.clip_w) * (1.0 + magnitude_of_row(view.clip_w, receiver.point) / w.abs());
        let y = row(view.clip_y)
            + place(view.clip_y) * row(view.clip_w) * (1.0 + magnitude_of_row(view.clip_w, receiver.point) / w.abs());
        (x.max(y) / w.abs()) * view.texel_scale[0].abs()
    }

    /// A textured material, and coordinates in and around its texture, often on the border or the centre of a texel.
    pub(super) fn texture_coordinates(&self, random: &mut Random) -> [f32; 3] {
        let material = random.below(self.globals.materials.len() as u32 - 1);
        let texture = self.globals.materials[material as usize].texture;
        let coordinate = |random: &mut Random, size: u32| match random.below(8) {
            0 | 1 => (random.below(8 * size) as f32 - 3.0 * size as f32) / (2.0 * size as f32),
            2 => random.within(-1e4, 1e4),
            3 => random.within(-1e9, 1e9),
            _ => random.within(-2.0, 3.0),
        };
        [material as f32, coordinate(random, texture.width), coordinate(random, texture.height)]
    }

    /// Every textured material at coordinates that are huge or not finite, for which the function promises some texel.
    pub(super) fn edges_of_textures(&self) -> Vec<[f32; 3]> {
        let coordinates = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, -1e30, 0.0, 1.0, -0.0];
        (0..self.globals.materials.len() - 1)
            .flat_map(|material| {
                coordinates.map(|u| [material as f32, u, 0.3]).into_iter().chain(coordinates.map(|v| [material as f32, 0.3, v]))
            })
            .collect()
    }
}

/// The maps of the world.
pub(super) struct Map<'a> {
    pub(super) depths: &'a [f32],
}

impl MapAccess for Map<'_> {
    fn fetch_texel(&self, layer: u32, x: u32, y: u32) -> f32 {
        self.depths[((layer * MAP_SIZE + y) * MAP_SIZE + x) as usize]
    }
}

/// Every kind of light under every bias and filter, planned for a scene of 10 m.
pub(super) fn plans() -> (Vec<LightPlan>, Vec<ViewPlan>) {
    let position = Vec3::new(1.0, 7.0, 2.0);
    let direction = Vec3::new(0.2, -1.0, -0.3);
    let kinds = [
        (LightKind::Directional { direction: Vec3::NEG_Y }, Split::Single),
        (LightKind::Directional { direction: Vec3::new(0.5, -0.8, 0.3) }, Split::Single),
        (LightKind::Spot { position, direction, inner: 0.3, outer: 0.6, range: Some(12.0) }, Split::Single),
        // The falloff's steepest step.
        (LightKind::Spot { position, direction, inner: 0.0, outer: 0.02, range: None }, Split::Single),
        (LightKind::Spot { position, direction, inner: 1.0, outer: 1.5, range: None }, Split::Single),
        (LightKind::Point { position: Vec3::new(0.5, 1.0, -0.25), range: None }, Split::Single),
        (LightKind::Point { position: Vec3::new(-2.0, 3.0, 1.0), range: Some(6.0) }, Split::Cube),
    ];
    let scene = Aabb::new(Vec3::splat(-5.0), Vec3::splat(5.0));
    let (mut lights, mut views) = (Vec::new(), Vec::new());
    let casters = [scene];
    let projection = Projection::Perspective { vertical_fov: 1.0, near: 0.5, far: None };
    let camera = Camera::look_at(DVec3::new(1.0, 4.0, 9.0), DVec3::ZERO, projection).expect("the eye is not the target");
    let eye = Eye { camera, aspect: 1.5, samples: &[], plane: None };
    let subject = Subject { casters: &casters, bounds: scene, origin: DVec3::ZERO, eye: Some(eye) };
    let mut add_with = |kind: LightKind, settings: ShadowSettings| {
        let light = Light { kind, color: Vec3::new(1.0, 0.9, 0.7), intensity: 1500.0 };
        let terminator = [Terminator::Hard, Terminator::Soft][lights.len() % 2];
        let texels = [Texels::OpenGl, Texels::OpenGl, Texels::Direct3d][lights.len() % 3];
        let settings = ShadowSettings { texels, terminator, map_size: MAP_SIZE, ..settings };
        let mut lent = [ViewPlan::default(); MAX_VIEWS_PER_LIGHT];
        let plan = plan_light(&light, &subject, &settings, [views.len() as u32, views.len() as u32], &mut lent)
            .expect("the light can be planned");
        views.extend_from_slice(&lent[..plan.view_count as usize]);
        lights.push(plan);
    };
    let mut add_stored = |(kind, split): (LightKind, Split), bias: Bias, filter: Filter, store: Store| {
        add_with(kind, ShadowSettings { split, bias, filter, store, ..ShadowSettings::default() });
    };
    // Every store, and casters that are drawn deeper.
    for store in Store::ALL.into_iter().filter(|store| *store != Store::Depth32) {
        for bias in [Bias::Automatic, Bias::slope(1.0, 0.01)] {
            for kind in [kinds[1], kinds[2], kinds[5]] {
                add_stored(kind, bias, Filter::Bilinear, store);
            }
        }
    }
    let polygon_offset = Some(PolygonOffset { slope: 1.5, units: 40.0, clamp: 0.05 });
    for store in [Store::Depth32, Store::Depth16, Store::Reversed32] {
        for kind in [kinds[1], kinds[2], kinds[5]] {
            add_stored(kind, Bias::Parts(BiasParts { polygon_offset, ..BiasParts::NONE }), Filter::Hard, store);
        }
    }
    for is_corrected in [false, true] {
        let ogre_2006 = Some(Ogre2006 { metres: 0.1, is_corrected });
        for kind in [kinds[1], kinds[2], kinds[5]] {
            add_stored(kind, Bias::Parts(BiasParts { ogre_2006, ..BiasParts::NONE }), Filter::Hard, Store::Depth32);
        }
    }
    let mut add = |kind: (LightKind, Split), bias: Bias, filter: Filter| add_stored(kind, bias, filter, Store::Depth32);
    for bias in [Bias::Automatic, Bias::slope(1.0, 0.01), Bias::constant(0.02), Bias::NONE] {
        for filter in [Filter::Hard, Filter::Bilinear] {
            for kind in kinds {
                add(kind, bias, filter);
            }
        }
    }
    // Every part of a bias, alone and together.
    let gradient = ReceiverGradient { fixed: 0.01, clamp: 0.2, scale: 0.5 };
    for parts in [
        BiasParts { normal_offset: Some(1.5), ..BiasParts::NONE },
        BiasParts { receiver_plane: Some(0.5), ..BiasParts::NONE },
        BiasParts { receiver_gradient: Some(gradient), ..BiasParts::NONE },
        BiasParts {
            constant: Some(0.01),
            normal_offset: Some(1.0),
            receiver_plane: Some(2.0),
            receiver_gradient: Some(gradient),
            ..BiasParts::NONE
        },
    ] {
        for filter in [Filter::Hard, Filter::Bilinear, Filter::Box3, Filter::Footprint] {
            for kind in [kinds[1], kinds[2], kinds[5]] {
                add(kind, Bias::Parts(parts), filter);
            }
        }
    }
    // The guard bands of wide filters under the automatic bias would leave nothing of maps as small as these.
    for filter in Filter::ALL.into_iter().filter(|filter| !matches!(filter, Filter::Hard | Filter::Bilinear)) {
        for kind in [kinds[1], kinds[2], kinds[5]] {
            add(kind, Bias::slope(1.0, 0.01), filter);
        }
    }
    // Every fit, and cascades of every kind, under biases that measure metres, texels and depth.
    let every_part = BiasParts { constant: Some(0.02), normal_offset: Some(1.0), receiver_plane: Some(1.0), ..BiasParts::NONE };
    let biases = [Bias::Automatic, Bias::slope(1.0, 0.01), Bias::Parts(every_part)];
    let plane = Some([0.1, 1.0, 0.0, 5.0]);
    for bias in biases {
        let hard = ShadowSettings { bias, filter: Filter::Hard, plane, ..ShadowSettings::default() };
        for fit in Fit::ALL.into_iter().filter(|fit| *fit != Fit::Uniform) {
            for (kind, _) in [kinds[1], kinds[2], kinds[5]] {
                add_with(kind, ShadowSettings { fit, ..hard });
            }
        }
        let four = Cascades::default();
        for (fit, cascades) in [
            (Fit::Uniform, four),
            (Fit::Focused, Cascades { count: 8, blend: 0.3, ..four }),
            (Fit::Lispsm, Cascades { count: 3, blend: 0.5, padding: 0.5, ..four }),
            (Fit::Uniform, Cascades { count: 2, selection: Selection::Containment, ..four }),
            (Fit::Focused, Cascades { selection: Selection::Containment, blend: 0.4, ..four }),
            (Fit::Lispsm, Cascades { selection: Selection::Containment, ..four }),
        ] {
            let split = Split::Cascades(cascades);
            for (kind, _) in [kinds[1], kinds[2]] {
                add_with(kind, ShadowSettings { fit, split, ..hard });
                add_with(kind, ShadowSettings { fit, split, shadow_distance: Some(9.0), ..hard });
            }
        }
        add_with(kinds[5].0, ShadowSettings { shadow_distance: Some(8.0), ..hard });
    }
    // Pancaked views, of what is near to the camera, for every store that has them and casters that are drawn deeper. The room for the automatic bias would fill maps as small as these.
    let near = ShadowSettings { pancake: true, shadow_distance: Some(9.0), ..ShadowSettings::default() };
    for (kind, split) in [kinds[1], kinds[2], kinds[5]] {
        for store in Store::ALL.into_iter().filter(|store| !matches!(store, Store::Second | Store::Midpoint)) {
            add_with(kind, ShadowSettings { split, store, bias: Bias::constant(0.02), ..near });
        }
        let polygon_offset = Some(PolygonOffset { slope: 1.5, units: 40.0, clamp: 0.05 });
        for store in [Store::Depth16, Store::Reversed32] {
            let bias = Bias::Parts(BiasParts { polygon_offset, ..BiasParts::NONE });
            add_with(kind, ShadowSettings { split, store, bias, ..near });
        }
        let ogre_2006 = Some(Ogre2006 { metres: 0.1, is_corrected: false });
        add_with(kind, ShadowSettings { split, bias: Bias::Parts(BiasParts { ogre_2006, ..BiasParts::NONE }), ..near });
    }
    // Warps of so small a scene leave nothing out that is in their map: they end half-way.
    for view in views.iter_mut().filter(|view| view.farthest_w < f32::MAX) {
        view.farthest_w = 0.5 * (1.0 + view.farthest_w);
    }
    // A part of the layer, as an atlas has it.
    for view in views.iter_mut().step_by(3).filter(|view| view.has_map()) {
        view.rect = [2, 1, MAP_SIZE - 5, MAP_SIZE - 3];
    }
    (lights, views)
}

/// Maps of large blocks with single texels that differ, so that all, some or none of neighbouring tests pass; a good part was
/// never drawn to.
pub(super) fn depths(layers: u32, random: &mut Random) -> Vec<f32> {
    const BLOCK: u32 = 4;
    const BLOCKS: u32 = MAP_SIZE / BLOCK;
    // Perspective depths crowd near 1.
    let new_depth = |random: &mut Random| match random.below(3) {
        0 => 1.0,
        1 => random.unit(),
        _ => 1.0 - random.unit() * random.unit() * random.unit(),
    };
    let blocks: Vec<f32> = (0..layers * BLOCKS * BLOCKS).map(|_| new_depth(random)).collect();
    (0..layers * MAP_SIZE * MAP_SIZE)
        .map(|index| {
            let (x, row) = (index % MAP_SIZE, index / MAP_SIZE);
            if random.below(6) == 0 { new_depth(random) } else { blocks[(row / BLOCK * BLOCKS + x / BLOCK) as usize] }
        })
        .collect()
}

/// Textures of several sizes under every pair of wrap modes, and at last a material without one.
pub(super) fn materials(random: &mut Random) -> (Vec<MaterialData>, Vec<u32>) {
    let mut words: Vec<u32> = decode_table().map(f32::to_bits).to_vec();
    assert_eq!(words.len(), DECODE_TABLE_LEN as usize, "the table is as long as it says");
    let mut materials = Vec::new();
    for (width, height) in [(1, 1), (2, 2), (5, 3), (16, 8)] {
        let first_word = words.len() as u32;
        words.extend((0..width * height).map(|_| random.bits()));
        for wrap_u in [WRAP_REPEAT, WRAP_CLAMP, WRAP_MIRROR] {
            for wrap_v in [WRAP_REPEAT, WRAP_CLAMP, WRAP_MIRROR] {
                materials.push(MaterialData {
                    base_color: [random.unit(), random.unit(), random.unit(), 1.0],
                    alpha_cutoff: 0.5,
                    flags: FLAG_MASK,
                    shininess: 10.0,
                    texture: TextureData { first_word, width, height, wrap_u, wrap_v },
                });
            }
        }
    }
    materials.push(MaterialData { texture: TextureData::NONE, ..materials[0] });
    (materials, words)
}

pub(super) fn v3(numbers: &[f32], first: usize) -> Vec3 {
    Vec3::from_slice(&numbers[first..])
}

/// The light and the receiver of a group of inputs.
pub(super) fn receiver<'a>(world: &'a World, group: &[f32]) -> (&'a LightPlan, Receiver) {
    let receiver = Receiver {
        point: v3(group, 1),
        normal: v3(group, 4),
        pixel: [group[7] as u32, group[8] as u32],
        steps: [v3(group, 9), v3(group, 12)],
    };
    (world.light(group[0]), receiver)
}

/// The surface that 13 inputs describe.
pub(super) fn surface(i: &[f32]) -> Surface {
    Surface {
        point: v3(i, 0),
        normal: v3(i, 3),
        deviation: i[6],
        toward_viewer: v3(i, 7),
        base_color: v3(i, 10),
        shininess: i[13],
    }
}

/// Numbers that are as large as their terms.
pub(super) fn numbers<const N: usize>(values: [f32; N]) -> Vec<Number> {
    values.map(Number::from).to_vec()
}

/// A vector, and the sizes of the terms of its components.
pub(super) fn scaled(values: Vec3, scales: Vec3) -> Vec<Number> {
    values.to_array().into_iter().zip(scales.to_array()).map(|(value, scale)| Number { value, scale }).collect()
}

/// A sum of products, and the size of the products.
pub(super) fn sum(value: f32, products: &[Vec3]) -> Number {
    Number { value, scale: products.iter().map(|product| product.abs().element_sum()).sum() }
}

/// Depths that are nearer than this may compare either way: the contract's tolerance.
pub(super) const TIE: f32 = 1.0 / 1_048_576.0;

/// Whether a sum of terms of this size is so near to 0 that its sign may be the rounding's.
pub(super) fn is_tie(value: f32, magnitude: f32) -> bool {
    // Some sixteen roundings.
    value.abs() <= 16.0 * unit_of(magnitude)
}

pub(super) fn magnitude_of_cross(a: Vec3, b: Vec3) -> Vec3 {
    let (a, b) = (a.abs(), b.abs());
    Vec3::new(a.y * b.z + b.y * a.z, a.z * b.x + b.z * a.x, a.x * b.y + b.x * a.y)
}

pub(super) fn magnitude_of_row(row: [f32; 4], point: Vec3) -> f32 {
    (v3(&row, 0) * point).abs().element_sum() + row[3].abs()
}

pub(super) fn magnitude_of_gradient(view: &ViewPlan, point: Vec3, normal: Vec3) -> Vec2 {
    let gradient = depth_gradient(view, point, normal);
    let terms = |column: [f32; 4]| normal.abs().dot(v3(&column, 0).abs() + point.abs() * column[3].abs());
    let column = view.world_from_depth;
    let divisor = normal.dot(v3(&column, 0) - point * column[3]).abs();
    let along = |column, gradient: f32| (terms(column) + gradient.abs() * terms(view.world_from_depth)) / divisor;
    if is_tie(divisor, terms(view.world_from_depth)) {
        return Vec2::INFINITY;
    }
    Vec2::new(along(view.world_from_texel_x, gradient.x), along(view.world_from_texel_y, gradient.y))
}

/// At least a filter's support.
fn reach_of(light: &LightPlan, footprint: [Vec2; 2]) -> f32 {
    let sides = footprint.map(|side| side.abs().max_element());
    light.filter_reach + 1.0 + sides[0] + sides[1]
}

pub(super) fn magnitude_of_bias(
    light: &LightPlan,
    view: &ViewPlan,
    point: Vec3,
    normal: Vec3,
    [w, distance]: [f32; 2],
    footprint: [Vec2; 2],
) -> f32 {
    let before = distance - view.w_per_metre * light.bias_metres;
    // Without a length there is nothing to lose, however near the light is.
    let reach = if light.bias_metres == 0.0 {
        0.0
    } else {
        view.depth_factor * light.bias_metres * (distance + light.bias_metres) / (w * before * before)
    };
    let mut magnitude = depth_bias(light, view, needed_depth(light, view, point, normal, w, footprint), w, distance) + reach;
    if light.bias & (BIAS_SLOPE | BIAS_AUTOMATIC | BIAS_RECEIVER_PLANE) != 0 {
        let gradient = magnitude_of_gradient(view, point, normal);
        let texels = light.slope_scale * reach_of(light, footprint) + 1.0 + view.rounding_texels[0] + view.rounding_texels[1] / w;
        magnitude += (gradient.x + gradient.y) * texels;
    }
    magnitude
}

/// Of the need of a plane, and of the step along its normal; infinite where a choice hangs on rounding.
pub(super) fn magnitude_of_need(
    light: &LightPlan,
    view: &ViewPlan,
    point: Vec3,
    normal: Vec3,
    w: f32,
    footprint: [Vec2; 2],
) -> [f32; 2] {
    let gradient = magnitude_of_gradient(view, point, normal);
    let texels = light.slope_scale * reach_of(light, footprint) + 1.0 + view.rounding_texels[0] + view.rounding_texels[1] / w;
    let needed = (gradient.x + gradient.y) * texels.abs() + view.rounding_depth[0] + (view.rounding_depth[1] / w).abs();
    let toward = toward_light(light, point);
    let height = normal.dot(toward);
    let limit = (OFFSET_SLOPE * OFFSET_SLOPE + 1.0) * height * height;
    let height_scale = normal.abs().dot(Vec3::from(light.position).abs() + point.abs());
    let along = normal.dot(Vec3::new(view.clip_w[0], view.clip_w[1], view.clip_w[2]));
    let rest = view.depth_factor - needed_depth(light, view, point, normal, w, footprint) * height * along;
    let rest_scale = view.depth_factor + needed * height_scale;
    let is_choice = is_tie(needed_depth(light, view, point, normal, w, footprint) - MAX_DEPTH_BIAS.max(view.drawn_scale), needed)
        || (toward.dot(toward) - limit).abs() <= 1e-4 * limit
        || is_tie(rest, rest_scale)
        || is_tie(height, height_scale);
    let offset =
        if is_choice { f32::INFINITY } else { (needed * height_scale * w / rest).abs() * (1.0 + rest_scale / rest.abs()) };
    [needed, offset]
}

pub(super) fn magnitude_of_attenuation(light: &LightPlan, toward: Vec3) -> f32 {
    let ratio = toward.length() * light.inverse_range;
    (1.0 + ratio.powi(4)) * (1.0 + light.cone_scale.abs()) / toward.length_squared().max(1e-30)
}

/// How far the rounding of a texture coordinate may move the lookup, as a number of which it is a unit in the last place.
pub(super) fn texel_distance(texture: &TextureData, u: f32, v: f32) -> f32 {
    1.0 + (u * texture.width as f32).abs() + (v * texture.height as f32).abs()
}

pub(super) fn pairs_of_vectors(random: &mut Random) -> Vec<f32> {
    let edges = [
        [0.0; 6],
        [1.0, 2.0, 3.0, 1.0, 2.0, 3.0],
        [1.0, 2.0, 3.0, -1.0, -2.0, -3.0],
        [1e15, 0.0, 0.0, 0.0, 1e15, 1e-15],
        // Cancels but for the rounding of the products.
        [1.1, 1.3, 0.0, 1.3, -1.1, 0.0],
    ];
    random.groups(&edges, |random| random.numbers(10.0))
}

/// A triangle and a ray that, but for every eighth, is aimed at a point of it or just beside.
pub(super) fn rays_and_triangles(random: &mut Random) -> [f32; 15] {
    let origin = random.vector(20.0);
    let v0 = random.vector(10.0);
    // Down to triangles of a millimetre.
    let size = [10.0, 1.0, 1e-3][random.below(3) as usize];
    let (v1, v2) = (v0 + random.vector(size), v0 + random.vector(size));
    let target = v0 + (v1 - v0) * random.within(-0.1, 1.1) + (v2 - v0) * random.within(-0.1, 0.6);
    let direction = if random.below(8) == 0 { random.vector(1.0) } else { target - origin };
    let mut group = [0.0; 15];
    for (index, vector) in [origin, direction, v0, v1, v2].into_iter().enumerate() {
        vector.write_to_slice(&mut group[3 * index..]);
    }
    group
}

/// Triangles without area, seen edge-on, and rays without a direction.
pub(super) fn degenerate_triangles() -> Vec<[f32; 15]> {
    let (o, x, y, z) = (Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z);
    let cases = [
        [z, -z, x, x, x],
        [z, -z, o, z, x],
        [z, -z, o, x, 2.0 * x],
        [z, o, o, x, y],
        [5.0 * x + z, -z, o, x, y],
        [z, z, o, x, y],
    ];
    cases
        .map(|case| {
            let mut group = [0.0; 15];
            for (index, vector) in case.into_iter().enumerate() {
                vector.write_to_slice(&mut group[3 * index..]);
            }
            group
        })
        .to_vec()
}

/// Numbers that are the same in every run: splitmix64, seeded by a name.
pub(super) struct Random(pub(super) u64);

impl Random {
    pub(super) fn new(name: &str) -> Self {
        // FNV-1a.
        Self(name.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)))
    }

    pub(super) fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let x = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ x >> 31) >> 32) as u32
    }

    /// An integer from 0 to below `end`.
    pub(super) fn below(&mut self, end: u32) -> u32 {
        ((u64::from(self.bits()) * u64::from(end)) >> 32) as u32
    }

    /// A number from 0 to below 1.
    pub(super) fn unit(&mut self) -> f32 {
        (self.bits() >> 8) as f32 / 16_777_216.0
    }

    pub(super) fn within(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    pub(super) fn vector(&mut self, size: f32) -> Vec3 {
        Vec3::from(self.numbers(size))
    }

    pub(super) fn numbers<const N: usize>(&mut self, size: f32) -> [f32; N] {
        std::array::from_fn(|_| self.within(-size, size))
    }

    /// A positive normal number of any size.
    pub(super) fn positive(&mut self) -> f32 {
        f32::from_bits(0x0080_0000 + self.below(0x7f00_0000))
    }

    /// A bias as plans have it: often none, sometimes so large that all is lit.
    pub(super) fn bias(&mut self) -> f32 {
        [0.0, self.unit() * 0.01, 1.0, self.unit()][self.below(4) as usize]
    }

    /// The edge cases and then random groups, [`COUNT`] in all.
    pub(super) fn groups<const N: usize>(
        &mut self,
        edges: &[[f32; N]],
        mut group: impl FnMut(&mut Self) -> [f32; N],
    ) -> Vec<f32> {
        let mut inputs = edges.concat();
        while inputs.len() < N * COUNT {
            inputs.extend(group(self));
        }
        inputs
    }
}
