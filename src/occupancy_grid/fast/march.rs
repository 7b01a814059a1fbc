//! The traversal in f32: sixteen rays walk side by side, a lane each, over bits, past empty cells, bricks and blocks.
//!
//! A ray alone waits: each step needs the bit that the step before led to. Sixteen rays wait together, in vector registers.

use super::{BLOCK, BRICK, Occupancy};

/// Rays that walk together.
pub const LANES: usize = 16;

/// A ray's samples: the points t = (k + u) step, t in [near, far), in units of the box.
#[derive(Clone, Copy, Debug)]
pub struct Way {
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
    /// The ray ends behind so many samples in opaque cells, at least 1.
    pub patience: u32,
}

impl Way {
    /// Sample k, clamped to the box.
    #[inline(always)]
    pub fn at(&self, k: f32, step: f32) -> [f32; 3] {
        let t = (k + self.u) * step;
        let [o, d] = [self.o, self.d];
        let x = [o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]];
        [x[0].clamp(0.0, 1.0), x[1].clamp(0.0, 1.0), x[2].clamp(0.0, 1.0)]
    }
}

/// The samples of up to 16 rays that lie in occupied cells; buffers that are used again.
#[derive(Default)]
pub struct Steps {
    room: usize,
    k: Vec<f32>,
    count: [usize; LANES],
    patience: [u32; LANES],
}

impl Steps {
    /// k of a ray's samples, ascending.
    #[inline(always)]
    pub fn of(&self, lane: usize) -> &[f32] {
        &self.k[lane * self.room..][..self.count[lane]]
    }

    /// Whether the ray ran out of patience: there may be more samples behind the last one.
    #[inline(always)]
    pub fn cut(&self, lane: usize) -> bool {
        self.patience[lane] == 0
    }
}

/// One number a lane.
type Lanes = [f32; LANES];
/// The same of whole numbers.
type Whole = [u32; LANES];

/// The whole part of each of x, clamped to [0, top]; NaN becomes 0. Without conversions that saturate, which aren't vector code.
#[inline(always)]
fn whole(x: &Lanes, top: f32) -> Whole {
    // 2^23: from here on a float's low bits are its whole part.
    const MAGIC: f32 = 8_388_608.0;
    let mut out = [0; LANES];
    for i in 0..LANES {
        let x = if x[i] > 0.0 { x[i] } else { 0.0 };
        let x = if x < top { x } else { top };
        out[i] = (x.trunc() + MAGIC).to_bits() & 0x7f_ffff;
    }
    out
}

/// Where cells, or bricks (shift 2) or blocks (shift 4) of them, stand among `side`^3 of their kind.
#[inline(always)]
fn place([x, y, z]: &[Whole; 3], shift: u32, side: u32) -> Whole {
    let mut out = [0; LANES];
    for i in 0..LANES {
        out[i] = ((z[i] >> shift) * side + (y[i] >> shift)) * side + (x[i] >> shift);
    }
    out
}

/// The bit of a cell in its brick's word, or of a brick (shift 2) in its block's.
#[inline(always)]
fn bit([x, y, z]: &[Whole; 3], shift: u32) -> Whole {
    let mut out = [0; LANES];
    for i in 0..LANES {
        out[i] = (z[i] >> shift & 3) << 4 | (y[i] >> shift & 3) << 2 | (x[i] >> shift & 3);
    }
    out
}

/// Rays in units of cells and steps.
struct Walk {
    start: [Lanes; 3],
    speed: [Lanes; 3],
    inverse: [Lanes; 3],
    k: Lanes,
    last: Lanes,
}

impl Occupancy {
    /// Walks up to 16 rays.
    #[inline(always)]
    pub fn march(&self, ways: &[Way], step: f32, steps: &mut Steps) {
        let r = self.resolution as f32;
        let (zero, never) = ([0f32; LANES], [f32::NEG_INFINITY; LANES]);
        let mut walk = Walk { start: [zero; 3], speed: [zero; 3], inverse: [zero; 3], k: zero, last: never };
        let mut room = 0f32;
        for (i, way) in ways.iter().enumerate() {
            for a in 0..3 {
                let speed = way.d[a] * step * r;
                walk.start[a][i] = (way.o[a] + way.u * step * way.d[a]) * r;
                walk.speed[a][i] = speed;
                walk.inverse[a][i] = if speed == 0.0 { f32::MAX } else { 1.0 / speed };
            }
            (walk.k[i], walk.last[i]) = ((way.near / step - way.u).ceil(), way.far / step - way.u);
            steps.patience[i] = way.patience;
            room = room.max(walk.last[i] - walk.k[i]);
        }
        // One more for rounding, one to write to behind the last.
        steps.room = room as usize + 3;
        if steps.k.len() < LANES * steps.room {
            steps.k.resize(LANES * steps.room, 0.0);
        }
        steps.count = [0; LANES];
        loop {
            let mut walking = 0;
            for i in 0..LANES {
                walking |= u32::from(walk.k[i] < walk.last[i]);
            }
            if walking == 0 {
                break;
            }
            self.advance(&mut walk, steps);
        }
    }

    /// Every lane by one lattice point or, out of an empty cell, brick or block, to the first behind it.
    #[inline(always)]
    fn advance(&self, walk: &mut Walk, steps: &mut Steps) {
        let (top, side) = ((self.resolution - 1) as f32, self.resolution as u32);
        let mut cell = [[0; LANES]; 3];
        for a in 0..3 {
            let mut x = [0f32; LANES];
            for i in 0..LANES {
                x[i] = walk.start[a][i] + walk.k[i] * walk.speed[a][i];
            }
            cell[a] = whole(&x, top);
        }
        let (block, brick) = (place(&cell, 4, side >> 4), place(&cell, 2, side >> 2));
        let (brick_bit, cell_bit) = (bit(&cell, 2), bit(&cell, 0));
        let (mut occupied, mut opaque, mut edge) = ([0; LANES], [0; LANES], [1; LANES]);
        for i in 0..LANES {
            let bricks = self.blocks[block[i] as usize];
            let any = bricks >> brick_bit[i] & 1;
            // Word 0 where there is nothing to read.
            let [first, second] = self.words[any as usize * brick[i] as usize];
            occupied[i] = (any & first >> cell_bit[i]) as u32;
            opaque[i] = (any & second >> cell_bit[i]) as u32;
            edge[i] = if bricks == 0 { BLOCK as u32 } else { [BRICK as u32, 1][any as usize] };
        }
        let mut exit = [f32::INFINITY; LANES];
        for a in 0..3 {
            for i in 0..LANES {
                // The face ahead.
                let low = cell[a][i] & edge[i].wrapping_neg();
                let face = if walk.speed[a][i] >= 0.0 { low + edge[i] } else { low };
                let at = (face as i32 as f32 - walk.start[a][i]) * walk.inverse[a][i];
                exit[i] = if at < exit[i] { at } else { exit[i] };
            }
        }
        let mut here = [0; LANES];
        for i in 0..LANES {
            here[i] = occupied[i] & u32::from(walk.k[i] < walk.last[i]);
            steps.patience[i] -= here[i] & opaque[i];
        }
        for i in 0..LANES {
            steps.k[i * steps.room + steps.count[i]] = walk.k[i];
            steps.count[i] += here[i] as usize;
        }
        for i in 0..LANES {
            let (next, far) = (walk.k[i] + 1.0, exit[i].ceil());
            let jump = if occupied[i] == 0 && far > next { far } else { next };
            // From 2^24 on k + 1 is k: so far from the box there are no samples to tell apart.
            let over = steps.patience[i] == 0 || jump == walk.k[i];
            walk.k[i] = if over { f32::INFINITY } else { jump };
        }
    }
}
