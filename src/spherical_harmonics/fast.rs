//! f32 harmonics of bands 0 to 3, common products shared.

/// Bands 0 to 3.
pub const WIDTH: usize = 16;

/// The 16 harmonics of bands 0 to 3 of a unit direction.
#[inline(always)]
pub fn harmonics([x, y, z]: [f32; 3]) -> [f32; WIDTH] {
    let (xx, yy, zz) = (x * x, y * y, z * z);
    [
        0.282_094_8,
        -0.488_602_5 * y,
        0.488_602_5 * z,
        -0.488_602_5 * x,
        1.092_548_5 * x * y,
        -1.092_548_5 * y * z,
        0.946_174_7 * zz - 0.315_391_57,
        -1.092_548_5 * x * z,
        0.546_274_24 * (xx - yy),
        0.590_043_6 * y * (-3.0 * xx + yy),
        2.890_611_4 * x * y * z,
        0.457_045_8 * y * (1.0 - 5.0 * zz),
        0.373_176_34 * z * (5.0 * zz - 3.0),
        0.457_045_8 * x * (1.0 - 5.0 * zz),
        1.445_305_7 * z * (xx - yy),
        0.590_043_6 * x * (-xx + 3.0 * yy),
    ]
}

#[cfg(test)]
mod tests;
