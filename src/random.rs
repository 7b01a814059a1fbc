//! Counter-based random numbers: any draw can be computed without the ones before it, so threads and chunks change nothing.
//!
//! Philox4x64-10 (Salmon, Moraes, Dror, Shaw: "Parallel random numbers: as easy as 1, 2, 3", SC 2011), word for word
//! `numpy.random.Philox`: draw n of stream `(purpose, step, ray)` is output n of
//! `numpy.random.Generator(Philox(key=[seed, purpose], counter=[0, ray, step, 0])).random()`.

/// What a draw is for. Streams of different purposes never overlap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u64)]
pub enum Purpose {
    /// Initial weights and biases.
    Parameters = 1,
    /// Which image and pixel a training ray goes through.
    Rays = 2,
    /// Jitter of the samples along a ray.
    Samples = 3,
    /// The pixels of a picture that a 2D step uses.
    Pixels = 4,
    /// Occupancy grid updates.
    Occupancy = 5,
    /// The seeded pixels of a quick validation.
    Probe = 6,
    /// Seeded test cases.
    Cases = 7,
    /// Hash table initialization.
    HashTable = 8,
}

/// The generator's key: a run's seed and the purpose of the draws.
#[derive(Clone, Copy, Debug)]
pub struct Key([u64; 2]);

impl Key {
    /// The key of `purpose` in a run with `seed`.
    pub fn new(seed: u64, purpose: Purpose) -> Self {
        Key([seed, purpose as u64])
    }

    /// 64 random bits: draw `sample` of `ray` in `step`.
    pub fn bits(&self, step: u64, ray: u64, sample: u64) -> u64 {
        // numpy advances the counter before its first block, hence the + 1.
        philox([sample / 4 + 1, ray, step, 0], self.0)[(sample % 4) as usize]
    }

    /// A number in [0, 1), a multiple of 2^-53: draw `sample` of `ray` in `step`.
    ///
    /// ```
    /// use nerf_oracle::random::{Key, Purpose};
    /// let key = Key::new(0, Purpose::Parameters);
    /// assert_eq!(key.uniform(0, 0, 3), key.uniform(0, 0, 3));
    /// assert_ne!(key.uniform(0, 0, 3), key.uniform(0, 1, 3));
    /// ```
    pub fn uniform(&self, step: u64, ray: u64, sample: u64) -> f64 {
        (self.bits(step, ray, sample) >> 11) as f64 * crate::math::power_of_two(-53)
    }

    /// The first `count` numbers of `ray` in `step`, four to a block.
    pub fn uniforms(&self, step: u64, ray: u64, count: usize) -> Vec<f64> {
        (0..count.div_ceil(4) as u64)
            .flat_map(|block| philox([block + 1, ray, step, 0], self.0))
            .take(count)
            .map(|bits| (bits >> 11) as f64 * crate::math::power_of_two(-53))
            .collect()
    }

    /// The first four numbers of `ray` in `step`: one block.
    pub fn four(&self, step: u64, ray: u64) -> [f64; 4] {
        philox([1, ray, step, 0], self.0).map(|bits| (bits >> 11) as f64 * crate::math::power_of_two(-53))
    }

    /// A whole number in [0, n): the high word of a 64 x 64 bit product. Its bias is below n / 2^64.
    pub fn below(&self, n: u64, step: u64, ray: u64, sample: u64) -> u64 {
        ((u128::from(self.bits(step, ray, sample)) * u128::from(n)) >> 64) as u64
    }
}

/// Ten rounds of Philox4x64 on one 256-bit counter.
pub fn philox(counter: [u64; 4], key: [u64; 2]) -> [u64; 4] {
    const MULTIPLIERS: [u64; 2] = [0xD2E7_470E_E14C_6C93, 0xCA5A_8263_9512_1157];
    const WEYL: [u64; 2] = [0x9E37_79B9_7F4A_7C15, 0xBB67_AE85_84CA_A73B];
    let (mut c, mut k) = (counter, key);
    for _ in 0..10 {
        let p0 = u128::from(MULTIPLIERS[0]) * u128::from(c[0]);
        let p1 = u128::from(MULTIPLIERS[1]) * u128::from(c[2]);
        c = [(p1 >> 64) as u64 ^ c[1] ^ k[0], p1 as u64, (p0 >> 64) as u64 ^ c[3] ^ k[1], p0 as u64];
        k = [k[0].wrapping_add(WEYL[0]), k[1].wrapping_add(WEYL[1])];
    }
    c
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Printed by `numpy.random.Philox(key=[7, 3], counter=[0, 5, 2, 0])`, numpy 2.2: `random_raw(5)` and `random(6)`.
    #[test]
    fn equals_numpy() {
        let words = [0xcbd7a611c9abc8ec, 0xb9719a6f3a33e058, 0xad92a284fb236077, 0xa642ab82ca657cba];
        assert_eq!(philox([1, 5, 2, 0], [7, 3]), words);
        let key = Key::new(7, Purpose::Samples);
        assert_eq!(key.bits(2, 5, 4), 0x6e4cfcd233574dde);
        assert_eq!(key.uniform(2, 5, 0).to_bits(), 0x3fe9_7af4_c239_3579);
        assert_eq!(key.uniform(2, 5, 5).to_bits(), 0x3fd0_637f_707c_98d2);
        let six: Vec<f64> = (0..6).map(|n| key.uniform(2, 5, n)).collect();
        assert_eq!(key.uniforms(2, 5, 6), six);
        assert_eq!(key.four(2, 5)[..], six[..4]);
    }

    #[test]
    fn below_reaches_every_value_evenly() {
        let key = Key::new(1, Purpose::Rays);
        let mut seen = [0; 3];
        for ray in 0..3000 {
            seen[key.below(3, 0, ray, 0) as usize] += 1;
        }
        // Four standard deviations of a binomial with n = 3000, p = 1/3.
        assert!(seen.iter().all(|&n| (900..1104).contains(&n)), "{seen:?}");
    }
}
