//! A model as a table of constants.
//!
//! The table is a list of `f64`, so it has no padding and no byte order of its own, and stands in a header of C as well as in flash:
//!
//! | numbers | meaning |
//! |---|---|
//! | 0, 1, 2 | [`MARK`], [`VERSION`], how many numbers there are |
//! | 3 | drive: 0 two wheels, 1 synchro, 2 car, 3 tricycle |
//! | 4 to 9 | [`Nominal`]: wheelbase, radius left and right, metres per tick left and right, axle distance |
//! | 10 to 12 | [`Gearing`]: metres and radians per count, coupling or steering zero; 0 for two wheels |
//! | 13, 14 | counts per turn of both counters |
//! | 15 | bits of the counters; 0 where they never roll over |
//! | 16 | wiring: +1 exchanged, +2 the first counts backward, +4 the second |
//! | 17 to 19 | START: x, y, heading |
//! | 20 to 24 | whether the noise is known, and [`Growth`] |
//! | 25 | how many laws follow |
//! | ... | of each law its [code](Law::code) and its numbers |

use crate::context::Nominal;
use crate::gearing::{Gearing, MAX_COUNTER_BITS, Steering};
use crate::geometry::Pose2;
use crate::law::Law;
use crate::spread::Growth;
use crate::travel::WheelTravel;
use core::fmt;

/// The first number of every table: "umbm" in ASCII.
pub const MARK: f64 = 1_970_102_893.0;

/// The version of the layout that this crate reads and writes.
pub const VERSION: f64 = 1.0;

/// The largest number of laws in a table.
pub const MAX_LAWS: usize = 24;

/// No length, count or noise is larger.
const LARGEST: f64 = 1e9;

/// How the robot's counters are connected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Columns {
    /// The first that is given is the second counter, and the second is the first.
    pub exchanged: bool,
    /// Whether the first that is given, and the second, counts down when the robot drives forward.
    pub backward: [bool; 2],
}

/// A law with its numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<'t> {
    /// The law.
    pub law: &'static Law,
    /// Its numbers.
    pub values: &'t [f64],
}

/// A model: robot, START, noise and laws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Table<'t> {
    /// Numbers of the robot.
    pub nominal: Nominal,
    /// What its counters mean.
    pub gearing: Gearing,
    /// Counts of each counter per turn of its wheel; of a steering, per turn about the vertical.
    pub counts_per_turn: [f64; 2],
    /// Width of the counters; `None` where they never roll over.
    pub counter_bits: Option<u32>,
    /// How the counters are connected.
    pub columns: Columns,
    /// Where the robot stands at its first reading.
    pub start: Pose2,
    /// Noise of the wheels, where it is known.
    pub growth: Option<Growth>,
    /// The laws in the order in which they act; `None` after the last.
    steps: [Option<Step<'t>>; MAX_LAWS],
}

/// Why numbers are no table.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum TableError {
    /// They do not begin as a table does.
    NotATable,
    /// A table of another version of the layout.
    Version(f64),
    /// More or fewer numbers than the table says.
    Length {
        /// What the table says.
        stated: f64,
        /// How many there are.
        given: usize,
    },
    /// A number that is not finite, or out of its range.
    Number {
        /// Its place, from 0.
        place: usize,
        /// The number.
        value: f64,
    },
    /// A law that this crate does not know; a newer one may.
    UnknownLaw {
        /// Its place, from 0.
        place: usize,
        /// Its code.
        code: f64,
    },
    /// A law with more or fewer numbers than it has.
    Values {
        /// The law.
        law: &'static str,
        /// How many numbers were given.
        given: usize,
    },
    /// More laws than [`MAX_LAWS`].
    TooManyLaws(usize),
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            TableError::NotATable => {
                write!(f, "the numbers are no table of a model; export the model as one")
            }
            TableError::Version(version) => write!(
                f,
                "the table has version {version} of the layout, and this library reads {VERSION}; write it anew with the \
                 umbmark of this library"
            ),
            TableError::Length { stated, given } => write!(f, "the table has {stated} numbers, got {given}"),
            TableError::Number { place, value } => write!(f, "number {place} of the table cannot be {value}"),
            TableError::UnknownLaw { place, code } => {
                write!(f, "number {place} of the table names law {code}, which this library does not know")
            }
            TableError::Values { law, given } => write!(f, "{law} does not have {given} numbers"),
            TableError::TooManyLaws(laws) => write!(f, "a table holds at most {MAX_LAWS} laws, got {laws}"),
        }
    }
}

impl core::error::Error for TableError {}

/// Numbers that are read one after the other.
struct Numbers<'t> {
    all: &'t [f64],
    place: usize,
}

impl<'t> Numbers<'t> {
    fn some(&mut self, count: usize) -> Result<&'t [f64], TableError> {
        let end = self.place.saturating_add(count);
        let short = TableError::Length { stated: end as f64, given: self.all.len() };
        let some = self.all.get(self.place..end).ok_or(short)?;
        if let Some(bad) = some.iter().position(|value| !value.is_finite()) {
            return Err(TableError::Number { place: self.place + bad, value: some[bad] });
        }
        self.place = end;
        Ok(some)
    }

    /// The next number, if `holds` is true of it.
    fn next(&mut self, holds: impl Fn(f64) -> bool) -> Result<f64, TableError> {
        let place = self.place;
        let value = self.some(1)?[0];
        if holds(value) { Ok(value) } else { Err(TableError::Number { place, value }) }
    }

    fn any(&mut self) -> Result<f64, TableError> {
        self.next(|_| true)
    }

    fn positive(&mut self) -> Result<f64, TableError> {
        self.next(|value| value > 0.0 && value <= LARGEST)
    }

    /// A whole number up to a limit.
    fn whole(&mut self, limit: u32) -> Result<u32, TableError> {
        let is_whole = |value: f64| (0.0..=f64::from(limit)).contains(&value) && f64::from(value as u32) == value;
        self.next(is_whole).map(|value| value as u32)
    }
}

impl<'t> Table<'t> {
    /// A table without laws: the robot is as its odometry believes.
    pub fn new(nominal: Nominal, gearing: Gearing) -> Table<'t> {
        Table {
            nominal,
            gearing,
            counts_per_turn: [1.0; 2],
            counter_bits: None,
            columns: Columns::default(),
            start: Pose2::IDENTITY,
            growth: None,
            steps: [None; MAX_LAWS],
        }
    }

    /// The same with other laws, in the order in which they act; laws of the wheels act before those of the body.
    pub fn with_steps(mut self, steps: impl IntoIterator<Item = Step<'t>>) -> Result<Table<'t>, TableError> {
        self.steps = [None; MAX_LAWS];
        for (place, step) in steps.into_iter().enumerate() {
            if step.values.len() != step.law.parameters {
                return Err(TableError::Values { law: step.law.name, given: step.values.len() });
            }
            *self.steps.get_mut(place).ok_or(TableError::TooManyLaws(place + 1))? = Some(step);
        }
        Ok(self)
    }

    /// Its laws in the order in which they act.
    pub fn steps(&self) -> impl Iterator<Item = &Step<'t>> {
        self.steps.iter().map_while(Option::as_ref)
    }

    /// Whether some law depends on the speeds of the wheels, which are known half a window later.
    pub fn reads_speed(&self) -> bool {
        self.steps().any(|step| step.law.reads_speed)
    }

    /// The table in numbers.
    ///
    /// # Errors
    /// Where they are no table, of another version, not complete, or out of range.
    pub fn read(numbers: &'t [f64]) -> Result<Table<'t>, TableError> {
        if numbers.first() != Some(&MARK) {
            return Err(TableError::NotATable);
        }
        let mut rest = Numbers { all: numbers, place: 1 };
        let version = rest.any()?;
        if version != VERSION {
            return Err(TableError::Version(version));
        }
        let stated = rest.any()?;
        if stated != numbers.len() as f64 {
            return Err(TableError::Length { stated, given: numbers.len() });
        }
        let drive = rest.whole(3)?;
        let wheelbase = rest.positive()?;
        let wheel_radius = [rest.positive()?, rest.positive()?];
        let metres_per_tick = WheelTravel { left: rest.positive()?, right: rest.positive()? };
        let axle_distance = rest.positive()?;
        let nominal = Nominal { wheelbase, wheel_radius, metres_per_tick, axle_distance, wheel_layout: [0.0; 2] };
        let (per_count, zero) = ([rest.any()?, rest.any()?], rest.any()?);
        let steering = Steering { per_count, zero, axle_distance };
        let gearing = match drive {
            0 => Gearing::Wheels(metres_per_tick),
            1 => Gearing::Synchro { per_count, coupling: zero },
            2 => Gearing::Car(steering),
            _ => Gearing::Tricycle(steering),
        };
        let mut table = Table::new(nominal, gearing);
        table.counts_per_turn = [rest.positive()?, rest.positive()?];
        table.counter_bits = Some(rest.whole(MAX_COUNTER_BITS)?).filter(|bits| *bits > 0);
        let wiring = rest.whole(7)?;
        table.columns = Columns { exchanged: wiring & 1 != 0, backward: [wiring & 2 != 0, wiring & 4 != 0] };
        table.start = Pose2::new(rest.any()?, rest.any()?, rest.any()?);
        let known = rest.whole(1)?;
        let mut size = || rest.next(|value| (0.0..=LARGEST).contains(&value));
        let growth = Growth {
            heading_per_metre: size()?,
            heading_per_radian: size()?,
            forward_per_metre: size()?,
            sideways_per_metre: size()?,
        };
        table.growth = (known == 1).then_some(growth);
        let laws = rest.any()?;
        if !(laws >= 0.0 && laws <= MAX_LAWS as f64) {
            return Err(TableError::TooManyLaws(laws as usize));
        }
        for step in table.steps.iter_mut().take(laws as usize) {
            let place = rest.place;
            let code = rest.any()?;
            let known = Law::of_code(code as u16).filter(|law| f64::from(law.code) == code);
            let law = known.ok_or(TableError::UnknownLaw { place, code })?;
            *step = Some(Step { law, values: rest.some(law.parameters)? });
        }
        if rest.place != numbers.len() {
            return Err(TableError::Length { stated: rest.place as f64, given: numbers.len() });
        }
        Ok(table)
    }

    /// Hands out the numbers of the table one after the other, each with what it means.
    pub fn write(&self, mut each: impl FnMut(&'static str, f64)) {
        let (drive, [per_count, per_steering], zero) = match self.gearing {
            Gearing::Wheels(_) => (0.0, [0.0; 2], 0.0),
            Gearing::Synchro { per_count, coupling } => (1.0, per_count, coupling),
            Gearing::Car(car) => (2.0, car.per_count, car.zero),
            Gearing::Tricycle(front) => (3.0, front.per_count, front.zero),
        };
        let numbers = 26 + self.steps().map(|step| 1 + step.values.len()).sum::<usize>();
        each("a table of umbmark", MARK);
        each("version of its layout", VERSION);
        each("how many numbers", numbers as f64);
        each("drive: 0 two wheels, 1 synchro, 2 car, 3 tricycle", drive);
        each("wheelbase [m]", self.nominal.wheelbase);
        each("radius of the left wheel [m]", self.nominal.wheel_radius[0]);
        each("of the right wheel [m]", self.nominal.wheel_radius[1]);
        each("left wheel [m per tick]", self.nominal.metres_per_tick.left);
        each("right wheel [m per tick]", self.nominal.metres_per_tick.right);
        each("axle distance [m]", self.nominal.axle_distance);
        each("drive [m per count]; 0 for two wheels", per_count);
        each("steering [rad per count]; 0 for two wheels", per_steering);
        each("steering zero [rad], or coupling [rad/m]", zero);
        each("counts per turn, first counter", self.counts_per_turn[0]);
        each("second counter", self.counts_per_turn[1]);
        each("bits of the counters; 0: they never roll over", f64::from(self.counter_bits.unwrap_or(0)));
        let flag = |set: bool, value: f64| if set { value } else { 0.0 };
        let Columns { exchanged, backward } = self.columns;
        let wiring = flag(exchanged, 1.0) + flag(backward[0], 2.0) + flag(backward[1], 4.0);
        each("wiring: +1 exchanged, +2 first backward, +4 second backward", wiring);
        each("START x [m]", self.start.x);
        each("START y [m]", self.start.y);
        each("START heading [rad]", self.start.heading);
        let growth = self.growth.unwrap_or_default();
        each("whether the noise is known", flag(self.growth.is_some(), 1.0));
        each("heading noise [rad per root metre]", growth.heading_per_metre);
        each("heading noise [rad per root radian]", growth.heading_per_radian);
        each("noise forward [m per root metre]", growth.forward_per_metre);
        each("noise to the side [m per root metre]", growth.sideways_per_metre);
        each("how many laws", self.steps().count() as f64);
        for step in self.steps() {
            each(step.law.name, f64::from(step.law.code));
            step.values.iter().for_each(|value| each("", *value));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::example::TABLE;
    use crate::law::LAWS;
    use std::string::ToString;
    use std::vec::Vec;

    fn numbers(table: &Table) -> Vec<f64> {
        let mut numbers = Vec::new();
        table.write(|_, number| numbers.push(number));
        numbers
    }

    #[test]
    fn a_table_is_written_as_it_was_read_with_every_gearing_wiring_and_law() {
        let read = Table::read(&TABLE).unwrap();
        assert_eq!(numbers(&read), TABLE);
        let steering = Steering { per_count: [1e-4, 2e-4], zero: -0.01, axle_distance: 0.34 };
        let values = [0.5, 1.5, 2.5, 3.5, 4.5, 5.5];
        for (k, gearing) in [
            Gearing::Wheels(read.nominal.metres_per_tick),
            Gearing::Synchro { per_count: [1e-4, 2e-4], coupling: -0.02 },
            Gearing::Car(steering),
            Gearing::Tricycle(steering),
        ]
        .into_iter()
        .enumerate()
        {
            let laws = LAWS.iter().skip(10 * k).take(10);
            let steps = laws.map(|law| Step { law, values: &values[..law.parameters] });
            let mut table = Table::new(read.nominal, gearing).with_steps(steps).unwrap();
            table.columns = Columns { exchanged: k % 2 == 1, backward: [k > 1, k == 1] };
            table.counter_bits = [None, Some(1), Some(16), Some(62)][k];
            table.start = Pose2::new(1.0, -2.0, 3.0);
            let written = numbers(&table);
            assert_eq!(Table::read(&written), Ok(table));
        }
        let short = Step { law: &LAWS[0], values: &values[..2] };
        let refused = Table::new(read.nominal, read.gearing).with_steps([short]);
        assert_eq!(refused, Err(TableError::Values { law: "missed_counts", given: 2 }));
        let codes: std::collections::BTreeSet<u16> = LAWS.iter().map(|law| law.code).collect();
        assert_eq!(codes.len(), LAWS.len(), "a code names one law");
    }

    #[test]
    fn every_number_that_is_not_finite_and_every_shorter_or_longer_table_is_refused() {
        for place in 0..TABLE.len() {
            for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                let mut bad = TABLE;
                bad[place] = value;
                assert!(Table::read(&bad).is_err(), "{place}");
            }
            assert!(Table::read(&TABLE[..place]).is_err(), "{place}");
            let mut cut = TABLE[..place].to_vec();
            if place > 2 {
                cut[2] = place as f64;
            }
            assert!(Table::read(&cut).is_err(), "{place}");
        }
        let longer: Vec<f64> = TABLE.iter().copied().chain([0.0]).collect();
        assert_eq!(Table::read(&longer), Err(TableError::Length { stated: 30.0, given: 31 }));
    }

    #[test]
    fn numbers_out_of_range_are_told_by_their_place() {
        for (place, value, sentence) in [
            (0, 7.0, "the numbers are no table of a model; export the model as one"),
            (1, 2.0, "version 2 of the layout, and this library reads 1"),
            (2, 29.0, "the table has 29 numbers, got 30"),
            (3, 4.0, "number 3 of the table cannot be 4"),
            (3, 0.5, "number 3 of the table cannot be 0.5"),
            (4, 0.0, "number 4 of the table cannot be 0"),
            (8, 1e10, "number 8 of the table cannot be 10000000000"),
            (15, 63.0, "number 15 of the table cannot be 63"),
            (16, 8.0, "number 16"),
            (20, 2.0, "number 20"),
            (21, -1e-3, "number 21 of the table cannot be -0.001"),
            (25, 25.0, "a table holds at most 24 laws, got 25"),
            (25, -1.0, "a table holds at most 24 laws"),
            (26, 99.0, "number 26 of the table names law 99, which this library does not know"),
            (26, 4.5, "number 26 of the table names law 4.5"),
            (26, 65540.0, "number 26 of the table names law 65540"),
        ] {
            let mut bad = TABLE;
            bad[place] = value;
            let said = Table::read(&bad).unwrap_err().to_string();
            assert!(said.contains(sentence), "{place}: {said}");
        }
    }
}
