//! Descriptions of the mistakes in hash grids. Libraries' choices that differ from the paper's text are conventions.

use crate::contract::component::Mistake;

/// Mistakes of the hash grid.
pub(crate) const HASH_GRID: &[Mistake] = &[
    Mistake::new(
        "prime_mistyped",
        "265443567 for 2654435761: a digit is missing",
        "another hash, with more collisions: tables can't be exchanged",
        "1, 2654435761, 805459861",
        "kaolin-wisp#129",
        1,
    ),
    Mistake::new(
        "primes_rolled",
        "the factors belong to other axes: 2654435761, 805459861, 1",
        "another hash: tables can't be exchanged",
        "1 belongs to x, 2654435761 to y, 805459861 to z",
        "kaolin-wisp#132, level by level",
        1,
    ),
    Mistake::new(
        "sum_for_xor",
        "x + 2654435761 y + 805459861 z",
        "another hash, whose collisions lie on planes",
        "exclusive or",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "modulo_one_less",
        "hash mod (T - 1): the mask for the modulus",
        "the last entry is never used, and all others are other ones",
        "hash mod T, or hash and (T - 1) where T is a power of two",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "side_without_one",
        "x + N (y + N z): cells counted, not vertices",
        "vertices of the far faces share entries with those of the near ones",
        "a level of N cells has N + 1 vertices along an edge",
        "asked in torch-ngp#71 and tiny-cuda-nn#149, whose levels have one cell less than their name says",
        1,
    ),
    Mistake::new(
        "z_fastest",
        "z + (N + 1) (y + (N + 1) x) in dense levels",
        "another order of entries: tables can't be exchanged",
        "x runs fastest",
        "tables reshaped to (x, y, z) in row-major order",
        1,
    ),
    Mistake::new(
        "offset_half",
        "x N + 1/2 in front of the floor",
        "every level is shifted by half a cell against the box: another encoding, and entries outside of it",
        "x N without an offset",
        "ports of tiny-cuda-nn's pos_fract, which has N - 1 for N",
        2,
    ),
    Mistake::new(
        "nearest_vertex",
        "the nearest vertex's entry without interpolation",
        "features jump from cell to cell and have no gradient in x",
        "weigh all 8 corners",
        "tiny-cuda-nn's interpolation type Nearest, where it is meant",
        1,
    ),
    Mistake::new(
        "weights_swapped",
        "lower corners have the fraction as their weight, upper ones the rest",
        "features jump at every face and run backwards in between",
        "upper corners have the fraction",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "resolution_rounded_up",
        "N_l = ceil(base growth^l)",
        "levels with one cell more",
        "round to nearest, or hand over whole resolutions",
        "tiny-cuda-nn's grid_resolution, of base growth^l - 1",
        1,
    ),
    Mistake::new(
        "growth_over_levels",
        "growth = (finest / base)^(1 / L)",
        "the finest level is coarser than asked for",
        "the exponent is 1 / (L - 1): L levels have L - 1 steps between them",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "resolution_forgotten",
        "the gradient with respect to x without the factor N of each level",
        "normals and camera poses learn from coarse levels alone",
        "d fraction / d x = N",
        "hand-written backward passes",
        1,
    )
    .of_gradient(),
    Mistake::new(
        "collisions_overwrite",
        "the gradient of an entry is stored, not added, so that the last corner wins",
        "shared entries learn from one point in many",
        "accumulate: atomic addition, index_add, or scatter with a sum",
        "indexed assignment in numpy and torch (g[i] += x keeps one of equal indices)",
        1,
    )
    .of_gradient(),
];
