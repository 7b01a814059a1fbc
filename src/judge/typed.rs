//! Between named arrays and a kernel's own types: numbers, slices, rows of three, ndarray's views.

use ndarray::{
    Array, ArrayD, ArrayView1, ArrayView2, ArrayView3, ArrayView4, ArrayViewD, Dimension, Ix1, Ix2, Ix3, Ix4,
    IxDyn,
};

/// What a kernel may take: a view of an array of the contract as its own type.
pub trait Input<'a>: Sized {
    /// The array in this type.
    ///
    /// # Panics
    /// Where the array has other dimensions: a front door that asks for the wrong type is wrong on every case.
    fn from_view(view: ArrayViewD<'a, f64>) -> Self;
}

fn scalar(view: &ArrayViewD<f64>) -> f64 {
    assert_eq!(view.len(), 1, "a scalar");
    *view.first().expect("one entry")
}

impl Input<'_> for f64 {
    fn from_view(view: ArrayViewD<f64>) -> f64 {
        scalar(&view)
    }
}

impl Input<'_> for usize {
    fn from_view(view: ArrayViewD<f64>) -> usize {
        scalar(&view) as usize
    }
}

impl Input<'_> for Vec<usize> {
    fn from_view(view: ArrayViewD<f64>) -> Vec<usize> {
        view.iter().map(|&x| x as usize).collect()
    }
}

impl<'a> Input<'a> for &'a [f64] {
    fn from_view(view: ArrayViewD<'a, f64>) -> &'a [f64] {
        view.to_slice().expect("arrays of the contract are row-major")
    }
}

impl<'a, const N: usize> Input<'a> for &'a [[f64; N]] {
    fn from_view(view: ArrayViewD<'a, f64>) -> &'a [[f64; N]] {
        let (rows, rest) = <&[f64]>::from_view(view).as_chunks();
        assert!(rest.is_empty(), "rows of {N}");
        rows
    }
}

impl<const N: usize> Input<'_> for [f64; N] {
    fn from_view(view: ArrayViewD<f64>) -> [f64; N] {
        <&[f64]>::from_view(view).try_into().expect("as many numbers as the contract says")
    }
}

impl<const N: usize, const M: usize> Input<'_> for [[f64; N]; M] {
    fn from_view(view: ArrayViewD<f64>) -> [[f64; N]; M] {
        <&[[f64; N]]>::from_view(view).try_into().expect("as many rows as the contract says")
    }
}

impl<'a> Input<'a> for ArrayViewD<'a, f64> {
    fn from_view(view: ArrayViewD<'a, f64>) -> Self {
        view
    }
}

impl<'a> Input<'a> for ArrayView1<'a, f64> {
    fn from_view(view: ArrayViewD<'a, f64>) -> Self {
        view.into_dimensionality::<Ix1>().expect("one axis")
    }
}

impl<'a> Input<'a> for ArrayView2<'a, f64> {
    fn from_view(view: ArrayViewD<'a, f64>) -> Self {
        view.into_dimensionality::<Ix2>().expect("two axes")
    }
}

impl<'a> Input<'a> for ArrayView3<'a, f64> {
    fn from_view(view: ArrayViewD<'a, f64>) -> Self {
        view.into_dimensionality::<Ix3>().expect("three axes")
    }
}

impl<'a> Input<'a> for ArrayView4<'a, f64> {
    fn from_view(view: ArrayViewD<'a, f64>) -> Self {
        view.into_dimensionality::<Ix4>().expect("four axes")
    }
}

/// A number, or so many of them in a row: what arrays are made of.
pub trait Element {
    /// The shape, from the outside in.
    const SHAPE: &'static [usize];

    /// The numbers at the end of `out`.
    fn push(&self, out: &mut Vec<f64>);
}

/// A number in f64, which holds all of these exactly.
fn number<T: Copy + TryInto<f64>>(x: T) -> f64 {
    x.try_into().unwrap_or_else(|_| unreachable!("f64 holds it"))
}

macro_rules! numbers {
    ($($type:ty),*) => { $(
        impl Element for $type {
            const SHAPE: &'static [usize] = &[];

            fn push(&self, out: &mut Vec<f64>) {
                out.push(number(*self));
            }
        }
    )* };
}

numbers!(f32, f64, u8, u32, i32, bool);

impl Element for usize {
    const SHAPE: &'static [usize] = &[];

    fn push(&self, out: &mut Vec<f64>) {
        out.push(*self as f64);
    }
}

impl<T: Element, const N: usize> Element for [T; N] {
    const SHAPE: &'static [usize] = match T::SHAPE {
        [] => &[N],
        [a] => &[N, *a],
        _ => panic!("at most two axes in an element"),
    };

    fn push(&self, out: &mut Vec<f64>) {
        self.iter().for_each(|x| x.push(out));
    }
}

/// What a kernel may return for one output: a number, an array, a vector of them, an ndarray; `()` or `None` for an output that it
/// doesn't have.
pub trait Output {
    /// As an array of the contract.
    fn into_array(self) -> Option<ArrayD<f64>>;
}

fn packed<E: Element>(outer: &[usize], elements: &[E]) -> Option<ArrayD<f64>> {
    let mut numbers = vec![];
    elements.iter().for_each(|x| x.push(&mut numbers));
    let shape = [outer, E::SHAPE].concat();
    Some(ArrayD::from_shape_vec(IxDyn(&shape), numbers).expect("the elements fill their shape"))
}

impl<E: Element> Output for E {
    fn into_array(self) -> Option<ArrayD<f64>> {
        packed(&[], &[self])
    }
}

impl<E: Element> Output for Vec<E> {
    fn into_array(self) -> Option<ArrayD<f64>> {
        packed(&[self.len()], &self)
    }
}

impl<E: Element, D: Dimension> Output for Array<E, D> {
    fn into_array(self) -> Option<ArrayD<f64>> {
        let shape = self.shape().to_vec();
        packed(&shape, &self.into_iter().collect::<Vec<E>>())
    }
}

impl<T: Output> Output for Option<T> {
    fn into_array(self) -> Option<ArrayD<f64>> {
        self.and_then(T::into_array)
    }
}

impl Output for () {
    fn into_array(self) -> Option<ArrayD<f64>> {
        None
    }
}

/// What a kernel may return: one output, or a tuple of them in the contract's order. Those behind the last one aren't judged.
pub trait Outputs {
    /// As arrays of the contract, in its order.
    fn into_arrays(self) -> Vec<Option<ArrayD<f64>>>;
}

impl<T: Output> Outputs for T {
    fn into_arrays(self) -> Vec<Option<ArrayD<f64>>> {
        vec![self.into_array()]
    }
}

macro_rules! tuples {
    ($(($($type:ident $n:tt),*))*) => { $(
        impl<$($type: Output),*> Outputs for ($($type,)*) {
            fn into_arrays(self) -> Vec<Option<ArrayD<f64>>> {
                vec![$(self.$n.into_array()),*]
            }
        }
    )* };
}

tuples! {
    (A 0)
    (A 0, B 1)
    (A 0, B 1, C 2)
    (A 0, B 1, C 2, D 3)
    (A 0, B 1, C 2, D 3, E 4)
    (A 0, B 1, C 2, D 3, E 4, F 5)
    (A 0, B 1, C 2, D 3, E 4, F 5, G 6)
}
