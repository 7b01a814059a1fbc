use glam::DVec3;
use ndarray::{Array1, Array2};
use serde_json::{Value, json};

use super::*;
use crate::convention::{CS180, profiles};
use crate::field::NerfMlp;
use crate::field::nerf_mlp::Shape;
use crate::files::npz::Array;
use crate::random::{Key, Purpose};

/// A mapping of small networks with the names of the oracle's layers.
fn mapping(change: impl FnOnce(&mut Value)) -> Mapping {
    let mut json = json!({
        "schema": mapping::SCHEMA, "networks": {"coarse": ""},
        "layers": {"trunk": "trunk{}", "density": "sigma", "feature": "feature", "color": ["color0"], "rgb": "color1"},
        "depth": 8, "width": 6, "skip": {"layer": 5, "order": "encoding_first"}, "activations": {"trunk": "relu"},
        "levels": {"position": 2, "direction": 1}, "profile": "nerf2020", "samples": {"coarse": 5}, "near": 1, "far": 3,
    });
    change(&mut json);
    Mapping::parse(&json, "mapping.json").unwrap()
}

fn model(mapping: Mapping, arrays: &Arrays, reference: bool) -> ForeignModel {
    let mut model = ForeignModel::new(mapping, reference, "mapping.json").unwrap();
    assert_eq!(model.take(arrays, "weights.npz").unwrap(), Vec::<String>::new());
    model
}

/// The arrays of a network, with PyTorch's names, in either layout.
fn arrays(net: &NerfMlp, out_in: bool) -> Arrays {
    let mut arrays = Arrays::new();
    for (name, layer) in net.layers() {
        let w = if out_in { layer.w.clone() } else { layer.w.t().as_standard_layout().into_owned() };
        arrays.insert(format!("{name}.weight"), w.into());
        arrays.insert(format!("{name}.bias"), layer.b.clone().into());
    }
    arrays
}

/// The same field as the oracle's, in every layout, with the encoding on either side: seen through a ray's weights and color.
#[test]
fn a_network_is_the_oracles() {
    for (order, profile) in [("encoding_first", "nerf2020"), ("hidden_first", "cs180")] {
        let c = profiles::find(profile).unwrap().conventions;
        let layer = c.skip_layer;
        let (position, direction) = (Encoding::new(2, &c), Encoding::new(1, &c));
        let shape = Shape {
            position: position.width(3),
            direction: direction.width(3),
            width: 6,
            depth: 8,
            color: 3,
        };
        let mut net = NerfMlp::initial(&shape, &c, &Key::new(3, Purpose::Parameters));
        net.sigma.b.fill(0.7);
        let ray = Ray { o: DVec3::new(0.1, -0.2, 0.3), d: DVec3::new(0.3, 0.4, 1.0) };
        let unit = (ray.d / ray.d.length()).to_array();
        for out_in in [true, false] {
            let mapping = mapping(|json| {
                (json["skip"]["layer"], json["skip"]["order"]) = (json!(layer), json!(order));
                json["profile"] = json!(profile);
                let layout = if out_in { "out_in" } else { "in_out" };
                json["arrays"] = json!({"weight": "{}.weight", "bias": "{}.bias", "layout": layout});
            });
            let slow = model(mapping, &arrays(&net, out_in), true);
            let t = slow.places(1.0, 3.0, 5);
            let tapes = t.iter().map(|&t| {
                let x = positional_encoding(&ray.at(t).to_array(), &position);
                net.forward(&x, &positional_encoding(&unit, &direction), &c)
            });
            let (sigmas, rgbs): (Vec<f64>, Vec<[f64; 3]>) = tapes.map(|tape| (tape.sigma, tape.rgb)).unzip();
            assert!(sigmas.iter().any(|&sigma| sigma > 0.1), "{sigmas:?}");
            let deltas = slow.steps(&t, ray.d.length(), false);
            let expected = volume_render(&sigmas, &rgbs, &deltas, c.product_eps);
            let found = slow.render(&[ray])[0];
            let color = expected.color.map(|c| c as f32);
            assert!((0..3).all(|k| (found.rgb[k] - color[k]).abs() < 1e-6), "{:?} {color:?}", found.rgb);
            let fast = model(slow.mapping.clone(), &arrays(&net, out_in), false);
            assert!((0..3).all(|k| (fast.render(&[ray])[0].rgb[k] - color[k]).abs() < 1e-5));
        }
    }
}

/// Networks of biases alone: one density and one color everywhere.
fn constant(mapping: &Mapping, prefix: &str, sigma: f64, color: f64) -> Arrays {
    let (position, direction) = mapping.encodings(&CS180);
    let (p, d) = (position.width(3), direction.unwrap().width(3));
    let mut arrays = Arrays::new();
    let mut layer = |name: &str, inputs: usize, bias: &[f64]| {
        let w: Array = Array2::<f64>::zeros((bias.len(), inputs)).into();
        arrays.insert(format!("{prefix}{name}.weight"), w);
        arrays.insert(format!("{prefix}{name}.bias"), Array1::from(bias.to_vec()).into());
    };
    for n in 0..8 {
        layer(&format!("trunk{n}"), if n == 0 { p } else { 6 + if n == 5 { p } else { 0 } }, &[0.0; 6]);
    }
    layer("sigma", 6, &[sigma]);
    layer("feature", 6, &[0.0; 6]);
    layer("color0", 6 + d, &[0.0; 3]);
    layer("color1", 3, &[(color / (1.0 - color)).ln(); 3]);
    arrays
}

/// A fog between 1 and 3: opacity 1 - exp(-sigma length), where the length is the convention's.
#[test]
fn steps_are_those_of_the_convention() {
    let ray = Ray { o: DVec3::ZERO, d: DVec3::new(0.0, 0.75, 1.0) };
    let opacity = |conventions: Value| {
        let mapping = mapping(|json| json["conventions"] = conventions);
        let arrays = constant(&mapping, "", 0.2, 0.25);
        model(mapping, &arrays, true).render(&[ray])[0]
    };
    let fog = |length: f64| (1.0 - (-0.2 * length).exp()) as f32;
    for (conventions, length) in [
        // Four steps of 0.5 along a direction of length 1.25, then one without end.
        (json!({}), 1e10),
        (json!({"last_delta": "to_far"}), 2.5),
        (json!({"last_delta": "repeated"}), 3.125),
        (json!({"delta": "differences", "last_delta": "to_far"}), 2.0),
        (json!({"delta": "width", "grid": "intervals"}), 2.0),
    ] {
        let pixel = opacity(conventions.clone());
        assert!((pixel.opacity - fog(length)).abs() < 1e-6, "{conventions}: {pixel:?}");
        assert!((pixel.rgb[0] - 0.25 * pixel.opacity).abs() < 1e-6);
    }
    // t counts depth, a pixel's depth distance: the mean of 1, 1.5, ..., 3 by their weights.
    let w: Vec<f64> = (0..5)
        .map(|i| (-0.125 * f64::from(i)).exp() * if i < 4 { 1.0 - (-0.125f64).exp() } else { 1.0 })
        .collect();
    let depth: f64 = (0..5).map(|i| w[i] * 1.25 * (1.0 + 0.5 * i as f64)).sum();
    assert!((f64::from(opacity(json!({})).depth) - depth).abs() < 1e-6);
    assert_eq!(
        model(mapping(|_| ()), &constant(&mapping(|_| ()), "", 0.2, 0.25), true).directions(),
        Directions::Depth
    );
}

/// The second network shows its own color, at the first one's samples and where those weigh.
#[test]
fn the_second_network_has_more_samples() {
    let mapping = mapping(|json| {
        json["networks"]["fine"] = json!("fine.");
        json["samples"]["fine"] = json!(4);
        json["conventions"] = json!({"last_delta": "to_far"});
    });
    let mut both = constant(&mapping, "", 0.2, 0.25);
    both.extend(constant(&mapping, "fine.", 0.4, 0.75));
    let model = model(mapping, &both, true);
    let seen = model.render(&[Ray { o: DVec3::ZERO, d: DVec3::Z }])[0];
    assert!(
        (f64::from(seen.opacity) - (1.0 - (-0.8f64).exp())).abs() < 1e-6
            && (seen.rgb[1] - 0.75 * seen.opacity).abs() < 1e-6
    );
    // Midpoints of 1, 1.5, ..., 3 are the edges; all weight is in the second of three bins; u is 0, 1/3, 2/3, 1.
    let t = model.places(1.0, 3.0, 5);
    let finer = model.finer(&t, &[9.0, 0.0, 1.0, 0.0, 9.0]);
    let inner: Vec<f64> = finer.iter().copied().filter(|t| (1.76..2.24).contains(t)).collect();
    assert_eq!(finer.len(), 9);
    assert!(inner.len() == 3 && (inner[0] - (1.75 + 0.5 / 3.0)).abs() < 1e-4, "{finer:?}");
}
