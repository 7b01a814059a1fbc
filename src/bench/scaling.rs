//! Time and memory against size, with exponents fitted by least squares in log-log.

use serde_json::{Value, json};

use super::Kernel;
use super::rounds::Timer;

/// A kernel in several sizes.
#[derive(Clone, Copy)]
pub struct Scaling {
    /// The component.
    pub component: &'static str,
    /// The quantity that grows: points, samples, resolution, occupied fraction, width, threads.
    pub parameter: &'static str,
    /// What runs, in a line.
    pub about: &'static str,
    /// Its values.
    pub values: &'static [f64],
    /// The kernel at a value.
    pub prepare: fn(f64) -> Box<dyn Kernel>,
    /// Whether the kernel's memory is meaningful.
    pub memory: bool,
}

/// A scaling being measured.
pub struct Measured {
    scaling: Scaling,
    kernels: Vec<(Box<dyn Kernel>, Timer)>,
}

/// The kernels of all sizes.
pub fn prepare(scalings: &[Scaling], least: f64) -> Vec<Measured> {
    let one = |scaling: &Scaling| {
        let kernel = |&value: &f64| {
            let mut kernel = (scaling.prepare)(value);
            let timer = Timer::new(&mut *kernel, least);
            (kernel, timer)
        };
        Measured { scaling: *scaling, kernels: scaling.values.iter().map(kernel).collect() }
    };
    scalings.iter().map(one).collect()
}

impl Measured {
    /// All sizes, once.
    pub fn round(&mut self) {
        self.kernels.iter_mut().for_each(|(kernel, timer)| timer.round(&mut **kernel));
    }

    /// The row.
    pub fn json(&self) -> Value {
        let Scaling { component, parameter, about, values, memory, .. } = self.scaling;
        let seconds: Vec<f64> = self.kernels.iter().map(|(_, timer)| timer.median()).collect();
        let spread: Vec<f64> = self.kernels.iter().map(|(_, timer)| timer.spread()).collect();
        let bytes: Vec<f64> = self.kernels.iter().map(|(kernel, _)| kernel.bytes() as f64).collect();
        let memory_exponent = memory.then(|| exponent(values, &bytes)).flatten();
        json!({
            "component": component, "parameter": parameter, "about": about, "values": values,
            "seconds": seconds, "spread": spread, "exponent": exponent(values, &seconds),
            "memory_bytes": memory.then_some(bytes), "memory_exponent": memory_exponent,
        })
    }
}

/// The p of y = c x^p that fits best: least squares in log-log. `None` with fewer than two different x, or where a logarithm fails.
///
/// ```
/// use nerf_oracle::bench::scaling::exponent;
/// assert!((exponent(&[1.0, 2.0, 4.0], &[3.0, 12.0, 48.0]).unwrap() - 2.0).abs() < 1e-12);
/// assert_eq!(exponent(&[2.0, 2.0], &[1.0, 3.0]), None);
/// ```
pub fn exponent(x: &[f64], y: &[f64]) -> Option<f64> {
    let points: Vec<(f64, f64)> = x.iter().zip(y).map(|(x, y)| (x.ln(), y.ln())).collect();
    let n = points.len() as f64;
    let mean = |f: fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / n;
    let (x0, y0) = (mean(|p| p.0), mean(|p| p.1));
    let above = points.iter().map(|p| (p.0 - x0) * (p.1 - y0)).sum::<f64>();
    let below = points.iter().map(|p| (p.0 - x0).powi(2)).sum::<f64>();
    Some(above / below).filter(|p| p.is_finite() && below > 0.0)
}
