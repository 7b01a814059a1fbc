//! The settings of a compact model, derived from the scene, each value with its reason.

use glam::DVec3;
use serde_json::{Map, Value, json};

use super::extent::{self, Extent, cut_out, pixel_footprint};
use super::parts::Part;
use super::space::Space;
use crate::camera::Camera;
use crate::convention::Exponent;
use crate::hash_grid;
use crate::hash_grid::fast::LEVELS;
use crate::scene::Scene;
use crate::training::rate;
use crate::training::watch::constant_error;

/// Optical depth over the width of a cell above which it is opaque.
pub(super) const OPAQUE: f64 = 1.5;

/// The settings that a user may choose.
#[derive(Clone, Debug, Default)]
pub struct Overrides {
    /// Seed of parameters, rays, jitter and occupancy updates.
    pub seed: u64,
    /// Samples across the box (`--samples`).
    pub samples: Option<usize>,
    /// Rays per step, fixed (`--rays`); by default as many as fill a batch of samples.
    pub rays: Option<usize>,
    /// Learning rate of the grid (`--lr`).
    pub lr: Option<f64>,
    /// The part of space that the model holds (`--space`).
    pub extent: Extent,
    /// Parts to leave out (`--without`).
    pub without: Vec<Part>,
}

/// All settings of a [`super::CompactModel`].
#[derive(Clone, Debug, PartialEq)]
pub struct CompactSettings {
    /// What is around the box, if anything.
    pub(crate) space: Space,
    /// Lower corner of the box, a cube; in contracted space of the part that isn't.
    pub low: DVec3,
    /// Its edge, scene units.
    pub size: f64,
    /// Where samples start.
    pub near: f64,
    /// Where they end.
    pub far: f64,
    /// The color behind everything.
    pub background: [f64; 3],
    /// Whether pictures with opacity are learned over all backgrounds.
    pub any_background: bool,
    /// Step lengths across the box in the end.
    pub samples: f64,
    /// The same early in training; see [`CompactSettings::samples_at`].
    pub samples_first: f64,
    /// Cells along an edge, level by level.
    pub resolutions: Vec<u32>,
    /// Largest number of table entries of a level.
    pub table: usize,
    /// Cells along an edge of the occupancy grid.
    pub occupancy: usize,
    /// A training ray ends where its transmittance falls below this.
    pub stop: f64,
    /// The same threshold for the rays of a picture.
    pub stop_at_rest: f64,
    /// Samples per step at first; see [`CompactSettings::batch_at`].
    pub batch: usize,
    /// Rays per step, if given.
    pub rays: Option<usize>,
    /// Learning rates of the grid and of the networks at step 1.
    pub lr: [f64; 2],
    /// Factor of the distortion loss; 0 where it is left out.
    pub distortion: f64,
    /// Seed of everything random.
    pub seed: u64,
    /// Whether color depends on the direction.
    pub view_dependent: bool,
    /// Parts that are switched off.
    pub without: Vec<Part>,
    /// The reason of each value.
    pub reasons: Map<String, Value>,
}

/// Step lengths across the box early in training, where the scene has details that ask for more.
const SAMPLES_FIRST: f64 = 128.0;

/// Steps over which samples grow by the square root of 2.
const SAMPLES_GROW: f64 = 2000.0;

/// The step from which on batches grow.
const BATCH_GROWS: f64 = 1000.0;

/// Pixels of a scene from which on a level's table has 2^18 entries: a batch is too small a part of them to spoil what others learned.
const MANY_PIXELS: usize = 8_000_000;

/// The distortion loss' factor, as mip-NeRF 360 has it.
const DISTORTION: f64 = 0.01;

/// The variance of pictures' colors from which on that factor is as it is.
const USUAL: f64 = 0.02;

/// Where the density's exponent is clamped: in the forward pass too.
pub(crate) const EXPONENT: Exponent = Exponent::Clamped;

/// Samples of a picture over those of training, along the same ray.
pub(crate) const AT_REST: f64 = 1.5;

/// Optical depth in opaque cells after which a training ray is ended, if the grid is right: more than the early stop asks for.
/// Where the grid is out of date and light is left, the ray is drawn again in the next step, and then seen to its end.
const PATIENCE: f64 = 8.0;

/// Light that is left where a training ray ends. What lies behind moves no color by an 8-bit step, and its samples are better spent on
/// other rays.
const STOP: f64 = 1.0 / 256.0;

impl CompactSettings {
    /// The settings of a scene.
    pub fn derive(scene: &Scene, overrides: &Overrides) -> CompactSettings {
        let mut reasons = Map::new();
        let mut because = |name: &str, why: String| drop(reasons.insert(name.into(), Value::from(why)));
        let without = |part| overrides.without.contains(&part);
        let or = |part, why: &str| if without(part) { "left out: as asked for" } else { why }.to_string();
        let (space, why) = extent::space(scene, overrides.extent);
        because("space", why);
        let (low, size, why) = extent::cube(scene, space);
        because("box", why);
        let footprint = pixel_footprint(scene);
        let samples = overrides.samples.map_or((size / footprint).clamp(64.0, 1024.0), |n| n as f64);
        let samples_first = if overrides.samples.is_some() || without(Part::CoarseSteps) {
            samples
        } else {
            samples.min(SAMPLES_FIRST)
        };
        because(
            "samples",
            match overrides.samples {
                Some(_) => "given".into(),
                None => format!(
                    "a step is a pixel's footprint {footprint:.4} at the focus, within 64 to 1024 steps"
                ),
            },
        );
        because(
            "samples_at_rest",
            "a picture's samples lie closer than the last step's, 3 for its 2: nearer to the field's own integral".into(),
        );
        let finest = ((2.0 * size / footprint).clamp(64.0, 2048.0) * space.width()) as u32;
        because(
            "resolutions",
            format!(
                "the finest cell is half a pixel's footprint, the coarsest a 16th of the box, {LEVELS} levels of 4 features fill one cache line and a half"
            ),
        );
        let pixels: usize = scene.train.iter().map(|frame| frame.camera.width * frame.camera.height).sum();
        let table = if pixels < MANY_PIXELS { 1 << 17 } else { 1 << 18 };
        because(
            "table",
            format!(
                "{table} entries of 16 bytes for {:.1} million pixels: 2^17, which fit into 2 MiB of cache, below 8 million, else 2^18",
                pixels as f64 / 1e6
            ),
        );
        because("stop", or(Part::Stop, "a training ray's color moves by less than an 8-bit step"));
        because(
            "stop_at_rest",
            or(Part::Stop, "a picture's color moves by at most 1e-6: so near to f64 at the same samples"),
        );
        because(
            "patience",
            or(
                Part::Patience,
                "a training ray ends after so many samples in opaque cells, those of optical depth 1.5: 8 of it in all",
            ),
        );
        because(
            "occupancy",
            or(
                Part::Occupancy,
                "128 cells an edge, bits that fit into a core's L2 cache; occupied from an optical depth of 0.015 a cell on, or from the mean on where that is less, whatever the samples",
            ),
        );
        because(
            "density_exponent",
            "clamped to [-15, 15] forward too, a convention of trunc_exp: the vector code's exponential has no branch for overflow, and \
             a density beyond lets no light through, or all of it"
                .into(),
        );
        because(
            "coarse_steps",
            or(
                Part::CoarseSteps,
                "0.3 of the samples at first, 128 across the box from step 300 on, then as sqrt(1 + step / 2000), up to a pixel's footprint: coarse steps leave a batch room for more rays",
            ),
        );
        because("coarse_levels", or(Part::CoarseLevels, "4 levels at first, one more every 100 steps"));
        because("lr_half_life", or(Part::Decay, "rates fall by 1 / sqrt(1 + step / 1500)"));
        because(
            "batch",
            or(
                Part::Growth,
                "16,384 samples, from step 1,000 on in proportion to the step, up to 65,536: the noise of small steps averages out of pictures, but each goes through all tables",
            ),
        );
        because(
            "averaging",
            or(
                Part::Averaging,
                "from step 256 on pictures are of the parameters' running mean over the last sixteenth of the steps, which the last step's noise doesn't move",
            ),
        );
        let full = !cut_out(scene);
        let scattered = full && !without(Part::Distortion);
        // The loss beside it goes with the square of the pictures' contrast, so that faint pictures would be all fog.
        let contrast = if scattered { (constant_error(&scene.train, false) / USUAL).min(1.0) } else { 0.0 };
        because(
            "distortion",
            or(
                Part::Distortion,
                if full {
                    "the pictures are full: weights that lie scattered along a ray cost, against floaters before the cameras; less where the pictures are faint"
                } else {
                    "left out: the pictures' borders are background, over which floaters would show"
                },
            ),
        );
        let spread = direction_spread(scene);
        let view_dependent = spread > 10f64.to_radians() && !without(Part::ViewDependence);
        because(
            "view_dependence",
            format!(
                "{}: {}the cameras' axes differ by up to {:.0} degrees",
                if view_dependent { "kept" } else { "left out" },
                if without(Part::ViewDependence) { "as asked for; " } else { "" },
                spread.to_degrees()
            ),
        );
        because(
            "lens",
            match scene.train.iter().find_map(|frame| frame.camera.distortion) {
                Some(_) => "undone: the scene has distortion coefficients".into(),
                None => "left out: the scene has no distortion coefficients".to_string(),
            },
        );
        because(
            "any_background",
            or(
                Part::RandomBackgrounds,
                "pictures with opacity are learned over all colors at once, by the loss' mean over them, so that nothing but empty space looks empty and any background can be had later; others over the scene's",
            ),
        );
        because(
            "background_model",
            match space {
                Space::Box => "left out: what lies beyond the box has one color".into(),
                Space::Contracted { .. } => {
                    "left out: the contracted part of space holds the background".into()
                }
            },
        );
        CompactSettings {
            space,
            low,
            size,
            near: scene.near,
            far: extent::far(scene, space),
            background: scene.background,
            any_background: !without(Part::RandomBackgrounds),
            samples,
            samples_first,
            resolutions: hash_grid::resolutions(16 * space.width() as u32, finest, LEVELS),
            table,
            occupancy: 128,
            stop: if without(Part::Stop) { 0.0 } else { STOP },
            stop_at_rest: if without(Part::Stop) { 0.0 } else { 1e-6 },
            batch: 16_384,
            rays: overrides.rays,
            lr: overrides.lr.map_or([2e-2, 1e-2], |lr| [lr, 0.5 * lr]),
            distortion: DISTORTION * contrast,
            seed: overrides.seed,
            view_dependent,
            without: overrides.without.clone(),
            reasons,
        }
    }

    /// Step lengths across the box at a training step: coarse at first, while there are no details yet; from then on details come ever
    /// more slowly, and so do the steps that show them. With fewer samples a ray, a batch has more rays.
    pub fn samples_at(&self, step: u64) -> f64 {
        if self.without.contains(&Part::CoarseSteps) {
            return self.samples;
        }
        let fine = self.samples_first * (1.0 + step as f64 / SAMPLES_GROW).sqrt();
        fine.min(self.samples) * (0.3 + 0.7 * (step as f64 / 300.0).min(1.0))
    }

    /// The same for a picture of the model after that step.
    pub fn samples_at_rest(&self, step: u64) -> f64 {
        AT_REST * self.samples_at(step)
    }

    /// Levels of the hash grid in use at a training step: the coarse ones first, one more every 100 steps.
    pub fn levels_at(&self, step: u64) -> usize {
        if self.without.contains(&Part::CoarseLevels) {
            return LEVELS;
        }
        (4 + step as usize / 100).min(LEVELS)
    }

    /// Samples of a training step: as learning slows down, more samples average out more of their noise, and share the fixed cost of a
    /// step, a pass over all tables. Constant up to step 1,000, then in proportion to it, up to 4 times the first: later, and the fixed cost
    /// takes more than smaller steps learn.
    pub fn batch_at(&self, step: u64) -> usize {
        // A given number of rays stays constant.
        if self.rays.is_some() || self.without.contains(&Part::Growth) {
            return self.batch;
        }
        let growth = (step as f64 / BATCH_GROWS).clamp(1.0, 4.0);
        ((growth * self.batch as f64) as usize).next_multiple_of(1024)
    }

    /// Samples in opaque cells after which a ray of a training step is ended: as many as take `PATIENCE`.
    pub fn patience_at(&self, step: u64) -> u32 {
        let off = [Part::Patience, Part::Stop].iter().any(|part| self.without.contains(part));
        let each = OPAQUE * self.occupancy as f64 / (self.space.width() * self.samples_at(step));
        if off { u32::MAX } else { (PATIENCE / each).ceil() as u32 }
    }

    /// The learning rates' factor at a training step.
    pub fn lr_factor(&self, step: u64) -> f64 {
        if self.without.contains(&Part::Decay) { 1.0 } else { rate::falling(step) }
    }

    /// Whether all of space is held, contracted, and not a box alone.
    pub fn contracted(&self) -> bool {
        self.space != Space::Box
    }

    /// Samples of a ray at the most, in the end: across the box, or to where steps even in 1 / distance end.
    pub fn longest_ray(&self) -> f64 {
        match self.space {
            Space::Box => self.samples,
            Space::Contracted { even } => 2.0 * even / self.size * self.samples,
        }
    }

    /// For `run.json`.
    pub fn to_json(&self) -> Map<String, Value> {
        let object = json!({
            "model": "compact", "space": self.space.name(), "box_low": self.low.to_array(), "box_size": self.size, "near": self.near, "far": self.far,
            "background": self.background, "any_background": self.any_background, "samples": self.samples, "samples_first": self.samples_first, "samples_at_rest": AT_REST * self.samples,
            "resolutions": self.resolutions, "table": self.table, "features": hash_grid::fast::FEATURES, "occupancy": self.occupancy, "stop": self.stop, "stop_at_rest": self.stop_at_rest,
            "patience": Some(self.patience_at(u64::MAX)).filter(|n| *n < u32::MAX), "batch": self.batch, "batch_grows": BATCH_GROWS, "batch_most": self.batch_at(u64::MAX),
            "rays": self.rays, "lr": self.lr, "lr_half_life": rate::HALF_LIFE, "seed": self.seed,
            "distortion": self.distortion, "view_dependent": self.view_dependent, "density_exponent": EXPONENT, "without": self.without, "reasons": self.reasons,
        });
        let Value::Object(map) = object else { unreachable!("an object literal") };
        map
    }
}

/// The largest angle between two training cameras' axes and the first one's.
fn direction_spread(scene: &Scene) -> f64 {
    let axis = |camera: &Camera| camera.c2w.z_axis.truncate().normalize();
    let first = axis(&scene.train[0].camera);
    scene.train.iter().map(|frame| axis(&frame.camera).angle_between(first)).fold(0.0, f64::max)
}
