//! Random scenes, with whatever is awkward about them.

use shadow_math::{
    Bias, Camera, Cascades, Filter, Fit, FitFrom, Light, LightKind, PlanError, Projection, Selection, ShadowSettings, Split,
    SplitScheme, Store,
    bounds::Aabb,
    fit::{Eye, Subject},
    glam::{DQuat, DVec3, DVec4, Vec3},
    light::MAX_SINGLE_MAP_OUTER_ANGLE,
    plan::{LightPlan, MAX_VIEWS_PER_LIGHT, ViewPlan, plan_light},
    settings::MAX_CASCADES,
};

/// Numbers from a seed, the same on every machine: Vigna's SplitMix64.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number from `low` up to `high`.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.next() >> 11) as f64 / (1_u64 << 53) as f64)
    }

    /// A whole number below `count`.
    pub(crate) fn below(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }

    /// Yes, once in `times`.
    pub(crate) fn once_in(&mut self, times: usize) -> bool {
        self.below(times) == 0
    }

    pub(crate) fn of<T: Copy>(&mut self, items: &[T]) -> T {
        items[self.below(items.len())]
    }

    /// A number between two powers of ten.
    pub(crate) fn power(&mut self, low: f64, high: f64) -> f64 {
        10_f64.powf(self.between(low, high))
    }

    /// A point of the cube from -1 to 1.
    pub(crate) fn point(&mut self) -> DVec3 {
        DVec3::new(self.between(-1.0, 1.0), self.between(-1.0, 1.0), self.between(-1.0, 1.0))
    }

    pub(crate) fn direction(&mut self) -> DVec3 {
        loop {
            let point = self.point();
            if point.length() > 0.1 && point.length() < 1.0 {
                return point.normalize();
            }
        }
    }

    /// A point of a box, of its surface one time in two.
    pub(crate) fn point_of(&mut self, bounds: Aabb) -> Vec3 {
        let mut share = 0.5 * (self.point() + 1.0);
        if self.once_in(2) {
            let axis = self.below(3);
            share[axis] = share[axis].round();
        }
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let point = (min + (max - min) * share).as_vec3();
        point.clamp(bounds.min, bounds.max)
    }
}

/// A scene, who looks at it, and how its shadows are mapped.
#[derive(Debug)]
pub(crate) struct Case {
    pub(crate) light: Light,
    pub(crate) casters: Vec<Aabb>,
    pub(crate) bounds: Aabb,
    pub(crate) camera: Camera,
    pub(crate) aspect: f64,
    pub(crate) samples: Vec<Vec3>,
    pub(crate) plane: Option<DVec4>,
    pub(crate) settings: ShadowSettings,
}

impl Case {
    pub(crate) fn subject(&self) -> Subject<'_> {
        let eye = Eye { camera: self.camera, aspect: self.aspect, samples: &self.samples, plane: self.plane };
        Subject { casters: &self.casters, bounds: self.bounds, origin: DVec3::ZERO, eye: Some(eye) }
    }

    /// The plan, over views that were full of something else.
    pub(crate) fn plan(&self) -> Result<(LightPlan, Vec<ViewPlan>), PlanError> {
        self.plan_over(bytemuck_filled(0xff))
    }

    pub(crate) fn plan_over(&self, stale: ViewPlan) -> Result<(LightPlan, Vec<ViewPlan>), PlanError> {
        let mut views = vec![stale; MAX_VIEWS_PER_LIGHT];
        let light = plan_light(&self.light, &self.subject(), &self.settings, [0, 0], &mut views)?;
        views.truncate(light.view_count as usize);
        Ok((light, views))
    }
}

/// A view all of whose bytes are the same.
pub(crate) fn bytemuck_filled(byte: u8) -> ViewPlan {
    bytemuck::pod_read_unaligned(&[byte; size_of::<ViewPlan>()])
}

fn caster(random: &mut Random, size: f64, origin: DVec3) -> Aabb {
    let center = origin + random.point() * size;
    let mut half = DVec3::new(random.power(-2.0, 0.0), random.power(-2.0, 0.0), random.power(-2.0, 0.0)) * 0.6 * size;
    match random.below(12) {
        0 => half[random.below(3)] = 0.0,
        1 => half = DVec3::ZERO,
        2 => half *= DVec3::new(1.0, 0.0, 0.0),
        _ => {}
    }
    Aabb::new((center - half).as_vec3(), (center + half).as_vec3())
}

fn light(random: &mut Random, size: f64, origin: DVec3, casters: &[Aabb], camera: &Camera) -> Light {
    let along_view = camera.direction() * if random.once_in(2) { 1.0 } else { -1.0 };
    let direction = match random.below(10) {
        0 => along_view,
        1 => along_view + 1e-9 * random.direction(),
        2 => along_view + random.power(-5.0, -1.0) * random.direction(),
        3 => random.of(&DVec3::AXES) * if random.once_in(2) { 1.0 } else { -1.0 },
        4 => camera.orientation * DVec3::X,
        _ => random.direction(),
    };
    let position = match random.below(10) {
        0 if !casters.is_empty() => random.of(casters).center().as_dvec3(),
        1 => camera.eye,
        2 => camera.eye + camera.direction() * size * random.between(0.0, 2.0),
        3 if !casters.is_empty() => random.of(casters).max.as_dvec3(),
        _ => origin + random.point() * size * random.power(-1.0, 1.0),
    }
    .as_vec3();
    let direction = direction.as_vec3();
    let range = random.once_in(3).then(|| (size * random.power(-1.5, 1.0)) as f32);
    let kind = match random.below(3) {
        0 => LightKind::Directional { direction },
        1 => {
            let outer = random.of(&[0.01, 0.3, 0.7, 1.1, 1.221, 1.3, core::f32::consts::FRAC_PI_2]);
            LightKind::Spot { position, direction, inner: 0.5 * outer, outer, range }
        }
        _ => LightKind::Point { position, range },
    };
    Light { kind, color: Vec3::ONE, intensity: 100.0 }
}

fn camera(random: &mut Random, size: f64, origin: DVec3, casters: &[Aabb]) -> Camera {
    let eye = match random.below(6) {
        0 if !casters.is_empty() => random.of(casters).center().as_dvec3(),
        1 => origin + random.direction() * size * random.power(0.5, 2.0),
        2 if !casters.is_empty() => random.of(casters).max.as_dvec3() + DVec3::Y * size * 1e-3,
        _ => origin + random.point() * size * 2.0,
    };
    let near = size * random.power(-4.0, -1.0);
    let far = match random.below(4) {
        0 => near * (1.0 + random.power(-9.0, -1.0)),
        1 => near * random.power(0.1, 5.0),
        _ => near + 40.0 * size,
    };
    let projection = if random.once_in(4) {
        let near = if random.once_in(2) { 0.0 } else { near };
        Projection::Orthographic { half_height: size * random.power(-2.0, 0.5), near, far }
    } else {
        let vertical_fov = if random.once_in(20) { random.between(1e-3, 3.1) } else { random.between(0.2, 1.8) };
        Projection::Perspective { vertical_fov, near, far: (!random.once_in(3)).then_some(far) }
    };
    let target = origin + random.point() * size * 0.7;
    let camera = Camera::look_at(eye, target, projection).unwrap_or(Camera { eye, orientation: DQuat::IDENTITY, projection });
    let roll = if random.once_in(3) { random.between(0.0, 6.0) } else { 0.0 };
    Camera { orientation: (camera.orientation * DQuat::from_rotation_z(roll)).normalize(), ..camera }
}

fn cascades(random: &mut Random, size: f64, fits: &[Fit], is_parallel: bool) -> Cascades {
    let step = (size * random.power(-2.0, 0.3)) as f32;
    let scheme = match random.below(5) {
        0 => SplitScheme::Uniform,
        1 => SplitScheme::Logarithmic,
        2 => SplitScheme::Explicit(core::array::from_fn(|i| step * (i + 1) as f32)),
        3 => SplitScheme::Histogram,
        _ => SplitScheme::Practical(random.between(0.0, 1.0) as f32),
    };
    let stabilised = is_parallel && random.once_in(4);
    // What follows the picture cannot stand still.
    let scheme = if stabilised && scheme == SplitScheme::Histogram { SplitScheme::Logarithmic } else { scheme };
    let mut fits_of_each = [None; MAX_CASCADES];
    if !stabilised && random.once_in(2) {
        fits_of_each = core::array::from_fn(|_| Some(random.of(fits)));
    }
    Cascades {
        count: 1 + random.below(MAX_CASCADES) as u32,
        scheme,
        padding: if random.once_in(2) { 0.0 } else { (size * random.power(-3.0, 1.0)) as f32 },
        blend: if random.once_in(2) { 0.0 } else { random.between(0.0, 1.0) as f32 },
        selection: random.of(&[Selection::Depth, Selection::Containment]),
        stabilised,
        map_sizes: core::array::from_fn(|_| random.of(&[None, Some(64)])),
        fits: fits_of_each,
        lispsm_factors: core::array::from_fn(|_| random.of(&[0.0, 0.3, 1.0, 4.0])),
    }
}

/// A random case: of any of the fits, in scenes of any of the sizes in metres, `count` points in which are looked at.
pub(crate) fn case(seed: u64, fits: &[Fit], sizes: [f64; 2], count: usize) -> Case {
    let random = &mut Random(seed);
    let size = random.power(sizes[0].log10(), sizes[1].log10());
    let origin = if random.once_in(4) { random.point() * size * 10.0 } else { DVec3::ZERO };
    let mut casters: Vec<_> = (0..random.below(6)).map(|_| caster(random, size, origin)).collect();
    if casters.is_empty() || random.once_in(2) {
        let (low, high) = (origin - DVec3::new(1.0, 0.5, 1.0) * size, origin + DVec3::new(1.0, -0.5, 1.0) * size);
        casters.push(Aabb::new(low.as_vec3(), high.as_vec3()));
    }
    if random.once_in(10) {
        let center = casters[0].center();
        let flat = Vec3::new(0.0, size as f32, size as f32);
        casters = vec![if random.once_in(2) { Aabb::new(center, center) } else { Aabb::new(center - flat, center + flat) }];
    }
    let mut bounds = casters.iter().fold(Aabb::EMPTY, |bounds, caster| bounds.union(*caster));
    if random.once_in(3) {
        let extra = (size * random.between(0.0, 3.0)) as f32;
        bounds = Aabb::new(bounds.min - extra, bounds.max + extra);
    }
    if random.once_in(30) {
        casters.clear();
    }
    let camera = camera(random, size, origin, &casters);
    let light = light(random, size, origin, &casters, &camera);
    let mut fit = random.of(fits);
    let parallel = light.position().is_none();
    let takes_cube = match light.kind {
        LightKind::Directional { .. } => false,
        LightKind::Spot { outer, .. } => outer > MAX_SINGLE_MAP_OUTER_ANGLE,
        LightKind::Point { .. } => true,
    };
    let is_whole = |fit: &Fit| matches!(fit, Fit::PlaneOptimal | Fit::OgreUniform);
    let sliced: Vec<_> = fits.iter().copied().filter(|fit| !is_whole(fit)).collect();
    let split = match random.below(4) {
        0 => Split::Single,
        1 if !parallel => Split::Cube,
        _ if takes_cube || is_whole(&fit) => Split::Single,
        _ => Split::Cascades(cascades(random, size, &sliced, parallel)),
    };
    if let Split::Cascades(Cascades { stabilised: true, .. }) = split {
        fit = Fit::Uniform;
    }
    let mut samples: Vec<_> = (0..count)
        .map(|_| {
            let caster = if casters.is_empty() || random.once_in(3) { bounds } else { random.of(&casters) };
            random.point_of(caster)
        })
        .collect();
    if random.once_in(40) {
        samples.clear();
    }
    let plane = match random.below(4) {
        0 => None,
        1 => Some(random.direction().extend(random.between(-1.0, 1.0) * size)),
        _ => Some(DVec3::Y.extend(-f64::from(bounds.min.y))),
    };
    let settings = ShadowSettings {
        fit,
        split,
        fit_from: random.of(&[FitFrom::Frustum, FitFrom::Frustum, FitFrom::Samples]),
        plane: None,
        shadow_distance: random.once_in(3).then(|| (size * random.power(-3.0, 1.0)) as f32),
        store: random.of(&[Store::Depth32, Store::Depth32, Store::Reversed32]),
        bias: random.of(&[Bias::Automatic, Bias::NONE]),
        filter: random.of(&[Filter::Hard, Filter::Bilinear, Filter::Box5]),
        map_size: random.of(&[64, 256, 1024]),
        pancake: random.once_in(2),
        ..ShadowSettings::default()
    };
    Case { light, casters, bounds, camera, aspect: random.between(0.5, 2.5), samples, plane, settings }
}
