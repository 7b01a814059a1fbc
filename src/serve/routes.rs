//! What can be asked for: the page, the run's figures, its curve, photographs, views that training has kept, and new ones. Each is named
//! by numbers; no part of a path is ever a file's name.

use std::fs;
use std::sync::Arc;

use axum::Router;
use axum::body::Body;
use axum::extract::rejection::{PathRejection, QueryRejection};
use axum::extract::{Path, Query, State};
use axum::http::header::{ALLOW, CONTENT_TYPE, HeaderName};
use axum::http::{HeaderValue, Method, StatusCode};
use axum::middleware::{from_fn, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use serde::Deserialize;
use serde_json::{Value, json};

use super::Shown;
use super::camera::{self, Asked};
use super::guard::{self, Allowed};
use super::page::PAGE;
use super::views::{self, Seen, Views};
use crate::error::Result;
use crate::files::{self, picture};
use crate::limits::PICTURE_FILE;
use crate::report::training;
use crate::scene::{Frame, path};
use crate::shown::shown;
use crate::training::outlook;

/// What every answer is made of.
struct Desk {
    shown: Shown,
    views: Views,
}

type Asks = State<Arc<Desk>>;

/// The server's routes.
pub(super) fn router(shown: Shown, views: Views, allowed: Arc<Allowed>) -> Router {
    Router::new()
        .route("/", get(page))
        .route("/favicon.ico", get(|| async { StatusCode::NO_CONTENT }))
        .route("/api/state", get(state))
        .route("/api/curve", get(curve))
        .route("/api/key", get(key))
        .route("/api/view", get(view))
        .route("/photographs/{n}", get(photograph))
        .route("/views/{step}/{n}", get(kept))
        .fallback(|| async { (StatusCode::NOT_FOUND, "There is no such page.") })
        .with_state(Arc::new(Desk { shown, views }))
        .layer(from_fn(|request: axum::extract::Request, next: axum::middleware::Next| async {
            match *request.method() {
                Method::GET | Method::HEAD => next.run(request).await,
                _ => (StatusCode::METHOD_NOT_ALLOWED, [(ALLOW, "GET, HEAD")], "Nothing can be changed here.")
                    .into_response(),
            }
        }))
        .layer(from_fn_with_state(allowed, guard::check))
}

async fn page() -> Response {
    ([(CONTENT_TYPE, "text/html; charset=utf-8")], PAGE).into_response()
}

/// Work that reads files or encodes pictures, on a thread that may wait.
async fn waiting(work: impl FnOnce() -> Response + Send + 'static) -> Response {
    let done = tokio::task::spawn_blocking(work).await;
    done.unwrap_or_else(|_| failed("it couldn't be computed"))
}

fn failed(why: impl ToString) -> Response {
    (StatusCode::INTERNAL_SERVER_ERROR, shown(&why.to_string()).into_owned()).into_response()
}

fn refused(why: impl ToString) -> Response {
    (StatusCode::BAD_REQUEST, shown(&why.to_string()).into_owned()).into_response()
}

fn missing() -> Response {
    (StatusCode::NOT_FOUND, "The run has no such picture.").into_response()
}

fn json_of(value: &Value) -> Response {
    ([(CONTENT_TYPE, "application/json")], value.to_string()).into_response()
}

fn png(bytes: Vec<u8>) -> Response {
    ([(CONTENT_TYPE, "image/png")], Body::from(bytes)).into_response()
}

/// Validation frames that have a photograph, in the order in which training numbers them.
fn photographed(shown: &Shown) -> Vec<&Frame> {
    shown.scene.val.iter().filter(|frame| frame.image.is_some()).collect()
}

#[derive(Deserialize)]
struct After {
    /// Measurements of later steps alone.
    after: Option<u64>,
}

async fn state(State(desk): Asks, query: Result<Query<After>, QueryRejection>) -> Response {
    let after = match query {
        Ok(Query(After { after })) => after,
        Err(error) => return refused(error.body_text()),
    };
    waiting(move || match state_of(&desk.shown, after) {
        Ok(state) => json_of(&state),
        Err(error) => failed(error),
    })
    .await
}

fn state_of(shown: &Shown, after: Option<u64>) -> Result<Value> {
    let progress = shown.source.progress()?;
    let (scene, log) = (&shown.scene, &progress.log);
    let speed = outlook::points_per_second(log);
    let last = log.last();
    let measured = log.iter().rev().find_map(|point| point.val_psnr.or(point.val_probe));
    let views = log.iter().rev().find(|point| point.val_psnr.is_some()).map(|point| point.step);
    let numbers = views.map_or(vec![], |step| kept_views(shown, step));
    let names = photographed(shown);
    let rows: Vec<Value> =
        numbers.iter().filter_map(|&n| Some(json!({"n": n, "name": names.get(n)?.name}))).collect();
    let newer: Vec<_> = log.iter().filter(|point| after.is_none_or(|after| point.step > after)).collect();
    Ok(json!({
        "run": shown.folder.display().to_string(), "scene": scene.name, "warnings": scene.warnings,
        "live": progress.live, "step": progress.step, "left": progress.left, "points_per_second": speed,
        "seconds": last.map(|point| point.seconds), "psnr": measured, "measured": last.map(|point| point.step),
        "log": newer, "views": {"step": views, "rows": rows}, "background": scene.background,
        "near": scene.near, "far": scene.far, "camera": camera::first(scene),
    }))
}

/// The numbers of the views that training has kept of a step.
fn kept_views(shown: &Shown, step: u64) -> Vec<usize> {
    let head = format!("step{step:06}_view");
    let names = fs::read_dir(shown.folder.join("views")).into_iter().flatten().flatten();
    let number = |entry: fs::DirEntry| {
        let name = entry.file_name().to_str()?.to_string();
        name.strip_prefix(&head)?.strip_suffix(".png")?.parse().ok()
    };
    let mut numbers: Vec<usize> = names.filter_map(number).collect();
    numbers.sort_unstable();
    numbers
}

async fn curve(State(desk): Asks) -> Response {
    waiting(move || match desk.shown.source.progress() {
        Ok(progress) => {
            let svg = training::curve(&desk.shown.scene.name, &progress.log);
            ([(CONTENT_TYPE, "image/svg+xml")], svg).into_response()
        }
        Err(error) => failed(error),
    })
    .await
}

async fn photograph(State(desk): Asks, number: Result<Path<usize>, PathRejection>) -> Response {
    let Ok(Path(n)) = number else { return missing() };
    waiting(move || {
        let frames = photographed(&desk.shown);
        let image = frames.get(n).and_then(|frame| frame.image.as_ref());
        image.map_or_else(missing, |image| png(views::png(&picture::to_rgb(image.to_array().view()))))
    })
    .await
}

async fn kept(State(desk): Asks, numbers: Result<Path<(u64, usize)>, PathRejection>) -> Response {
    let Ok(Path((step, n))) = numbers else { return missing() };
    waiting(move || {
        let file = desk.shown.folder.join(format!("views/step{step:06}_view{n:02}.png"));
        files::read(&file, PICTURE_FILE).map_or_else(|_| missing(), png)
    })
    .await
}

async fn key(State(desk): Asks, query: Result<Query<Asked>, QueryRejection>) -> Response {
    match query.map(|Query(asked)| asked.view(&desk.shown.scene)) {
        Ok(Ok(view)) => json_of(&path::key(&view.camera)),
        Ok(Err(why)) => refused(why),
        Err(error) => refused(error.body_text()),
    }
}

async fn view(State(desk): Asks, query: Result<Query<Asked>, QueryRejection>) -> Response {
    let scene = &desk.shown.scene;
    let view = match query.map(|Query(asked)| asked.view(scene)) {
        Ok(Ok(view)) => view,
        Ok(Err(why)) => return refused(why),
        Err(error) => return refused(error.body_text()),
    };
    let Some(seen) = desk.views.order(view, (scene.near, scene.far)) else {
        return (StatusCode::SERVICE_UNAVAILABLE, "Too many views are waiting: ask again.").into_response();
    };
    match seen.await {
        Ok(Ok(Seen { png: bytes, step, milliseconds })) => {
            let mut response = png(bytes);
            for (name, value) in
                [("x-step", step.to_string()), ("x-milliseconds", format!("{milliseconds:.1}"))]
            {
                let value = HeaderValue::from_str(&value).expect("digits");
                response.headers_mut().insert(HeaderName::from_static(name), value);
            }
            response
        }
        Ok(Err(error)) => failed(error),
        Err(_) => failed("the model can't be rendered here"),
    }
}
