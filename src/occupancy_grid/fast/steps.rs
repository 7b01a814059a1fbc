//! The inputs and outputs of a traversal: rays, and their samples in occupied cells.

/// A ray's samples: the points t = (k + u) step, t in [near, far), in units of the box.
#[derive(Clone, Copy, Debug)]
pub struct MarchRay {
    /// Origin.
    pub o: [f32; 3],
    /// Direction.
    pub d: [f32; 3],
    /// Where samples start.
    pub near: f32,
    /// Where they end.
    pub far: f32,
    /// Jitter in [0, 1).
    pub u: f32,
    /// The number of samples in opaque cells after which the ray ends, at least 1.
    pub patience: u32,
}

impl MarchRay {
    /// Sample k, clamped to the box.
    #[inline(always)]
    pub fn at(&self, k: f32, step: f32) -> [f32; 3] {
        let t = (k + self.u) * step;
        let [o, d] = [self.o, self.d];
        let x = [o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]];
        [x[0].clamp(0.0, 1.0), x[1].clamp(0.0, 1.0), x[2].clamp(0.0, 1.0)]
    }
}

/// The samples of rays that lie in occupied cells; buffers that are used again.
#[derive(Default, Debug)]
pub struct Steps {
    /// The range of a ray's samples in `k`.
    pub(super) capacity: usize,
    pub(super) k: Vec<f32>,
    pub(super) count: Vec<usize>,
    pub(super) patience: Vec<u32>,
}

impl Steps {
    /// k of a ray's samples, ascending.
    #[inline(always)]
    pub fn of(&self, ray: usize) -> &[f32] {
        &self.k[ray * self.capacity..][..self.count[ray]]
    }

    /// Whether the ray ran out of patience: there may be more samples after the last one.
    #[inline(always)]
    pub fn cut(&self, ray: usize) -> bool {
        self.patience[ray] == 0
    }

    /// No samples yet; sized for the longest rays.
    #[inline(always)]
    pub(super) fn begin(&mut self, march_rays: &[MarchRay], step: f32) {
        let longest = |march_ray: &MarchRay| (march_ray.far - march_ray.near) / step;
        self.begin_with(march_rays, march_rays.iter().map(longest).fold(0.0, f32::max));
    }

    /// The same where the longest ray has so many samples.
    pub(super) fn begin_with(&mut self, march_rays: &[MarchRay], longest: f32) {
        // One more for the rounding of each end, and one spare slot after the last.
        self.capacity = longest as usize + 3;
        let places = march_rays.len() * self.capacity;
        assert!(
            places < u32::MAX as usize,
            "{} rays of {longest} steps: at most 2^32 at once",
            march_rays.len()
        );
        // The last slot is for lanes that no ray has entered yet.
        if self.k.len() <= places {
            self.k.resize(places + 1, 0.0);
        }
        self.count.clear();
        self.count.resize(march_rays.len(), 0);
        self.patience.clear();
        self.patience.extend(march_rays.iter().map(|march_ray| march_ray.patience));
    }

    /// A sample of a ray, the next one.
    #[inline(always)]
    pub(super) fn push(&mut self, ray: usize, k: f32, opaque: bool) {
        self.k[ray * self.capacity + self.count[ray]] = k;
        self.count[ray] += 1;
        self.patience[ray] -= u32::from(opaque);
    }
}
