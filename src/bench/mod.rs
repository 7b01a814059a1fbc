//! Speed against error: every variant of a component is checked against the oracle, then timed, then its errors are measured.
//!
//! A [`Suite`] is one component with a workload and its variants; they live in `variants/`. A [`Variant`] is
//! prepared once, then `run` (timed) and `read` (not timed), so that conversion isn't billed to the kernel. All kernels of a report
//! take turns in the same rounds, together with the machine's calibration and with a peer's program.

pub mod calibration;
pub mod dense;
pub mod error;
pub mod frontier;
pub mod nerf_step;
pub mod page;
pub mod peer;
pub mod report;
pub mod rounds;
pub mod scaling;
pub mod suites;
pub mod system;
pub mod systems;
mod truth;
mod variants;

#[cfg(test)]
mod tests;

pub use dense::Dense;
pub use error::{BF16, Errors, F16, Tolerance};
pub use report::{BenchReport, Row};
pub use scaling::Scaling;

use rounds::Timer;
use truth::Truth;

use crate::contract::Dtype;
use crate::contract::arrays::{Arrays, array, arrays, values};
use crate::contract::component::Component;
use crate::error::Result;
use crate::random::{Key, Purpose};

/// A variant with its inputs converted and its buffers allocated.
pub trait Kernel {
    /// The work, timed.
    fn run(&mut self);
    /// The results of the last run, not timed.
    fn read(&self) -> Arrays;
    /// Bytes of the kernel's buffers: inputs, intermediate values and results.
    fn bytes(&self) -> usize;
}

/// Inputs -> a kernel.
pub type Prepare = fn(&Arrays) -> Box<dyn Kernel>;

struct Parts<D, F, R> {
    data: D,
    bytes: usize,
    run: F,
    read: R,
}

impl<D, F: FnMut(&mut D), R: Fn(&D) -> Arrays> Kernel for Parts<D, F, R> {
    fn run(&mut self) {
        (self.run)(&mut self.data);
    }

    fn read(&self) -> Arrays {
        (self.read)(&self.data)
    }

    fn bytes(&self) -> usize {
        self.bytes
    }
}

/// A kernel from its data (and their bytes), the function that is timed, and the one that reads its results.
pub fn kernel<D: 'static>(
    data: D,
    bytes: usize,
    run: impl FnMut(&mut D) + 'static,
    read: impl Fn(&D) -> Arrays + 'static,
) -> Box<dyn Kernel> {
    Box::new(Parts { data, bytes, run, read })
}

/// A kernel whose input has rows of `dims` entries and whose one output, `name`, rows of `width`.
pub fn rows<X: 'static, T: Clone + Default + 'static>(
    name: &'static str,
    (x, dims, width): (Vec<X>, usize, usize),
    run: impl Fn(&[X], &mut [T]) + 'static,
    wide: impl Fn(&T) -> f64 + 'static,
) -> Box<dyn Kernel> {
    let count = x.len() / dims;
    let out = vec![T::default(); count * width];
    let bytes = size_of_val(&x[..]) + size_of_val(&out[..]);
    let all = move |out: &Vec<T>| array(&[count, width], out.iter().map(&wide).collect());
    let read = move |(_, out): &(Vec<X>, Vec<T>)| arrays([(name, all(out))]);
    kernel((x, out), bytes, move |(x, out)| run(x, out), read)
}

/// An input as f32: exact, since the workloads' numbers are.
pub fn singles(a: &Arrays, name: &str) -> Vec<f32> {
    values(a, name).iter().map(|&x| x as f32).collect()
}

/// Seeded numbers of f32 in [low, high): draws of `stream`, `count` of them.
pub fn uniform(stream: u64, count: usize, low: f64, high: f64) -> Vec<f64> {
    let u = Key::new(2, Purpose::Cases).uniforms(0, stream, count);
    u.into_iter().map(|u| f64::from((low + (high - low) * u) as f32)).collect()
}

/// One way to compute a component.
#[derive(Clone, Copy, Debug)]
pub struct Variant {
    /// Name, unique within the suite.
    pub name: &'static str,
    /// What it does, in a line.
    pub about: &'static str,
    /// What it computes in, or what its weights or results are stored in where that is shorter.
    pub dtype: Dtype,
    /// Its tolerance: it is checked against this before it is timed.
    pub tolerance: Tolerance,
    /// Makes the kernel.
    pub prepare: Prepare,
}

impl Variant {
    /// A variant from its fields, in a `const`.
    pub const fn new(
        name: &'static str,
        about: &'static str,
        dtype: Dtype,
        tolerance: Tolerance,
        prepare: Prepare,
    ) -> Self {
        Variant { name, about, dtype, tolerance, prepare }
    }

    /// The same computed in f32.
    pub const fn f32(
        name: &'static str,
        about: &'static str,
        tolerance: Tolerance,
        prepare: Prepare,
    ) -> Self {
        Variant::new(name, about, Dtype::F32, tolerance, prepare)
    }

    /// Whether the cost of an item doesn't depend on their number: no batches, no threads.
    fn point_by_point(&self) -> bool {
        matches!(self.name, "oracle" | "plain_f32")
    }
}

/// A component with a workload and its variants.
#[derive(Clone, Copy, Debug)]
pub struct Suite {
    /// Name of the component; where [`crate::COMPONENTS`] has it and `judged`, its oracle and its bound are used.
    pub component: &'static str,
    /// Whether the workload's arrays are those of the registry's row.
    pub judged: bool,
    /// What is counted: point, sample, ray, parameter.
    pub item: &'static str,
    /// Seeded inputs of a number of items, representable in f32.
    pub workload: fn(usize) -> Arrays,
    /// Items that are timed; with `--quick` a quarter of them.
    pub items: usize,
    /// Items that are checked; a slow oracle is timed on them, and its seconds are scaled.
    pub checked: usize,
    /// The component's plain f64 functions.
    pub oracle: Prepare,
    /// Practical variants.
    pub variants: &'static [Variant],
}

impl Suite {
    fn registered(&self) -> Option<&'static Component> {
        crate::COMPONENTS.iter().find(|c| self.judged && c.name == self.component)
    }

    /// The oracle as a variant of its own suite.
    pub fn oracle_variant(&self) -> Variant {
        Variant {
            name: "oracle",
            about: "plain f64, the reference",
            dtype: Dtype::F64,
            tolerance: Tolerance::exact(),
            prepare: self.oracle,
        }
    }
}

/// Options of a report.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Rounds; at least 5.
    pub rounds: usize,
    /// The minimum seconds that a kernel runs in a round.
    pub least: f64,
    /// A quarter of the items, smaller calibration.
    pub quick: bool,
    /// A program that takes part in every round.
    pub peer: Option<String>,
}

/// Seconds of a run above which variants that go point by point are timed on the items that were checked.
const SLOW: f64 = 0.05;

/// A variant that passed its check.
struct Entry {
    suite: usize,
    variant: Variant,
    errors: Errors,
    kernel: Box<dyn Kernel>,
    items: usize,
    timer: Timer,
}

/// Checks, times and measures suites and dense layers; `tell` gets progress messages.
///
/// # Errors
/// Where the peer fails.
pub fn run(
    suites: &[Suite],
    scalings: &[Scaling],
    layers: &[Dense],
    options: &Options,
    tell: impl Fn(&str),
) -> Result<BenchReport> {
    let (mut entries, mut refused) = (vec![], vec![]);
    for (s, suite) in suites.iter().enumerate() {
        tell(&format!("check {}", suite.component));
        let items = if options.quick { (suite.items / 4).max(suite.checked) } else { suite.items };
        let mut truth = Truth::new(suite);
        let big = (suite.workload)(items);
        let all = std::iter::once(suite.oracle_variant()).chain(suite.variants.iter().copied());
        for variant in all {
            match truth.check(suite, &variant) {
                Err(why) => refused.push(Row::refused(suite, &variant, why)),
                Ok(errors) => {
                    let mut kernel = (variant.prepare)(&truth.inputs);
                    let few = rounds::seconds(|| kernel.run());
                    // Slow variants are timed on the items that were checked, and their seconds are scaled.
                    let slow = variant.point_by_point() && few * items as f64 / suite.checked as f64 > SLOW;
                    if !slow {
                        kernel = (variant.prepare)(&big);
                    }
                    let timer = Timer::new(&mut *kernel, options.least);
                    let timed = if slow { suite.checked } else { items };
                    let entry = Entry { suite: s, variant, errors, kernel, items: timed, timer };
                    entries.push((entry, items));
                }
            }
        }
    }
    let mut measured = scaling::prepare(scalings, options.least);
    let mut layers = dense::prepare(layers, options.least, options.quick);
    let mut machine = calibration::Calibration::new(options.quick);
    let mut peer = options.peer.as_deref().map(peer::Peer::new);
    for round in 0..options.rounds {
        tell(&format!("round {} of {}", round + 1, options.rounds));
        machine.round();
        entries.iter_mut().for_each(|(e, _)| e.timer.round(&mut *e.kernel));
        measured.iter_mut().for_each(scaling::Measured::round);
        layers.iter_mut().for_each(dense::Measured::round);
        if let Some(peer) = &mut peer {
            peer.round()?;
        }
    }
    let calibration = machine.json();
    let mut rows: Vec<Row> = entries
        .iter()
        .map(|(e, items)| {
            let scale = *items as f64 / e.items as f64;
            Row::new(&suites[e.suite], &e.variant, &e.errors, (*items, scale), &e.timer, &calibration)
        })
        .collect();
    rows.extend(refused);
    rows.extend(peer.iter().flat_map(|peer| peer.rows(&calibration)));
    report::compare(&mut rows);
    let mut candidates = machine.candidates();
    let left_out = match peer.as_ref().map(peer::Peer::candidate) {
        Some(Ok(candidate)) => {
            candidates.push(candidate);
            None
        }
        Some(Err(why)) => Some(why),
        None => Some("another library's product (`peer`)".into()),
    };
    let scaling = measured.iter().map(scaling::Measured::json).collect();
    let mut report = BenchReport {
        rows,
        scaling,
        system: vec![],
        dense: dense::section(&layers, &candidates, left_out),
        calibration,
        peer: peer.map(|p| p.json()),
        rounds: options.rounds,
    };
    report.stamp();
    Ok(report)
}
