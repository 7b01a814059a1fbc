//! The gradient of a whole training step, by the oracle's own VJPs, against differences.

use nerf_oracle::contract::Draw;
use nerf_oracle::convention::{CS180, Conventions, Density};
use nerf_oracle::encoding::{self, Encoding, positional_encoding};
use nerf_oracle::field::backward as field_backward;
use nerf_oracle::field::nerf_mlp::{NerfMlp, Shape, Tape};
use nerf_oracle::loss;
use nerf_oracle::proof::gradient::richardson;
use nerf_oracle::random::{Key, Purpose};
use nerf_oracle::volume_rendering as render;

/// Relative to the largest gradient.
const TOLERANCE: f64 = 1e-8;

/// A training step: points and directions of R rays, the background and the target colors.
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
        Shape { position: self.x.width(3), direction: self.d.width(3), width, depth, color }
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

    /// The backward pass of that, by the oracle's own VJPs: gradients of the parameters, and of each ray's points and direction.
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

    /// The on/off pattern of all ReLUs.
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

/// A network whose density head isn't dead.
fn network(shape: &Shape, seed: u64) -> NerfMlp {
    let mut net = NerfMlp::initial(shape, &CS180, &Key::new(seed, Purpose::Parameters));
    net.sigma.b.fill(0.5);
    net
}

/// A step of at most `most` on which no ReLU opens or closes: quartered until both of its ends have the pattern of the middle.
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
