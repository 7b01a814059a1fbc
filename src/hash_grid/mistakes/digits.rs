//! Numbers of ten digits and nine, typed wrongly: two that stand side by side exchanged, or one of them missing.

/// Of the second factor and of the third.
pub(super) const MISTYPED: [[f64; 19]; 2] = [mistyped(2_654_435_761, 10), mistyped(805_459_861, 9)];

/// A number's slips of so many digits; the first of them again where there are fewer than nineteen.
const fn mistyped(number: u64, digits: usize) -> [f64; 19] {
    let mut all = [(number / 10) as f64; 19];
    let (mut place, mut power) = (0, 1);
    while place < digits {
        let (above, below) = (number / power, number % power);
        all[place] = (above / 10 * power + below) as f64;
        let (one, next) = (above % 10, above / 10 % 10);
        if place + 1 < digits && one != next {
            all[digits + place] = ((above / 100 * 100 + one * 10 + next) * power + below) as f64;
        }
        (place, power) = (place + 1, power * 10);
    }
    all
}

#[cfg(test)]
mod tests {
    #[test]
    fn digits_change_places_or_are_missing() {
        let all = super::mistyped(805_459_861, 9);
        assert!(all.contains(&805_459_681.0) && all.contains(&80_545_961.0) && all.contains(&5_459_861.0));
        assert!(!all.contains(&805_459_861.0));
        assert!(super::mistyped(2_654_435_761, 10).contains(&2_654_435_716.0));
    }
}
