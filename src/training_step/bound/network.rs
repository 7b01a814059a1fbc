//! The network whose parameters have errors of their own, forth and back. Unlike the bound of `nerf_mlp` alone, that of a few layers of a
//! few units in the worst case: errors of parameters are no independent roundings.

use crate::contract::arithmetic::Arithmetic;
use crate::contract::bounded::{Bounded, exact};
use crate::convention::{Conventions, Cosine};
use crate::encoding::bound::encode;
use crate::encoding::{Encoding, factor};
use crate::field::NerfMlp;
use crate::field::bound::{density_of, density_slope_of, sigmoid_of, sigmoid_slope_of};
use crate::field::trunk::{Part, Plan};

/// The encoding of a point with errors: |sin(s x) - sin(s x')| <= s |x - x'|. What is rounded is that of a point nearby.
pub(super) fn encoded(x: &[Bounded], encoding: &Encoding, m: &Arithmetic) -> Vec<Bounded> {
    let at: Vec<f64> = x.iter().map(|x| x.y).collect();
    let mut out = encode(&at, encoding, Cosine::Own, m);
    for (d, x) in x.iter().enumerate() {
        let kept = encoding.identity_column(at.len(), d);
        out[kept] = out[kept].widened(x.e);
        for k in 0..encoding.levels {
            let reach = factor(encoding.frequency) * encoding.band(k) * x.e * (1.0 + 32.0 * m.u);
            for wave in [0, 1] {
                let column = encoding.column(at.len(), k, d, wave);
                out[column] = out[column].widened(reach);
            }
        }
    }
    out
}

/// A layer, and what its gradient sums: g_z and x of each point.
struct Layer {
    w: Vec<Vec<Bounded>>,
    b: Vec<Bounded>,
    g_z: Vec<Vec<Bounded>>,
    x: Vec<Vec<Bounded>>,
}

impl Layer {
    /// w x + b: the bias is one more term of the sum, or added after it.
    fn forward(&self, x: &[Bounded], m: &Arithmetic) -> Vec<Bounded> {
        let one = |(w, b): (&Vec<Bounded>, &Bounded)| {
            let products: Vec<Bounded> = w.iter().zip(x).map(|(&w, &x)| m.mul(w, x)).collect();
            let sum = m.sum(&products);
            m.add(m.rounded(sum.y, sum.e), *b).or(m.sum(&[&products[..], &[*b]].concat()))
        };
        self.w.iter().zip(&self.b).map(one).collect()
    }

    /// Keeps a point's part of the gradient, and returns w^T g_z.
    fn backward(&mut self, x: &[Bounded], g_z: &[Bounded], m: &Arithmetic) -> Vec<Bounded> {
        let column = |i: usize| -> Vec<Bounded> { self.w.iter().map(|row| row[i]).collect() };
        let g_x = (0..x.len()).map(|i| rounded(m.dot(&column(i), g_z), m)).collect();
        self.g_z.push(g_z.to_vec());
        self.x.push(x.to_vec());
        g_x
    }

    /// Sums over the points: weights row by row, then biases.
    fn gradient(&self, m: &Arithmetic) -> Vec<Bounded> {
        let of =
            |rows: &[Vec<Bounded>], i: usize| -> Vec<Bounded> { rows.iter().map(|row| row[i]).collect() };
        let (mut weights, mut biases) = (vec![], vec![]);
        for o in 0..self.b.len() {
            let g = of(&self.g_z, o);
            biases.push(rounded(m.sum(&g), m));
            weights.extend((0..self.w[o].len()).map(|i| rounded(m.dot(&g, &of(&self.x, i)), m)));
        }
        [weights, biases].concat()
    }
}

fn rounded(x: Bounded, m: &Arithmetic) -> Bounded {
    m.rounded(x.y, x.e)
}

/// max(z, 0).
fn relu(z: &[Bounded]) -> Vec<Bounded> {
    let one = |z: &Bounded| match z.y > 0.0 {
        true => *z,
        false => Bounded { y: 0.0, e: (z.e + z.y).max(0.0) },
    };
    z.iter().map(one).collect()
}

/// g where z > 0. Where rounding may put z on either side, 0 and g are both honest.
fn masked(g: &[Bounded], z: &[Bounded]) -> Vec<Bounded> {
    let one = |(g, z): (&Bounded, &Bounded)| {
        let kept = if z.y > 0.0 { *g } else { exact(0.0) };
        if z.e > 0.0 && z.e >= z.y.abs() { Bounded { y: kept.y, e: g.size() } } else { kept }
    };
    g.iter().zip(z).map(one).collect()
}

/// The network, with the plan of its trunk.
pub(super) struct Network {
    trunk: Vec<Layer>,
    /// sigma, feature, color0, color1.
    heads: [Layer; 4],
    plan: Plan,
    conventions: Conventions,
}

/// One point, as the way back needs it.
pub(super) struct Tape {
    inputs: Vec<Vec<Bounded>>,
    z: Vec<Vec<Bounded>>,
    hidden: Vec<Bounded>,
    z_sigma: Bounded,
    color_input: Vec<Bounded>,
    z_color0: Vec<Bounded>,
    color_hidden: Vec<Bounded>,
    z_color1: Vec<Bounded>,
    pub sigma: Bounded,
    pub rgb: [Bounded; 3],
}

const SIGMA: usize = 0;
const FEATURE: usize = 1;
const COLOR0: usize = 2;
const COLOR1: usize = 3;

impl Network {
    /// A network of the sizes of `net` with these parameters.
    pub(super) fn new(net: &NerfMlp, params: &[Bounded], c: &Conventions) -> Network {
        let mut left = params;
        let mut take = |count: usize| {
            let (taken, rest) = left.split_at(count);
            left = rest;
            taken.to_vec()
        };
        let mut layers: Vec<Layer> = vec![];
        for (_, layer) in net.layers() {
            let (outputs, inputs) = layer.w.dim();
            let w = (0..outputs).map(|_| take(inputs)).collect();
            layers.push(Layer { w, b: take(outputs), g_z: vec![], x: vec![] });
        }
        let heads = layers.split_off(net.trunk.len()).try_into();
        let heads = heads.unwrap_or_else(|_| unreachable!("a network has four heads"));
        Network { trunk: layers, heads, plan: Plan::of(c), conventions: *c }
    }

    /// One point, encoded, seen from an encoded direction.
    pub(super) fn forward(&self, position: &[Bounded], direction: &[Bounded], m: &Arithmetic) -> Tape {
        let (mut inputs, mut zs, mut h) = (vec![], vec![], vec![]);
        for (n, layer) in self.trunk.iter().enumerate() {
            let parts = self.plan.parts(n).iter().map(|part| match part {
                Part::Encoding => position,
                Part::Hidden => &h[..],
            });
            let input = parts.collect::<Vec<_>>().concat();
            let z = layer.forward(&input, m);
            h = relu(&z);
            inputs.push(input);
            zs.push(z);
        }
        let z_sigma = self.heads[SIGMA].forward(&h, m)[0];
        let feature = self.heads[FEATURE].forward(&h, m);
        let color_input = [&feature, direction].concat();
        let z_color0 = self.heads[COLOR0].forward(&color_input, m);
        let color_hidden = relu(&z_color0);
        let z_color1 = self.heads[COLOR1].forward(&color_hidden, m);
        let rgb = std::array::from_fn(|k| sigmoid_of(z_color1[k], m));
        let sigma = density_of(z_sigma, self.conventions.density, m);
        #[rustfmt::skip]
        let tape = Tape { inputs, z: zs, hidden: h, z_sigma, color_input, z_color0, color_hidden, z_color1, sigma, rgb };
        tape
    }

    /// The same point back: its part of the gradient is kept.
    pub(super) fn backward(&mut self, tape: &Tape, g_sigma: Bounded, g_rgb: [Bounded; 3], m: &Arithmetic) {
        let slopes: Vec<Bounded> =
            (0..3).map(|k| m.mul(sigmoid_slope_of(tape.z_color1[k], m), g_rgb[k])).collect();
        let g = self.heads[COLOR1].backward(&tape.color_hidden, &slopes, m);
        let g = masked(&g, &tape.z_color0);
        let mut g = self.heads[COLOR0].backward(&tape.color_input, &g, m);
        g.truncate(self.heads[FEATURE].b.len());
        let from_color = self.heads[FEATURE].backward(&tape.hidden, &g, m);
        let slope = density_slope_of(tape.z_sigma, self.conventions.density, m);
        let g = self.heads[SIGMA].backward(&tape.hidden, &[m.mul(slope, g_sigma)], m);
        let mut g: Vec<Bounded> = from_color.iter().zip(g).map(|(&a, b)| m.add(a, b)).collect();
        let columns = tape.inputs[0].len();
        for n in (0..self.trunk.len()).rev() {
            let g_z = masked(&g, &tape.z[n]);
            g = self.trunk[n].backward(&tape.inputs[n], &g_z, m);
            match self.plan.encoding_begins(n, g.len(), columns) {
                None => {}
                Some(0) => drop(g.drain(..columns)),
                Some(begins) => g.truncate(begins),
            }
        }
    }

    /// The gradient of all points that came back, in a row.
    pub(super) fn gradient(&self, m: &Arithmetic) -> Vec<Bounded> {
        self.trunk.iter().chain(&self.heads).flat_map(|layer| layer.gradient(m)).collect()
    }
}
