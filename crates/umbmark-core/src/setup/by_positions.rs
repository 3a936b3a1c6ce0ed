//! Return headings that follow from the return positions.

use crate::drive::Robot;
use crate::effect::{Evaluate, Model};
use crate::fit::{Options, Problem, RANK_TOLERANCE, least_squares, null_directions};
use crate::geometry::{Dual, Pose2, seeded, wrap};
use crate::path::{Direction, Path};
use crate::replay::Track;
use crate::run::ReturnError;
use crate::stats::median;
use nalgebra::{DMatrix, DVector};

/// Return headings \[rad\], clockwise and counter-clockwise, of a robot whose E_d and E_b explain the median return positions; `None` if
/// these do not determine both.
pub(super) fn headings_by_positions(returns: &[Vec<ReturnError>; 2], robot: &Robot, path: &Path) -> Option<[f64; 2]> {
    if !robot.drive.kind().has_axle_wheels() {
        return None;
    }
    let mut model = Model::new(robot);
    model.add("wheel_diameter_ratio").ok()?;
    model.add("wheelbase").ok()?;
    let mut drives = Vec::new();
    for direction in Direction::BOTH {
        let own = &returns[direction as usize];
        let [x, y] = [|e: &ReturnError| e.x, |e: &ReturnError| e.y].map(|of| median(own.iter().map(of).collect()));
        drives.push(Drive {
            track: Track::from_path(path, direction, robot),
            told: path.end(direction),
            returned: [x?, y?],
        });
    }
    let problem = Ends { model, drives };
    let nominal = [1.0, 1.0];
    if !null_directions(&problem.jacobian(&nominal), RANK_TOLERANCE).is_empty() {
        return None;
    }
    let fit = least_squares(&problem, &nominal, &Options::default());
    let ends = problem.ends(&fit.values);
    let headings = problem.drives.iter().zip(ends).map(|(drive, end)| wrap(end.heading - drive.told.heading));
    headings.collect::<Vec<f64>>().try_into().ok()
}

/// The path driven in one direction.
struct Drive {
    track: Track,
    told: Pose2,
    /// Measured minus commanded end \[m\].
    returned: [f64; 2],
}

/// Where a robot with an E_d and an E_b ends.
struct Ends {
    model: Model,
    drives: Vec<Drive>,
}

impl Ends {
    fn ends<T: Evaluate>(&self, values: &[T]) -> Vec<Pose2<T>> {
        let chain = self.model.chain_with(values);
        self.drives.iter().map(|drive| drive.track.end(&chain)).collect()
    }
}

impl Problem for Ends {
    fn residuals(&self, values: &[f64]) -> DVector<f64> {
        let rows = self.drives.iter().zip(self.ends(values)).flat_map(|(drive, end)| {
            let [x, y] = drive.returned;
            [x - (end.x - drive.told.x), y - (end.y - drive.told.y)]
        });
        DVector::from_vec(rows.collect())
    }

    fn jacobian(&self, values: &[f64]) -> DMatrix<f64> {
        let ends = self.ends::<Dual>(&seeded(values.to_vec(), &[0, 1]));
        DMatrix::from_fn(2 * self.drives.len(), values.len(), |row, column| {
            let end = &ends[row / 2];
            -[end.x, end.y][row % 2].eps[column]
        })
    }
}
