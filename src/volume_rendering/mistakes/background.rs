//! Composites over a background, wrong on purpose.

use super::catalogue::CLAMPED;
use crate::contract::arrays::{Arrays, input};
use crate::contract::component::Mistake;
use crate::convention::Conventions;
use crate::volume_rendering::arrays;

const NEARLY_OPAQUE: Mistake = Mistake::new(
    "no_background_behind_the_nearly_opaque",
    "(1 - A) b where A < 1 - k alone, and nothing elsewhere",
    "what is nearly opaque is darker than it should be, by k b at most",
    "C + (1 - A) b, whatever A is",
    "a splat renderer in CUDA, 1e-3",
    1,
)
.with("k", 1e-3, [1e-7, 0.3]);

/// Mistakes of the background.
pub(crate) const COMPOSITE_BACKGROUND: &[Mistake] = &[
    CLAMPED,
    NEARLY_OPAQUE,
    Mistake::new(
        "background_by_opacity",
        "C + A b: the opacity stands where the light that is left belongs",
        "the background shines through what is opaque, and is missing behind nothing",
        "C + (1 - A) b",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "attenuated_twice",
        "A C + (1 - A) b: the rendered color is premultiplied already",
        "half-transparent edges too dark; right only at A = 0 or 1",
        "C + (1 - A) b",
        "instant-nsr-pl#54, nerfstudio#2165",
        2,
    ),
    Mistake::new(
        "one_channel",
        "the background is written to the first channel alone",
        "empty rays have the wrong hue",
        "add (1 - A) b to every channel",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "background_255",
        "b is in 0..255 where C is in 0..1",
        "everything that isn't opaque is white",
        "divide the background by 255",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "background_always",
        "C + b: the background isn't attenuated (an appended sample that isn't opaque, or a forgotten 1 - A)",
        "opaque objects glow",
        "C + (1 - A) b",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "color_divided",
        "C / A + (1 - A) b: the rendered color isn't premultiplied any more",
        "half-transparent edges too bright; NaN where nothing is",
        "C + (1 - A) b",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "brighter_of_both",
        "max(C, (1 - A) b)",
        "dark edges: what covers by half and what shines through don't add up",
        "C + (1 - A) b",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "either_of_both",
        "C where A > 1/2, else b",
        "jagged edges, and no fog",
        "C + (1 - A) b",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "background_where_nothing_is",
        "C where A > 0, else b",
        "dark fringes, and no fog",
        "C + (1 - A) b",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "background_forgotten",
        "C, whatever lies behind",
        "black where nothing is, against pictures with a background of their own",
        "C + (1 - A) b",
        "renderers that leave the background to somebody else",
        2,
    ),
    Mistake::new(
        "rendered_color_clamped",
        "C is clamped to [0, 1] in front of the background",
        "no gradient where a color is too bright; high dynamic range is lost",
        "clamp where the picture is written",
        "clouds in GLSL",
        1,
    ),
    Mistake::new(
        "light_left_exchanged",
        "(1 - A) C + A b: the weights of both are exchanged",
        "opaque objects have the background's color",
        "C + (1 - A) b",
        "never; cheap to keep",
        0,
    ),
];

/// Background.
pub(crate) fn composite_background(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let mut a = a.clone();
    if wrong.contains(&"background_255") {
        a.get_mut("background").expect("checked").mapv_inplace(|b| 255.0 * b);
    }
    if wrong.contains(&"one_channel") {
        a.get_mut("background").expect("checked").iter_mut().skip(1).for_each(|b| *b = 0.0);
    }
    if wrong.contains(&"rendered_color_clamped") {
        a.get_mut("colors").expect("checked").mapv_inplace(|c| c.clamp(0.0, 1.0));
    }
    if wrong.contains(&"attenuated_twice") {
        let opacity = input(&a, "opacity").clone();
        let colors = a.get_mut("colors").expect("checked");
        colors.indexed_iter_mut().for_each(|(i, c)| *c *= opacity[[i[0]]]);
    }
    if wrong.contains(&"background_by_opacity") {
        a.get_mut("opacity").expect("checked").mapv_inplace(|opacity| 1.0 - opacity);
    }
    if wrong.contains(&"background_always") {
        a.get_mut("opacity").expect("checked").fill(0.0);
    }
    if wrong.contains(&"light_left_exchanged") {
        let opacity = input(&a, "opacity").clone();
        let colors = a.get_mut("colors").expect("checked");
        colors.indexed_iter_mut().for_each(|(i, c)| *c *= 1.0 - opacity[[i[0]]]);
        a.get_mut("opacity").expect("checked").mapv_inplace(|opacity| 1.0 - opacity);
    }
    let opacity = input(&a, "opacity").clone();
    if wrong.contains(&"color_divided") {
        let colors = a.get_mut("colors").expect("checked");
        colors.indexed_iter_mut().for_each(|(i, c)| *c /= opacity[[i[0]]].max(1e-6));
    }
    let mut out = arrays::background(&a, c);
    let (colors, background) = (input(&a, "colors"), input(&a, "background"));
    let written = out.get_mut("colors_out").expect("an output");
    for (i, written) in written.indexed_iter_mut() {
        let (c, b, left) = (colors[&i], background[[i[1]]], 1.0 - opacity[[i[0]]]);
        match () {
            () if wrong.contains(&"brighter_of_both") => *written = c.max(left * b),
            () if NEARLY_OPAQUE.among(wrong).is_some_and(|k| left <= k) => *written = c,
            () if wrong.contains(&"background_where_nothing_is") => *written = if left < 1.0 { c } else { b },
            () if wrong.contains(&"background_forgotten") => *written = c,
            () if wrong.contains(&"either_of_both") => *written = if left < 0.5 { c } else { b },
            () => {}
        }
    }
    if wrong.contains(&"clamped") {
        out.get_mut("colors_out").expect("an output").mapv_inplace(|c| c.clamp(0.0, 1.0));
    }
    out
}

/// Gradient of the background: none of its own.
pub(crate) fn composite_background_vjp(a: &Arrays, c: &Conventions, _: &[&str]) -> Arrays {
    arrays::background_vjp(a, c)
}
