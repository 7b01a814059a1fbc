//! Laws of the positional encoding: which bands, which waves, and what is made of a point beforehand.

use super::super::arrays::{dims, settings};
use super::super::{Encoding, positional_encoding, wave};
use crate::contract::arrays::{Arrays, arrays, from_rows, rows};
use crate::contract::laws::{Guard, Laws};
use crate::convention::Conventions;
use crate::math::{cos, exp, pow, sin};

/// The bands, in the place of 2^k and of what the convention multiplies them with.
const BANDS: [&str; 20] = [
    "as they are by convention",
    "k",
    "k + 1",
    "k pi",
    "(k + 1) pi",
    "2 pi k",
    "2 pi (k + 1)",
    "k^2",
    "2^(k + 1)",
    "2^(k + 1) pi",
    "2^(k - 1) pi",
    "2^(L - 1 - k)",
    "2^-k",
    "2^-k pi",
    "10000^(-k / L)",
    "10000^(-2 k / L)",
    "e^k",
    "1 + k (L - 1) / L",
    "2^(k (L - 1) / L)",
    "1",
];

/// The waves.
const WAVES: [&str; 8] = [
    "sin, cos",
    "cos, sin",
    "sin, sin",
    "cos, cos",
    "sin, -cos",
    "-sin, cos",
    "sin, cos of the band before",
    "sin, sin(x + pi / 2) without the band",
];

/// What is made of a point before anything else.
const BEFOREHAND: [&str; 20] = [
    "x",
    "x over its length",
    "tanh(x)",
    "sigmoid(x)",
    "x held between -1 and 1",
    "x held between 0 and 1",
    "x - floor(x)",
    "x from the least to the largest of its own coordinates onto 0 to 1",
    "x from the least to the largest of its own coordinates onto -1 to 1",
    "x from the points' least to their largest onto 0 to 1",
    "x from the points' least to their largest onto -1 to 1",
    "x from the least to the largest of all numbers onto 0 to 1",
    "x from the least to the largest of all numbers onto -1 to 1",
    "x less the points' mean, over their deviation",
    "x less the points' mean, over their deviation by N - 1",
    "x less the mean of its own coordinates, over their deviation",
    "x over the largest |x| of all numbers",
    "x over the largest |x| of its own coordinates",
    "(2 - 1 / |x|) x / |x| where |x| > 1",
    "(x + 1) mod 2 - 1",
];

/// What that is divided by; behind these, 1 where that is 0.
const OVER: [Guard; 7] = [
    Guard::Nothing,
    Guard::Plus(1e-8),
    Guard::Plus(1e-6),
    Guard::Plus(1e-10),
    Guard::AtLeast(1e-12),
    Guard::AtLeast(1e-8),
    Guard::AtLeast(1e-6),
];

/// How it is scaled.
const SCALED: [&str; 12] = [
    "x",
    "2 x - 1",
    "(x + 1) / 2",
    "x / pi",
    "x / 2",
    "2 x",
    "pi x",
    "x / (2 pi)",
    "2 pi x",
    "x + 1",
    "1 - x",
    "-x",
];

/// What stands for x itself.
const ITSELF: [&str; 4] = ["what is encoded", "x as it came", "0", "pi x"];

/// Those of a point.
pub(crate) const OF_POINTS: Laws = Laws {
    choices: &[BANDS.len(), WAVES.len(), OVER.len() + 1, SCALED.len(), BEFOREHAND.len(), ITSELF.len()],
    says: |part, choice| match part {
        0 => format!("bands {}", BANDS[choice]),
        1 => format!("waves {}", WAVES[choice]),
        2 => {
            let over = OVER.get(choice).map_or("1 where that is 0".into(), |guard| guard.said("that"));
            format!("{over} in the place of what x is divided by")
        }
        3 => format!("{} encoded in the place of x", SCALED[choice]),
        4 => format!("beforehand x' = {}", BEFOREHAND[choice]),
        _ => format!("{} for x itself", ITSELF[choice]),
    },
    of,
    rounding: &[],
};

fn band(k: usize, levels: usize, choice: usize) -> f64 {
    let (k, levels, pi) = (k as f64, levels as f64, std::f64::consts::PI);
    match choice {
        1 => k,
        2 => k + 1.0,
        3 => k * pi,
        4 => (k + 1.0) * pi,
        5 => 2.0 * pi * k,
        6 => 2.0 * pi * (k + 1.0),
        7 => k * k,
        8 => pow(2.0, k + 1.0),
        9 => pow(2.0, k + 1.0) * pi,
        10 => pow(2.0, k - 1.0) * pi,
        11 => pow(2.0, levels - 1.0 - k),
        12 => pow(2.0, -k),
        13 => pow(2.0, -k) * pi,
        14 => pow(10_000.0, -k / levels),
        15 => pow(10_000.0, -2.0 * k / levels),
        16 => exp(k),
        17 => 1.0 + k * (levels - 1.0) / levels,
        18 => pow(2.0, k * (levels - 1.0) / levels),
        _ => 1.0,
    }
}

fn waves(encoding: &Encoding, k: usize, x: f64, law: &[usize]) -> (f64, f64) {
    let at = |k: usize| match law[0] {
        0 => wave(encoding.frequency, encoding.band(k), x),
        n => {
            let angle = band(k, encoding.levels, n) * x;
            (sin(angle), cos(angle))
        }
    };
    let (sin, cos) = at(k);
    match law[1] {
        0 => (sin, cos),
        1 => (cos, sin),
        2 => (sin, sin),
        3 => (cos, cos),
        4 => (sin, -cos),
        5 => (-sin, cos),
        6 => (sin, at(k.max(1) - 1).1),
        _ => (sin, crate::math::sin(x + std::f64::consts::FRAC_PI_2)),
    }
}

fn over(length: f64, choice: usize) -> f64 {
    match OVER.get(choice) {
        Some(guard) => guard.of(length),
        None if length == 0.0 => 1.0,
        None => length,
    }
}

/// The least, the largest, the mean and the deviation of some numbers.
struct Spread {
    least: f64,
    largest: f64,
    mean: f64,
    /// The sum of squares of what is off the mean.
    squares: f64,
    n: f64,
}

impl Spread {
    fn of(x: impl Iterator<Item = f64>) -> Spread {
        let x: Vec<f64> = x.collect();
        let (n, mean) = (x.len() as f64, x.iter().sum::<f64>() / x.len() as f64);
        Spread {
            least: x.iter().copied().fold(f64::INFINITY, f64::min),
            largest: x.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            mean,
            squares: x.iter().map(|x| (x - mean) * (x - mean)).sum(),
            n,
        }
    }

    /// 0 for the least, 1 for the largest.
    fn share(&self, x: f64, law: usize) -> f64 {
        (x - self.least) / over(self.largest - self.least, law)
    }

    fn standard(&self, x: f64, less: f64, law: usize) -> f64 {
        (x - self.mean) / over((self.squares / (self.n - less)).sqrt(), law)
    }

    fn size(&self) -> f64 {
        self.largest.abs().max(self.least.abs())
    }
}

/// What all points have in common: the spread of each coordinate, and of all numbers.
struct Common {
    each: Vec<Spread>,
    all: Spread,
}

/// What is made of a point, by the choices of what it is divided by and of that.
fn beforehand(x: &[f64], common: &Common, divided: usize, choice: usize) -> Vec<f64> {
    let (own, all) = (Spread::of(x.iter().copied()), &common.all);
    let length = x.iter().map(|x| x * x).sum::<f64>().sqrt();
    let each = |f: &dyn Fn(f64) -> f64| x.iter().map(|x| f(*x)).collect::<Vec<f64>>();
    let by_axis = |f: &dyn Fn(f64, &Spread) -> f64| -> Vec<f64> {
        x.iter().zip(&common.each).map(|(x, spread)| f(*x, spread)).collect()
    };
    match choice {
        1 => each(&|x| x / over(length, divided)),
        2 => each(&|x| libm::tanh(x)),
        3 => each(&|x| 1.0 / (1.0 + exp(-x))),
        4 => each(&|x| x.clamp(-1.0, 1.0)),
        5 => each(&|x| x.clamp(0.0, 1.0)),
        6 => each(&|x| x - libm::floor(x)),
        7 => each(&|x| own.share(x, divided)),
        8 => each(&|x| 2.0 * own.share(x, divided) - 1.0),
        9 => by_axis(&|x, spread| spread.share(x, divided)),
        10 => by_axis(&|x, spread| 2.0 * spread.share(x, divided) - 1.0),
        11 => each(&|x| all.share(x, divided)),
        12 => each(&|x| 2.0 * all.share(x, divided) - 1.0),
        13 => by_axis(&|x, spread| spread.standard(x, 0.0, divided)),
        14 => by_axis(&|x, spread| spread.standard(x, 1.0, divided)),
        15 => each(&|x| own.standard(x, 0.0, divided)),
        16 => each(&|x| x / over(all.size(), divided)),
        17 => each(&|x| x / over(own.size(), divided)),
        18 if length > 1.0 => each(&|x| (2.0 - 1.0 / length) * x / length),
        19 => each(&|x| x - 2.0 * libm::floor(0.5 * (x + 1.0))),
        _ => x.to_vec(),
    }
}

fn scaled(x: f64, choice: usize) -> f64 {
    let pi = std::f64::consts::PI;
    match choice {
        1 => 2.0 * x - 1.0,
        2 => 0.5 * (x + 1.0),
        3 => x / pi,
        4 => 0.5 * x,
        5 => 2.0 * x,
        6 => pi * x,
        7 => x / (2.0 * pi),
        8 => 2.0 * pi * x,
        9 => x + 1.0,
        10 => 1.0 - x,
        11 => -x,
        _ => x,
    }
}

/// The encoding of a point x of which this is encoded.
fn encoded(x: &[f64], own: &[f64], encoding: &Encoding, law: &[usize]) -> Vec<f64> {
    let dims = x.len();
    let mut out = positional_encoding(own, encoding);
    if law[..2] != [0, 0] {
        for (k, d) in (0..encoding.levels).flat_map(|k| (0..dims).map(move |d| (k, d))) {
            let (sin, cos) = waves(encoding, k, own[d], law);
            out[encoding.column(dims, k, d, 0)] = sin;
            out[encoding.column(dims, k, d, 1)] = cos;
        }
    }
    for d in (0..dims).filter(|_| encoding.identity) {
        out[encoding.identity_column(dims, d)] = match law[5] {
            0 => own[d],
            1 => x[d],
            2 => 0.0,
            _ => std::f64::consts::PI * own[d],
        };
    }
    out
}

fn of(a: &Arrays, c: &Conventions, law: &[usize]) -> Arrays {
    let (encoding, dims, points) = (settings(a, c), dims(a), rows(a, "x"));
    let axis = |d: usize| Spread::of(points.iter().map(|x| x[d]));
    let all = Spread::of(points.iter().flatten().copied());
    let common = Common { each: (0..dims).map(axis).collect(), all };
    let point = |x: &Vec<f64>| {
        let before = beforehand(x, &common, law[2], law[4]);
        let own: Vec<f64> = before.iter().map(|x| scaled(*x, law[3])).collect();
        encoded(x, &own, &encoding, law)
    };
    let out: Vec<Vec<f64>> = points.iter().map(point).collect();
    arrays([("encoding", from_rows(&out, encoding.width(dims)))])
}
