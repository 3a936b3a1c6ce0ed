//! What a run is called: its test, its direction and its number.

use umbmark_core::effect::TestKind;
use umbmark_core::path::Direction;

/// Words for the directions, as in files; `none` for a path that has no sense of turning.
pub(super) const DIRECTIONS: [(&str, Option<Direction>); 3] =
    [("cw", Some(Direction::Cw)), ("ccw", Some(Direction::Ccw)), ("none", None)];

/// Words for the tests, as in files.
pub(super) const TESTS: [(&str, TestKind); 2] = [("systematic", TestKind::Systematic), ("bumps", TestKind::Bumps)];

/// The name of a run: `cw_01`, `bumps_ccw_03`, `none_02`.
pub(super) fn label(test: TestKind, direction: Option<Direction>, number: u32) -> String {
    let test = if test == TestKind::Bumps { "bumps_" } else { "" };
    format!("{test}{}_{number:02}", direction.map_or("none", Direction::name))
}

/// The same for people: "run 3 cw (bumps)".
pub(super) fn spoken(test: TestKind, direction: Option<Direction>, number: u32) -> String {
    let direction = direction.map(|d| format!(" {}", d.name())).unwrap_or_default();
    format!("run {number}{direction} ({})", test.name())
}

/// What the name of a file says of its run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Named {
    pub test: Option<TestKind>,
    /// `Some(None)` where it says that there is none.
    pub direction: Option<Option<Direction>>,
    pub number: Option<u32>,
}

/// Reads a file stem: words and the last number in it.
pub(super) fn parse(stem: &str) -> Named {
    let stem = stem.to_lowercase();
    let mut named = Named::default();
    for word in stem.split(|c: char| !c.is_ascii_alphanumeric()) {
        if let Some((_, direction)) = DIRECTIONS.iter().find(|(name, _)| *name == word) {
            named.direction = Some(*direction);
        } else if let Some((_, test)) = TESTS.iter().find(|(name, _)| *name == word) {
            named.test = Some(*test);
        } else if let Ok(number) = word.parse() {
            named.number = Some(number);
        }
    }
    named
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_that_was_written_is_read_as_what_it_meant() {
        for test in [TestKind::Systematic, TestKind::Bumps] {
            for direction in [Some(Direction::Cw), Some(Direction::Ccw), None] {
                for number in [0, 3, 12, 123] {
                    let named = parse(&label(test, direction, number));
                    assert_eq!((named.direction, named.number), (Some(direction), Some(number)));
                    assert_eq!(named.test.unwrap_or(TestKind::Systematic), test);
                }
            }
        }
        assert_eq!(parse("Monday-CCW-07").direction, Some(Some(Direction::Ccw)));
        assert_eq!(parse("accurate"), Named::default());
    }
}
