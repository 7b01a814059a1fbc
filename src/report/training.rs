//! The chart of a run.

use super::curve::{self, Series};
use crate::training::run::LogPoint;

/// PSNR over steps as SVG: of training batches, of the probe, and of full validations.
pub(crate) fn curve(scene: &str, log: &[LogPoint]) -> String {
    let series = |name: &str, value: fn(&LogPoint) -> Option<f64>| Series {
        name: name.into(),
        points: log.iter().filter_map(|p| Some((p.step as f64, value(p)?))).collect(),
    };
    let all = [
        series("training batch", |p| Some(p.train_psnr)),
        series("validation, some pixels", |p| p.val_probe),
        series("validation, all pixels", |p| p.val_psnr),
    ];
    curve::svg(&format!("PSNR, {scene}"), "step", "dB", &all)
}
