//! Asked otherwise: rays and points that stand alone have the same answers in any order, and in tiles of any size.
//!
//! Which ones do is for the oracle to say: it is asked otherwise first.

use ndarray::{ArrayD, Axis};

use super::answer::{Answer, Given, Reply};
use super::exam::Question;
use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::Arrays;
use crate::contract::case::{Case, Draw};
use crate::contract::component::Port;
use crate::convention::Conventions;

/// How a case's rays or points come otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    /// All at once in another order.
    Shuffled,
    /// In two tiles, one call each.
    Tiled,
}

impl Way {
    pub(super) const ALL: [Way; 2] = [Way::Shuffled, Way::Tiled];

    /// What is wrong where answers are, this way alone.
    pub(super) fn fault(self) -> &'static str {
        match self {
            Way::Shuffled => "depends on the order: with the same rays or points in another order it fails",
            Way::Tiled => "depends on the tile: asked for a part of the rays or points at a time it fails",
        }
    }

    /// Which rays or points each call gets. Two at least: one alone is an edge case of its own.
    fn parts(self, count: usize) -> Option<Vec<Vec<usize>>> {
        match self {
            Way::Shuffled if count > 1 => Some(vec![shuffled(count)]),
            Way::Tiled if count > 2 => {
                let tile = (count / 3).max(2);
                Some(vec![(0..tile).collect(), (tile.min(count - 2)..count).collect()])
            }
            _ => None,
        }
    }
}

/// 0, ..., count - 1 in another order, always the same one.
fn shuffled(count: usize) -> Vec<usize> {
    let mut draw = Draw::new("another order", count as u64);
    let mut order: Vec<usize> = (0..count).collect();
    // Each changes places with an earlier one (Sattolo's cycle): none stays in its place.
    for n in (1..count).rev() {
        order.swap(n, draw.below(n as u64) as usize);
    }
    order
}

/// Asks for a case whose rays or points come otherwise; `first` is the answer to the case as it is. The answer has the case's own order;
/// there is none where they don't stand alone, are too few, or some part has none.
pub(super) fn ask_otherwise<E>(
    way: Way,
    (question, case, first): (&Question, &Case, &Answer),
    (base, dtype): (&Conventions, Dtype),
    mut ask: impl FnMut(&Case) -> Result<Reply, E>,
) -> Result<Reply, E> {
    let Some((items, parts)) = Items::of(question, case, way, base, dtype) else { return Ok(Reply::Nothing) };
    let mut answers = vec![];
    for (part, tile) in parts.iter().zip(items.cases(&parts)) {
        match ask(&tile)? {
            Reply::Answer(answer) => answers.push(answer),
            Reply::Crash(said) => {
                let how = if way == Way::Tiled { "a tile of" } else { "another order of" };
                let (some, all, id) = (part.len(), items.count, &case.id);
                return Ok(Reply::Crash(format!("{how} {some} of the {all} of {id}: {said}")));
            }
            Reply::Nothing => return Ok(Reply::Nothing),
        }
    }
    let whole = |(name, given): (&String, &Given)| {
        let found: Option<Vec<&Given>> = answers.iter().map(|answer| answer.get(name)).collect();
        Some((name.clone(), items.joined(name, given, &found?, &parts)))
    };
    Ok(Reply::Answer(first.iter().filter_map(whole).collect()))
}

/// Whether an input belongs to all items together: it has their number in another axis too, as a grid of cells.
fn together(letter: &str, port: &Port) -> bool {
    let mut axes = port.shape.split(',');
    let first = axes.next().unwrap_or_default();
    first != letter && first.contains(letter) || axes.any(|axis| axis.contains(letter))
}

/// The rays or points of a case, each of which stands alone.
struct Items<'a> {
    question: &'a Question,
    case: &'a Case,
    count: usize,
}

impl<'a> Items<'a> {
    /// Those of a case, and which come in each call; `None` where they don't stand alone, or are too few.
    fn of(
        question: &'a Question,
        case: &'a Case,
        way: Way,
        base: &Conventions,
        dtype: Dtype,
    ) -> Option<(Items<'a>, Vec<Vec<usize>>)> {
        let component = question.component;
        let counts = |(name, array): (&String, &ArrayD<f64>)| {
            component.counts(name).then(|| array.shape().first().copied()).flatten()
        };
        // Rays, points and parameters; rows of pictures and of weights, and samples that belong to rays, aren't items.
        let letter = component.letter()?;
        let apart = ["R", "M", "P"].contains(&letter);
        let apart = apart && !component.inputs.iter().any(|port| together(letter, port));
        let count = case.inputs.iter().find_map(counts).filter(|_| apart)?;
        let items = Items { question, case, count };
        let parts = way.parts(count).filter(|_| case.edge.is_none() && question.admits(base))?;
        let fits = items.cases(&parts).all(|tile| items.same_forms(&tile.inputs, dtype));
        (fits && items.alone(&parts, base)).then_some((items, parts))
    }

    /// The case with a part of its items, part by part.
    fn cases(&self, parts: &[Vec<usize>]) -> impl Iterator<Item = Case> {
        parts.iter().map(|part| {
            let mut case = self.case.clone();
            for (name, array) in case.inputs.iter_mut() {
                if self.question.component.counts(name) {
                    *array = array.select(Axis(0), part);
                }
            }
            case
        })
    }

    /// Whether every form that can ask the case can ask this too.
    fn same_forms(&self, inputs: &Arrays, dtype: Dtype) -> bool {
        let forms = self.question.component.special.forms;
        forms.iter().all(|form| !(form.holds)(&self.case.inputs, dtype) || (form.holds)(inputs, dtype))
    }

    /// Whether the oracle gives each item the same numbers in its part as among all.
    fn alone(&self, parts: &[Vec<usize>], base: &Conventions) -> bool {
        let component = self.question.component;
        let oracle = component.direction(self.question.kind).expect("the row that is asked").oracle;
        let whole = oracle(&self.case.inputs, base);
        self.cases(parts).zip(parts).all(|(tile, part)| {
            let answer = oracle(&tile.inputs, base);
            let same = |(name, array): (&String, &ArrayD<f64>)| {
                let expected = array.select(Axis(0), part);
                answer[name].shape() == expected.shape()
                    && answer[name].iter().zip(&expected).all(|(a, b)| a.to_bits() == b.to_bits())
            };
            whole.iter().filter(|(name, _)| component.counts(name)).all(same)
        })
    }

    /// An output in the case's own order, from the parts' answers. Of what all items share, such as a table's gradient, only one part that
    /// has all of them can say anything: tiles leave it as it was first. An answer of another length stays as it is: its shape is wrong.
    fn joined(&self, name: &str, first: &Given, found: &[&Given], parts: &[Vec<usize>]) -> Given {
        if !self.question.component.counts(name) {
            return if let [only] = found { (*only).clone() } else { first.clone() };
        }
        let width = first.values.len() / self.count;
        let mut values = vec![0.0; first.values.len()];
        for (part, given) in parts.iter().zip(found) {
            if given.values.len() != part.len() * width {
                return (*given).clone();
            }
            let given: Vec<f64> = given.values.iter().copied().collect();
            for (k, &n) in part.iter().enumerate() {
                values[n * width..(n + 1) * width].copy_from_slice(&given[k * width..(k + 1) * width]);
            }
        }
        let whole = ArrayD::from_shape_vec(first.values.raw_dim(), values);
        whole.map_or_else(|_| first.clone(), |values| Given { values, dtype: first.dtype })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contract::check::Kind;
    use crate::contract::component::Component;
    use crate::convention::CS180;
    use crate::judge::exam::Exam;
    use crate::registry::COMPONENTS;

    #[test]
    fn another_order_leaves_none_in_its_place() {
        for count in 2..40 {
            let order = shuffled(count);
            let mut sorted = order.clone();
            sorted.sort_unstable();
            assert!(sorted.into_iter().eq(0..count) && order.iter().enumerate().all(|(n, &k)| n != k));
        }
    }

    #[test]
    fn tiles_are_two_at_least_and_cover_all() {
        assert!(Way::Tiled.parts(2).is_none() && Way::Shuffled.parts(1).is_none());
        for count in 3..40 {
            let parts = Way::Tiled.parts(count).unwrap();
            assert!(parts.iter().all(|part| 1 < part.len() && part.len() < count));
            assert!((0..count).all(|n| parts.iter().any(|part| part.contains(&n))), "{parts:?}");
        }
    }

    /// What stands alone by the oracle's own word: neither pixels of a grid of rays, nor cells, nor samples of one array of all rays.
    #[test]
    fn the_oracle_says_what_stands_alone() {
        let kinds = |c: &Component| {
            let kinds = [Some(Kind::Forward), c.vjp.map(|_| Kind::Vjp)];
            kinds.into_iter().flatten().map(|kind| (c.name, kind)).collect::<Vec<_>>()
        };
        let rows: Vec<_> = COMPONENTS.iter().flat_map(kinds).collect();
        let exam = Exam::of(&rows, Dtype::F64, None).unwrap();
        let alone = |question: &Question, way| {
            question
                .cases
                .iter()
                .filter(|case| Items::of(question, case, way, &CS180, Dtype::F64).is_some())
                .count()
        };
        let some: Vec<&str> = exam
            .questions
            .iter()
            .filter(|q| alone(q, Way::Shuffled) > 0 && alone(q, Way::Tiled) > 0)
            .map(|q| q.component.name)
            .collect();
        for name in [
            "volume_render",
            "mlp",
            "step_sizes",
            "positional_encoding",
            "adam_step",
            "hash_grid",
            "transform",
        ] {
            assert!(some.contains(&name), "{name}: {some:?}");
        }
        for name in [
            "image_rays",
            "to_uint8",
            "occupancy_grid",
            "mse",
            "ssim",
            "pack_info",
            "training_step",
            "render_trace",
        ] {
            assert!(!some.contains(&name), "{name}");
        }
    }
}
