//! The table: what is put where, and part of the message that refuses it.

use std::fmt;

use nerf_oracle::files::npz::{self, Array, Arrays};
use serde_json::Value;

use super::bad_captures as captures;
use super::ground::{Ground, words};

/// One bad input.
pub(crate) enum Row {
    /// A JSON file in which a place (a JSON pointer) holds something else; nothing, where the text is empty.
    Json { file: &'static str, place: &'static str, put: &'static str, says: &'static str },
    /// An npz in which an array is another.
    Array { file: &'static str, array: &'static str, put: &'static str, says: &'static str },
    /// A file of other bytes.
    Bytes { file: &'static str, put: &'static str, says: &'static str },
    /// A line of arguments.
    Line { line: &'static str, says: &'static str },
}

/// The command that reads a file.
fn reader(file: &str) -> &'static str {
    match file {
        "scene/transforms.json" => "inspect scene --rays 1 --samples 1 --out out",
        "scene/a.png" => "inspect scene --rays 1 --samples 1 --out out",
        "keys.json" => "render run --path keys.json:1 --size 2x2 --out out.gif",
        file if file.starts_with("colmap/") => "inspect colmap --rays 1 --samples 1 --out out",
        file if file.starts_with("text/") => "inspect text --rays 1 --samples 1 --out out",
        file if file.starts_with("llff/") => "inspect llff --rays 1 --samples 1 --out out",
        "cs180.npz" => "inspect cs180.npz --rays 1 --samples 1 --out out",
        "tiny.npz" => "inspect tiny.npz --rays 1 --samples 1 --out out",
        "run/run.json" | "run/checkpoint.npz" => "render run --path orbit:1 --size 2x2 --out out.gif",
        "compact/run.json" | "compact/checkpoint.npz" => {
            "render compact --path orbit:1 --size 2x2 --out out.gif"
        }
        "photo.png" => "fit-image photo.png --steps 1 --width 2 --layers 1 --batch 2 --size 4 --out out",
        "photo.jpg" => "fit-image photo.jpg --steps 1 --width 2 --layers 1 --batch 2 --size 4 --out out",
        "photo.gif" => "fit-image photo.gif --steps 1 --width 2 --layers 1 --batch 2 --size 4 --out out",
        other => panic!("nothing reads {other}"),
    }
}

impl Row {
    /// Changes the files; the arguments that the program gets.
    pub(crate) fn prepare(&self, ground: &Ground) -> Vec<String> {
        match *self {
            Row::Json { file, place, put, .. } => {
                let mut json = ground.json(file);
                set(&mut json, place, put);
                ground.write(file, json.to_string());
                words(reader(file))
            }
            Row::Array { file, array, put, .. } => {
                let path = ground.touch(file);
                let mut arrays = npz::read(&path).expect("a good archive");
                change(&mut arrays, array, put);
                npz::write(&path, &arrays, false).expect("written");
                words(reader(file))
            }
            Row::Bytes { file, put, .. } => {
                super::draw::bytes(ground, file, put);
                words(reader(file))
            }
            Row::Line { line, .. } => words(line),
        }
    }

    /// What the message must have in it.
    pub(crate) fn words(&self) -> Vec<&'static str> {
        match *self {
            Row::Json { file, says, .. } | Row::Array { file, says, .. } | Row::Bytes { file, says, .. } => {
                vec![file.rsplit('/').next().expect("a name"), says]
            }
            Row::Line { says, .. } => vec![says],
        }
    }
}

impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match *self {
            Row::Json { file, place, put, .. } => write!(f, "{file}: {place} = {put}"),
            Row::Array { file, array, put, .. } => write!(f, "{file}: {array}: {put}"),
            Row::Bytes { file, put, .. } => write!(f, "{file}: {put}"),
            Row::Line { line, .. } => write!(f, "{line}"),
        }
    }
}

/// Puts a text's value at a JSON pointer, or takes away what is there.
fn set(json: &mut Value, place: &str, put: &str) {
    let (parent, name) = place.rsplit_once('/').expect("a place");
    let parent = json.pointer_mut(parent).unwrap_or_else(|| panic!("no {parent}"));
    match (parent, put) {
        (Value::Object(object), "") => drop(object.shift_remove(name).expect("a field")),
        (Value::Object(object), put) => drop(object.insert(name.into(), text(put))),
        (Value::Array(list), put) => list[name.parse::<usize>().expect("an index")] = text(put),
        (other, _) => panic!("{place}: {other}"),
    }
}

/// Ready for `set`: `# 70` is a list in 70 lists.
fn text(put: &str) -> Value {
    match put.strip_prefix("# ") {
        Some(n) => (0..n.parse().expect("a number")).fold(Value::Null, |inner, _| Value::Array(vec![inner])),
        None => serde_json::from_str(put).unwrap_or_else(|error| panic!("{put}: {error}")),
    }
}

/// Changes one array: its first element, its shape, its type; takes it away, or adds it.
fn change(arrays: &mut Arrays, name: &str, put: &str) {
    if put == "new" {
        arrays.insert(name.into(), ndarray::arr1(&[1.0]).into());
        return;
    }
    let array = arrays.remove(name).unwrap_or_else(|| panic!("no {name}"));
    let f64s = array.to_f64();
    let shape = f64s.shape().to_vec();
    let first = |x: f64| {
        let mut other = f64s.clone();
        *other.iter_mut().next().expect("an element") = x;
        match &array {
            Array::F32(_) => other.mapv(|x| x as f32).into(),
            Array::I64(_) => other.mapv(|x| x as i64).into(),
            _ => Array::from(other),
        }
    };
    let other: Array = match put {
        "gone" => return,
        "nan" => first(f64::NAN),
        "inf" => first(f64::INFINITY),
        "short" => ndarray::Array1::<f32>::zeros(f64s.len() - 1).into(),
        "empty" => ndarray::Array1::<f32>::zeros(0).into(),
        "flat" => ndarray::Array1::from_iter(f64s.iter().copied()).into(),
        "none" => {
            let mut shape = shape;
            shape[0] = 0;
            ndarray::ArrayD::<f64>::zeros(shape).into()
        }
        "longer" => {
            let mut shape = shape;
            shape[0] += 1;
            ndarray::ArrayD::<f64>::zeros(shape).into()
        }
        "integers" => f64s.mapv(|x| x as i64).into(),
        "floats" => f64s.into(),
        number => first(number.parse().unwrap_or_else(|_| panic!("{number}?"))),
    };
    arrays.insert(name.into(), other);
}

/// All rows.
pub(crate) fn all() -> Vec<Row> {
    let scene =
        SCENE.iter().map(|&(place, put, says)| Row::Json { file: "scene/transforms.json", place, put, says });
    let run = SETTINGS.iter().map(|&(place, put, says)| Row::Json { file: "run/run.json", place, put, says });
    let arrays = ARRAYS.iter().map(|&(file, array, put, says)| Row::Array { file, array, put, says });
    let compact =
        COMPACT.iter().map(|&(place, put, says)| Row::Json { file: "compact/run.json", place, put, says });
    let bytes = BYTES.iter().map(|&(file, put, says)| Row::Bytes { file, put, says });
    let captures = captures::CAPTURES.iter().map(|&(file, put, says)| Row::Bytes { file, put, says });
    let keys =
        captures::KEYS.iter().map(|&(place, put, says)| Row::Json { file: "keys.json", place, put, says });
    let lines = LINES.iter().map(|&(line, says)| Row::Line { line, says });
    let rows = scene.chain(run).chain(compact).chain(arrays).chain(bytes).chain(lines);
    rows.chain(captures).chain(keys).collect()
}

/// `transforms.json`: a place, what is put there, part of the message.
#[rustfmt::skip]
const SCENE: &[(&str, &str, &str)] = &[
    ("/fl_x", "\"8\"", "fl_x: found \"8\"; expected a positive number"), ("/fl_x", "0", "fl_x: found 0"), ("/fl_x", "-8", "fl_x: found -8"),
    ("/fl_x", "0.5", "lens of b.png: found no inverse"), ("/fl_x", "1e300", "fl_x: found 1e+300"), ("/fl_x", "null", "fl_x: found null"), ("/fl_x", "[8]", "fl_x: found [8]"),
    ("/fl_x", "true", "fl_x: found true"), ("/fl_x", "{}", "fl_x: found {}"), ("/fl_y", "\"7\"", "fl_y"), ("/fl_y", "0.0", "fl_y"),
    ("/fl_y", "false", "fl_y"), ("/cx", "\"2.5\"", "cx: found \"2.5\"; expected a number from"), ("/cx", "1e9", "cx"),
    ("/cx", "null", "cx"), ("/cy", "\"\"", "cy"), ("/cy", "-1e300", "cy"), ("/cy", "[]", "cy"), ("/w", "\"6\"", "w: found \"6\"; expected a whole number from 1"),
    ("/w", "5", "expected 5x4"), ("/w", "6.5", "w: found 6.5"), ("/w", "0", "w: found 0"), ("/w", "-6", "w: found -6"), ("/w", "1e30", "w: found 1e+30"),
    ("/w", "99999999999", "w"), ("/h", "true", "h: found true"), ("/h", "0.0", "h"), ("/h", "5", "expected 6x5"), ("/h", "null", "h"),
    ("/camera_angle_x", "\"0.7\"", "camera_angle_x: found \"0.7\""), ("/camera_angle_x", "0", "camera_angle_x"),
    ("/camera_angle_x", "-0.7", "camera_angle_x"), ("/camera_angle_x", "3.2", "camera_angle_x"), ("/camera_angle_y", "\"x\"", "camera_angle_y"),
    ("/camera_angle_y", "40", "camera_angle_y"), ("/camera_angle_y", "[0.6]", "camera_angle_y"),
    ("/k1", "\"0.1\"", "k1: found \"0.1\"; expected a number"), ("/k1", "true", "k1"), ("/k1", "null", "k1"), ("/k1", "[0.1]", "k1"), ("/k1", "1e10", "k1"),
    ("/k2", "\"0\"", "k2"), ("/k2", "{}", "k2"), ("/p1", "\"0\"", "p1"), ("/p2", "[]", "p2"), ("/k3", "\"0.2\"", "k3"), ("/k3", "-1e5", "lens of "),
    ("/k4", "[0.0]", "k4"), ("/k4", "-1e-9", "k4 of a.png"), ("/k5", "\"0\"", "k5"), ("/k5", "-1e6", "lens of "), ("/k6", "false", "k6"), ("/k6", "-1e6", "lens of "),
    ("/camera_model", "7", "camera_model: found 7; expected text"), ("/camera_model", "\"\"", "camera_model"), ("/camera_model", "\"OPENCV_FISHEYE\"", "with a fisheye"),
    ("/camera_model", "[\"OPENCV\"]", "camera_model"), ("/camera_model", "null", "camera_model"), ("/is_fisheye", "\"true\"", "is_fisheye: found \"true\"; expected true or false"),
    ("/is_fisheye", "1", "is_fisheye"), ("/is_fisheye", "true", "p1 of a.png"), ("/is_fisheye", "null", "is_fisheye"), ("/is_equirectangular", "\"no\"", "is_equirectangular"),
    ("/is_equirectangular", "true", "is_equirectangular of a.png"), ("/is_latlong", "0", "is_latlong"), ("/is_latlong", "true", "is_latlong of a.png"),
    ("/latlong", "true", "latlong of a.png"), ("/equirectangular", "true", "equirectangular of a.png"), ("/equirectangular", "\"\"", "equirectangular"),
    ("/ftheta_p0", "\"1\"", "ftheta_p0"), ("/ftheta_p0", "1.0", "ftheta_p0 of a.png"), ("/ftheta_p1", "2", "ftheta_p1 of a.png"), ("/ftheta_p4", "[1]", "ftheta_p4"),
    ("/rolling_shutter", "[0, 1, 0]", "rolling_shutter of a.png"), ("/rolling_shutter", "[0, \"1\", 0]", "rolling_shutter"), ("/rolling_shutter", "0.5", "rolling_shutter"),
    ("/rolling_shutter", "[0]", "rolling_shutter"), ("/aabb_scale", "\"4\"", "aabb_scale"), ("/aabb_scale", "0", "aabb_scale"), ("/aabb_scale", "-4", "aabb_scale"),
    ("/aabb_scale", "[4]", "aabb_scale"), ("/aabb_scale", "null", "aabb_scale"), ("/scale", "\"0.33\"", "scale"), ("/scale", "0", "scale"), ("/scale", "true", "scale"),
    ("/offset", "\"0.5\"", "offset"), ("/offset", "[0.5, 0.5]", "offset"), ("/offset", "[0.5, 0.5, \"0.5\"]", "offset"), ("/offset", "null", "offset"),
    ("/up", "[0, 1]", "up"), ("/up", "\"z\"", "up"), ("/up", "[0, 0, null]", "up"), ("/applied_transform", "[[1, 0], [0, 1]]", "applied_transform"),
    ("/applied_transform", "\"eye\"", "applied_transform"), ("/applied_scale", "\"1\"", "applied_scale"), ("/applied_scale", "0", "applied_scale"),
    ("/ply_file_path", "7", "ply_file_path"), ("/ply_file_path", "[]", "ply_file_path"), ("/orientation_override", "true", "orientation_override"),
    ("/enable_depth_loading", "\"false\"", "enable_depth_loading"), ("/integer_depth_scale", "\"0.001\"", "integer_depth_scale"), ("/from_na", "\"yes\"", "from_na"),
    ("/white_transparent", "1", "white_transparent"), ("/fix_premult", "\"\"", "fix_premult"), ("/aabb", "[0, 1]", "aabb"), ("/render_aabb", "{}", "render_aabb"),
    ("/train_filenames", "\"a.png\"", "train_filenames"), ("/val_filenames", "[1]", "val_filenames"), ("/n_frames", "-1", "n_frames"), ("/x_fov", "200", "x_fov"),
    ("/frames", "", "frames: found none"), ("/frames", "null", "frames: found none"), ("/frames", "[]", "frames: found none"), ("/frames", "{}", "frames"), ("/frames", "\"a\"", "frames"),
    ("/frames", "[1, 2]", "frames[0].file_path"), ("/frames", "[null]", "frames[0].file_path"), ("/frames", "[[]]", "frames[0].file_path"), ("/frames/1", "{}", "frames[1].file_path"),
    ("/frames/0/file_path", "7", "file_path: found 7; expected a path"), ("/frames/0/file_path", "null", "file_path"), ("/frames/0/file_path", "\"\"", "file_path"),
    ("/frames/0/file_path", "[\"a.png\"]", "file_path"), ("/frames/0/file_path", "", "file_path"), ("/frames/0/transform_matrix", "", "transform_matrix of a.png: found no matrix"),
    ("/frames/0/transform_matrix", "null", "transform_matrix"), ("/frames/0/transform_matrix", "7", "transform_matrix"), ("/frames/0/transform_matrix", "[]", "transform_matrix"),
    ("/frames/0/transform_matrix", "[[]]", "transform_matrix of a.png: found shape [1, 0]"), ("/frames/0/transform_matrix", "[1, 2, 3, 4]", "transform_matrix"),
    ("/frames/0/transform_matrix/0", "[1, 2, 3]", "transform_matrix"), ("/frames/0/transform_matrix/0/0", "\"0\"", "NaN in row 0, column 0"),
    ("/frames/0/transform_matrix/1/3", "1e300", "in row 1, column 3"), ("/frames/0/transform_matrix/2/2", "null", "in row 2, column 2"),
    ("/frames/0/transform_matrix/0/0", "5", "expected a rotation"), ("/frames/0/transform_matrix/3", "[0, 0, 1, 1]", "last row"),
    ("/frames/0/transform_matrix/0/2", "-1.0", "reflection"), ("/frames/0/transform_matrix", "# 60", "transform_matrix"), ("/frames/0/k1", "\"0.1\"", "k1 of a.png: found \"0.1\""),
    ("/frames/0/k1", "null", "k1 of a.png"), ("/frames/1/fl_x", "\"8\"", "fl_x of b.png"), ("/frames/1/fl_x", "0", "fl_x of b.png"), ("/frames/1/w", "7", "expected 7x4"),
    ("/frames/1/h", "\"4\"", "h of b.png"), ("/frames/1/cx", "{}", "cx of b.png"), ("/frames/1/camera_angle_x", "-1", "camera_angle_x of b.png"),
    ("/frames/1/is_fisheye", "true", "p1 of b.png"), ("/frames/1/is_fisheye", "\"1\"", "is_fisheye of b.png"), ("/frames/1/camera_model", "\"FISHEYE\"", "camera_model of b.png"),
    ("/frames/1/sharpness", "\"30\"", "sharpness of b.png"), ("/frames/1/rotation", "\"0.01\"", "rotation of b.png"), ("/frames/1/rotation", "null", "rotation of b.png"),
    ("/frames/1/colmap_im_id", "-1", "colmap_im_id of b.png"), ("/frames/1/colmap_im_id", "\"7\"", "colmap_im_id of b.png"), ("/frames/1/depth_file_path", "7", "depth_file_path of b.png"),
    ("/frames/1/mask_path", "false", "mask_path of b.png"), ("/frames/1/time", "\"now\"", "time of b.png"), ("/frames/1/k4", "0.1", "k4 of b.png"),
];

/// `run.json`.
#[rustfmt::skip]
const SETTINGS: &[(&str, &str, &str)] = &[
    ("/scene", "", "scene: found no such field"), ("/scene", "7", "scene: found 7"), ("/scene", "null", "scene"), ("/scene", "\"\"", "scene"),
    ("/scene", "[\"builtin:blob\"]", "scene"), ("/scene_options", "", "scene_options"), ("/scene_options", "null", "scene_options"), ("/scene_options", "[]", "scene_options"),
    ("/scene_options/near", "\"1\"", "scene_options.near: found \"1\""), ("/scene_options/near", "-1", "scene_options.near"), ("/scene_options/near", "1e300", "scene_options.near"),
    ("/scene_options/near", "[1]", "scene_options.near"), ("/scene_options/near", "1.5", "derived.near"), ("/scene_options/far", "true", "scene_options.far"),
    ("/scene_options/far", "7.5", "derived.far"), ("/scene_options/holdout", "1", "scene_options.holdout"), ("/scene_options/holdout", "\"2\"", "scene_options.holdout"),
    ("/scene_options/holdout", "2.5", "scene_options.holdout"), ("/scene_options/background", "\"white\"", "scene_options.background"),
    ("/scene_options/background", "[1, 1]", "scene_options.background"), ("/scene_options/background", "[1, 1, 2]", "scene_options.background"),
    ("/scene_options/background", "[1, \"x\", 1]", "scene_options.background"), ("/scene_options/background", "[1, 1, 1]", "derived.background"),
    ("/scene_options/shrink", "0", "scene_options.shrink"), ("/scene_options/shrink", "65", "scene_options.shrink"), ("/scene_options/shrink", "\"2\"", "scene_options.shrink"),
    ("/scene_options/shrink", "2", "derived."), ("/model", "", "model"), ("/model", "\"Nerf\"", "model: found \"Nerf\"; expected compact or nerf"), ("/model", "7", "model"),
    ("/model", "null", "model"), ("/backend", "\"slow\"", "backend"), ("/backend", "0", "backend"), ("/backend", "", "backend"), ("/seed", "-1", "seed"), ("/seed", "\"0\"", "seed"),
    ("/seed", "0.5", "seed"), ("/seed", "null", "seed"), ("/seed", "", "seed"), ("/seed", "1e300", "seed"), ("/rays", "\"8\"", "rays"), ("/rays", "0", "rays"), ("/rays", "-8", "rays"),
    ("/rays", "9999999999999", "rays"), ("/rays", "8.5", "rays"), ("/rays", "8.0", "rays: found 8.0"), ("/seed", "1.0", "seed: found 1.0"), ("/rays", "[8]", "rays"), ("/rays", "16", "settings.rays"), ("/rays", "null", "settings.rays"), ("/samples", "0", "samples"),
    ("/samples", "\"4\"", "samples"), ("/samples", "1e9", "samples"), ("/samples", "true", "samples"), ("/samples", "5", "settings.samples"), ("/samples", "", "settings.samples"),
    ("/fine", "-1", "fine"), ("/fine", "\"0\"", "fine"), ("/fine", "99999", "fine"), ("/fine", "4", "settings.fine"), ("/lr", "0", "lr"), ("/lr", "-1", "lr"), ("/lr", "\"1e-3\"", "lr"),
    ("/lr", "[]", "lr"), ("/lr", "0.25", "settings.lr"), ("/width", "0", "width"), ("/width", "\"8\"", "width"), ("/width", "4097", "width"), ("/width", "9", "settings.width"),
    ("/width", "null", "settings.width"), ("/skip", "1", "skip"), ("/skip", "\"true\"", "skip"), ("/skip", "true", "settings.skip"), ("/steps", "0", "steps"), ("/steps", "\"2\"", "steps"),
    ("/without", "\"stop\"", "without"), ("/without", "[1]", "without"), ("/without", "[\"stops\"]", "without"), ("/without", "{}", "without"), ("/without", "[\"stop\"]", "--without"), ("/scene_options/near", "9", "found near 9, far 6"), ("/scene", "\"gone\"", "that names it"), ("/scene", "\"builtin:blob,size=0\"", "size=0"),
    ("/version", "7", "version"), ("/version", "", "version"), ("/derived", "[]", "derived"), ("/derived", "", "derived"), ("/derived/near", "2.5", "derived.near"),
    ("/derived/near", "\"2\"", "derived.near"), ("/derived/width", "9", "derived.width"), ("/derived/train_frames", "3", "derived.train_frames"),
    ("/derived/focus", "[0, 0]", "derived.focus"), ("/settings", "7", "settings"), ("/settings/near", "null", "settings.near"), ("/settings/depth", "9", "settings.depth"),
    ("/settings/samples", "\"4\"", "settings.samples"), ("/settings/other", "1", "settings.other"), ("/reasons", "\"\"", "reasons"), ("/end", "null", "end"),
    ("/end/steps", "-1", "end.steps"), ("/end/seconds", "\"1\"", "end.seconds"), ("/end/seconds", "-1", "end.seconds"), ("/end/stop_at_psnr", "\"20\"", "end.stop_at_psnr"),
    ("/threads", "\"2\"", "threads"), ("/threads", "0", "threads"), ("/warnings", "\"none\"", "warnings"), ("/warnings", "[1]", "warnings"), ("/failure", "7", "failure"),
];

/// `run.json` of a compact run.
#[rustfmt::skip]
const COMPACT: &[(&str, &str, &str)] = &[
    ("/model", "\"nerf\"", "settings."), ("/fine", "8", "--fine"), ("/width", "8", "--width"), ("/skip", "true", "--skip"), ("/lr", "1", "settings.lr"), ("/rays", "1048576", "settings."), ("/samples", "16384", "settings.samples"),
    ("/without", "[\"stop\"]", "settings."), ("/settings/box_size", "1", "settings.box_size"), ("/settings/resolutions", "[16]", "settings.resolutions"), ("/settings/table", "\"1\"", "settings.table"), ("/settings/view_dependent", "0", "settings.view_dependent"), ("/settings/lr", "null", "settings.lr"),
];

/// Archives: the file, an array, what becomes of it, part of the message.
#[rustfmt::skip]
const ARRAYS: &[(&str, &str, &str, &str)] = &[
    ("cs180.npz", "images_train", "gone", "arrays"), ("cs180.npz", "images_train", "nan", "images_train"), ("cs180.npz", "images_train", "2", "images_train"),
    ("cs180.npz", "images_train", "-0.5", "images_train"), ("cs180.npz", "images_train", "integers", "images_train"), ("cs180.npz", "images_train", "flat", "images_train"),
    ("cs180.npz", "images_train", "none", "c2ws_train"), ("cs180.npz", "images_train", "empty", "images_train"), ("cs180.npz", "images_train", "longer", "c2ws_train"),
    ("cs180.npz", "images_val", "gone", "images_val"), ("cs180.npz", "images_val", "inf", "images_val"), ("cs180.npz", "images_val", "flat", "images_val"),
    ("cs180.npz", "c2ws_train", "gone", "c2ws_train"), ("cs180.npz", "c2ws_train", "nan", "c2ws_train[0]"), ("cs180.npz", "c2ws_train", "inf", "c2ws_train[0]"),
    ("cs180.npz", "c2ws_train", "7", "expected a rotation"), ("cs180.npz", "c2ws_train", "flat", "c2ws_train"), ("cs180.npz", "c2ws_train", "longer", "c2ws_train"),
    ("cs180.npz", "c2ws_train", "none", "c2ws_train"), ("cs180.npz", "c2ws_val", "gone", "c2ws_val"), ("cs180.npz", "c2ws_val", "nan", "c2ws_val"), ("cs180.npz", "c2ws_test", "nan", "c2ws_test[0]"),
    ("cs180.npz", "c2ws_test", "flat", "c2ws_test"), ("cs180.npz", "focal", "gone", "focal"), ("cs180.npz", "focal", "nan", "focal"), ("cs180.npz", "focal", "inf", "focal"),
    ("cs180.npz", "focal", "0", "focal"), ("cs180.npz", "focal", "-8", "focal"), ("cs180.npz", "focal", "1e30", "focal"), ("cs180.npz", "focal", "empty", "focal"),
    ("tiny.npz", "images", "gone", "arrays"), ("tiny.npz", "images", "nan", "images"), ("tiny.npz", "images", "1.5", "images"), ("tiny.npz", "images", "integers", "images"),
    ("tiny.npz", "images", "short", "images"), ("tiny.npz", "images", "none", "poses"), ("tiny.npz", "poses", "gone", "arrays"), ("tiny.npz", "poses", "nan", "poses[0]"), ("tiny.npz", "poses", "longer", "poses"),
    ("tiny.npz", "poses", "short", "poses"), ("tiny.npz", "focal", "gone", "focal"), ("tiny.npz", "focal", "-1", "focal"),
    ("run/checkpoint.npz", "version", "gone", "version"), ("run/checkpoint.npz", "version", "2", "version"), ("run/checkpoint.npz", "version", "nan", "version"),
    ("run/checkpoint.npz", "step", "gone", "step"), ("run/checkpoint.npz", "step", "empty", "step"), ("run/checkpoint.npz", "step", "1000000000000", "step"), ("run/checkpoint.npz", "step", "-1", "step"), ("run/checkpoint.npz", "step", "3", "adam_step"),
    ("run/checkpoint.npz", "seconds", "gone", "seconds"), ("run/checkpoint.npz", "seconds", "nan", "seconds"), ("run/checkpoint.npz", "seconds", "inf", "seconds"), ("run/checkpoint.npz", "seconds", "-1", "seconds"),
    ("run/checkpoint.npz", "samples", "gone", "samples"), ("run/checkpoint.npz", "samples", "-1", "samples"), ("run/checkpoint.npz", "adam_step", "gone", "adam_step"),
    ("run/checkpoint.npz", "adam_step", "-1", "adam_step"), ("run/checkpoint.npz", "adam_step", "1", "adam_step"),
    ("run/checkpoint.npz", "trunk0_w", "gone", "trunk0_w"), ("run/checkpoint.npz", "trunk0_w", "nan", "trunk0_w: found NaN; expected finite"), ("run/checkpoint.npz", "trunk0_w", "inf", "trunk0_w"),
    ("run/checkpoint.npz", "trunk0_w", "short", "trunk0_w"), ("run/checkpoint.npz", "trunk0_w", "empty", "trunk0_w"), ("run/checkpoint.npz", "trunk0_w", "flat", "trunk0_w"),
    ("run/checkpoint.npz", "trunk0_w", "integers", "trunk0_w"), ("run/checkpoint.npz", "trunk0_b", "nan", "trunk0_b"), ("run/checkpoint.npz", "m.trunk0_w", "nan", "m.trunk0_w"),
    ("run/checkpoint.npz", "m.trunk0_w", "gone", "m.trunk0_w"), ("run/checkpoint.npz", "v.trunk0_w", "-1", "v.trunk0_w: found -1; expected finite numbers, 0 or more"),
    ("run/checkpoint.npz", "v.trunk0_w", "inf", "v.trunk0_w"), ("run/checkpoint.npz", "other", "new", "other: found an array that this model doesn't have"), ("run/checkpoint.npz", "fine.trunk0_w", "new", "fine.trunk0_w"),
    ("compact/checkpoint.npz", "level0_param", "nan", "level0_param: found NaN"), ("compact/checkpoint.npz", "level0_param", "short", "level0_param"), ("compact/checkpoint.npz", "level0_param", "floats", "level0_param"), ("compact/checkpoint.npz", "level7_v", "-1", "level7_v: found -1"), ("compact/checkpoint.npz", "level3_m", "gone", "level3_m"),
    ("compact/checkpoint.npz", "occupancy_density", "inf", "occupancy_density"), ("compact/checkpoint.npz", "occupancy_density", "empty", "occupancy_density"), ("compact/checkpoint.npz", "occupancy_density", "longer", "occupancy_density"), ("compact/checkpoint.npz", "occupancy_found", "short", "occupancy_found"), ("compact/checkpoint.npz", "occupancy_found", "nan", "occupancy_found"),
    ("compact/checkpoint.npz", "occupancy_bits", "longer", "occupancy_bits"), ("compact/checkpoint.npz", "occupancy_bits", "gone", "occupancy_bits"), ("compact/checkpoint.npz", "occupancy_opaque", "none", "occupancy_opaque"), ("compact/checkpoint.npz", "occupancy_bits", "floats", "occupancy_bits"),
    ("compact/checkpoint.npz", "compact_progress", "-5", "compact_progress"), ("compact/checkpoint.npz", "compact_progress", "1000000000000", "compact_progress"), ("compact/checkpoint.npz", "compact_progress", "empty", "compact_progress"), ("compact/checkpoint.npz", "compact_progress", "longer", "compact_progress"), ("compact/checkpoint.npz", "step", "1000000000000", "step"), ("compact/checkpoint.npz", "step", "1", "compact_progress"),
    ("compact/checkpoint.npz", "level8_param", "new", "level8_param"), ("compact/checkpoint.npz", "trunk0_w", "new", "trunk0_w"),
];

/// Files of other bytes: see `draw::bytes`.
#[rustfmt::skip]
const BYTES: &[(&str, &str, &str)] = &[
    ("photo.png", "cut 0", "picture"), ("photo.png", "cut 1", "picture"), ("photo.png", "cut 30", "picture"), ("photo.png", "cut 50", "cut off"), ("photo.png", "cut 90", "cut off"), ("photo.png", "cut -1", "cut off"),
    ("photo.png", "cut -12", "cut off"), ("photo.jpg", "cut 1", "picture"), ("photo.jpg", "cut 30", "picture"), ("photo.jpg", "cut 60", "picture"), ("photo.jpg", "cut 90", "cut off"), ("photo.jpg", "cut -1", "cut off"),
    ("photo.jpg", "cut -2", "cut off"), ("photo.gif", "cut 20", "picture"), ("photo.gif", "cut 90", "cut off"), ("photo.gif", "cut -1", "cut off"), ("photo.png", "huge png", "pixels"), ("photo.png", "folder", "a folder"), ("photo.png", "fifo", "a pipe or a device"),
    ("photo.png", "device", "a pipe or a device"), ("photo.png", "gone", "can't be read"), ("photo.png", "text", "picture"), ("photo.jpg", "zeros", "picture"), ("photo.png", "wrong checksum", "picture"),
    ("scene/a.png", "cut 50", "cut off"), ("scene/a.png", "huge png", "pixels"), ("scene/a.png", "text", "picture"), ("scene/a.png", "zeros", "picture"), ("scene/a.png", "other size", "6x4"),
    ("scene/transforms.json", "cut 0", "JSON"), ("scene/transforms.json", "cut 50", "JSON"), ("scene/transforms.json", "cut -1", "JSON"), ("scene/transforms.json", "text", "JSON"), ("scene/transforms.json", "zeros", "JSON"),
    ("scene/transforms.json", "twice", "is there twice"), ("scene/transforms.json", "deep", "recursion limit"), ("scene/transforms.json", "list", "one object"), ("scene/transforms.json", "nan", "JSON"), ("scene/transforms.json", "not utf-8", "transforms.json"),
    ("cs180.npz", "cut 0", "archive"), ("cs180.npz", "cut 50", "archive"), ("cs180.npz", "cut -1", "archive"), ("cs180.npz", "text", "archive"), ("cs180.npz", "fifo", "a pipe or a device"), ("cs180.npz", "device", "a pipe or a device"), ("cs180.npz", "folder", "a folder"), ("cs180.npz", "gone", "cs180.npz"),
    ("cs180.npz", "pickled", "Python objects"), ("cs180.npz", "long shape", "images_train"), ("cs180.npz", "short data", "bytes"), ("cs180.npz", "bomb", "packed bytes"), ("cs180.npz", "integer bomb", "in memory"), ("cs180.npz", "text array", "element type"), ("cs180.npz", "no header", "images_train"), ("cs180.npz", "nested header", "nested"), ("cs180.npz", "few nested brackets", "nested"),
    ("run/run.json", "cut 0", "JSON"), ("run/run.json", "cut 50", "JSON"), ("run/run.json", "text", "JSON"), ("run/run.json", "gone", "run.json"), ("run/run.json", "folder", "run.json"), ("run/run.json", "fifo", "run.json"), ("run/run.json", "list", "JSON"), ("run/run.json", "twice", "is there twice"), ("run/run.json", "deep", "recursion limit"),
    ("run/checkpoint.npz", "cut 0", "archive"), ("run/checkpoint.npz", "cut 50", "archive"), ("run/checkpoint.npz", "cut -1", "archive"), ("run/checkpoint.npz", "text", "archive"), ("run/checkpoint.npz", "gone", "checkpoint.npz"), ("run/checkpoint.npz", "fifo", "a pipe or a device"),
];

/// Lines of arguments.
#[rustfmt::skip]
const LINES: &[(&str, &str)] = &[
    ("train builtin:blob --out o --near NaN", "--near"), ("train builtin:blob --out o --near inf", "--near"), ("train builtin:blob --out o --near=-1", "--near"), ("train builtin:blob --out o --near 1e10", "--near"), ("train builtin:blob --out o --near x", "--near"),
    ("train builtin:blob --out o --far inf", "--far"), ("train builtin:blob --out o --far NaN", "--far"), ("train builtin:blob --out o --far=-inf", "--far"), ("train builtin:blob --out o --far 1,5", "--far"), ("train builtin:blob --out o --near 5 --far 2", "--near: found 5"), ("train builtin:blob --out o --near 2 --far 2", "--near: found 2"),
    ("train builtin:blob --out o --background 0.5,x,1,0", "three numbers"), ("train builtin:blob --out o --background 1,1", "three numbers"), ("train builtin:blob --out o --background nan,0,0", "three numbers"), ("train builtin:blob --out o --background 0,0,1.01", "three numbers"), ("train builtin:blob --out o --background 0,0,-0.1", "three numbers"), ("train builtin:blob --out o --background red", "black, white"),
    ("train builtin:blob --out o --seconds=-1", "--seconds"), ("train builtin:blob --out o --seconds 0", "--seconds"), ("train builtin:blob --out o --seconds NaN", "--seconds"), ("train builtin:blob --out o --seconds inf", "--seconds"), ("train builtin:blob --out o --seconds 1e999", "--seconds"),
    ("train builtin:blob --out o --steps 0", "--steps"), ("train builtin:blob --out o --steps=-1", "--steps"), ("train builtin:blob --out o --steps 1.5", "--steps"), ("train builtin:blob --out o --steps 1e3", "--steps"), ("train builtin:blob --out o --steps 99999999999999999999", "--steps"),
    ("train builtin:blob --out o --stop-at-psnr NaN", "--stop-at-psnr"), ("train builtin:blob --out o --stop-at-psnr inf", "--stop-at-psnr"), ("train builtin:blob --out o --rays 0", "--rays"), ("train builtin:blob --out o --rays 1048577", "--rays"), ("train builtin:blob --out o --rays x", "--rays"), ("train builtin:blob --out o --samples 0", "--samples"), ("train builtin:blob --out o --samples 16385", "--samples"),
    ("train builtin:blob --out o --model nerf --fine 16385", "--fine"), ("train builtin:blob --out o --model nerf --fine=-1", "--fine"), ("train builtin:blob --out o --lr 0", "--lr"), ("train builtin:blob --out o --lr NaN", "--lr"), ("train builtin:blob --out o --lr inf", "--lr"), ("train builtin:blob --out o --lr=-1e-3", "--lr"),
    ("train builtin:blob --out o --holdout 0", "--holdout"), ("train builtin:blob --out o --holdout 1", "--holdout"), ("train builtin:blob --out o --scale 2", "--scale"), ("train builtin:blob --out o --scale 1/0", "--scale"), ("train builtin:blob --out o --scale 1/65", "--scale"), ("train builtin:blob --out o --scale 1/64.5", "--scale"), ("train builtin:blob,size=8,views=1 --out o --scale 1/9", "--scale"),
    ("train builtin:blob --out o --val-every 0", "--val-every"), ("train builtin:blob --out o --val-at 0", "--val-at"), ("train builtin:blob --out o --val-at 1,x", "--val-at"), ("train builtin:blob --out o --seed=-1", "--seed"), ("train builtin:blob --out o --seed 1.5", "--seed"), ("train builtin:blob --out o --seed 18446744073709551616", "--seed"),
    ("train builtin:blob --out o --threads 0", "--threads"), ("train builtin:blob --out o --threads 1025", "--threads"), ("train builtin:blob --out o --threads 65536", "--threads"), ("train builtin:blob --out o --model nerf --width 0", "--width"), ("train builtin:blob --out o --model nerf --width 4097", "--width"), ("train builtin:blob --out o --width 8", "--width"),
    ("train builtin:blob --out o --model other", "--model"), ("train builtin:blob --out o --backend other", "--backend"), ("train builtin:blob --out o --without other", "--without"), ("train builtin:blob --out o --model nerf --without stop", "--without"), ("train builtin:blob --out o --skip", "--skip"), ("train builtin:blob --out o --model nerf --skip --fine 8", "--skip"), ("train builtin:blob --out o --fine 8", "--fine"), ("train builtin:blob --out o --backend reference", "--backend"),
    ("train builtin:blob --out o --steps 1 --steps 2", "--steps"), ("train builtin:blob --out o --no-such-option", "--no-such-option"), ("train builtin:blob", "--out"), ("train --out o", "SCENE"),
    ("train builtin:blob --out o --model nerf --rays 1048576 --samples 16384", "memory: found about"), ("train builtin:blob --out o --rays 1048576 --samples 16384", "Lower --rays or --samples"), ("train builtin:nothing --out o", "builtin:nothing"), ("train builtin: --out o", "builtin:"),
    ("train builtin:blob,size=0 --out o", "size=0"), ("train builtin:blob,size=5000 --out o", "size=4 to 4096"), ("train builtin:blob,views=0 --out o", "views=0"), ("train builtin:blob,fill=NaN --out o", "fill=NaN"), ("train builtin:blob,fill=0 --out o", "fill=0"), ("train builtin:blob,other=1 --out o", "other=1"), ("train builtin:blob,size --out o", "size"), ("train builtin:blob,size=4096,views=1000 --out o", "Choose a smaller size, or fewer views"),
    ("train no_such_folder --out o", "no_such_folder"), ("train no_such.npz --out o", "no_such.npz"), ("train photo.png --out o", "photo.png"), ("train photo.jpg --out o", "a file of another kind"), ("train run --out o", "a folder without transforms.json"), ("train scene --out photo.png", "photo.png"), ("train scene --out photo.png/run", "photo.png"),
    ("evaluate no_run", "run.json"), ("evaluate photo.png", "run.json"), ("evaluate scene", "Train first"), ("evaluate run --split other", "--split"), ("evaluate run --split test --threads 0", "--threads"), ("evaluate run --backend gpu", "--backend"),
    ("render run --out o.gif --size 0x0", "--size"), ("render run --out o.gif --size 4", "--size"), ("render run --out o.gif --size 4x", "--size"), ("render run --out o.gif --size 4x-4", "--size"), ("render run --out o.gif --size 16385x4", "--size"), ("render run --out o.gif --size 4x4x4", "--size"), ("render run --out o.gif --size 1e2x4", "--size"), ("render run --out o.gif --size 16384x16384 --path orbit:10000", "Lower --size"),
    ("render run --out o.gif --path orbit:0", "--path"), ("render run --out o.gif --path orbit:", "--path"), ("render run --out o.gif --path orbit:-1", "--path"), ("render run --out o.gif --path orbit:10001", "--path"), ("render run --out o.gif --path circle", "orbit:N"), ("render run --out o.gif --background 0.5,x,1,0", "--background"), ("render run --out o.gif --threads 9999", "--threads"), ("render run", "--out"), ("render no_run --out o.gif", "no_run"),
    ("inspect scene --out o --near NaN", "--near"), ("inspect scene --out o --far inf", "--far"), ("inspect scene --out o --near 3 --far 1", "--near: found 3"), ("inspect scene --out o --rays 0", "--rays"), ("inspect scene --out o --samples 0", "--samples"), ("inspect scene --out o --rays 9999999", "--rays"), ("inspect scene --out o --rays 1048576 --samples 16384", "Lower --rays or --samples"), ("inspect scene --out o --holdout 0", "--holdout"), ("inspect scene --out o --holdout 1", "--holdout"), ("inspect scene --out o --seed x", "--seed"), ("inspect scene/a.png --out o", "a.png"),
    ("fit-image photo.png --out o --size 0", "--size"), ("fit-image photo.png --out o --size 16385", "--size"), ("fit-image photo.png --out o --steps 0", "--steps"), ("fit-image photo.png --out o --steps 9999999999", "--steps"), ("fit-image photo.png --out o --batch 0", "--batch"), ("fit-image photo.png --out o --batch 99999999", "--batch"), ("fit-image photo.png --out o --levels 33", "--levels"), ("fit-image photo.png --out o --levels=-1", "--levels"),
    ("fit-image photo.png --out o --width 0", "--width"), ("fit-image photo.png --out o --width 4097", "--width"), ("fit-image photo.png --out o --layers 0", "--layers"), ("fit-image photo.png --out o --layers 65", "--layers"), ("fit-image photo.png --out o --lr 0", "--lr"), ("fit-image photo.png --out o --lr NaN", "--lr"), ("fit-image photo.png --out o --threads 0", "--threads"), ("fit-image photo.png --out o --seed x", "--seed"), ("fit-image no.png --out o", "no.png"), ("fit-image scene --out o", "a folder"),
    ("fit-image builtin:card --out o --size 16384 --steps 1000000000", "memory: found about"), ("fit-image photo.png --out o --steps 1000000000 --width 4096 --layers 64", "Lower --size"),
    ("sweep-image photo.png --out o --levels 4,x", "--levels"), ("sweep-image photo.png --out o --levels 33", "--levels"), ("sweep-image photo.png --out o --width 0", "--width"), ("sweep-image photo.png --out o --width 64,,64", "--width"), ("sweep-image photo.png --out o --lr 0", "--lr"), ("sweep-image photo.png --out o --lr 1e-2,inf", "--lr"), ("sweep-image photo.png --out o --steps 0", "--steps"), ("sweep-image photo.png --out o --batch 0", "--batch"), ("sweep-image photo.png --out o --layers 65", "--layers"), ("sweep-image photo.png --out o --size 0", "--size"), ("sweep-image photo.png --out o --threads 0", "--threads"),
    ("demo --out o --seconds 0", "--seconds"), ("demo --out o --seconds NaN", "--seconds"), ("demo --out o --seconds=-5", "--seconds"), ("bench none --out o", "none"), ("bench dense --out o --rounds 4", "--rounds"), ("bench dense --out o --rounds 1001", "--rounds"), ("bench dense --out o --rounds x", "--rounds"), ("bench dense --out o --threads 0", "--threads"), ("bench nerf_step --out o", "--run"), ("bench nerf_step --out o --run no_run", "no_run"),
    ("matrix --steps 0", "--steps"), ("matrix --megapixels NaN", "--megapixels"), ("matrix --megapixels 0", "--megapixels"), ("matrix --megapixels=-1", "--megapixels"), ("matrix --runs 0", "--runs"), ("matrix --threads 0", "--threads"), ("cases none --out o", "none"), ("cases loss --out o --dtype f8", "--dtype"), ("cases loss --out o --profile none", "none"), ("cases loss --out photo.png", "photo.png"), ("cases loss --out o --layout zip", "--layout"),
    ("vectors", "--out"), ("vectors none --out o", "none"), ("vectors loss --out o --profile none", "none"), ("vectors loss --out o --layout zip", "--layout"),
    ("vectors loss --out photo.png", "photo.png"), ("vectors loss --out scene", "expected an empty folder"), ("vectors --verify scene", "SHA256SUMS"),
    ("vectors --verify scene --out o", "--verify"), ("vectors --verify photo.png", "photo.png"), ("judge no_cases scene", "no_cases"), ("judge scene scene", "cases.json"), ("judge scene scene --exp-ulp NaN", "--exp-ulp"), ("judge scene scene --exp-ulp 0", "--exp-ulp"), ("judge scene scene --allow fail", "--allow"),
    ("train builtin:blob --out o --serve 65536", "--serve"), ("train builtin:blob --out o --serve x", "--serve"), ("train builtin:blob --out o --serve 0 --host example.org", "--host"), ("view no_run", "run.json"), ("view run --port=-1", "--port"), ("view run --host x", "--host"), ("completions klingon", "klingon"), ("man nothing", "nothing"),
    ("explain nothing", "nothing"), ("explain", "NAME"), ("check none", "none"), ("paint", "paint"), ("list none", "none"), ("", "Usage"),
];
