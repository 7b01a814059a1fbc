//! Progress on stderr.

use indicatif::{ProgressBar, ProgressStyle};

use super::output;

/// A bar over `length` steps, a spinner where the length isn't known. Silent where stderr is no terminal.
pub(super) fn bar(length: Option<u64>, what: &'static str) -> ProgressBar {
    let (bar, template) = match length {
        Some(n) => (ProgressBar::new(n), "{prefix} [{bar:30}] {pos}/{len} {elapsed} (left {eta}) {msg}"),
        None => (ProgressBar::new_spinner(), "{prefix} {spinner} {pos} {elapsed} {msg}"),
    };
    let style = ProgressStyle::with_template(template).expect("a valid template").progress_chars("=> ");
    bar.with_style(style).with_prefix(what)
}

/// That checkpoints come less often than usual, as each takes `cost` seconds.
pub(super) fn say_slow(cost: f64, every: f64) {
    output::say(&format!(
        "a checkpoint takes {cost:.1} s here: one every {every:.0} s, so that they cost no more than 1%"
    ));
}
