//! What a component is to the harness: a plain struct of functions over named arrays.

use super::arithmetic::Arithmetic;
use super::arrays::Arrays;
use super::case::Case;
use super::machine::Machine;
use super::special::Special;
use crate::convention::Conventions;

/// What the entries of an array are, which says in which types files have them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entries {
    /// Real numbers, in the type under test; a scalar input is a hyper-parameter, in f64.
    Real,
    /// Counts: whole numbers, written as int64, answered in any type.
    Count,
    /// 0 or 1: written as int64, answered in any type.
    Bit,
    /// 0, ..., 255: uint8, answered in any type.
    Byte,
    /// Which pixel or image: real numbers, which may be answered as integers.
    Pixel,
}

impl Entries {
    /// Small whole numbers, which every type holds.
    pub fn whole(self) -> bool {
        matches!(self, Entries::Count | Entries::Bit | Entries::Byte)
    }
}

/// One input or output array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Port {
    /// Name, as in the judging contract. A last `*` stands for a number: `w*` is w0, w1, ...
    pub name: &'static str,
    /// Shape in letters, e.g. `R,N,3`; empty for a scalar.
    pub shape: &'static str,
    /// What it is, with units.
    pub meaning: &'static str,
    /// Inputs: a VJP returns `grad_<name>`. Outputs: a VJP takes `grad_<name>`.
    pub gradient: bool,
    /// What its entries are.
    pub entries: Entries,
}

impl Port {
    /// An array that a VJP differentiates, or hands a cotangent over for.
    pub const fn smooth(name: &'static str, shape: &'static str, meaning: &'static str) -> Port {
        Port { name, shape, meaning, gradient: true, entries: Entries::Real }
    }

    /// An array without gradient.
    pub const fn plain(name: &'static str, shape: &'static str, meaning: &'static str) -> Port {
        Port { name, shape, meaning, gradient: false, entries: Entries::Real }
    }

    /// The same with entries of this kind.
    pub const fn of(self, entries: Entries) -> Port {
        Port { entries, ..self }
    }

    /// Whether the array `name` belongs to this port.
    pub fn covers(&self, name: &str) -> bool {
        match self.name.strip_suffix('*') {
            None => name == self.name,
            Some(stem) => name
                .strip_prefix(stem)
                .is_some_and(|number| !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit())),
        }
    }
}

/// A number in a mistake, which everybody chooses for herself: fitted where the usual one doesn't explain the answers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Number {
    /// What it is called.
    pub name: &'static str,
    /// Its value where it has been seen.
    pub usual: f64,
    /// The least and the largest that it can be.
    pub range: [f64; 2],
    /// Others that people write, where they can't be read off the answers.
    pub listed: &'static [f64],
}

/// A mistake that people really make, runnable through [`Direction::wrong`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mistake {
    /// Name, unique within the component, e.g. `inclusive_transmittance`.
    pub name: &'static str,
    /// What was written.
    pub cause: &'static str,
    /// What it does to a picture or a training.
    pub effect: &'static str,
    /// Where it has been seen, and how often.
    pub seen: &'static str,
    /// How to fix it.
    pub fix: &'static str,
    /// How often it was seen: ranks hypotheses that explain equally well.
    pub count: u32,
    /// Whether it is a mistake of the gradient alone.
    pub gradient: bool,
    /// The number in it, if it has one.
    pub number: Option<Number>,
    /// Whether right code that loses digits gives the same, so that a few answers don't tell the two apart.
    pub lost_digits: bool,
    /// Whether it leaves open what becomes of some elements: it is said by a NaN, in the place of whatever is answered there.
    pub open: bool,
}

impl Mistake {
    /// A mistake of the forward direction.
    pub const fn new(
        name: &'static str,
        cause: &'static str,
        effect: &'static str,
        fix: &'static str,
        seen: &'static str,
        count: u32,
    ) -> Mistake {
        Mistake {
            name,
            cause,
            effect,
            seen,
            fix,
            count,
            gradient: false,
            number: None,
            lost_digits: false,
            open: false,
        }
    }

    /// The same as a mistake of the gradient alone.
    pub const fn of_gradient(self) -> Mistake {
        Mistake { gradient: true, ..self }
    }

    /// The same with a number in it.
    pub const fn with(self, name: &'static str, usual: f64, range: [f64; 2]) -> Mistake {
        Mistake { number: Some(Number { name, usual, range, listed: &[] }), ..self }
    }

    /// The same with other numbers that people write.
    pub const fn or(self, listed: &'static [f64]) -> Mistake {
        let Some(number) = self.number else { panic!("a mistake with a number") };
        Mistake { number: Some(Number { listed, ..number }), ..self }
    }

    /// The same, where right code that loses digits gives what this mistake does.
    pub const fn like_lost_digits(self) -> Mistake {
        Mistake { lost_digits: true, ..self }
    }

    /// The same, where a NaN stands for whatever is answered: what wrong code gives there depends on the order of its comparisons.
    pub const fn open_where_nan(self) -> Mistake {
        Mistake { open: true, ..self }
    }

    /// The number in it where it is among the names of `wrong`: the usual one, or that of `name=number`.
    pub(crate) fn among(&self, wrong: &[&str]) -> Option<f64> {
        let usual = self.number.map_or(f64::NAN, |number| number.usual);
        wrong.iter().find_map(|name| match name.strip_prefix(self.name)? {
            "" => Some(usual),
            rest => rest.strip_prefix('=')?.parse().ok(),
        })
    }
}

/// The number in one of these mistakes where it is among the names of `wrong` ([`Mistake::among`]).
pub(crate) fn number_of(name: &str, mistakes: &[Mistake], wrong: &[&str]) -> Option<f64> {
    mistakes.iter().find(|m| m.name == name).and_then(|m| m.among(wrong))
}

/// Lists of mistakes as one: N is how many there are.
pub(crate) const fn joined<const N: usize>(lists: &[&[Mistake]]) -> [Mistake; N] {
    let mut all = [lists[0][0]; N];
    let (mut list, mut n) = (0, 0);
    while list < lists.len() {
        let mut one = 0;
        while one < lists[list].len() {
            all[n] = lists[list][one];
            (one, n) = (one + 1, n + 1);
        }
        list += 1;
    }
    assert!(n == N, "as many as there are");
    all
}

/// A function over named arrays in given conventions.
pub type Function = fn(&Arrays, &Conventions) -> Arrays;

/// How far an honest implementation may be off, element by element: arrays with the names and shapes of the outputs.
pub type Bound = fn(&Arrays, &Conventions, &Arithmetic) -> Arrays;

/// The function in emulated arithmetic, as an honest implementation might write it.
pub type Honest = fn(&Arrays, &Conventions, &Machine) -> Arrays;

/// The function with mistakes in it, by name. Without any it equals the oracle bit for bit.
pub type Wrong = fn(&Arrays, &Conventions, &[&str]) -> Arrays;

/// One row of the judging contract.
#[derive(Clone, Copy, Debug)]
pub struct Component {
    /// Name of the row, e.g. `volume_render`.
    pub name: &'static str,
    /// Its folder under `src/`.
    pub folder: &'static str,
    /// The text of its honest implementations, in which a slip of the formula is shown.
    pub code: &'static str,
    /// The formula, on a line or two.
    pub formula: &'static str,
    /// Paper and equation, or the code that defines it.
    pub source: &'static str,
    /// Input arrays.
    pub inputs: &'static [Port],
    /// Output arrays.
    pub outputs: &'static [Port],
    /// Conventions that the result depends on (keys of [`crate::convention::CHOICES`]).
    pub conventions: &'static [&'static str],
    /// The oracle, its bound and honest implementations.
    pub forward: Direction,
    /// The vector-Jacobian product: inputs and `grad_<output>` -> `grad_<input>`.
    pub vjp: Option<Direction>,
    /// Seeded and hard cases ([`super::hazard`]). Those of the VJP are the same with cotangents added.
    pub cases: fn() -> Vec<Case>,
    /// Mistakes that people make in it.
    pub mistakes: &'static [Mistake],
    /// What only a few rows need.
    pub special: Special,
}

/// One direction of a component: everything that is known about forward, or about its VJP.
#[derive(Clone, Copy, Debug)]
pub struct Direction {
    /// Plain f64.
    pub oracle: Function,
    /// Error bound.
    pub bound: Bound,
    /// Honest implementations.
    pub honest: Honest,
    /// The same with mistakes.
    pub wrong: Wrong,
}

impl Component {
    /// Inputs that a VJP differentiates.
    pub fn differentiable(&self) -> impl Iterator<Item = &Port> {
        self.inputs.iter().filter(|port| port.gradient)
    }

    /// Whether each ray or point has its own entry of this array: its first axis is the first of the first output. A gradient has the shape
    /// of what it is the gradient of.
    pub fn counts(&self, name: &str) -> bool {
        let bare = name.strip_prefix("grad_").unwrap_or(name);
        let port = self.inputs.iter().chain(self.outputs).find(|port| port.covers(bare));
        let first = port.and_then(|port| port.shape.split(',').next());
        self.letter().is_some() && first == self.letter()
    }

    /// The letter of the first axis of the first output: what the row has many of.
    pub fn letter(&self) -> Option<&'static str> {
        self.outputs[0].shape.split(',').next().filter(|letter| !letter.is_empty())
    }

    /// The port that the input array `name` belongs to.
    pub fn input_port(&self, name: &str) -> Option<&Port> {
        self.inputs.iter().find(|port| port.covers(name))
    }

    /// What the entries of the input `name` are; those of a cotangent are real.
    pub fn input_entries(&self, name: &str) -> Entries {
        self.input_port(name).map_or(Entries::Real, |port| port.entries)
    }

    /// What the entries of the output `name` are; those of a gradient are real.
    pub fn output_entries(&self, name: &str) -> Entries {
        self.outputs.iter().find(|port| port.covers(name)).map_or(Entries::Real, |port| port.entries)
    }

    /// Names of the arrays in `inputs` that a VJP differentiates, those of numbered ports one by one.
    pub fn differentiable_arrays(&self, inputs: &Arrays) -> Vec<String> {
        let smooth = |name: &&String| self.input_port(name).is_some_and(|port| port.gradient);
        inputs.keys().filter(smooth).cloned().collect()
    }
}
