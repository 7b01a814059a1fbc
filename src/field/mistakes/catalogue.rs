//! Descriptions of the mistakes in the networks.

use crate::contract::component::Mistake;
use crate::encoding::mistakes as encoding;

const SIGMOID_MISSING: Mistake = Mistake::new(
    "sigmoid_missing",
    "the color head's output is handed over as it is",
    "colors below 0 and above 1",
    "1 / (1 + e^-z)",
    "never; cheap to keep",
    0,
);
const RELU_BEFORE_SIGMOID: Mistake = Mistake::new(
    "relu_before_sigmoid",
    "the last layer has a ReLU too: sigmoid(max(z, 0))",
    "no color is darker than 1/2",
    "no ReLU after the last layer",
    "never; cheap to keep",
    0,
);
const BIAS_FORGOTTEN: Mistake = Mistake::new(
    "bias_forgotten",
    "z = w x",
    "black can't be learned",
    "z = w x + b",
    "never; cheap to keep",
    0,
);
const TRANSPOSED: Mistake = Mistake::new(
    "weights_transposed",
    "x w for w x in square layers",
    "parameters of another framework give noise",
    "transpose when loading (JAX and Keras keep (in, out))",
    "weight conversions",
    0,
);
pub(super) const NEVER_APPLIED: Mistake = Mistake::new(
    "layer_never_applied",
    "a square layer is built but left out of forward",
    "a smaller network; the layer has no gradient",
    "call every layer",
    "2 public implementations",
    2,
)
.with("layer", 1.0, [1.0, 8.0]);
pub(super) const LAYER_TWICE: Mistake = Mistake::new(
    "layer_twice",
    "layer n is applied in the place of layer n - 1, too",
    "a network of less freedom; the layer in front has no gradient",
    "call every layer, once",
    "1 public implementation",
    1,
)
.with("layer", 3.0, [1.0, 8.0]);
const SIGMOID_GRADIENT: Mistake = Mistake::new(
    "sigmoid_gradient_missing",
    "the gradient passes the sigmoid unchanged",
    "dark and bright colors overshoot",
    "multiply by y (1 - y)",
    "hand-written backward passes",
    0,
)
.of_gradient();
const RELU_MASK: Mistake = Mistake::new(
    "relu_mask_on_output",
    "the mask asks max(z, 0) >= 0, which always holds",
    "dead units are trained as if they were alive",
    "mask by z > 0",
    "hand-written backward passes",
    0,
)
.of_gradient();

pub(super) const LEAKY_UNITS: Mistake = Mistake::new(
    "leaky_units",
    "LeakyReLU in the hidden layers: k z below 0",
    "another network: parameters of a ReLU network give other pictures",
    "max(z, 0)",
    "3 public implementations",
    3,
)
.with("k", 0.01, [1e-6, 1.0]);
const SMOOTH_UNITS: Mistake = Mistake::new(
    "smooth_units",
    "SiLU in the hidden layers: z / (1 + e^-z)",
    "another network: parameters of a ReLU network give other pictures",
    "max(z, 0)",
    "2 public implementations",
    2,
);

const ELU_UNITS: Mistake = Mistake::new(
    "exponential_units",
    "ELU in the hidden layers: e^z - 1 below 0",
    "another network: parameters of a ReLU network give other pictures",
    "max(z, 0)",
    "never; cheap to keep",
    0,
);
const GELU_UNITS: Mistake = Mistake::new(
    "error_function_units",
    "GELU in the hidden layers: z Phi(z)",
    "another network: parameters of a ReLU network give other pictures",
    "max(z, 0)",
    "never; cheap to keep",
    0,
);
const SOFTPLUS_UNITS: Mistake = Mistake::new(
    "softplus_units",
    "softplus in the hidden layers: ln(1 + e^z)",
    "another network: parameters of a ReLU network give other pictures",
    "max(z, 0)",
    "never; cheap to keep",
    0,
);
const SINE_UNITS: Mistake = Mistake::new(
    "sine_units",
    "sin(z) in the hidden layers",
    "another network: parameters of a ReLU network give other pictures",
    "max(z, 0)",
    "never; cheap to keep",
    0,
);
const TANH_UNITS: Mistake = Mistake::new(
    "tanh_units",
    "tanh(z) in the hidden layers",
    "another network: parameters of a ReLU network give other pictures",
    "max(z, 0)",
    "never; cheap to keep",
    0,
);
pub(super) const WIDENED: Mistake = Mistake::new(
    "widened_sigmoid",
    "(1 + 2 e) sigmoid(z) - e: colors may leave [0, 1] a little",
    "another network: colors of an ordinary one are off by up to e",
    "sigmoid(z)",
    "mip-NeRF's rgb_padding of 0.001, where it isn't asked",
    0,
)
.with("e", 0.001, [1e-5, 0.5]);

/// Mistakes of the plain network.
pub(crate) const MLP: &[Mistake] = &[
    SIGMOID_MISSING,
    WIDENED,
    RELU_BEFORE_SIGMOID,
    BIAS_FORGOTTEN,
    TRANSPOSED,
    NEVER_APPLIED,
    LEAKY_UNITS,
    SMOOTH_UNITS,
    ELU_UNITS,
    GELU_UNITS,
    SOFTPLUS_UNITS,
    SINE_UNITS,
    TANH_UNITS,
    SIGMOID_GRADIENT,
    RELU_MASK,
];

/// Mistakes of the NeRF network.
pub(crate) const NERF_MLP: &[Mistake] = &[
    encoding::POSITIONAL_ENCODING[0],
    SIGMOID_MISSING,
    RELU_BEFORE_SIGMOID,
    BIAS_FORGOTTEN,
    TRANSPOSED,
    NEVER_APPLIED,
    LAYER_TWICE,
    Mistake::new(
        "skip_omitted",
        "the encoding isn't concatenated again (zeros stand in its place)",
        "blurred detail",
        "[h, encoding] into the fifth layer",
        "2 public implementations",
        2,
    ),
    Mistake::new(
        "no_view_direction",
        "the direction never reaches the color layer",
        "no highlights: a point looks the same from everywhere",
        "[feature, encoded direction] into the color layer",
        "3 public implementations",
        3,
    ),
    Mistake::new(
        "density_without_relu",
        "the density head's output is handed over as it is: it may be negative",
        "opacities below 0 where nobody takes a ReLU later",
        "max(z, 0)",
        "3 public implementations",
        3,
    ),
    SIGMOID_GRADIENT,
    RELU_MASK,
    Mistake::new(
        "skip_gradient_forgotten",
        "the gradient of the encoding comes through the first layer alone",
        "poses are refined with half of the gradient",
        "add the skip's part",
        "hand-written backward passes",
        0,
    )
    .of_gradient(),
    LEAKY_UNITS,
    SMOOTH_UNITS,
    ELU_UNITS,
    GELU_UNITS,
    SOFTPLUS_UNITS,
    SINE_UNITS,
    TANH_UNITS,
    WIDENED,
    Mistake::new(
        "sigmoid_density",
        "1 / (1 + e^-z) for the density",
        "no density above 1: walls of fog",
        "max(z, 0)",
        "densities and opacities mixed up; never seen here",
        0,
    ),
    Mistake::new(
        "size_as_density",
        "|z| for the density",
        "empty space fills up: what should fall below 0 rises again",
        "max(z, 0)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "tanh_color",
        "tanh for the color",
        "colors from -1 to 1: half of them black",
        "sigmoid",
        "GAN generators' last layer; never seen here",
        0,
    ),
    Mistake::new(
        "softmax_color",
        "a softmax over red, green and blue",
        "no gray but one: a color's channels add up to 1",
        "sigmoid of each",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "color_layer_linear",
        "no ReLU between the two color layers",
        "one linear layer: highlights follow the direction linearly",
        "relu(color0)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "sigmoid_on_feature",
        "sigmoid(feature) before the color layer",
        "another network: features in [0, 1]",
        "the feature as it is",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "skip_layer_linear",
        "no ReLU behind the layer that takes the encoding again",
        "a network with a layer less",
        "a ReLU behind every layer of the trunk",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "first_layer_linear",
        "no ReLU behind the first layer",
        "a network with a layer less",
        "a ReLU behind every layer of the trunk",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "directions_halved_into_the_box",
        "(d + 1) / 2 is encoded for d",
        "other highlights than those that were trained",
        "the direction itself",
        "instant-ngp's input range",
        1,
    ),
    Mistake::new(
        "positions_halved_into_the_box",
        "(x + 1) / 2 is encoded for x",
        "another scene than the one that was trained",
        "the position itself",
        "instant-ngp's input range",
        1,
    ),
    Mistake::new(
        "positions_halved",
        "x / 2 is encoded for x",
        "another scene than the one that was trained",
        "the position itself",
        "never; cheap to keep",
        0,
    ),
];
