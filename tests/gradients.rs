//! Every hand-written backward against differences, in every convention. A whole training step: tests/training_gradients.rs; at kinks:
//! tests/kinks.rs.

use nerf_oracle::COMPONENTS;
use nerf_oracle::contract::arrays::Arrays;
use nerf_oracle::contract::component::{Component, Function};
use nerf_oracle::contract::{Draw, Kind};
use nerf_oracle::convention::{CHOICES, CS180, Conventions};
use nerf_oracle::proof::gradient::{directional, inner, moved};
use nerf_oracle::trunc_exp::{LIMIT, trunc_exp};

/// Relative to the largest gradient.
const TOLERANCE: f64 = 1e-8;

/// Choices whose gradient is a stated surrogate, as a code base has it on purpose: a plain check must fail.
const SURROGATE_CHOICES: &[(&str, &str)] =
    &[("splat_clamp_gradient", "held"), ("conic_gradient", "entry"), ("sigma_relu", "inside")];

/// CS180, and CS180 with each choice of each convention that the component depends on, but for surrogates.
fn conventions_of(component: &Component) -> Vec<Conventions> {
    let mut all = vec![CS180];
    for (key, values) in CHOICES.iter().filter(|(key, _)| component.conventions.contains(key)) {
        let others = values
            .iter()
            .filter(|value| CS180.get(key) != **value && !SURROGATE_CHOICES.contains(&(*key, **value)));
        all.extend(others.map(|value| CS180.with(key, value).unwrap()));
    }
    all
}

/// A number in [-1, 1), not short.
fn signed(draw: &mut Draw) -> f64 {
    2.0 * draw.unit() - 1.0
}

/// Directions: for each differentiable input one that moves it alone, by about its own size, and one that moves all of them.
fn directions(component: &Component, inputs: &Arrays, draw: &mut Draw) -> Vec<Arrays> {
    let mut all = Arrays::new();
    let mut directions = vec![];
    for name in component.differentiable_arrays(inputs) {
        let x = &inputs[&name];
        let size = x.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
        let v = x.mapv(|x| signed(draw) * if x == 0.0 { size.clamp(1e-3, 1.0) } else { x.abs().min(1e3) });
        directions.push(Arrays::from([(name.clone(), v.clone())]));
        all.insert(name, v);
    }
    directions.push(all);
    directions
}

/// The result of a check by differences: directions that it could decide, directions tried, and where it disagrees.
struct Checked {
    decided: usize,
    tried: usize,
    disagreements: Vec<String>,
}

/// The component's gradient against differences of `forward`, in one assignment of conventions.
fn check(component: &Component, forward: Function, c: &Conventions) -> Checked {
    let vjp = component.vjp.expect("asked for a component with a VJP").oracle;
    let (mut decided, mut tried, mut disagreements) = (0, 0, vec![]);
    for (n, case) in component.cases_of(Kind::Vjp, c).into_iter().enumerate() {
        let gradient: Arrays = vjp(&case.inputs, c)
            .into_iter()
            .map(|(name, g)| (name.strip_prefix("grad_").expect("named after its input").to_string(), g))
            .collect();
        let cotangents: Arrays = case
            .inputs
            .iter()
            .filter_map(|(name, w)| Some((name.strip_prefix("grad_")?.to_string(), w.clone())))
            .collect();
        let pulled = |x: &Arrays| inner(&forward(x, c), &cotangents);
        let mut draw = Draw::new(component.name, 2000 + n as u64);
        for v in directions(component, &case.inputs, &mut draw) {
            // <J v, w> by differences, <v, J^T w> by hand, relative to the largest term of the latter.
            let largest = v.iter().flat_map(|(name, v)| v.iter().zip(&gradient[name]));
            let largest = largest.map(|(v, g)| (v * g).abs()).fold(0.0, f64::max);
            let difference = directional(pulled, &case.inputs, &v, 1.0 / 64.0);
            tried += 1;
            // At a jump (an empty ray's depth) differences see the function beside it.
            let beside = pulled(&moved(&case.inputs, &v, 1e-9)) - pulled(&case.inputs);
            if beside.abs() > 1e-6 * (1.0 + largest) {
                continue;
            }
            // A kink, a jump, the edge of the domain, or noise: differences can't decide. The next direction can.
            if largest.is_nan() || difference.error.is_nan() || difference.error > 0.1 * TOLERANCE * largest {
                assert!(!largest.is_nan(), "{} {}: NaN in the gradient", component.name, case.id);
                continue;
            }
            decided += 1;
            let by_hand = inner(&v, &gradient);
            if (by_hand - difference.value).abs() > TOLERANCE * largest {
                disagreements.push(format!(
                    "{} {}: {by_hand} by hand, {} by differences along {:?}; {c:?}",
                    component.name,
                    case.id,
                    difference.value,
                    v.keys().collect::<Vec<_>>(),
                ));
            }
        }
    }
    Checked { decided, tried, disagreements }
}

/// Components whose gradient is a stated surrogate: a plain check must fail.
const SURROGATES: &[&str] = &["trunc_exp"];

#[test]
fn every_component_in_every_convention() {
    let derived = |c: &&Component| c.vjp.is_some() && !SURROGATES.contains(&c.name);
    for component in COMPONENTS.iter().filter(derived) {
        for c in conventions_of(component) {
            let Checked { decided, tried, disagreements } = check(component, component.forward.oracle, &c);
            println!("{}: {decided} of {tried} directions decided", component.name);
            assert!(disagreements.is_empty(), "{}", disagreements.join("\n"));
            assert!(decided * 2 >= tried && decided > 0, "{}: {decided} of {tried} decided", component.name);
        }
    }
}

#[test]
fn surrogate_choices_fail_the_plain_check() {
    for (key, value) in SURROGATE_CHOICES {
        let of_choice = |c: &&Component| c.vjp.is_some() && c.conventions.contains(key);
        let component = COMPONENTS.iter().find(of_choice).expect("a component of the choice");
        let c = CS180.with(key, value).unwrap();
        let checked = check(component, component.forward.oracle, &c);
        assert!(!checked.disagreements.is_empty(), "{key} = {value} passes: take it off the list");
    }
}

/// The function that the surrogate of trunc_exp is the derivative of: straight lines outside of [-15, 15].
fn continued(a: &Arrays, _: &Conventions) -> Arrays {
    let one = |x: f64| trunc_exp(x.clamp(-LIMIT, LIMIT)) * (1.0 + x - x.clamp(-LIMIT, LIMIT));
    Arrays::from([("sigmas".to_string(), a["x"].mapv(one))])
}

#[test]
fn vr6_a_surrogate_gradient_fails_the_plain_check_and_passes_its_own() {
    let component = COMPONENTS.iter().find(|c| c.name == "trunc_exp").unwrap();
    let plain = check(component, component.forward.oracle, &CS180);
    let fails = |id: &str| plain.disagreements.iter().any(|line| line.contains(&format!(" {id}:")));
    // Above 15 the derivative's own rounding is past this tolerance: the component's tests look there one by one.
    assert!(fails("below"), "the plain check passes: {:?}", plain.disagreements);
    assert!(!["zero", "usual", "thin"].into_iter().any(fails), "{:?}", plain.disagreements);
    let own = check(component, continued, &CS180);
    assert!(own.disagreements.is_empty(), "{}", own.disagreements.join("\n"));
    assert!(own.decided * 2 >= own.tried, "{} of {} decided", own.decided, own.tried);
}

#[test]
fn the_check_itself_sees_an_error_in_the_eighth_digit() {
    let x = Arrays::from([("x".to_string(), nerf_oracle::contract::arrays::scalar(0.7))]);
    let v = Arrays::from([("x".to_string(), nerf_oracle::contract::arrays::scalar(1.0))]);
    let sine = |x: &Arrays| nerf_oracle::math::sin(x["x"].iter().copied().next().unwrap());
    let difference = directional(sine, &x, &v, 0.125);
    assert!((difference.value / nerf_oracle::math::cos(0.7) - 1.0).abs() < 1e-11 && difference.error < 1e-11);
    assert_eq!(sine(&moved(&x, &v, 0.5)), nerf_oracle::math::sin(1.2));
}
