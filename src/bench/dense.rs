//! Dense layers: the share of the machine's peak that the matrix products of training reach.
//!
//! The **ceiling** is the best round of all products in the calibration, on all threads: `gemm` on 4096^3, `gemm` on 1024 x 256 x 256 (one
//! per thread, as the layers of a chunk are computed), and what a peer's library reaches on 4096^3 where the peer reports it
//! (`sgemm_gflops`).
//!
//! **share_products** = useful flops / seconds / ceiling of the products in a training step: the step itself runs, on the chunks of a
//! training batch, and a clock is read before and after each product; seconds are those of all threads over their number, so that a
//! thread that waits for others counts for nothing. ReLU is in it where the kernel applies it while it writes; biases, masks,
//! encodings, activations, rendering and the sums over chunks are not. **share_pass** is the same for the whole forward and backward
//! pass with all of these, on the wall clock.
//!
//! Useful flops are 2 per multiplication with an actual weight, once for the forward pass, once for the weights' gradient,
//! and once for the inputs' gradient where it is needed. Columns that pad a vector don't count.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use serde_json::{Value, json};

use super::rounds::quantile;
use crate::parallel;

pub mod compact;
pub mod nerf_mlp;

/// The networks of a training step with a batch, ready to run.
pub trait Layers {
    /// Runs a chunk's step and compares each product with plain f64 loops over its own inputs: the largest error over what f32 sums
    /// in any order may be off by; not above 1.
    fn check(&mut self) -> f64;
    /// What one run does.
    fn work(&self) -> WorkCount;
    /// Runs the pass; seconds in its products.
    fn products(&mut self) -> f64;
    /// Seconds of the whole pass.
    fn pass(&mut self) -> f64;
}

/// What one run does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorkCount {
    /// Points with a backward pass.
    pub points: usize,
    /// Useful flops of the products.
    pub products: f64,
    /// Useful flops of the pass.
    pub pass: f64,
}

/// A network whose layers are measured.
#[derive(Clone, Copy)]
pub struct Dense {
    /// Its name.
    pub name: &'static str,
    /// What runs, in a line.
    pub about: &'static str,
    /// The batch; for the 8x256 network a smaller one where `quick`.
    pub prepare: fn(quick: bool) -> Box<dyn Layers>,
}

/// Time in products, of all threads.
#[derive(Debug, Default)]
pub struct Clock(AtomicU64);

impl Clock {
    /// When a product begins.
    #[inline(always)]
    pub fn now() -> Instant {
        Instant::now()
    }

    /// It ends.
    #[inline(always)]
    pub fn add(&self, start: Instant) {
        self.0.fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
    }

    /// Seconds, a mean over the threads.
    pub fn seconds(&self) -> f64 {
        self.0.load(Ordering::Relaxed) as f64 / 1e9 / parallel::threads() as f64
    }
}

/// Products that were checked: the largest error over what it may be, and the flops of all columns, padded ones too.
#[derive(Debug, Default)]
pub struct Found(Mutex<[f64; 2]>);

impl Found {
    /// A product, its flops, and the errors of its entries over their bounds.
    pub fn add(&self, flops: f64, entries: impl Iterator<Item = f64>) {
        let mut found = self.0.lock().expect("no holder panics");
        let [worst, all] = *found;
        *found = [entries.fold(worst, worse), all + flops];
    }

    /// Largest error over what it may be, and flops.
    pub fn worst_and_flops(&self) -> [f64; 2] {
        *self.0.lock().expect("no holder panics")
    }
}

/// How far an entry of a product is off, over what it may be off by: half a unit of the last place for each of its terms and additions,
/// relative to the sum of absolute terms; and the smallest normal number, below which f32 has fewer digits. `before` is what stood
/// there and was added to.
pub fn used(terms: impl ExactSizeIterator<Item = (f32, f32)>, before: f32, relu: bool, got: f32) -> f64 {
    let count = terms.len();
    let (mut sum, mut absolute) = (f64::from(before), f64::from(before.abs()));
    for (a, b) in terms {
        let term = f64::from(a) * f64::from(b);
        sum += term;
        absolute += term.abs();
    }
    let expected = if relu { sum.max(0.0) } else { sum };
    let unit = f64::from(f32::EPSILON) / 2.0;
    let bound = (count + 2) as f64 * (unit * absolute + f64::from(f32::MIN_POSITIVE));
    (f64::from(got) - expected).abs() / bound
}

/// The larger of both; a NaN stays one.
fn worse(worst: f64, error: f64) -> f64 {
    if error > worst || error.is_nan() { error } else { worst }
}

/// One figure that the ceiling is the largest of.
#[derive(Clone, Debug, PartialEq)]
pub struct CeilingCandidate {
    /// What ran.
    pub name: String,
    /// Its best round.
    pub gflops: f64,
}

/// The best of the candidates; what isn't finite doesn't count.
///
/// ```
/// use nerf_oracle::bench::dense::{CeilingCandidate, ceiling};
/// let all = [("a", 170.0), ("b", 301.5), ("c", f64::NAN)].map(|(n, gflops)| CeilingCandidate { name: n.into(), gflops });
/// assert_eq!(ceiling(&all), Some(&all[1]));
/// assert_eq!(ceiling(&all[2..]), None);
/// ```
pub fn ceiling(candidates: &[CeilingCandidate]) -> Option<&CeilingCandidate> {
    let finite = candidates.iter().filter(|c| c.gflops.is_finite());
    finite.max_by(|a, b| a.gflops.total_cmp(&b.gflops))
}

/// A network under measurement.
pub struct Measured {
    dense: Dense,
    layers: Box<dyn Layers>,
    used: f64,
    least: f64,
    products: Vec<f64>,
    pass: Vec<f64>,
}

/// All networks, checked.
pub fn prepare(dense: &[Dense], least: f64, quick: bool) -> Vec<Measured> {
    let one = |dense: &Dense| {
        let mut layers = (dense.prepare)(quick);
        let used = layers.check();
        Measured { dense: *dense, layers, used, least, products: vec![], pass: vec![] }
    };
    dense.iter().map(one).collect()
}

impl Measured {
    /// Whether its products are right.
    fn right(&self) -> bool {
        self.used <= 1.0
    }

    /// One round of both; nothing if the check failed.
    pub fn round(&mut self) {
        if self.right() {
            let layers = &mut self.layers;
            self.pass.push(mean(self.least, || layers.pass()));
            self.products.push(mean(self.least, || layers.products()));
        }
    }

    /// The row, with its shares of a ceiling in GFLOP/s.
    pub fn json(&self, ceiling: f64) -> Value {
        let WorkCount { points, products, pass } = self.layers.work();
        let mut row = json!({ "network": self.dense.name, "about": self.dense.about, "points": points, "check_used": self.used });
        if !self.right() {
            row["refused"] =
                format!("a product is off by {:.3} times what it may be off by", self.used).into();
            return row;
        }
        for (name, flops, seconds) in [("products", products, &self.products), ("pass", pass, &self.pass)] {
            let (middle, best) = (quantile(seconds, 0.5), quantile(seconds, 0.0));
            let spread = (quantile(seconds, 0.75) - quantile(seconds, 0.25)) / middle;
            let figures = [
                ("flops", flops),
                ("seconds", middle),
                ("best_seconds", best),
                ("spread", spread),
                ("gflops", flops / middle / 1e9),
            ];
            for (what, value) in figures {
                row[format!("{name}_{what}")] = value.into();
            }
            row[format!("share_{name}")] = (flops / middle / 1e9 / ceiling).into();
            row[format!("best_share_{name}")] = (flops / best / 1e9 / ceiling).into();
        }
        row
    }
}

/// Where runs are short, a run that isn't counted, because others have used the caches meanwhile; then the mean of runs that take
/// `least` seconds together.
fn mean(least: f64, mut run: impl FnMut() -> f64) -> f64 {
    let first = run();
    if first >= least {
        return first;
    }
    let (mut sum, mut count) = (0.0, 0.0);
    while sum < least || count == 0.0 {
        sum += run();
        count += 1.0;
    }
    sum / count
}

/// The section of the report.
pub fn section(measured: &[Measured], candidates: &[CeilingCandidate], left_out: Option<String>) -> Value {
    if measured.is_empty() {
        return Value::Null;
    }
    let best = ceiling(candidates).map_or(f64::NAN, |c| c.gflops);
    let list = candidates.iter().map(|c| json!({ "name": c.name, "gflops": c.gflops })).collect::<Vec<_>>();
    json!({
        "ceiling_gflops": best, "ceiling_of": ceiling(candidates).map(|c| &c.name), "ceiling_candidates": list,
        "ceiling_left_out": left_out, "threads": parallel::threads(),
        "rows": measured.iter().map(|m| m.json(best)).collect::<Vec<_>>(),
    })
}

/// The ceiling in a line.
pub fn ceiling_text(section: &Value) -> String {
    let candidate = |c: &Value| {
        format!("{} {:.0}", c["name"].as_str().unwrap_or(""), c["gflops"].as_f64().unwrap_or(f64::NAN))
    };
    let list: Vec<String> =
        section["ceiling_candidates"].as_array().into_iter().flatten().map(candidate).collect();
    let left_out = section["ceiling_left_out"].as_str();
    format!(
        "Dense layers on {} threads; ceiling {:.0} GFLOP/s, the best round of: {}.{}",
        section["threads"],
        section["ceiling_gflops"].as_f64().unwrap_or(f64::NAN),
        list.join(", "),
        left_out.map_or_else(String::new, |why| format!(" Not among them: {why}.")),
    )
}

/// What the shares are, for table and page.
pub const NOTE: &str = "share: useful flops / seconds / ceiling, median and best round. Products: thread time in the kernels of a training step, \
     forward and backward, without biases, masks, encodings, rendering and sums over chunks. Pass: with all of these.";

/// Columns of the table.
pub const HEADER: [&str; 9] = [
    "network",
    "points",
    "products s",
    "GFLOP/s",
    "share products",
    "best",
    "pass s",
    "GFLOP/s",
    "share pass",
];

/// A row as text.
pub fn cells(row: &Value) -> Vec<String> {
    let name = row["network"].as_str().unwrap_or("").to_string();
    let points = row["points"].to_string();
    let number = |field: &str, digits: usize| {
        row[field].as_f64().map_or_else(|| "-".into(), |x| format!("{x:.digits$}"))
    };
    let percent =
        |field: &str| row[field].as_f64().map_or_else(|| "-".into(), |x| format!("{:.1}%", 100.0 * x));
    vec![
        name,
        points,
        number("products_seconds", 4),
        number("products_gflops", 0),
        percent("share_products"),
        percent("best_share_products"),
        number("pass_seconds", 4),
        number("pass_gflops", 0),
        percent("share_pass"),
    ]
}
