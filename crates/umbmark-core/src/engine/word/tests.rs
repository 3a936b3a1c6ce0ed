use super::*;
use crate::engine::random_lines::{Source, cases};
use crate::engine::{UNITS_PER_TICK, oracle};
use Letter::{Joint, Left, Right};

/// The word itself: letters in a row.
#[derive(Clone, Debug, PartialEq)]
struct Spelling(Vec<Letter>);

impl Monoid for Spelling {
    type Root = ();

    fn identity() -> Self {
        Spelling(Vec::new())
    }

    fn then(&self, next: &Self) -> Self {
        Spelling([&self.0[..], &next.0[..]].concat())
    }

    fn root(&self) {}

    fn power_from(&self, _: (), exponent: u64) -> Self {
        Spelling(self.0.repeat(exponent as usize))
    }
}

fn spelling(line: &WheelLine) -> Vec<Letter> {
    word_product(line, |letter| Spelling(vec![letter])).0
}

/// The word by definition: all events of both wheels with their exact times, sorted; equal times are one letter.
fn sorted_events(line: &WheelLine) -> Vec<Letter> {
    let mut events = Vec::new();
    for (wheel, letter) in [(0, Left), (1, Right)] {
        let (start, travel) = (line.start()[wheel], line.travel()[wheel]);
        // The first unit at which the counter reads differently.
        let first = if travel < 0 { start + 1 } else { UNITS_PER_TICK - start };
        let reached = (0..).map(|i| first + i * UNITS_PER_TICK).take_while(|units| *units <= travel.abs());
        events.extend(reached.map(|units| (i128::from(units), i128::from(travel.abs()), letter)));
    }
    events.sort_by(|a, b| (a.0 * b.1).cmp(&(b.0 * a.1)));
    let mut word: Vec<Letter> = Vec::new();
    let mut previous = None;
    for (units, travel, letter) in events {
        if previous.is_some_and(|(u, t)| u * travel == units * t) {
            *word.last_mut().unwrap() = Joint;
            previous = None;
        } else {
            word.push(letter);
            previous = Some((units, travel));
        }
    }
    word
}

#[test]
fn the_word_is_that_of_the_sorted_event_times_letter_by_letter() {
    let mut source = Source(1);
    let (mut ties, mut still, mut backward) = (0, 0, 0);
    let all = cases(20_000);
    for i in 0..all {
        let line = source.line(if i % 10 == 0 { 400 } else { 40 });
        let expected = sorted_events(&line);
        assert_eq!(spelling(&line), expected, "{line:?}");
        assert_eq!(oracle::letters(&line).collect::<Vec<_>>(), expected, "{line:?}");
        ties += usize::from(expected.contains(&Joint));
        still += usize::from(line.counts().contains(&0));
        backward += usize::from(line.backward().contains(&true));
    }
    // The cases that matter are among them.
    assert!(ties * 40 > all && still * 20 > all && backward * 2 > all, "{ties} {still} {backward} of {all}");
}

#[test]
fn every_letter_is_counted() {
    #[derive(Clone)]
    struct Counts([u64; 3]);
    impl Monoid for Counts {
        type Root = ();
        fn identity() -> Self {
            Counts([0; 3])
        }
        fn then(&self, next: &Self) -> Self {
            Counts(std::array::from_fn(|i| self.0[i] + next.0[i]))
        }
        fn root(&self) {}
        fn power_from(&self, _: (), exponent: u64) -> Self {
            Counts(self.0.map(|n| n * exponent))
        }
    }
    let mut source = Source(2);
    for _ in 0..20_000 {
        let line = source.line(1 << 29);
        let Counts([left, right, joint]) = word_product(&line, |letter| {
            Counts([u64::from(letter == Left), u64::from(letter == Right), u64::from(letter == Joint)])
        });
        assert_eq!([left + joint, right + joint], line.counts().map(i64::unsigned_abs), "{line:?}");
    }
}

#[test]
fn wheels_in_step_tick_together_and_wheels_out_of_step_never_do() {
    let line = |start, travel| WheelLine::from_ticks(start, travel).unwrap();
    assert_eq!(spelling(&line([0.0, 0.0], [3.0, 3.0])), [Joint; 3]);
    assert_eq!(spelling(&line([0.5, 0.5], [-2.0, -2.0])), [Joint; 2]);
    assert_eq!(spelling(&line([0.5, 0.25], [2.0, 2.0])), [Left, Right, Left, Right]);
    assert_eq!(spelling(&line([0.0, 0.0], [2.0, 4.0])), [Right, Joint, Right, Joint]);
    assert_eq!(spelling(&line([0.0, 0.0], [-2.0, 2.0])), [Left, Right, Left, Right]);
    assert_eq!(spelling(&line([0.0, 0.0], [0.0, 0.0])), []);
    assert_eq!(spelling(&line([0.9, 0.0], [0.2, 0.9])), [Left]);
}
