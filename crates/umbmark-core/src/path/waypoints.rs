//! A path through points.

use super::{Move, PathError, Shape};
use crate::geometry::wrap;

/// Turn towards each point in turn and drive straight to it; x, y of each point \[m\], START at the origin. The clockwise
/// direction is the mirror image in the x axis.
pub static SHAPE: Shape = Shape {
    name: "waypoints",
    about: "straight legs from START through a list of points, `points_m = [[x, y], ..]`, turning on the spot at each",
    parameters: &[],
    closed: false,
    flows: false,
    moves,
};

/// No floor is larger \[m\].
const FARTHEST: f64 = 1e6;

/// Points must be on a floor, and none the same as the one before.
fn check(values: &[f64]) -> Result<(), PathError> {
    let points = values.chunks_exact(2).map(|p| (p[0], p[1]));
    let mut before = (0.0, 0.0);
    for (i, (x, y)) in points.enumerate() {
        if !(x.abs() <= FARTHEST && y.abs() <= FARTHEST) || (x, y) == before {
            return Err(PathError::Waypoint { index: i + 1, x, y });
        }
        before = (x, y);
    }
    if values.is_empty() || !values.len().is_multiple_of(2) {
        return Err(PathError::Count { shape: SHAPE.name, expected: 2, got: values.len() });
    }
    Ok(())
}

fn moves(values: &[f64]) -> Result<Vec<Move>, PathError> {
    check(values)?;
    let (mut x, mut y, mut heading) = (0.0, 0.0, 0.0);
    let mut moves = Vec::new();
    for point in values.chunks_exact(2) {
        let (dx, dy) = (point[0] - x, point[1] - y);
        let towards = libm::atan2(dy, dx);
        let angle = wrap(towards - heading);
        if angle != 0.0 {
            moves.push(Move::Turn { angle });
        }
        moves.push(Move::Straight { length: libm::hypot(dx, dy) });
        (x, y, heading) = (point[0], point[1], towards);
    }
    Ok(moves)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::{Direction, Path, SpeedProfile};

    #[test]
    fn the_robot_ends_at_the_last_point_and_its_mirror_image_at_the_mirrored_one() {
        let path = Path::new(&SHAPE, &[2.0, 0.0, 2.0, 3.0, -1.0, 1.0], SpeedProfile::default()).unwrap();
        let (left, right) = (path.end(Direction::Ccw), path.end(Direction::Cw));
        assert!((left.x + 1.0).abs() < 1e-12 && (left.y - 1.0).abs() < 1e-12);
        assert!((right.x + 1.0).abs() < 1e-12 && (right.y + 1.0).abs() < 1e-12);
    }
}
