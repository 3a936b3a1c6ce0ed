//! A move in small pieces.

use super::{SpeedProfile, Trapezoid};
use crate::drive::WheelTravel;

/// No wheel rolls farther in a piece \[m\], unless the move would fall into more than [`MOST`] of them.
const LENGTH: f64 = 0.01;
const MOST: f64 = 2000.0;

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

/// The pieces of a move, equal in travel.
#[derive(Clone, Debug)]
pub struct Pieces {
    travel: WheelTravel,
    profile: Trapezoid,
    count: usize,
    next: usize,
}

impl Pieces {
    /// The pieces of a move of believed wheel travel `travel` \[m\], from rest to rest.
    pub fn of(travel: &WheelTravel, speed: &SpeedProfile) -> Pieces {
        let most = travel.left.abs().max(travel.right.abs());
        let count = (most / LENGTH).ceil().clamp(0.0, MOST) as usize;
        Pieces { travel: *travel, profile: speed.over(most), count, next: 0 }
    }

    /// The whole move as one piece.
    pub fn whole(travel: &WheelTravel, speed: &SpeedProfile) -> Pieces {
        let all = Pieces::of(travel, speed);
        Pieces { count: all.count.min(1), ..all }
    }

    /// Time since the move began \[s\] and wheel speeds \[m/s\] at piece `k`.
    fn moment(&self, k: usize) -> (f64, [f64; 2]) {
        let time = self.profile.time(k as f64 / self.count as f64);
        let rate = self.profile.rate(time);
        (time, [self.travel.left * rate, self.travel.right * rate])
    }
}

impl Iterator for Pieces {
    type Item = Piece;

    fn next(&mut self) -> Option<Piece> {
        if self.next == self.count {
            return None;
        }
        let (begins, from) = self.moment(self.next);
        let (ends, to) = self.moment(self.next + 1);
        let share = 1.0 / self.count as f64;
        let piece = Piece {
            begins: self.next as f64 * share,
            travel: self.travel.scaled(share),
            duration: ends - begins,
            from,
            to,
        };
        self.next += 1;
        Some(piece)
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
