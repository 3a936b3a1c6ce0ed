//! A move in small pieces.

use super::Trapezoid;
use crate::drive::WheelTravel;

/// No wheel rolls farther in a piece \[m\], unless the move would fall into more than [`MAX_PIECES`] of them.
const LENGTH: f64 = 0.01;
const MAX_PIECES: f64 = 2000.0;

/// A small piece of a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Share of the move's travel done when it begins.
    pub begins: f64,
    /// Believed wheel travel \[m\].
    pub travel: WheelTravel,
    /// Believed way to the left \[m\].
    pub left: f64,
    /// Mean speed to the left \[m/s\].
    pub speed_left: f64,
    /// \[s\]
    pub duration: f64,
    /// Speeds of the left and the right wheel when it begins \[m/s\].
    pub from: [f64; 2],
    /// Speeds of the left and the right wheel when it ends \[m/s\].
    pub to: [f64; 2],
}

/// The pieces of a move, equal in travel unless something else [cuts](Pieces::until) it.
#[derive(Clone, Debug)]
pub struct Pieces {
    travel: WheelTravel,
    left: f64,
    profile: Trapezoid,
    count: usize,
    /// Number of the next cut, from 1.
    next: usize,
    reached: Moment,
}

/// How far a move has come.
#[derive(Clone, Copy, Debug, Default)]
struct Moment {
    /// Share of its travel.
    share: f64,
    /// \[s\]
    time: f64,
    /// Share of its travel made per second \[1/s\].
    rate: f64,
    /// Speeds of the left and the right wheel \[m/s\].
    speeds: [f64; 2],
}

impl Pieces {
    /// The pieces of a believed travel of the axle's wheels, and of a way to the left \[m\], spread over time by `profile`.
    pub fn along(travel: &WheelTravel, left: f64, profile: Trapezoid) -> Pieces {
        let most = travel.farthest().max(left.abs());
        let count = (most / LENGTH).ceil().clamp(0.0, MAX_PIECES) as usize;
        let mut pieces = Pieces { travel: *travel, left, profile, count, next: 1, reached: Moment::default() };
        pieces.reached = pieces.moment(0.0);
        pieces
    }

    /// The same move in pieces that are so many times as long.
    pub fn coarser(self, times: usize) -> Pieces {
        Pieces { count: self.count.div_ceil(times), ..self }
    }

    /// The same move as one piece.
    pub fn in_one(self) -> Pieces {
        Pieces { count: self.count.min(1), ..self }
    }

    /// The next piece, up to the next cut or to where `share` of the travel is done, whichever comes first; none where it
    /// is done already.
    #[inline]
    pub fn until(&mut self, share: f64) -> Option<Piece> {
        if self.count == 0 || self.reached.share >= share.min(1.0) {
            return None;
        }
        let cut = self.next as f64 / self.count as f64;
        if cut <= share {
            self.next += 1;
        }
        let (from, to) = (self.reached, self.moment(cut.min(share)));
        self.reached = to;
        let share = to.share - from.share;
        Some(Piece {
            begins: from.share,
            travel: self.travel.scaled(share),
            left: self.left * share,
            speed_left: 0.5 * self.left * (from.rate + to.rate),
            duration: (to.time - from.time).max(0.0),
            from: from.speeds,
            to: to.speeds,
        })
    }

    fn moment(&self, share: f64) -> Moment {
        let time = self.profile.time(share);
        let rate = self.profile.rate(time);
        Moment { share, time, rate, speeds: [self.travel.left * rate, self.travel.right * rate] }
    }
}

impl Iterator for Pieces {
    type Item = Piece;

    fn next(&mut self) -> Option<Piece> {
        self.until(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::DriveKind;
    use crate::path::{Move, SpeedProfile};

    /// The pieces of a travel of two wheels.
    fn along(travel: &WheelTravel, speed: &SpeedProfile) -> Pieces {
        Pieces::along(travel, 0.0, speed.over(travel.farthest()))
    }

    #[test]
    fn pieces_make_up_the_move_and_begin_as_the_one_before_ends() {
        let speed = SpeedProfile::new(0.5, 0.25, 1.0).unwrap();
        let travel = WheelTravel { left: 2.0, right: -1.0 };
        let pieces: Vec<Piece> = along(&travel, &speed).collect();
        assert_eq!(pieces.len(), 200);
        assert!((pieces.iter().map(|p| p.travel.right).sum::<f64>() + 1.0).abs() < 1e-12);
        assert!((pieces.iter().map(|p| p.duration).sum::<f64>() - speed.over(2.0).duration()).abs() < 1e-9);
        assert!(pieces.windows(2).all(|pair| pair[0].to == pair[1].from));
        assert_eq!((pieces[0].from, pieces[199].to), ([0.0; 2], [0.0; 2]));
        assert!((pieces[100].from[0] - 0.5).abs() < 1e-12 && (pieces[100].from[1] + 0.25).abs() < 1e-12);
    }

    #[test]
    fn a_move_can_be_cut_anywhere_and_stays_cut_where_it_was() {
        let speed = SpeedProfile::default();
        let mut pieces = along(&WheelTravel { left: 0.04, right: 0.02 }, &speed);
        let mut begins = Vec::new();
        for share in [0.1, 0.1, 0.3, 0.5, 0.9, 1.0] {
            while let Some(piece) = pieces.until(share) {
                begins.push(piece.begins);
            }
        }
        assert_eq!(begins, [0.0, 0.1, 0.25, 0.3, 0.5, 0.75, 0.9]);
        assert_eq!(pieces.next(), None);
    }

    #[test]
    fn a_whole_move_is_one_piece() {
        let travel = WheelTravel { left: 2.0, right: 2.0 };
        let pieces: Vec<Piece> = along(&travel, &SpeedProfile::default()).in_one().collect();
        assert_eq!((pieces.len(), pieces[0].travel), (1, travel));
    }

    #[test]
    fn a_way_to_the_side_is_cut_like_a_way_ahead_and_as_fast_as_its_fastest_wheel() {
        let (speed, drive) = (SpeedProfile::new(0.5, 0.25, 1.0).unwrap(), DriveKind::Mecanum.usual());
        for (ahead, left, most) in [(0.0, 2.0, 2.0), (1.0, -1.0, 2.0), (1.0, 0.0, 1.0)] {
            let slide = Move::Slide { ahead, left };
            let profile = speed.over(slide.farthest(&drive));
            let pieces: Vec<Piece> = Pieces::along(&slide.wheel_travel(&drive), left, profile).collect();
            assert_eq!(pieces.len(), (100.0 * ahead.abs().max(left.abs())) as usize);
            assert!((pieces.iter().map(|p| p.left).sum::<f64>() - left).abs() < 1e-12);
            assert!((pieces.iter().map(|p| p.travel.left).sum::<f64>() - ahead).abs() < 1e-12);
            assert!((pieces.iter().map(|p| p.duration).sum::<f64>() - speed.over(most).duration()).abs() < 1e-9);
            // What is made at constant speed is made at that speed.
            let middle = &pieces[pieces.len() / 2];
            assert!((middle.speed_left - middle.left / middle.duration).abs() < 1e-9, "{middle:?}");
        }
    }

    #[test]
    fn no_travel_has_no_pieces_and_a_long_way_not_too_many() {
        let speed = SpeedProfile::default();
        assert_eq!(along(&WheelTravel::default(), &speed).count(), 0);
        assert_eq!(along(&WheelTravel { left: 1e4, right: 1e4 }, &speed).count(), 2000);
    }
}
