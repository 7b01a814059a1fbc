//! Closed forms, what the projection of an affine camera is, and slopes.

use approx::assert_relative_eq;
use proptest::prelude::*;

use super::{Form, Splat, View, backward, project};
use crate::camera::Intrinsics;
use crate::contract::testing::{properties, slope};
use crate::convention::{
    CompensationFloor, RadiusFloor, SplatCenter, SplatClamp, SplatClampGradient, SplatCulling, SplatDilation,
};

const STRAIGHT: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// A camera at the origin.
fn straight() -> View {
    let k = Intrinsics { fx: 40.0, fy: 44.0, cx: 28.0, cy: 26.0 };
    View { rotation: STRAIGHT, translation: [0.0; 3], k, width: 64.0, height: 48.0 }
}

/// The same turned and moved.
fn turned() -> View {
    let rotation = crate::gaussian_covariance::rotation([0.8, 0.2, -0.4, 0.4]);
    View { rotation, translation: [0.5, -0.25, 3.0], ..straight() }
}

/// A A^T of an A with a diagonal that isn't small.
fn covariance() -> impl Strategy<Value = [f64; 6]> {
    (prop::array::uniform3(0.2..1.0), prop::array::uniform3(-0.5..0.5)).prop_map(|([a, b, c], [d, e, f])| {
        [a * a, a * d, a * e, d * d + b * b, d * e + b * f, e * e + f * f + c * c]
    })
}

fn cotangent() -> impl Strategy<Value = Splat> {
    prop::collection::vec(-1.0..1.0, 10).prop_map(|g| Splat {
        mean: [g[0], g[1]],
        covariance: [g[2], g[3], g[4]],
        conic: [g[5], g[6], g[7]],
        depth: g[8],
        radius: 0.0,
        compensation: g[9],
    })
}

fn inner(s: &Splat, g: &Splat) -> f64 {
    let three = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let mean = s.mean[0] * g.mean[0] + s.mean[1] * g.mean[1];
    let shape = three(s.covariance, g.covariance) + three(s.conic, g.conic);
    mean + shape + s.depth * g.depth + s.compensation * g.compensation
}

fn assert_gradient(mean: [f64; 3], sigma: [f64; 6], view: &View, form: Form, g: &Splat) {
    let (g_mean, g_sigma) = backward::project(mean, sigma, view, form, g);
    let close = |by_hand: f64, f: &dyn Fn(f64) -> f64| {
        let h = 1.0 / 64.0;
        let by_differences = slope(|s| f(h * s)) / h;
        let size = 1e-6 * (1.0 + by_differences.abs() + by_hand.abs());
        assert!((by_hand - by_differences).abs() < size, "{form:?}: {by_hand} {by_differences}");
    };
    for k in 0..3 {
        close(g_mean[k], &|step| {
            let mut at = mean;
            at[k] += step;
            inner(&project(at, sigma, view, form), g)
        });
    }
    for k in 0..6 {
        close(g_sigma[k], &|step| {
            let mut at = sigma;
            at[k] += step;
            inner(&project(mean, at, view, form), g)
        });
    }
}

proptest! {
    #![proptest_config(properties())]

    /// The picture's covariance is that of points: J R v, summed over the axes v of the Gaussian.
    #[test]
    fn the_jacobian_is_that_of_the_mean(at in prop::array::uniform3(-0.5..0.5), v in prop::array::uniform3(-1.0..1.0)) {
        let view = turned();
        let sigma = [v[0] * v[0], v[0] * v[1], v[0] * v[2], v[1] * v[1], v[1] * v[2], v[2] * v[2]];
        let splat = project(at, sigma, &view, Form::default());
        let place = |axis: usize| slope(|s| {
            project([0, 1, 2].map(|k| at[k] + s * v[k]), sigma, &view, Form::default()).mean[axis]
        });
        let [x, y] = [place(0), place(1)];
        for (found, expected) in splat.covariance.iter().zip([x * x + 0.3, x * y, y * y + 0.3]) {
            prop_assert!((found - expected).abs() < 1e-6 * (1.0 + expected.abs()), "{found} {expected}");
        }
    }

    #[test]
    fn the_conic_is_the_inverse(at in prop::array::uniform3(-0.5..0.5), sigma in covariance()) {
        let Splat { covariance: [a, b, c], conic: [x, y, z], .. } = project(at, sigma, &turned(), Form::default());
        prop_assert!((a * x + b * y - 1.0).abs() < 1e-9 && (b * y + c * z - 1.0).abs() < 1e-9);
        prop_assert!((a * y + b * z).abs() < 1e-9 * (a * z) && (b * x + c * y).abs() < 1e-9 * (c * x));
    }

    #[test]
    fn gradients_in_the_picture_are_those_of_differences(
        at in prop::array::uniform3(-0.4..0.4),
        sigma in covariance(),
        g in cotangent(),
    ) {
        for (center, dilation) in [(SplatCenter::Half, SplatDilation::ThreeTenths), (SplatCenter::Integer, SplatDilation::Tenth)] {
            assert_gradient(at, sigma, &turned(), Form { center, dilation, ..Form::default() }, &g);
        }
    }

    /// GS3: beside the picture, on either side of either axis.
    #[test]
    fn gradients_beside_the_picture_are_those_of_differences(
        x in 3.0..6.0f64,
        y in 3.0..6.0f64,
        signs in prop::array::uniform2(-1i8..=1),
        sigma in covariance(),
        g in cotangent(),
    ) {
        let at = [f64::from(signs[0]) * x, f64::from(signs[1]) * y, 2.0];
        for clamp in [SplatClamp::Picture, SplatClamp::Centered, SplatClamp::None] {
            assert_gradient(at, sigma, &straight(), Form { clamp, ..Form::default() }, &g);
        }
    }
}

/// GS3: with t_x held, the Jacobian's last column falls with z^2, not z.
#[test]
fn a_held_mean_counts_twice() {
    let (at, sigma) = ([6.0, 0.0, 2.0], [0.25, 0.0, 0.0, 0.25, 0.0, 0.25]);
    let g = Splat {
        mean: [0.0; 2],
        covariance: [1.0, 0.0, 0.0],
        conic: [0.0; 3],
        depth: 0.0,
        radius: 0.0,
        compensation: 0.0,
    };
    let gradient = |clamp_gradient| {
        backward::project(at, sigma, &straight(), Form { clamp_gradient, ..Form::default() }, &g).0
    };
    // P = (f/z) (1, 0, -l), variance (f/z)^2 (1 + l^2) / 4; with the slope held its slope along z is -(f^2/z^3) (1 + l^2) / 2.
    let limit = 36.0 / 40.0 + 0.3 * 0.8;
    let through = -0.5 * 1600.0 / 8.0 * (1.0 + limit * limit);
    assert_relative_eq!(gradient(SplatClampGradient::Through)[2], through, max_relative = 1e-14);
    let more = -0.5 * 1600.0 / 8.0 * limit * limit;
    assert_relative_eq!(gradient(SplatClampGradient::Held)[2], through + more, max_relative = 1e-14);
    assert_eq!(gradient(SplatClampGradient::Held)[0], 0.0);
}

#[test]
fn means_are_turned_moved_and_divided_by_their_depth() {
    let rotation = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]];
    let view = View { rotation, translation: [0.5, -1.0, 4.0], ..straight() };
    let splat = project([1.0, 2.0, 3.0], [0.25, 0.0, 0.0, 0.25, 0.0, 0.25], &view, Form::default());
    assert_eq!(splat.depth, 5.0);
    assert_relative_eq!(splat.mean[0], 40.0 * 0.5 + 28.0, max_relative = 1e-15);
    assert_relative_eq!(splat.mean[1], 44.0 * 0.4 + 26.0, max_relative = 1e-15);
}

#[test]
fn limits_are_where_the_code_bases_have_them() {
    // A line along x + z, or y + z, has the deviation (f/z) |1 - slope|.
    let deviation = |at: [f64; 3], axis: usize, clamp| {
        let mut line = [0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        line[3 * axis] = 1.0;
        line[2 * (axis + 1)] = 1.0;
        let form = Form { clamp, ..Form::default() };
        let variance = project(at, line, &straight(), form).covariance[2 * axis] - 0.3;
        variance.sqrt() * at[2] / [40.0, 44.0][axis]
    };
    let sides = [([9.0, 0.0, 1.0], 0), ([-9.0, 0.0, 1.0], 0), ([0.0, 9.0, 1.0], 1), ([0.0, -9.0, 1.0], 1)];
    let (half_x, half_y): (f64, f64) = (32.0 / 40.0, 24.0 / 44.0);
    let picture = [
        36.0 / 40.0 + 0.3 * half_x,
        -(28.0 / 40.0 + 0.3 * half_x),
        22.0 / 44.0 + 0.3 * half_y,
        -(26.0 / 44.0 + 0.3 * half_y),
    ];
    let centered = [1.3 * half_x, -1.3 * half_x, 1.3 * half_y, -1.3 * half_y];
    let nowhere = [9.0, -9.0, 9.0, -9.0];
    for (n, (at, axis)) in sides.into_iter().enumerate() {
        for (clamp, slopes) in
            [(SplatClamp::Picture, picture), (SplatClamp::Centered, centered), (SplatClamp::None, nowhere)]
        {
            let found = deviation(at, axis, clamp);
            assert_relative_eq!(found, (1.0 - slopes[n]).abs(), max_relative = 1e-9);
        }
    }
}

/// GS4: what has no area is invisible, and finite.
#[test]
fn a_point_is_its_dilation() {
    let splat = project([0.0, 0.0, 2.0], [0.0; 6], &straight(), Form::default());
    assert_eq!((splat.covariance, splat.conic), ([0.3, 0.0, 0.3], [1.0 / 0.3, 0.0, 1.0 / 0.3]));
    assert_eq!((splat.mean, splat.radius, splat.compensation), ([28.0, 26.0], 3.0, 0.0));
    let inria = Form {
        center: SplatCenter::Integer,
        compensation: CompensationFloor::FiveThousandths,
        radius: RadiusFloor::None,
        ..Form::default()
    };
    let splat = project([0.0, 0.0, 2.0], [0.0; 6], &straight(), inria);
    assert_eq!((splat.mean, splat.radius, splat.compensation), ([27.5, 25.5], 2.0, 0.005));
    let g = Splat {
        compensation: 1.0,
        mean: [0.0; 2],
        covariance: [0.0; 3],
        conic: [0.0; 3],
        depth: 0.0,
        radius: 0.0,
    };
    for form in [Form::default(), inria] {
        let gradient = backward::project([0.0, 0.0, 2.0], [0.0; 6], &straight(), form, &g);
        assert_eq!(gradient, ([0.0; 3], [0.0; 6]), "{form:?}");
    }
}

/// A point's determinants are 0 and 0.09: with both held up, the root of what the floor is of the latter.
#[test]
fn determinants_have_a_floor() {
    for (compensation, least) in
        [(CompensationFloor::Millionth, 1e-6), (CompensationFloor::Trillionth, 1e-12)]
    {
        let form = Form { compensation, ..Form::default() };
        let point = project([0.0, 0.0, 2.0], [0.0; 6], &straight(), form);
        assert_relative_eq!(point.compensation, f64::sqrt(least / 0.09), max_relative = 1e-14);
        let g = Splat { compensation: 1.0, ..Splat::NOWHERE };
        let (_, g_sigma) = backward::project([0.0, 0.0, 2.0], [0.0; 6], &straight(), form, &g);
        // Of (a + 0.3)(c + 0.3) alone, below the root: -compensation/2 / 0.3 for each variance, by (f/z)^2.
        for (entry, f) in [(0, 40.0), (3, 44.0)] {
            let by_hand = -0.5 * point.compensation / 0.3 * (f / 2.0) * (f / 2.0);
            assert_relative_eq!(g_sigma[entry], by_hand, max_relative = 1e-14);
        }
    }
}

/// A line has no determinant to learn by, an ellipse has: of variances 100 and 121, and 110 or 44 between them.
#[test]
fn a_determinant_at_its_floor_does_not_learn() {
    let form = Form { compensation: CompensationFloor::Millionth, ..Form::default() };
    let g = Splat { compensation: 1.0, ..Splat::NOWHERE };
    for (xy, learns) in [(0.25, 0.0), (0.1, 1.0)] {
        let sigma = [0.25, xy, 0.0, 0.25, 0.0, 0.0];
        let splat = project([0.0, 0.0, 2.0], sigma, &straight(), form);
        let (_, g_sigma) = backward::project([0.0, 0.0, 2.0], sigma, &straight(), form, &g);
        let ([a, b, c], left) = (splat.covariance, splat.compensation);
        let twice = 2.0 * (a * c - b * b);
        let by_hand = 400.0 * (learns * (c - 0.3) / left - left * c) / twice;
        assert_relative_eq!(g_sigma[0], by_hand, max_relative = 1e-9);
    }
}

/// A circle of 3 pixels about a point 4 pixels beside the picture, or 3, and 2.
#[test]
fn what_misses_the_picture_is_nowhere() {
    let form = Form { culling: SplatCulling::Zero, ..Form::default() };
    let at = |x: f64, y: f64| {
        let mean = [(x - 28.0) / 20.0, (y - 26.0) / 22.0, 2.0];
        (
            project(mean, [0.0; 6], &straight(), form),
            backward::project(mean, [0.0; 6], &straight(), form, &ONES),
        )
    };
    for (x, y) in [(-4.0, 20.0), (-3.0, 20.0), (67.0, 20.0), (68.0, 20.0), (20.0, -4.0), (20.0, 52.0)] {
        assert_eq!(at(x, y), (Splat::NOWHERE, ([0.0; 3], [0.0; 6])), "({x}, {y})");
    }
    for (x, y) in [(-2.0, 20.0), (66.0, 20.0), (20.0, -2.0), (20.0, 50.0)] {
        let (splat, (g_mean, _)) = at(x, y);
        assert_eq!((splat.radius, splat.depth), (3.0, 2.0), "({x}, {y})");
        assert!(g_mean.iter().all(|g| *g != 0.0), "({x}, {y})");
    }
}

/// Cotangents of 1.
const ONES: Splat = Splat {
    mean: [1.0; 2],
    covariance: [1.0; 3],
    conic: [1.0; 3],
    depth: 1.0,
    radius: 0.0,
    compensation: 1.0,
};

/// The eigenvalues of a known ellipse: axes of 3 and 1 pixels along the diagonals.
#[test]
fn the_radius_is_three_deviations_of_the_long_axis() {
    let view = View { k: Intrinsics { fx: 1.0, fy: 1.0, cx: 0.0, cy: 0.0 }, ..straight() };
    let form = Form { radius: RadiusFloor::Hundredth, ..Form::default() };
    let splat = project([0.0, 0.0, 1.0], [4.7, 4.0, 0.0, 4.7, 0.0, 0.0], &view, form);
    assert_relative_eq!(splat.covariance[0], 5.0, max_relative = 1e-15);
    assert_eq!(splat.radius, 9.0, "sqrt(5 + 4) is 3");
    assert_relative_eq!(splat.compensation, f64::sqrt((4.7 * 4.7 - 16.0) / 9.0), max_relative = 1e-14);
    let round = project([0.0, 0.0, 1.0], [0.7, 0.0, 0.0, 0.7, 0.0, 0.0], &view, form);
    assert_eq!(round.radius, (3.0 * f64::sqrt(1.1)).ceil(), "a ball: the floor of 0.01 under the root");
    // Far from round, upright and slanted: a larger eigenvalue of 99.
    for sigma in [[98.7, 0.0, 0.0, 0.7, 0.0, 0.0], [49.7, 49.0, 0.0, 49.7, 0.0, 0.0]] {
        assert_eq!(project([0.0, 0.0, 1.0], sigma, &view, form).radius, 30.0);
    }
}
