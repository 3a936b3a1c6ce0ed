//! Rigid bodies as OptiTrack's Motive exports them: CSV with five or six lines of header.
//!
//! ```text
//! Format Version,1.23,..,Rotation Type,YXZ,Length Units,Meters,Coordinate Space,Global
//!
//! ,Type,Rigid Body,Rigid Body,..
//! ,Name,robot,robot,..
//! ,ID,..
//! ,,Rotation,Rotation,Rotation,Position,Position,Position,Mean Marker Error,..
//! Frame,Time (Seconds),Y,X,Z,X,Y,Z,,..
//! ```
//!
//! Rotations are degrees about the named axes, each in the frame that the ones before left, or quaternions. A frame in which
//! the body was not seen has empty cells. Motive's y axis points up, unless the height of the body says otherwise: up is the
//! axis along which the body moves least. The floor's x and y are the two axes that follow it (z, x for y up), so headings stay
//! counter-clockwise as seen from above.

use super::Layout;
use crate::error::{At, DatasetError, LineProblem, quoted};
use crate::sheet::Rows;
use crate::source::Source;
use crate::track_rows::TrackRows;
use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};

pub(super) const LAYOUT: Layout = Layout::new("motive", "rigid bodies as OptiTrack's Motive exports them")
    .reads_tracks((&[], is_motive, parse_motive));

/// How the first line of a file of Motive begins.
const FORMAT: &str = "Format Version";
const REMEDY: &str = "export the robot's rigid body from Motive as CSV, with rotation and position";
/// Another axis than y is up where the body moves so many times less along it.
const CLEARLY: f64 = 3.0;

/// Whether a text is an export of Motive.
fn is_motive(text: &str) -> bool {
    text.trim_start_matches(['"', '\u{feff}']).starts_with(FORMAT)
}

/// Where the columns of the body are, and what they hold.
struct Body {
    /// How many of the length unit make a metre.
    per_metre: f64,
    /// Letters of the rotation's axes, in order; `None` for quaternions.
    euler: Option<Vec<usize>>,
    /// Columns of the rotation about (or the component along) x, y, z, and w of a quaternion.
    rotation: [Option<usize>; 4],
    position: [usize; 3],
}

/// The poses of the one rigid body in a file.
fn parse_motive(source: Source, warnings: &mut Vec<String>) -> Result<TrackRows, DatasetError> {
    let mut lines = Rows::of(source);
    let file = lines.file().to_owned();
    let body = Body::read(&file, &mut lines)?;
    let mut rows = TrackRows { file: file.clone(), column: "Time (Seconds)".into(), ..TrackRows::default() };
    let mut found: Vec<(Vector3<f64>, Matrix3<f64>)> = Vec::new();
    while let Some(row) = lines.next()? {
        let cell = |column: usize| row.cell(column);
        let columns = || body.position.into_iter().chain(body.rotation.into_iter().flatten());
        if columns().all(|column| cell(column).is_empty()) {
            rows.lost += 1;
            continue;
        }
        let number = |column: usize, name: &str| row.own_number(name, cell(column));
        let mut position = Vector3::zeros();
        for (axis, column) in body.position.into_iter().enumerate() {
            position[axis] = number(column, "Position")? / body.per_metre;
        }
        rows.lines.push(row.line);
        rows.time.push(number(1, "Time (Seconds)")?);
        found.push((position, body.rotation(|column| number(column, "Rotation"))?));
    }
    if found.is_empty() {
        return Err(refused(&file, "the rigid body is in none of the frames"));
    }
    let up = up_axis(&found);
    if up != 1 {
        warnings.push(format!("{file}: the body stays at one height along {}: taken to point up", ["x", "y", "z"][up]));
    }
    let (x, y) = ((up + 1) % 3, (up + 2) % 3);
    rows.poses = found.iter().map(|(p, r)| (p[x], p[y], Some(libm::atan2(r[(y, x)], r[(x, x)])))).collect();
    Ok(rows)
}

/// The axis along which the body moves least; y unless another is clearly less.
fn up_axis(found: &[(Vector3<f64>, Matrix3<f64>)]) -> usize {
    let range = |axis: usize| {
        let values = || found.iter().map(|(position, _)| position[axis]);
        values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
    };
    [0, 2].into_iter().find(|axis| range(*axis) * CLEARLY < range(1)).unwrap_or(1)
}

fn refused(file: &str, found: &str) -> DatasetError {
    DatasetError::NotADataset { file: file.to_owned(), found: found.to_owned(), remedy: REMEDY.into() }
}

impl Body {
    fn read(file: &str, lines: &mut Rows) -> Result<Body, DatasetError> {
        let (mut types, mut names, mut kinds) = (Vec::new(), Vec::new(), Vec::new());
        let (mut per_metre, mut rotation_type) = (1.0, String::from("XYZ"));
        while let Some(row) = lines.next()? {
            let owned = || row.cells().map(str::to_owned).collect::<Vec<String>>();
            let after = |key: &str| row.cells().skip_while(|cell| *cell != key).nth(1);
            match (row.cell(0), row.cell(1)) {
                (FORMAT, _) => {
                    per_metre = per_metre_of(file, row.line, after("Length Units").unwrap_or("Meters"))?;
                    rotation_type = after("Rotation Type").unwrap_or("XYZ").to_uppercase();
                }
                (_, "Type") => types = owned(),
                (_, "Name") => names = owned(),
                (_, "ID" | "Parent") => {}
                ("Frame", _) => return Body::of(file, per_metre, &rotation_type, [&types, &names, &kinds, &owned()]),
                _ => kinds = owned(),
            }
        }
        Err(refused(file, "it is an export of Motive without a line of column names (Frame, Time (Seconds), ..)"))
    }

    fn of(file: &str, per_metre: f64, rotation_type: &str, header: [&[String]; 4]) -> Result<Body, DatasetError> {
        let [types, names, kinds, axes] = header;
        let at = |row: &[String], column: usize| row.get(column).cloned().unwrap_or_default();
        let body: Vec<usize> = (2..axes.len()).filter(|c| at(types, *c) == "Rigid Body").collect();
        let mut bodies: Vec<String> = body.iter().map(|column| at(names, *column)).collect();
        bodies.dedup();
        if bodies.is_empty() {
            return Err(refused(file, "no rigid body is in it"));
        }
        if bodies.len() > 1 {
            let bodies: Vec<String> = bodies.iter().map(|name| quoted(name)).collect();
            return Err(refused(file, &format!("it has {} rigid bodies ({})", bodies.len(), bodies.join(", "))));
        }
        let place =
            |kind: &str, axis: &str| body.iter().copied().find(|c| at(kinds, *c) == kind && at(axes, *c) == axis);
        let position = ["X", "Y", "Z"].map(|axis| place("Position", axis));
        let rotation = ["X", "Y", "Z", "W"].map(|axis| place("Rotation", axis));
        let euler = match rotation_type {
            "QUATERNION" => None,
            letters => Some(letters.chars().filter_map(|c| "XYZ".find(c)).collect::<Vec<usize>>()),
        };
        let turned = euler.as_ref().map_or(4, |letters| if letters.len() == 3 { 3 } else { 5 });
        match position {
            [Some(x), Some(y), Some(z)] if rotation.iter().take(turned).flatten().count() == turned => {
                Ok(Body { per_metre, euler, rotation, position: [x, y, z] })
            }
            _ => Err(refused(file, "its rigid body has no position or no rotation")),
        }
    }

    /// The rotation of a frame, world from body.
    fn rotation(&self, number: impl Fn(usize) -> Result<f64, DatasetError>) -> Result<Matrix3<f64>, DatasetError> {
        let mut values = [0.0; 4];
        for (value, column) in values.iter_mut().zip(self.rotation) {
            *value = column.map_or(Ok(0.0), &number)?;
        }
        let Some(letters) = &self.euler else {
            let [x, y, z, w] = values;
            return Ok(*UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)).to_rotation_matrix().matrix());
        };
        let axes = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
        let about = |axis: &usize| Rotation3::from_axis_angle(&axes[*axis], values[*axis].to_radians());
        Ok(*letters.iter().fold(Rotation3::identity(), |turned, axis| turned * about(axis)).matrix())
    }
}

fn per_metre_of(file: &str, line: usize, unit: &str) -> Result<f64, DatasetError> {
    match unit {
        "Meters" => Ok(1.0),
        "Centimeters" => Ok(100.0),
        "Millimeters" => Ok(1000.0),
        _ => Err(At::new(file, line).refuse(LineProblem::Value {
            key: "Length Units".into(),
            value: quoted(unit),
            allowed: "Meters, Centimeters or Millimeters".into(),
            remedy: "".into(),
        })),
    }
}
