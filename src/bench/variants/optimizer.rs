//! Variants of a step of Adam for `bench`.

use pulp::{Simd, WithSimd};

use crate::approximate::{from_bf16, to_bf16};
use crate::bench::{BF16, Kernel, Scaling, Suite, Tolerance, Variant, kernel, singles, uniform};
use crate::contract::Dtype;
use crate::contract::arrays::{Arrays, array, arrays, scalar, values};
use crate::optimizer::arrays::settings;
use crate::optimizer::fast::Rates;
use crate::optimizer::{Adam, fast};
use crate::parallel;

/// Parameters of a task.
const TASK: usize = 1 << 15;

/// Parameters of size 1 in the 100th step, gradients of size 0.01.
fn workload(items: usize) -> Arrays {
    let of = |stream, low, high| array(&[items], uniform(stream, items, low, high));
    arrays([
        ("params", of(2, -1.0, 1.0)),
        ("grad", of(3, -0.01, 0.01)),
        ("m", of(4, -0.003, 0.003)),
        ("v", of(5, 1e-6, 1e-4)),
        ("step", scalar(100.0)),
        ("lr", scalar(5e-4)),
        ("beta1", scalar(0.9)),
        ("beta2", scalar(0.999)),
        ("eps", scalar(1e-8)),
        ("weight_decay", scalar(0.0)),
    ])
}

/// Parameters, gradient, and the means in their storage type.
struct State<T> {
    p: Vec<T>,
    g: Vec<T>,
}

/// A kernel with parameters, gradients and means; each run is the same step.
fn step<P: Copy + 'static, M: Copy + 'static>(
    (state, m, v): (State<P>, Vec<M>, Vec<M>),
    run: impl Fn(&mut [P], &[P], &mut [M], &mut [M]) + 'static,
    wide: (fn(P) -> f64, fn(M) -> f64),
) -> Box<dyn Kernel> {
    let bytes = 2 * size_of_val(&state.p[..]) + 2 * size_of_val(&m[..]);
    let read = move |(s, m, v): &(State<P>, Vec<M>, Vec<M>)| {
        let n = s.p.len();
        let means = |m: &Vec<M>| array(&[n], m.iter().map(|&m| wide.1(m)).collect());
        let params = array(&[n], s.p.iter().map(|&p| wide.0(p)).collect());
        arrays([("params_out", params), ("m_out", means(m)), ("v_out", means(v))])
    };
    kernel((state, m, v), bytes, move |(s, m, v)| run(&mut s.p, &s.g, m, v), read)
}

fn state(a: &Arrays) -> State<f32> {
    State { p: singles(a, "params"), g: singles(a, "grad") }
}

fn oracle(a: &Arrays) -> Box<dyn Kernel> {
    let (adam, number) = settings(a);
    let state = State { p: values(a, "params"), g: values(a, "grad") };
    let run = move |p: &mut [f64], g: &[f64], m: &mut [f64], v: &mut [f64]| {
        for i in 0..p.len() {
            let before = crate::optimizer::Moments { param: p[i], m: m[i], v: v[i] };
            let after = crate::optimizer::adam_step(&adam, before, g[i], number);
            (p[i], m[i], v[i]) = (after.param, after.m, after.v);
        }
    };
    step((state, values(a, "m"), values(a, "v")), run, (|x| x, |x| x))
}

/// The straightforward code. With `single`, 1 - beta and 1 - beta^t are formed in f32: 1 - 0.999 then has 14 good bits.
fn plain(a: &Arrays, single: bool) -> Box<dyn Kernel> {
    let (Adam { lr, beta1, beta2, eps, .. }, number) = settings(a);
    let round = move |x: f64| if single { f64::from(x as f32) } else { x };
    let betas = [beta1, beta2].map(round);
    let [c1, c2] = betas.map(|beta| round(1.0 - round(beta.powi(number as i32))) as f32);
    let [a1, a2] = betas.map(|beta| (1.0 - beta) as f32);
    let [lr, b1, b2, eps] = [lr, beta1, beta2, eps].map(|x| x as f32);
    let run = move |p: &mut [f32], g: &[f32], m: &mut [f32], v: &mut [f32]| {
        for i in 0..p.len() {
            m[i] = b1 * m[i] + a1 * g[i];
            v[i] = b2 * v[i] + a2 * g[i] * g[i];
            p[i] -= lr * (m[i] / c1) / ((v[i] / c2).sqrt() + eps);
        }
    };
    step((state(a), singles(a, "m"), singles(a, "v")), run, (f64::from, f64::from))
}

struct Apply<'a> {
    rates: Rates,
    p: &'a mut [f32],
    g: &'a [f32],
    m: &'a mut [f32],
    v: &'a mut [f32],
}

impl WithSimd for Apply<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.rates.apply(self.p, self.g, self.m, self.v);
    }
}

fn vectorized(a: &Arrays) -> Box<dyn Kernel> {
    let (adam, number) = settings(a);
    let rates = Rates::new(&adam, number);
    let run = move |p: &mut [f32], g: &[f32], m: &mut [f32], v: &mut [f32]| {
        crate::simd::arch().dispatch(Apply { rates, p, g, m, v });
    };
    step((state(a), singles(a, "m"), singles(a, "v")), run, (f64::from, f64::from))
}

fn threaded(a: &Arrays) -> Box<dyn Kernel> {
    let (adam, number) = settings(a);
    let (m, v) = (singles(a, "m"), singles(a, "v"));
    let data = (state(a), fast::Moments { step: 0, m, v });
    let bytes = 16 * data.0.p.len();
    let run = move |(s, moments): &mut (State<f32>, fast::Moments)| {
        moments.step = number - 1;
        moments.update(crate::simd::arch(), &adam, &mut s.p, &s.g);
    };
    let wide = |x: &[f32]| array(&[x.len()], x.iter().map(|&x| x.into()).collect());
    kernel(data, bytes, run, move |(s, moments)| {
        arrays([("params_out", wide(&s.p)), ("m_out", wide(&moments.m)), ("v_out", wide(&moments.v))])
    })
}

/// What a less accurate step changes.
#[derive(Clone, Copy, PartialEq)]
enum Trade {
    /// Means stored as bf16.
    ShortMeans,
    /// 1 / sqrt(v) by a shifted exponent and one Newton step, eps left out.
    RootByBits,
}

struct Bold<'a, M> {
    trade: Trade,
    /// lr over the first bias correction, root of the second, betas.
    constants: [f32; 4],
    p: &'a mut [f32],
    g: &'a [f32],
    m: &'a mut [M],
    v: &'a mut [M],
    load: fn(M) -> f32,
    store: fn(f32) -> M,
}

impl<M: Copy> WithSimd for Bold<'_, M> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Bold { trade, constants: [rate, root, b1, b2], p, g, m, v, load, store } = self;
        for (((p, &g), m), v) in p.iter_mut().zip(g).zip(m).zip(v) {
            let mean = b1 * load(*m) + (1.0 - b1) * g;
            let square = b2 * load(*v) + (1.0 - b2) * g * g;
            let inverse = match trade {
                Trade::ShortMeans => 1.0 / (square.sqrt() / root + 1e-8),
                Trade::RootByBits => root * inverse_root(square),
            };
            *p -= rate * mean * inverse;
            (*m, *v) = (store(mean), store(square));
        }
    }
}

/// 1 / sqrt(x) within 0.18% (Lomont 2003).
#[inline(always)]
fn inverse_root(x: f32) -> f32 {
    let y = f32::from_bits(0x5f37_5a86 - (x.to_bits() >> 1));
    y * (1.5 - 0.5 * x * y * y)
}

fn bold<M: Copy + Send + 'static>(
    a: &Arrays,
    trade: Trade,
    store: fn(f32) -> M,
    load: fn(M) -> f32,
) -> Box<dyn Kernel> {
    let (adam, number) = settings(a);
    let [c1, c2] = [adam.beta1, adam.beta2].map(|beta| crate::optimizer::bias_correction(beta, number));
    let constants = [adam.lr / c1, c2.sqrt(), adam.beta1, adam.beta2].map(|x| x as f32);
    let mean = |name| singles(a, name).into_iter().map(store).collect::<Vec<M>>();
    let data = (state(a), mean("m"), mean("v"));
    let bytes = data.0.p.len() * (8 + 2 * size_of::<M>());
    let run = move |(s, m, v): &mut (State<f32>, Vec<M>, Vec<M>)| {
        let (arch, g) = (crate::simd::arch(), &s.g);
        let tasks = s.p.chunks_mut(TASK).zip(g.chunks(TASK)).zip(m.chunks_mut(TASK)).zip(v.chunks_mut(TASK));
        let mut tasks: Vec<_> = tasks.collect();
        parallel::for_each(&mut tasks, |(((p, g), m), v)| {
            arch.dispatch(Bold { trade, constants, p, g, m, v, load, store });
        });
    };
    kernel(data, bytes, run, move |(s, m, v)| {
        let wide = |x: &[f32]| array(&[x.len()], x.iter().map(|&x| x.into()).collect());
        let mean = |m: &[M]| wide(&m.iter().map(|&m| load(m)).collect::<Vec<f32>>());
        arrays([("params_out", wide(&s.p)), ("m_out", mean(m)), ("v_out", mean(v))])
    })
}

/// The optimizer's suite.
pub(crate) const SUITE: Suite = Suite {
    component: "adam_step",
    judged: true,
    item: "parameter",
    workload,
    items: 1 << 20,
    checked: 1 << 14,
    oracle,
    variants: &[
        Variant::new(
            "plain_f32",
            "one thread, elements in f32, 1 - beta and 1 - beta^t in f64",
            Dtype::F32,
            Tolerance::f32(),
            |a| plain(a, false),
        ),
        Variant::new(
            "f32_betas",
            "the same with beta rounded to f32 before 1 - beta is formed, as code in f32 alone does",
            Dtype::F32,
            // 2^-25 in 0.999 is 3e-5 of 1 - 0.999, and 100 times that of 1 - 0.999^100 = 0.095; a step is at most 2e-3.
            Tolerance::f32().stored(6e-5).within(2e-3 * 6e-5),
            |a| plain(a, true),
        ),
        Variant::new(
            "vectorized",
            "one thread, what depends on the step alone in f64, one reciprocal",
            Dtype::F32,
            Tolerance::f32(),
            vectorized,
        ),
        Variant::new("threaded", "the same on all threads", Dtype::F32, Tolerance::f32(), threaded),
        Variant::new(
            "root_by_bits",
            "all threads, 1 / sqrt by a shifted exponent and one Newton step (0.18%), eps left out",
            Dtype::F32,
            // A step is at most lr m / sqrt(v) / c1 = 5e-4 * 4e-3 / 1e-3 = 2e-3 (times 0.32, the root of c2): 0.2% of it.
            Tolerance::f32().within(2e-3 * 0.002),
            |a| bold(a, Trade::RootByBits, |x| x, |x| x),
        ),
        Variant::new(
            "bf16_means",
            "all threads, both means stored as bf16",
            Dtype::Bf16,
            // Each mean is rounded before the step and after it.
            Tolerance::f32().of_largest(2.0 * BF16),
            |a| bold(a, Trade::ShortMeans, to_bf16, from_bf16),
        ),
    ],
};

/// Time and memory against the number of parameters.
pub(crate) const SCALING: &[Scaling] = &[Scaling {
    component: "adam_step",
    parameter: "parameters",
    about: "threaded",
    values: &[65536.0, 262_144.0, 1_048_576.0, 4_194_304.0],
    prepare: |items| threaded(&workload(items as usize)),
    memory: true,
}];
