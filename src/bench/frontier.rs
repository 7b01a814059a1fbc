//! The Pareto frontier, which variants nobody beats: no other is at least as fast and at least as accurate, and better in one of the two.

/// For each (seconds, error), whether it lies on the frontier. Values that aren't finite don't take part.
///
/// ```
/// use nerf_oracle::bench::frontier::on_frontier;
/// assert_eq!(on_frontier(&[(1.0, 0.1), (2.0, 0.2), (3.0, 0.0)]), [true, false, true]);
/// ```
pub fn on_frontier(points: &[(f64, f64)]) -> Vec<bool> {
    let takes_part = |p: &(f64, f64)| p.0.is_finite() && p.1.is_finite();
    let beats = |a: &(f64, f64), b: &(f64, f64)| a.0 <= b.0 && a.1 <= b.1 && a != b;
    let one = |p: &(f64, f64)| takes_part(p) && !points.iter().any(|q| takes_part(q) && beats(q, p));
    points.iter().map(one).collect()
}
