//! The bound is sound (no honest implementation is rejected), sharp (the all-zero answer is), and every mistake exceeds it.

use nerf_oracle::COMPONENTS;
use nerf_oracle::contract::arithmetic::{Arithmetic, Dtype, Grade};
use nerf_oracle::contract::check::{Kind, tolerance, worst};
use nerf_oracle::contract::{Component, Machine};
use nerf_oracle::convention::CS180;
use nerf_oracle::convention::profiles::PROFILES;
use nerf_oracle::parallel;

/// Machines per case, and evaluations that each component and direction has at least (those with few cases get more machines): 48 and
/// 0 by default, which makes the suite fast; `BOUND_MACHINES=192` for that many and 2,000.
fn machines() -> (u64, u64) {
    match std::env::var("BOUND_MACHINES").ok().and_then(|n| n.parse().ok()) {
        Some(machines) => (machines, 2000),
        None => (48, 0),
    }
}

/// Evaluations of honest machines, and those that the bound rejects.
fn rejections(component: &Component, kind: Kind, dtype: Dtype) -> (u64, Vec<String>) {
    let Some(direction) = component.direction(kind) else { return (0, vec![]) };
    let (mut count, mut rejected) = (0, vec![]);
    let cases = component.cases_of(kind, &CS180);
    let (machines, at_least) = machines();
    let machines = machines.max(at_least.div_ceil((cases.len() * Dtype::ALL.len()).max(1) as u64));
    for case in cases.iter().filter(|case| case.exists_in(dtype)) {
        let expected = (direction.oracle)(&case.inputs, &CS180);
        let bounds = [Grade::A, Grade::B]
            .map(|g| tolerance(direction, &case.inputs, &CS180, &Arithmetic::new(dtype, g)));
        for n in 0..machines {
            let machine = Machine::number(dtype, n);
            let got = (direction.honest)(&case.inputs, &CS180, &machine);
            let used = worst(&got, &expected, &bounds[usize::from(!machine.stable)]);
            count += 1;
            if used > 1.0 {
                rejected.push(format!(
                    "{} {kind:?} {dtype} {}: {used:.3} by {machine:?}",
                    component.name, case.id
                ));
            }
        }
    }
    (count, rejected)
}

#[test]
fn no_honest_implementation_is_rejected() {
    let both = [Kind::Forward, Kind::Vjp];
    let rows: Vec<_> = COMPONENTS.iter().flat_map(|c| both.map(|kind| (c, kind))).collect();
    let rows: Vec<_> = rows.into_iter().filter(|(c, kind)| c.direction(*kind).is_some()).collect();
    let types = Dtype::ALL.len();
    let results = parallel::map(rows.len() * types, |n| {
        let (component, kind) = rows[n / types];
        rejections(component, kind, Dtype::ALL[n % types])
    });
    let mut evaluations = 0;
    for ((component, kind), results) in rows.iter().zip(results.chunks(types)) {
        let count: u64 = results.iter().map(|(count, _)| count).sum();
        println!("{:<24}{kind:?}: {count} evaluations", component.name);
        assert!(count > 0, "{} {kind:?}: nothing was evaluated", component.name);
        evaluations += count;
    }
    let rejected: Vec<String> = results.into_iter().flat_map(|(_, rejected)| rejected).collect();
    println!("{evaluations} evaluations, {} rejected", rejected.len());
    assert!(
        rejected.is_empty(),
        "{} rejected:\n{}",
        rejected.len(),
        rejected[..rejected.len().min(40)].join("\n")
    );
}

/// What the stable formula may be off by is allowed to whoever is judged by the textbook's.
#[test]
fn the_textbooks_bound_is_the_wider() {
    let kinds = [Kind::Forward, Kind::Vjp];
    let rows: Vec<_> = COMPONENTS.iter().flat_map(|c| kinds.map(|kind| (c, kind))).collect();
    let narrower = parallel::map(rows.len(), |n| {
        let (component, kind) = rows[n];
        let Some(direction) = component.direction(kind) else { return vec![] };
        let mut narrower = vec![];
        for case in component.cases_of(kind, &CS180) {
            for dtype in Dtype::ALL.into_iter().filter(|dtype| case.exists_in(*dtype)) {
                let [stable, textbook] = [Grade::A, Grade::B]
                    .map(|g| tolerance(direction, &case.inputs, &CS180, &Arithmetic::new(dtype, g)));
                // Up to the roundings of the bounds themselves.
                let narrow = |name: &String| {
                    stable[name].iter().zip(&textbook[name]).any(|(a, b)| a.is_nan() || *a > b * (1.0 + 1e-9))
                };
                let names = stable.keys().filter(|name| narrow(name));
                narrower.extend(
                    names.map(|name| format!("{} {kind:?} {dtype} {} {name}", component.name, case.id)),
                );
            }
        }
        narrower
    });
    let narrower = narrower.concat();
    assert!(narrower.is_empty(), "{} narrower, {:#?}", narrower.len(), &narrower[..narrower.len().min(40)]);
}

#[test]
fn the_all_zero_answer_is_rejected() {
    for component in COMPONENTS {
        for kind in [Kind::Forward, Kind::Vjp] {
            let Some(direction) = component.direction(kind) else { continue };
            for dtype in Dtype::ALL {
                let arithmetic = Arithmetic::new(dtype, Grade::B);
                let fails = component.cases_of(kind, &CS180).iter().filter(|case| case.exists_in(dtype)).any(
                    |case| {
                        let expected = (direction.oracle)(&case.inputs, &CS180);
                        let zero = expected.iter().map(|(name, a)| (name.clone(), a.mapv(|_| 0.0))).collect();
                        worst(&zero, &expected, &tolerance(direction, &case.inputs, &CS180, &arithmetic))
                            > 1.0
                    },
                );
                assert!(fails, "{} {kind:?} {dtype}: the all-zero answer passes", component.name);
            }
        }
    }
}

#[test]
fn every_mistake_is_rejected_in_f64() {
    for component in COMPONENTS {
        for mistake in component.mistakes {
            let kind = if mistake.gradient { Kind::Vjp } else { Kind::Forward };
            let direction = component.direction(kind).expect("a gradient mistake needs a gradient");
            let arithmetic = Arithmetic::new(Dtype::F64, Grade::B);
            let caught = component.cases_of(kind, &CS180).iter().any(|case| {
                let expected = (direction.oracle)(&case.inputs, &CS180);
                let got = (direction.wrong)(&case.inputs, &CS180, &[mistake.name]);
                worst(&got, &expected, &tolerance(direction, &case.inputs, &CS180, &arithmetic)) > 1.0
            });
            assert!(caught, "{} {}: no case catches it", component.name, mistake.name);
        }
    }
}

/// What makes a row's wrong code do everything its own way, and nothing wrong: a number at which its mistake does nothing.
fn inert(row: &str) -> &'static str {
    match row {
        "volume_render" => "backward_given_up=0",
        "volume_render_alpha" => "stopped_behind_the_sample=0",
        _ => "no_mistake",
    }
}

/// Gradients that are written again by hand, so that mistakes have their places, in every convention that profiles have.
#[test]
fn a_gradient_by_hand_is_the_oracle_but_for_its_mistakes() {
    let arithmetic = Arithmetic::new(Dtype::F64, Grade::B);
    let rows = ["volume_render", "volume_render_alpha"];
    let by_hand = |c: &&Component| c.name.starts_with("gaussian_") || rows.contains(&c.name);
    for component in COMPONENTS.iter().filter(by_hand) {
        let Some(direction) = component.direction(Kind::Vjp) else { continue };
        for profile in PROFILES {
            let c = &profile.conventions;
            for case in component.cases_of(Kind::Vjp, c) {
                let got = (direction.wrong)(&case.inputs, c, &[inert(component.name)]);
                let used = worst(
                    &got,
                    &(direction.oracle)(&case.inputs, c),
                    &tolerance(direction, &case.inputs, c, &arithmetic),
                );
                assert!(used <= 1.0, "{} {} {}: {used}", component.name, profile.name, case.id);
            }
        }
    }
}

#[test]
fn no_mistake_is_the_oracle() {
    for component in COMPONENTS {
        for kind in [Kind::Forward, Kind::Vjp] {
            let Some(direction) = component.direction(kind) else { continue };
            for case in component.cases_of(kind, &CS180) {
                let (oracle, none) =
                    ((direction.oracle)(&case.inputs, &CS180), (direction.wrong)(&case.inputs, &CS180, &[]));
                assert_eq!(oracle, none, "{} {kind:?} {}", component.name, case.id);
            }
        }
    }
}
