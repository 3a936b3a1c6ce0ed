//! Counters that count up whichever way their wheels roll.
//!
//! An encoder with one channel does not know the sense of rotation. Where a wheel rolls backward, as the inner one does in a turn on the spot,
//! its counts then agree with the reference only with the opposite sign. Of every window, that sign of each such counter is taken under which
//! both motions agree best, and all windows are fitted again, a few times over. The counters are named if windows that need the opposite sign
//! agree with it, and disagree with the counts as they are by what all windows together say.

use super::Fault;
use super::agreement::{Agreement, Beside, Reading};
use super::windows::Rolling;
use crate::drive::Robot;
use crate::run::TickLog;
use crate::stats::robust;

/// How often the signs are chosen and the agreement fitted again.
const ROUNDS: usize = 4;
/// In fewer windows the opposite sign may be a matter of chance.
const FEWEST: usize = 8;
/// Both together are so many at least, of all windows in which the wheels clearly roll.
const SHARE: f64 = 0.01;
/// A wheel clearly rolls if by more than this in a window \[m\].
const CLEAR: f64 = 0.01;
/// With the opposite sign the usual disagreement of these windows is below the first, as a share of the travel of their faster wheel; as
/// counted it is above the second.
const AGREES: f64 = 0.25;
const DISAGREES: f64 = 0.6;

/// The fault that counters never count down while their wheels roll backward; of runs, each with its windows.
pub(super) fn counted_up(runs: &[(&TickLog, Vec<Beside>)], robot: &Robot) -> Option<Fault> {
    if !robot.drive.kind().has_axle_wheels() {
        return None;
    }
    let rises =
        |of: fn(&TickLog) -> &[f64]| runs.iter().all(|(log, _)| of(log).windows(2).all(|pair| pair[1] >= pair[0]));
    let rising = [rises(|log| &log.left), rises(|log| &log.right)];
    let windows: Vec<Beside> = runs.iter().flat_map(|(_, own)| own.iter().copied()).collect();
    let headings = windows.iter().all(|(window, _)| window.with_heading && !window.headings_only);
    if rising == [false; 2] || !headings {
        return None;
    }
    let wheelbase = robot.drive.wheelbase();
    let given = Agreement::without_drift(&windows, Reading::default(), wheelbase);
    let mut found = given;
    let mut signed = windows.clone();
    for _ in 0..ROUNDS {
        let chosen: Vec<Beside> = windows.iter().map(|own| best(own, &found, rising, wheelbase)).collect();
        if chosen == signed {
            break;
        }
        signed = chosen;
        found = Agreement::without_drift(&signed, Reading::default(), wheelbase);
    }
    let clear = |(_, rolled): &&Beside| rolled.travel.iter().any(|travel| travel.abs() > CLEAR);
    let turned = |wheel: usize| {
        let pairs = windows.iter().zip(&signed);
        pairs.filter(move |(own, new)| own.1.travel[wheel] > CLEAR && new.1.travel[wheel] < 0.0)
    };
    let counters = [0, 1].map(|wheel| turned(wheel).count() >= FEWEST);
    let (own, new): (Vec<Beside>, Vec<Beside>) = windows
        .iter()
        .zip(&signed)
        .filter(|(own, new)| clear(own) && own.1.travel != new.1.travel)
        .map(|(own, new)| (*own, *new))
        .unzip();
    if counters == [false; 2] || (own.len() as f64) < SHARE * windows.iter().filter(clear).count() as f64 {
        return None;
    }
    let usual = |agreement: &Agreement, windows: &[Beside]| {
        let share = |own: &Beside| off(own, agreement, wheelbase) / own.1.travel[0].abs().max(own.1.travel[1].abs());
        robust::median(windows.iter().map(share))
    };
    let names = robot.drive.kind().counters();
    (usual(&found, &new) < AGREES && usual(&given, &own) > DISAGREES).then_some(Fault::OneWay { names, counters })
}

/// A window with that sign of the counters that never count down under which both motions agree best.
fn best(own: &Beside, agreement: &Agreement, rising: [bool; 2], wheelbase: f64) -> Beside {
    let (window, rolled) = own;
    let tried =
        (0..4).map(|k| [k & 1 != 0, k & 2 != 0]).filter(|back| (0..2).all(|wheel| rising[wheel] || !back[wheel]));
    let signed = tried.map(|back| {
        let [left, right] = back.map(|back| if back { -1.0 } else { 1.0 });
        let [l, r] = rolled.travel;
        (*window, Rolling { travel: [left * l, right * r], aside: 0.0, area: left * right * rolled.area })
    });
    signed.min_by(|a, b| off(a, agreement, wheelbase).total_cmp(&off(b, agreement, wheelbase))).unwrap_or(*own)
}

/// How far both motions of a window disagree \[m\]; a rotation by what it moves a wheel.
fn off(beside: &Beside, agreement: &Agreement, wheelbase: f64) -> f64 {
    let [x, y, turned] = agreement.residual(Reading::default(), beside, wheelbase);
    libm::hypot(libm::hypot(x, y), 0.5 * wheelbase * turned)
}
