//! Sheets of return errors that are read in another way than they were written: directions, axes, signs or units exchanged throughout.
//!
//! No run is far from the others then, and a closed path has few numbers: some effect of the catalogue nearly always fits what the exchange
//! leaves. But E_d and E_b alone fit the sheet as it was written, and do not fit it as it is read:
//!
//! ```text
//! χ²(how) = min over E_d, E_b of Σ (mean - predicted)²/σ²,   σ² = s²/n + reading² + (0.05 size)²
//! ```
//!
//! over the coordinates of the mean return errors of both directions; s is their scatter, and size that of the whole error, because E_s and
//! small effects are left out.

use crate::drive::Robot;
use crate::effect::{Model, TestKind};
use crate::geometry::Pose2;
use crate::path::{Direction, Path};
use crate::replay::Track;
use crate::run::{ReturnError, Run};
use nalgebra::{Matrix2, Vector2};

/// So many returns of each direction are needed.
const FEWEST: usize = 2;
/// A reading of a tape \[m\] and of a protractor \[rad\].
const READING: [f64; 2] = [1e-3, 2e-3];
/// What else is there besides E_d and E_b, as a share of the whole error.
const BESIDE: f64 = 0.05;
/// χ² for each degree of freedom above which the sheet as it is read does not fit, and below which another reading does.
const FITS: (f64, f64) = (25.0, 1.0);
/// |ln E_d| and |ln E_b| of a robot.
const CREDIBLE: [f64; 2] = [0.1, 0.3];
/// Steps of the fit, and of its derivatives.
const STEPS: usize = 12;
const STEP: f64 = 1e-5;

/// How a sheet was written, if not as it is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Written {
    /// Runs that are called clockwise went counterclockwise; or y is counted to the right, and headings clockwise.
    DirectionsExchanged,
    /// x is y, and y is x.
    AxesExchanged,
    /// As computed minus measured.
    SignsReversed,
    /// y is counted to the right.
    RightPositive,
    /// Headings are counted clockwise.
    HeadingsClockwise,
    /// Positions are so many times as large, of both directions or of one.
    Scaled(f64, Option<Direction>),
    /// Headings are so many times as large.
    HeadingsScaled(f64),
}

/// A sheet that E_d and E_b fit, if it is read in another way.
#[derive(Clone, Debug, PartialEq)]
pub struct Misread {
    /// The ways under which they do, the best first.
    pub written: Vec<Written>,
    /// What E_d and E_b leave of the mean return errors as they are read, root mean square \[m\].
    pub as_read: f64,
    /// The same in the best of these ways \[m\].
    pub left: f64,
}

impl Written {
    /// All of them; without headings, some are the same as others, and scales do not show.
    fn all(with_headings: bool) -> Vec<Written> {
        let mut all = vec![Written::DirectionsExchanged, Written::AxesExchanged, Written::SignsReversed];
        if with_headings {
            all.extend([Written::RightPositive, Written::HeadingsClockwise]);
            let degree = 1f64.to_degrees();
            all.extend([degree, 1.0 / degree].map(Written::HeadingsScaled));
            for side in [None, Some(Direction::Cw), Some(Direction::Ccw)] {
                all.extend([10.0, 0.1, 25.4, 1.0 / 25.4].map(|factor| Written::Scaled(factor, side)));
            }
            all.extend([2.0, 0.5].map(|factor| Written::Scaled(factor, None)));
        }
        all
    }

    /// The mean return errors (clockwise, counterclockwise) as they were written.
    fn read(self, [cw, ccw]: [Pose2; 2]) -> [Pose2; 2] {
        let each = |of: fn(Pose2) -> Pose2| [of(cw), of(ccw)];
        match self {
            Written::DirectionsExchanged => [ccw, cw],
            Written::AxesExchanged => each(|p| Pose2::new(p.y, p.x, p.heading)),
            Written::SignsReversed => each(|p| Pose2::new(-p.x, -p.y, -p.heading)),
            Written::RightPositive => each(|p| Pose2::new(p.x, -p.y, p.heading)),
            Written::HeadingsClockwise => each(|p| Pose2::new(p.x, p.y, -p.heading)),
            Written::HeadingsScaled(factor) => [cw, ccw].map(|p| Pose2::new(p.x, p.y, factor * p.heading)),
            Written::Scaled(factor, side) => {
                let of = |direction, p: Pose2| match side {
                    Some(side) if side != direction => p,
                    _ => Pose2::new(factor * p.x, factor * p.y, p.heading),
                };
                [of(Direction::Cw, cw), of(Direction::Ccw, ccw)]
            }
        }
    }

    /// What would have to be so, and what to do then.
    fn words(self) -> String {
        let of = |side: Option<Direction>| side.map_or(String::new(), |side| format!(" of the {} runs", side.name()));
        match self {
            Written::DirectionsExchanged => "cw and ccw are exchanged, or y is counted to the right and headings clockwise, or x is counted backward (exchange the \
                                             directions, or change the signs)"
                .into(),
            Written::AxesExchanged => "x and y are exchanged (x points along the first leg, y to the left)".into(),
            Written::SignsReversed => {
                "the signs are those of computed minus measured (change them: an error is measured minus computed)".into()
            }
            Written::RightPositive => "y is counted to the right (change its sign)".into(),
            Written::HeadingsClockwise => "headings are counted clockwise (change their sign)".into(),
            Written::HeadingsScaled(factor) if factor > 1.0 => "headings are in radians (name their column etheta_rad)".into(),
            Written::HeadingsScaled(_) => "headings are in degrees (name their column etheta_deg)".into(),
            Written::Scaled(2.0, _) => "the sides of the path are half as long as in [path], or positions twice as large".into(),
            Written::Scaled(0.5, _) => "the sides of the path are twice as long as in [path], or positions half as large".into(),
            Written::Scaled(factor, side) if factor > 20.0 => format!("positions{} are in inches", of(side)),
            Written::Scaled(factor, side) if factor < 0.05 => format!("positions{} are 25.4 times too large", of(side)),
            Written::Scaled(factor, side) if factor > 1.0 => format!("positions{} are a tenth of what they should be", of(side)),
            Written::Scaled(_, side) => format!("positions{} are ten times what they should be", of(side)),
        }
    }
}

impl Misread {
    /// Whether E_d and E_b do not fit the return errors of the regular runs as they are read, but do in another way.
    pub(super) fn of(runs: &[Run], robot: &Robot, path: &Path) -> Option<Misread> {
        let sheet = Sheet::new(runs, robot, path)?;
        let as_read = sheet.fit(sheet.means)?;
        if as_read.misfit < FITS.0 {
            return None;
        }
        let fitted = |written: Written| Some((written, sheet.fit(written.read(sheet.means))?));
        let mut others: Vec<(Written, Fitted)> = Written::all(sheet.with_headings)
            .into_iter()
            .filter_map(fitted)
            .filter(|(_, fit)| fit.misfit < FITS.1)
            .collect();
        others.sort_by(|(_, a), (_, b)| a.misfit.total_cmp(&b.misfit));
        let left = others.first()?.1.left;
        Some(Misread { written: others.into_iter().map(|(written, _)| written).collect(), as_read: as_read.left, left })
    }

    /// In a sentence, without a full stop.
    pub(super) fn sentence(&self) -> String {
        let ways: Vec<String> = self.written.iter().map(|written| written.words()).collect();
        format!(
            "E_d and E_b leave {:.0} mm of the mean return errors as they are read, and {:.0} mm if {}",
            1e3 * self.as_read,
            1e3 * self.left,
            ways.join("; or if ")
        )
    }
}

/// The mean return errors of the regular runs of a sheet.
struct Sheet<'a> {
    robot: &'a Robot,
    tracks: [Track; 2],
    ends: [Pose2; 2],
    means: [Pose2; 2],
    /// Variances of the means of a coordinate \[m²\] and a heading \[rad²\].
    variances: [f64; 2],
    with_headings: bool,
    /// A heading changes places by so much \[m/rad\].
    arm: f64,
}

struct Fitted {
    /// χ² for each degree of freedom.
    misfit: f64,
    /// Root mean square of what is left of the positions \[m\].
    left: f64,
}

impl<'a> Sheet<'a> {
    fn new(runs: &[Run], robot: &'a Robot, path: &Path) -> Option<Sheet<'a>> {
        let written = |direction| {
            let own =
                runs.iter().filter(move |run| run.test == TestKind::Systematic && run.direction == Some(direction));
            own.filter_map(|run| run.returned.filter(|_| run.log.is_none())).collect::<Vec<ReturnError>>()
        };
        let groups = Direction::BOTH.map(written);
        let axle = robot.drive.kind().has_axle_wheels();
        if !axle || path.shape().name == "waypoints" || groups.iter().any(|group| group.len() < FEWEST) {
            return None;
        }
        let with_headings = groups.iter().flatten().all(|error| error.heading.is_some());
        let means = [0, 1].map(|group| mean(&groups[group]));
        let least = groups.iter().map(Vec::len).min()? as f64;
        let freedom = (groups.iter().map(Vec::len).sum::<usize>() - 2) as f64;
        let squares = |of: fn(&ReturnError, &Pose2) -> f64| {
            let sum = groups
                .iter()
                .zip(&means)
                .flat_map(|(group, mean)| group.iter().map(move |error| of(error, mean)))
                .sum::<f64>();
            sum / freedom / least
        };
        let place = squares(|error, mean| 0.5 * ((error.x - mean.x).powi(2) + (error.y - mean.y).powi(2)));
        let heading = squares(|error, mean| (error.heading.unwrap_or(0.0) - mean.heading).powi(2));
        let tracks = Direction::BOTH.map(|direction| Track::from_path(path, direction, robot));
        let plain = Model::new(robot).chain();
        let ends = [0, 1].map(|group: usize| tracks[group].end(&plain));
        let arm = tracks[0].length() / 8.0;
        Some(Sheet { robot, ends, tracks, means, variances: [place, heading], with_headings, arm })
    }

    /// The return errors of both directions by these values.
    fn predicted(&self, values: Vector2<f64>) -> Option<[Pose2; 2]> {
        let mut model = Model::new(self.robot);
        for (effect, parameter, value) in [("wheel_diameter_ratio", "e_d", values[0]), ("wheelbase", "e_b", values[1])]
        {
            model.add(effect).ok()?;
            model.set(effect, parameter, libm::exp(value)).ok()?;
        }
        let chain = model.chain();
        Some([0, 1].map(|group: usize| {
            let (end, plain) = (self.tracks[group].end(&chain), self.ends[group]);
            Pose2::new(end.x - plain.x, end.y - plain.y, end.heading - plain.heading)
        }))
    }

    /// The best fit of E_d and E_b to mean return errors; `None` if no robot has such values.
    fn fit(&self, means: [Pose2; 2]) -> Option<Fitted> {
        let arm = if self.with_headings { self.arm } else { 0.0 };
        let numbers = |poses: [Pose2; 2]| poses.map(|p| [p.x, p.y, arm * p.heading]).concat();
        let told = numbers(means);
        let counted = if self.with_headings { 6 } else { 4 };
        let size = told.iter().map(|value| value * value).sum::<f64>() / f64::from(counted);
        let variance = |k: usize| {
            let (spread, reading) =
                if k % 3 == 2 { (self.variances[1], READING[1]) } else { (self.variances[0], READING[0]) };
            let unit = if k % 3 == 2 { arm } else { 1.0 };
            unit * unit * (spread + reading * reading) + BESIDE * BESIDE * size
        };
        let left =
            |values| Some(numbers(self.predicted(values)?).iter().zip(&told).map(|(p, t)| t - p).collect::<Vec<f64>>());
        let mut values = Vector2::zeros();
        for _ in 0..STEPS {
            let now = left(values)?;
            let slopes = [0, 1].map(|k| {
                let mut beside = values;
                beside[k] += STEP;
                Some(left(beside)?.iter().zip(&now).map(|(b, n)| (n - b) / STEP).collect::<Vec<f64>>())
            });
            let [Some(first), Some(second)] = slopes else { return None };
            let sum = |a: &[f64], b: &[f64]| (0..told.len()).map(|k| a[k] * b[k] / variance(k)).sum::<f64>();
            let products =
                Matrix2::new(sum(&first, &first), sum(&first, &second), sum(&first, &second), sum(&second, &second));
            values += products.lu().solve(&Vector2::new(sum(&first, &now), sum(&second, &now)))?;
            if !(values[0].abs() < CREDIBLE[0] && values[1].abs() < CREDIBLE[1]) {
                return (values.norm() < 1.0).then(|| Fitted { misfit: f64::INFINITY, left: of_places(&told) });
            }
        }
        let now = left(values)?;
        let misfit = (0..told.len()).map(|k| now[k] * now[k] / variance(k)).sum::<f64>() / f64::from(counted - 2);
        Some(Fitted { misfit, left: of_places(&now) })
    }
}

/// Root mean square distance of both places \[m\].
fn of_places(numbers: &[f64]) -> f64 {
    (0.5 * [0, 1, 3, 4].map(|k| numbers[k] * numbers[k]).iter().sum::<f64>()).sqrt()
}

fn mean(errors: &[ReturnError]) -> Pose2 {
    let of = |of: fn(&ReturnError) -> f64| errors.iter().map(of).sum::<f64>() / errors.len() as f64;
    Pose2::new(of(|error| error.x), of(|error| error.y), of(|error| error.heading.unwrap_or(0.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::wrap;

    /// Ten returns of a robot with E_d and E_b off, by arcs of its own, and a scatter of some millimetres.
    fn sheet(with_headings: bool) -> Vec<Run> {
        let robot = Robot::labmate();
        let (b, e_d, e_b) = (robot.drive.wheelbase(), 1.006, 0.97);
        let run = |number: u32| {
            let direction = Direction::BOTH[number as usize % 2];
            let sense = if direction == Direction::Ccw { 1.0 } else { -1.0 };
            let mut pose = Pose2::IDENTITY;
            let mut roll = |left: f64, right: f64| {
                let (left, right) = (left * 2.0 / (1.0 + e_d), right * 2.0 * e_d / (1.0 + e_d));
                for _ in 0..1000 {
                    let (way, turn) = (5e-4 * (left + right), 1e-3 * (right - left) / (b * e_b));
                    let heading = pose.heading + 0.5 * turn;
                    pose = Pose2::new(
                        pose.x + way * libm::cos(heading),
                        pose.y + way * libm::sin(heading),
                        pose.heading + turn,
                    );
                }
            };
            for _ in 0..4 {
                roll(4.0, 4.0);
                let arc = sense * 0.5 * b * std::f64::consts::FRAC_PI_2;
                roll(-arc, arc);
            }
            let scatter = f64::from(number * 7 % 5) - 2.0;
            let heading = with_headings.then(|| wrap(pose.heading) + 2e-3 * scatter);
            let returned = Some(ReturnError { x: pose.x + 3e-3 * scatter, y: pose.y - 2e-3 * scatter, heading });
            let (test, direction) = (TestKind::Systematic, Some(direction));
            Run { name: format!("run {number}"), number, direction, test, log: None, returned }
        };
        (0..10).map(run).collect()
    }

    fn found(runs: &[Run]) -> Option<Misread> {
        Misread::of(runs, &Robot::labmate(), &Path::umbmark())
    }

    /// The sheet with every error as another person writes it down.
    fn written(with_headings: bool, of: impl Fn(&mut Run)) -> Vec<Run> {
        let mut runs = sheet(with_headings);
        runs.iter_mut().for_each(of);
        runs
    }

    fn error(run: &mut Run) -> &mut ReturnError {
        run.returned.as_mut().unwrap()
    }

    #[test]
    fn a_sheet_as_it_should_be_is_read_as_it_is() {
        assert_eq!([true, false].map(|with_headings| found(&sheet(with_headings))), [None, None]);
    }

    #[test]
    fn exchanged_directions_axes_and_signs_are_named() {
        for with_headings in [true, false] {
            let exchange = |run: &mut Run| run.direction = run.direction.map(|d| Direction::BOTH[1 - d as usize]);
            let misread = found(&written(with_headings, exchange)).unwrap();
            assert_eq!(misread.written[0], Written::DirectionsExchanged);
            assert!(misread.left < 0.05 * misread.as_read, "{misread:?}");
            assert!(misread.sentence().contains(" mm if cw and ccw are exchanged"), "{}", misread.sentence());
        }
        let axes = |run: &mut Run| *error(run) = ReturnError { x: error(run).y, y: error(run).x, ..*error(run) };
        assert_eq!(found(&written(true, axes)).unwrap().written[0], Written::AxesExchanged);
        let right = |run: &mut Run| error(run).y *= -1.0;
        assert_eq!(found(&written(true, right)).unwrap().written[0], Written::RightPositive);
        let clockwise = |run: &mut Run| error(run).heading = error(run).heading.map(|heading| -heading);
        assert_eq!(found(&written(true, clockwise)).unwrap().written[0], Written::HeadingsClockwise);
    }

    #[test]
    fn units_that_are_not_those_of_the_column_are_named() {
        for (factor, side) in [(0.1, None), (1.0 / 25.4, None), (0.5, None), (0.1, Some(Direction::Ccw))] {
            let scale = |run: &mut Run| {
                let factor = if side.is_none_or(|side| Some(side) == run.direction) { factor } else { 1.0 };
                *error(run) = ReturnError { x: factor * error(run).x, y: factor * error(run).y, ..*error(run) };
            };
            let misread = found(&written(true, scale)).unwrap();
            let Written::Scaled(told, whose) = misread.written[0] else { panic!("{misread:?}") };
            assert!((told * factor - 1.0).abs() < 1e-12 && whose == side, "{misread:?}");
        }
        let radians = |run: &mut Run| error(run).heading = error(run).heading.map(f64::to_radians);
        assert!(
            matches!(found(&written(true, radians)).unwrap().written[0], Written::HeadingsScaled(factor) if factor > 1.0)
        );
    }
}
