//! Every hand-written backward against differences, and the gradient of a whole training step.

use nerf_oracle::COMPONENTS;
use nerf_oracle::convention::{CHOICES, CS180, Conventions, Density};
use nerf_oracle::encoding::{self, Encoding, positional_encoding};
use nerf_oracle::field::backward as field_backward;
use nerf_oracle::field::nerf_mlp::{NerfMlp, Shape, Tape};
use nerf_oracle::loss;
use nerf_oracle::random::{Key, Purpose};
use nerf_oracle::trunc_exp::{LIMIT, trunc_exp};
use nerf_oracle::verify::component::{Arrays, Component, Function};
use nerf_oracle::verify::gradient::{directional, inner, moved, richardson};
use nerf_oracle::verify::{Draw, Kind};
use nerf_oracle::volume_rendering as render;

/// Relative to the largest gradient.
const TOLERANCE: f64 = 1e-8;

/// CS180, and CS180 with each choice of each convention that the component depends on.
fn conventions_of(component: &Component) -> Vec<Conventions> {
    // These two are shapes of the network's parameters: the cases' arrays can't follow.
    let shape = |key: &str| component.name == "nerf_mlp" && ["identity", "skip_layer"].contains(&key);
    let mut all = vec![CS180];
    for (key, values) in CHOICES.iter().filter(|(key, _)| component.conventions.contains(key) && !shape(key))
    {
        let others = values.iter().filter(|value| CS180.get(key) != **value);
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

/// What a check by differences found: directions that it could decide, directions tried, and where it disagrees.
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
            // A kink, a jump, the edge of the domain, or noise: the differences don't know. The next direction does.
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

/// Components whose gradient is stated and not derived: a plain check must fail.
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
fn a_relu_at_its_kink_takes_the_left_derivative() {
    // One-sided: 0 on the left, 1 on the right; at z = 0 it is 0, as in PyTorch.
    assert_eq!(field_backward::relu(&[-1e-300, 0.0, -0.0, 1e-300], &[1.0; 4]), [0.0, 0.0, 0.0, 1.0]);
    assert_eq!(nerf_oracle::field::density_slope(0.0, Density::Relu), 0.0);
}

/// A training step: points and directions of R rays, what is behind and what should have been seen.
#[derive(Clone)]
struct Step {
    c: Conventions,
    x: Encoding,
    d: Encoding,
    rays: Vec<([f64; 3], Vec<[f64; 3]>, Vec<f64>, [f64; 3])>,
}

const BACKGROUND: [f64; 3] = [0.9, 0.5, 0.1];

impl Step {
    fn new(rays: usize, samples: usize, levels: (usize, usize), c: Conventions) -> Self {
        let mut draw = Draw::new("training step", 0);
        let mut three = |low: f64, high: f64| [0; 3].map(|_| low + (high - low) * draw.unit());
        let rays = (0..rays)
            .map(|_| {
                let points = (0..samples).map(|_| three(-1.0, 1.0)).collect();
                let deltas = (0..samples).map(|_| three(0.2, 0.6)[0]).collect();
                (three(-1.0, 1.0), points, deltas, three(0.0, 1.0))
            })
            .collect();
        Step { c, x: Encoding::new(levels.0, &c), d: Encoding::new(levels.1, &c), rays }
    }

    fn shape(&self, width: usize, depth: usize, color: usize) -> Shape {
        Shape { position: self.x.width(3), direction: self.d.width(3), width, depth, color, skip: 4 }
    }

    fn tapes(&self, net: &NerfMlp, ray: usize) -> Vec<Tape> {
        let (direction, points, ..) = &self.rays[ray];
        let d = positional_encoding(direction, &self.d);
        points.iter().map(|p| net.forward(&positional_encoding(p, &self.x), &d, &self.c)).collect()
    }

    /// encode -> nerf_mlp -> volume_render -> composite_background -> mse.
    fn loss(&self, net: &NerfMlp) -> f64 {
        let (mut seen, mut wanted) = (vec![], vec![]);
        for (ray, (_, _, deltas, target)) in self.rays.iter().enumerate() {
            let r = self.render(&self.tapes(net, ray), deltas);
            seen.extend(render::composite_background(r.color, r.opacity, BACKGROUND));
            wanted.extend(target);
        }
        loss::mse(&seen, &wanted)
    }

    fn render(&self, tapes: &[Tape], deltas: &[f64]) -> render::Rendering {
        let (sigmas, rgbs): (Vec<f64>, Vec<_>) = tapes.iter().map(|tape| (tape.sigma, tape.rgb)).unzip();
        render::volume_render(&sigmas, &rgbs, deltas, self.c.product_eps)
    }

    /// The same backwards, by the oracle's own VJPs: gradients of the parameters, and of each ray's points and direction.
    fn gradient(&self, net: &NerfMlp) -> (NerfMlp, Vec<(Vec<f64>, Vec<Vec<f64>>)>) {
        let mut gradient = net.clone();
        gradient.layers_mut().into_iter().for_each(|layer| {
            layer.w.fill(0.0);
            layer.b.fill(0.0);
        });
        let tapes: Vec<_> = (0..self.rays.len()).map(|ray| self.tapes(net, ray)).collect();
        let rendered: Vec<_> = self.rays.iter().zip(&tapes).map(|(ray, t)| self.render(t, &ray.2)).collect();
        let seen: Vec<f64> = rendered
            .iter()
            .flat_map(|r| render::composite_background(r.color, r.opacity, BACKGROUND))
            .collect();
        let wanted: Vec<f64> = self.rays.iter().flat_map(|ray| ray.3).collect();
        let g_seen = loss::backward::mse(&seen, &wanted, 1.0);
        let mut of_rays = vec![];
        for (ray, (direction, points, deltas, _)) in self.rays.iter().enumerate() {
            let g = [g_seen[3 * ray], g_seen[3 * ray + 1], g_seen[3 * ray + 2]];
            let r = &rendered[ray];
            let (color, opacity, _) = render::backward::composite_background(r.opacity, BACKGROUND, g);
            let cotangent = render::backward::Cotangent {
                color,
                weights: vec![0.0; points.len()],
                opacity,
                transmittance: 0.0,
            };
            let (sigmas, rgbs): (Vec<f64>, Vec<_>) =
                tapes[ray].iter().map(|tape| (tape.sigma, tape.rgb)).unzip();
            let (g_sigmas, g_rgbs, _) =
                render::backward::volume_render(&sigmas, &rgbs, deltas, self.c.product_eps, r, &cotangent);
            let (mut g_direction, mut g_points) = (vec![0.0; 3], vec![]);
            for (i, tape) in tapes[ray].iter().enumerate() {
                let (g_x, g_d) =
                    field_backward::nerf_mlp(net, tape, &self.c, g_sigmas[i], g_rgbs[i], &mut gradient);
                g_points.push(encoding::backward::positional_encoding(&points[i], &self.x, &g_x));
                let g_d = encoding::backward::positional_encoding(direction, &self.d, &g_d);
                g_direction.iter_mut().zip(g_d).for_each(|(sum, g)| *sum += g);
            }
            of_rays.push((g_direction, g_points));
        }
        (gradient, of_rays)
    }

    /// Which ReLUs are open, all of them.
    fn pattern(&self, net: &NerfMlp) -> Vec<bool> {
        let open = |tape: Tape| {
            let trunk = tape.z.concat().into_iter();
            trunk.chain(tape.z_color0).chain([tape.z_sigma]).map(|z| z > 0.0).collect::<Vec<_>>()
        };
        (0..self.rays.len()).flat_map(|ray| self.tapes(net, ray)).flat_map(open).collect()
    }
}

/// All parameters in one row.
fn flat(net: &NerfMlp) -> Vec<f64> {
    net.layers().iter().flat_map(|(_, layer)| layer.w.iter().chain(&layer.b).copied()).collect()
}

fn shifted(net: &NerfMlp, v: &[f64], s: f64) -> NerfMlp {
    let mut moved = net.clone();
    let mut v = v.iter();
    for layer in moved.layers_mut() {
        layer.w.iter_mut().chain(&mut layer.b).for_each(|p| *p += s * v.next().unwrap());
    }
    moved
}

/// A network whose density head is alive.
fn network(shape: &Shape, seed: u64) -> NerfMlp {
    let mut net = NerfMlp::initial(shape, &Key::new(seed, Purpose::Parameters));
    net.sigma.b.fill(0.5);
    net
}

/// A step of at most `most` on which no ReLU opens or closes: quartered until both of its ends see the pattern of the middle.
fn smooth_step(pattern: impl Fn(f64) -> Vec<bool>, most: f64) -> f64 {
    let here = pattern(0.0);
    let mut steps = (0..10).map(|n| most * 0.25f64.powi(n));
    steps.find(|&s| pattern(s) == here && pattern(-s) == here).expect("some step without a kink")
}

#[test]
fn a_training_step_parameter_by_parameter() {
    for density in [Density::Relu, Density::Softplus, Density::Exp] {
        let step = Step::new(2, 4, (3, 2), Conventions { density, ..CS180 });
        let net = network(&step.shape(8, 8, 4), 1);
        let gradient = flat(&step.gradient(&net).0);
        let largest = gradient.iter().fold(0.0, |largest: f64, g| largest.max(g.abs()));
        assert!(largest > 1e-3, "a training step that learns something");
        for (n, g) in gradient.iter().enumerate() {
            let mut v = vec![0.0; gradient.len()];
            v[n] = 1.0;
            let h = smooth_step(|s| step.pattern(&shifted(&net, &v, s)), 0.05);
            let difference = richardson(|s| step.loss(&shifted(&net, &v, s)), h);
            assert!(
                (g - difference.value).abs() <= TOLERANCE * largest,
                "{n}: {g}, {difference:?}, {largest}"
            );
        }
    }
}

#[test]
fn a_training_step_back_to_the_rays() {
    let step = Step::new(2, 4, (2, 2), Conventions { density: Density::Softplus, ..CS180 });
    let net = network(&step.shape(8, 8, 4), 1);
    let (_, of_rays) = step.gradient(&net);
    let largest = of_rays.iter().flat_map(|ray| ray.1.concat()).fold(0.0, |l: f64, g| l.max(g.abs()));
    let nudged = |ray: usize, of_point: bool, d: usize, s: f64| {
        let mut rays = step.rays.clone();
        *(if of_point { &mut rays[ray].1[1][d] } else { &mut rays[ray].0[d] }) += s;
        Step { rays, ..step.clone() }
    };
    for (ray, (g_direction, g_points)) in of_rays.iter().enumerate() {
        for (of_point, g) in [(false, g_direction), (true, &g_points[1])] {
            for d in 0..3 {
                let h = smooth_step(|s| nudged(ray, of_point, d, s).pattern(&net), 0.01);
                let difference = richardson(|s| nudged(ray, of_point, d, s).loss(&net), h);
                assert!((g[d] - difference.value).abs() <= TOLERANCE * largest, "{} {difference:?}", g[d]);
            }
        }
    }
}

#[test]
fn a_training_step_at_full_size_along_16_directions() {
    let step = Step::new(2, 2, (10, 4), CS180);
    let net = network(&Shape::PAPER, 3);
    let gradient = flat(&step.gradient(&net).0);
    let norm = gradient.iter().map(|g| g * g).sum::<f64>().sqrt();
    let key = Key::new(16, Purpose::Cases);
    for direction in 0..16 {
        // Along the gradient (as far as 1/2) and across it: a random direction alone meets almost none of it.
        let random = key.uniforms(0, direction, gradient.len());
        let length = (gradient.len() as f64 / 3.0).sqrt();
        let v: Vec<f64> =
            random.iter().zip(&gradient).map(|(u, g)| (2.0 * u - 1.0) / length + 0.5 * g / norm).collect();
        let h = smooth_step(|s| step.pattern(&shifted(&net, &v, s)), 1e-3);
        let by_hand: f64 = gradient.iter().zip(&v).map(|(g, v)| g * v).sum();
        let difference = richardson(|s| step.loss(&shifted(&net, &v, s)), h);
        assert!((by_hand - difference.value).abs() <= TOLERANCE * norm, "{by_hand}, {difference:?}");
    }
}

#[test]
fn the_check_itself_sees_an_error_in_the_eighth_digit() {
    let x = Arrays::from([("x".to_string(), nerf_oracle::verify::component::scalar(0.7))]);
    let v = Arrays::from([("x".to_string(), nerf_oracle::verify::component::scalar(1.0))]);
    let sine = |x: &Arrays| nerf_oracle::maths::sin(x["x"].iter().copied().next().unwrap());
    let difference = directional(sine, &x, &v, 0.125);
    assert!(
        (difference.value / nerf_oracle::maths::cos(0.7) - 1.0).abs() < 1e-11 && difference.error < 1e-11
    );
    assert_eq!(sine(&moved(&x, &v, 0.5)), nerf_oracle::maths::sin(1.2));
}
