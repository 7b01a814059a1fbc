//! A step that leaves samples out: the dense step where it leaves out none, the oracle without those samples otherwise.

use super::*;

/// Every bit of a step: loss and gradient.
fn bits(loss: f64, gradient: &Gradient) -> (u64, Vec<u32>) {
    (loss.to_bits(), gradient.values.iter().map(|g| g.to_bits()).collect())
}

/// About two samples in five, and none of the second ray.
fn some(rays: usize, samples: usize) -> Vec<bool> {
    let u = Key::new(4, Purpose::Cases).uniforms(0, 7, rays * samples);
    u.iter().enumerate().map(|(n, &u)| u < 0.4 && n / samples != 1).collect()
}

/// Chunks that don't divide the batch, a ray longer than a chunk, one ray.
#[test]
fn everything_live_is_the_dense_step_bit_for_bit() {
    for (rays, samples) in [(70, 24), (33, 100), (3, 700), (1, 5)] {
        let scene = Scene::new(rays, samples);
        for density in [Density::Relu, Density::Softplus] {
            let c = Conventions { density, ..EARLY };
            let net = Network::new(&network(&SMALL, &c), &SMALL, &c);
            let (mut a, mut b) = (Gradient::default(), Gradient::default());
            let all = vec![true; rays * samples];
            let dense = net.step(&scene.batch(), false, &mut a);
            let skipping = Skipping { live: Some(&all), stop: 0.0 };
            let got = net.step_skipping(&scene.batch(), skipping, &mut b);
            assert!(bits(dense, &a) == bits(got, &b), "{rays} rays of {samples}");
            assert_eq!((a.forward_points, a.backward_points), (b.forward_points, b.backward_points));
            let pictures = [
                net.render(&scene.batch().rays, BACKGROUND),
                net.render_skipping(&scene.batch().rays, skipping, BACKGROUND),
            ];
            assert_eq!(pictures[0], pictures[1]);
        }
    }
}

/// The dense step's chunks: whole rays, 512 points or one ray; live samples are packed as densely.
#[test]
fn chunks_hold_whole_rays() {
    for (rays, samples, each) in [(20, 64, 8), (11, 100, 5), (3, 700, 1)] {
        let scene = Scene::new(rays, samples);
        let spans = Skipping::default().spans(&scene.batch().rays);
        let want: Vec<_> = (0..rays).step_by(each).map(|from| (from, rays.min(from + each))).collect();
        assert_eq!(spans, want);
    }
    let scene = Scene::new(30, 64);
    // Ten, none and all of a ray's samples in turn: 74 in three rays.
    let live: Vec<bool> = (0..30 * 64).map(|n| n % 64 < [10, 0, 64][n / 64 % 3]).collect();
    let skipping = Skipping { live: Some(&live), stop: 0.0 };
    assert_eq!(skipping.spans(&scene.batch().rays), [(0, 20), (20, 30)]);
}

/// Colors, loss and every layer's gradient against f64 with the same samples left out and the same early end.
#[test]
fn what_is_left_agrees_with_the_oracle() {
    let scene = Scene::new(6, 32);
    let live = some(6, 32);
    for (density, stop) in
        [(Density::Relu, 0.0), (Density::Relu, 0.5), (Density::Softplus, 0.25), (Density::Exp, 0.3)]
    {
        let conventions = Conventions { density, ..EARLY };
        let mut net = network(&SMALL, &EARLY);
        // So dense that rays end.
        net.sigma.w *= 8.0;
        net.sigma.b *= 8.0;
        for live in [None, Some(&live[..])] {
            let skipping = Skipping { live, stop };
            let (colors, loss, gradient) = oracle(&net, &conventions, &scene.batch(), skipping);
            let fast = Network::new(&net, &SMALL, &conventions);
            let rendered = fast.render_skipping(&scene.batch().rays, skipping, BACKGROUND);
            for (got, want) in rendered.colors.iter().zip(&colors) {
                assert!((f64::from(*got) - want).abs() < 1e-5, "color {got}, expected {want}");
            }
            let mut got = Gradient::default();
            fast.step_skipping(&scene.batch(), Skipping { live, stop: 0.0 }, &mut got);
            let unended = got.backward_points;
            let got_loss = fast.step_skipping(&scene.batch(), skipping, &mut got);
            assert!((got_loss - loss).abs() < 1e-5, "loss {got_loss}, expected {loss}");
            assert_eq!(got.forward_points, live.map_or(192, |live| live.iter().filter(|&&l| l).count()));
            assert_eq!(got.backward_points < unended, stop > 0.0, "rays end early");
            let got = fast.to_oracle(&got.values);
            for ((name, want), (_, got)) in gradient.layers().into_iter().zip(got.layers()) {
                let difference = difference(got, want);
                assert!(
                    difference < 1e-4,
                    "{density:?} {stop}: gradient of {name}: {difference:e} of its largest entry"
                );
            }
        }
    }
}

/// A ray that ends early changes its color by at most `stop`, and leaves samples out of the backward pass.
#[test]
fn an_early_end_costs_at_most_its_transmittance() {
    let scene = Scene::new(40, 32);
    let mut net = network(&SMALL, &EARLY);
    net.sigma.w *= 30.0;
    net.sigma.b *= 30.0;
    let net = Network::new(&net, &SMALL, &EARLY);
    let whole = net.render(&scene.batch().rays, BACKGROUND);
    let mut seen = 0;
    for stop in [0.01, 0.1, 0.5] {
        let skipping = Skipping { live: None, stop };
        let ended = net.render_skipping(&scene.batch().rays, skipping, BACKGROUND);
        let most = whole.colors.iter().zip(&ended.colors).fold(0.0f32, |m, (a, b)| m.max((a - b).abs()));
        assert!(most <= stop + 1e-6 && most > 0.0, "{most} of {stop}");
        let mut gradient = Gradient::default();
        net.step_skipping(&scene.batch(), skipping, &mut gradient);
        assert!(seen == 0 || gradient.backward_points < seen, "{} of {seen}", gradient.backward_points);
        seen = gradient.backward_points;
    }
}

/// Live samples are packed into chunks by what is live alone: threads change nothing.
#[test]
fn skipping_gives_the_same_bits_on_any_number_of_threads() {
    let (scene, live) = (Scene::new(150, 24), some(150, 24));
    let net = Network::new(&network(&SMALL, &EARLY), &SMALL, &EARLY);
    let run = |threads| {
        with_threads(Some(threads), || {
            let mut gradient = Gradient::default();
            net.step(&Scene::new(400, 40).batch(), true, &mut gradient);
            let loss =
                net.step_skipping(&scene.batch(), Skipping { live: Some(&live), stop: 0.05 }, &mut gradient);
            assert!((1000..1600).contains(&gradient.forward_points), "{}", gradient.forward_points);
            bits(loss, &gradient)
        })
    };
    let one = run(1);
    assert!(one.1.iter().any(|&g| g << 1 != 0));
    for threads in [2, 3, 8, 8] {
        assert!(run(threads) == one, "{threads} threads");
    }
}

/// Nothing live: the background, a loss, no gradient. A NaN in a live sample shows in the result, one in a sample that is left out doesn't.
#[test]
fn nothing_live_and_nan() {
    let scene = Scene::new(4, 16);
    let mut net = Network::new(&network(&SMALL, &EARLY), &SMALL, &EARLY);
    let (nothing, mut gradient) = (vec![false; 64], Gradient::default());
    let skipping = Skipping { live: Some(&nothing), stop: 0.0 };
    assert!(net.step_skipping(&scene.batch(), skipping, &mut gradient) > 0.0);
    assert!(gradient.values.iter().all(|&g| g == 0.0));
    assert_eq!((gradient.forward_points, gradient.backward_points), (0, 0));
    let seen = net.render_skipping(&scene.batch().rays, skipping, BACKGROUND);
    assert_eq!((&seen.colors[..3], seen.opacity[0]), (&BACKGROUND[..], 0.0));
    net.params[5] = f32::NAN;
    let live = some(4, 16);
    for stop in [0.0, 0.1] {
        let skipping = Skipping { live: Some(&live), stop };
        assert!(net.step_skipping(&scene.batch(), skipping, &mut gradient).is_nan());
    }
}
