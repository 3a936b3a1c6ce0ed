//! What was done to a draft, in words.

/// Between two of them.
const AND: &str = ", ";
/// The end of what is said of a number that was set.
const SET: &str = " set";
/// The end of what is said of a number that fits may change again.
const FREE: &str = " to be fitted";
/// Before the value of a number that is held.
const HELD: &str = " held at ";
/// Digits of a value in words, as the page shows them.
const DIGITS: usize = 7;

/// A number in words.
pub fn named(effect: &str, parameter: &str) -> String {
    format!("{parameter} of {effect}")
}

/// That a number was set.
pub fn set(effect: &str, parameter: &str) -> String {
    named(effect, parameter) + SET
}

/// That a number is held in fits at its value.
pub fn held(effect: &str, parameter: &str, value: f64) -> String {
    let short: f64 = format!("{value:.0$e}", DIGITS - 1).parse().unwrap_or(value);
    format!("{}{HELD}{short}", named(effect, parameter))
}

/// That fits may change a number again.
pub fn free(effect: &str, parameter: &str) -> String {
    named(effect, parameter) + FREE
}

/// All that was done since the step, after something more. The last word on a number counts; a number that was only set is not told of
/// behind other things.
pub fn after(before: &str, more: &str) -> String {
    let own = number(more);
    let mut told: Vec<&str> = clauses(before).filter(|clause| own.is_none() || number(clause) != own).collect();
    if more.ends_with(SET) {
        while told.last().is_some_and(|clause| clause.ends_with(SET)) {
            told.pop();
        }
    }
    if told.is_empty() || !more.ends_with(SET) {
        told.push(more);
    }
    told.join(AND)
}

/// The same once it is fitted, after `released`, the number that an earlier fit held, was freed: of that one nothing is told any more, and
/// `held` is what is said of the number that this fit holds.
pub fn fitted(before: &str, released: Option<&str>, held: Option<&str>) -> String {
    let gone = [released, held.and_then(number)];
    let lasting = clauses(before).filter(|clause| number(clause).is_none_or(|own| !gone.contains(&Some(own))));
    let told: Vec<&str> = lasting.chain(held).collect();
    if told.is_empty() { "fitted anew".into() } else { told.join(AND) }
}

fn clauses(words: &str) -> impl Iterator<Item = &str> {
    words.split(AND).filter(|clause| !clause.is_empty())
}

/// The number that was set, held or freed, as [`named`].
fn number(clause: &str) -> Option<&str> {
    let before_value = clause.split_once(HELD).map(|(number, _)| number);
    before_value.or_else(|| clause.strip_suffix(SET)).or_else(|| clause.strip_suffix(FREE))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_word_on_a_number_counts() {
        let set = set("wheelbase", "e_b");
        assert_eq!(after("", &set), "e_b of wheelbase set");
        assert_eq!(after("+ crab", &set), "+ crab");
        assert_eq!(after(&set, "+ crab"), "e_b of wheelbase set, + crab");
        assert_eq!(after(&set, &super::set("scale", "e_s")), "e_s of scale set");
        let held = held("wheelbase", "e_b", 1.01 + 1e-16);
        assert_eq!(after(&set, &held), "e_b of wheelbase held at 1.01");
        let other = super::held("wheelbase", "e_b", 1.02);
        assert_eq!(after(&format!("+ crab, {held}"), &other), "+ crab, e_b of wheelbase held at 1.02");
        assert_eq!(after(&held, &free("wheelbase", "e_b")), "e_b of wheelbase to be fitted");
    }

    #[test]
    fn a_fit_tells_of_the_number_that_it_held_and_not_of_the_one_that_it_released() {
        let [first, second] = [held("wheelbase", "e_b", 1.01), held("scale", "e_s", 0.99)];
        let (both, name) = (format!("+ crab, {first}"), named("wheelbase", "e_b"));
        assert_eq!(fitted(&both, Some(&name), Some(&second)), "+ crab, e_s of scale held at 0.99");
        assert_eq!(fitted(&both, None, Some(&second)), format!("+ crab, {first}, {second}"));
        assert_eq!(fitted(&set("scale", "e_s"), None, Some(&second)), second);
        assert_eq!(fitted(&first, Some(&name), None), "fitted anew");
        assert_eq!(fitted("", None, None), "fitted anew");
        assert_eq!(fitted("wheels and wheelbase", None, None), "wheels and wheelbase");
    }
}
