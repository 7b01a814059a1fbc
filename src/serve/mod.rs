//! A run as a live page on this machine: its curve, its views beside the photographs, and new views from wherever one drags to.
//!
//! A request goes: `guard` refuses what another page or another name sent, `routes` reads it, `views` renders what was asked for on a
//! thread of its own, with parameters that a [`Source`] hands over: [`live`], training between two of its steps, or [`saved`], a
//! run's folder. Nothing is copied while nobody asks.

mod camera;
mod guard;
mod live;
mod page;
mod routes;
mod saved;
mod views;

use std::io;
use std::net::{IpAddr, SocketAddr, TcpListener};
use std::path::PathBuf;
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use tokio::sync::watch;

use crate::error::{Error, Result};
use crate::scene::Scene;
use crate::training::model::Model;
use crate::training::run::LogPoint;

pub(crate) use live::Live;
pub(crate) use saved::Saved;

/// How long answers that are under way may take once the server is to end.
const GRACE: Duration = Duration::from_millis(300);

/// Where parameters and figures come from.
pub(crate) trait Source: Send + Sync {
    /// What is known of the run now.
    fn progress(&self) -> Result<Progress>;

    /// Brings the model up to date; the step that it is at then.
    fn newest(&self, model: &mut dyn Model) -> Result<u64>;
}

/// A run as far as it has come.
#[derive(Debug)]
pub(crate) struct Progress {
    /// The last step.
    pub step: u64,
    /// Whether it is being trained by this program.
    pub live: bool,
    /// Seconds until its end, where that is known.
    pub left: Option<f64>,
    /// Its measurements.
    pub log: Vec<LogPoint>,
}

/// What makes the model that views are rendered with, when the first is asked for.
pub(crate) type Build = Box<dyn FnOnce() -> Result<Box<dyn Model>> + Send>;

/// What is shown: a run, and nothing else.
pub(crate) struct Shown {
    /// What it was trained on.
    pub scene: Arc<Scene>,
    /// Its folder.
    pub folder: PathBuf,
    /// Figures and parameters.
    pub source: Arc<dyn Source>,
}

/// A port that is taken, and not answered on yet.
pub(crate) struct Port {
    listener: TcpListener,
    address: SocketAddr,
}

impl Port {
    /// Takes a port, which `argument` names; 0: any that is free.
    ///
    /// # Errors
    /// Where it is taken already, or not this program's to take.
    pub(crate) fn take(host: IpAddr, port: u16, argument: &str) -> Result<Port> {
        let taken = TcpListener::bind((host, port)).and_then(|listener| {
            listener.set_nonblocking(true)?;
            Ok(Port { address: listener.local_addr()?, listener })
        });
        taken.map_err(|error| {
            let found = match error.kind() {
                io::ErrorKind::AddrInUse => format!("{port}, which another program has taken"),
                _ => format!("{port} at {host} ({error})"),
            };
            Error::usage(argument, found, "a free port, or 0 for any that is free")
        })
    }

    /// Where the page is.
    pub(crate) fn url(&self) -> String {
        format!("http://{}/", self.address)
    }

    /// Whether this machine alone reaches it.
    pub(crate) fn is_own(&self) -> bool {
        self.address.ip().is_loopback()
    }

    /// Answers from now on.
    ///
    /// # Errors
    /// Where the system starts no threads, or has no such sockets.
    pub(crate) fn serve(self, shown: Shown, build: Build, threads: usize) -> Result<Server> {
        let refused = |source| Error::Io {
            path: self.address.to_string().into(),
            action: "can't be served",
            source,
            remedy: "Do without the live page.".into(),
        };
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(refused)?;
        let views = views::start(shown.source.clone(), build, threads).map_err(refused)?;
        let app = routes::router(shown, views, guard::Allowed::new(self.address));
        let (stop, mut stopped) = watch::channel(false);
        let mut long_stopped = stop.subscribe();
        let listener = self.listener;
        let serve = async move {
            let listener = tokio::net::TcpListener::from_std(listener)?;
            // The sender's end is the server's end, too.
            let serving = axum::serve(listener, app)
                .with_graceful_shutdown(async move { drop(stopped.wait_for(|&stopped| stopped).await) });
            let overdue = async move {
                drop(long_stopped.wait_for(|&stopped| stopped).await);
                tokio::time::sleep(GRACE).await;
            };
            tokio::select! {
                ended = serving => ended,
                () = overdue => Ok(()),
            }
        };
        let work = move || {
            let ended = runtime.block_on(serve);
            // What renders is rendered for nobody.
            runtime.shutdown_background();
            ended
        };
        let thread = thread::Builder::new().name("serve".into()).spawn(work).map_err(refused)?;
        Ok(Server { stop, thread: Some(thread) })
    }
}

/// Answers until it is dropped.
pub(crate) struct Server {
    stop: watch::Sender<bool>,
    thread: Option<JoinHandle<io::Result<()>>>,
}

impl Drop for Server {
    fn drop(&mut self) {
        self.stop.send_replace(true);
        // A server that has failed has nothing more to say.
        let _ = self.thread.take().map(JoinHandle::join);
    }
}
