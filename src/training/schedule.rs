//! When a run is measured: quick probes at steps that grow by at most 5%, full validations at steps that grow by at most 25%.

/// The measuring steps of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Schedule {
    /// Full validations at exactly these steps, where validation is expensive.
    fixed: Option<&'static [u64]>,
    /// `--val-every N`.
    every: Option<u64>,
    next_probe: u64,
    next_full: u64,
}

/// The steps at which the 8x256 network is validated in full.
pub const EXPENSIVE_AT: &[u64] = &[100, 500, 1000, 2000, 4000, 5000];

impl Schedule {
    /// A schedule; `expensive` for models whose validation costs minutes.
    pub fn new(expensive: bool, every: Option<u64>) -> Self {
        Schedule { fixed: expensive.then_some(EXPENSIVE_AT), every, next_probe: 1, next_full: 1 }
    }

    /// Continues as in a run that measured up to `step`.
    pub fn skip_to(&mut self, step: u64) {
        for s in 1..=step {
            let _ = (self.probe(s), self.full(s));
        }
    }

    /// Whether `step` is probed. Steps must be passed in ascending order.
    pub fn probe(&mut self, step: u64) -> bool {
        let due = step >= self.next_probe;
        if due {
            self.next_probe = grown(step, 20);
        }
        due
    }

    /// Whether `step` is validated in full. Steps must be passed in ascending order.
    pub fn full(&mut self, step: u64) -> bool {
        if let Some(every) = self.every {
            return step.is_multiple_of(every);
        }
        if let Some(fixed) = self.fixed {
            return fixed.contains(&step);
        }
        let due = step >= self.next_full;
        if due {
            self.next_full = grown(step, 4);
        }
        due
    }
}

/// The largest step that is at most 1 + 1/`part` times as far, and at least the next one.
fn grown(step: u64, part: u64) -> u64 {
    (step + step / part).max(step + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn growth_is_bounded() {
        let mut schedule = Schedule::new(false, None);
        let (mut probes, mut fulls) = (vec![], vec![]);
        for step in 1..20_000 {
            probes.extend(schedule.probe(step).then_some(step));
            fulls.extend(schedule.full(step).then_some(step));
        }
        let bounded = |steps: &[u64], factor: f64| {
            steps.windows(2).all(|s| s[1] == s[0] + 1 || s[1] as f64 <= factor * s[0] as f64)
        };
        assert!(bounded(&probes, 1.05) && bounded(&fulls, 1.25));
        assert!(probes.len() > 150 && fulls.len() > 30, "{} {}", probes.len(), fulls.len());
    }

    #[test]
    fn dear_models_are_validated_where_the_contract_says() {
        let mut schedule = Schedule::new(true, None);
        let fulls: Vec<u64> = (1..=5000).filter(|&step| schedule.full(step)).collect();
        assert_eq!(fulls, EXPENSIVE_AT);
        let mut every = Schedule::new(true, Some(7));
        assert_eq!((1..=21).filter(|&step| every.full(step)).collect::<Vec<_>>(), [7, 14, 21]);
    }
}
