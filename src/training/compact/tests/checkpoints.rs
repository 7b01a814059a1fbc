//! A model out of a checkpoint goes on as if it had never been away.

use super::{ball, bits, trained};
use crate::files::npz::Array;
use crate::training::Model;
use crate::training::compact::{CompactModel, Overrides};

#[test]
fn a_checkpoint_from_before_there_was_a_mean_has_the_parameters_for_it() {
    let mut state = trained(23).state();
    state.retain(|name, _| !name.ends_with("_mean"));
    let mut resumed = CompactModel::new(&ball(), &Overrides::default()).unwrap();
    resumed.restore(&state, "checkpoint").unwrap();
    assert!(resumed.levels.iter().all(|level| level.mean() == level.table()));
    assert_eq!(resumed.nets.mean.parts(), resumed.nets.weights.parts());
    let whole = trained(23);
    assert!(whole.levels[0].mean() != whole.levels[0].table(), "nothing was averaged yet");
}

#[test]
fn resumes_where_it_stood() {
    let scene = ball();
    let mut half = trained(23);
    // Everything that a step depends on: rays to draw again, and opaque cells.
    half.again = vec![7, 9];
    let most = half.occupancy.density.iter().copied().fold(0.0, f32::max);
    half.occupancy.apply_thresholds([0.25 * most, 0.5 * most]);
    assert!(half.occupancy.bits()[1].iter().any(|&word| word != 0), "some cell is opaque");
    let state = half.state();
    let mut whole = half;
    for step in 24..=40 {
        whole.step(&scene, step).unwrap();
    }
    let mut resumed = CompactModel::new(&scene, &Overrides::default()).unwrap();
    resumed.restore(&state, "checkpoint").unwrap();
    for step in 24..=40 {
        resumed.step(&scene, step).unwrap();
    }
    assert!(bits(&whole) == bits(&resumed));
    let mut beyond = state.clone();
    let pixels = Array::I64(ndarray::arr1(&[12 * 24 * 24]).into_dyn());
    beyond.insert("compact_again".into(), pixels);
    let error = resumed.restore(&beyond, "checkpoint").unwrap_err().to_string();
    assert!(error.contains("compact_again") && error.contains("pixels of the training pictures"), "{error}");
    let mut short = state;
    short.remove("level3_m");
    let error = resumed.restore(&short, "checkpoint").unwrap_err().to_string();
    assert!(error.contains("level3_m") && error.contains("checkpoint"), "{error}");
}
