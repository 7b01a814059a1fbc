//! How sharp the bounds are, and what lies below them, as a page generated from the code.
#![doc = include_str!("BOUNDS.md")]

use super::arithmetic::Dtype;
use super::selfcheck;

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
        let current = page() == include_str!("BOUNDS.md");
        assert!(current, "write it again: nerf-oracle check --tables src/verify/BOUNDS.md");
    }

    /// Of every component and direction some honest machine, in some type, uses a 25th of the bound: a hundred times as loose none would.
    #[test]
    fn no_bound_is_a_hundred_times_too_loose() {
        let mut used: BTreeMap<String, f64> = BTreeMap::new();
        for row in selfcheck::all() {
            let most = used.entry(format!("{} {}", row.name, row.kind)).or_default();
            *most = most.max(row.error_over_bound);
        }
        let loose: Vec<_> = used.iter().filter(|(_, most)| **most < 0.04).collect();
        assert!(loose.is_empty(), "error over bound in no type above {loose:?}");
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
