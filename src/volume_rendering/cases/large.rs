//! Cases of real sizes.

use crate::contract::arithmetic::Dtype;
use crate::contract::large::Large;
use crate::contract::recipe::{Recipe, constants, floats, sparse};

/// Name, what it probes, numbers of rays and samples, rays judged at once; densities, steps and opacities.
struct Size {
    id: &'static str,
    comment: &'static str,
    shape: [usize; 2],
    block: usize,
    sigmas: Recipe,
    deltas: Recipe,
    alphas: Recipe,
}

/// The large cases: more rays than threads, more samples than a warp has lanes, neither a multiple of anything, and as much light left at
/// the end whatever the number of samples.
const LARGE: [Size; 5] = [
    Size {
        id: "rays_4099x3",
        comment: "4,099 rays of 3 samples, whose outputs keep digits in every type",
        shape: [4099, 3],
        block: 512,
        sigmas: floats(3, 1),
        deltas: Recipe::Constant(0.03125),
        alphas: floats(-3, 2),
    },
    Size {
        id: "rays_1025x193",
        comment: "1,025 rays of 193 samples",
        shape: [1025, 193],
        block: 64,
        sigmas: sparse(-3, 7, 2),
        deltas: floats(-9, 3),
        alphas: sparse(-8, 5, 2),
    },
    Size {
        id: "rays_100003x64",
        comment: "100,003 rays of 64 samples",
        shape: [100_003, 64],
        block: 256,
        sigmas: sparse(-3, 7, 2),
        deltas: Recipe::Constant(0.015625),
        alphas: sparse(-8, 5, 2),
    },
    Size {
        id: "ray_4097",
        comment: "one ray of 4,097 samples",
        shape: [1, 4097],
        block: 1,
        sigmas: sparse(-3, 7, 2),
        deltas: Recipe::Constant(0.000244140625),
        alphas: sparse(-12, 4, 2),
    },
    Size {
        id: "ray_200",
        comment: "one ray of 200 samples, none of them opaque: a scan that loses its carry shows in every type",
        shape: [1, 200],
        block: 1,
        sigmas: floats(3, 1),
        deltas: Recipe::Constant(0.0078125),
        alphas: floats(-5, 1),
    },
];

impl Size {
    fn case(&self) -> Large {
        Large::new(self.id, self.comment, self.shape[0], self.block)
    }

    /// With colors.
    fn colored(&self, case: Large) -> Large {
        case.with("rgbs", &[self.shape[0], self.shape[1], 3], Recipe::Unit)
    }
}

/// From densities.
pub(crate) fn densities() -> Vec<Large> {
    let given = |size: &Size| {
        size.case().with("sigmas", &size.shape, size.sigmas).with("deltas", &size.shape, size.deltas)
    };
    LARGE.iter().map(|size| size.colored(given(size))).collect()
}

/// From opacities.
pub(crate) fn opacities() -> Vec<Large> {
    LARGE.iter().map(|size| size.colored(size.case().with("alphas", &size.shape, size.alphas))).collect()
}

/// More rays than 16 bits count, over a background. Its gradient adds up over all of them, so that a gradient is judged at once, and in types
/// in which so long a sum has digits.
pub(crate) fn backgrounds() -> Vec<Large> {
    const BACKGROUND: Recipe = Recipe::Cycle(&constants([0.75, 0.25, 0.5]));
    let rays = |id, comment, n: usize, block| {
        let large = Large::new(id, comment, n, block).with("colors", &[n, 3], Recipe::Unit);
        large.with("opacity", &[n], Recipe::Unit).with("background", &[3], BACKGROUND)
    };
    vec![
        rays("rays_4099", "4,099 rays", 4099, 4099).in_types(&[Dtype::F64, Dtype::F32]),
        rays("rays_100003", "100,003 rays", 100_003, 1024).forward_only(),
    ]
}

/// Where weights lie: few samples, whose depth keeps digits in every type, and many.
pub(crate) fn depths() -> Vec<Large> {
    let case = |id, comment, [rays, n, block]: [usize; 3], cells, weights| {
        let large = Large::new(id, comment, rays, block).with("weights", &[rays, n], weights);
        large.with("t", &[rays, n], Recipe::Ascending { cells }).with("far", &[], Recipe::Constant(2.0))
    };
    vec![
        case("rays_4099x3", "4,099 rays of 3 samples", [4099, 3, 512], 2, floats(-3, 2)),
        case("rays_1025x193", "1,025 rays of 193 samples", [1025, 193, 64], 8, sparse(-10, 4, 2)),
    ]
}
