//! The bounds are sound in every convention that a component depends on, not in the default profile alone.

mod types;

use nerf_oracle::COMPONENTS;
use nerf_oracle::contract::arithmetic::{Arithmetic, Dtype, Grade};
use nerf_oracle::contract::check::{Kind, tolerance, worst};
use nerf_oracle::contract::{Component, Machine};
use nerf_oracle::convention::profiles::PROFILES;
use nerf_oracle::convention::{CHOICES, CS180, Conventions, Delta, LastDelta};
use nerf_oracle::parallel;
use types::types;

/// All combinations of a component's conventions; where these are more than three, one at a time, and the profiles'.
fn assignments(component: &Component) -> Vec<Conventions> {
    let mut all = vec![CS180];
    for &key in component.conventions {
        let values = CHOICES.iter().find(|(name, _)| *name == key).expect("listed").1;
        let with = |c: &Conventions| {
            values.iter().map(|value| c.with(key, value).expect("listed")).collect::<Vec<_>>()
        };
        if component.conventions.len() <= 3 {
            all = all.iter().flat_map(with).collect();
        } else {
            all.extend(with(&CS180).into_iter().filter(|c| *c != CS180));
        }
    }
    // And those that programs have at once, where they are others in what this component reads.
    let read = |c: &Conventions| component.conventions.iter().map(|key| c.get(key)).collect::<Vec<_>>();
    for profile in PROFILES {
        if all.iter().all(|c| read(c) != read(&profile.conventions)) {
            all.push(profile.conventions);
        }
    }
    all
}

/// Whether a type has the numbers of these conventions: to f16 1e10 is infinite, and a density of 0 times such a step is no number.
fn in_range(component: &Component, c: &Conventions, dtype: Dtype) -> bool {
    let rendered = component.name != "step_sizes" && component.conventions.contains(&"last_delta");
    let endless = c.delta != Delta::Width && c.last_delta == LastDelta::TenToTen;
    dtype != Dtype::F16 || !rendered || !endless
}

/// Evaluations of honest machines in one assignment of conventions, and those that the bound rejects.
fn rejections(component: &Component, c: Conventions) -> (u64, Vec<String>) {
    let (mut evaluations, mut rejected) = (0, vec![]);
    let each = types(&[77], &[29])[0];
    for kind in [Kind::Forward, Kind::Vjp] {
        let Some(direction) = component.direction(kind) else { continue };
        for case in component.cases_of(kind, &c) {
            // Three machines out of 192, or seven: with either step, order, fusing, formula and form all vary. Three for the network at
            // full size in another convention than the default always: longer sums are what it adds, and these are the same in each.
            let large = case.inputs.values().map(|a| a.len()).sum::<usize>() >= 20_000;
            let machines = (0..192).step_by(if large && c != CS180 { 77 } else { each });
            let expected = (direction.oracle)(&case.inputs, &c);
            let label = format!("{} {kind:?} {}", component.name, case.id);
            assert_eq!(expected, (direction.wrong)(&case.inputs, &c, &[]), "{label}");
            let tried = types(&[Dtype::F32], &Dtype::ALL);
            let known = |dtype: Dtype| case.exists_in(dtype) && in_range(component, &c, dtype);
            for &dtype in tried.iter().filter(|&&dtype| known(dtype)) {
                // The bound depends on the type and the grade, not on the machine.
                let bound = |grade| tolerance(direction, &case.inputs, &c, &Arithmetic::new(dtype, grade));
                let (stable, textbook) = (bound(Grade::A), bound(Grade::B));
                let machines: Vec<Machine> = machines.clone().map(|n| Machine::number(dtype, n)).collect();
                assert!([true, false].iter().all(|&stable| machines.iter().any(|m| m.stable == stable)));
                for machine in machines {
                    let bound = if machine.stable { &stable } else { &textbook };
                    let used = worst(&(direction.honest)(&case.inputs, &c, &machine), &expected, bound);
                    evaluations += 1;
                    if used > 1.0 {
                        rejected.push(format!("{label} {dtype}: {used:.3} by {machine:?}, {c:?}"));
                    }
                }
            }
        }
    }
    (evaluations, rejected)
}

#[test]
fn no_honest_implementation_is_rejected_in_any_convention() {
    let jobs: Vec<_> =
        COMPONENTS.iter().flat_map(|c| assignments(c).into_iter().map(move |a| (c, a))).collect();
    let all = parallel::map(jobs.len(), |n| rejections(jobs[n].0, jobs[n].1));
    let evaluations: u64 = all.iter().map(|(count, _)| count).sum();
    let rejected: Vec<String> = all.into_iter().flat_map(|(_, rejected)| rejected).collect();
    println!("{evaluations} evaluations, {} rejected", rejected.len());
    let first = rejected[..rejected.len().min(20)].join("\n");
    assert!(rejected.is_empty(), "{} rejected:\n{first}", rejected.len());
}
