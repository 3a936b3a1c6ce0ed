//! No input makes a reader panic, hang or take more memory than it has bytes: good files with random damage, always the same
//! damage for the same seed. A damaged file that is still read gives finite numbers only.
//!
//! `UMBMARK_TEST_CASES=1000000` damages each of the files a million times and prints how many were read.

mod damage;

use super::closures::{Closure, Marks, closures};
use super::conditions::parse_conditions;
use super::error::DatasetError;
use super::filled_in::drop_filled_in;
use super::layout::csv::{Measured, parse_returns, parse_tick_log};
use super::layout::{optiodom, parse_track};
use super::model_file::ModelFile;
use super::recording::Recording;
use super::robot_file::RobotFile;
use super::sheet::Rows;
use super::source::Source;
use super::stale::drop_stale;
use super::start_frame::move_to_start;
pub(super) use damage::damage;
use std::io::Read;
use umbmark_core::dataset::{Stated, TickLog};
use umbmark_core::drive::{DriveKind, Robot};
use umbmark_core::random::Stream;
use umbmark_core::run::{PoseRow, ReferenceTrack, place};
use umbmark_core::synchronise::synchronise;

/// How often each file is damaged.
fn rounds() -> u64 {
    std::env::var("UMBMARK_TEST_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(20_000)
}

/// Damages a file many times; says how often it was still read.
fn survive(good: &str, purpose: u64, read: impl Fn(&str) -> bool) {
    let mut stream = Stream::new(7, purpose, 0);
    let mut fine = 0;
    let rounds = rounds();
    for _ in 0..rounds {
        let Ok(text) = String::from_utf8(damage(good.as_bytes(), &mut stream)) else { continue };
        fine += u64::from(read(&text));
    }
    println!("file {purpose}: {rounds} damaged, {fine} of them still read");
    assert!(read(good), "the undamaged file is good");
    assert!(fine > 0 && fine < rounds, "{fine}: damage too heavy or too light to tell anything");
}

fn source(text: &str) -> Source<'_> {
    Source::of("file", text.as_bytes()).unwrap()
}

fn finished(recording: Recording, bits: Option<u32>) -> bool {
    let log = recording.into_log(Some(&Robot::labmate()), bits, &mut Vec::new()).map(|(log, _)| log);
    let finite = |log: &TickLog| log.left.iter().chain(&log.right).chain(&log.time).all(|value| value.is_finite());
    log.is_ok_and(|mut log| {
        drop_stale("file", &mut log, &Robot::labmate(), &mut Vec::new());
        drop_filled_in("file", &mut log, &mut Vec::new());
        let moved = move_to_start("file", &mut log, None, &mut Vec::new()).is_ok();
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
        parse_returns(source(text), &mut Vec::new()).is_ok_and(|rows| {
            assert!(rows.iter().all(|row| {
                let (x, y, heading) = match row.measured {
                    Measured::Error(error) => (error.x, error.y, error.heading),
                    Measured::Absolute(end) => end,
                };
                x.is_finite() && y.is_finite() && heading.is_none_or(f64::is_finite)
            }));
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
            parse_tick_log(source(text), DriveKind::default(), &mut Vec::new())
                .is_ok_and(|recording| finished(recording, bits))
        });
    }
}

#[test]
fn damaged_logs_of_steps() {
    let good = "t_s,ticks_left,ticks_right,dx_rel_m,dy_rel_m,dtheta_rel_rad\n0.00,0,0,,,\n0.01,4,3,0.001,0,0\n0.02,7,9,,,\n\
                0.03,9,12,0.002,-0.01,3.1\n0.04,12,20,1e-3,0,3.1\n";
    survive(good, 17, |text| {
        parse_tick_log(source(text), DriveKind::default(), &mut Vec::new())
            .is_ok_and(|recording| finished(recording, None))
    });
}

#[test]
fn damaged_conditions() {
    survive("run,floor,load_kg\ncw_01,tile,0\nccw_01,\"felt, thick\",2.5\nccw_02,,-1e3\n", 19, |text| {
        let rows = parse_conditions(source(text));
        rows.is_ok_and(|rows| {
            let finite = |value: &Stated| !matches!(value, Stated::Number(number) if !number.is_finite());
            assert!(rows.iter().flat_map(|row| &row.values).all(|(_, value)| finite(value)));
            rows.len() > 1
        })
    });
}

#[test]
fn damaged_logs_of_marks() {
    let good = "t_s,ticks_left,ticks_right,mark,closed\n0.00,0,0,,1\n0.01,4,3,a,\n0.02,7,9,,0\n0.03,9,12,a,0\n0.04,12,20,b,\n0.05,13,21,,1\n";
    let places = Marks::from([("a".to_owned(), (1.0, 2.0, Some(0.5))), ("b".to_owned(), (0.0, 0.0, None))]);
    survive(good, 18, |text| {
        let read = parse_tick_log(source(text), DriveKind::default(), &mut Vec::new())
            .and_then(|recording| recording.into_log(Some(&Robot::labmate()), None, &mut Vec::new()));
        read.is_ok_and(|(log, marked)| {
            let found = closures(&log, &marked, &places);
            for Closure { log, end: (x, y, heading) } in &found {
                assert!(x.is_finite() && y.is_finite() && heading.is_none_or(f64::is_finite));
                assert!(log.time.len() > 1 && log.left[0] == 0.0 && log.right[0] == 0.0);
            }
            !found.is_empty()
        })
    });
}

/// Oracle: lines cut at their ends and commas.
#[test]
fn rows_have_the_cells_and_the_lines_of_a_text_cut_at_its_commas() {
    let good = "0.00,65530,3,0.001,0,0\n0.01,65534,65533,,,\n\n,,,,,\n# Monday, \"5\n0.02,3,65530,0.002, 0.01,\r\n0.03,9,65500,-0.002,.01,-6.2";
    survive(good, 16, |text| {
        if text.contains('"') != good.contains('"') || !text.contains('\n') || text.matches('"').count() > 1 {
            return false;
        }
        let mut rows = Rows::of(source(text));
        let mut read = Vec::new();
        while let Some(row) = rows.next().unwrap() {
            read.push((row.line, row.cells().map(str::to_owned).collect::<Vec<_>>()));
        }
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let lines = text.split('\n').enumerate().map(|(n, line)| (n + 1, line.split(',').map(str::trim)));
        let holds = |cells: &Vec<String>| !cells[0].starts_with('#') && cells.iter().any(|cell| !cell.is_empty());
        let cut = lines.map(|(n, cells)| (n, cells.map(str::to_owned).collect::<Vec<_>>()));
        let cut: Vec<_> = cut.filter(|(_, cells)| holds(cells)).collect();
        if !text.contains('"') || text.contains("# Monday, \"5\n") {
            assert_eq!(read, cut, "{text:?}");
        }
        read.len() == 4
    });
}

/// Gives out a few bytes at a time.
struct Dribble<'a>(&'a [u8], usize);

impl Read for Dribble<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let most = self.1.min(buffer.len());
        self.0.read(&mut buffer[..most])
    }
}

#[test]
fn a_log_is_the_same_however_its_bytes_arrive() {
    let good = "\u{feff}t_s,ticks_left,ticks_right,x_ref_m,y_ref_m,theta_ref_rad\n0.00,5,3,0.001,0,0\n0.01,7,6,,,\r\n\
                # Monday\n0.02,9,65530,0.002,0.01,\n\n0.03,9,65500,0.002,0.01,-6.2\n";
    let mut stream = Stream::new(7, 15, 0);
    for round in 0..rounds() / 10 {
        let bytes = damage(good.as_bytes(), &mut stream);
        let read = |source: Result<Source, DatasetError>| {
            let mut noticed = Vec::new();
            let read = source.and_then(|source| parse_tick_log(source, DriveKind::default(), &mut noticed));
            (read.map_err(|error| error.to_string()), noticed)
        };
        let dribble = Dribble(&bytes, 1 + (round % 40) as usize);
        assert_eq!(read(Source::of("file", dribble)), read(Source::of("file", &bytes[..])));
    }
}

#[test]
fn damaged_robots_and_models() {
    let robot = "[robot]\nname = \"a\"\nwheel_separation_m = 0.34\nwheel_diameter_left_m = 0.15\nwheel_diameter_right_m = 0.151\n\
                 ticks_per_revolution = 2_000\nencoder_rate_hz = \"every tick\"\ncounter_bits = 16\nwheels_exchanged = true\n\n[reference]\ny_mirrored = true\n\n[path]\nshape = \"waypoints\"\n\
                 points_m = [[1.0, 0.0], [1, 1]]\nspeed_m_s = 0.2\n";
    survive(robot, 4, |text| {
        RobotFile::parse("file", text).is_ok_and(|RobotFile { robot, path, .. }| {
            assert!(robot.metres_per_tick().left > 0.0 && path.is_none_or(|path| path.length().is_finite()));
            true
        })
    });
    let model = "[robot]\nwheelbase_m = 0.34\nwheel_diameter_m = 0.15\nticks_per_revolution = 2000\n\n[[effect]]\nname = \"wheelbase\"\ne_b = { mean = 1.01, sd = 0.002 }\nfree = true\n\n\
                 [[effect]]\nname = \"placed_bumps\"\ncount = 10\nheight_m = { min = 0.0, max = 0.02 }\nprofile = \"cable\"\n\n\
                 [noise]\nheading_rad_per_sqrt_m = 0.001\nreference_time_s = 5e-4\n";
    survive(model, 5, |text| {
        ModelFile::parse("file", text, Some(&Robot::labmate())).is_ok_and(|ModelFile { model, noise, .. }| {
            assert!(model.values().chain(noise.iter().flat_map(|noise| noise.written())).all(f64::is_finite));
            true
        })
    });
}

#[test]
fn damaged_optiodom_files() {
    let metadata = "type,diff,,\nngear,43.7,,\nencRes,64,,\nLi,0.2,,\nDi,0.084,0.085,\nL,0.75,,\n";
    survive(metadata, 6, |text| optiodom::parse_metadata("set", source(text)).is_ok());
    let run = "0,0,0,0,0,0\n0.05,-5.3e-05,-3e-05,-0.0003,12,7\n0.1,0.002,0.004,0.02,-12,700\n";
    let tricycle = "type,tricyc,\nngear,1,\nencRes,1600,\nLi,0.15,\nDi,0.065,\nThi,0.01,\n";
    survive(tricycle, 6, |text| optiodom::parse_metadata("set", source(text)).is_ok());
    let robot = optiodom::parse_metadata("set", source(tricycle)).unwrap().0;
    let steered = "0,0,0,0,0,0\n0.05,-5.3e-05,-3e-05,-0.0003,12,0.1\n0.1,0.002,0.004,0.02,-12,-0.2\n";
    survive(steered, 8, |text| {
        let log = optiodom::parse_tricycle_run(source(text))
            .and_then(|recording| recording.into_log(Some(&robot), None, &mut Vec::new()));
        log.is_ok_and(|(log, _)| {
            assert!(log.left.iter().chain(&log.right).chain(&log.time).all(|value| value.is_finite()));
            true
        })
    });
    survive(run, 7, |text| optiodom::parse_run(source(text)).is_ok_and(|recording| finished(recording, None)));
}

/// What a log does with a track: it is put between its samples by any clock, and aligned from the motion where there is enough of it.
fn placed(track: &ReferenceTrack) -> bool {
    assert!(track.time.windows(2).all(|pair| pair[0] < pair[1]));
    let values = || track.x.iter().chain(&track.y).chain(&track.time).chain(track.heading.iter().flatten());
    assert!(values().all(|value| value.is_finite()));
    let time: Vec<f64> = (0..40).map(|i| 0.05 * f64::from(i)).collect();
    let counts: Vec<f64> = (0..40).map(|i| f64::from(i * i)).collect();
    let mut log = TickLog { time, left: counts.clone(), right: counts, ..TickLog::default() };
    if let Ok(found) = synchronise(&log, track, &Robot::labmate()) {
        assert!(found.offset.value.is_finite() && found.rate.std_error.is_finite());
    }
    let poses = track.x.iter().zip(&track.y).enumerate();
    let poses: Vec<PoseRow> = poses.map(|(i, (x, y))| (*x, *y, track.heading.as_ref().map(|h| h[i]))).collect();
    place(&mut log, &track.time, &poses);
    log.time.windows(2).all(|pair| pair[0] < pair[1]) && log.reference.iter().all(|pose| pose.sample < log.time.len())
}

#[test]
fn damaged_tracks() {
    let tum =
        "# t tx ty tz qx qy qz qw\n0.1 1 2 0 0 0 0 1\n0.2 1.01 2 0 0 0 0.1 0.995\n0.35 1.02 2e0 0 0 0 -0.1 0.995\n";
    let motive = "Format Version,1.23,Take Name,a,Rotation Type,YXZ,Length Units,Meters,Coordinate Space,Global\n\n\
                  ,Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body\n\
                  ,Name,r,r,r,r,r,r,r\n,ID,\"A\",\"A\",\"A\",\"A\",\"A\",\"A\",\"A\"\n\
                  ,,Rotation,Rotation,Rotation,Position,Position,Position,Mean Marker Error\n\
                  Frame,Time (Seconds),Y,X,Z,X,Y,Z,\n0,0.0,90,0,0.1,1,0.1,2,0.001\n1,0.01,,,,,,,\n2,0.02,91,-1,0,1.1,0.1,2,0\n";
    let columns = "t_s,x_ref_mm,y_ref_mm,theta_ref_deg\n0.0,1,2,3\n0.5,,,\n1.0,-4,5e-1,179\n1.5,2,3,-179\n";
    for (purpose, good) in [(8, tum), (9, motive), (10, columns)] {
        survive(good, purpose, |text| parse_track(source(text), &mut Vec::new()).is_ok_and(|track| placed(&track)));
    }
}

#[test]
fn damaged_counters_with_time_stamps_out_of_order() {
    let odometry = "0,0,0\n0.05,12,7\n0.15,9,9\n0.10,11,8\n0.2,-3,700\n0.2,-3,700\n";
    survive(odometry, 11, |text| {
        optiodom::parse_odometry(source(text)).is_ok_and(|recording| finished(recording, None))
    });
    let reset = "t_s,ticks_left,ticks_right\n0,1000,1000\n0.01,1003,1003\n0.03,3,2\n0.02,0,0\n0.04,6,6\n0.04,7,6\n";
    for (purpose, bits) in [(12, Some(16)), (13, None)] {
        survive(reset, purpose, |text| {
            parse_tick_log(source(text), DriveKind::default(), &mut Vec::new())
                .is_ok_and(|recording| finished(recording, bits))
        });
    }
}

#[test]
fn damaged_packed_files() {
    use std::io::Write;
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    encoder.write_all(b"t_s,ticks_left,ticks_right\n0,0,0\n0.01,1,1\n").unwrap();
    let good = encoder.finish().unwrap();
    let mut stream = Stream::new(7, 14, 0);
    for _ in 0..rounds() {
        let mut bytes = good.clone();
        for _ in 0..3 {
            let at = (stream.uniform() * bytes.len() as f64) as usize;
            bytes[at] = (stream.uniform() * 256.0) as u8;
        }
        let unpacked = Source::of("file", &bytes[..]).and_then(Source::text);
        assert!(unpacked.is_err() || unpacked.is_ok_and(|text| text.len() < 1 << 20));
    }
}
