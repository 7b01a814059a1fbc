//! Recipes: arrays of which every entry is an exact function of one word of the generator, so that every language makes the same bits and
//! nobody needs a file of gigabytes.
//!
//! Word n of an array is output n of Philox4x64-10 with that array's key: `numpy.random.Philox(key=key).random_raw()`. Everything behind
//! that is shifts, remainders, sums and powers of two, none of which rounds.

use std::ops::Range;

use super::arithmetic::Dtype;
use crate::math::power_of_two;
use crate::parallel;
use crate::random::{Purpose, philox};

/// What the entries of an array are. `w` is an entry's word, `b` the significant bits of its type; `/` drops the remainder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Recipe {
    /// The same number everywhere.
    Constant(f64),
    /// (w >> (64 - b)) 2^-b: in [0, 1).
    Unit,
    /// 2^(lowest + (w mod 256) mod binades) (1 + (w >> (65 - b)) 2^(1 - b)), every bit of the type in use; below 0 where `signed` and
    /// bit 8 is set; 0 where (w >> 9) mod 8 < empty.
    Float {
        /// The smallest exponent.
        lowest: i32,
        /// How many of them.
        binades: u64,
        /// Whether both signs are there.
        signed: bool,
        /// Eighths of the entries that are 0.
        empty: u64,
    },
    /// (i + f) 2^-cells for place i along the last axis, f = (w >> (76 - b)) 2^(11 - b) in [0, 1/2): ascending, for i up to 2047. f is 0
    /// in types of 12 bits and less.
    Ascending {
        /// Of 2^cells cells.
        cells: i32,
    },
    /// Entry n is n / each.
    Each(usize),
    /// Entry n is that of law n mod their number, none of them a running one: columns that differ, or an array of a few numbers.
    Cycle(&'static [Recipe]),
    /// 0, then running sums of lengths, (w >> 33) mod (most + 1) each, the word of a length being that of the entry before.
    Offsets {
        /// The longest.
        most: u64,
    },
}

/// Entries that one thread makes at a time.
const TASK: usize = 1 << 14;

/// Numbers in (2^lowest, 2^(lowest + binades)).
pub const fn floats(lowest: i32, binades: u64) -> Recipe {
    Recipe::Float { lowest, binades, signed: false, empty: 0 }
}

/// The same of both signs.
pub const fn signed(lowest: i32, binades: u64) -> Recipe {
    Recipe::Float { lowest, binades, signed: true, empty: 0 }
}

/// The same with so many eighths of zeros.
pub const fn sparse(lowest: i32, binades: u64, empty: u64) -> Recipe {
    Recipe::Float { lowest, binades, signed: false, empty }
}

/// These numbers, for [`Recipe::Cycle`].
pub const fn constants<const N: usize>(numbers: [f64; N]) -> [Recipe; N] {
    let (mut laws, mut n) = ([Recipe::Unit; N], 0);
    while n < N {
        laws[n] = Recipe::Constant(numbers[n]);
        n += 1;
    }
    laws
}

impl Recipe {
    /// The generator's key of an array: a seed from its name, and the purpose of cases.
    pub fn key(name: &str) -> [u64; 2] {
        let seed = name.bytes().fold(0, |hash: u32, byte| hash.wrapping_mul(31).wrapping_add(byte.into()));
        [seed.into(), Purpose::Cases as u64]
    }

    /// The last one of so many offsets and one of an input of a case.
    pub fn total(&self, row: &str, id: &str, input: &str, rays: usize) -> usize {
        let last = self.entries(&format!("{row}/{id}/{input}"), rays..rays + 1, 1, Dtype::F64);
        last.first().map_or(0, |&x| x as usize)
    }

    /// Entries `range` of the array `name`, whose last axis has `last` entries, in `dtype`.
    pub fn entries(&self, name: &str, range: Range<usize>, last: usize, dtype: Dtype) -> Vec<f64> {
        // The four words, made at once, of which word n is one; numpy advances the counter before its first four.
        let four = |n: usize| philox([n as u64 / 4 + 1, 0, 0, 0], Recipe::key(name));
        match *self {
            Recipe::Offsets { most } => {
                let mut sum = 0;
                let mut next = |n: usize| {
                    sum += if n == 0 { 0 } else { (four(n - 1)[(n - 1) % 4] >> 33) % (most + 1) };
                    sum as f64
                };
                (0..range.end).map(&mut next).skip(range.start).collect()
            }
            _ => {
                let mut all = vec![0.0; range.len()];
                parallel::for_chunks(&mut all, TASK, |i, chunk| {
                    let first = range.start + i * TASK;
                    let mut words = four(first);
                    for (n, x) in (first..).zip(chunk) {
                        if n % 4 == 0 {
                            words = four(n);
                        }
                        *x = self.entry(words[n % 4], n, last.max(1), dtype.bits());
                    }
                });
                all
            }
        }
    }

    /// Entry n from its word.
    fn entry(&self, w: u64, n: usize, last: usize, b: i32) -> f64 {
        match *self {
            Recipe::Constant(x) => x,
            Recipe::Each(each) => (n / each) as f64,
            Recipe::Cycle(laws) => laws[n % laws.len()].entry(w, n, last, b),
            Recipe::Float { lowest, binades, signed, empty } => {
                let exponent = lowest + ((w % 256) % binades) as i32;
                let x = power_of_two(exponent) * (1.0 + (w >> (65 - b)) as f64 * power_of_two(1 - b));
                match ((w >> 9) % 8 < empty, signed && w >> 8 & 1 == 1) {
                    (true, _) => 0.0,
                    (false, true) => -x,
                    (false, false) => x,
                }
            }
            Recipe::Ascending { cells } => {
                let inside = if b > 12 { (w >> (76 - b)) as f64 * power_of_two(11 - b) } else { 0.0 };
                ((n % last) as f64 + inside) * power_of_two(-cells)
            }
            _ => (w >> (64 - b)) as f64 * power_of_two(-b),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Recipe; 7] = [
        Recipe::Constant(0.25),
        Recipe::Unit,
        Recipe::Float { lowest: -6, binades: 5, signed: true, empty: 2 },
        Recipe::Ascending { cells: 5 },
        Recipe::Each(7),
        Recipe::Cycle(&[Recipe::Unit, Recipe::Constant(0.5), signed(-2, 3)]),
        Recipe::Offsets { most: 3 },
    ];

    #[test]
    fn parts_are_parts_of_the_whole_and_fit_into_their_type() {
        for recipe in ALL {
            for dtype in Dtype::ALL {
                let whole = recipe.entries("a", 0..TASK + 100, 10, dtype);
                for part in [33..57, TASK - 3..TASK + 6, 30..TASK + 34] {
                    assert_eq!(recipe.entries("a", part.clone(), 10, dtype), whole[part], "{recipe:?}");
                }
                assert!(whole[..100].iter().all(|&x| dtype.holds(x)), "{recipe:?} {dtype}");
            }
        }
    }

    #[test]
    fn numbers_use_every_bit_and_lie_where_they_should() {
        let ends_odd = |x: &f64, dtype: Dtype| x.abs() / dtype.ulp(*x) % 2.0 == 1.0;
        for dtype in Dtype::ALL {
            let x = Recipe::Float { lowest: -3, binades: 4, signed: true, empty: 1 };
            let x = x.entries("floats", 0..4000, 1, dtype);
            assert!((400..600).contains(&x.iter().filter(|x| **x == 0.0).count()));
            assert!((1600..1900).contains(&x.iter().filter(|x| **x < 0.0).count()));
            assert!(x.iter().all(|x| *x == 0.0 || (0.125..2.0).contains(&x.abs())));
            assert!((1500..2000).contains(&x.iter().filter(|x| ends_odd(x, dtype)).count()), "{dtype}");
        }
        let edges = Recipe::Ascending { cells: 10 }.entries("edge", 0..2 * 1025, 1025, Dtype::F32);
        assert!(edges.chunks(1025).all(|row| row.is_sorted() && row[0] < 0.001 && row[1024] >= 1.0));
        let cycle = Recipe::Cycle(&[Recipe::Unit, Recipe::Constant(7.0)]).entries("a", 0..6, 3, Dtype::F32);
        let unit = Recipe::Unit.entries("a", 0..6, 3, Dtype::F32);
        assert_eq!(cycle, [unit[0], 7.0, unit[2], 7.0, unit[4], 7.0]);
        let offsets = Recipe::Offsets { most: 3 }.entries("starting", 0..400, 400, Dtype::F32);
        let lengths: Vec<f64> = offsets.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert!(offsets[0] == 0.0 && [0.0, 1.0, 2.0, 3.0].iter().all(|n| lengths.contains(n)));
    }

    /// `w = numpy.random.Philox(key=[97, 7]).random_raw(3)`, then the formulas above, numpy 2.4.
    #[test]
    fn equals_numpy() {
        assert_eq!(Recipe::key("a"), [97, 7]);
        let unit = Recipe::Unit.entries("a", 0..3, 1, Dtype::F32);
        let float = signed(-3, 4).entries("a", 0..3, 1, Dtype::F64);
        assert_eq!(unit, [0.756311297416687, 0.16139978170394897, 0.04011499881744385]);
        assert_eq!(float, [0.4390778302819536, -1.1613998069705296, -0.13001437670065918]);
    }
}
