//! Real scenes that lie beside the project: tests on them are skipped where they aren't there.

use std::io::Write;
use std::path::{Path, PathBuf};

/// A path of theirs; where it is missing, a note on stderr.
pub(crate) fn shared(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data").join(name);
    if !path.exists() {
        // Past the test harness, which would keep it to itself.
        let _ = writeln!(std::io::stderr(), "skipped: ../shared/data/{name} isn't there");
        return None;
    }
    Some(path)
}
