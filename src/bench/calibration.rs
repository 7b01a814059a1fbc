//! The machine's peak in the same minutes: a large matrix product, products of a layer's shape, and random reads from a table beyond
//! the caches of a core.

use serde_json::{Value, json};

use super::dense::CeilingCandidate;
use super::rounds::{quantile, seconds};
use crate::field::fast::{sgemm, sgemm_layer};
use crate::parallel;

/// Entries of 8 bytes: 16 MB.
const TABLE: usize = 1 << 21;
/// Reads of a thread and round.
const READS: usize = 1 << 22;

/// A layer's product: rows, columns, terms. Each thread has its own, as the fast path's threads have their own chunks.
const LAYER: [usize; 3] = [1024, 256, 256];

/// The machine's figures, round by round.
#[derive(Debug)]
pub struct Calibration {
    n: usize,
    /// A thread's products of a round.
    repeats: usize,
    layers: Vec<[Vec<f32>; 3]>,
    layer_gflops: Vec<f64>,
    matrices: [Vec<f32>; 3],
    table: Vec<u64>,
    gflops: Vec<f64>,
    reads: Vec<f64>,
}

impl Calibration {
    /// A product of 4096^3, 1024^3 where `quick`; 64 of 1024 x 256 x 256 a thread, 16 where `quick`.
    pub fn new(quick: bool) -> Self {
        let n = if quick { 1024 } else { 4096 };
        let fill = |i: usize| (i % 61) as f32 / 61.0 - 0.5;
        let matrix = |entries: usize| (0..entries).map(fill).collect::<Vec<f32>>();
        let [rows, columns, terms] = LAYER;
        let layer = |_| [rows * terms, terms * columns, rows * columns].map(matrix);
        let table = (0..TABLE as u64).map(|i| i.wrapping_mul(0x9E37_79B9_7F4A_7C15)).collect();
        Calibration {
            n,
            repeats: if quick { 16 } else { 64 },
            layers: (0..parallel::threads()).map(layer).collect(),
            layer_gflops: vec![],
            matrices: [n * n; 3].map(matrix),
            table,
            gflops: vec![],
            reads: vec![],
        }
    }

    /// All of them, once.
    pub fn round(&mut self) {
        let [a, b, c] = &mut self.matrices;
        let n = self.n;
        let product = seconds(|| sgemm(n, a, b, c));
        self.gflops.push(2.0 * (n as f64).powi(3) / product / 1e9);
        let (repeats, count) = (self.repeats, self.repeats * self.layers.len());
        let layers = seconds(|| {
            parallel::for_each(&mut self.layers, |[a, b, c]| {
                (0..repeats).for_each(|_| sgemm_layer(LAYER, a, b, c));
            });
        });
        let flops = LAYER.iter().fold(2.0, |flops, &side| flops * side as f64);
        self.layer_gflops.push(count as f64 * flops / layers / 1e9);
        let (threads, table) = (parallel::threads(), &self.table);
        let mut sums = vec![];
        let read = seconds(|| sums = parallel::map(threads, |thread| read(table, thread as u64 + 1)));
        std::hint::black_box(&sums);
        self.reads.push((threads * READS) as f64 / read);
    }

    /// The candidates for the ceiling of dense layers: the best rounds.
    pub fn candidates(&self) -> Vec<CeilingCandidate> {
        let [m, n, k] = LAYER;
        let small = if self.n < 4096 { " (quick: not 4096^3)" } else { "" };
        let names = [format!("gemm {}^3{small}", self.n), format!("gemm {m}x{n}x{k}, one a thread")];
        let best = [&self.gflops, &self.layer_gflops].map(|gflops| quantile(gflops, 1.0));
        names.into_iter().zip(best).map(|(name, gflops)| CeilingCandidate { name, gflops }).collect()
    }

    /// For rows and reports.
    pub fn json(&self) -> Value {
        json!({
            "sgemm_gflops": quantile(&self.gflops, 0.5), "sgemm_size": self.n,
            "sgemm_best_gflops": quantile(&self.gflops, 1.0), "quick": self.n < 4096,
            "sgemm_layer_gflops": quantile(&self.layer_gflops, 0.5),
            "sgemm_layer_best_gflops": quantile(&self.layer_gflops, 1.0), "sgemm_layer_shape": LAYER,
            "random_reads_per_second": quantile(&self.reads, 0.5), "table_bytes": 8 * TABLE,
            "threads": parallel::threads(), "cores": cores(), "cpu": cpu(),
        })
    }
}

/// The sum of random entries. The next address doesn't depend on the value read, so several reads are in flight at once.
fn read(table: &[u64], seed: u64) -> u64 {
    let (mut state, mut sum) = (seed.wrapping_mul(0x2545_F491_4F6C_DD1D), 0u64);
    for _ in 0..READS {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        sum = sum.wrapping_add(table[state as usize % TABLE]);
    }
    sum
}

/// Processors that this program may use.
pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, |n| n.get())
}

/// The processor's name if the system reports it, otherwise its architecture.
pub fn cpu() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let line = info.lines().find(|line| line.starts_with("model name"));
    let name = line.and_then(|line| line.split(':').nth(1)).map(|name| name.trim().to_string());
    name.unwrap_or_else(|| std::env::consts::ARCH.into())
}
