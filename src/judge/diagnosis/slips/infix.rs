//! An operation in the text of an honest implementation, as it would be on paper: `o.div(o.mul(d, d), o.exact(12.0))` is `d * d / 12`.

use crate::contract::how::How;
use crate::contract::operation::Operation;
use crate::contract::site::{Origin, Site};
use crate::registry::COMPONENTS;

/// Longer ones are cut.
const LONGEST: usize = 90;

/// What is written where, and in which other way that would be: on a line.
pub(super) fn says(site: &Site, how: How) -> String {
    let file = site.at.file().replace('\\', "/");
    let place = format!("{}:{}", file.rfind("src/").map_or(&*file, |n| &file[n..]), site.at.line());
    let Some(call) = call(&file, site) else {
        return format!("{} ({place})", changed(&Written::atom("an operation"), &[], site.operation, how));
    };
    let (name, arguments) = call;
    let right = written(&name, &arguments);
    if let How::Other(n, origin) = how {
        let other = originally(origin).unwrap_or_else(|| Written::atom("another number"));
        let one = |(i, own): (usize, &Written)| if i == n { other.clone() } else { own.clone() };
        let mixed: Vec<Written> = arguments.iter().enumerate().map(one).collect();
        return format!("{} in the place of {} ({place})", cut(&written(&name, &mixed).0), cut(&right.0));
    }
    format!("{} ({place})", changed(&right, &arguments, site.operation, how))
}

/// A number of an operation that was done before, as it is written there.
fn originally(origin: Origin) -> Option<Written> {
    let (name, arguments) = call(&origin.site.at.file().replace('\\', "/"), &origin.site)?;
    if origin.place == 2 { Some(written(&name, &arguments)) } else { arguments.get(origin.place).cloned() }
}

/// Text, and how tightly it holds together: a sum is 1, a product 2, a name 3.
#[derive(Clone)]
struct Written(String, u8);

impl Written {
    fn atom(text: &str) -> Written {
        Written(text.into(), 3)
    }

    /// In parentheses where it doesn't hold together as tightly as this.
    fn within(&self, tight: u8) -> String {
        if self.1 >= tight { self.0.clone() } else { format!("({})", self.0) }
    }

    fn two(sign: &str, tight: u8, a: &Written, b: &Written) -> Written {
        // a - (b + c), a / (b c).
        let own = tight + u8::from(matches!(sign, "-" | "/"));
        Written(format!("{} {sign} {}", a.within(tight), b.within(own)), tight)
    }
}

/// What stands in the place of what.
fn changed(right: &Written, arguments: &[Written], operation: Operation, how: How) -> String {
    let argument = |n: usize| arguments.get(n).cloned().unwrap_or_else(|| Written::atom("the other"));
    let instead = match how {
        How::First => argument(0),
        How::Second if operation == Operation::Above => argument(2),
        How::Second => argument(1),
        How::Done(other) => applied(other, &[argument(0), argument(1)]),
        How::Crossed(other) => applied(other, &[argument(1), argument(0)]),
        How::Exchanged => applied(operation, &[argument(1), argument(0)]),
        How::Both(n) => applied(operation, &[argument(n), argument(n)]),
        How::OfOpposite => applied(operation, &[Written(format!("-{}", argument(0).within(2)), 2)]),
        How::Opposite => Written(format!("-{}", right.within(2)), 2),
        How::Squared => square(right),
        How::Root => root(right),
        How::SquaredInside(0) => applied(operation, &[square(&argument(0)), argument(1)]),
        How::SquaredInside(_) => applied(operation, &[argument(0), square(&argument(1))]),
        How::RootInside(0) => applied(operation, &[root(&argument(0)), argument(1)]),
        How::RootInside(_) => applied(operation, &[argument(0), root(&argument(1))]),
        How::Halved => Written(format!("{} / 2", right.within(2)), 2),
        How::Doubled => Written(format!("2 * {}", right.within(2)), 2),
        How::Taken(x) => Written::atom(&number(x)),
        How::Times(k) => Written(format!("{} * {}", number(k), right.within(2)), 2),
        How::Plus(k) => plus(right, k),
        How::PlusInside(0, k) => applied(operation, &[plus(&argument(0), k), argument(1)]),
        How::PlusInside(_, k) => applied(operation, &[argument(0), plus(&argument(1), k)]),
        How::Without(n) => return format!("{} without term {} of the sum", cut(&right.0), n + 1),
        How::Less(n) => return format!("{} with the other sign in term {} of the sum", cut(&right.0), n + 1),
        How::SecondOutside => return outside(right, &argument(1)),
        How::FirstOutside => return outside(right, &argument(0)),
        How::Wider => return format!("{}, with what follows inside of the parenthesis", cut(&right.0)),
        How::Other(..) => right.clone(),
    };
    format!("{} in the place of {}", cut(&instead.0), cut(&right.0))
}

fn number(x: f64) -> String {
    if x.fract() == 0.0 && x.abs() < 1e6 { format!("{x}") } else { format!("{x:?}") }
}

fn plus(x: &Written, k: f64) -> Written {
    let sign = if k < 0.0 { "-" } else { "+" };
    Written(format!("{} {sign} {}", x.within(1), number(k.abs())), 1)
}

fn square(x: &Written) -> Written {
    Written(format!("{}^2", x.within(3)), 3)
}

fn root(x: &Written) -> Written {
    Written(format!("sqrt({})", x.0), 3)
}

fn outside(right: &Written, part: &Written) -> String {
    format!("{}, of which {} is taken outside of the parenthesis", cut(&right.0), cut(&part.0))
}

fn cut(text: &str) -> String {
    if text.chars().count() <= LONGEST {
        return text.into();
    }
    text.chars().take(LONGEST - 3).chain("...".chars()).collect()
}

/// The method's name and its arguments in the text of its file.
fn call(file: &str, site: &Site) -> Option<(String, Vec<Written>)> {
    let of = |folder: &str| file.ends_with(&format!("src/{folder}/honest.rs"));
    let code = COMPONENTS.iter().find(|c| of(c.folder))?.code;
    let mut lines = code.split_inclusive('\n');
    let before: usize = lines.by_ref().take(site.at.line() as usize - 1).map(str::len).sum();
    let column: usize = lines.next()?.chars().take(site.at.column() as usize - 1).map(char::len_utf8).sum();
    let text = &code[before + column..];
    let open = text.find('(')?;
    let close = closing(text, open)?;
    let name = text[..open].rsplit(['.', ' ', '(']).next()?;
    Some((name.to_string(), split(&text[open + 1..close]).into_iter().map(node).collect()))
}

/// The place of the bracket that closes the one at `open`.
fn closing(text: &str, open: usize) -> Option<usize> {
    let mut depth = 0;
    for (n, c) in text.char_indices().skip_while(|(n, _)| *n < open) {
        match c {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return Some(n);
        }
    }
    None
}

/// Arguments, at the commas that no bracket surrounds.
fn split(text: &str) -> Vec<&str> {
    let (mut depth, mut from, mut parts) = (0, 0, vec![]);
    for (n, c) in text.char_indices() {
        match c {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(&text[from..n]);
                from = n + 1;
            }
            _ => {}
        }
    }
    parts.push(&text[from..]);
    parts.into_iter().map(str::trim).filter(|part| !part.is_empty()).collect()
}

/// An expression.
fn node(text: &str) -> Written {
    let text = text.trim().trim_start_matches(['&', '*']);
    let is_path = |before: &str| before.chars().all(|c| c.is_alphanumeric() || c == '_' || c == '.');
    if let Some(open) = text.find('(')
        && closing(text, open) == Some(text.len() - 1)
        && is_path(&text[..open])
        && let Some((_, name)) = text[..open].rsplit_once('.')
    {
        let arguments: Vec<Written> = split(&text[open + 1..text.len() - 1]).into_iter().map(node).collect();
        return written(name, &arguments);
    }
    let words: Vec<&str> = text.split_whitespace().collect();
    let whole = |word: &&str| word.strip_suffix(".0").unwrap_or(word).to_string();
    let plain = words.iter().map(whole).collect::<Vec<_>>().join(" ").replace("self.", "");
    Written(plain, if words.len() > 1 { 1 } else { 3 })
}

/// A call by its name.
fn written(name: &str, arguments: &[Written]) -> Written {
    match (name, arguments) {
        ("exact" | "hyper" | "round", [x]) => x.clone(),
        ("add", _) => applied(Operation::Add, arguments),
        ("sub", _) => applied(Operation::Sub, arguments),
        ("mul" | "times", _) => applied(Operation::Mul, arguments),
        ("div", _) => applied(Operation::Div, arguments),
        ("neg", [x]) => Written(format!("-{}", x.within(2)), 2),
        ("sum", [x]) if x.0.starts_with('[') => {
            let terms: Vec<String> =
                split(x.0.trim_matches(['[', ']'])).into_iter().map(|t| node(t).0).collect();
            Written(terms.join(" + "), 1)
        }
        (name, _) => {
            let all: Vec<&str> = arguments.iter().map(|a| a.0.as_str()).collect();
            Written(format!("{name}({})", all.join(", ")), 3)
        }
    }
}

/// An operation on what is written.
fn applied(operation: Operation, arguments: &[Written]) -> Written {
    match (operation, arguments) {
        (Operation::Add, [a, b]) => Written::two("+", 1, a, b),
        (Operation::Sub, [a, b]) => Written::two("-", 1, a, b),
        (Operation::Mul, [a, b]) => Written::two("*", 2, a, b),
        (Operation::Div, [a, b]) => Written::two("/", 2, a, b),
        (Operation::Pow, [a, b]) => Written::two("^", 2, a, b),
        (Operation::Max, [a, b]) => Written::atom(&format!("max({}, {})", a.0, b.0)),
        (Operation::Min, [a, b]) => Written::atom(&format!("min({}, {})", a.0, b.0)),
        (function, [a, ..]) => Written::atom(&format!("{}({})", format!("{function:?}").to_lowercase(), a.0)),
        (_, []) => Written::atom("it"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn calls_become_formulas() {
        for (code, formula) in [
            ("o.sub(a, o.add(b, c))", "a - (b + c)"),
            ("o.sub(o.add(a, b), c)", "a + b - c"),
            ("self.o.div(m.mul(a, b), o.times(2.0, self.c))", "a * b / (2 * c)"),
            ("m.mul(m.sub(m.exact(1.0), a[i]), o.sqrt(b))", "(1 - a[i]) * sqrt(b)"),
            ("o.sum(&[x, o.neg(y), o.max(y, z)])", "x + -y + max(y, z)"),
            ("o.hyper(4.0 / 15.0)", "4 / 15"),
        ] {
            assert_eq!(node(code).0, formula, "{code}");
        }
    }

    #[test]
    fn what_is_done_in_another_way_is_written_so() {
        let arguments = ["a", "o.add(b, c)"].map(node);
        let said = |how| changed(&written("div", &arguments), &arguments, Operation::Div, how);
        for (how, says) in [
            (How::First, "a in the place of a / (b + c)"),
            (How::Exchanged, "(b + c) / a in the place of a / (b + c)"),
            (How::RootInside(1), "a / sqrt(b + c) in the place of a / (b + c)"),
            (How::PlusInside(0, -1.0), "(a - 1) / (b + c) in the place of a / (b + c)"),
            (How::Taken(1e-8), "1e-8 in the place of a / (b + c)"),
            (How::Wider, "a / (b + c), with what follows inside of the parenthesis"),
        ] {
            assert_eq!(said(how), says);
        }
        assert_eq!(cut(&"x".repeat(200)).len(), LONGEST);
    }
}
