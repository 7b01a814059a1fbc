//! Points in a `.ply`, as nerfstudio's and Polycam's captures have one beside their cameras: the places of its vertices, nothing else.

use std::path::Path;

use glam::DVec3;

use crate::error::{Error, Input, Result};
use crate::files;
use crate::limits::{LENGTH, MODEL};

/// Longest header: a line for each property and some comments.
const HEADER: usize = 64 << 10;

/// A property's type: its names, its bytes.
const TYPES: [([&str; 2], usize); 8] = [
    (["char", "int8"], 1),
    (["uchar", "uint8"], 1),
    (["short", "int16"], 2),
    (["ushort", "uint16"], 2),
    (["int", "int32"], 4),
    (["uint", "uint32"], 4),
    (["float", "float32"], 4),
    (["double", "float64"], 8),
];

/// What the header says of the vertices.
struct Header {
    ascii: bool,
    count: usize,
    /// Bytes, or words of a line, of a vertex.
    stride: usize,
    /// Where x, y and z are in it, and whether they are doubles.
    places: [(usize, bool); 3],
}

/// Reads the places of all vertices.
///
/// # Errors
/// Where the file is no whole PLY whose vertices come first and have x, y and z.
pub(super) fn read(path: &Path) -> Result<Vec<DVec3>> {
    let bytes = files::read(path, MODEL)?;
    let wrong = |(field, found, expected): (&str, String, String)| {
        let remedy = "Write the points again as a PLY, in text or little-endian, with x, y and z.";
        Error::input(Input { file: path.display(), field, found, expected, remedy })
    };
    let head = &bytes[..bytes.len().min(HEADER)];
    let (end, length) = [&b"end_header\n"[..], b"end_header\r\n"]
        .into_iter()
        .find_map(|end| Some((head.windows(end.len()).position(|window| window == end)?, end.len())))
        .ok_or_else(|| {
            let found = format!("none in {} bytes", head.len());
            wrong(("header", found, "ply, ..., end_header".into()))
        })?;
    let text = String::from_utf8_lossy(&bytes[..end]);
    let header = header(&text).map_err(|(found, expected)| wrong(("header", found, expected.into())))?;
    let rest = &bytes[end + length..];
    let points = if header.ascii { in_text(&header, rest) } else { in_binary(&header, rest) };
    let points = points.map_err(|(found, expected)| wrong(("vertices", found, expected)))?;
    match points.iter().find(|point| point.is_nan() || point.abs().max_element() > LENGTH) {
        Some(point) => Err(wrong(("vertices", point.to_string(), "finite numbers, none beyond 1e9".into()))),
        None => Ok(points),
    }
}

fn header(text: &str) -> std::result::Result<Header, (String, &'static str)> {
    let mut lines = text.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
    if lines.next().as_deref() != Some(&["ply"]) {
        return Err(("another first line".into(), "ply"));
    }
    let (mut ascii, mut count, mut vertices) = (None, None, false);
    let (mut stride, mut places) = (0, [None; 3]);
    for line in lines {
        match line[..] {
            // What is behind it is counted in words or in bytes.
            ["format", ..] if ascii.is_some() || count.is_some() => {
                return Err((line.join(" "), "one format, in front of all elements"));
            }
            ["format", "ascii", _] => ascii = Some(true),
            ["format", "binary_little_endian", _] => ascii = Some(false),
            ["format", ..] => return Err((line.join(" "), "format ascii or binary_little_endian")),
            ["element", "vertex", n] if count.is_none() => {
                count = Some(n.parse::<usize>().map_err(|_| (line.join(" "), "a number of vertices"))?);
                vertices = true;
            }
            ["element", ..] if count.is_none() => return Err((line.join(" "), "element vertex first")),
            ["element", ..] => vertices = false,
            ["property", kind, name] if vertices => {
                let known = TYPES.iter().position(|(names, _)| names.contains(&kind));
                let kind = known.ok_or_else(|| (line.join(" "), "a property of a known type"))?;
                if let Some(axis) = ["x", "y", "z"].iter().position(|axis| *axis == name) {
                    if kind < 6 {
                        return Err((line.join(" "), "a float or a double"));
                    }
                    places[axis] = Some((stride, kind == 7));
                }
                stride += if ascii == Some(true) { 1 } else { TYPES[kind].1 };
            }
            ["property", ..] if vertices => return Err((line.join(" "), "one number a property")),
            _ => {}
        }
    }
    let (Some(ascii), Some(count)) = (ascii, count) else {
        return Err(("no format or no vertices".into(), "both"));
    };
    let [Some(x), Some(y), Some(z)] = places else { return Err(("no x, y or z".into(), "all three")) };
    Ok(Header { ascii, count, stride, places: [x, y, z] })
}

fn in_binary(header: &Header, bytes: &[u8]) -> std::result::Result<Vec<DVec3>, (String, String)> {
    if header.count > bytes.len() / header.stride {
        let expected = format!("{} vertices of {} bytes", header.count, header.stride);
        return Err((format!("{} bytes", bytes.len()), expected));
    }
    let number = |vertex: &[u8], (at, double): (usize, bool)| match double {
        true => f64::from_le_bytes(vertex[at..at + 8].try_into().expect("8 bytes")),
        false => f64::from(f32::from_le_bytes(vertex[at..at + 4].try_into().expect("4 bytes"))),
    };
    let vertices = bytes.chunks_exact(header.stride).take(header.count);
    Ok(vertices.map(|vertex| DVec3::from_array(header.places.map(|place| number(vertex, place)))).collect())
}

fn in_text(header: &Header, bytes: &[u8]) -> std::result::Result<Vec<DVec3>, (String, String)> {
    let text = String::from_utf8_lossy(bytes);
    let mut points = vec![];
    for line in text.lines().take(header.count) {
        let words: Vec<&str> = line.split_whitespace().collect();
        let number = |(at, _): (usize, bool)| words.get(at).and_then(|word| word.parse().ok());
        let [Some(x), Some(y), Some(z)] = header.places.map(number) else {
            return Err((line.chars().take(60).collect(), format!("{} numbers", header.stride)));
        };
        points.push(DVec3::new(x, y, z));
    }
    let found = points.len();
    if found < header.count { Err((found.to_string(), header.count.to_string())) } else { Ok(points) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_bytes(bytes: &[u8]) -> Result<Vec<DVec3>> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), bytes).unwrap();
        read(file.path())
    }

    const TEXT: &str = "ply\nformat ascii 1.0\ncomment of nerfstudio\nelement vertex 2\nproperty float x\nproperty float y\n\
        property float z\nproperty uint8 red\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
        1 2.5 -3 255\n4 5 6e1 0\n3 0 1 1\n";

    #[test]
    fn lines_may_end_as_on_windows() {
        let windows = TEXT.replace('\n', "\r\n");
        assert_eq!(read_bytes(windows.as_bytes()).unwrap(), read_bytes(TEXT.as_bytes()).unwrap());
    }

    /// The place of z would be counted in words, and looked for in bytes.
    #[test]
    fn a_second_format_is_refused() {
        let text = TEXT.replace("end_header", "format binary_little_endian 1.0\nend_header");
        let message = read_bytes(text.as_bytes()).unwrap_err().to_string();
        assert!(message.contains("expected one format, in front of all elements"), "{message}");
    }

    #[test]
    fn text_and_bytes_hold_the_same_points() {
        let points = vec![DVec3::new(1.0, 2.5, -3.0), DVec3::new(4.0, 5.0, 60.0)];
        assert_eq!(read_bytes(TEXT.as_bytes()).unwrap(), points);
        let mut bytes = b"ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty uchar red\nproperty double x\n\
            property float y\nproperty double z\nend_header\n"
            .to_vec();
        for point in &points {
            bytes.push(7);
            bytes.extend(point.x.to_le_bytes());
            bytes.extend((point.y as f32).to_le_bytes());
            bytes.extend(point.z.to_le_bytes());
        }
        assert_eq!(read_bytes(&bytes).unwrap(), points);
        let message = read_bytes(&bytes[..bytes.len() - 1]).unwrap_err().to_string();
        assert!(message.contains("vertices: found 41 bytes; expected 2 vertices of 21 bytes"), "{message}");
    }

    #[test]
    fn what_is_no_such_file_is_refused_by_what_is_wrong() {
        for (from, to, says) in [
            ("ply", "plz", "another first line"),
            ("ascii", "binary_big_endian", "format binary_big_endian"),
            ("vertex 2", "vertex 4", "found 3; expected 4"),
            ("vertex 2", "vertex 99999999999999999999", "a number of vertices"),
            ("vertex 2", "vertex 9999999999999", "found 3; expected 9999999999999"),
            ("float x", "int x", "a float or a double"),
            ("float x", "list uchar int x", "one number a property"),
            ("float x", "float w", "no x, y or z"),
            ("float x", "half x", "a known type"),
            ("2.5", "nan", "finite numbers"),
            ("2.5", "1e30", "finite numbers"),
            ("2.5", "x", "expected 4 numbers"),
            ("element vertex", "element face 1\nelement vertex", "element vertex first"),
            ("end_header", "the end", "end_header"),
        ] {
            let message = read_bytes(TEXT.replacen(from, to, 1).as_bytes()).unwrap_err().to_string();
            assert!(message.contains(says), "{from} -> {to}: {message}");
        }
    }
}
