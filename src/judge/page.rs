//! The judge's page for people.

use std::collections::BTreeMap;
use std::fmt;

use super::diagnosis::evidence::Explanation;
use super::mark::Worst;
use super::partial::Partial;
use super::report::{Report, Row, Verdict};
use crate::contract::arithmetic::Grade;
use crate::contract::component::Mistake;
use crate::contract::hazard::{Hazard, of_case};

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let how = if self.pinned { "PINNED" } else { "FOUND" };
        if self.assignment.is_empty() {
            writeln!(f, "answers in {}", self.dtype)?;
        } else {
            writeln!(f, "CONVENTIONS {how}: {}   (answers in {})", self.profile, self.dtype)?;
        }
        if self.left_out > 0 {
            writeln!(f, "{} cases aren't representable in {} and were left out", self.left_out, self.dtype)?;
        }
        writeln!(
            f,
            "\n{:<24}{:<12}{:>7}  {:<12}{:<7}{:>10}{:>9}{:>9}",
            "component", "kind", "cases", "verdict", "grade", "budget", "honest", "vacuous"
        )?;
        for row in self.rows.iter().filter(|row| row.verdict != Verdict::Unsupported) {
            let budget = row.budget_used.map_or(String::new(), percent);
            let grade = row.grade.map_or("-".into(), |grade| format!("{grade:?}"));
            let honest = row.over_honest().map_or("-".into(), |times| format!("{times:.1} x"));
            let cases = format!("{}/{}", row.answered, row.cases);
            writeln!(
                f,
                "{:<24}{:<12}{cases:>7}  {:<12}{grade:<7}{budget:>10}{honest:>9}{:>9}",
                row.name, row.kind, row.verdict, row.vacuous
            )?;
        }
        writeln!(
            f,
            "\nbudget: the largest error, of what is allowed; grade: A, the stable formula's bound held, B, the textbook's;\n\
             honest: that share, in those of the best of four honest machines, their exponentials off by up to 4 ULP;\n\
             vacuous: elements whose bound reaches their own size, so that 0 would pass too"
        )?;
        let unsupported = self.rows.iter().filter(|row| row.verdict == Verdict::Unsupported);
        let names: Vec<String> = unsupported.map(|row| format!("{} {}", row.name, row.kind)).collect();
        if !names.is_empty() {
            writeln!(f, "\nunsupported (nothing answered): {}", names.join(", "))?;
        }
        for row in self.rows.iter().filter(|row| row.verdict != Verdict::Unsupported) {
            notes(f, row)?;
        }
        writeln!(f, "\n{}", counts(self))
    }
}

/// How many rows have each verdict.
pub(crate) fn counts(report: &Report) -> String {
    let all = [
        (Verdict::Pass, "passed"),
        (Verdict::Fail, "failed"),
        (Verdict::Unproved, "unproved"),
        (Verdict::Imprecise, "imprecise"),
        (Verdict::Edge, "wrong in edge cases alone"),
        (Verdict::Unsupported, "unsupported"),
    ];
    all.map(|(verdict, word)| format!("{} {word}", report.count(verdict))).join(", ")
}

/// Error over bound.
pub(crate) fn percent(used: f64) -> String {
    match used {
        u if !u.is_finite() => "inf".into(),
        u if u < 10.0 => format!("{:.1}%", 100.0 * u),
        u => format!("{u:.1e} x"),
    }
}

fn notes(f: &mut fmt::Formatter, row: &Row) -> fmt::Result {
    for finding in &row.findings {
        writeln!(f, "\n{} {}: a choice, no mistake: {finding}", row.name, row.kind)?;
    }
    if !row.left_out.is_empty() {
        let mut needed: Vec<&str> = row.left_out.values().flat_map(|names| names.split(", ")).collect();
        needed.sort_unstable();
        needed.dedup();
        let (cases, needed) = (row.left_out.len(), needed.join(", "));
        writeln!(f, "\n{} {}: {cases} cases left out, as they need {needed}", row.name, row.kind)?;
    }
    let textbook = row.grades.values().filter(|grade| **grade == Grade::B).count();
    if textbook > 0 {
        let first = row.grades.iter().find(|(_, grade)| **grade == Grade::B).map_or("", |(id, _)| id);
        let graded = row.grades.len();
        writeln!(
            f,
            "\n{} {}: grade B in {textbook} of {graded} graded cases, {first} among them",
            row.name, row.kind
        )?;
    }
    if row.verdict == Verdict::Pass {
        for layout in &row.layouts {
            writeln!(f, "\n{} {}: layout {layout}", row.name, row.kind)?;
        }
        if !row.missing_outputs.is_empty() {
            writeln!(
                f,
                "\n{} {}: not credited, as not answered: {}",
                row.name,
                row.kind,
                row.missing_outputs.join(", ")
            )?;
        }
        return Ok(());
    }
    if row.verdict == Verdict::Unproved {
        return writeln!(f, "\nUNPROVED {} {}: {}", row.name, row.kind, row.unproved_for());
    }
    let word = row.verdict.to_string().to_uppercase();
    writeln!(f, "\n{word} {} {}", row.name, row.kind)?;
    if let Some(bits) = row.lost_bits {
        let digits = f64::from(bits) * std::f64::consts::LOG10_2;
        writeln!(
            f,
            "  the right formula, with {bits} {} ({digits:.1} digits) lost, first of all in {}",
            if bits == 1 { "bit" } else { "bits" },
            row.off.join(", ")
        )?;
        if bits >= 24 {
            writeln!(f, "    no more is left than f32 has: something is computed in it on the way")?;
        }
    }
    if !row.edge_cases.is_empty() {
        writeln!(f, "  right, but for edge cases: {}", but_for(row))?;
    }
    for layout in &row.layouts {
        writeln!(f, "  read in the contract's layout: {layout}")?;
    }
    for fault in row.faults.iter().take(4) {
        writeln!(f, "  {fault}")?;
    }
    if row.faults.len() > 4 {
        writeln!(f, "  and {} more like these", row.faults.len() - 4)?;
    }
    if !row.missing_outputs.is_empty() {
        writeln!(f, "  not answered: {}", row.missing_outputs.join(", "))?;
    }
    if !row.shown_in.is_empty() {
        writeln!(f, "  shown in the conventions next to these answers: {}", list(&row.shown_in))?;
    }
    if let Some(w) = row.worst_case.as_ref().filter(|_| row.budget_used > Some(1.0)) {
        writeln!(
            f,
            "  worst at case {}, {}{:?}: got {:.9e}, expected {:.9e}",
            w.id, w.output, w.index, w.got, w.expected
        )?;
        let allowed = if w.bound == 0.0 { "nothing".into() } else { format!("{:.2e}", w.bound) };
        writeln!(f, "  off by {:.2e}{}, where {allowed} is allowed", (w.got - w.expected).abs(), places(w))?;
    }
    if !row.contradiction.is_empty() {
        writeln!(f, "  right with {}, which contradicts the rest of this run", list(&row.contradiction))?;
    }
    let explained = row.verdict == Verdict::Edge && !row.diagnosis.is_empty();
    if explained || row.verdict == Verdict::Fail && row.budget_used > Some(1.0) {
        diagnosis(f, row)?;
    }
    if let Some(example) = &row.example {
        write!(f, "{example}")?;
    }
    Ok(())
}

/// The edge cases in which a row is wrong, each with what happens there, in a word.
fn but_for(row: &Row) -> String {
    let one = |(edge, id): (&&str, &String)| {
        let what = row.faults.iter().filter_map(|fault| fault.strip_prefix(id)?.strip_prefix(": ")).next();
        let what = match what {
            Some(said) if said.starts_with("crashed") => "crashes",
            Some(said) if said.ends_with("NaN") => "NaN",
            Some(_) => "no such arrays",
            None => "other numbers",
        };
        format!("{edge} ({what}: {id})")
    };
    row.edge_cases.iter().zip(&row.wrong_cases).map(one).collect::<Vec<_>>().join(", ")
}

/// What is said of one row under the table.
#[cfg(feature = "cli")]
pub(crate) fn of_row(row: &Row) -> String {
    struct Notes<'a>(&'a Row);
    impl fmt::Display for Notes<'_> {
        fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
            notes(f, self.0)
        }
    }
    Notes(row).to_string()
}

/// What goes wrong in hard cases like those that an explanation leaves.
fn hazards(f: &mut fmt::Formatter, e: &Explanation) -> fmt::Result {
    let all = e.unexplained_cases.iter().filter_map(|id| of_case(id));
    let known: BTreeMap<&str, &Hazard> = all.map(|hazard| (hazard.id, hazard)).collect();
    known.values().try_for_each(|h| writeln!(f, "    {}, {}: {}", h.id, h.title, h.effect))
}

fn diagnosis(f: &mut fmt::Formatter, row: &Row) -> fmt::Result {
    let Some(best) = row.diagnosis.first() else {
        writeln!(
            f,
            "  diagnosis: unknown: no mistake of the catalogue gives these numbers, nor do those that were tried together"
        )?;
        for sentence in &row.observed {
            writeln!(f, "    {sentence}")?;
        }
        return match row.off.first() {
            Some(name) => writeln!(f, "    the first output to differ is {name}: begin there"),
            None => Ok(()),
        };
    };
    if best.inaccurate {
        return writeln!(
            f,
            "  consistent with: no mistake: {}the right formula, with more digits lost than are allowed",
            before(best)
        );
    }
    // Right elsewhere is no acquittal.
    if !best.wrong() && !best.unexplained_cases.is_empty() && best.unexplained.is_empty() {
        let cases = best.unexplained_cases.join(", ");
        writeln!(
            f,
            "  wrong in {cases} alone: all other cases follow {}the right formula; look at these by hand",
            before(best)
        )?;
        return hazards(f, best);
    }
    writeln!(f, "  consistent with: {}{}", name(best), closeness(best))?;
    if !best.spared.is_empty() {
        let spared = best.spared.join(", ");
        writeln!(
            f,
            "  but {spared}, which it would change, is right: it happens to the other outputs alone"
        )?;
    }
    for (output, some) in best.apart.iter().filter(|(_, some)| !some.is_empty()) {
        writeln!(f, "  {output} with {} alone", some.join(", "))?;
    }
    if !best.unexplained.is_empty() {
        writeln!(f, "  but for {}, which something more must explain", best.unexplained.join(", "))?;
    }
    if !best.unexplained_cases.is_empty() {
        let cases = best.unexplained_cases.join(", ");
        writeln!(f, "  but for the cases {cases}, where something more is wrong: look at these by hand")?;
        hazards(f, best)?;
    }
    for sentence in &row.observed {
        writeln!(f, "    {sentence}")?;
    }
    for same in row.diagnosis.iter().filter(|e| e.same_as_best) {
        writeln!(f, "  or, the same on every case: {}", name(same))?;
    }
    for mistake in &best.mistakes {
        writeln!(f, "    {}: {}", mistake.name, mistake.cause)?;
        writeln!(f, "      effect: {}", mistake.effect)?;
        writeln!(f, "      to fix:  {}   (seen: {})", mistake.fix, mistake.seen)?;
    }
    if row.kind == "vjp" && best.of_forward() {
        writeln!(f, "  a mistake of the forward function: its gradient follows from it")?;
    }
    if let Some(next) = row.diagnosis.iter().skip(1).find(|e| !e.same_as_best) {
        writeln!(f, "  runner-up: {}", name(next))?;
    }
    Ok(())
}

/// The error in units in the last place, where that number means something.
fn places(w: &Worst) -> String {
    match w.ulp {
        ulp if w.expected == 0.0 || !ulp.is_finite() => String::new(),
        ulp if ulp < 1e6 => format!(" ({ulp:.1} ULP)"),
        ulp => format!(" ({ulp:.1e} ULP)"),
    }
}

/// How well it fits: how much of what wrong code may be off is used, where that is a number at all.
fn closeness(e: &Explanation) -> String {
    match e.residual {
        r if r > 0.0 && r.is_finite() => format!("   (off by {:.1}% of what such code may be)", 100.0 * r),
        _ => String::new(),
    }
}

/// The conventions in which the right formula is followed.
fn before(e: &Explanation) -> String {
    if e.conventions.is_empty() { String::new() } else { format!("with {}, ", list(&e.conventions)) }
}

/// An explanation on a line.
pub(crate) fn name(e: &Explanation) -> String {
    let mut numbers = e.fitted.iter();
    let of = |m: &&Mistake| match m.number.and_then(|number| Some((number, numbers.next()?))) {
        Some((number, fitted)) => format!("{} ({} = {fitted:?})", m.name, number.name),
        None => m.name.to_string(),
    };
    let mut mistakes = e.mistakes.iter().map(of).collect::<Vec<_>>().join(" + ");
    if let Some(slip) = &e.slip {
        mistakes += if mistakes.is_empty() { "" } else { " + " };
        mistakes += &slip.named();
    }
    match (!e.wrong(), e.conventions.is_empty()) {
        (true, true) => "the right formula".into(),
        (false, true) => mistakes,
        (true, _) => format!("no mistake, but the convention {}", list(&e.conventions)),
        (false, false) => format!("{mistakes}, with {}", list(&e.conventions)),
    }
}

fn list(partial: &Partial) -> String {
    partial.iter().map(|(key, value)| format!("{key} = {value}")).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::registry::COMPONENTS;

    #[test]
    fn numbers_keep_their_digits_and_their_mistake() {
        let named = |mistakes: &[&str], fitted| {
            let find = |name: &&str| COMPONENTS.iter().flat_map(|c| c.mistakes).find(|m| m.name == *name);
            let mistakes = mistakes.iter().map(|name| find(name).expect("a mistake")).collect();
            name(&Explanation { mistakes, fitted: vec![fitted], ..Explanation::default() })
        };
        assert_eq!(named(&["eps_on_alpha"], 1e-12), "eps_on_alpha (eps = 1e-12)");
        assert_eq!(named(&["scaled_exponential"], 0.98), "scaled_exponential (k = 0.98)");
        let pair = ["inclusive_transmittance", "weights_normalized"];
        assert_eq!(named(&pair, 1e-5), "inclusive_transmittance + weights_normalized (eps = 1e-5)");
    }
}
