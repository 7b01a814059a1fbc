//! What fuzzing has found and kept: no file of `tools/fuzz/corpus` makes a reader panic. New ones come from `cargo fuzz`, see
//! `tools/README.md`.

use std::fs;
use std::path::Path;

#[allow(unreachable_pub, reason = "it belongs to another package")]
#[path = "../tools/fuzz/src/readers.rs"]
mod readers;

#[test]
fn every_kept_input_is_read_or_refused() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("tools/fuzz/corpus");
    for (name, read) in readers::ALL {
        let files = fs::read_dir(corpus.join(name)).unwrap_or_else(|e| panic!("the corpus of {name}: {e}"));
        let mut count = 0;
        for file in files {
            let path = file.expect("a file").path();
            println!("{}", path.display());
            read(&fs::read(&path).expect("read"));
            count += 1;
        }
        assert!(count > 0, "{name} has no inputs");
    }
    fs::remove_dir_all(readers::folder()).expect("removed");
}
