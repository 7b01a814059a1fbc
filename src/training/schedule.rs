//! When a run is measured: quick probes at steps that grow by at most 5%, full validations at the steps that are asked for.

/// The measuring steps of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Schedule {
    /// `--val-every N`.
    every: Option<u64>,
    /// `--val-at A,B`.
    at: Vec<u64>,
    next_probe: u64,
}

/// Pixels of the first probes, and the most of a later one.
const PIXELS: [u64; 2] = [256, MOST as u64];

/// The most pixels of a probe.
pub const MOST: usize = 1 << 14;

impl Schedule {
    /// A schedule with full validations every so many steps, and at some.
    pub fn new(every: Option<u64>, at: &[u64]) -> Self {
        Schedule { every, at: at.to_vec(), next_probe: 1 }
    }

    /// Stands where a run that measured up to `step` stood.
    pub fn skip_to(&mut self, step: u64) {
        while self.next_probe <= step {
            self.probe(self.next_probe);
        }
    }

    /// How many pixels are probed at `step`, if it is due: two a step, so that a probe costs about a twentieth of the steps up to the
    /// next. Depends on the step alone, as a resumed run's log has to have the same figures. Steps must be asked in ascending order.
    pub fn probe(&mut self, step: u64) -> Option<usize> {
        let due = step >= self.next_probe;
        if due {
            self.next_probe = (step + step / 20).max(step + 1);
        }
        due.then_some(Self::pixels(step))
    }

    /// Pixels of a probe at `step`.
    pub fn pixels(step: u64) -> usize {
        (2 * step).clamp(PIXELS[0], PIXELS[1]) as usize
    }

    /// Whether a full validation was asked for at `step`.
    pub fn full(&self, step: u64) -> bool {
        self.every.is_some_and(|every| step.is_multiple_of(every)) || self.at.contains(&step)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probes_grow_slowly_in_step_and_size() {
        let mut schedule = Schedule::new(None, &[]);
        let probes: Vec<(u64, usize)> =
            (1..20_000).filter_map(|step| Some((step, schedule.probe(step)?))).collect();
        let slow = |a: u64, b: u64| b == a + 1 || b as f64 <= 1.05 * a as f64;
        assert!(
            probes.windows(2).all(|two| slow(two[0].0, two[1].0)) && probes.len() > 150,
            "{}",
            probes.len()
        );
        assert!(probes.windows(2).all(|two| two[0].1 <= two[1].1));
        assert_eq!((probes[0], probes.last().unwrap().1), ((1, 256), MOST));
        // From where a run stood, the same.
        let mut resumed = Schedule::new(None, &[]);
        resumed.skip_to(1000);
        let rest: Vec<u64> = (1001..20_000).filter(|&step| resumed.probe(step).is_some()).collect();
        assert!(probes.iter().map(|p| p.0).filter(|&step| step > 1000).eq(rest));
    }

    #[test]
    fn full_validations_come_where_they_are_asked_for() {
        let fulls = |schedule: Schedule| (1..=30).filter(|&step| schedule.full(step)).collect::<Vec<_>>();
        assert!(fulls(Schedule::new(None, &[])).is_empty());
        assert_eq!(fulls(Schedule::new(Some(7), &[5, 14])), [5, 7, 14, 21, 28]);
    }
}
