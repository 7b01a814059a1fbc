//! The traversal in f32: sixteen rays walk side by side, a lane each, over bits, past empty cells, bricks and blocks.
//!
//! A ray alone waits: each step needs the bit that the step before led to. Sixteen rays wait together, in vector registers; a lane
//! whose ray has ended takes the next.

use super::{BLOCK, BRICK, Occupancy};

/// Rays that walk together.
const LANES: usize = 16;

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

/// The samples of rays that lie in occupied cells; buffers that are used again.
#[derive(Default)]
pub struct Steps {
    room: usize,
    k: Vec<f32>,
    count: Vec<usize>,
    patience: Vec<u32>,
}

impl Steps {
    /// k of a ray's samples, ascending.
    #[inline(always)]
    pub fn of(&self, ray: usize) -> &[f32] {
        &self.k[ray * self.room..][..self.count[ray]]
    }

    /// Whether the ray ran out of patience: there may be more samples behind the last one.
    #[inline(always)]
    pub fn cut(&self, ray: usize) -> bool {
        self.patience[ray] == 0
    }

    /// No samples yet; room for the longest way.
    #[inline(always)]
    fn begin(&mut self, ways: &[Way], step: f32) {
        let longest = ways.iter().map(|way| (way.far - way.near) / step).fold(0.0, f32::max);
        // One more for each end's rounding, one to write to behind the last.
        self.room = longest as usize + 3;
        if self.k.len() < ways.len() * self.room {
            self.k.resize(ways.len() * self.room, 0.0);
        }
        self.count.clear();
        self.count.resize(ways.len(), 0);
        self.patience.clear();
        self.patience.extend(ways.iter().map(|way| way.patience));
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

/// The rays that walk, in units of cells and steps.
struct Walk {
    start: [Lanes; 3],
    speed: [Lanes; 3],
    inverse: [Lanes; 3],
    k: Lanes,
    last: Lanes,
    patience: Whole,
    /// Where the next sample goes among all rays' k.
    next: Whole,
    /// Which ray walks in the lane.
    ray: [usize; LANES],
    /// The lanes in which one walks or has just ended, a bit each.
    held: u32,
}

impl Walk {
    fn new() -> Self {
        let (lanes, whole) = ([0f32; LANES], [0; LANES]);
        Walk {
            start: [lanes; 3],
            speed: [lanes; 3],
            inverse: [lanes; 3],
            k: lanes,
            last: lanes,
            patience: whole,
            next: whole,
            ray: [0; LANES],
            held: 0,
        }
    }

    /// The lanes in which no ray walks, a bit each.
    #[inline(always)]
    fn idle(&self) -> u32 {
        let mut walking = 0;
        for i in 0..LANES {
            walking |= u32::from(self.k[i] < self.last[i]) << i;
        }
        walking ^ ((1 << LANES) - 1)
    }

    /// Notes what the lane's ray has found, if it has one.
    #[inline(always)]
    fn leave(&mut self, lane: usize, steps: &mut Steps) {
        if self.held >> lane & 1 == 1 {
            let ray = self.ray[lane];
            steps.count[ray] = self.next[lane] as usize - ray * steps.room;
            steps.patience[ray] = self.patience[lane];
            self.held ^= 1 << lane;
        }
    }

    /// Puts a ray into a lane.
    #[inline(always)]
    fn enter(&mut self, lane: usize, (ray, way): (usize, &Way), step: f32, cells: f32, room: usize) {
        for a in 0..3 {
            let speed = way.d[a] * step * cells;
            self.start[a][lane] = (way.o[a] + way.u * step * way.d[a]) * cells;
            self.speed[a][lane] = speed;
            self.inverse[a][lane] = if speed == 0.0 { f32::MAX } else { 1.0 / speed };
        }
        (self.k[lane], self.last[lane]) = ((way.near / step - way.u).ceil(), way.far / step - way.u);
        self.patience[lane] = way.patience;
        self.next[lane] = (ray * room) as u32;
        self.ray[lane] = ray;
        self.held |= 1 << lane;
    }
}

impl Occupancy {
    /// Walks rays; where one has ended, the next that meets the box takes its lane.
    #[inline(always)]
    pub fn march(&self, ways: &[Way], step: f32, steps: &mut Steps) {
        steps.begin(ways, step);
        let mut walk = Walk::new();
        let mut waiting = ways.iter().enumerate().filter(|(_, way)| way.near < way.far);
        loop {
            let mut idle = walk.idle();
            while idle != 0 {
                let lane = idle.trailing_zeros() as usize;
                idle &= idle - 1;
                walk.leave(lane, steps);
                match waiting.next() {
                    Some(way) => walk.enter(lane, way, step, self.resolution as f32, steps.room),
                    None if walk.held == 0 => return,
                    None => {}
                }
            }
            self.advance(&mut walk, &mut steps.k);
        }
    }

    /// Every lane by one lattice point or, out of an empty cell, brick or block, to the first behind it.
    #[inline(always)]
    fn advance(&self, walk: &mut Walk, k: &mut [f32]) {
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
            walk.patience[i] -= here[i] & opaque[i];
        }
        for i in 0..LANES {
            k[walk.next[i] as usize] = walk.k[i];
            walk.next[i] += here[i];
        }
        for i in 0..LANES {
            let (next, far) = (walk.k[i] + 1.0, exit[i].ceil());
            let jump = if occupied[i] == 0 && far > next { far } else { next };
            // From 2^24 on k + 1 is k: so far from the box there are no samples to tell apart.
            let over = walk.patience[i] == 0 || jump == walk.k[i];
            walk.k[i] = if over { f32::INFINITY } else { jump };
        }
    }
}
