//! A network of any such shape, for batches of points: in f32, or in f64 for the reference.

use ndarray::{Array1, Array2, ArrayView2, Axis, LinalgScalar, concatenate};

use super::mapping::{Activation, Layout, Mapping, SkipAt};
use crate::convention::{Conventions, SkipOrder};
use crate::error::{Error, Input, Result};
use crate::field::{density, sigmoid};
use crate::files::npz::Arrays;

/// The type that a network computes in.
pub(super) trait Real: LinalgScalar + PartialOrd + Send + Sync + Into<f64> {
    /// The nearest number.
    fn of(x: f64) -> Self;
}

impl Real for f32 {
    fn of(x: f64) -> f32 {
        x as f32
    }
}

impl Real for f64 {
    fn of(x: f64) -> f64 {
        x
    }
}

/// A layer with what stands behind it.
struct Affine<A> {
    /// (in, out).
    w: Array2<A>,
    b: Array1<A>,
    activation: Activation,
}

impl<A: Real> Affine<A> {
    fn forward(&self, x: ArrayView2<A>) -> Array2<A> {
        let mut z = x.dot(&self.w) + &self.b;
        if self.activation == Activation::Relu {
            // A NaN stays one.
            z.mapv_inplace(|z| if z <= A::zero() { A::zero() } else { z });
        }
        z
    }
}

/// One network.
pub(super) struct Network<A> {
    trunk: Vec<Affine<A>>,
    skip: Option<SkipAt>,
    density: Affine<A>,
    feature: Option<Affine<A>>,
    color: Vec<Affine<A>>,
    rgb: Affine<A>,
    conventions: Conventions,
}

/// Reads the layers of one network, and remembers which arrays they were.
pub(super) struct Reader<'a> {
    /// Where they are.
    pub arrays: &'a Arrays,
    /// What they mean.
    pub mapping: &'a Mapping,
    /// What this network's names begin with.
    pub prefix: &'a str,
    /// The file, for messages.
    pub file: &'a str,
    /// Names of those that were taken.
    pub taken: Vec<String>,
}

impl Reader<'_> {
    fn layer<A: Real>(
        &mut self,
        layer: &str,
        [inputs, outputs]: [usize; 2],
        activation: Activation,
    ) -> Result<Affine<A>> {
        let names = &self.mapping.arrays;
        let (shape, out_in) = match names.layout {
            Layout::OutIn => ([outputs, inputs], true),
            Layout::InOut => ([inputs, outputs], false),
        };
        let w = self.array(&names.weight.replace("{}", layer), &shape)?;
        let w: Array2<A> = Array2::from_shape_vec(shape, w).expect("the shape was checked");
        let w = if out_in { w.t().as_standard_layout().into_owned() } else { w };
        let b = match &names.bias {
            Some(bias) => Array1::from(self.array(&bias.replace("{}", layer), &[outputs])?),
            None => Array1::from_elem(outputs, A::zero()),
        };
        Ok(Affine { w, b, activation })
    }

    /// An array by its name without the prefix; it must have this shape and finite numbers.
    fn array<A: Real>(&mut self, name: &str, shape: &[usize]) -> Result<Vec<A>> {
        let name = format!("{}{name}", self.prefix);
        let wrong = |found: String, expected: String| {
            let remedy =
                "Correct the mapping: names, depth, width, skip, levels and layout decide what is expected.";
            let field = format!("array {name}");
            Err(Error::input(Input { file: self.file, field, found, expected, remedy }))
        };
        let Some(array) = self.arrays.get(&name) else {
            let there: Vec<&str> = self.arrays.keys().map(String::as_str).take(12).collect();
            return wrong(
                format!("only [{}{}]", there.join(", "), if self.arrays.len() > 12 { ", ..." } else { "" }),
                format!("{shape:?}"),
            );
        };
        if array.shape() != shape {
            return wrong(format!("shape {:?}", array.shape()), format!("shape {shape:?}"));
        }
        let values = array.to_f64();
        if let Some(x) = values.iter().find(|x| !x.is_finite()) {
            return wrong(x.to_string(), "finite numbers".into());
        }
        self.taken.push(name);
        Ok(values.iter().map(|&x| A::of(x)).collect())
    }
}

impl<A: Real> Network<A> {
    /// The network that a mapping describes.
    ///
    /// # Errors
    /// Where an array is missing or has another shape.
    pub(super) fn read(reader: &mut Reader, conventions: Conventions) -> Result<Self> {
        let mapping = reader.mapping;
        let (position, direction) = mapping.encodings(&conventions);
        let (p, d) = (position.width(3), direction.map_or(0, |direction| direction.width(3)));
        let width = mapping.width;
        let mut trunk = vec![];
        for (n, name) in mapping.trunk().iter().enumerate() {
            let inputs = match mapping.skip {
                _ if n == 0 => p,
                Some(skip) if skip.layer == n => p + width,
                _ => width,
            };
            trunk.push(reader.layer(name, [inputs, width], mapping.behind(n))?);
        }
        let (layers, activations) = (&mapping.layers, &mapping.activations);
        let density = reader.layer(&layers.density, [width, 1], Activation::None)?;
        let feature = match &layers.feature {
            Some(name) => Some(reader.layer(name, [width, width], activations.feature)?),
            None => None,
        };
        let (mut color, mut inputs) = (vec![], width + d);
        let units = mapping.color_width.unwrap_or((width / 2).max(1));
        for name in &layers.color {
            color.push(reader.layer(name, [inputs, units], activations.color)?);
            inputs = units;
        }
        let rgb = reader.layer(&layers.rgb, [inputs, 3], Activation::None)?;
        Ok(Network { trunk, skip: mapping.skip, density, feature, color, rgb, conventions })
    }

    /// Densities and colors of points: encoded positions (M, P) and directions (M, D), row by row.
    pub(super) fn forward(
        &self,
        position: &[f64],
        direction: &[f64],
        points: usize,
    ) -> (Vec<f64>, Vec<[f64; 3]>) {
        let matrix = |flat: &[f64]| {
            let values = flat.iter().map(|&x| A::of(x)).collect();
            Array2::from_shape_vec((points, flat.len() / points), values).expect("so many rows")
        };
        let (position, direction) = (matrix(position), matrix(direction));
        let beside =
            |a: &Array2<A>, b: &Array2<A>| concatenate(Axis(1), &[a.view(), b.view()]).expect("as many rows");
        let mut hidden = position.clone();
        for (n, layer) in self.trunk.iter().enumerate() {
            hidden = match self.skip.filter(|skip| skip.layer == n).map(|skip| skip.order) {
                None => layer.forward(hidden.view()),
                Some(SkipOrder::HiddenFirst) => layer.forward(beside(&hidden, &position).view()),
                Some(SkipOrder::EncodingFirst) => layer.forward(beside(&position, &hidden).view()),
            };
        }
        let z = self.density.forward(hidden.view());
        let feature =
            self.feature.as_ref().map_or_else(|| hidden.clone(), |layer| layer.forward(hidden.view()));
        let mut color = beside(&feature, &direction);
        for layer in &self.color {
            color = layer.forward(color.view());
        }
        let rgb = self.rgb.forward(color.view());
        let sigmas = z.iter().map(|&z| density(z.into(), self.conventions.density)).collect();
        let rgbs = rgb.rows().into_iter().map(|row| [0, 1, 2].map(|k| sigmoid(row[k].into()))).collect();
        (sigmas, rgbs)
    }
}
