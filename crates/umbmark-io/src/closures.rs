//! Logs of a robot that was driven onto marks on the floor, cut into drives from a mark to a mark.
//!
//! Nobody watched the drive, but at both of its ends the robot stood on a mark: where it stood is known then, and the counts say where the
//! odometry puts it. Between two visits of one mark the robot has come back to where it began, wherever the mark lies. Between two marks
//! whose places are measured it has moved from one place to the other. A visit is the rows that name the mark: a drive begins at the last of
//! them and ends at the first of the next visit's.

use std::collections::BTreeMap;
use umbmark_core::geometry::{Pose2, wrap};
use umbmark_core::run::{Mended, PoseRow, TickLog};

/// Places of marks: x, y \[m\] and, where it was measured, the heading of the robot that stands on it \[rad\].
pub(super) type Marks = BTreeMap<String, PoseRow>;

/// A drive from a mark to a mark.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Closure {
    /// Its counts, from its beginning on.
    pub log: TickLog,
    /// Where the robot stands at its end, seen from where it stood at its beginning.
    pub end: PoseRow,
}

/// Rows at which the robot stood on one mark.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Visit<'a> {
    mark: &'a str,
    first: usize,
    last: usize,
}

/// The drives of a log from one mark to the next of which both ends are known, as many as possible that share no way. `marked` has the
/// samples at which the robot stood on a mark, in their order, and its name.
pub(super) fn closures(log: &TickLog, marked: &[(usize, String)], places: &Marks) -> Vec<Closure> {
    let visits = visits(marked);
    let mut found = Vec::new();
    // Of drives that end first, each that begins no earlier than the one before has ended: no choice gives more.
    let mut free = 0;
    for to in 0..visits.len() {
        let ends = (free..to).rev().find_map(|from| Some((from, end_of(&visits[from], &visits[to], places)?)));
        if let Some((from, end)) = ends {
            found.push(Closure { log: between(log, visits[from].last, visits[to].first), end });
            free = to;
        }
    }
    found
}

fn visits(marked: &[(usize, String)]) -> Vec<Visit<'_>> {
    let mut visits: Vec<Visit> = Vec::new();
    for (sample, mark) in marked {
        match visits.last_mut() {
            Some(visit) if visit.mark == mark && visit.last + 1 == *sample => visit.last = *sample,
            _ => visits.push(Visit { mark, first: *sample, last: *sample }),
        }
    }
    visits
}

/// Where the robot stands on the second mark, seen from the first; `None` where nobody knows.
fn end_of(from: &Visit, to: &Visit, places: &Marks) -> Option<PoseRow> {
    if from.mark == to.mark {
        return Some((0.0, 0.0, Some(0.0)));
    }
    let ((x, y, heading), (to_x, to_y, to_heading)) = (places.get(from.mark)?, places.get(to.mark)?);
    let heading = (*heading)?;
    let seen = Pose2::new(*x, *y, heading).between(&Pose2::new(*to_x, *to_y, to_heading.unwrap_or(heading)));
    Some((seen.x, seen.y, to_heading.map(|_| wrap(seen.heading))))
}

/// The counts between two samples, from zero at the first.
fn between(log: &TickLog, from: usize, to: usize) -> TickLog {
    let counts = |counts: &[f64]| counts[from..=to].iter().map(|count| count - counts[from]).collect();
    TickLog {
        time: log.time[from..=to].to_vec(),
        left: counts(&log.left),
        right: counts(&log.right),
        rollers: log.rollers.iter().map(|all| counts(all)).collect(),
        mended: Mended::default(),
        ..TickLog::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    fn log(samples: usize) -> TickLog {
        let count = |k: usize| (k * k) as f64;
        TickLog {
            time: (0..samples).map(|k| 5.0 + k as f64).collect(),
            left: (0..samples).map(count).collect(),
            right: (0..samples).map(|k| 2.0 * count(k)).collect(),
            ..TickLog::default()
        }
    }

    /// From and to which time, and where the robot ends.
    fn found(marked: &[(usize, &str)], places: &Marks) -> Vec<(f64, f64, PoseRow)> {
        let marked: Vec<(usize, String)> = marked.iter().map(|(sample, mark)| (*sample, (*mark).to_owned())).collect();
        let of = |closure: Closure| {
            assert_eq!((closure.log.left[0], closure.log.right[0]), (0.0, 0.0));
            (closure.log.time[0], closure.log.time[closure.log.time.len() - 1], closure.end)
        };
        closures(&log(20), &marked, places).into_iter().map(of).collect()
    }

    #[test]
    fn a_robot_that_stands_on_a_mark_again_has_come_back_wherever_the_mark_is() {
        let back = (0.0, 0.0, Some(0.0));
        // It leaves at the last row of a visit and arrives at the first of the next.
        assert_eq!(
            found(&[(0, "a"), (1, "a"), (9, "a"), (10, "a"), (17, "a")], &Marks::new()),
            [(6.0, 14.0, back), (15.0, 22.0, back)]
        );
        // Of drives that share some way, those that end first.
        assert_eq!(found(&[(0, "a"), (4, "b"), (8, "a"), (12, "b"), (15, "c")], &Marks::new()), [(5.0, 13.0, back)]);
        assert_eq!(found(&[(0, "a"), (4, "b"), (6, "b"), (8, "a")], &Marks::new()), [(9.0, 11.0, back)]);
        assert_eq!(found(&[(3, "a")], &Marks::new()), []);
    }

    #[test]
    fn between_marks_whose_places_are_measured_the_robot_has_moved_from_one_to_the_other() {
        let places = Marks::from([
            ("a".to_owned(), (1.0, 1.0, Some(FRAC_PI_2))),
            ("b".to_owned(), (1.0, 3.0, Some(-FRAC_PI_2))),
            ("c".to_owned(), (0.0, 1.0, None)),
        ]);
        let drives = found(&[(0, "a"), (5, "b"), (9, "c"), (12, "c"), (15, "d")], &places);
        let expected = [(2.0, 0.0, Some(-std::f64::consts::PI)), (2.0, -1.0, None), (0.0, 0.0, Some(0.0))];
        assert_eq!(drives.len(), 3);
        for ((.., (x, y, heading)), (to_x, to_y, to_heading)) in drives.iter().zip(expected) {
            assert!((x - to_x).abs() < 1e-12 && (y - to_y).abs() < 1e-12, "{drives:?}");
            assert_eq!(heading.is_some(), to_heading.is_some());
            assert!(wrap(heading.unwrap_or(0.0) - to_heading.unwrap_or(0.0)).abs() < 1e-12, "{drives:?}");
        }
    }
}
