//! How sharp the bounds are, and what lies below them, as a page generated from the code.
#![doc = include_str!("../../tests/pages/BOUNDS.md")]

use super::selfcheck;
use crate::contract::arithmetic::Dtype;

/// The page.
pub fn page() -> String {
    let mut page = String::from(
        "# Bounds\n\nWritten by `nerf-oracle check --tables`; a test keeps it current.\n\n\
         Over all cases of the default profile. *Elements* aren't 0 over the reals; a bound that reaches an element's size is \
         *vacuous* there, which is counted and never passes for proof. *Bound over y* is the bound of the textbook formula (grade \
         B) over |y| in the middle of the elements that are left, *error over bound* the largest of eight honest machines.\n\n\
         | component | kind | type | cases | elements | vacuous | bound over y | error over bound |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    for row in selfcheck::all() {
        let percent = 100.0 * row.vacuous as f64 / row.elements.max(1) as f64;
        page += &format!(
            "| {} | {} | {} | {} | {} | {percent:.1}% | {:.1e} | {:.2} |\n",
            row.name, row.kind, row.dtype, row.cases, row.elements, row.bound_over_y, row.error_over_bound
        );
    }
    page += "\n## Mistakes below the bound\n\nIn f64 every mistake of the catalogue exceeds the bound on some case. In f32 these \
             do not; error over bound, on the case where it is largest:\n\n| component | mistake | f32 |\n|---|---|---|\n";
    for row in selfcheck::all().iter().filter(|row| row.dtype == Dtype::F32) {
        for (name, ratio) in &row.missed {
            page += &format!("| {} | {} | {ratio:.1e} |\n", row.name, name.replace('_', "\\_"));
        }
    }
    page
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    #[test]
    fn the_page_is_current() {
        let current = page() == include_str!("../../tests/pages/BOUNDS.md");
        assert!(current, "write it again: nerf-oracle check --tables tests/pages/BOUNDS.md");
    }

    /// Rows that see no rounding: every honest machine returns exactly the expected numbers, so they say nothing about the bound's size.
    const EXACT: [(&str, &str, &[Dtype]); 6] = [
        ("step_sizes", "forward", &[Dtype::F64]),
        ("to_uint8", "forward", &[Dtype::F64, Dtype::F32]),
        ("occupancy_grid", "forward", &[Dtype::F64]),
        ("pack_info", "forward", &Dtype::ALL),
        ("clip_by_value", "forward", &[Dtype::F64]),
        ("pose_from_colmap", "forward", &[Dtype::Tf32, Dtype::Bf16, Dtype::F16]),
    ];

    /// Honest machines use at most the whole bound; of one that is 100 times too loose none would use more than 1/100. So in every
    /// type some machine must use more than 1/100 of it, and for every component and direction, in some type, 1/25.
    #[test]
    fn no_bound_is_a_hundred_times_too_loose() {
        let (mut used, mut loose) = (BTreeMap::<String, f64>::new(), vec![]);
        for row in selfcheck::all() {
            let most = row.error_over_bound;
            let listed = EXACT.iter().find(|(name, kind, _)| *name == row.name && *kind == row.kind);
            if listed.is_some_and(|(.., types)| types.contains(&row.dtype)) {
                assert_eq!(most, 0.0, "{} {} {} rounds: take it off the list", row.name, row.kind, row.dtype);
            } else if most <= 0.01 {
                loose.push(format!("{} {} {}: {most:e}", row.name, row.kind, row.dtype));
            }
            if listed.is_none_or(|(.., types)| types.len() < Dtype::ALL.len()) {
                let all = used.entry(format!("{} {} in every type", row.name, row.kind)).or_default();
                *all = all.max(most);
            }
        }
        loose.extend(
            used.iter().filter(|(_, most)| **most < 0.04).map(|(name, most)| format!("{name}: {most:e}")),
        );
        assert!(
            loose.is_empty(),
            "no honest machine uses a hundredth of the bound (error over bound): tighten the bound, let honest.rs round more, or, \
             where nothing rounds and it is 0e0, add the row to EXACT here: {loose:#?}"
        );
    }

    #[test]
    fn every_row_proves_something() {
        for row in selfcheck::all() {
            let label = format!("{} {} {}", row.name, row.kind, row.dtype);
            assert!(row.vacuous < row.elements && row.zero_fails, "{label}: only vacuous elements");
            assert!(
                row.rejected == 0 && row.error_over_bound <= 1.0,
                "{label}: an honest answer is rejected"
            );
            assert!(row.dtype != Dtype::F64 || row.missed.is_empty(), "{label}: {:?} pass", row.missed);
        }
    }
}
