//! One pixel by hand: a proof without the registry, for the mutation tests.

use glam::DMat4;

use super::trace_pixel;
use crate::camera::{Camera, Intrinsics};
use crate::convention::{CS180, Conventions, Delta, Directions};

/// d = (3/4, 0, 1) has length 5/4: steps along t are 5/4 as long in space, and only one of the conventions multiplies them by that.
#[test]
fn steps_are_stretched_by_the_length_of_the_direction_where_that_is_the_convention() {
    let k = Intrinsics { fx: 4.0, fy: 4.0, cx: 1.5, cy: 0.5 };
    let camera = Camera { width: 8, height: 1, k, c2w: DMat4::IDENTITY, distortion: None };
    let trace = |delta: Delta| {
        let c = Conventions { delta, directions: Directions::Depth, ..CS180 };
        trace_pixel(&camera, (4, 0), (2.0, 6.0), &[0.5, 0.5], &[1.0, 1.0], &[[1.0; 3]; 2], [0.0; 3], &c)
    };
    let (plain, stretched) = (trace(Delta::Differences), trace(Delta::DifferencesTimesNorm));
    assert_eq!((plain.ray.d.to_array(), &plain.t), ([0.75, 0.0, 1.0], &vec![3.0, 5.0]));
    assert_eq!((plain.deltas[0], stretched.deltas[0]), (2.0, 2.5));
    assert_eq!(stretched.deltas[1], 1.25 * plain.deltas[1]);
    // Colors are white: the result is the opacity of the stretched steps.
    let opacity = 1.0 - crate::math::exp(-stretched.deltas[0] - stretched.deltas[1]);
    assert!((stretched.color[0] - opacity).abs() < 1e-15 && opacity < 1.0);
}
