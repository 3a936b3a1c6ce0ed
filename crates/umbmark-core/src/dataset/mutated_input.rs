//! No input makes a reader panic: good files with random damage, always the same damage for the same seed.

use super::model_file::parse_model;
use super::recording::Recording;
use super::robot_file::parse_robot;
use super::start_frame::move_to_start;
use super::{TickLog, optiodom, returns, text, tick_log};
use crate::drive::Robot;
use crate::random::Stream;

const ROUNDS: u64 = 20_000;
/// Pieces that parsers trip over.
const PIECES: [&str; 20] = [
    ",",
    "\n",
    "\r\n",
    "\"",
    "#",
    "nan",
    "-inf",
    "1e308",
    "-1e-308",
    "9007199254740993",
    "=",
    "[",
    "]]",
    "{",
    "\u{feff}",
    "\0",
    "ä",
    ";",
    "",
    "-0",
];

/// `good` with up to five bytes changed, pieces put in, or parts cut out or doubled.
pub(super) fn damage(good: &[u8], stream: &mut Stream) -> Vec<u8> {
    let mut bytes = good.to_vec();
    let mut below = |n: usize| ((stream.uniform() * n as f64) as usize).min(n.saturating_sub(1));
    for _ in 0..=below(5) {
        let (a, b) = (below(bytes.len() + 1), below(bytes.len() + 1));
        let (a, b) = (a.min(b), a.max(b));
        match below(5) {
            0 if a < bytes.len() => bytes[a] = below(256) as u8,
            1 => drop(bytes.splice(a..a, PIECES[below(PIECES.len())].bytes())),
            2 => drop(bytes.splice(a..b.min(a + 12), PIECES[below(PIECES.len())].bytes())),
            3 => drop(bytes.drain(a..b)),
            _ => {
                let copy = bytes[a..b].to_vec();
                drop(bytes.splice(a..a, copy));
            }
        }
    }
    bytes
}

/// Damages a file many times; says how often it was still read.
fn survive(good: &str, purpose: u64, read: impl Fn(&str) -> bool) {
    let mut stream = Stream::new(7, purpose, 0);
    let mut fine = 0;
    for _ in 0..ROUNDS {
        let Ok(text) = text::decode("file", damage(good.as_bytes(), &mut stream)) else { continue };
        fine += usize::from(read(&text));
    }
    assert!(read(good), "the undamaged file is good");
    assert!(fine > 0 && fine < ROUNDS as usize, "{fine}: damage too heavy or too light to tell anything");
}

fn finished(recording: Recording, bits: Option<u32>) -> bool {
    let log = recording.into_log(Some(&Robot::labmate()), bits, &mut Vec::new());
    let finite = |log: &TickLog| log.left.iter().chain(&log.right).chain(&log.time).all(|value| value.is_finite());
    log.is_ok_and(|mut log| {
        let moved = move_to_start("file", &mut log, &mut Vec::new()).is_ok();
        assert!(finite(&log));
        assert!(log.reference.iter().all(|p| p.x.is_finite() && p.y.is_finite()));
        moved
    })
}

#[test]
fn damaged_return_sheets() {
    let good = "direction,run,test,x_abs_m,y_abs_m,theta_abs_rad,x_calc_m,y_calc_m,theta_calc_rad,x_start_m,y_start_m,theta_start_rad\n\
                # Monday\r\ncw,1,bumps,0.1,-0.2,0.3,1e-3,0,0,1,2,3\n\"ccw\",2,,0.1,-0.2,,1e-3,0,,1,2,3\n";
    survive(good, 1, |text| {
        returns::parse_returns("file", text, &mut Vec::new()).is_ok_and(|rows| {
            assert!(rows.iter().all(|row| row.error.x.is_finite() && row.error.heading.is_none_or(f64::is_finite)));
            true
        })
    });
}

#[test]
fn damaged_tick_logs() {
    let good = "t_s,ticks_left,ticks_right,x_ref_m,y_ref_m,theta_ref_rad\n0.00,65530,3,0.001,0,0\n0.01,65534,65533,,,\n\
                0.02,3,65530,0.002,0.01,\n0.03,9,65500,0.002,0.01,-6.2\n";
    for (purpose, bits) in [(2, Some(16)), (3, None)] {
        let good = if bits.is_some() { good.to_owned() } else { good.replace("655", "") };
        survive(&good, purpose, |text| {
            tick_log::parse_tick_log("file", text, &mut Vec::new()).is_ok_and(|recording| finished(recording, bits))
        });
    }
}

#[test]
fn damaged_robots_and_models() {
    let robot = "[robot]\nname = \"a\"\nwheel_separation_m = 0.34\nwheel_diameter_left_m = 0.15\nwheel_diameter_right_m = 0.151\n\
                 ticks_per_revolution = 2_000\nencoder_rate_hz = \"every tick\"\ncounter_bits = 16\n\n[path]\nshape = \"waypoints\"\n\
                 points_m = [[1.0, 0.0], [1, 1]]\nspeed_m_s = 0.2\n";
    survive(robot, 4, |text| {
        parse_robot("file", text).is_ok_and(|(robot, path)| {
            assert!(robot.metres_per_tick().left > 0.0 && path.is_none_or(|path| path.length().is_finite()));
            true
        })
    });
    let model = "[[effect]]\nname = \"wheelbase\"\ne_b = { mean = 1.01, sd = 0.002 }\nfree = true\n\n\
                 [[effect]]\nname = \"placed_bumps\"\ncount = 10\nheight_m = { min = 0.0, max = 0.02 }\nprofile = \"cable\"\n";
    survive(model, 5, |text| {
        parse_model("file", text, &Robot::labmate()).is_ok_and(|(model, _)| {
            assert!(model.values().all(f64::is_finite));
            true
        })
    });
}

#[test]
fn damaged_optiodom_files() {
    let metadata = "type,diff,,\nngear,43.7,,\nencRes,64,,\nLi,0.2,,\nDi,0.084,0.085,\nL,0.75,,\n";
    survive(metadata, 6, |text| optiodom::parse_metadata("file", "set", text).is_ok());
    let run = "0,0,0,0,0,0\n0.05,-5.3e-05,-3e-05,-0.0003,12,7\n0.1,0.002,0.004,0.02,-12,700\n";
    survive(run, 7, |text| optiodom::parse_run("file", text).is_ok_and(|recording| finished(recording, None)));
}
