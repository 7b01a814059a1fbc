//! What happens to some elements of a long axis, as the answers show it: one harmonic with another constant, three in another order, the
//! last sample left out.

use ndarray::{ArrayD, Axis};

use super::each::{By, EACH, rounded};

/// Elements of an axis that are looked at, from either end.
const LONGEST: usize = 64;

/// Elements that can be off, each for a reason of its own.
const OFF: usize = 8;

/// Reasons that are listed for an element.
const REASONS: usize = 3;

/// How far numbers that are meant to be the same may be apart, of the largest: what is found is held against its bounds afterward.
const NEAR: f64 = 1e-4;

/// What an element has become.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Becomes {
    /// Itself, changed.
    Changed(By),
    /// Another element, or that with the other sign.
    Element { from: usize, negative: bool },
}

/// Some elements of an axis.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Changed {
    pub axis: usize,
    /// Whether they are counted from its end.
    pub from_end: bool,
    /// Which, and what each has become.
    pub elements: Vec<(usize, Becomes)>,
}

impl Changed {
    /// The array with these elements changed; those that it doesn't have are left out.
    pub(super) fn of(&self, x: &ArrayD<f64>) -> ArrayD<f64> {
        let mut new = x.clone();
        for (to, becomes) in &self.elements {
            let Some(mut part) = self.place(x, *to).map(|n| new.index_axis_mut(Axis(self.axis), n)) else {
                continue;
            };
            match becomes {
                Becomes::Changed(by) => part.mapv_inplace(|x| by.of(x)),
                Becomes::Element { from, negative } => {
                    let sign = if *negative { -1.0 } else { 1.0 };
                    if let Some(n) = self.place(x, *from) {
                        part.assign(&x.index_axis(Axis(self.axis), n).mapv(|x| sign * x));
                    }
                }
            }
        }
        new
    }

    /// Where an element lies in an array that has it.
    fn place(&self, x: &ArrayD<f64>, element: usize) -> Option<usize> {
        let length = x.shape().get(self.axis).copied().unwrap_or(0);
        (element < length).then(|| if self.from_end { length - 1 - element } else { element })
    }

    /// What it says, on a line.
    pub(super) fn says(&self, name: &str) -> String {
        let end = if self.from_end { ", counted from its end" } else { "" };
        let one = |(to, becomes): &(usize, Becomes)| match becomes {
            Becomes::Changed(by) => format!("element {to} {}", by.says()),
            Becomes::Element { from, negative } => {
                format!("element {}{from} in the place of element {to}", if *negative { "-" } else { "" })
            }
        };
        let elements: Vec<String> = self.elements.iter().map(one).collect();
        format!("{name} with, along axis {}{end}, {}", self.axis, elements.join(", "))
    }

    /// These elements in all arrays that have them.
    fn numbers(&self, pairs: &[(ArrayD<f64>, ArrayD<f64>)], element: usize) -> Numbers {
        let part = |a: &ArrayD<f64>| -> Vec<f64> {
            let place = self.place(a, element);
            place.map_or(vec![], |n| a.index_axis(Axis(self.axis), n).iter().copied().collect())
        };
        Numbers {
            predicted: pairs.iter().flat_map(|(p, _)| part(p)).collect(),
            given: pairs.iter().flat_map(|(_, g)| part(g)).collect(),
        }
    }
}

/// The array whose last axis of groups of `group` elements goes by the place in a group first; or, `back`, the other way around.
pub(super) fn regrouped(x: &ArrayD<f64>, group: usize, back: bool) -> ArrayD<f64> {
    let n = x.shape().last().copied().unwrap_or(0);
    if group < 2 || group >= n || n % group != 0 {
        return x.clone();
    }
    let inner = if back { n / group } else { group };
    let order: Vec<usize> = (0..n).map(|to| to % (n / inner) * inner + to / (n / inner)).collect();
    x.select(Axis(x.ndim() - 1), &order)
}

/// What may have become of the elements that are off along an axis: `pairs` of predicted and given arrays, of several cases.
pub(super) fn shown(pairs: &[(ArrayD<f64>, ArrayD<f64>)], axis: usize) -> Vec<Changed> {
    let both = [false, true].map(|from_end| counted(pairs, Changed { axis, from_end, elements: vec![] }));
    let last = |all: &Vec<Changed>| all.iter().flat_map(|c| c.elements.iter().map(|(to, _)| *to)).max();
    let [from_start, from_end] = both;
    // From the nearer end first.
    let nearer = last(&from_end).is_some_and(|end| last(&from_start).is_none_or(|start| end < start));
    if nearer { [from_end, from_start].concat() } else { [from_start, from_end].concat() }
}

fn counted(pairs: &[(ArrayD<f64>, ArrayD<f64>)], way: Changed) -> Vec<Changed> {
    let length = |(p, _): &(ArrayD<f64>, ArrayD<f64>)| p.shape().get(way.axis).copied().unwrap_or(0);
    let elements = pairs.iter().map(length).max().unwrap_or(0).min(LONGEST);
    let off: Vec<usize> = (0..elements).filter(|n| !way.numbers(pairs, *n).same(|p| p)).collect();
    if off.is_empty() || off.len() > OFF || 2 * off.len() > elements {
        return vec![];
    }
    let reasons: Vec<Vec<Becomes>> = off.iter().map(|&to| reasons(pairs, &way, to, elements)).collect();
    let most = reasons.iter().map(Vec::len).max().unwrap_or(0);
    if reasons.iter().any(Vec::is_empty) {
        return vec![];
    }
    let nth = |n: usize| {
        let all = off.iter().zip(&reasons);
        let elements = all.map(|(to, all)| (*to, all[n.min(all.len() - 1)].clone())).collect();
        Changed { elements, ..way.clone() }
    };
    (0..most).map(nth).collect()
}

/// The likelier first.
fn reasons(pairs: &[(ArrayD<f64>, ArrayD<f64>)], way: &Changed, to: usize, elements: usize) -> Vec<Becomes> {
    let own = way.numbers(pairs, to);
    let each = (0..EACH.len()).map(By::Each).filter(|by| own.same(|p| by.of(p))).map(Becomes::Changed);
    let others = (0..elements).filter(|from| *from != to);
    let others = others.flat_map(|from| [false, true].map(|negative| Becomes::Element { from, negative }));
    // Shorter arrays may have one of the two alone.
    let others = others.filter(|becomes| {
        let changed = Changed { elements: vec![(to, becomes.clone())], ..way.clone() };
        let moved: Vec<_> = pairs.iter().map(|(p, g)| (changed.of(p), g.clone())).collect();
        changed.numbers(&moved, to).same(|p| p)
    });
    let largest = own.predicted.iter().zip(&own.given).max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
    let (p, g) = largest.map_or((1.0, 1.0), |(p, g)| (*p, *g));
    let fitted = rounded(g / p).map(By::Times).into_iter().chain(rounded(g - p).map(By::Plus));
    let fitted = fitted.filter(|by| own.same(|p| by.of(p))).map(Becomes::Changed);
    each.chain(others).chain(fitted).take(REASONS).collect()
}

/// An element's numbers in all cases that have it.
struct Numbers {
    predicted: Vec<f64>,
    given: Vec<f64>,
}

impl Numbers {
    /// Whether what was given is what `f` makes of what was predicted.
    fn same(&self, f: impl Fn(f64) -> f64) -> bool {
        let finite = self.given.iter().filter(|g| g.is_finite());
        let largest = finite.fold(0.0, |most: f64, g| most.max(g.abs()));
        // Below its smallest normal number f32 has fewer digits.
        let tiny = f64::from(f32::MIN_POSITIVE);
        let near =
            |e: f64, g: f64| e == g || e.is_finite() && (e - g).abs() <= tiny + NEAR * largest.max(e.abs());
        self.predicted.iter().zip(&self.given).all(|(p, g)| near(f(*p), *g))
    }
}

#[cfg(test)]
mod tests {
    use ndarray::array;

    use super::*;

    /// Beside an infinite number every other is small, and still not the same.
    #[test]
    fn what_is_infinite_hides_no_other_number() {
        let same = |predicted: [f64; 3], given: [f64; 3]| {
            Numbers { predicted: predicted.into(), given: given.into() }.same(|x| x)
        };
        let inf = f64::INFINITY;
        assert!(same([1.0, 2.0, inf], [1.0, 2.0, inf]));
        assert!(!same([1.0, 2.0, inf], [1.0, 3.0, inf]));
        assert!(!same([1.0, 2.0, 3.0], [1.0, 2.0, inf]));
        assert!(!same([1.0, 2.0, inf], [1.0, 2.0, 3.0]));
    }

    fn at_start(elements: Vec<(usize, Becomes)>) -> Changed {
        Changed { axis: 1, from_end: false, elements }
    }

    fn answered(changed: &Changed) -> Vec<(ArrayD<f64>, ArrayD<f64>)> {
        // The second has fewer elements.
        let all = [
            array![[1.0, 2.0, 3.0, 5.0, 7.0, 11.0], [0.5, -1.0, 0.25, 4.0, -2.0, 1.5]].into_dyn(),
            array![[2.0, 0.75, 6.0, -3.0]].into_dyn(),
        ];
        all.into_iter().map(|x| (x.clone(), changed.of(&x))).collect()
    }

    #[test]
    fn what_became_of_elements_is_read_off() {
        let other = |to, from, negative| (to, Becomes::Element { from, negative });
        let left_out = vec![(0, Becomes::Changed(By::Each(0)))];
        for changed in [
            at_start(vec![(4, Becomes::Changed(By::Each(1)))]),
            at_start(vec![(2, Becomes::Changed(By::Times(0.6)))]),
            at_start(vec![other(1, 3, true)]),
            at_start(vec![other(1, 2, false), other(2, 3, false), other(3, 1, false)]),
            at_start(vec![(0, Becomes::Changed(By::Times(1.5))), other(5, 4, false)]),
            Changed { axis: 1, from_end: true, elements: left_out },
            Changed { axis: 1, from_end: true, elements: vec![other(0, 1, false)] },
        ] {
            let found = shown(&answered(&changed), 1);
            assert_eq!(found.first(), Some(&changed), "{found:?}");
        }
    }

    #[test]
    fn what_is_off_everywhere_is_no_matter_of_elements() {
        let pairs = answered(&at_start(vec![]));
        assert!(shown(&pairs, 1).is_empty());
        let doubled: Vec<_> = pairs.iter().map(|(p, _)| (p.clone(), 2.0 * p)).collect();
        assert!(shown(&doubled, 1).is_empty());
    }

    #[test]
    fn groups_are_ordered_the_other_way_and_back() {
        let x = array![1.0, 2.0, 3.0, 4.0, 5.0, 6.0].into_dyn();
        let by_place = array![1.0, 3.0, 5.0, 2.0, 4.0, 6.0].into_dyn();
        assert_eq!(regrouped(&x, 2, false), by_place);
        assert_eq!(regrouped(&by_place, 2, true), x);
        assert_eq!(regrouped(&x, 4, false), x);
    }

    #[test]
    fn it_says_which() {
        let other = (1, Becomes::Element { from: 3, negative: true });
        let changed = at_start(vec![other, (4, Becomes::Changed(By::Each(1)))]);
        let said =
            "y with, along axis 1, element -3 in the place of element 1, element 4 with the other sign";
        assert_eq!(changed.says("y"), said);
        let last = Changed { axis: 0, from_end: true, elements: vec![(0, Becomes::Changed(By::Each(0)))] };
        assert_eq!(last.says("w"), "w with, along axis 0, counted from its end, element 0 left out: 0");
    }
}
