//! The live page of a run, while it is trained.

use std::path::Path;
use std::sync::Arc;

use super::output;
use crate::error::Result;
use crate::parallel;
use crate::scene::Scene;
use crate::serve::{Build, Live, Port, Server, Shown};
use crate::training::model::Model;
use crate::training::run::{LogPoint, Options};

/// The port that a page has where none is named.
pub(super) const PORT: &str = "8765";

/// The address that it has then: nobody else's machine reaches it.
pub(super) const HOST: &str = "127.0.0.1";

/// A page that is there until it is dropped.
pub(super) struct Page {
    live: Arc<Live>,
    _server: Server,
}

impl Page {
    /// Shows a run that goes on after these measurements; `build` makes the model that views are rendered with.
    pub(super) fn open(
        port: Port,
        scene: &Arc<Scene>,
        build: Build,
        folder: &Path,
        end: &Options,
        log: &[LogPoint],
    ) -> Result<Page> {
        let live = Arc::new(Live::new(end, log));
        let shown = Shown { scene: scene.clone(), folder: folder.to_path_buf(), source: live.clone() };
        say_where(&port);
        Ok(Page { live, _server: port.serve(shown, build, parallel::threads())? })
    }

    /// A step has been done.
    pub(super) fn stepped(&self, step: u64, model: &dyn Model) {
        self.live.stepped(step, model);
    }

    /// A measurement has been made.
    pub(super) fn measured(&self, point: &LogPoint) {
        self.live.measured(point);
    }
}

/// Where a page is, and who can see it.
pub(super) fn say_where(port: &Port) {
    output::say(&format!("see the run at {}", port.url()));
    if !port.is_own() {
        output::say(
            "warning: whoever reaches this address sees the run; without --host only this machine does",
        );
    }
}
