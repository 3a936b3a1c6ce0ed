//! A move in small pieces.

use super::{SpeedProfile, Trapezoid};
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
    /// Speeds of the left and the right wheel \[m/s\].
    speeds: [f64; 2],
}

impl Pieces {
    /// The pieces of a move of believed wheel travel `travel` \[m\], from rest to rest.
    pub fn of(travel: &WheelTravel, speed: &SpeedProfile) -> Pieces {
        Pieces::along(travel, speed.over(travel.left.abs().max(travel.right.abs())))
    }

    /// The same, spread over time by `profile`.
    pub fn along(travel: &WheelTravel, profile: Trapezoid) -> Pieces {
        let most = travel.left.abs().max(travel.right.abs());
        let count = (most / LENGTH).ceil().clamp(0.0, MAX_PIECES) as usize;
        let mut pieces = Pieces { travel: *travel, profile, count, next: 1, reached: Moment::default() };
        pieces.reached = pieces.moment(0.0);
        pieces
    }

    /// The whole move as one piece.
    pub fn whole(travel: &WheelTravel, speed: &SpeedProfile) -> Pieces {
        let all = Pieces::of(travel, speed);
        Pieces { count: all.count.min(1), ..all }
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
        Some(Piece {
            begins: from.share,
            travel: self.travel.scaled(to.share - from.share),
            duration: (to.time - from.time).max(0.0),
            from: from.speeds,
            to: to.speeds,
        })
    }

    fn moment(&self, share: f64) -> Moment {
        let time = self.profile.time(share);
        let rate = self.profile.rate(time);
        Moment { share, time, speeds: [self.travel.left * rate, self.travel.right * rate] }
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

    #[test]
    fn pieces_make_up_the_move_and_begin_as_the_one_before_ends() {
        let speed = SpeedProfile::new(0.5, 0.25, 1.0).unwrap();
        let travel = WheelTravel { left: 2.0, right: -1.0 };
        let pieces: Vec<Piece> = Pieces::of(&travel, &speed).collect();
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
        let mut pieces = Pieces::of(&WheelTravel { left: 0.04, right: 0.02 }, &speed);
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
        let pieces: Vec<Piece> = Pieces::whole(&travel, &SpeedProfile::default()).collect();
        assert_eq!((pieces.len(), pieces[0].travel), (1, travel));
    }

    #[test]
    fn no_travel_has_no_pieces_and_a_long_way_not_too_many() {
        let speed = SpeedProfile::default();
        assert_eq!(Pieces::of(&WheelTravel::default(), &speed).count(), 0);
        assert_eq!(Pieces::of(&WheelTravel { left: 1e4, right: 1e4 }, &speed).count(), 2000);
    }
}
