//! What the page with the 3D view is told, and the same for other programs as PLY.

use std::path::Path;

use glam::DVec3;
use serde_json::{Value, json};

use crate::error::Result;
use crate::files;
use crate::files::npz::{Array, Arrays};
use crate::report::canvas::corners;
use crate::report::inspect::Outside;
use crate::report::{ply, space};
use crate::scene::{Frame, Scene};
use crate::shown::shown;
use crate::training::probe::Cells;

/// Samples that a page shows, of 104 bytes each: 5 MB with all else.
const MOST_SAMPLES: usize = 32_000;
/// Points of a capture that it shows.
const MOST_POINTS: usize = 20_000;
/// Cells along an edge.
const MOST_CELLS: usize = 32;

/// Arrays of `rays.npz` with a row for each ray.
const OF_RAYS: [&str; 15] = [
    "rays_frame",
    "rays_uv",
    "rays_rgb",
    "rays_o",
    "rays_d",
    "rays_hit",
    "t",
    "deltas",
    "sigmas",
    "rgbs",
    "alphas",
    "transmittances",
    "weights",
    "opacities",
    "colors",
];

/// The page.
pub(super) fn html(
    scene: &Scene,
    outside: &Outside,
    arrays: &Arrays,
    doubts: &[Option<String>],
    cells: Option<Cells>,
) -> String {
    let frames: Vec<&Frame> = scene.train.iter().chain(&scene.val).collect();
    let (eye, target, up) = outside.viewpoint();
    let samples = outside.rays[0].1.len();
    let rays = outside.rays.len().min((MOST_SAMPLES / samples).max(1));
    let mut warnings: Vec<String> =
        scene.warnings.iter().map(|warning| shown(warning).into_owned()).collect();
    if rays < outside.rays.len() {
        warnings.push(format!(
            "Only the first {rays} of {} rays are on this page; rays.npz has all.",
            outside.rays.len()
        ));
    }
    let named = |(n, frame): (usize, &&Frame)| json!({"name": shown(&frame.name), "val": n >= scene.train.len(), "doubt": doubts[n]});
    // The last part of a path; the whole one is among the facts.
    let name = shown(&scene.name);
    let title = name.trim_end_matches(['/', '\\']).rsplit(['/', '\\']).next().unwrap_or_default();
    let data = json!({
        "title": title, "warnings": warnings, "facts": facts(scene),
        "frames": frames.iter().enumerate().map(named).collect::<Vec<_>>(),
        "rays": rays, "samples": samples, "near": scene.near, "far": scene.far,
        "focal_distance": 0.5 * (scene.near + scene.far), "extent": 0.5 * (eye - target).length(),
        "view": {"eye": eye.to_array(), "target": target.to_array(), "up": up.to_array()},
        "box": scene.bounds.map(|(low, high)| [low.to_array(), high.to_array()]),
        "cells": cells.map(|cells| of_cells(cells.coarser(MOST_CELLS))),
        "atlas": space::atlas(&frames),
        "arrays": encoded(scene, outside, arrays, rays),
    });
    space::html(&data)
}

fn facts(scene: &Scene) -> Vec<[String; 2]> {
    let (width, height) = scene.size();
    let mut facts = vec![
        ["scene".to_string(), shown(&scene.name).into_owned()],
        [
            "frames".to_string(),
            format!("{} to learn from, {} to measure on", scene.train.len(), scene.val.len()),
        ],
        ["size".into(), format!("{width}x{height}")],
    ];
    let reasons = scene.reasons.iter();
    facts.extend(
        reasons.map(|(field, why)| [field.clone(), shown(why.as_str().unwrap_or_default()).into_owned()]),
    );
    facts
}

fn of_cells(cells: Cells) -> Value {
    let byte = |bits: &[bool]| bits.iter().enumerate().fold(0, |byte, (n, &bit)| byte | u8::from(bit) << n);
    let bits: Vec<u8> = cells.occupied.chunks(8).map(byte).collect();
    json!({
        "low": cells.low.to_array(), "high": cells.high.to_array(), "resolution": cells.resolution, "bits": space::base64(&bits),
    })
}

/// Arrays by name, as f64.
fn encoded(scene: &Scene, outside: &Outside, arrays: &Arrays, rays: usize) -> Value {
    let mut out = serde_json::Map::new();
    let of_rays = OF_RAYS.iter().filter_map(|name| Some((*name, arrays.get(*name)?)));
    for (name, array) in of_rays {
        out.insert(name.into(), numbers(&first(array, rays)));
    }
    for name in ["intrinsics", "sizes"] {
        out.insert(name.into(), numbers(&first(&arrays[name], usize::MAX)));
    }
    let cameras = || outside.cameras.iter().map(|(camera, _)| camera);
    let flat = |points: Vec<DVec3>| points.iter().flat_map(|point| point.to_array()).collect::<Vec<_>>();
    let centers = cameras().map(|camera| camera.c2w.w_axis.truncate()).collect();
    let axes = cameras().map(|camera| camera.c2w.z_axis.truncate()).collect();
    let planes = cameras().flat_map(|camera| corners(camera, outside.depth())).collect();
    for (name, points) in [("centers", centers), ("axes", axes), ("corners", planes)] {
        out.insert(name.into(), numbers(&flat(points)));
    }
    if let Some(cloud) = &scene.cloud {
        let step = cloud.points.len().div_ceil(MOST_POINTS).max(1);
        out.insert("cloud".into(), numbers(&flat(cloud.points.iter().step_by(step).copied().collect())));
    }
    Value::Object(out)
}

/// The first rows of an array.
fn first(array: &Array, rows: usize) -> Vec<f64> {
    let array = array.to_f64();
    let row = array.len() / array.shape()[0].max(1);
    array.iter().copied().take(rows.saturating_mul(row)).collect()
}

fn numbers(values: &[f64]) -> Value {
    let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    space::base64(&bytes).into()
}

/// Frustums as edges with vertices; samples, in the colors of their pixels, and the capture's points.
pub(super) fn write_ply(scene: &Scene, outside: &Outside, [cameras, points]: [&Path; 2]) -> Result<()> {
    let (mut vertices, mut edges) = (vec![], vec![]);
    for (n, (camera, _)) in outside.cameras.iter().enumerate() {
        let color = if n < scene.train.len() { [60, 70, 80] } else { [230, 130, 25] };
        let first = vertices.len() as u32;
        vertices.push((camera.c2w.w_axis.truncate(), color));
        vertices.extend(corners(camera, outside.depth()).map(|corner| (corner, color)));
        edges.extend((0..4).flat_map(|k| [[first, first + 1 + k], [first + 1 + k, first + 1 + (k + 1) % 4]]));
    }
    files::write(cameras, ply::bytes(&vertices, &edges))?;
    let samples = outside.rays.iter().flat_map(|(ray, t)| t.iter().map(|&t| (ray.at(t), [220, 95, 30])));
    let cloud = scene.cloud.iter().flat_map(|cloud| cloud.points.iter().map(|&point| (point, [128; 3])));
    files::write(points, ply::bytes(&samples.chain(cloud).collect::<Vec<_>>(), &[]))
}
