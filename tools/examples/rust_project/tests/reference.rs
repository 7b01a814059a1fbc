//! The renderer, held against the reference: `cargo test`.

use nerf_oracle::judge::Verdict;
use nerf_oracle::volume_rendering::judge;
use renderer::{march, march_back, over};

/// The cases' numbers are those of the type under test, so that this loses nothing.
fn short(x: &[f64]) -> Vec<f32> {
    x.iter().map(|&x| x as f32).collect()
}

fn colors(x: &[[f64; 3]]) -> Vec<[f32; 3]> {
    x.iter().map(|x| x.map(|x| x as f32)).collect()
}

#[test]
fn renders_as_the_paper_says() {
    judge::judge(|sigmas, rgbs, deltas| march(&short(sigmas), &colors(rgbs), &short(deltas)))
        .in_f32()
        .assert_pass();
}

#[test]
fn differentiates_as_it_renders() {
    let judged = judge::judge(|sigmas, rgbs, deltas| march(&short(sigmas), &colors(rgbs), &short(deltas)).0)
        .vjp(|sigmas, rgbs, deltas, grad_color, _, _, _| {
            let grad =
                march_back(&short(sigmas), &colors(rgbs), &short(deltas), grad_color.map(|g| g as f32));
            // Densities and steps have no gradient here: neither is judged.
            ((), grad)
        })
        .returns(&["colors"])
        .in_f32();
    judged.assert_pass();
}

#[test]
fn blends_with_a_background() {
    let judged = judge::composite_background(|color, opacity, background| {
        over(color.map(|x| x as f32), opacity as f32, background.map(|x| x as f32))
    });
    judged.in_f32().profile("cs180").assert_pass();
}

/// What a verdict says of a mistake: the sample shades itself.
#[test]
fn a_mistake_is_named() {
    let report = judge::judge(|sigmas, rgbs, deltas| {
        let (mut color, mut through) = ([0f32; 3], 1f32);
        for i in 0..sigmas.len() {
            let x = sigmas[i] as f32 * deltas[i] as f32;
            through *= (-x).exp();
            (0..3).for_each(|a| color[a] -= through * (-x).exp_m1() * rgbs[i][a] as f32);
        }
        color
    });
    let report = report.in_f32().report();
    let row = report.of("volume_render", "forward").expect("it was asked");
    assert_eq!(row.verdict, Verdict::Fail);
    assert_eq!(row.diagnosis[0].mistakes[0].name, "inclusive_transmittance", "{report}");
}
