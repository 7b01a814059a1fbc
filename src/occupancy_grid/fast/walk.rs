//! Rays side by side, a lane each, in vectors of the machine's own width: where they are, and how far each goes next.

use pulp::Simd;

use super::steps::{MarchRay, Steps};
use super::{BLOCK, BRICK};
use crate::simd::{CacheAligned, fma};

/// Rays that walk together.
pub(super) const LANES: usize = 16;

/// One number a lane, on a cache line of its own.
type Lanes = CacheAligned<[f32; LANES]>;
/// The same for integers.
type Whole = CacheAligned<[u32; LANES]>;

/// 2^23: a float from here on has its whole part in its low bits.
const MAGIC: f32 = 8_388_608.0;

/// The rays that walk, in units of cells and steps, and what a step reads for them.
pub(super) struct Walk {
    start: [Lanes; 3],
    speed: [Lanes; 3],
    inverse: [Lanes; 3],
    pub k: Lanes,
    last: Lanes,
    patience: Whole,
    /// Where the next sample goes among all rays' k.
    pub next: Whole,
    /// The cell, its brick and its block, and the bits of the cell in the brick and (from bit 8 on) of the brick in the block.
    cell: [Whole; 3],
    pub brick: Whole,
    pub block: Whole,
    pub bits: Whole,
    /// Bit 0: occupied; bit 1: opaque; from bit 2 on the edge of what can be skipped.
    pub state: Whole,
    /// Whether the lane's point is a sample.
    pub here: Whole,
    /// Which ray walks in the lane.
    ray: [usize; LANES],
    /// The lanes that have a ray, even if it has just ended, a bit each.
    pub busy: u32,
}

impl Walk {
    /// No rays yet; `spare` is where lanes without a ray write to.
    pub(super) fn new(spare: usize) -> Self {
        let (lanes, whole) = (CacheAligned([0f32; LANES]), CacheAligned([0; LANES]));
        Walk {
            start: [lanes; 3],
            speed: [lanes; 3],
            inverse: [lanes; 3],
            k: lanes,
            last: lanes,
            patience: whole,
            next: CacheAligned([spare as u32; LANES]),
            cell: [whole; 3],
            brick: whole,
            block: whole,
            bits: whole,
            state: whole,
            here: whole,
            ray: [0; LANES],
            busy: 0,
        }
    }

    /// The lanes without a ray, a bit each.
    #[inline(always)]
    pub(super) fn idle(&self) -> u32 {
        let mut walking = 0;
        for i in 0..LANES {
            walking |= u32::from(self.k.0[i] < self.last.0[i]) << i;
        }
        walking ^ ((1 << LANES) - 1)
    }

    /// Stores the samples of the lane's ray, if it has one.
    #[inline(always)]
    pub(super) fn leave(&mut self, lane: usize, steps: &mut Steps) {
        if self.busy >> lane & 1 == 1 {
            let ray = self.ray[lane];
            steps.count[ray] = self.next.0[lane] as usize - ray * steps.capacity;
            steps.patience[ray] = self.patience.0[lane];
            self.busy ^= 1 << lane;
        }
    }

    /// Puts a ray into a lane.
    #[inline(always)]
    pub(super) fn enter(
        &mut self,
        lane: usize,
        (ray, march_ray): (usize, &MarchRay),
        step: f32,
        cells: f32,
        capacity: usize,
    ) {
        for a in 0..3 {
            let speed = march_ray.d[a] * step * cells;
            self.start[a].0[lane] = (march_ray.o[a] + march_ray.u * step * march_ray.d[a]) * cells;
            self.speed[a].0[lane] = speed;
            self.inverse[a].0[lane] = if speed == 0.0 { f32::MAX } else { 1.0 / speed };
        }
        (self.k.0[lane], self.last.0[lane]) =
            ((march_ray.near / step - march_ray.u).ceil(), march_ray.far / step - march_ray.u);
        self.patience.0[lane] = march_ray.patience;
        self.next.0[lane] = (ray * capacity) as u32;
        self.ray[lane] = ray;
        self.busy |= 1 << lane;
    }

    /// Where the rays are: cells, bricks, blocks and their bits.
    #[inline(always)]
    pub(super) fn locate<S: Simd>(&mut self, s: S, resolution: usize) {
        for v in 0..LANES / S::F32_LANES {
            let k = floats::<S>(&self.k)[v];
            let none = [s.splat_u32s(0); 3];
            let (mut cell, mut brick, mut block) = (none, none, none);
            for a in 0..3 {
                let (start, speed) = (floats::<S>(&self.start[a])[v], floats::<S>(&self.speed[a])[v]);
                cell[a] = whole(s, fma(s, k, speed, start), (resolution - 1) as f32);
                brick[a] = s.wrapping_dyn_shr_u32s(cell[a], s.splat_u32s(2));
                block[a] = s.wrapping_dyn_shr_u32s(cell[a], s.splat_u32s(4));
                numbers_mut::<S>(&mut self.cell[a])[v] = cell[a];
            }
            numbers_mut::<S>(&mut self.brick)[v] = place(s, brick, resolution / BRICK);
            numbers_mut::<S>(&mut self.block)[v] = place(s, block, resolution / BLOCK);
            let of_brick = s.wrapping_dyn_shl_u32s(bit(s, brick), s.splat_u32s(8));
            numbers_mut::<S>(&mut self.bits)[v] = s.or_u32s(bit(s, cell), of_brick);
        }
    }

    /// Finds which of the points are samples, and updates patience; returns whether any is.
    #[inline(always)]
    pub(super) fn judge<S: Simd>(&mut self, s: S) -> bool {
        let (one, mut any) = (s.splat_u32s(1), false);
        for v in 0..LANES / S::F32_LANES {
            let walks = s.less_than_f32s(floats::<S>(&self.k)[v], floats::<S>(&self.last)[v]);
            let state = numbers::<S>(&self.state)[v];
            let occupied = s.equal_u32s(s.and_u32s(state, one), one);
            let here = s.and_m32s(walks, occupied);
            any |= s.first_true_m32s(here) < S::F32_LANES;
            let here = s.select_u32s(here, one, s.splat_u32s(0));
            let opaque = s.and_u32s(here, s.wrapping_dyn_shr_u32s(state, one));
            let patience = &mut numbers_mut::<S>(&mut self.patience)[v];
            *patience = s.sub_u32s(*patience, opaque);
            numbers_mut::<S>(&mut self.here)[v] = here;
        }
        any
    }

    /// To the next lattice point or, out of an empty cell, brick or block, to the first after it. Out of patience: to the end.
    #[inline(always)]
    pub(super) fn advance<S: Simd>(&mut self, s: S) {
        let (zero, one) = (s.splat_u32s(0), s.splat_u32s(1));
        let never = s.splat_f32s(f32::INFINITY);
        for v in 0..LANES / S::F32_LANES {
            let state = numbers::<S>(&self.state)[v];
            let edge = s.wrapping_dyn_shr_u32s(state, s.splat_u32s(2));
            let mut exit = never;
            for a in 0..3 {
                let (start, speed) = (floats::<S>(&self.start[a])[v], floats::<S>(&self.speed[a])[v]);
                let inverse = floats::<S>(&self.inverse[a])[v];
                // The face ahead.
                let low = s.and_u32s(numbers::<S>(&self.cell[a])[v], s.sub_u32s(zero, edge));
                let up = s.greater_than_or_equal_f32s(speed, s.splat_f32s(0.0));
                let face = s.select_u32s(up, s.add_u32s(low, edge), low);
                let face = s.or_u32s(face, s.splat_u32s(MAGIC.to_bits()));
                let face = s.sub_f32s(s.transmute_f32s_u32s(face), s.splat_f32s(MAGIC));
                exit = s.min_f32s(s.mul_f32s(s.sub_f32s(face, start), inverse), exit);
            }
            let k = &mut floats_mut::<S>(&mut self.k)[v];
            let (next, far) = (s.add_f32s(*k, s.splat_f32s(1.0)), ceil(s, exit));
            let empty = s.equal_u32s(s.and_u32s(state, one), zero);
            let skips = s.and_m32s(empty, s.greater_than_f32s(far, next));
            let jump = s.select_f32s(skips, far, next);
            // From 2^24 on k + 1 is k in f32: that far out, samples can't be told apart.
            let stuck = s.equal_f32s(jump, *k);
            let over = s.or_m32s(s.equal_u32s(numbers::<S>(&self.patience)[v], zero), stuck);
            *k = s.select_f32s(over, never, jump);
        }
    }
}

#[inline(always)]
fn floats<S: Simd>(lanes: &Lanes) -> &[S::f32s] {
    S::as_simd_f32s(&lanes.0).0
}

#[inline(always)]
fn floats_mut<S: Simd>(lanes: &mut Lanes) -> &mut [S::f32s] {
    S::as_mut_simd_f32s(&mut lanes.0).0
}

#[inline(always)]
fn numbers<S: Simd>(lanes: &Whole) -> &[S::u32s] {
    S::as_simd_u32s(&lanes.0).0
}

#[inline(always)]
fn numbers_mut<S: Simd>(lanes: &mut Whole) -> &mut [S::u32s] {
    S::as_mut_simd_u32s(&mut lanes.0).0
}

/// The whole part of each of x, clamped to [0, top]; NaN becomes 0.
#[inline(always)]
fn whole<S: Simd>(s: S, x: S::f32s, top: f32) -> S::u32s {
    let (zero, one, magic) = (s.splat_f32s(0.0), s.splat_f32s(1.0), s.splat_f32s(MAGIC));
    // A comparison, not a maximum, whose treatment of NaN depends on the machine.
    let x = s.min_f32s(s.select_f32s(s.greater_than_f32s(x, zero), x, zero), s.splat_f32s(top));
    let nearest = s.add_f32s(x, magic);
    let above = s.greater_than_f32s(s.sub_f32s(nearest, magic), x);
    let below = s.sub_f32s(nearest, s.select_f32s(above, one, zero));
    s.and_u32s(s.transmute_u32s_f32s(below), s.splat_u32s(0x7f_ffff))
}

/// The index of cells, bricks or blocks among `side`^3 of them.
#[inline(always)]
fn place<S: Simd>(s: S, [x, y, z]: [S::u32s; 3], side: usize) -> S::u32s {
    let side = s.splat_u32s(side as u32);
    s.add_u32s(s.mul_u32s(s.add_u32s(s.mul_u32s(z, side), y), side), x)
}

/// The bit of a cell in its brick's word, or of a brick in its block's: two bits of each coordinate.
#[inline(always)]
fn bit<S: Simd>(s: S, [x, y, z]: [S::u32s; 3]) -> S::u32s {
    let low = s.splat_u32s(3);
    let y = s.wrapping_dyn_shl_u32s(s.and_u32s(y, low), s.splat_u32s(2));
    let z = s.wrapping_dyn_shl_u32s(s.and_u32s(z, low), s.splat_u32s(4));
    s.or_u32s(s.and_u32s(x, low), s.or_u32s(y, z))
}

/// x rounded up to a whole number for |x| < 2^22, at most one more beyond; infinity stays.
#[inline(always)]
fn ceil<S: Simd>(s: S, x: S::f32s) -> S::f32s {
    let magic = s.splat_f32s(1.5 * MAGIC);
    let nearest = s.sub_f32s(s.add_f32s(x, magic), magic);
    let up = s.add_f32s(nearest, s.splat_f32s(1.0));
    s.select_f32s(s.less_than_f32s(nearest, x), up, nearest)
}
