//! What people put in the place of a projection's parts, as one would write it; the first is the right one.

/// The mean in the picture.
pub(super) const MEAN: [&str; 17] = [
    "(fx x/z + cx, fy y/z + cy)",
    "(x, y) in the camera, not projected",
    "(cx - fx x/z, fy y/z + cy)",
    "(fx x/z + cx, cy - fy y/z)",
    "(cx - fx x/z, cy - fy y/z)",
    "(fx x/z + cx, fy y/z + cy) rounded down",
    "(fx x/z + cx, fy y/z + cy) rounded to whole pixels",
    "(fx x/z + cx, fx y/z + cy)",
    "(fy x/z + cx, fy y/z + cy)",
    "(2 fx x/(z W), 2 fy y/(z H))",
    "(fx x/z + W/2, fy y/z + H/2)",
    "(fx x/z, fy y/z)",
    "(x/z, y/z)",
    "((fx x/z + cx) (W - 1)/W, (fy y/z + cy) (H - 1)/H)",
    "(fx x/z + cx, fy y/z + cy) of the world's x, y, z",
    "((fx x/z + cx) (W - 1)/W, (fy y/z + cy) (H - 1)/H) cut off to whole pixels",
    "(fx x/z + W/2, fx y/z + H/2)",
];

/// The mean m in the camera, with R and T of the pose.
pub(super) const CAMERA: [&str; 8] = [
    "R m + T",
    "R^T (m - T), the pose inverted,",
    "R^T m + T",
    "m, as it is in the world,",
    "R (m - T)",
    "R m - T",
    "R m, not moved,",
    "R (m + T)",
];

/// The covariance that goes through the Jacobian.
pub(super) const TURNED: [&str; 6] = [
    "R Sigma R^T",
    "Sigma, not turned,",
    "R^T Sigma R",
    "D R Sigma R^T D, D = diag(1, -1, -1),",
    "D Sigma D, D = diag(1, -1, -1), not turned,",
    "R Sigma R",
];

/// The Jacobian's focal lengths.
pub(super) const FOCAL: [&str; 9] = [
    "(fx, fy)",
    "(1, 1)",
    "(fx, fx)",
    "(fy, fy)",
    "(2 fx / W, 2 fy / H)",
    "(2 fx / W, 2 fx / W)",
    "of K R's diagonal",
    "of R's diagonal",
    "(2 fx / W, -2 fy / H)",
];

/// The point whose Jacobian is taken.
pub(super) const AT: [&str; 4] = [
    "(x, y, z) in the camera",
    "(x, y, z) in the world",
    "(u, v, z), u and v the mean in the picture",
    "((2 fx x + (2 cx - W) z) / W, (2 fy y + (2 cy - H) z) / H, z), the mean in clip space",
];

/// What divides in the mean and in the Jacobian.
pub(super) const DIVISOR: [&str; 6] =
    ["z", "max(z, 0.01)", "max(z, 0.1)", "max(z, 0.2)", "max(z, 0.3)", "max(z, 1)"];

/// The Jacobian.
pub(super) const JACOBIAN: [&str; 10] = [
    "= (f/z, 0, -f x/z^2; 0, f/z, -f y/z^2)",
    "without its depth column",
    "with + in its depth column",
    "with + in the depth column of y alone",
    "with + in the depth column of x alone",
    "with the distance for z",
    "not divided by z, with z in its depth column",
    "with z for z^2 in its depth column",
    "with y for x and x for y",
    "= (1, 0, 0; 0, 1, 0)",
];

/// How far beside the picture it is taken.
pub(super) const HELD: [&str; 13] = [
    "what it is by convention",
    "nothing",
    "1.3 of the half picture on either side",
    "0.3 of the half picture beyond its edges",
    "1.3 times the whole angle",
    "1.3 on either side",
    "1.3 tan(1/2) on either side",
    "0.15 of the picture beyond its edges",
    "1.3 of half the width on either side, in y too",
    "z in x/z and y/z of J held to 1.3 W/(2 fx) and 1.3 H/(2 fy) on either side",
    "1.3 max(cx, W - cx) / fx and 1.3 max(cy, H - cy) / fy on either side",
    "1.3 times the tangent of the whole angle",
    "1.3 fx / z and 1.3 fy / z on either side",
];

/// What is added to the variances.
pub(super) const ADDED: [&str; 14] = [
    "",
    "nothing",
    "1e-6",
    "1e-4",
    "0.01",
    "0.1",
    "0.3",
    "0.5",
    "1",
    "1.5",
    "1e-3",
    "0.3 in every entry",
    "1e-4 (W/2)^2 and 1e-4 (H/2)^2",
    "what the smaller eigenvalue lacks of a tenth of the larger one",
];

/// What becomes of the number off the diagonal.
pub(super) const MIXED: [&str; 4] = ["b", "-b", "0", "b / 2"];

/// The conic.
pub(super) const CONIC: [&str; 14] = [
    "(c, -b, a) / det",
    "(c, -b, a) / (det + 1e-6)",
    "(c, -b, a) / (det + 1e-7)",
    "(c, -b, a) / max(det, 1e-6)",
    "(c, -b, a), not divided",
    "(c, b, a) / det",
    "(a, -b, c) / det",
    "(c, -b, a) / det of variances with 1e-6 added once more",
    "(c, -b, a) / det of variances with nothing added",
    "(a, b, c), the covariance itself",
    "(c, -b, a) / (a c + b^2)",
    "(c, -b, a) / max(det, 1e-8)",
    "(c, -b, a) / max(det, 1e-10)",
    "(c, -b, a) / max(det, 1e-12)",
];

/// The radius, lambda the larger eigenvalue.
pub(super) const RADIUS: [&str; 29] = [
    "ceil(3 sqrt(lambda))",
    "3 sqrt(lambda)",
    "ceil(3 sqrt(max(a, c)))",
    "3 sqrt(max(a, c))",
    "ceil(3 sqrt(sqrt(det)))",
    "3 sqrt(sqrt(det))",
    "ceil(2 sqrt(lambda))",
    "ceil(3.33 sqrt(lambda))",
    "ceil(3 sqrt(lambda)) + 1",
    "3 sqrt(lambda) rounded",
    "3 sqrt(lambda) rounded down",
    "sqrt(lambda)",
    "3 lambda",
    "ceil(3 sqrt(lambda)) of variances with nothing added",
    "ceil(3 sqrt(a + c))",
    "3 sqrt(a + c)",
    "ceil(3 sqrt(lambda)), at most 64",
    "3 sqrt(lambda), at most 64",
    "ceil(3 sqrt(max(a, c))), at most 64",
    "0",
    "3 ceil(sqrt(lambda))",
    "3 / sqrt(min(a, c) / det)",
    "3 / (sqrt(min(a, c) / det) + 1e-4)",
    "ceil(3 sqrt(lambda)), from 1 to 64",
    "ceil(3 sqrt(lambda)), with nothing held up in lambda",
    "3 sqrt(lambda), with nothing held up in lambda",
    "ceil(2.5 sqrt(lambda))",
    "ceil(3 sqrt(lambda)) + 1, at most 50",
    "ceil(3 sqrt(lambda)), 0 where the mean lies outside of the picture",
];

/// The depth.
pub(super) const DEPTH: [&str; 10] = [
    "z",
    "|t|",
    "-z",
    "1/z",
    "max(z, 0.01)",
    "max(z, 0.1)",
    "max(z, 0.2)",
    "max(z, 1)",
    "max(z, 0.3)",
    "z of the world",
];
