//! What is wrong with rotations, what it does, and where it was seen; and what motions share with them.

use crate::contract::component::Mistake;

pub(super) const NAN_AT_ZERO: Mistake = Mistake::new(
    "not_a_number_at_zero",
    "w / |w| for the axis, or a factor's quotient, where the angle is 0",
    "refinement begins at 0: every pose is NaN from the first step on",
    "the factors' limits 1, 1/2 and 1/6, by a selection or a series",
    "NVlabs/instant-ngp#303: the camera's rotation offset, which begins at 0, divided by its length",
    1,
);
pub(super) const IDENTITY_WHEN_SMALL: Mistake = Mistake::new("identity_when_small","the identity below a limit of the angle","small corrections are lost, and where autograd sees it their gradient: a pose that begins at 0 never moves","I + K and half of K^2, or a series: they are no dearer","SNURobotics/optimal-excitation libraries/lie/exp_so3.m, with 1e-14, a code in numpy, with 1e-6; the gradient of it: oarriaga/paz#383",2)
.with("limit", 1e-5, [1e-9, 0.5]);
pub(super) const FIRST_ORDER_WHEN_SMALL: Mistake = Mistake::new(
    "first_order_when_small",
    "I + K below a limit of the angle",
    "no rotation there: off by half of the angle's square",
    "and half of K^2, or a series",
    "never; cheap to keep",
    0,
)
.with("limit", 1e-2, [1e-7, 0.5])
.like_lost_digits();
pub(super) const POWER_SERIES: Mistake = Mistake::new(
    "power_series",
    "the powers of K (of the twist's matrix), each over its factorial, and so many of them",
    "no rotation for large angles; with a few terms none at all",
    "Rodrigues' formula: its factors are the sums of all of them",
    "never; cheap to keep",
    0,
)
.with("terms", 2.0, [2.0, 40.0]);
pub(super) const EPS_IN_AXIS: Mistake = Mistake::new(
    "eps_in_axis",
    "w / (|w| + eps) for the axis",
    "the axis isn't of unit length: no rotation, and none at all for angles below eps",
    "a case of its own for 0, or the factors' series",
    "a rotation's projection in torch: 0.001",
    1,
)
.with("eps", 1e-3, [1e-9, 1e-1]);
pub(super) const EPS_IN_VECTOR: Mistake = Mistake::new(
    "eps_in_vector",
    "|w + eps| for the angle, each entry moved",
    "small turns are turned too far or not far enough, by the eps",
    "a case of its own for 0, or the factors' series",
    "batch_rodrigues of body models: 1e-8, which f32 doesn't notice",
    1,
)
.with("eps", 1e-8, [1e-9, 1e-1]);
pub(super) const CAYLEY_WHEN_SMALL: Mistake = Mistake::new(
    "cayley_when_small",
    "below an angle of 0.01 the cosine (4 - theta^2) / (4 + theta^2), and (1 + cos) / 2 for sin theta / theta: 1 - theta^2 / 4 for 1 - theta^2 / 6",
    "a rotation, but by 2 atan(theta / 2): the angle jumps by 8e-6 of it at 0.01, 140 of f32's last digits",
    "1 - theta^2 / 6, and 1/2 - theta^2 / 24",
    "nerfstudio's exp_map_SE3, and Theseus, which it is from",
    2,
);
pub(super) const SERIES_CUT_SHORT: Mistake = Mistake::new(
    "series_cut_short",
    "eleven terms of each factor's series, for every angle",
    "right to 1e-11 up to half a turn; at a whole one 8e-5 off, at one and a half as far off as entries are large",
    "quotients for large angles, the series for small ones",
    "BARF's camera.py, taylor_A with nth=10, and what copied it",
    1,
);
pub(super) const DEGREES: Mistake = Mistake::new(
    "degrees",
    "w in degrees",
    "turns are 57 times too small: poses hardly move",
    "radians",
    "never; cheap to keep",
    0,
);
pub(super) const NAN_GRADIENT: Mistake = Mistake::new(
    "gradient_not_a_number_at_zero",
    "both branches differentiated, one selected: 0 times the slope of a root at 0",
    "the first step makes every pose NaN",
    "select the angle, not the result: a safe angle inside of the quotients (jaxlie), or the squared angle's series",
    "kornia's So3.exp and Se3.exp: where(theta != 0, ...)",
    1,
)
.of_gradient();
pub(super) const NO_GRADIENT: Mistake = Mistake::new(
    "no_gradient_at_zero",
    "a constant where the angle is 0",
    "a pose that begins at 0 stays there",
    "its derivative at 0: K's own, as the factor is 1",
    "oarriaga/paz#383: SO3.exp by a safe norm that is a constant 0 at 0; mesh poses didn't move",
    1,
)
.of_gradient();
pub(super) const FACTORS_CONSTANT: Mistake = Mistake::new(
    "factors_held_constant",
    "the factors of K and K^2 aren't differentiated: the angle is detached",
    "small turns learn nearly right, large ones turn their axis instead of themselves",
    "and the slopes of the factors, times w",
    "never; cheap to keep",
    0,
)
.of_gradient();

/// Mistakes of rotation vectors.
pub(crate) const SO3_EXP: &[Mistake] = &[
    NAN_AT_ZERO,
    Mistake::new(
        "turned_backward",
        "K transposed, or -w: R^T",
        "refinement moves poses away from where they should go",
        "K = [0, -z, y; z, 0, -x; -y, x, 0]",
        "NVlabs/instant-ngp before af9434e (#303): the sign of the rotation was incorrect",
        1,
    ),
    Mistake::new(
        "axis_not_normalized",
        "sin theta K + (1 - cos theta) K^2 with K = [w]_x, not that of w / |w|",
        "no rotation but for angles of 1: pictures shrink and shear",
        "divide by the angle and by its square, or w by its length",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "divided_by_angle_once",
        "(1 - cos theta) / theta K^2",
        "no rotation: worse the further from an angle of 1",
        "theta^2",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "square_forgotten",
        "I + sin(theta) / theta K",
        "pictures grow with the angle, by half of its square",
        "and (1 - cos theta) / theta^2 K^2",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "first_order",
        "I + K",
        "no rotation beyond the smallest angles: composed step by step, poses grow",
        "Rodrigues' formula",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "angle_doubled",
        "the quaternion of the whole angle: (cos theta, sin theta w / |w|)",
        "everything turns twice as far",
        "half of the angle in a quaternion",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "euler_angles",
        "Rx Ry Rz of the three numbers",
        "right about an axis, and the further off the more axes turn",
        "one axis, and its angle",
        "a browser's port of the body model Anny, 31 mm off",
        1,
    ),
    Mistake::new("square_not_divided","sin(theta) / theta K + (1 - cos theta) K^2: K = [w]_x in both, and one of the two factors for it","no rotation: worse the further from an angle of 1","(1 - cos theta) / theta^2","never; cheap to keep",0),
    Mistake::new("square_by_element","K * K for K @ K: each entry squared","no rotation","a product of matrices","never; cheap to keep",0),
    Mistake::new("outer_product_forgotten","cos(theta) I + sin(theta) / theta K: without (1 - cos theta) u u^T","what lies along the axis shrinks by the cosine","all three terms, or I and K^2","never; cheap to keep",0),
    Mistake::new("cosine_with_square","cos(theta) I, which goes with u u^T, beside (1 - cos theta) K^2, which goes with I","what lies along the axis shrinks by the cosine, what lies across by more","I + ... K^2, or cos(theta) I + ... u u^T","never; cheap to keep",0),
    Mistake::new("root_forgotten","w . w for the angle","small turns vanish, large ones run wild","its root","never; cheap to keep",0),
    Mistake::new("norm_of_all_vectors","one norm for the whole batch: without its axis","every rotation depends on the others in the batch","the norm along the last axis","never in this row; as norm_of_all_rays of directions",0),
    Mistake::new("cayley_map","(I - K/2)^-1 (I + K/2), or the quaternion (1, w/2) made unit: a turn by 2 atan(theta / 2)","turns are too short, the more the larger they are","the exponential","never; cheap to keep",0),
    Mistake::new("euler_angles_reversed","Rz Ry Rx of the three numbers","right about an axis, and the further off the more axes turn","one axis, and its angle","never by itself; rotations of three angles are written in this order most often",0),
    EPS_IN_AXIS,
    EPS_IN_VECTOR,
    POWER_SERIES,
    DEGREES,
    IDENTITY_WHEN_SMALL,
    FIRST_ORDER_WHEN_SMALL,
    CAYLEY_WHEN_SMALL,
    SERIES_CUT_SHORT,
    NAN_GRADIENT,
    NO_GRADIENT,
    FACTORS_CONSTANT,
    Mistake::new(
        "as_if_at_zero",
        "the gradient at 0, (G21 - G12, G02 - G20, G10 - G01), wherever w is",
        "refinement turns about wrong axes, once poses have turned",
        "the chain rule at w; or compose the pose with a turn that begins at 0, and start again at 0 after each step",
        "never by itself; codes that compose after each step have it by right",
        0,
    )
    .of_gradient(),
];
