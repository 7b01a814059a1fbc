//! Cases and answers as files: what is written, and what is refused.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use nerf_oracle::contract::Dtype;
use nerf_oracle::convention::CS180;
use nerf_oracle::files::layout::Layout;
use nerf_oracle::files::npz::{self, Array};
use nerf_oracle::judge::exchange::{declared, read_answers, read_exam, write_cases};
use nerf_oracle::judge::judging::{EXP_ULP, judge_answers};
use nerf_oracle::judge::large::files as large;
use nerf_oracle::judge::{Exam, LargeExam};
use tempfile::TempDir;

/// Cases of the background's component, and right answers to them.
fn folders() -> (TempDir, PathBuf, PathBuf) {
    folders_of("composite_background")
}

/// Cases of a component, and right answers to them.
fn folders_of(component: &str) -> (TempDir, PathBuf, PathBuf) {
    folders_in(Layout::Npz, component)
}

/// The same in a layout.
fn folders_in(layout: Layout, component: &str) -> (TempDir, PathBuf, PathBuf) {
    let root = tempfile::tempdir().unwrap();
    let (cases, answers) = (root.path().join("cases"), root.path().join("answers"));
    let exam = Exam::new(component, Dtype::F32, None).unwrap();
    write_cases(&exam, &cases, layout).unwrap();
    for question in &exam.questions {
        for case in &question.cases {
            let outputs = (question.component.direction(question.kind).unwrap().oracle)(&case.inputs, &CS180);
            let narrow =
                outputs.into_iter().map(|(name, a)| (name, Array::F32(a.mapv(|x| x as f32)))).collect();
            layout.write(&answers, &question.path(case), &narrow).unwrap();
        }
    }
    (root, cases, answers)
}

/// The message with which a pair of folders is refused.
fn refused(cases: &Path, answers: &Path) -> String {
    let result = read_exam(cases).and_then(|exam| read_answers(&exam, answers));
    result.err().unwrap_or_else(|| panic!("not refused")).to_string()
}

/// An answer's file.
fn first(answers: &Path) -> PathBuf {
    answers.join("composite_background/forward-three_opacities.npz")
}

/// A zip with one stored entry.
fn zip_of(path: &Path, name: &str, bytes: &[u8], compress: bool) {
    let mut zip = zip::ZipWriter::new(fs::File::create(path).unwrap());
    let method = if compress { zip::CompressionMethod::Deflated } else { zip::CompressionMethod::Stored };
    zip.start_file(name, zip::write::SimpleFileOptions::default().compression_method(method)).unwrap();
    zip.write_all(bytes).unwrap();
    zip.finish().unwrap();
}

#[test]
fn right_answers_come_back_and_pass() {
    let (_root, cases, answers) = folders();
    let exam = read_exam(&cases).unwrap();
    let report = judge_answers(&exam, &read_answers(&exam, &answers).unwrap(), EXP_ULP);
    assert_eq!(report.exit_code(), 0, "{report}");
    let json = report.json();
    for field in [
        "name",
        "kind",
        "cases",
        "answered",
        "verdict",
        "grade",
        "budget_used",
        "vacuous",
        "missing_outputs",
        "worst_case",
        "conventions",
        "diagnosis",
    ] {
        assert!(json["components"][0].get(field).is_some(), "{field}");
    }
    for field in ["id", "output", "index", "got", "expected", "bound", "ulp"] {
        assert!(json["components"][0]["worst_case"].get(field).is_some(), "{field}");
    }
}

/// A NaN among the inputs is the NaN that was written.
#[test]
fn inputs_that_are_no_number_are_read_as_they_were_written() {
    let (_root, cases, answers) = folders_of("unscale_gradients");
    let exam = read_exam(&cases).unwrap();
    let report = judge_answers(&exam, &read_answers(&exam, &answers).unwrap(), EXP_ULP);
    assert_eq!(report.exit_code(), 0, "{report}");
}

/// In every pair of layouts.
#[test]
fn cases_and_answers_lie_in_either_layout() {
    for component in ["composite_background", "adam_step", "occupancy_grid"] {
        let (_npz, cases, answers) = folders_in(Layout::Npz, component);
        let (_raw, raw_cases, raw_answers) = folders_in(Layout::Raw, component);
        for cases in [&cases, &raw_cases] {
            let exam = read_exam(cases).unwrap();
            let given = read_answers(&exam, &answers).unwrap();
            assert!(!given.concat().contains(&None));
            assert_eq!(read_answers(&exam, &raw_answers).unwrap(), given, "{component}");
        }
    }
}

#[test]
fn hostile_folders_of_numbers_are_refused_by_name() {
    let (_root, cases, answers) = folders_in(Layout::Raw, "composite_background");
    let place = answers.join("composite_background/forward-three_opacities");
    let index = place.join("index.txt");
    let whole = fs::read_to_string(&index).unwrap();
    assert_eq!(whole, "colors_out f32 2 3 3 colors_out.bin\n");
    let expect = |change: &dyn Fn(), word: &str| {
        change();
        let message = refused(&cases, &answers);
        assert!(message.contains("three_opacities") && message.contains(word), "{message}");
        fs::write(&index, &whole).unwrap();
    };
    expect(&|| fs::remove_file(&index).unwrap(), "index.txt");
    expect(&|| fs::write(&index, whole.replace("2 3 3", "2 3 4")).unwrap(), "expected a file of 48 bytes");
    expect(&|| fs::write(&index, "colors_out f32 2 3 3 ../../answers.bin\n").unwrap(), "line 1");
    expect(&|| fs::write(&index, "../colors_out f32 2 3 3 colors_out.bin\n").unwrap(), "inside the folder");
    let large = place.join("large.bin");
    let with_large = whole.clone() + "large u8 1 1048576 large.bin\n";
    expect(
        &|| {
            fs::write(&large, vec![0; 1 << 20]).unwrap();
            fs::write(&index, &with_large).unwrap();
        },
        "unpacks to",
    );
    expect(&|| (), "only files that it lists");
    fs::remove_file(&large).unwrap();
    // Where both are there, nobody knows which is meant.
    let twice = place.with_extension("npz");
    expect(&|| fs::write(&twice, b"").unwrap(), "an npz and a folder");
    fs::remove_file(&twice).unwrap();
    let stray = answers.join("composite_background/forward-another");
    fs::create_dir(&stray).unwrap();
    assert!(refused(&cases, &answers).contains("forward-another"));
    fs::remove_dir(&stray).unwrap();
    // And an input that was changed.
    let input = cases.join("composite_background/forward-three_opacities/opacity.bin");
    let bytes = fs::read(&input).unwrap();
    fs::write(&input, vec![0; bytes.len()]).unwrap();
    assert!(refused(&cases, &answers).contains("array opacity"));
}

#[test]
fn an_absent_answer_fails() {
    let (_root, cases, answers) = folders();
    fs::remove_file(first(&answers)).unwrap();
    let exam = read_exam(&cases).unwrap();
    let report = judge_answers(&exam, &read_answers(&exam, &answers).unwrap(), EXP_ULP);
    assert_eq!(report.exit_code(), 1);
    assert!(report.rows[0].faults[0].contains("three_opacities"));
}

#[test]
fn hostile_answers_are_refused_by_name() {
    let (_root, cases, answers) = folders();
    let path = first(&answers);
    let whole = fs::read(&path).unwrap();
    let expect = |change: &dyn Fn(), word: &str| {
        change();
        let message = refused(&cases, &answers);
        assert!(message.contains("three_opacities") && message.contains(word), "{message}");
        fs::write(&path, &whole).unwrap();
    };
    expect(&|| fs::write(&path, &whole[..whole.len() / 2]).unwrap(), "archive");
    expect(&|| fs::write(&path, b"not a zip").unwrap(), "archive");
    expect(&|| fs::write(&path, vec![0; 1 << 20]).unwrap(), "bytes");
    // 64 MB of zeros in a few kB.
    expect(&|| zip_of(&path, "colors_out.npy", &vec![0; 64 << 20], true), "unpacks");
    expect(&|| zip_of(&path, "../../climbs.npy", b"x", false), "inside the folder");
    expect(&|| zip_of(&path, "/etc/absolute.npy", b"x", false), "inside the folder");
    let header = b"{'descr': '|O', 'fortran_order': False, 'shape': (3, 3), }";
    let mut object = b"\x93NUMPY\x01\x00".to_vec();
    object.extend((header.len() as u16).to_le_bytes());
    object.extend(header);
    object.extend([0; 72]);
    expect(&|| zip_of(&path, "colors_out.npy", &object, false), "colors_out");
    // The same 64 MB under a directory that says they are 128 bytes: the data are counted, not the declared size.
    let mut long = b"\x93NUMPY\x01\x00".to_vec();
    let header = b"{'descr': '<f4', 'fortran_order': False, 'shape': (3, 3), }";
    long.extend((header.len() as u16).to_le_bytes());
    long.extend(header);
    long.resize(64 << 20, 0);
    expect(
        &|| {
            zip_of(&path, "colors_out.npy", &long, true);
            understate(&path, 128);
        },
        "colors_out",
    );
}

/// Writes another unpacked size into an archive of one entry, in both places.
fn understate(path: &Path, size: u32) {
    let mut bytes = fs::read(path).unwrap();
    for (signature, at) in [(b"PK\x03\x04", 22), (b"PK\x01\x02", 24)] {
        let start = bytes.windows(4).position(|window| window == signature).unwrap() + at;
        bytes[start..start + 4].copy_from_slice(&size.to_le_bytes());
    }
    fs::write(path, bytes).unwrap();
}

#[test]
fn what_no_case_asks_for_is_refused() {
    let (root, cases, answers) = folders();
    let stray = [answers.join("notes.txt"), answers.join("composite_background/forward-another.npz")];
    for path in stray {
        fs::write(&path, b"").unwrap();
        assert!(refused(&cases, &answers).contains(path.file_name().unwrap().to_str().unwrap()));
        fs::remove_file(&path).unwrap();
    }
    #[cfg(unix)]
    {
        let outside = root.path().join("outside.npz");
        fs::rename(first(&answers), &outside).unwrap();
        std::os::unix::fs::symlink(&outside, first(&answers)).unwrap();
        assert!(refused(&cases, &answers).contains("a link"));
    }
    drop(root);
}

#[test]
fn changed_cases_are_refused() {
    let (_root, cases, answers) = folders();
    let manifest = cases.join("cases.json");
    let text = fs::read_to_string(&manifest).unwrap();
    let mut json: serde_json::Value = serde_json::from_str(&text).unwrap();
    json["cases"].as_array_mut().unwrap().remove(0);
    fs::write(&manifest, json.to_string()).unwrap();
    assert!(refused(&cases, &answers).contains("cases.json"));
    fs::write(
        &manifest,
        text.replacen("\"composite_background/forward-three", "\"../composite_background/", 1),
    )
    .unwrap();
    assert!(refused(&cases, &answers).contains("inside the folder"));
    fs::write(&manifest, &text).unwrap();
    let input = cases.join("composite_background/forward-three_opacities.npz");
    let mut arrays = npz::read(&input).unwrap();
    arrays.insert("opacity".into(), Array::F32(ndarray::arr1(&[0.0, 0.0, 0.0]).into_dyn()));
    npz::write(&input, &arrays, false).unwrap();
    assert!(refused(&cases, &answers).contains("opacity"));
}

/// The report on a folder with an `answers.json` of these rows.
fn judged(cases: &Path, answers: &Path, rows: &str) -> Result<nerf_oracle::judge::Report, String> {
    let text = format!(r#"{{"schema": "nerf-oracle/answers/1", "rows": {{{rows}}}}}"#);
    fs::write(answers.join("answers.json"), text).unwrap();
    let exam =
        read_exam(cases).and_then(|exam| declared(exam, answers)).map_err(|error| error.to_string())?;
    let given = read_answers(&exam, answers).map_err(|error| error.to_string())?;
    Ok(judge_answers(&exam, &given, EXP_ULP))
}

#[test]
fn what_a_candidate_doesnt_take_is_left_out_and_told() {
    let (_root, cases, answers) = folders_of("image_rays");
    let off_center = answers.join("image_rays/forward-inexact_lens.npz");
    fs::remove_file(&off_center).unwrap();
    let without = r#""image_rays/forward": {"takes": ["height", "width", "focal", "c2w"]}"#;
    let report = judged(&cases, &answers, without).unwrap();
    let row = report.of("image_rays", "forward").unwrap();
    assert_eq!(report.exit_code(), 0, "{report}");
    assert_eq!(row.left_out["inexact_lens"], "cx, cy");
    assert!(!row.left_out.contains_key("moved_and_turned"), "the center of 5 x 3 pixels is (2.5, 1.5)");
    assert!(report.to_string().contains("cases left out, as they need cx, cy"), "{report}");
    // With K nothing is assumed, and whatever isn't answered fails.
    let with_matrix = r#""image_rays/forward": {"takes": ["height", "width", "K", "c2w"]}"#;
    let report = judged(&cases, &answers, with_matrix).unwrap();
    assert_eq!(report.exit_code(), 1, "{report}");
    assert!(report.rows[0].left_out.is_empty());
}

#[test]
fn a_crash_is_its_cases_result() {
    let (_root, cases, answers) = folders_of("volume_render");
    for kind in ["forward", "vjp"] {
        fs::remove_file(answers.join(format!("volume_render/{kind}-VR9_no_samples.npz"))).unwrap();
    }
    let crashed = |case: &str| {
        format!(r#""volume_render/forward": {{"crashed": {{"{case}": "index 0 out of range"}}}}"#)
    };
    let report = judged(&cases, &answers, &crashed("VR9_no_samples")).unwrap();
    let row = report.of("volume_render", "forward").unwrap();
    assert_eq!(row.faults, ["VR9_no_samples: crashed: index 0 out of range"]);
    assert_eq!(row.edge_cases, ["no samples"]);
    // Another case without an answer is no edge case.
    fs::remove_file(answers.join("volume_render/forward-slab.npz")).unwrap();
    let report = judged(&cases, &answers, &crashed("VR9_no_samples")).unwrap();
    let row = report.of("volume_render", "forward").unwrap();
    assert_eq!((row.faults.len(), row.edge_cases.len()), (2, 0), "{report}");
}

#[test]
fn declarations_are_checked() {
    let (_root, cases, answers) = folders();
    let refused = |rows: &str, word: &str| {
        let message = judged(&cases, &answers, rows).expect_err("not refused");
        assert!(message.contains("answers.json") && message.contains(word), "{message}");
    };
    refused(r#""composite/forward": {}"#, "composite/forward: no row");
    refused(r#""composite_background/forward": {"takes": ["sigmas"]}"#, "sigmas: no input");
    refused(r#""composite_background/vjp": {"returns": ["weights"]}"#, "weights: no output");
    refused(r#""composite_background/forward": {"crashed": {"nowhere": "x"}}"#, "nowhere: no case");
    refused(r#""composite_background/forward": {"passes": true}"#, "unknown field");
}

/// Large cases of a row, with their inputs, and right answers to them.
fn large_folders() -> (TempDir, PathBuf, PathBuf) {
    let root = tempfile::tempdir().unwrap();
    let (cases, answers) = (root.path().join("cases"), root.path().join("answers"));
    let exam = LargeExam::new("importance_sampling", Dtype::F32, None).unwrap();
    large::write(&exam, &cases, true).unwrap();
    for (question, laid) in exam.exam.questions.iter().zip(&exam.laid) {
        for laid in laid {
            let case = laid.whole();
            let outputs = (question.component.direction(question.kind).unwrap().oracle)(&case.inputs, &CS180);
            let narrow = outputs.into_iter().map(|(name, a)| (name, Array::F32(a.mapv(|x| x as f32))));
            npz::write(&answers.join(question.path(&case) + ".npz"), &narrow.collect(), false).unwrap();
        }
    }
    (root, cases, answers)
}

#[test]
fn large_cases_come_back_with_recipes_and_are_judged() {
    let (_root, cases, answers) = large_folders();
    let manifest: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(cases.join("cases.json")).unwrap()).unwrap();
    assert_eq!(manifest["tier"], "large");
    let input = &manifest["cases"][0]["inputs"][0];
    assert!(input["recipe"]["law"].is_string() && input["key"][1] == 7, "{input}");
    let judged = |answers: &Path| large::judged(large::read(&cases).unwrap(), answers, EXP_ULP);
    let report = judged(&answers).unwrap();
    assert_eq!((report.exit_code(), report.rows.len()), (0, 2), "{report}");
    // Half of the answers to the forward direction: the others are zeros.
    let path = answers.join("importance_sampling/forward-bins_1024.npz");
    let mut half = npz::read(&path).unwrap();
    let Some(Array::F32(t)) = half.get_mut("t") else { panic!("t in f32") };
    t.slice_axis_mut(ndarray::Axis(0), ndarray::Slice::from(200..)).fill(0.0);
    npz::write(&path, &half, false).unwrap();
    let report = judged(&answers).unwrap();
    let row = report.of("importance_sampling", "forward").unwrap();
    assert!(row.observed[0].contains("number 200 of 257"), "{report}");
    assert!(row.worst_case.as_ref().unwrap().index[0] >= 200);
    // Something that no case asks for, and inputs that aren't the case's.
    fs::write(answers.join("importance_sampling/more.npz"), "").unwrap();
    assert!(judged(&answers).unwrap_err().to_string().contains("no case asks for"));
    let inputs = cases.join("importance_sampling/forward-bins_1024.npz");
    fs::copy(&path, &inputs).unwrap();
    assert!(large::read(&cases).unwrap_err().to_string().contains("forward-bins_1024.npz"));
}
