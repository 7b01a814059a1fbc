//! Cases of rigid motions: corrections of a pose, small and large turns, none at all, half turns, several.

use std::f64::consts::PI;

use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::array;
use crate::contract::case::{Case, Draw, in_full, short};
use crate::contract::large::Large;
use crate::contract::recipe::signed;

/// What a case asks: its id, what it probes, its rotation vectors.
type Asked = (&'static str, &'static str, Vec<[f64; 3]>);

/// `n` vectors in any direction, of lengths from `low` to `high`.
fn any_way(draw: &mut Draw, n: usize, low: f64, high: f64) -> Vec<[f64; 3]> {
    let one = |_| {
        let size = low + (high - low) * draw.unit();
        let v = [0; 3].map(|_| 2.0 * draw.unit() - 1.0);
        let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        v.map(|x| short(x / length * size))
    };
    (0..n).map(one).collect()
}

/// The rotation vectors of both rows.
fn vectors() -> Vec<Asked> {
    let mut draw = Draw::new("rigid_motion", 0);
    let mut any = |n, low, high| any_way(&mut draw, n, low, high);
    let mut none = vec![[0.0; 3]];
    none.extend(any(2, 0.5, 1.0));
    vec![
        ("usual", "turns up to half of a half turn", any(6, 0.2, 1.5)),
        ("corrections", "what pose refinement learns", any(6, 0.02, 0.15)),
        ("wide", "turns beyond a quarter", any(5, 1.6, 3.0)),
        ("axes", "about the axes", vec![[0.75, 0.0, 0.0], [0.0, -1.25, 0.0], [0.0, 0.0, 2.5]]),
        ("CG11_none", "no turn at all, as every refinement begins, among others", none),
        ("CG11_small", "angles of thousandths", any(5, 0.002, 0.008)),
        ("CG11_tiny", "angles of millionths, which 1 - cos theta loses", any(5, 1e-6, 6e-6)),
        ("several_turns", "up to four turns", any(5, 7.0, 25.0)),
    ]
}

/// Half turns about the axes and about another one, as near to pi as `dtype` comes.
fn half_turns(dtype: Dtype) -> Vec<[f64; 3]> {
    let third = PI / 3.0;
    let turns = [[PI, 0.0, 0.0], [0.0, -PI, 0.0], [0.0, 0.0, PI], [2.0 * third, -third, 2.0 * third]];
    turns.map(|w| w.map(|x| dtype.round(x))).into()
}

/// The cases of a row, each a function of its rotation vectors.
fn all(case: impl Fn(&str, &'static str, &[[f64; 3]]) -> Case) -> Vec<Case> {
    let mut cases: Vec<Case> = vectors().iter().map(|(id, comment, w)| case(id, comment, w)).collect();
    for (dtype, id, comment) in [
        (Dtype::F64, "half_turns_f64", "half turns, as near as f64 comes to pi"),
        (Dtype::F32, "half_turns_f32", "half turns, as near as f32 comes to pi"),
    ] {
        cases.push(Case { full: Some(dtype), ..case(id, comment, &half_turns(dtype)) });
    }
    let mut cases = in_full(in_full(cases, "usual"), "corrections");
    let (id, comment, w) = vanishing();
    cases.push(case(id, comment, &w));
    cases
}

/// Turns that code with a threshold takes for none.
fn vanishing() -> Asked {
    let w = any_way(&mut Draw::new("rigid_motion", 1), 5, 1e-8, 6e-8);
    ("CG11_vanishing", "angles whose squares vanish beside 1 in every type", w)
}

/// Rotation vectors.
pub(crate) fn so3_exp() -> Vec<Case> {
    all(|id, comment, w| Case::new(id, comment, vec![("w", array(&[w.len(), 3], w.concat()))]))
}

/// Twists with these rotations behind a translation, and for code that has the rotation in front, small ones and several turns there too.
pub(crate) fn se3_exp() -> Vec<Case> {
    let twists = |id: &str, comment, w: &[[f64; 3]], first: bool| {
        let mut draw = Draw::new(id, 1);
        let twist = |w: &[f64; 3]| {
            let other = [0; 3].map(|_| draw.between(-2.0, 2.0));
            if first { [*w, other] } else { [other, *w] }.concat()
        };
        let twists = w.iter().flat_map(twist).collect();
        Case::new(id, comment, vec![("twists", array(&[w.len(), 6], twists))])
    };
    let mut cases = all(|id, comment, w| twists(id, comment, w, false));
    let other = vectors()
        .into_iter()
        .chain([vanishing()])
        .filter(|(id, ..)| id.starts_with("CG11") || *id == "several_turns");
    cases.extend(other.map(|(id, comment, w)| twists(&format!("{id}_first"), comment, &w, true)));
    cases
}

/// More rotation vectors than a grid has blocks, up to a quarter turn: a pose for every ray.
pub(crate) fn large_so3() -> Vec<Large> {
    let n = 20_011;
    vec![Large::new("vectors_20011", "20,011 rotation vectors", n, 1024).with("w", &[n, 3], signed(-6, 6))]
}

/// The same of twists.
pub(crate) fn large_se3() -> Vec<Large> {
    let n = 10_007;
    vec![Large::new("twists_10007", "10,007 twists", n, 1024).with("twists", &[n, 6], signed(-6, 6))]
}
