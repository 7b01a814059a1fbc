//! What is wrong with figures of a part of a picture, and with what is done to its bytes.

use crate::contract::component::Mistake;

/// Of channels, borders and bytes.
pub(super) const OF_PARTS: &[Mistake] = &[
    Mistake::new(
        "first_channel_alone",
        "the figure of red",
        "a picture that is good in red alone is good",
        "the mean square over all channels",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "luma_alone",
        "the figure of 0.299 r + 0.587 g + 0.114 b",
        "errors of color cost little",
        "the mean square over all channels",
        "super-resolution's habit, where it is told",
        1,
    ),
    Mistake::new(
        "border_cropped",
        "the figure without a border of one pixel",
        "errors at the border cost nothing",
        "the whole picture",
        "super-resolution's habit, where it is told",
        1,
    ),
    Mistake::new(
        "bytes_wrap_around",
        "bytes subtracted as bytes: -1 is 255",
        "figures far too low wherever the prediction is darker",
        "subtract numbers that have a sign",
        "a - b of uint8, made a float behind the difference",
        1,
    ),
];
