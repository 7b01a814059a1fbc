//! Descriptions of units in the place of the right ones.

use crate::contract::component::Mistake;

pub(super) const LEAKY_UNITS: Mistake = Mistake::new(
    "leaky_units",
    "LeakyReLU in the hidden layers: k z below 0",
    "another network: parameters of a ReLU network give other pictures",
    "max(z, 0)",
    "3 public implementations",
    3,
)
.with("k", 0.01, [1e-6, 1.0]);
pub(super) const SMOOTH_UNITS: Mistake = Mistake::new(
    "smooth_units",
    "SiLU in the hidden layers: z / (1 + e^-z)",
    "another network: parameters of a ReLU network give other pictures",
    "max(z, 0)",
    "2 public implementations",
    2,
);
pub(super) const ELU_UNITS: Mistake = Mistake::new(
    "exponential_units",
    "ELU in the hidden layers: e^z - 1 below 0",
    "another network: parameters of a ReLU network give other pictures",
    "max(z, 0)",
    "never; cheap to keep",
    0,
);
pub(super) const GELU_UNITS: Mistake = Mistake::new(
    "error_function_units",
    "GELU in the hidden layers: z Phi(z)",
    "another network: parameters of a ReLU network give other pictures",
    "max(z, 0)",
    "never; cheap to keep",
    0,
);
pub(super) const SOFTPLUS_UNITS: Mistake = Mistake::new(
    "softplus_units",
    "softplus in the hidden layers: ln(1 + e^z)",
    "another network: parameters of a ReLU network give other pictures",
    "max(z, 0)",
    "never; cheap to keep",
    0,
);
pub(super) const SINE_UNITS: Mistake = Mistake::new(
    "sine_units",
    "sin(z) in the hidden layers",
    "another network: parameters of a ReLU network give other pictures",
    "max(z, 0)",
    "never; cheap to keep",
    0,
);
pub(super) const TANH_UNITS: Mistake = Mistake::new(
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
pub(super) const NO_UNITS: Mistake = Mistake::new(
    "linear_units",
    "z in the hidden layers: no unit behind any of them",
    "all layers together are one linear layer",
    "max(z, 0)",
    "never; cheap to keep",
    0,
);
pub(super) const SHARPENED: Mistake = Mistake::new(
    "sharpened_sigmoid",
    "sigmoid(k z), as (tanh(z) + 1) / 2 is for k = 2",
    "another network: colors nearer to 0 and 1, or to gray",
    "sigmoid(z)",
    "never; cheap to keep",
    0,
)
.with("k", 2.0, [0.05, 20.0]);
pub(super) const SHIFTED_DENSITY: Mistake = Mistake::new(
    "shifted_density",
    "the density of z - b: softplus(z - 1) begins nearer to empty",
    "another network: parameters of an ordinary one give thinner scenes",
    "the density of z; b belongs into the bias",
    "mip-NeRF's density_bias of -1, where it isn't asked",
    1,
)
.with("b", 1.0, [1e-3, 16.0]);
pub(super) const LEAKY_DENSITY: Mistake = Mistake::new(
    "leaky_density",
    "LeakyReLU for the density: k z below 0",
    "densities below 0: light is added where nothing is",
    "max(z, 0)",
    "never; cheap to keep",
    0,
)
.with("k", 0.01, [1e-6, 1.0]);
pub(super) const LEAKY_COLOR_LAYER: Mistake = Mistake::new(
    "color_layer_leaky",
    "LeakyReLU between the two color layers alone: k z below 0",
    "another network: parameters of a ReLU network give other colors",
    "relu(color0)",
    "never; cheap to keep",
    0,
)
.with("k", 0.01, [1e-6, 1.0]);
