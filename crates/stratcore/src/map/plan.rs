//! What a map is of, in words that two machines can compare.

use super::digest::{Digest, hex};
use super::region::{Region, Tiling};
use crate::error::StudyError;
use crate::integrand::Integrand as _;
use crate::rng::StreamKey;
use crate::sampler::{CountPolicy, MAX_DIM, Scramble};
use crate::scene::{Channel, Light, Scene};
use crate::study::StudyPlan;
use crate::trace::{TracedScene, Tracer};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// The study of every pixel of a region.
#[derive(Clone)]
pub struct MapPlan {
    /// How each pixel is studied.
    pub study: StudyPlan,
    /// Which pixels.
    pub region: Region,
    /// Which number of their radiance.
    pub channel: Channel,
    /// Compute `random` and `jittered` without trials where a pixel can be resolved
    /// ([`crate::exact`]).
    pub exact: bool,
}

/// Everything that the numbers of a map depend on. Two runs with the same identity have the same
/// tiles, bit for bit, whoever computes them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Identity {
    /// Version of the library that computes.
    pub version: String,
    /// Name of the scene.
    pub scene: String,
    /// Hash of all that the scene holds.
    pub scene_hash: String,
    /// Width and height of the whole picture.
    pub resolution: [u32; 2],
    /// The pixels.
    pub region: Region,
    /// Pixels along the side of a tile.
    pub tile_side: u32,
    /// What is studied of the radiance.
    pub channel: Channel,
    /// How samples are traced.
    pub tracer: Tracer,
    /// Whether variances are computed without trials where that can be done.
    pub exact: bool,
    /// Dimensions of a pixel's integral.
    pub dim: usize,
    /// The samplers, in order.
    pub samplers: Vec<SamplerIdentity>,
    /// Sample counts as asked for.
    pub counts: Vec<u64>,
    /// What to do with a count that a sampler cannot make.
    pub n_policy: CountPolicy,
    /// Independent repeats M.
    pub trials: u32,
    /// Seed of all randomness.
    pub seed: u64,
}

/// A sampler by name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SamplerIdentity {
    /// Its name.
    pub name: String,
    /// Its scramble.
    pub scramble: Scramble,
    /// The counts it uses for [`Identity::counts`].
    pub counts_used: Vec<u64>,
}

impl SamplerIdentity {
    /// Whether it is the sampler of this name, without a scramble.
    pub fn is_plain(&self, name: &str) -> bool {
        self.name == name && self.scramble == Scramble::None
    }

    /// The name, with the scramble after a plus sign where there is one: `sobol+owen-hash`.
    pub fn label(&self) -> String {
        match self.scramble {
            Scramble::None => self.name.clone(),
            scramble => format!("{}+{scramble}", self.name),
        }
    }
}

impl MapPlan {
    /// Pixels along the side of a tile.
    pub const TILE_SIDE: u32 = 32;

    /// The plan's identity for a scene.
    ///
    /// # Errors
    /// What [`StudyPlan::counts_used`] refuses. The region is for the caller to
    /// [check](Region::check).
    pub fn identity(&self, scene: &TracedScene) -> Result<Identity, StudyError> {
        let Self { study, region, channel, exact } = self;
        let dim = scene.pixel([region.x0, region.y0], *channel).dim();
        let counts_used = study.counts_used(dim)?;
        let samplers = study.samplers.iter().zip(counts_used);
        Ok(Identity {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            scene: scene.scene().name.clone(),
            scene_hash: hex(scene_hash(scene.scene())),
            resolution: scene.scene().camera.resolution,
            region: *region,
            tile_side: Self::TILE_SIDE,
            channel: *channel,
            tracer: scene.tracer(),
            exact: *exact,
            dim,
            samplers: samplers
                .map(|(choice, counts_used)| SamplerIdentity {
                    name: choice.sampler.name().to_owned(),
                    scramble: choice.scramble,
                    counts_used,
                })
                .collect(),
            counts: study.counts.clone(),
            n_policy: study.count_policy,
            trials: study.n_trials,
            seed: study.seed,
        })
    }
}

impl Identity {
    /// The tiles of the region.
    pub fn tiling(&self) -> Tiling {
        Tiling { region: self.region, side: self.tile_side }
    }

    /// Rows that are kept of each pixel: one per sampler and count.
    pub fn rows_per_pixel(&self) -> usize {
        self.samplers.len() * self.counts.len()
    }

    /// Samples that are drawn for each pixel.
    pub fn samples_per_pixel(&self) -> u64 {
        let counts = self.samplers.iter().flat_map(|sampler| &sampler.counts_used);
        counts.fold(0, |sum: u64, n| sum.saturating_add(*n)).saturating_mul(self.trials.into())
    }

    /// A hash of the whole, as 32 hexadecimal digits: the same on every machine.
    pub fn hash(&self) -> String {
        let mut digest = Digest::new();
        // In the order of the fields above; none of them can fail to be written.
        digest.text(&serde_json::to_string(self).unwrap_or_default());
        hex(digest.finish())
    }

    /// Whether its parts fit together, as those of a plan that was read from a file should.
    pub(super) fn is_sound(&self) -> bool {
        let n_counts = self.counts.len();
        let is_count = |n: &u64| (1..StreamKey::MAX_SAMPLES).contains(n);
        self.tile_side == MapPlan::TILE_SIDE
            && self.resolution.iter().all(|side| *side <= StreamKey::MAX_PIXEL)
            && self.region.check(self.resolution).is_ok()
            && (1..=MAX_DIM).contains(&self.dim)
            && n_counts > 0
            && !self.samplers.is_empty()
            && self.samplers.iter().all(|sampler| {
                sampler.counts_used.len() == n_counts && sampler.counts_used.iter().all(is_count)
            })
    }

    /// What differs between two identities, in words; empty where nothing does.
    pub fn differences(&self, other: &Self) -> String {
        let [ours, theirs] =
            [self, other].map(|plan| serde_json::to_value(plan).unwrap_or_default());
        let Value::Object(ours) = ours else { return String::new() };
        let differing = ours.iter().filter(|(key, value)| theirs[key.as_str()] != **value);
        let words = differing.map(|(key, value)| {
            let (ours, theirs) = (value.to_string(), theirs[key.as_str()].to_string());
            if ours.len() + theirs.len() > 100 {
                format!("{key} differs")
            } else {
                format!("{key} is {theirs}, not {ours}")
            }
        });
        words.collect::<Vec<_>>().join("; ")
    }
}

/// A hash of all that a pixel's radiance depends on: names and notes are left out.
fn scene_hash(scene: &Scene) -> u128 {
    let Scene {
        name: _,
        camera,
        mesh,
        materials,
        light,
        distribution,
        filter,
        ambient,
        background,
        files: _,
        notes: _,
    } = scene;
    let mut digest = Digest::new();
    digest.numbers([camera.eye, camera.look_at, camera.up].iter().flat_map(|v| v.to_array()));
    digest.numbers([camera.fov_y]);
    camera.resolution.iter().for_each(|n| digest.word((*n).into()));
    // Lengths come first, so that no two lists run into one another.
    digest.word(mesh.positions.len() as u64);
    digest.numbers(mesh.positions.iter().flat_map(|v| v.to_array()));
    digest.word(mesh.triangles.len() as u64);
    mesh.triangles.iter().flatten().for_each(|i| digest.word((*i).into()));
    mesh.materials.iter().for_each(|i| digest.word((*i).into()));
    digest.word(mesh.corner_normals.is_some().into());
    let normals = mesh.corner_normals.iter().flatten().flatten();
    digest.numbers(normals.flat_map(|v| v.to_array()));
    digest.word(materials.len() as u64);
    for material in materials {
        digest.numbers([material.kd, material.ke].concat());
        digest.text(&format!("{:?}", material.specular));
    }
    let (kind, numbers) = match light {
        Light::Headlight => (0, Vec::new()),
        Light::Off => (3, Vec::new()),
        Light::Point { position, intensity } => (1, [position.to_array(), *intensity].concat()),
        Light::Directional { towards, irradiance } => {
            (2, [towards.to_array(), *irradiance].concat())
        }
    };
    digest.word(kind);
    digest.numbers(numbers);
    digest.numbers([*ambient, *background].concat());
    // Numbers are written with all their digits.
    digest.text(&format!("{distribution:?} {filter:?}"));
    digest.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Filter, FilterMethod, FilterShape, load};

    fn identity(change: impl FnOnce(&mut MapPlan, &mut Scene)) -> Identity {
        let mut scene = load("edges").unwrap();
        let region = Region { x0: 1, y0: 2, x1: 9, y1: 9 };
        let mut plan = MapPlan {
            study: StudyPlan::paper(),
            region,
            channel: Channel::Luminance,
            exact: false,
        };
        change(&mut plan, &mut scene);
        plan.identity(&TracedScene::new(scene)).unwrap()
    }

    #[test]
    fn whatever_changes_the_numbers_changes_the_hash_and_is_named() {
        let base = identity(|_, _| ());
        assert_eq!(base.hash(), identity(|_, _| ()).hash());
        assert_eq!(base.differences(&base), "");
        type Change = fn(&mut MapPlan, &mut Scene);
        let changes: [(&str, Change); 11] = [
            ("seed", |plan, _| plan.study.seed = 7),
            ("trials", |plan, _| plan.study.n_trials = 51),
            ("counts", |plan, _| plan.study.counts.truncate(9)),
            ("samplers", |plan, _| plan.study.samplers.reverse()),
            ("region", |plan, _| plan.region.x1 = 10),
            ("channel", |plan, _| plan.channel = Channel::R),
            ("exact", |plan, _| plan.exact = true),
            ("scene_hash", |_, scene| scene.mesh.positions[0].x += 0.125),
            ("scene_hash", |_, scene| scene.materials[0].kd[1] += 0.125),
            ("scene_hash", |_, scene| scene.distribution.specular_depth = 1),
            ("scene_hash", |_, scene| {
                scene.filter = Some(Filter::new(FilterShape::Tent, 1.0, FilterMethod::default()));
            }),
        ];
        for (key, change) in changes {
            let other = identity(change);
            assert_ne!(base.hash(), other.hash(), "{key}");
            let words = base.differences(&other);
            assert!(words.contains(key), "{key}: {words}");
        }
    }

    #[test]
    fn a_plan_whose_parts_do_not_fit_is_unsound() {
        let changes: [fn(&mut Identity); 10] = [
            |plan| plan.tile_side = 0,
            |plan| plan.tile_side = u32::MAX,
            |plan| plan.dim = usize::MAX,
            |plan| plan.samplers[0].counts_used[1] = 0,
            |plan| plan.samplers[0].counts_used[1] = u64::MAX,
            |plan| plan.region.x1 = plan.region.x0,
            |plan| plan.resolution[0] = u32::MAX,
            |plan| plan.counts.clear(),
            |plan| plan.samplers.clear(),
            |plan| plan.samplers[1].counts_used.truncate(3),
        ];
        assert!(identity(|_, _| ()).is_sound());
        for change in changes {
            let mut plan = identity(|_, _| ());
            change(&mut plan);
            assert!(!plan.is_sound(), "{plan:?}");
        }
    }

    #[test]
    fn an_identity_is_read_back_as_it_was_written() {
        let base = identity(|_, _| ());
        let text = serde_json::to_string(&base).unwrap();
        assert_eq!(serde_json::from_str::<Identity>(&text).unwrap(), base);
    }
}
