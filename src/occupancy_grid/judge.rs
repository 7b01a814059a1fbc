//! Somebody's occupancy grid, judged. Cells have the index [z, y, x].

use ndarray::ArrayView3;

use super::component::{GRID_TRAVERSAL, OCCUPANCY_GRID};
use crate::judge::door::front_door;

front_door! {
    /// Judges an update with the queries after it: (density, points, sigmas, queries, decay, threshold)
    /// -> (density_out, occupied, found).
    ///
    /// ```
    /// use nerf_oracle::occupancy_grid;
    /// occupancy_grid::judge(|density, points, sigmas, _, decay, threshold| {
    ///     // As instant-ngp has it: every cell fades that a camera sees.
    ///     let g = density.dim().0;
    ///     let mut out = density.mapv(|x| if x < 0.0 { x } else { decay * x });
    ///     for (p, &sigma) in points.iter().zip(sigmas) {
    ///         let [x, y, z] = p.map(|x| ((x * g as f64) as usize).min(g - 1));
    ///         if density[[z, y, x]] >= 0.0 {
    ///             out[[z, y, x]] = sigma.max(out[[z, y, x]]);
    ///         }
    ///     }
    ///     let occupied = out.mapv(|x| x > threshold);
    ///     (out, occupied)
    /// })
    /// .assert_pass();
    /// ```
    whole OCCUPANCY_GRID: judge as Grid(
        density: ArrayView3<f64>,
        points: &[[f64; 3]],
        sigmas: &[f64],
        queries: &[[f64; 3]],
        decay: f64,
        threshold: f64,
    );
}

front_door! {
    /// Judges the way of one ray through the cells of the unit box: (origin, direction, near, far, resolution)
    /// -> (lengths (G, G, G), visited).
    ///
    /// ```
    /// use nerf_oracle::ndarray::Array3;
    /// use nerf_oracle::occupancy_grid::{OccupancyGrid, judge};
    /// judge::grid_traversal(|o, d, near, far, g| {
    ///     let grid = OccupancyGrid { resolution: g, density: vec![0.0; g * g * g], threshold: 0.0 };
    ///     let mut lengths = Array3::<f64>::zeros((g, g, g));
    ///     for crossing in grid.crossings(o, d, near, far) {
    ///         lengths.as_slice_mut().unwrap()[crossing.cell] += crossing.leave - crossing.enter;
    ///     }
    ///     let visited = lengths.iter().filter(|&&length| length > 0.0).count();
    ///     (lengths, visited)
    /// })
    /// .assert_pass();
    /// ```
    each GRID_TRAVERSAL: grid_traversal as Ray(
        rays_o: [f64; 3],
        rays_d: [f64; 3],
        near: f64,
        far: f64,
        resolution: usize,
    );
}
