//! Points that are found in the photographs themselves, where nothing else says how far away things are: patches of one photograph are
//! looked for in its neighbors, at all depths (Collins, "A space-sweep approach to true multi-image matching", CVPR 1996).

use std::collections::BTreeSet;

use glam::{DVec2, DVec3};

use super::cloud::image_of;
use super::{Cloud, Frame, shrunk};
use crate::camera::Camera;
use crate::parallel;
use crate::ray::camera_ray;

/// Photographs are shrunk until they have no more pixels a side than this.
const SIDE: usize = 320;
/// So many photographs are looked at, at so many places a side, with so many neighbors each.
const PHOTOS: usize = 24;
const PLACES: usize = 16;
const NEIGHBORS: usize = 6;
/// A patch has 2 REACH + 1 pixels a side.
const REACH: i32 = 3;
const PIXELS: usize = ((2 * REACH + 1) * (2 * REACH + 1)) as usize;
/// A patch whose gray values deviate by less than this from their mean says nothing.
const PLAIN: f64 = 0.02;
/// What correlates less isn't found, nor what correlates as well (but for this) elsewhere on the line.
const ALIKE: f64 = 0.8;
const DISTINCT: f64 = 0.05;
/// Neighbors that must agree on a depth.
const AGREEING: usize = 3;
/// What is found in fewer places than this, or in a smaller share of those that show something, may be chance.
const ENOUGH: usize = 100;
const SHARE: f64 = 0.1;
/// Where more than this share is too far away to measure, the points that can be measured say nothing about where the scene ends.
const BEYOND: f64 = 0.02;

/// A photograph in gray, shrunk, with its camera.
struct View {
    camera: Camera,
    gray: Vec<f32>,
    counts: Vec<bool>,
}

/// Gray values without their mean, of length 1.
type Patch = [f64; PIXELS];

/// The inverse of a depth, and what a pixel of the neighbor is worth; 0 where something is found, but too far away to say how far.
#[derive(Clone, Copy)]
struct Found {
    inverse: f64,
    pixel: f64,
}

/// What is found of one photograph in its neighbors.
#[derive(Default)]
struct Swept {
    /// Points, with their distances from this camera.
    found: Vec<(DVec3, f64)>,
    places: usize,
    beyond: usize,
}

/// What neighboring photographs agree on.
pub(super) struct Agreement {
    /// The points, and how far they are from the photographs' cameras.
    pub cloud: Cloud,
    /// The places that show something, with or without a point.
    pub places: usize,
    /// Of these, what is farther away than photographs so close to one another can tell.
    pub beyond: usize,
}

impl Agreement {
    /// Whether there are more points than chance would find, and hardly anything behind them.
    pub(super) fn trusted(&self) -> bool {
        self.enough(self.cloud.points.len()) && !self.open()
    }

    /// Whether the scene goes on behind what can be measured.
    pub(super) fn open(&self) -> bool {
        self.beyond as f64 > BEYOND * self.places as f64
    }

    /// Whether photographs that show enough don't fit their cameras.
    pub(super) fn refuted(&self) -> bool {
        let far = if self.open() { self.beyond } else { 0 };
        self.places >= ENOUGH && !self.enough(self.cloud.points.len() + far)
    }

    fn enough(&self, found: usize) -> bool {
        found >= ENOUGH && found as f64 >= SHARE * self.places as f64
    }
}

/// The points on which photographs agree, seen from cameras that stand apart and look in about the same direction.
pub(super) fn sweep(frames: &[Frame]) -> Agreement {
    let frames: Vec<&Frame> = frames.iter().filter(|frame| frame.image.is_some()).collect();
    let count = frames.len().min(PHOTOS);
    let chosen: Vec<usize> = (0..count).map(|n| n * frames.len() / count).collect();
    let beside: Vec<Vec<usize>> = chosen.iter().map(|&n| neighbors(&frames, n)).collect();
    let needed: BTreeSet<usize> = beside.iter().flatten().chain(&chosen).copied().collect();
    let views = parallel::map(frames.len(), |n| needed.contains(&n).then(|| View::of(frames[n])).flatten());

    let sweeps = parallel::map(count, |n| {
        let others: Vec<&View> = beside[n].iter().filter_map(|&other| views[other].as_ref()).collect();
        views[chosen[n]].as_ref().map_or(Swept::default(), |view| view.sweep(&others))
    });
    let (places, beyond) = (sweeps.iter().map(|s| s.places).sum(), sweeps.iter().map(|s| s.beyond).sum());
    let found: Vec<(DVec3, f64)> = sweeps.into_iter().flat_map(|swept| swept.found).collect();
    let (points, mut distances): (Vec<DVec3>, Vec<f64>) = found.into_iter().unzip();
    distances.sort_by(f64::total_cmp);
    Agreement { cloud: Cloud { points, distances, reprojection: None }, places, beyond }
}

/// Of the cameras elsewhere that look in about the same direction, the second nearest, and others that are farther away by equal factors
/// of rank: a film's next frames stand too close to measure with.
fn neighbors(frames: &[&Frame], n: usize) -> Vec<usize> {
    const TURNED: f64 = 30.0;
    let [center, axis] = stand(&frames[n].camera);
    let away = |m: usize| (stand(&frames[m].camera)[0] - center).length();
    let near =
        |m: &usize| away(*m) > 0.0 && stand(&frames[*m].camera)[1].angle_between(axis) < TURNED.to_radians();
    let mut others: Vec<usize> = (0..frames.len()).filter(near).collect();
    others.sort_by(|a, b| away(*a).total_cmp(&away(*b)));
    if others.len() <= NEIGHBORS {
        return others;
    }
    // The last is the 64th, or where there are fewer, the farthest.
    let factor = (0.5 * others.len().min(64) as f64).powf(1.0 / (NEIGHBORS - 1) as f64);
    let ranks = (0..NEIGHBORS).scan(0, |rank, n| {
        *rank = (*rank + 1).max((2.0 * factor.powi(n as i32)).round() as usize);
        Some(*rank)
    });
    ranks.map(|rank| others[rank.min(others.len()) - 1]).collect()
}

/// A camera's center and axis.
fn stand(camera: &Camera) -> [DVec3; 2] {
    [camera.c2w.w_axis.truncate(), camera.c2w.z_axis.truncate()]
}

impl View {
    fn of(frame: &Frame) -> Option<View> {
        let (width, height) = (frame.camera.width, frame.camera.height);
        let n = width.max(height).div_ceil(SIDE).min(width.min(height));
        let photo = frame.image.as_ref()?.shrunk(n);
        let counts = (0..photo.len()).map(|n| photo.mask().is_none_or(|mask| mask.counts(n))).collect();
        let gray = photo.colors().map(|[r, g, b]| (r + g + b) / 3.0).collect();
        Some(View { camera: shrunk(&frame.camera, n), gray, counts })
    }

    /// What enough neighbors agree on.
    fn sweep(&self, others: &[&View]) -> Swept {
        let mut swept = Swept::default();
        // Fewer can't agree, and can't refute anything either.
        if others.len() < AGREEING {
            return swept;
        }
        for place in 0..PLACES * PLACES {
            let at = |n: usize, size: usize| (n as f64 + 0.5) / PLACES as f64 * size as f64;
            let uv =
                DVec2::new(at(place % PLACES, self.camera.width), at(place / PLACES, self.camera.height));
            let (Some(patch), Some(rays)) = (self.patch(uv, DVec2::X, DVec2::Y), self.rays(uv)) else {
                continue;
            };
            swept.places += 1;
            let all = others.iter().filter_map(|other| self.search(other, &patch, &rays));
            let (measured, beyond): (Vec<Found>, Vec<Found>) = all.partition(|found| found.inverse > 0.0);
            if let Some(inverse) = agreed(&measured) {
                let to = rays[0] / inverse;
                swept.found.push((stand(&self.camera)[0] + to, to.length()));
            } else if beyond.len() >= AGREEING {
                swept.beyond += 1;
            }
        }
        swept
    }

    /// Directions of depth 1 through a position, and through those a pixel to the right and below.
    fn rays(&self, uv: DVec2) -> Option<[DVec3; 3]> {
        let axis = stand(&self.camera)[1];
        let ray = |uv| camera_ray(&self.camera, uv).ok().map(|ray| ray.d / ray.d.dot(axis));
        Some([ray(uv)?, ray(uv + DVec2::X)?, ray(uv + DVec2::Y)?])
    }

    /// Where a patch is found in a neighbor: depths are tried pixel by pixel of the neighbor, as far as three quarters of its picture.
    fn search(&self, other: &View, patch: &Patch, rays: &[DVec3; 3]) -> Option<Found> {
        let [center, _] = stand(&self.camera);
        let apart = (stand(&other.camera)[0] - center).length();
        let pixel = 1.0 / (apart * other.camera.k.fx.max(other.camera.k.fy));
        let w2c = other.camera.c2w.inverse();
        let (origin, rays) = (w2c.transform_point3(center), rays.map(|ray| w2c.transform_vector3(ray)));
        let alike = |n: usize| {
            // The first is as good as infinitely far away.
            let depth = 1.0 / (pixel * (n as f64).max(0.01));
            let [uv, right, below] = rays.map(|ray| image_of(&other.camera, origin + ray * depth));
            let uv = uv?;
            let found = other.patch(uv, right? - uv, below? - uv)?;
            Some(patch.iter().zip(&found).map(|(a, b)| a * b).sum::<f64>())
        };
        let most = 3 * other.camera.width.max(other.camera.height) / 4;
        let scores: Vec<f64> = (0..most).map(|n| alike(n).unwrap_or(-1.0)).collect();
        let best = (0..most).max_by(|&a, &b| scores[a].total_cmp(&scores[b]))?;
        let rival = (0..most).filter(|n| n.abs_diff(best) > 3).map(|n| scores[n]).fold(-1.0, f64::max);
        let told = scores[best] >= ALIKE && scores[best] >= rival + DISTINCT;
        // Less than two pixels apart, things are far away, but nobody can say how far.
        told.then_some(Found { inverse: if best >= 2 { best as f64 * pixel } else { 0.0 }, pixel })
    }

    /// The patch around a position whose next pixels lie `right` and `below`; `None` where it isn't whole, doesn't count or is plain.
    fn patch(&self, uv: DVec2, right: DVec2, below: DVec2) -> Option<Patch> {
        let mut patch = [0.0; PIXELS];
        let offsets =
            (-REACH..=REACH).flat_map(|j| (-REACH..=REACH).map(move |i| (f64::from(i), f64::from(j))));
        for (value, (i, j)) in patch.iter_mut().zip(offsets) {
            *value = self.value(uv + right * i + below * j)?;
        }
        let mean = patch.iter().sum::<f64>() / PIXELS as f64;
        patch.iter_mut().for_each(|value| *value -= mean);
        let length = patch.iter().map(|value| value * value).sum::<f64>().sqrt();
        patch.iter_mut().for_each(|value| *value /= length);
        (length > PLAIN * (PIXELS as f64).sqrt()).then_some(patch)
    }

    /// The gray value at a position, between those of the four pixels around it.
    fn value(&self, uv: DVec2) -> Option<f64> {
        let (corner, width, height) = ((uv - 0.5).floor(), self.camera.width, self.camera.height);
        let inside = corner.cmpge(DVec2::ZERO).all()
            && corner.x + 1.0 < width as f64
            && corner.y + 1.0 < height as f64;
        if !inside {
            return None;
        }
        let (part, n) = (uv - 0.5 - corner, corner.y as usize * width + corner.x as usize);
        let four = [n, n + 1, n + width, n + width + 1];
        if four.iter().any(|&n| !self.counts[n]) {
            return None;
        }
        let [a, b, c, d] = four.map(|n| f64::from(self.gray[n]));
        Some((1.0 - part.y) * ((1.0 - part.x) * a + part.x * b) + part.y * ((1.0 - part.x) * c + part.x * d))
    }
}

/// The inverse depth of the sharpest neighbor with which enough of them agree, itself among them.
fn agreed(all: &[Found]) -> Option<f64> {
    let agree = |a: &Found| {
        let near = |b: &&Found| (a.inverse - b.inverse).abs() <= 1.5 * a.pixel.max(b.pixel);
        all.iter().filter(near).count() >= AGREEING
    };
    let sharpest = all.iter().filter(|found| agree(found)).min_by(|a, b| a.pixel.total_cmp(&b.pixel))?;
    Some(sharpest.inverse)
}

#[cfg(test)]
mod tests {
    use glam::DMat4;

    use super::*;
    use crate::camera::Intrinsics;
    use crate::files::photo::Photo;
    use crate::scene::rays::pixel_ray;

    const NEAR: f64 = 3.0;
    const FAR: f64 = 6.0;

    /// A wall on the left, another behind it on the right, with a pattern that doesn't repeat, seen from nine places side by side;
    /// with their own cameras, or with others' of them.
    fn frames(others: bool) -> Vec<Frame> {
        before(FAR, others)
    }

    /// The same with the second wall at any distance, its pattern as large in the photographs.
    fn before(far: f64, others: bool) -> Vec<Frame> {
        let k = Intrinsics { fx: 90.0, fy: 90.0, cx: 48.0, cy: 36.0 };
        let frame = |n: usize| {
            let center = DVec3::new(0.3 * (n % 3) as f64, 0.2 * (n / 3) as f64, 0.0);
            let mut camera = Camera { width: 96, height: 72, k, c2w: DMat4::IDENTITY, distortion: None };
            camera.c2w.w_axis = center.extend(1.0);
            let gray = |p: DVec3| {
                let waves = [(7.1, 2.3, 0.4), (-3.7, 8.3, 1.7), (12.7, -5.1, 2.9), (5.3, 13.9, 0.8)];
                waves.iter().map(|(a, b, c)| (a * p.x + b * p.y + c * p.z).sin()).sum::<f64>() / 8.0 + 0.5
            };
            let color = |(j, i, _): (usize, usize, usize)| {
                let ray = pixel_ray(&camera, i, j).unwrap().unwrap();
                let at = |z: f64| ray.o + ray.d * ((z - ray.o.z) / ray.d.z);
                gray(if at(NEAR).x < 0.3 { at(NEAR) } else { at(far) * (FAR / far) }) as f32
            };
            let image = Some(Photo::fine(ndarray::Array3::from_shape_fn((72, 96, 3), color), false));
            Frame { name: n.to_string(), camera, image }
        };
        let mut frames: Vec<Frame> = (0..9).map(frame).collect();
        if others {
            let cameras: Vec<Camera> = frames.iter().map(|frame| frame.camera).collect();
            let taken = [4, 0, 7, 2, 8, 1, 6, 3, 5];
            frames.iter_mut().zip(taken).for_each(|(frame, n)| frame.camera = cameras[n]);
        }
        frames
    }

    #[test]
    fn photographs_tell_how_far_walls_are() {
        let Agreement { cloud, places, beyond } = sweep(&frames(false));
        assert!(10 * cloud.points.len() > 3 * places, "{} of {places}", cloud.points.len());
        assert!(50 * beyond < places, "{beyond} of {places}");
        let (near, far): (Vec<_>, Vec<_>) = cloud.points.iter().map(|p| p.z).partition(|z| *z < 4.2);
        for (depths, wall) in [(near, NEAR), (far, FAR)] {
            assert!(depths.len() > 50, "{wall}: {}", depths.len());
            let right = depths.iter().filter(|z| (*z / wall - 1.0).abs() < 0.1).count();
            assert!(20 * right >= 19 * depths.len(), "{wall}: {right} of {} are right", depths.len());
        }
    }

    /// 0.6 apart, photographs of 90 pixels to the depth can tell 27 away, and not 600.
    #[test]
    fn what_is_too_far_away_to_measure_keeps_the_scene_open() {
        let far = sweep(&before(600.0, false));
        assert!(far.cloud.points.len() > ENOUGH, "the wall in front is found: {}", far.cloud.points.len());
        assert!(far.open() && !far.trusted() && !far.refuted(), "{} of {}", far.beyond, far.places);
        assert!(sweep(&frames(false)).trusted());
    }

    #[test]
    fn photographs_that_do_not_fit_their_cameras_tell_nothing() {
        let others = sweep(&frames(true));
        assert!(others.refuted() && !others.trusted(), "{} of {}", others.cloud.points.len(), others.places);
        let plain = |mut frame: Frame| {
            frame.image = Some(Photo::opaque(72, 96, vec![[90; 3]; 72 * 96]));
            frame
        };
        let nothing = [
            sweep(&frames(false).into_iter().map(plain).collect::<Vec<_>>()),
            sweep(&[]),
            sweep(&frames(true)[..AGREEING]),
        ];
        assert!(nothing.iter().all(|sweep| sweep.places == 0 && !sweep.trusted() && !sweep.refuted()));
    }
}
