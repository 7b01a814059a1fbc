//! What is wrong with boxes whose axes are mixed up, and what it does.

use crate::contract::component::Mistake;

pub(super) const SHRUNK: Mistake = Mistake::new(
    "box_shrunk",
    "low + k and high - k",
    "rays that graze a face miss it",
    "the box as it is",
    "1 viewer, with 1e-6",
    1,
)
.with("k", 1e-6, [1e-8, 0.2]);

/// Of axes, sizes and what is answered.
pub(super) const OF_BOXES: &[Mistake] = &[
    Mistake::new(
        "half_size_of_y_for_z",
        "the box's extent along y for that along z: half.y typed twice",
        "rays enter and leave another box, wherever it isn't a cube",
        "each axis' own extent",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "axes_of_the_box_exchanged",
        "the box's y and z exchanged",
        "rays enter and leave another box",
        "the same axes for box and rays",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "exit_of_y_forgotten",
        "the far end of y isn't taken",
        "rays leave too late",
        "the least of all three",
        "ports of Scratchapixel's slabs, which forget one of its ifs",
        1,
    ),
    Mistake::new(
        "entry_of_z_forgotten",
        "the near end of z isn't taken",
        "rays enter too early",
        "the largest of all three",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "size_for_half_size",
        "the box's whole size for half of it, about its middle",
        "a box twice as large",
        "half of the size",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "hit_negated",
        "1 for a miss, 0 for a hit",
        "empty space is marched through, and the scene isn't",
        "hit = t_near <= t_far",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "t_in_lengths",
        "t, cut at near and far, times |d|: for directions that aren't unit",
        "samples too far away, or too near",
        "t counts directions",
        "never; cheap to keep",
        0,
    ),
    SHRUNK,
];
