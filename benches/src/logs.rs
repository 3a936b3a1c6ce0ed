//! Tick logs as text: what a robot with counters read 100 times a second and a track at 20 Hz writes.

use std::fmt::Write;

/// The rows of a log in the project's own layout. The wheels speed up, cruise, turn and stop; each fifth row has a pose.
pub fn log_text(rows: usize) -> String {
    let mut text = String::from("t_s,ticks_left,ticks_right,x_ref_m,y_ref_m,theta_ref_rad\n");
    let (mut left, mut right) = (0i64, 0i64);
    for row in 0..rows {
        let phase = row % 2000;
        let (l, r) = if phase < 1600 { (8, 8) } else { (-5, 6) };
        (left, right) = (left + l + (row % 3) as i64, right + r + (row % 3) as i64);
        let _ = write!(text, "{:.3},{left},{right}", row as f64 * 0.01);
        if row % 5 == 0 {
            let along = 1e-4 * (left + right) as f64;
            let _ = writeln!(text, ",{:.5},{:.5},{:.6}", 4.0 * (0.1 * along).sin(), -along % 3.7, 1e-3 * phase as f64);
        } else {
            text.push_str(",,,\n");
        }
    }
    text
}

/// A robot for such a log.
pub const ROBOT: &str = "[robot]\nwheelbase_m = 0.340\nwheel_diameter_m = 0.150\nticks_per_revolution = 2000\n";
