//! JSON files in which nothing goes by unseen: a field that stands there twice is an error, and each field is checked against what it may
//! hold before anything is read from it.

use std::fmt;

use serde::de::{Deserialize, Deserializer, Error as _, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value};

use crate::error::{Error, Input, Result};

/// What a field may hold.
#[derive(Clone, Copy, Debug)]
pub enum Holds {
    /// A number from the first to the second.
    Number(f64, f64),
    /// A number above the first, up to the second.
    Above(f64, f64),
    /// A whole number from the first to the second.
    Whole(u64, u64),
    /// The same, where 3.0 is one too: exporters write 800.0 pixels.
    Round(f64, f64),
    /// true or false.
    Flag,
    /// Text, not empty.
    Text,
    /// One of these words.
    Word(&'static [&'static str]),
    /// So many numbers, each from the second to the third.
    Numbers(usize, f64, f64),
    /// Rows of so many numbers: the shape's first number of them, or one more.
    Rows(usize, usize),
    /// A list of such.
    List(&'static Holds),
    /// An object with these fields, each of them there unless it is [`Holds::Maybe`].
    Object(&'static [(&'static str, Holds)]),
    /// Either.
    Or(&'static Holds, &'static Holds),
    /// Such, null, or no field at all.
    Maybe(&'static Holds),
    /// Anything: of no consequence here.
    Anything,
}

use Holds::*;

impl Holds {
    /// Whether a value is such.
    fn holds(&self, value: &Value) -> bool {
        let number = |low: f64, high: f64| value.as_f64().is_some_and(|x| (low..=high).contains(&x));
        let list =
            |check: &dyn Fn(&Value) -> bool| value.as_array().is_some_and(|list| list.iter().all(check));
        let long = |n: usize| value.as_array().is_some_and(|list| list.len() == n);
        match *self {
            Number(low, high) => number(low, high),
            Above(low, high) => number(low, high) && value.as_f64() != Some(low),
            Whole(low, high) => value.as_u64().is_some_and(|n| (low..=high).contains(&n)),
            Round(low, high) => number(low, high) && value.as_f64().is_some_and(|x| x.fract() == 0.0),
            Flag => value.is_boolean(),
            Text => value.as_str().is_some_and(|text| !text.is_empty()),
            Word(words) => value.as_str().is_some_and(|word| words.contains(&word)),
            Numbers(n, low, high) => long(n) && list(&|x| Number(low, high).holds(x)),
            Rows(rows, columns) => {
                let row = Numbers(columns, f64::MIN, f64::MAX);
                (long(rows) || long(rows + 1)) && list(&|x| row.holds(x))
            }
            List(holds) => list(&|x| holds.holds(x)),
            Object(_) => value.is_object(),
            Or(one, other) => one.holds(value) || other.holds(value),
            Maybe(holds) => value.is_null() || holds.holds(value),
            Anything => true,
        }
    }

    /// Checks a field's value; of an object, each field of the table, and that there is no other.
    ///
    /// # Errors
    /// Where it is something else: file, field, what was found and what it may hold.
    pub fn check(&self, file: &str, field: &str, value: &Value, remedy: &str) -> Result<()> {
        if !self.holds(value) {
            return Err(Error::input(Input { file, field, found: short(value), expected: self, remedy }));
        }
        let (Object(table), Some(object)) = (self, value.as_object()) else { return Ok(()) };
        let inner = |name: &str| if field.is_empty() { name.to_string() } else { format!("{field}.{name}") };
        for (name, holds) in *table {
            match object.get(*name) {
                Some(value) => holds.check(file, &inner(name), value, remedy)?,
                None if matches!(holds, Maybe(_)) => {}
                None => {
                    let (field, found) = (inner(name), "no such field");
                    return Err(Error::input(Input { file, field, found, expected: holds, remedy }));
                }
            }
        }
        Ok(())
    }
}

impl fmt::Display for Holds {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match *self {
            Number(low, high) if high < f64::MAX => write!(f, "a number from {low} to {high}"),
            Number(..) => write!(f, "a number"),
            Above(0.0, f64::MAX) => write!(f, "a positive number"),
            Above(0.0, high) => write!(f, "a positive number, at most {high}"),
            Above(low, high) => write!(f, "a number above {low}, at most {high}"),
            Whole(low, high) => write!(f, "a whole number from {low} to {high}"),
            Round(low, high) => write!(f, "a whole number from {low} to {high}"),
            Flag => write!(f, "true or false"),
            Text => write!(f, "text"),
            Word(words) => write!(f, "{}", words.join(" or ")),
            Numbers(n, low, high) => write!(f, "a list of {n}, each {}", Number(low, high)),
            Rows(rows, columns) => write!(f, "{rows} rows of {columns} numbers"),
            List(holds) => write!(f, "a list, in it {holds}"),
            Object(_) => write!(f, "an object"),
            Or(one, other) => write!(f, "{one} or {other}"),
            Maybe(holds) => write!(f, "{holds} or null"),
            Anything => write!(f, "a value"),
        }
    }
}

/// A value as a message shows it.
pub fn short(value: &Value) -> String {
    const MOST: usize = 60;
    let text = value.to_string();
    match text.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text,
    }
}

/// Parses a text; a name that is in an object twice is an error. (serde_json's own values keep the last, silently.)
///
/// # Errors
/// Those of serde_json.
pub fn parse(text: &str) -> serde_json::Result<Value> {
    serde_json::from_str::<Once>(text).map(|once| once.0)
}

/// The same of a text that is one object.
///
/// # Errors
/// Those of serde_json, and where it is something else.
pub fn parse_object(text: &str) -> serde_json::Result<Map<String, Value>> {
    match parse(text)? {
        Value::Object(object) => Ok(object),
        other => Err(serde_json::Error::custom(short(&other))),
    }
}

/// A value whose objects have each name once.
struct Once(Value);

impl<'de> Deserialize<'de> for Once {
    fn deserialize<D: Deserializer<'de>>(from: D) -> std::result::Result<Once, D::Error> {
        from.deserialize_any(OnceVisitor).map(Once)
    }
}

struct OnceVisitor;

impl<'de> Visitor<'de> for OnceVisitor {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "JSON")
    }

    fn visit_bool<E>(self, x: bool) -> std::result::Result<Value, E> {
        Ok(x.into())
    }

    fn visit_i64<E>(self, x: i64) -> std::result::Result<Value, E> {
        Ok(x.into())
    }

    fn visit_u64<E>(self, x: u64) -> std::result::Result<Value, E> {
        Ok(x.into())
    }

    fn visit_f64<E>(self, x: f64) -> std::result::Result<Value, E> {
        Ok(x.into())
    }

    fn visit_str<E>(self, x: &str) -> std::result::Result<Value, E> {
        Ok(x.into())
    }

    fn visit_unit<E>(self) -> std::result::Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut from: A) -> std::result::Result<Value, A::Error> {
        let mut list = vec![];
        while let Some(Once(value)) = from.next_element()? {
            list.push(value);
        }
        Ok(list.into())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut from: A) -> std::result::Result<Value, A::Error> {
        let mut object = Map::new();
        while let Some((name, Once(value))) = from.next_entry::<String, Once>()? {
            if object.contains_key(&name) {
                return Err(A::Error::custom(format!("{name:?} is there twice")));
            }
            object.insert(name, value);
        }
        Ok(object.into())
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn values_are_read_as_they_are_but_no_name_twice() {
        let text = r#"{"a":[1,-2,0.5,true,null,"x",18446744073709551615],"b":{"a":{}}}"#;
        assert_eq!(parse(text).unwrap(), serde_json::from_str::<Value>(text).unwrap());
        let error = parse(r#"{"a":1,"b":{"k1":0,"k1":0.1}}"#).unwrap_err().to_string();
        assert!(error.contains(r#""k1" is there twice"#), "{error}");
        assert!(parse(&"[".repeat(100_000)).unwrap_err().to_string().contains("recursion limit"));
    }

    #[test]
    fn a_field_holds_what_the_table_says() {
        let fits = |holds: Holds, value: Value| holds.check("f", "x", &value, "").is_ok();
        for (holds, good, bad) in [
            (Number(0.0, 1.0), json!([0, 1, 0.5]), json!([-0.1, 1.1, "0.5", null, true, [0.5]])),
            (Above(0.0, 9.0), json!([1e-9, 9]), json!([0, -1, 10])),
            (Whole(1, 9), json!([1, 9]), json!([0, 10, 4.0, -1, 1e300, "1"])),
            (Round(1.0, 9.0), json!([1, 9, 4.0]), json!([0, 10, 1.5, -1, -1.0, 1e300, "1"])),
            (Flag, json!([true, false]), json!([0, "true", null])),
            (Text, json!(["a"]), json!(["", 1, null])),
            (Word(&["a", "b"]), json!(["a", "b"]), json!(["c", 1])),
            (Numbers(2, 0.0, 1.0), json!([[0, 1]]), json!([[0], [0, 1, 1], [0, 2], ["0", 1], 0])),
            (Rows(1, 2), json!([[[0, 1]], [[0, 1], [2, 3]]]), json!([[[0]], [], [0, 1]])),
            (List(&Text), json!([[], ["a"]]), json!([["a", 1], "a"])),
            (Or(&Text, &Flag), json!(["a", true]), json!([0, null])),
            (Maybe(&Flag), json!([null, true]), json!([0])),
        ] {
            good.as_array().unwrap().iter().for_each(|x| assert!(fits(holds, x.clone()), "{holds}: {x}"));
            bad.as_array().unwrap().iter().for_each(|x| assert!(!fits(holds, x.clone()), "{holds}: {x}"));
        }
        let table = Object(&[("a", Flag), ("b", Maybe(&Text)), ("c", Object(&[("d", Flag)]))]);
        let said = |value: Value| table.check("run.json", "", &value, "Do.").unwrap_err().to_string();
        assert_eq!(said(json!({"b": "x"})), "run.json: a: found no such field; expected true or false. Do.");
        assert_eq!(said(json!({"a": true, "b": 1})), "run.json: b: found 1; expected text or null. Do.");
        let inner = said(json!({"a": true, "c": {"d": "x".repeat(100)}}));
        assert!(
            inner.starts_with("run.json: c.d: found \"xxx") && inner.contains("x...; expected true or false")
        );
    }
}
