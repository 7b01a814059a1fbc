//! JSON with a line for each row and each case: as small as can be, and a change to one shows as one line.

use std::io::{self, Write};

use serde::Serialize;
use serde_json::Serializer;
use serde_json::ser::Formatter;

/// What lies in more brackets than this stays on its line.
const BROKEN: usize = 2;

/// A value as such JSON.
pub(super) fn text(value: &impl Serialize) -> serde_json::Result<String> {
    let mut bytes = vec![];
    value.serialize(&mut Serializer::with_formatter(&mut bytes, Lines { depth: 0 }))?;
    Ok(String::from_utf8(bytes).expect("JSON is UTF-8"))
}

struct Lines {
    depth: usize,
}

impl Lines {
    fn open<W: ?Sized + Write>(&mut self, to: &mut W, bracket: &[u8]) -> io::Result<()> {
        self.depth += 1;
        to.write_all(bracket)
    }

    fn close<W: ?Sized + Write>(&mut self, to: &mut W, bracket: &[u8]) -> io::Result<()> {
        if self.depth <= BROKEN {
            to.write_all(b"\n")?;
        }
        self.depth -= 1;
        to.write_all(bracket)
    }

    fn next<W: ?Sized + Write>(&mut self, to: &mut W, first: bool) -> io::Result<()> {
        let comma: &[u8] = if first { b"" } else { b"," };
        to.write_all(comma)?;
        if self.depth <= BROKEN { to.write_all(b"\n") } else { Ok(()) }
    }
}

impl Formatter for Lines {
    fn begin_array<W: ?Sized + Write>(&mut self, to: &mut W) -> io::Result<()> {
        self.open(to, b"[")
    }

    fn end_array<W: ?Sized + Write>(&mut self, to: &mut W) -> io::Result<()> {
        self.close(to, b"]")
    }

    fn begin_array_value<W: ?Sized + Write>(&mut self, to: &mut W, first: bool) -> io::Result<()> {
        self.next(to, first)
    }

    fn begin_object<W: ?Sized + Write>(&mut self, to: &mut W) -> io::Result<()> {
        self.open(to, b"{")
    }

    fn end_object<W: ?Sized + Write>(&mut self, to: &mut W) -> io::Result<()> {
        self.close(to, b"}")
    }

    fn begin_object_key<W: ?Sized + Write>(&mut self, to: &mut W, first: bool) -> io::Result<()> {
        self.next(to, first)
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn what_lies_deep_stays_on_a_line() {
        let value = json!({"cases": [{"id": "a", "shape": [2, 3]}, {"id": "b"}], "schema": "x"});
        let lines =
            "{\n\"cases\":[\n{\"id\":\"a\",\"shape\":[2,3]},\n{\"id\":\"b\"}\n],\n\"schema\":\"x\"\n}";
        assert_eq!(text(&value).unwrap(), lines);
        assert_eq!(serde_json::from_str::<serde_json::Value>(lines).unwrap(), value);
    }
}
