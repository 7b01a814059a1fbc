//! The same model as text: `cameras.txt`, `images.txt`, `points3D.txt`.

use std::path::Path;
use std::str::{FromStr, SplitWhitespace};

use glam::{DVec2, DVec3};

use super::faulty::faulty;
use super::lens::{Kind, Lens};
use super::model::{Model, Point, Sight, View};
use crate::error::{Error, Result};
use crate::files;
use crate::limits::MODEL;

/// Reads the three files of a folder.
pub(super) fn read(folder: &Path) -> Result<Model> {
    let mut model = Model::default();
    let text = Text::open(&folder.join("cameras.txt"))?;
    for line in text.lines().filter(Line::says_something) {
        camera(line, &mut model)?;
    }
    let text = Text::open(&folder.join("images.txt"))?;
    let mut lines = text.lines();
    while let Some(line) = lines.find(Line::says_something) {
        // The second line has the points, and may be empty.
        model.views.push(view(line, lines.next())?);
    }
    let text = Text::open(&folder.join("points3D.txt"))?;
    for line in text.lines().filter(Line::says_something) {
        point(line, &mut model)?;
    }
    Ok(model)
}

/// A file.
struct Text {
    file: String,
    text: String,
}

/// A line of it.
struct Line<'a> {
    file: &'a str,
    number: usize,
    text: &'a str,
    words: SplitWhitespace<'a>,
}

impl Text {
    fn open(path: &Path) -> Result<Text> {
        let wrong = |error| Error::reading(path)(std::io::Error::new(std::io::ErrorKind::InvalidData, error));
        let text = String::from_utf8(files::read(path, MODEL)?).map_err(wrong)?;
        Ok(Text { file: path.display().to_string(), text })
    }

    fn lines(&self) -> impl Iterator<Item = Line<'_>> {
        self.text.lines().enumerate().map(|(n, text)| Line {
            file: &self.file,
            number: n + 1,
            text,
            words: text.split_whitespace(),
        })
    }
}

impl<'a> Line<'a> {
    /// Whether it is neither empty nor a comment.
    fn says_something(&self) -> bool {
        !self.text.trim().is_empty() && !self.text.starts_with('#')
    }

    /// The next word, as whatever `expected` says.
    fn next<T: FromStr>(&mut self, expected: &str) -> Result<T> {
        let word = self.words.next();
        word.and_then(|word| word.parse().ok())
            .ok_or_else(|| self.wrong(word.unwrap_or("the end of the line"), expected))
    }

    fn numbers<const N: usize>(&mut self, expected: &str) -> Result<[f64; N]> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = self.next(expected)?;
        }
        Ok(numbers)
    }

    fn is_over(&mut self) -> Result<()> {
        self.words.next().map_or(Ok(()), |word| Err(self.wrong(word, "the end of the line")))
    }

    fn wrong(&self, found: &str, expected: &str) -> Error {
        let remedy = "Write the model again with COLMAP's model_converter.";
        faulty(self.file, format!("line {}", self.number), found, expected, remedy)
    }
}

/// CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]
fn camera(mut line: Line, model: &mut Model) -> Result<()> {
    let (id, name) = (line.next("a camera's number")?, line.next::<String>("a model's name")?);
    let Some(kind) = Kind::of_name(&name) else {
        return Err(line.wrong(&name, "the name of a COLMAP camera model"));
    };
    let size = [line.next("a width")?, line.next("a height")?];
    let expected = format!("{} parameters of {name}", kind.parameters());
    let parameters = (0..kind.parameters()).map(|_| line.next(&expected)).collect::<Result<_>>()?;
    line.is_over()?;
    model.add_camera(line.file, id, Lens { kind, size, parameters })
}

/// IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME; then POINTS2D[] as (X, Y, POINT3D_ID).
fn view(mut line: Line, points: Option<Line>) -> Result<View> {
    let _id: u32 = line.next("a picture's number")?;
    let (rotation, translation) = (line.numbers("a quaternion")?, line.numbers("a translation")?);
    let camera = line.next("a camera's number")?;
    // A name may have spaces in it.
    let name = line.words.by_ref().collect::<Vec<_>>().join(" ");
    if name.is_empty() {
        return Err(line.wrong("the end of the line", "a picture's name"));
    }
    let mut sights = vec![];
    if let Some(mut points) = points {
        while points.words.clone().next().is_some() {
            let [u, v] = points.numbers("x, y and a point's number, three for each feature")?;
            let point: i64 = points.next("a point's number, or -1")?;
            if let Ok(point) = point.try_into() {
                sights.push(Sight { uv: DVec2::new(u, v), point });
            }
        }
    }
    Ok(View { name, camera, rotation, translation, sights })
}

/// POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX).
fn point(mut line: Line, model: &mut Model) -> Result<()> {
    let (id, place) = (line.next("a point's number")?, line.numbers("a place")?);
    let _color: [f64; 3] = line.numbers("a color")?;
    let error = line.next("a reprojection error")?;
    model.add_point(line.file, id, Point { place: DVec3::from_array(place), error })
}
