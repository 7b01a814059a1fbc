//! Variants of the occupancy grid's traversal for `bench`: rays through a ball in 128^3 cells, 512 steps across the box.

use pulp::Arch;

use crate::bench::{Kernel, Scaling, Suite, Tolerance, Variant, kernel, singles, uniform};
use crate::contract::arrays::{Arrays, array, arrays, values};
use crate::occupancy_grid::OccupancyGrid;
use crate::occupancy_grid::fast::{MarchRay, Occupancy, Steps, ray_box};
use crate::{parallel, ray_aabb};

const RESOLUTION: usize = 128;
/// Length of a step, in units of the box.
const STEP: f64 = 1.0 / 512.0;
/// Rays of a task.
const TASK: usize = 256;
/// Share of the cells that the ball of the suite fills.
const SHARE: f64 = 0.05;

/// Rays from outside toward points of the unit box, directions of length 1.
fn workload(items: usize) -> Arrays {
    let (from, to) = (uniform(13, 3 * items, -1.0, 1.0), uniform(14, 3 * items, 0.0, 1.0));
    let (mut o, mut d) = (vec![], vec![]);
    for (from, to) in from.as_chunks::<3>().0.iter().zip(to.as_chunks::<3>().0) {
        let length = from.iter().map(|x| x * x).sum::<f64>().sqrt().max(1e-3);
        let origin = from.map(|x| f64::from((0.5 + 2.0 * x / length) as f32));
        let toward: [f64; 3] = std::array::from_fn(|a| to[a] - origin[a]);
        let length = toward.iter().map(|x| x * x).sum::<f64>().sqrt();
        o.extend(origin);
        d.extend(toward.map(|x| f64::from((x / length) as f32)));
    }
    arrays([("o", array(&[items, 3], o)), ("d", array(&[items, 3], d))])
}

/// A ball in the middle that fills `share` of the box: density 1 in cells whose middle lies in it, else 0.
fn densities(resolution: usize, share: f64) -> Vec<f64> {
    let radius = (share * 0.75 / std::f64::consts::PI).cbrt();
    let r = resolution as f64;
    let inside = |i: usize| {
        let at = [i % resolution, i / resolution % resolution, i / resolution / resolution];
        let off = at.map(|n| (n as f64 + 0.5) / r - 0.5);
        f64::from(u8::from(off.iter().map(|x| x * x).sum::<f64>() < radius * radius))
    };
    (0..resolution.pow(3)).map(inside).collect()
}

fn grid(resolution: usize, share: f64) -> Occupancy {
    let mut grid = Occupancy::full(resolution);
    grid.density = densities(resolution, share).iter().map(|&x| x as f32).collect();
    grid.apply_threshold(0.5);
    grid
}

/// `count(o, d)` samples of every ray.
fn counts<T: Copy + Send + Sync + 'static>(
    rays: Vec<([T; 3], [T; 3])>,
    bytes: usize,
    threads: bool,
    count: impl Fn(&[([T; 3], [T; 3])], &mut [f64]) + Sync + Send + 'static,
) -> Box<dyn Kernel> {
    let out = vec![0f64; rays.len()];
    let bytes = bytes + size_of_val(&rays[..]) + size_of_val(&out[..]);
    type Data<T> = (Vec<([T; 3], [T; 3])>, Vec<f64>);
    let run = move |(rays, out): &mut Data<T>| {
        if threads {
            parallel::for_chunks(out, TASK, |n, out| count(&rays[n * TASK..][..out.len()], out));
        } else {
            count(rays, out);
        }
    };
    kernel((rays, out), bytes, run, |(_, out)| arrays([("samples", array(&[out.len()], out.clone()))]))
}

fn oracle(a: &Arrays) -> Box<dyn Kernel> {
    let grid =
        OccupancyGrid { resolution: RESOLUTION, density: densities(RESOLUTION, SHARE), threshold: 0.5 };
    let (o, d) = (values(a, "o"), values(a, "d"));
    let rays = o.as_chunks::<3>().0.iter().copied().zip(d.as_chunks::<3>().0.iter().copied()).collect();
    counts(rays, 8 * grid.density.len(), false, move |rays, out| {
        for ((o, d), out) in rays.iter().zip(out) {
            let hit = ray_aabb::intersect(*o, *d, [0.0; 3], [1.0; 3]);
            *out = hit.map_or(0.0, |hit| {
                grid.samples(*o, *d, hit.enter.max(0.0), hit.leave, STEP, 0.5).len() as f64
            });
        }
    })
}

fn narrow(a: &Arrays) -> Vec<([f32; 3], [f32; 3])> {
    let (o, d) = (singles(a, "o"), singles(a, "d"));
    o.as_chunks::<3>().0.iter().copied().zip(d.as_chunks::<3>().0.iter().copied()).collect()
}

/// Every step of the ray is looked up.
fn plain(a: &Arrays) -> Box<dyn Kernel> {
    let density: Vec<f32> = densities(RESOLUTION, SHARE).iter().map(|&x| x as f32).collect();
    counts(narrow(a), 4 * density.len(), false, move |rays, out| {
        let step = STEP as f32;
        let along = |x: f32| ((x * RESOLUTION as f32) as usize).min(RESOLUTION - 1);
        for ((o, d), out) in rays.iter().zip(out) {
            let (enter, leave) = ray_box(*o, *d);
            let (mut k, mut samples) = ((enter.max(0.0) / step - 0.5).ceil(), 0);
            while (k + 0.5) * step < leave {
                let t = (k + 0.5) * step;
                let [x, y, z] = [0, 1, 2].map(|a| along(o[a] + t * d[a]));
                samples += usize::from(density[(z * RESOLUTION + y) * RESOLUTION + x] > 0.5);
                k += 1.0;
            }
            *out = samples as f64;
        }
    })
}

/// Rays of a call: while there are more, no lane is idle.
const TOGETHER: usize = 128;

/// Counts the samples of some rays, and computes the position of each.
fn walk(arch: Arch, grid: &Occupancy, rays: &[([f32; 3], [f32; 3])], out: &mut [f64]) {
    let mut steps = Steps::default();
    for (rays, out) in rays.chunks(TOGETHER).zip(out.chunks_mut(TOGETHER)) {
        let march_ray = |&(o, d): &([f32; 3], [f32; 3])| {
            let (enter, leave) = grid.span(o, d);
            MarchRay { o, d, near: enter.max(0.0), far: leave, u: 0.5, patience: u32::MAX }
        };
        let march_rays: Vec<MarchRay> = rays.iter().map(march_ray).collect();
        grid.march(arch, &march_rays, STEP as f32, &mut steps);
        for (ray, (march_ray, out)) in march_rays.iter().zip(out).enumerate() {
            *out = steps.of(ray).len() as f64;
            steps.of(ray).iter().for_each(|&k| {
                std::hint::black_box(march_ray.at(k, STEP as f32));
            });
        }
    }
}

fn skipping(a: &Arrays, grid: Occupancy, threads: bool) -> Box<dyn Kernel> {
    let arch = crate::simd::arch();
    let bytes = 16 * grid.bits()[0].len();
    counts(narrow(a), bytes, threads, move |rays, out| walk(arch, &grid, rays, out))
}

/// A coarser grid, occupied wherever one of its cells' parts is: nothing is missed, more cells are sampled.
fn coarse(a: &Arrays, resolution: usize) -> Box<dyn Kernel> {
    let (fine, n) = (densities(RESOLUTION, SHARE), RESOLUTION / resolution);
    let mut grid = Occupancy::full(resolution);
    for (i, density) in fine.iter().enumerate() {
        let [x, y, z] = [i % RESOLUTION, i / RESOLUTION % RESOLUTION, i / RESOLUTION / RESOLUTION];
        let at = (z / n * resolution + y / n) * resolution + x / n;
        grid.density[at] = grid.density[at].max(*density as f32);
    }
    grid.apply_threshold(0.5);
    skipping(a, grid, true)
}

/// A sample within rounding of a face may fall on either side; a ray through the ball's stairs grazes a few faces at most.
const F32: Tolerance = Tolerance::exact().within(3.0);

/// A coarse cell with a part of the ball in it lies within the ball's radius R = 0.2285 and its own diagonal h; cells of the fine grid
/// contain everything within R minus half their diagonal. The longest path of a ray between the two spheres, 2 sqrt((R + h)^2 - (R -
/// 0.0068)^2), is so many steps.
const COARSE: [Tolerance; 2] =
    [Tolerance::exact().within(3.0 + 131.0), Tolerance::exact().within(3.0 + 180.0)];

/// The traversal's suite.
pub(crate) const SUITE: Suite = Suite {
    component: "occupancy_grid",
    judged: false,
    item: "ray",
    workload,
    items: 1 << 14,
    checked: 1 << 11,
    oracle,
    variants: &[
        Variant::f32("plain_f32", "one thread, every step is looked up", F32, plain),
        Variant::f32(
            "skipping",
            "one thread, 16 rays side by side over bits, past empty cells, bricks of 4^3 and blocks of 16^3",
            F32,
            |a| skipping(a, grid(RESOLUTION, SHARE), false),
        ),
        Variant::f32("threaded", "the same on all threads", F32, |a| {
            skipping(a, grid(RESOLUTION, SHARE), true)
        }),
        Variant::f32(
            "coarse_64",
            "threaded, 64^3 cells, occupied where any part is: more samples",
            COARSE[0],
            |a| coarse(a, 64),
        ),
        Variant::f32("coarse_32", "threaded, 32^3 cells", COARSE[1], |a| coarse(a, 32)),
    ],
};

/// Time and memory against occupied share and resolution.
pub(crate) const SCALING: &[Scaling] = &[
    Scaling {
        component: "occupancy_grid",
        parameter: "occupied fraction",
        about: "threaded, a ball in 128^3 cells, 8,192 rays; the samples themselves grow with the share's 2/3rd power or more",
        values: &[0.002, 0.008, 0.032, 0.128, 0.4],
        prepare: |share| skipping(&workload(8192), grid(RESOLUTION, share), true),
        memory: false,
    },
    Scaling {
        component: "occupancy_grid",
        parameter: "grid resolution",
        about: "threaded, a ball of 5%, 8,192 rays, against cells along an edge: a volume's cells grow with the cube",
        values: &[16.0, 32.0, 64.0, 128.0, 256.0],
        prepare: |resolution| skipping(&workload(8192), grid(resolution as usize, SHARE), true),
        memory: true,
    },
    Scaling {
        component: "occupancy_grid",
        parameter: "rays",
        about: "threaded, a ball of 5% in 128^3 cells",
        values: &[2048.0, 4096.0, 8192.0, 16384.0, 32768.0],
        prepare: |rays| skipping(&workload(rays as usize), grid(RESOLUTION, SHARE), true),
        memory: false,
    },
];
