//! Registry rows of the networks.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Port};
use crate::contract::special::Special;

/// The plain network.
pub(crate) const MLP: Component = Component {
    name: "mlp",
    folder: "field",
    code: include_str!("honest.rs"),
    formula: "h_0 = x, z_n = w_n h_n + b_n, h_{n+1} = max(z_n, 0), y = sigmoid(z_last)",
    source: "Berkeley CS180 project 4, part 1; Tancik et al. 2020",
    inputs: &[
        Port::smooth("x", "M,D", "points"),
        Port::smooth("w*", "out,in", "weights of layer 0, 1, ..."),
        Port::smooth("b*", "out", "biases of layer 0, 1, ..."),
    ],
    outputs: &[Port::smooth("y", "M,O", "colors in [0, 1]")],
    conventions: &[],
    forward: Direction { oracle: arrays::mlp, bound: bound::mlp, honest: honest::mlp, wrong: mistakes::mlp },
    vjp: Some(Direction {
        oracle: arrays::mlp_vjp,
        bound: bound::mlp_vjp,
        honest: honest::mlp_vjp,
        wrong: mistakes::mlp_vjp,
    }),
    cases: cases::mlp,
    mistakes: mistakes::MLP,
    special: Special { large: cases::large, ..Special::NONE },
};

/// The network of the NeRF paper, encodings inside.
pub(crate) const NERF_MLP: Component = Component {
    name: "nerf_mlp",
    folder: "field",
    code: include_str!("honest.rs"),
    formula: "h = trunk(encode(x)), the encoding again in trunk 4; sigma = max(w h + b, 0); rgb = sigmoid(color1 relu(color0 [feature h, encode(d)]))",
    source: "NeRF (Mildenhall et al. 2020) figure 7",
    inputs: &NERF_PORTS,
    outputs: &[
        Port::smooth("sigmas", "M", "densities, 1 / length"),
        Port::smooth("rgbs", "M,3", "colors in [0, 1]"),
    ],
    conventions: &[
        "identity",
        "network_identity",
        "frequency",
        "bands",
        "columns",
        "density",
        "skip_layer",
        "skip_order",
        "color_order",
        "last_trunk",
        "feature",
    ],
    forward: Direction {
        oracle: arrays::nerf,
        bound: bound::nerf_mlp,
        honest: honest::nerf_mlp,
        wrong: mistakes::nerf_mlp,
    },
    vjp: Some(Direction {
        oracle: arrays::nerf_vjp,
        bound: bound::nerf_mlp_vjp,
        honest: honest::nerf_mlp_vjp,
        wrong: mistakes::nerf_mlp_vjp,
    }),
    cases: cases::nerf_mlp,
    mistakes: mistakes::NERF_MLP,
    special: Special {
        reshape: cases::reshape,
        admits: cases::admits,
        laws: Some(mistakes::laws::OF_NETWORKS),
        ..Special::NONE
    },
};

const fn w(name: &'static str) -> Port {
    Port::smooth(name, "out,in", "weights")
}

const fn b(name: &'static str) -> Port {
    Port::smooth(name, "out", "biases")
}

const NERF_PORTS: [Port; 26] = [
    Port::smooth("positions", "M,3", "positions in scene units"),
    Port::plain("directions", "M,3", "viewing directions"),
    w("trunk0_w"),
    b("trunk0_b"),
    w("trunk1_w"),
    b("trunk1_b"),
    w("trunk2_w"),
    b("trunk2_b"),
    w("trunk3_w"),
    b("trunk3_b"),
    w("trunk4_w"),
    b("trunk4_b"),
    w("trunk5_w"),
    b("trunk5_b"),
    w("trunk6_w"),
    b("trunk6_b"),
    w("trunk7_w"),
    b("trunk7_b"),
    w("sigma_w"),
    b("sigma_b"),
    w("feature_w"),
    b("feature_b"),
    w("color0_w"),
    b("color0_b"),
    w("color1_w"),
    b("color1_b"),
];
