//! The products are those of training, and their flops those that run.

use super::*;

/// By hand: 32 * 64 + 64 * 16 and 16 * 64 + 64 * 3 weights are 4,288, each with 6 flops. What runs has 13 more columns of 64 in the
/// color layer forward.
#[test]
fn flops_are_those_that_run() {
    assert_eq!(SAMPLE, 6.0 * 4288.0);
    let mut step = Step::new();
    let checked = step.checked(Checked::default());
    assert!(checked.worst > 0.0 && checked.worst <= 1.0, "{}", checked.worst);
    let rows = step.filled[0].chunk.rows() as f64;
    assert_eq!(checked.flops, rows * (SAMPLE + 2.0 * 13.0 * 64.0));
    let live: usize = step.filled.iter().map(|f| f.chunk.points.len()).sum();
    let work = step.work();
    assert_eq!((work.points, work.products), (live, live as f64 * SAMPLE));
    assert!(live > 12 * CHUNK, "{live}");
    let more = work.pass / work.products;
    assert!((1.0..1.5).contains(&more), "{more}");
    // No subnormal numbers, with which arithmetic is slow.
    for Filled { chunk, encoding, .. } in &step.filled {
        let rows = ..chunk.points.len();
        let of = |levels: &[Aligned<Entry>; LEVELS]| {
            levels.iter().flat_map(|level| level[rows].as_flattened().to_vec()).collect::<Vec<_>>()
        };
        let (forward, backward) = (of(encoding), of(&chunk.encoding));
        let colors = chunk.rgb[rows].as_flattened();
        let buffers = [&forward[..], chunk.hidden0[rows].as_flattened(), colors, &backward[..]];
        assert!(!buffers.into_iter().flatten().any(|x| x.is_subnormal()));
        assert!(!chunk.gradient.parts().into_iter().flatten().any(|x| x.is_subnormal()));
        assert!(colors.iter().any(|&x| x != 0.0) && backward.iter().any(|&x| x != 0.0));
    }
}

/// Activations and the colors' gradient come out with the training's bits, as often as they run.
#[test]
fn they_are_the_trainings_own() {
    let mut step = Step::new();
    let chunk = &step.filled[1].chunk;
    let before = (chunk.hidden0.clone(), chunk.geometry.clone(), chunk.hidden1.clone());
    let color = chunk.gradient.color1.clone();
    assert!(color.iter().any(|row| row[2] != 0.0));
    for _ in 0..2 {
        step.products();
    }
    let chunk = &step.filled[1].chunk;
    let rows = chunk.points.len();
    assert!(chunk.hidden0[..rows] == before.0[..rows] && chunk.geometry[..rows] == before.1[..rows]);
    assert!(chunk.hidden1[..rows] == before.2[..rows] && chunk.gradient.color1 == color);
    // A pass after the products gives the same result.
    step.pass();
    assert!(step.filled[1].chunk.gradient.color1 == color);
}

#[test]
fn a_wrong_product_is_found() {
    let mut step = Step::new();
    for wrong in [1e-3, f32::NAN] {
        let worst = step.checked(Checked { wrong, ..Checked::default() }).worst;
        assert!(worst > 1.0 || worst.is_nan(), "{wrong}: {worst}");
    }
}
