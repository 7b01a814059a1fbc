//! Front doors: a kernel with its own types, judged in a line. Each component's `judge.rs` has those of its rows.

use std::fmt;
use std::marker::PhantomData;

use ndarray::{ArrayD, Axis, stack};

use super::candidate::{Candidate, judge, judge_large};
use super::report::Report;
use super::typed::Input;
use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::{Arrays, input};
use crate::contract::check::Kind;
use crate::contract::component::{Component, Port};

/// Outputs in the contract's order, `None` where there is none.
type Answered = Vec<Option<ArrayD<f64>>>;

/// A kernel over the arrays of a whole case.
type Kernel<'a> = Box<dyn Fn(&Arrays) -> Arrays + Sync + 'a>;

/// A kernel on its way to the judge. `Row` says whose signature it has.
///
/// ```
/// use nerf_oracle::trunc_exp;
///
/// let report = trunc_exp::judge(|x: f64| x.exp()).vjp(|x, g| g * x.clamp(-15.0, 15.0).exp()).in_f32().report();
/// assert_eq!(report.exit_code(), 0, "{report}");
/// ```
#[must_use = "nothing is judged before `assert_pass` or `report`"]
pub struct Door<'a, Row> {
    component: &'static Component,
    forward: Kernel<'a>,
    vjp: Option<Kernel<'a>>,
    dtype: Dtype,
    profile: Option<String>,
    takes: Option<Vec<String>>,
    returns: Option<Vec<String>>,
    large: bool,
    row: PhantomData<fn() -> Row>,
}

impl<Row> fmt::Debug for Door<'_, Row> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let mut door = f.debug_struct("Door");
        door.field("component", &self.component.name).field("vjp", &self.vjp.is_some());
        door.field("dtype", &self.dtype).field("profile", &self.profile).finish_non_exhaustive()
    }
}

/// What a kernel is asked about: a whole case, or one ray (point) of it.
pub(crate) struct Slice<'a> {
    component: &'static Component,
    /// The arrays of the case.
    pub arrays: &'a Arrays,
    /// Which ray or point.
    item: Option<usize>,
}

impl<'a> Slice<'a> {
    /// An input in the kernel's type.
    pub(crate) fn get<T: Input<'a>>(&self, name: &str) -> T {
        let view = input(self.arrays, name).view();
        T::from_view(match self.item {
            Some(n) if self.component.counts(name) => view.index_axis_move(Axis(0), n),
            _ => view,
        })
    }
}

/// The names of the outputs in the contract's order; for a VJP those of the gradients.
fn names(component: &Component, kind: Kind, arrays: &Arrays) -> Vec<String> {
    if kind == Kind::Forward {
        return component.outputs.iter().map(|port| port.name.to_string()).collect();
    }
    let of = |port: &Port| {
        let mut names: Vec<&String> = arrays.keys().filter(|name| port.covers(name)).collect();
        // w2 before w10.
        names.sort_by_key(|name| (name.len(), name.as_str()));
        names.into_iter().map(|name| format!("grad_{name}")).collect::<Vec<_>>()
    };
    component.differentiable().flat_map(of).collect()
}

/// What a kernel returned, by name.
fn named(component: &Component, kind: Kind, arrays: &Arrays, answered: Answered) -> Arrays {
    let names = names(component, kind, arrays);
    let (most, found) = (names.len(), answered.len());
    assert!(found <= most, "{}: {found} outputs, where the contract has {most}: {names:?}", component.name);
    names.into_iter().zip(answered).filter_map(|(name, array)| Some((name, array?))).collect()
}

/// A kernel of a ray (point) on all of a case's: outputs of each are stacked, gradients of what they share added up.
fn on_each(
    component: &'static Component,
    kind: Kind,
    arrays: &Arrays,
    kernel: impl Fn(&Slice) -> Answered,
) -> Arrays {
    let counted = component.inputs.iter().find(|port| component.counts(port.name)).expect("rays or points");
    let items = input(arrays, counted.name).shape()[0];
    let answer = |n| named(component, kind, arrays, kernel(&Slice { component, arrays, item: Some(n) }));
    let answers: Vec<Arrays> = (0..items).map(answer).collect();
    let join = |name: &String| {
        let parts: Vec<_> = answers.iter().filter_map(|answer| answer.get(name)).map(|a| a.view()).collect();
        let joined = if component.counts(name) {
            stack(Axis(0), &parts).unwrap_or_else(|_| panic!("{name}: shapes that differ between items"))
        } else {
            parts.iter().skip(1).fold(parts[0].to_owned(), |sum, part| sum + part)
        };
        (name.clone(), joined)
    };
    answers.first().map(|first| first.keys().map(join).collect()).unwrap_or_default()
}

impl<'a, Row> Door<'a, Row> {
    fn new(component: &'static Component, forward: Kernel<'a>) -> Self {
        let (takes, returns) = (None, None);
        Door {
            component,
            forward,
            vjp: None,
            dtype: Dtype::F64,
            profile: None,
            takes,
            returns,
            large: false,
            row: PhantomData,
        }
    }

    /// A kernel of one ray or point.
    pub(crate) fn each(
        component: &'static Component,
        kernel: impl Fn(&Slice) -> Answered + Sync + 'a,
    ) -> Self {
        Self::new(component, Box::new(move |arrays| on_each(component, Kind::Forward, arrays, &kernel)))
    }

    /// A kernel of a whole case.
    pub(crate) fn whole(
        component: &'static Component,
        kernel: impl Fn(&Slice) -> Answered + Sync + 'a,
    ) -> Self {
        let whole = move |arrays: &Arrays| kernel(&Slice { component, arrays, item: None });
        let forward = move |arrays: &Arrays| named(component, Kind::Forward, arrays, whole(arrays));
        Self::new(component, Box::new(forward))
    }

    /// The gradient of a kernel of one ray or point.
    pub(crate) fn each_vjp(self, kernel: impl Fn(&Slice) -> Answered + Sync + 'a) -> Self {
        let component = self.component;
        let vjp = move |arrays: &Arrays| on_each(component, Kind::Vjp, arrays, &kernel);
        Door { vjp: Some(Box::new(vjp)), ..self }
    }

    /// The gradient of a kernel of a whole case.
    pub(crate) fn whole_vjp(self, kernel: impl Fn(&Slice) -> Answered + Sync + 'a) -> Self {
        let component = self.component;
        let whole = move |arrays: &Arrays| kernel(&Slice { component, arrays, item: None });
        let vjp = move |arrays: &Arrays| named(component, Kind::Vjp, arrays, whole(arrays));
        Door { vjp: Some(Box::new(vjp)), ..self }
    }

    /// Computed in f64: the default.
    pub fn in_f64(self) -> Self {
        self.in_dtype(Dtype::F64)
    }

    /// Computed in f32.
    pub fn in_f32(self) -> Self {
        self.in_dtype(Dtype::F32)
    }

    /// Computed in `dtype`: it decides the cases, and how far off an answer may be.
    pub fn in_dtype(self, dtype: Dtype) -> Self {
        Door { dtype, ..self }
    }

    /// Pins the conventions of a profile (`cs180`, `nerf2020`, ...): deviating fails. Otherwise those that are followed are found.
    pub fn profile(self, name: &str) -> Self {
        Door { profile: Some(name.into()), ..self }
    }

    /// Says which inputs the kernel looks at: cases that need others are left out and told (`&["height", "width", "focal", "c2w"]` for a
    /// center that is always the middle). Where a kernel of one number for all steps takes `step`, or one of positions `t`, see
    /// [`crate::contract::Form`].
    pub fn takes(self, inputs: &[&str]) -> Self {
        Door { takes: Some(inputs.iter().map(ToString::to_string).collect()), ..self }
    }

    /// Says which outputs the gradient goes through: the cotangents of the others are 0 (`&["colors"]` for a renderer of colors alone).
    pub fn returns(self, outputs: &[&str]) -> Self {
        Door { returns: Some(outputs.iter().map(ToString::to_string).collect()), ..self }
    }

    /// Asked large cases instead of the small ones: 100,003 rays, 10^6 + 3 parameters, a ray of 4,097 samples. What fails only there is
    /// no formula: a tail that isn't handled, a carry that a scan loses, an index of 32 bits.
    pub fn large(self) -> Self {
        Door { large: true, ..self }
    }

    /// The verdict, with what explains it. Where the kernel panics, that is the case's answer.
    ///
    /// # Panics
    /// On a profile, an input or an output that doesn't exist, and where a row without large cases is to be asked these.
    #[track_caller]
    pub fn report(&self) -> Report {
        let name = self.component.name;
        let mut candidate = Candidate::new().forward(name, &self.forward);
        if let Some(vjp) = &self.vjp {
            candidate = candidate.vjp(name, vjp);
        }
        candidate = candidate.declaring(name, self.takes.as_ref(), self.returns.as_ref());
        let profile = self.profile.as_ref();
        let pinned = match profile {
            Some(profile) => candidate.profile(profile),
            None => Ok(candidate),
        };
        let judge = if self.large { judge_large } else { judge };
        pinned.and_then(|candidate| judge(&candidate, self.dtype)).unwrap_or_else(|error| panic!("{error}"))
    }

    /// Passes, or panics with the whole report: the worst element, and the mistake that explains the numbers.
    ///
    /// # Panics
    /// Where the verdict isn't a pass, and where [`Self::report`] does.
    #[track_caller]
    pub fn assert_pass(&self) {
        let report = self.report();
        assert!(report.exit_code() == 0, "{}: {self:?}\n\n{report}", self.component.name);
    }
}

/// A front door: `each` for a kernel of one ray (point), `whole` for one of a whole case. Arguments have the names of the contract's
/// arrays; `vjp` takes the same arguments and then the gradients of the outputs.
macro_rules! front_door {
    (
        $(#[$doc:meta])*
        $how:ident $component:ident: $name:ident as $row:ident($($input:ident: $type:ty),* $(,)?);
    ) => {
        #[doc = concat!("The signature of [`", stringify!($name), "()`].")]
        #[derive(Clone, Copy, Debug)]
        pub struct $row;

        $(#[$doc])*
        ///
        /// # Panics
        /// Not here: [`report`]($crate::judge::Door::report) and [`assert_pass`]($crate::judge::Door::assert_pass) say when they do.
        pub fn $name<'a, O: $crate::judge::Outputs>(
            kernel: impl Fn($($type),*) -> O + Sync + 'a,
        ) -> $crate::judge::Door<'a, $row> {
            $crate::judge::Door::$how(&$component, move |of| kernel($(of.get(stringify!($input))),*).into_arrays())
        }
    };
    (
        $(#[$doc:meta])*
        $how:ident $component:ident: $name:ident as $row:ident($($input:ident: $type:ty),* $(,)?);
        $(#[$vjp_doc:meta])*
        $vjp:ident($($cotangent:ident: $cotangent_type:ty),* $(,)?);
    ) => {
        $crate::judge::door::front_door! {
            $(#[$doc])*
            $how $component: $name as $row($($input: $type),*);
        }

        impl<'a> $crate::judge::Door<'a, $row> {
            $(#[$vjp_doc])*
            ///
            /// # Panics
            /// Not here: [`report`](Self::report) and [`assert_pass`](Self::assert_pass) say when they do.
            pub fn vjp<O: $crate::judge::Outputs>(
                self,
                kernel: impl Fn($($type,)* $($cotangent_type),*) -> O + Sync + 'a,
            ) -> Self {
                self.$vjp(move |of| {
                    kernel($(of.get(stringify!($input)),)* $(of.get(stringify!($cotangent))),*).into_arrays()
                })
            }
        }
    };
}
pub(crate) use front_door;
