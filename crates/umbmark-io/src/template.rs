//! What a new user fills in: a commented `robot.toml` and an empty `returns.csv`.

use super::RobotFile;
use super::error::DatasetError;
use super::file_names::{RETURNS, ROBOT};
use super::save::{Existing, put_beside_logs};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use umbmark_core::dataset::RETURNS_COLUMNS;
use umbmark_core::drive::Robot;
use umbmark_core::path::SHAPES;

const ROBOT_TEXT: &str = r#"# The robot as its own software believes it to be: nominal values, not measured ones.
# Lengths in metres.

[robot]
name = "my robot"
drive = "differential"
wheelbase_m = 0.340            # b: distance of the two drive wheels' contact points with the floor
wheel_diameter_m = 0.150       # both wheels; or wheel_diameter_left_m and wheel_diameter_right_m
ticks_per_revolution = 2000    # encoder counts per turn of the wheel, after gearing and quadrature
encoder_rate_hz = 100.0        # how often the counters are read; or "every tick"
# counter_bits = 16            # only if the counters roll over

# The path that the robot is told to drive, clockwise (cw) and counter-clockwise (ccw).
[path]
shape = "square"               # or one of these:
OTHERS
side_m = 4.0                   # the paper's square
speed_m_s = 0.2                # slow, so that wheels do not slip
"#;

const RETURNS_TEXT: &str = "\
# One row for each drive round the path. At least 5 in each direction; 3 is the least that says anything.
#
# How to measure (Borenstein & Feng 1995, section 3):
#  1. Put the robot on START, along a wall or a line that you can measure from. Set its odometry to zero.
#     x points forward along the robot, y to its left, theta is counter-clockwise; START is 0, 0, 0.
#  2. Have it drive round the path, with stops, at walking pace or slower, and stop where it believes START to be.
#  3. Measure where it really stands: x_abs_m, y_abs_m, theta_abs_rad.
#  4. Write down where it believes to stand: x_calc_m, y_calc_m, theta_calc_rad. Left empty, they mean 0: on START.
#  5. Repeat, with direction cw and ccw, and number the runs of each direction 1, 2, 3, ...
#
# Headings may be left empty where they were not measured. Millimetres and degrees are fine: name the columns _mm, _deg.
# If START itself was measured, as in a room with cameras, add the columns x_start_m, y_start_m, theta_start_rad.
# For the extended test with bumps add a column test, with the words systematic and bumps.
# A row looks like this:
# cw,1,-0.012,0.034,0.006,0.001,0.000,0.001
";

/// Writes the two files into a folder, which is made where it is not there, and returns their paths.
pub fn write_template(folder: impl AsRef<Path>, existing: Existing) -> Result<[PathBuf; 2], DatasetError> {
    let folder = folder.as_ref();
    let [robot, returns] = template();
    let files = BTreeMap::from([(PathBuf::from(ROBOT), robot), (PathBuf::from(RETURNS), returns)]);
    put_beside_logs(folder, &files, existing)?;
    Ok([folder.join(ROBOT), folder.join(RETURNS)])
}

/// Whether a robot still has the name and the numbers of the template.
pub(super) fn is_untouched(robot: &Robot) -> bool {
    let [text, _] = template();
    RobotFile::parse(ROBOT, &text).is_ok_and(|template| {
        let numbers = |robot: &Robot| (robot.name.clone(), robot.drive, robot.encoder.ticks_per_revolution());
        numbers(&template.robot) == numbers(robot)
    })
}

/// The texts of the two files: the robot and the returns.
pub fn template() -> [String; 2] {
    let others: Vec<&str> = SHAPES[1..].iter().map(|shape| shape.name).collect();
    let lines: Vec<String> = others.chunks(4).map(|names| format!("#   {}", names.join(", "))).collect();
    [ROBOT_TEXT.replace("OTHERS", &lines.join("\n")), format!("{RETURNS_TEXT}{RETURNS_COLUMNS}\n")]
}
