//! Honest opacities of splats: the exponent by three terms, halved apart or together, or as a product with the conic's matrix; gradients
//! by either.

use super::arrays::{form, forward, vjp};
use super::{Form, Splat};
use crate::contract::arrays::Arrays;
use crate::contract::machine::Machine;
use crate::contract::operations::Operations;
use crate::convention::{AlphaCap, CapGradient, ConicGradient, Conventions, Faint, PositivePower};

/// The number of ways to an opacity.
pub(super) const WAYS: u64 = 3;

/// A splat at a pixel in some arithmetic.
pub(super) struct Seen<'a, O: Operations> {
    o: &'a O,
    form: Form,
    d: [O::Number; 2],
    conic: [O::Number; 3],
    power: O::Number,
    /// e^power.
    gaussian: O::Number,
    /// Before it is cut.
    alpha: O::Number,
}

impl<'a, O: Operations> Seen<'a, O> {
    pub(super) fn new(o: &'a O, pixel: [f64; 2], splat: &Splat, form: Form, way: u64) -> Self {
        let d = [0, 1].map(|k| o.sub(o.exact(pixel[k]), o.exact(splat.mean[k])));
        let conic = splat.conic.map(|x| o.exact(x));
        let ([x, y], [a, b, c]) = (d, conic);
        let squares = [o.mul(o.mul(a, x), x), o.mul(o.mul(c, y), y)];
        let cross = o.mul(o.mul(b, x), y);
        let power = match way % WAYS {
            0 => o.sub(o.times(-0.5, o.add(squares[0], squares[1])), cross),
            1 => o.neg(o.add(o.times(0.5, o.add(squares[0], squares[1])), cross)),
            _ => {
                let rows = [o.dot(&[a, b], &d), o.dot(&[b, c], &d)];
                o.times(-0.5, o.dot(&d, &rows))
            }
        };
        let gaussian = o.exp(power);
        let alpha = o.mul(o.exact(splat.opacity), gaussian);
        Seen { o, form, d, conic, power, gaussian, alpha }
    }

    fn capped(&self) -> O::Number {
        match self.form.cap {
            AlphaCap::None => self.alpha,
            cap => self.o.min(self.alpha, self.o.hyper(cap.value())),
        }
    }

    /// x where the splat is seen at all, else 0.
    fn seen(&self, x: O::Number) -> O::Number {
        let (o, mut x) = (self.o, x);
        if self.form.faint == Faint::Skipped {
            x = o.above(self.capped(), o.hyper(1.0 / 255.0), x);
        }
        // In its middle the exponent is 0, exactly, and not above it.
        if self.form.power == PositivePower::Skipped && self.d.iter().any(|&d| !o.is_zero(d)) {
            x = o.above(o.exact(0.0), self.power, x);
        }
        x
    }

    pub(super) fn opacity(&self) -> O::Number {
        self.seen(self.capped())
    }

    /// Gradients of mean, conic and opacity.
    pub(super) fn gradients(&self, g: f64) -> [O::Number; 6] {
        let (o, g, [x, y], [a, b, c]) = (self.o, self.o.exact(g), self.d, self.conic);
        let through = |x: O::Number| {
            let stops = self.form.cap != AlphaCap::None && self.form.cap_gradient == CapGradient::Stopped;
            self.seen(if stops { o.above(o.hyper(self.form.cap.value()), self.alpha, x) } else { x })
        };
        let g_power = o.mul(g, self.alpha);
        let square = |x: O::Number| o.times(-0.5, o.mul(o.mul(g_power, x), x));
        let once = if self.form.conic_gradient == ConicGradient::Entry { -0.5 } else { -1.0 };
        [
            o.mul(g_power, o.dot(&[a, b], &[x, y])),
            o.mul(g_power, o.dot(&[b, c], &[x, y])),
            square(x),
            o.times(once, o.mul(o.mul(g_power, x), y)),
            square(y),
            o.mul(g, self.gaussian),
        ]
        .map(through)
    }
}

/// Which way a machine takes.
fn way(m: &Machine) -> u64 {
    2 * m.form + u64::from(m.stable)
}

/// Opacities.
pub(crate) fn alpha(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    forward(a, |pixel, splat| Seen::new(m, pixel, splat, form(c), way(m)).opacity())
}

/// Their gradients.
pub(crate) fn alpha_vjp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    vjp(a, |pixel, splat, g| Seen::new(m, pixel, splat, form(c), way(m)).gradients(g), |parts| m.sum(parts))
}
