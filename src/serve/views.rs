//! Views, rendered one after the other on a thread with a pool of its own, so that training's is never in the middle of them.

use std::io;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::thread;
use std::time::Instant;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ImageEncoder, RgbImage};
use tokio::sync::oneshot;

use super::camera::View;
use super::{Build, Source};
use crate::error::Result;
use crate::evaluation::render_view;
use crate::files::picture;
use crate::parallel;
use crate::report::depth;
use crate::training::model::Model;

/// Views that may wait: one for each of a few pages.
const WAITING: usize = 4;

/// A rendered view.
pub(super) struct Seen {
    pub png: Vec<u8>,
    /// Of the parameters.
    pub step: u64,
    pub milliseconds: f64,
}

/// A view that was asked for, and who waits for it.
struct Job {
    view: View,
    /// Near and far, of the depth's colors.
    range: (f64, f64),
    reply: oneshot::Sender<Result<Seen>>,
}

/// Where views are ordered.
#[derive(Clone)]
pub(super) struct Views(SyncSender<Job>);

impl Views {
    /// Orders a view; `None` where too many are waiting, or nobody renders any more.
    pub(super) fn order(&self, view: View, range: (f64, f64)) -> Option<oneshot::Receiver<Result<Seen>>> {
        let (reply, seen) = oneshot::channel();
        match self.0.try_send(Job { view, range, reply }) {
            Ok(()) => Some(seen),
            Err(TrySendError::Full(_) | TrySendError::Disconnected(_)) => None,
        }
    }
}

/// Starts the thread, which ends when nobody can order any more.
pub(super) fn start(source: Arc<dyn Source>, build: Build, threads: usize) -> io::Result<Views> {
    let (orders, jobs) = sync_channel(WAITING);
    thread::Builder::new().name("views".into()).spawn(move || work(jobs, &*source, build, threads))?;
    Ok(Views(orders))
}

fn work(jobs: Receiver<Job>, source: &dyn Source, build: Build, threads: usize) {
    // The model, and the threads, are made when the first view is wanted.
    let Ok(first) = jobs.recv() else { return };
    let all = move || {
        let mut model = match build() {
            Ok(model) => model,
            Err(error) => return drop(first.reply.send(Err(error))),
        };
        for Job { view, range, reply } in std::iter::once(first).chain(jobs) {
            // Who has gone meanwhile needs none.
            if !reply.is_closed() {
                let _ = reply.send(see(&mut *model, source, &view, range));
            }
        }
    };
    // A pool that isn't started answers nobody: who waits is told by the end of the channel.
    let _ = parallel::on_threads(Some(threads), move || {
        all();
        Ok(())
    });
}

fn see(model: &mut dyn Model, source: &dyn Source, view: &View, range: (f64, f64)) -> Result<Seen> {
    let step = source.newest(model)?;
    let began = Instant::now();
    let seen = render_view(model, &view.camera, view.background)?;
    let picture =
        if view.depth { depth::picture(&seen, range.0, range.1) } else { picture::to_rgb(seen.rgb.view()) };
    let png = png(&picture);
    Ok(Seen { png, step, milliseconds: 1e3 * began.elapsed().as_secs_f64() })
}

/// A picture as PNG, quickly.
pub(super) fn png(picture: &RgbImage) -> Vec<u8> {
    let mut bytes = vec![];
    let encoder = PngEncoder::new_with_quality(&mut bytes, CompressionType::Fast, FilterType::Sub);
    let (width, height) = picture.dimensions();
    encoder
        .write_image(picture, width, height, image::ExtendedColorType::Rgb8)
        .expect("memory takes what it is given");
    bytes
}
