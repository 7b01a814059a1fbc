//! A model as COLMAP writes it by default: `cameras.bin`, `images.bin`, `points3D.bin`.

use std::path::Path;

use glam::{DVec2, DVec3};

use super::faulty::faulty;
use super::lens::{Kind, Lens};
use super::model::{Model, Point, Sight, View};
use crate::error::Result;
use crate::files::{self, bytes::Bytes};
use crate::limits::MODEL;

/// What COLMAP writes where a feature belongs to no point.
const NO_POINT: u64 = u64::MAX;

/// Reads the three files of a folder.
pub(super) fn read(folder: &Path) -> Result<Model> {
    let mut model = Model::default();
    each(folder, "cameras.bin", 24, |file, bytes| camera(file, bytes, &mut model))?;
    each(folder, "images.bin", 73, |_, bytes| view(bytes, &mut model))?;
    each(folder, "points3D.bin", 51, |file, bytes| point(file, bytes, &mut model))?;
    Ok(model)
}

/// Reads a file's count, and as many entries of at least `least` bytes.
fn each(
    folder: &Path,
    name: &str,
    least: usize,
    mut entry: impl FnMut(&str, &mut Bytes) -> Result<()>,
) -> Result<()> {
    let path = folder.join(name);
    let (file, whole) = (path.display().to_string(), files::read(&path, MODEL)?);
    let mut bytes = Bytes::new(&file, &whole);
    for _ in 0..bytes.count(least)? {
        entry(&file, &mut bytes)?;
    }
    bytes.end()
}

fn camera(file: &str, bytes: &mut Bytes, model: &mut Model) -> Result<()> {
    let (id, kind) = (bytes.u32()?, bytes.u32()?);
    let kind = Kind::of_id(kind).ok_or_else(|| {
        let expected = "0 to 11, which COLMAP's models have";
        faulty(file, format!("model of camera {id}"), kind, expected, "Write the model again with COLMAP.")
    })?;
    let size = [bytes.u64()?, bytes.u64()?];
    let parameters = (0..kind.parameters()).map(|_| bytes.f64s().map(|[x]| x)).collect::<Result<_>>()?;
    model.add_camera(file, id, Lens { kind, size, parameters })
}

fn view(bytes: &mut Bytes, model: &mut Model) -> Result<()> {
    let _id = bytes.u32()?;
    let (rotation, translation, camera) = (bytes.f64s()?, bytes.f64s()?, bytes.u32()?);
    let name = bytes.text()?.to_string();
    let mut sights = vec![];
    for _ in 0..bytes.count(24)? {
        let ([u, v], point) = (bytes.f64s()?, bytes.u64()?);
        if point != NO_POINT {
            sights.push(Sight { uv: DVec2::new(u, v), point });
        }
    }
    model.views.push(View { name, camera, rotation, translation, sights });
    Ok(())
}

fn point(file: &str, bytes: &mut Bytes, model: &mut Model) -> Result<()> {
    let (id, place) = (bytes.u64()?, DVec3::from_array(bytes.f64s()?));
    bytes.take(3)?;
    let [error] = bytes.f64s()?;
    let track = bytes.count(8)?;
    bytes.take(8 * track)?;
    model.add_point(file, id, Point { place, error })
}
