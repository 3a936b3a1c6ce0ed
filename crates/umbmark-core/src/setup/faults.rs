//! Columns that contradict their names.

use super::agreement::{Agreement, Beside, Reading};
use super::counts_factor::CountsFactor;
use super::one_wheel::Column;
use crate::drive::{DriveKind, Robot};
use std::borrow::Cow;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// If the misfit exceeds this, other readings are tried; one is accepted if its misfit is smaller by the second factor.
pub(super) const DOUBTFUL: f64 = 0.3;
const CLEARLY: f64 = 0.6;
/// If the misfit of every reading exceeds this, wheels and reference do not belong to the same drive.
pub(super) const NOTHING: f64 = 0.75;
/// If the rotation is less than this share of the expected one, its sign is undetermined. Distances and rotations beyond the inverse belong
/// to another reading.
const LEAST_GAIN: f64 = 0.2;
/// If the misfit of distance or rotation exceeds this, its scale is meaningless.
pub(super) const VAGUE: f64 = 0.5;
/// Lengths that are so many times too large: their unit, and the one that their column names.
const UNITS: [(f64, &str, &str); 7] = [
    (1000.0, "mm", "metres"),
    (100.0, "cm", "metres"),
    (39.37, "inches", "metres"),
    (3.2808, "feet", "metres"),
    (0.1, "cm", "mm"),
    (0.01, "metres", "cm"),
    (0.001, "metres", "mm"),
];
/// Headings that are read as degrees are below this, over a few turns, where they are radians \[rad\].
const FEW_DEGREES: f64 = 0.6;
/// Counts or lengths that are off by more than this factor, or the inverse, are no robot's.
const MOST_SCALE: f64 = 3.0;
/// Tolerance, as a share, to recognise a unit or a factor of the counts by its size.
pub(super) const NEAR: f64 = 0.08;

/// Data that contradicts its name.
#[derive(Clone, Debug, PartialEq)]
pub enum Fault {
    /// Left and right wheel are exchanged, or the frame of the reference is left-handed.
    Exchanged,
    /// Counters count backward when driving forward.
    Backward {
        /// What the columns are called, after "ticks_".
        names: [&'static str; 2],
        /// Whether the first counts backward, and the second.
        counters: [bool; 2],
        /// Whether the columns are exchanged as well.
        exchanged: bool,
    },
    /// Counters count up whichever way their wheels roll.
    OneWay {
        /// What the columns are called, after "ticks_".
        names: [&'static str; 2],
        /// Whether the first does, and the second.
        counters: [bool; 2],
    },
    /// Recordings are the same, to the last digit.
    Copies {
        /// The runs.
        runs: Vec<String>,
    },
    /// Measured headings grow clockwise.
    HeadingClockwise,
    /// Headings, which are all that was measured, turn opposite to the counts.
    TurnsOpposite,
    /// x and y are of a left-handed frame, and headings are not.
    PositionsMirrored,
    /// x and y are exchanged.
    PositionsExchanged,
    /// Headings are in degrees.
    HeadingInDegrees,
    /// Headings are in radians.
    HeadingInRadians,
    /// Counts are those since the row before.
    Increments,
    /// One wheel with rollers is counted backward, or two have each other's columns.
    OneWheel(Column),
    /// Positions and headings of the reference are mirrored.
    ReferenceMirrored,
    /// Lengths of the reference are in another unit than their column says.
    LengthsIn {
        /// Its name.
        unit: &'static str,
        /// That of their column.
        named: &'static str,
        /// Way by the reference over way by the wheels.
        ratio: f64,
    },
    /// The reference moves far more, or far less, than the wheels roll.
    OtherScale {
        /// Way by the reference over way by the wheels.
        ratio: f64,
    },
    /// Way and rotations by the reference are both so many times those by the wheels.
    Counts(CountsFactor),
    /// The counts of one wheel, and not of the other, have to be multiplied by a factor.
    OneCounter {
        /// What the column is called, after "ticks_".
        name: &'static str,
        /// That factor.
        factor: f64,
    },
    /// The reference moves, and the wheels hardly roll.
    Standing {
        /// Way by the counts in all runs \[m\].
        rolled: f64,
        /// How far the reference comes from the beginning of a run \[m\].
        moved: f64,
    },
    /// Some runs were recorded with other columns or headings than the rest, or with ticks and poses of different drives.
    InRuns {
        /// What is wrong in these runs.
        fault: Box<Fault>,
        /// Their names.
        runs: Vec<String>,
    },
    /// The reference does not move as the wheels roll, however they are read.
    OtherMotion {
        /// Share of the motion that disagrees.
        misfit: f64,
    },
    /// Return errors are in another unit than metres.
    ReturnsIn {
        /// "mm", or "mm or cm".
        unit: &'static str,
        /// Distance of the median return from START, if it were in metres \[m\].
        distance: f64,
        /// Way of a run \[m\].
        way: f64,
    },
    /// Return headings are in degrees.
    ReturnHeadingsInDegrees,
    /// Returns were measured from another point than START.
    ReturnsFromElsewhere {
        /// From that point to the middle of the returns \[m\].
        distance: f64,
        /// From the returns of one direction to those of the other \[m\].
        apart: f64,
    },
}

impl Fault {
    /// The message that refuses a fit: each fault with its remedy.
    pub(crate) fn refusal(faults: &[Fault]) -> String {
        let told: Vec<String> = faults.iter().map(|f| format!("{}; {}", f.sentence(), f.remedy())).collect();
        format!("the robot cannot be judged yet: {}", told.join("; and "))
    }

    /// What is wrong, in words.
    pub fn sentence(&self) -> String {
        match self {
            Fault::Exchanged => {
                "left and right are exchanged: the robot turns opposite to its counts".into()
            }
            Fault::Backward { names: [first, second], counters, exchanged } => {
                let which = match counters {
                    [true, true] => "both counters count".to_owned(),
                    [true, false] => format!("ticks_{first} counts"),
                    _ => format!("ticks_{second} counts"),
                };
                let and = if *exchanged { ", and left and right are exchanged" } else { "" };
                format!("{which} backward when the robot drives forward{and}")
            }
            Fault::OneWay { names: [first, second], counters } => {
                let which = match counters {
                    [true, true] => "both counters count up whichever way their wheels roll".to_owned(),
                    [true, false] => format!("ticks_{first} counts up whichever way its wheel rolls"),
                    _ => format!("ticks_{second} counts up whichever way its wheel rolls"),
                };
                format!("{which}: where the reference shows a wheel roll backward, its counts go on")
            }
            Fault::Copies { runs } => format!(
                "{} are one recording: all counts and all measured poses are the same",
                named(runs)
            ),
            Fault::HeadingClockwise => {
                "the measured heading grows clockwise: it turns opposite to the robot and its track".into()
            }
            Fault::TurnsOpposite => {
                "the measured heading turns opposite to the counts: left and right are exchanged, both count backward, or it grows clockwise, as \
                 that of a gyro upside down; headings alone do not say which".into()
            }
            Fault::PositionsMirrored => {
                "the measured track is mirrored: x and y are of a left-handed frame, the headings are not".into()
            }
            Fault::OneWheel(Column::Backward(name)) => format!(
                "ticks_{name} counts backward: with the other sign, and not as it is, the wheels move as the reference does"
            ),
            Fault::OneWheel(Column::Exchanged([one, other])) => format!(
                "ticks_{one} and ticks_{other} are exchanged: with the columns changed over, and not as they are, the wheels move as the reference does"
            ),
            Fault::ReferenceMirrored => {
                "the measured track and its headings are mirrored: the robot drives to the other side and turns the other way by its wheels".into()
            }
            Fault::PositionsExchanged => {
                "x and y of the measured track are exchanged: it is mirrored, and a quarter turn from the headings".into()
            }
            Fault::HeadingInDegrees => "the measured heading is in degrees, not in radians".into(),
            Fault::HeadingInRadians => "the measured heading is in radians, not in degrees".into(),
            Fault::Increments => {
                "the counts are those since the row before, and not those since the beginning: their running sums agree with the reference".into()
            }
            Fault::LengthsIn { unit, named, ratio } => {
                format!(
                    "the measured positions are in {unit}, not in {named}: the track is {ratio:.4} times as long as the wheels rolled"
                )
            }
            Fault::OtherScale { ratio } => {
                format!(
                    "the measured track is {ratio:.3} times as long as the wheels rolled: positions, wheel diameter or ticks per revolution are wrong"
                )
            }
            Fault::Counts(factor) => factor.sentence(),
            Fault::OneCounter { name, factor } => format!(
                "ticks_{name} has {} times the counts of the other wheel for the same way: both motions agree with the reference if it is \
                 multiplied by {factor}",
                1.0 / factor
            ),
            Fault::Standing { rolled, moved } => format!(
                "the wheels stand while the reference moves: {rolled:.3} m by the counts of all runs, and {moved:.2} m from the beginning of a \
                 run by the reference"
            ),
            Fault::InRuns { fault, runs } => {
                format!("in {}, and not in the other runs, {}", named(runs), fault.sentence())
            }
            Fault::OtherMotion { misfit } => format!(
                "the reference does not move as the wheels roll ({:.0} % of the motion disagrees, however the columns are read): \
                 ticks and poses may be of different drives, or stamped by clocks that are seconds apart",
                100.0 * misfit
            ),
            Fault::ReturnsIn { unit, distance, way } => format!(
                "the return errors are in {unit}, not in metres: read as metres, their median is {distance:.1} m after a way of {way:.1} m"
            ),
            Fault::ReturnsFromElsewhere { distance, apart } => format!(
                "the returns were not measured from START: those of both directions lie {distance:.2} m from (0, 0) and {apart:.2} m from each \
                 other, and wheels and wheelbase take them as far apart as away"
            ),
            Fault::ReturnHeadingsInDegrees => {
                "the return headings are in degrees, not in radians: read as degrees they agree with the return positions, read as radians they do not".into()
            }
        }
    }

    /// By what headings must be multiplied, with these faults.
    pub(super) fn heading_factor(faults: &[Fault]) -> f64 {
        let of = |fault: &Fault| match fault {
            Fault::HeadingInDegrees => Some(1.0_f64.to_radians()),
            Fault::HeadingInRadians => Some(1.0_f64.to_degrees()),
            _ => None,
        };
        faults.iter().find_map(of).unwrap_or(1.0)
    }

    /// What to do, with the line of robot.toml where there is one.
    pub fn remedy(&self) -> String {
        match self {
            Fault::Exchanged => {
                "write wheels_exchanged = true under [robot] in robot.toml (or, if the wheels are right and the reference is mirrored, \
                 y_mirrored = true and heading_clockwise = true under [reference])"
                    .into()
            }
            Fault::Backward { names, counters, exchanged } => {
                let backward = names.iter().zip(counters).filter(|(_, is)| **is);
                let mut lines: Vec<String> = backward.map(|(name, _)| format!("{name}_counts_backward = true")).collect();
                lines.extend(exchanged.then(|| "wheels_exchanged = true".to_owned()));
                format!("write {} under [robot] in robot.toml", lines.join(" and "))
            }
            Fault::OneWay { .. } => {
                "give the counts the sign of the rotation (both channels of the encoder, or the sign of the motor's command), or use only runs \
                 in which no wheel rolls backward"
                    .into()
            }
            Fault::Copies { .. } => "keep one of the files".into(),
            Fault::HeadingClockwise => "write heading_clockwise = true under [reference] in robot.toml".into(),
            Fault::TurnsOpposite => {
                "look, and write heading_clockwise = true under [reference] in robot.toml, or wheels_exchanged = true, or \
                 left_counts_backward = true and right_counts_backward = true, under [robot]"
                    .into()
            }
            Fault::PositionsMirrored => "write y_mirrored = true under [reference] in robot.toml".into(),
            Fault::OneWheel(Column::Backward(name)) => format!("change the sign of the column ticks_{name} in all logs"),
            Fault::OneWheel(Column::Exchanged([one, other])) => {
                format!("change over the names of the columns ticks_{one} and ticks_{other} in all logs")
            }
            Fault::ReferenceMirrored => {
                "write y_mirrored = true and heading_clockwise = true under [reference] in robot.toml (or, if the reference is right, change over the columns of the \
                 wheels on the left and on the right)"
                    .into()
            }
            Fault::PositionsExchanged => "exchange the columns x_ref and y_ref, or their names".into(),
            Fault::HeadingInDegrees => "call the column theta_ref_deg (of a gyro, gyro_deg_s)".into(),
            Fault::LengthsIn { unit: unit @ ("mm" | "cm"), .. } => format!("call the columns x_ref_{unit} and y_ref_{unit}"),
            Fault::LengthsIn { unit: "metres", named, .. } => {
                format!("call the columns x_ref_m and y_ref_m (or, if the sizes under [robot] in robot.toml are in {named}, write them in metres)")
            }
            Fault::LengthsIn { .. } => "convert the columns to metres".into(),
            Fault::HeadingInRadians => "call the column theta_ref_rad (of a gyro, gyro_rad_s)".into(),
            Fault::Increments => "write the running sum of its counts into each column ticks_*".into(),
            Fault::OtherScale { .. } => "check the unit of the positions and [robot] in robot.toml".into(),
            Fault::Counts(factor) => factor.remedy(),
            Fault::OneCounter { name, factor } => {
                format!(
                    "multiply ticks_{name} by {factor} (a decoder counts one, two or four edges of each line); if the wheels do differ, write \
                     wheel_diameter_left_m and wheel_diameter_right_m under [robot] in robot.toml as measured with a tape"
                )
            }
            Fault::Standing { .. } => {
                "check whether the columns of the ticks are those of the wheels, and ticks_per_revolution under [robot] in robot.toml".into()
            }
            Fault::InRuns { fault, runs } if matches!(**fault, Fault::OtherMotion { .. }) => format!(
                "check whether the ticks and the poses of {} are of the same drive, or move their files out of runs",
                named(runs)
            ),
            Fault::InRuns { fault, runs } => format!(
                "correct the recordings of {} ({}), or keep them in a folder of their own and {} there",
                named(runs),
                fault.in_recording(),
                fault.remedy()
            ),
            Fault::OtherMotion { .. } => "check whether each file has ticks and poses of the same drive".into(),
            Fault::ReturnsIn { unit: "mm", .. } => {
                "write the unit into the names of the columns: of returns.csv ex_mm and ey_mm, or x_abs_mm, y_abs_mm, x_calc_mm and y_calc_mm; of logs \
                 x_ref_mm and y_ref_mm".into()
            }
            Fault::ReturnsIn { .. } => {
                "write the unit into the names of the columns: of returns.csv ex_mm and ey_mm (or ex_cm and ey_cm), for poses x_abs_mm, y_abs_mm, \
                 x_calc_mm and y_calc_mm; of logs x_ref_mm and y_ref_mm (or _cm)".into()
            }
            Fault::ReturnsFromElsewhere { .. } => {
                "measure the pose of START in the same frame, and enter each return as seen from there, less what the odometry reports: x along the \
                 first leg, y to its left (if they are from START, all runs went the same way round, whatever their direction says)"
                    .into()
            }
            Fault::ReturnHeadingsInDegrees => {
                "call the column etheta_deg in returns.csv, or the two columns theta_abs_deg and theta_calc_deg".into()
            }
        }
    }

    /// What to change in a recording.
    fn in_recording(&self) -> String {
        match self {
            Fault::Exchanged => "exchange the columns of the two wheels".into(),
            Fault::Backward { names, counters, exchanged } => {
                let backward = names.iter().zip(counters).filter(|(_, is)| **is);
                let mut changes: Vec<String> =
                    backward.map(|(name, _)| format!("change the sign of ticks_{name}")).collect();
                changes.extend(exchanged.then(|| "exchange the columns of the two wheels".to_owned()));
                changes.join(" and ")
            }
            Fault::HeadingClockwise => "change the sign of the measured heading".into(),
            Fault::TurnsOpposite => {
                "change the sign of the measured heading, or exchange the columns of the two wheels".into()
            }
            Fault::PositionsMirrored => "change the sign of y".into(),
            Fault::PositionsExchanged => "exchange the columns of x and y".into(),
            Fault::HeadingInDegrees => "write the measured heading in radians".into(),
            Fault::HeadingInRadians => "write the measured heading in degrees".into(),
            Fault::Counts(factor) => format!("multiply all counts by {}", factor.nearest()),
            Fault::OneCounter { name, factor } => format!("multiply ticks_{name} by {factor}"),
            _ => "check their columns".into(),
        }
    }
}

/// Names of runs in a sentence.
fn named(runs: &[String]) -> String {
    match runs {
        [first, .., last] if runs.len() > 6 => format!("{} runs from {first} to {last}", runs.len()),
        [name] => format!("run {name}"),
        _ => format!("runs {}", runs.join(", ")),
    }
}

/// The faults of columns and headings, and the reading on which everything else is based.
pub(super) fn look(windows: &[Beside], robot: &Robot) -> (Vec<Fault>, Reading) {
    let wheelbase = robot.drive.wheelbase();
    let by_course = windows.iter().any(|(window, _)| !window.with_heading);
    let of = |windows: &[Beside], reading: Reading| {
        let found = Agreement::without_drift(windows, reading, wheelbase);
        // A robot that turns on the spot moves a point on its axle nowhere: its courses then turn by chance only, and accuse nobody.
        let [way, turns] = found.shown;
        Agreement { shown: [way, turns && (!by_course || found.turns_are_credible())], ..found }
    };
    // If a counter is read wrongly, a small difference of the wheels can mimic distance or rotation, multiplied many times.
    let doubt = |found: &Agreement| {
        let possible =
            |k: usize, ratio: f64| found.misfits[k] > VAGUE || (LEAST_GAIN..=1.0 / LEAST_GAIN).contains(&ratio);
        // If the rotations agree, a distance in another unit is possible too.
        let turns = found.shown[1] && found.misfits[1] < DOUBTFUL;
        let unit = turns && unit_of(found.scale()).is_some();
        let sound = CountsFactor::of(found, robot).is_some()
            || (unit || possible(0, found.scale())) && possible(1, found.turn[0].abs());
        if sound { found.misfit } else { found.misfit.max(1.0) }
    };
    let given = of(windows, Reading::default());
    let differential = robot.drive.kind().has_axle_wheels();
    // On long parallel legs, headings of the wrong sign fit well but for rotations that seem to be the wheels' fault.
    let accuses = given.shown[1] && given.turn[0] < -LEAST_GAIN;
    let (mut best, mut reading, mut unit) = (given, Reading::default(), None);
    if accuses || doubt(&given) > DOUBTFUL {
        let largest = windows.iter().map(|(window, _)| window.heading.abs()).fold(0.0, f64::max);
        let other_unit = match by_course {
            false if largest > 7.0 => Some(Fault::HeadingInDegrees),
            false if largest < FEW_DEGREES => Some(Fault::HeadingInRadians),
            _ => None,
        };
        for own in std::iter::once(None).chain(other_unit.map(Some)) {
            let read = scaled(windows, Fault::heading_factor(own.as_slice()));
            for tried in (0..4).map(|k| Reading { opposed: k & 1 != 0, clockwise: k & 2 != 0 }) {
                if tried.opposed && !differential {
                    continue;
                }
                let found = of(&read, tried);
                // If the given reading agrees, another one is more likely only if it agrees as well and its sizes are possible.
                let clearly = if given.misfit > DOUBTFUL { CLEARLY * doubt(&given) } else { DOUBTFUL };
                if doubt(&found) < clearly && doubt(&found) < doubt(&best) {
                    (best, reading, unit) = (found, tried, own.clone());
                }
            }
        }
    }
    // Courses of single positions are of little use where the robot hardly moves: then only the way can disagree.
    let disagrees = match by_course {
        true => best.shown[0] && best.is_main[0] && best.misfits[0] > NOTHING,
        false => best.misfit > NOTHING && best.shown.contains(&true),
    };
    if disagrees {
        return (vec![Fault::OtherMotion { misfit: best.misfit }], reading);
    }
    let mut faults: Vec<Fault> = unit.into_iter().collect();
    let turned = turned(&best, reading, robot.drive.kind());
    let headings_only = windows.iter().all(|(window, _)| window.headings_only);
    let opposite = |fault: &Fault| match fault {
        Fault::Exchanged | Fault::HeadingClockwise | Fault::PositionsMirrored | Fault::PositionsExchanged => true,
        Fault::Backward { counters, .. } => *counters == [true; 2],
        _ => false,
    };
    if headings_only && turned.iter().any(opposite) {
        faults.push(Fault::TurnsOpposite);
    } else {
        faults.extend(turned);
    }
    (faults, reading)
}

/// The agreement after signs are changed and columns exchanged.
fn turned(found: &Agreement, Reading { opposed, clockwise }: Reading, kind: DriveKind) -> Vec<Fault> {
    let [way, turns] = found.shown;
    let backward = way && found.yaw().abs() > FRAC_PI_2;
    let other_way = turns && found.turn[0] < -LEAST_GAIN;
    if clockwise && other_way && !opposed {
        // Clockwise headings together with wheels that turn the other way have a simpler explanation, whichever way the axes point: a
        // mirrored track.
        let across = way && (found.yaw().abs() - FRAC_PI_2).abs() < FRAC_PI_4;
        return vec![if across { Fault::PositionsExchanged } else { Fault::PositionsMirrored }];
    }
    let of = |counters, exchanged| Some(Fault::Backward { names: kind.counters(), counters, exchanged });
    // The tracked body may face backward. If the wheels also turn the other way, the cause is another one.
    let wheels = match (kind.has_axle_wheels(), opposed, other_way, backward) {
        (_, false, false, _) => None,
        (true, false, true, false) => Some(Fault::Exchanged),
        (true, false, true, true) => of([true, true], false),
        (_, true, false, false) => of([true, false], false),
        (_, true, true, true) => of([false, true], false),
        (_, true, true, false) => of([true, false], true),
        (_, true, false, true) => of([false, true], true),
        // Driven backward, a steered wheel turns the robot the other way.
        (_, false, true, true) if kind.steers() => of([true, false], false),
        // For the other drives, the second counter is that of the steering.
        (_, false, true, _) => of([false, true], false),
    };
    clockwise.then_some(Fault::HeadingClockwise).into_iter().chain(wheels).collect()
}

/// Values whose unit differs from that of their column, and counts that are far off.
pub(super) fn sizes(found: &Agreement, robot: &Robot) -> Vec<Fault> {
    let ratio = found.scale();
    let within = |most: f64| (1.0 / most..=most).contains(&ratio);
    if let Some(factor) = CountsFactor::of(found, robot).filter(|_| !within(MOST_SCALE)) {
        return vec![Fault::Counts(factor)];
    }
    if !found.shown[0] || found.misfits[0] > VAGUE || within(MOST_SCALE) {
        return Vec::new();
    }
    // The nominal diameter may be wrong too, but not by as much as units differ.
    vec![match unit_of(ratio) {
        Some((unit, named)) => Fault::LengthsIn { unit, named, ratio },
        None => Fault::OtherScale { ratio },
    }]
}

/// The unit that makes lengths so many times too large, and the one that their column names.
fn unit_of(ratio: f64) -> Option<(&'static str, &'static str)> {
    let is_near = |size: f64| (ratio / size - 1.0).abs() < 3.0 * NEAR;
    UNITS.into_iter().find(|(size, ..)| is_near(*size)).map(|(_, unit, named)| (unit, named))
}

/// Windows with headings multiplied by a factor.
pub(super) fn scaled(windows: &[Beside], factor: f64) -> Cow<'_, [Beside]> {
    match factor {
        1.0 => windows.into(),
        _ => windows.iter().map(|(window, rolled)| (window.with_headings_times(factor), *rolled)).collect(),
    }
}
