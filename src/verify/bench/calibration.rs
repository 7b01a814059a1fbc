//! What the machine can do in the same minutes: a large matrix product, and random reads from a table beyond the caches of a core.

use serde_json::{Value, json};

use super::rounds::{quantile, seconds};
use crate::field::fast::sgemm;
use crate::parallel;

/// Entries of 8 bytes: 16 MB.
const TABLE: usize = 1 << 21;
/// Reads of a thread and round.
const READS: usize = 1 << 22;

/// The machine's figures, round by round.
pub struct Calibration {
    n: usize,
    matrices: [Vec<f32>; 3],
    table: Vec<u64>,
    gflops: Vec<f64>,
    reads: Vec<f64>,
}

impl Calibration {
    /// A product of 4096^3, 1024^3 where `quick`.
    pub fn new(quick: bool) -> Self {
        let n = if quick { 1024 } else { 4096 };
        let fill = |i: usize| (i % 61) as f32 / 61.0 - 0.5;
        let matrix = || (0..n * n).map(fill).collect();
        let table = (0..TABLE as u64).map(|i| i.wrapping_mul(0x9E37_79B9_7F4A_7C15)).collect();
        Calibration { n, matrices: [matrix(), matrix(), matrix()], table, gflops: vec![], reads: vec![] }
    }

    /// Both, once.
    pub fn round(&mut self) {
        let [a, b, c] = &mut self.matrices;
        let n = self.n;
        let product = seconds(|| sgemm(n, a, b, c));
        self.gflops.push(2.0 * (n as f64).powi(3) / product / 1e9);
        let (threads, table) = (parallel::threads(), &self.table);
        let mut sums = vec![];
        let read = seconds(|| sums = parallel::map(threads, |thread| read(table, thread as u64 + 1)));
        std::hint::black_box(&sums);
        self.reads.push((threads * READS) as f64 / read);
    }

    /// For rows and reports.
    pub fn json(&self) -> Value {
        json!({
            "sgemm_gflops": quantile(&self.gflops, 0.5), "sgemm_size": self.n,
            "random_reads_per_second": quantile(&self.reads, 0.5), "table_bytes": 8 * TABLE,
            "threads": parallel::threads(), "cores": cores(), "cpu": cpu(),
        })
    }
}

/// The sum of random entries. Where the next read goes doesn't depend on what was read: several are under way at once.
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

/// The processor's name where the system tells it, else its architecture.
pub fn cpu() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let line = info.lines().find(|line| line.starts_with("model name"));
    let name = line.and_then(|line| line.split(':').nth(1)).map(|name| name.trim().to_string());
    name.unwrap_or_else(|| std::env::consts::ARCH.into())
}
