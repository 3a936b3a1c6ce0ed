//! Tables into which several sensors were joined, and the times of their rows.

use crate::dataset_reading::{ROBOT, load, log};
use umbmark_core::dataset::Dataset;

/// Two sensors joined into one table: where one of them has no row, its cells are empty.
#[test]
fn poses_in_rows_of_their_own_keep_their_times_and_get_counts_between_readings() {
    let header = "t_s,ticks_left,ticks_right,x_ref_m,y_ref_m,theta_ref_rad\n";
    let rows = "0,10,20,,,\n0.05,,,0,0,0\n0.1,10,20,,,\n0.2,110,220,0.3,0.1,0.2\n0.26,,,0.4,0.1,0.3\n0.3,210,420,,,\n0.3,,,0.5,0.2,0.4\n0.35,,,,,\n0.4,210,420,,,\n0.45,,,9,9,9\n";
    let data = log("ccw_01.csv", &(header.to_owned() + rows));
    let read = data.runs[0].log.as_ref().unwrap();
    assert_eq!(read.time, [0.0, 0.05, 0.1, 0.2, 0.26, 0.3, 0.4]);
    let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9) && a.len() == b.len();
    assert!(close(&read.left, &[0.0, 0.0, 0.0, 100.0, 160.0, 200.0, 200.0]), "{:?}", read.left);
    assert!(close(&read.right, &[0.0, 0.0, 0.0, 200.0, 320.0, 400.0, 400.0]), "{:?}", read.right);
    let seen: Vec<_> = read.reference.iter().map(|pose| (pose.sample, pose.x, pose.heading)).collect();
    assert_eq!(seen, [(1, 0.0, Some(0.0)), (3, 0.3, Some(0.2)), (4, 0.4, Some(0.3)), (5, 0.5, Some(0.4))]);
    let told = data.warnings.join("\n");
    assert!(told.contains("1 pose in a gap of the counts, or outside of them: left out"), "{told}");
    assert!(told.contains("1 row with neither counts nor a pose: left out"), "{told}");

    // Rows that arrived late, and a counter that rolls over between two of its rows.
    let late = "0,65530,20,,,\n0.05,,,0,0,0\n0.1,65530,20,,,\n0.26,,,0.4,0.1,0.3\n0.2,94,220,,,\n0.3,194,420,,,\n0.15,,,0.3,0.1,0.2\n0.4,194,420,,,\n";
    let robot = ROBOT.to_owned() + "counter_bits = 16\n";
    let data = load(&[("robot.toml", &robot), ("runs/ccw_01.csv", &(header.to_owned() + late))], "").unwrap();
    let read = data.runs[0].log.as_ref().unwrap();
    assert_eq!(read.time, [0.0, 0.05, 0.1, 0.15, 0.2, 0.26, 0.3, 0.4]);
    assert!(close(&read.left, &[0.0, 0.0, 0.0, 50.0, 100.0, 160.0, 200.0, 200.0]), "{:?}", read.left);
    assert_eq!(read.reference.iter().map(|pose| pose.sample).collect::<Vec<_>>(), [1, 3, 5]);
    let refused =
        load(&[("robot.toml", ROBOT), ("runs/ccw_01.csv", &(header.to_owned() + "0,0,0,,,\n0.1,5,,,,\n"))], "");
    assert!(refused.unwrap_err().to_string().contains("csv:3: column \"ticks_right\""));
}

#[test]
fn rates_and_steps_in_rows_of_their_own_are_added_up_as_those_beside_counts_are() {
    let counts = [[0.0, 0.0], [0.0, 0.0], [50.0, 60.0], [100.0, 120.0], [100.0, 120.0]];
    let table = |header: &str, cells: &[&str], apart: bool| {
        let mut text = format!("t_s,ticks_left,ticks_right,{header}\n");
        let blank = ",".repeat(header.matches(',').count());
        for (row, [left, right]) in counts.iter().enumerate() {
            match apart {
                true => text += &format!("{row},{left},{right},{blank}\n{row},,,{}\n", cells[row]),
                false => text += &format!("{row},{left},{right},{}\n", cells[row]),
            }
        }
        log("ccw_01.csv", &text).runs[0].log.clone().unwrap()
    };
    let gyro = ["0.5", "0.5", "2.5", "4.5", "0.5"];
    let steps = ["", "0,0,0", "0.03,0,0.01", "0.03,0.001,0.02", "0,0,0"];
    let steps_apart = [",,", "0,0,0", "0.03,0,0.01", "0.03,0.001,0.02", "0,0,0"];
    for (header, beside, apart) in [
        ("gyro_deg_s", gyro, gyro),
        ("dx_rel_m,dy_rel_m,dtheta_rel_rad", steps.map(|step| if step.is_empty() { ",," } else { step }), steps_apart),
    ] {
        let (beside, apart) = (table(header, &beside, false), table(header, &apart, true));
        assert!(beside.relative && beside.reference.len() >= 4, "{header}: {beside:?}");
        assert_eq!((&beside.time, &beside.left), (&apart.time, &apart.left), "{header}");
        let last = |log: &umbmark_core::dataset::TickLog| log.reference.last().copied().unwrap();
        let (beside, apart) = (last(&beside), last(&apart));
        assert!(
            (beside.x - apart.x).abs() < 1e-12 && (beside.y - apart.y).abs() < 1e-12,
            "{header}: {beside:?} {apart:?}"
        );
        assert!((beside.heading.unwrap() - apart.heading.unwrap()).abs() < 1e-9, "{header}: {beside:?} {apart:?}");
    }
}

#[test]
fn times_in_milliseconds_are_read_by_their_name_and_asked_about_where_they_are_called_seconds() {
    let rows = |name: &str, scale: f64| {
        let row = |i: i32| format!("{},{},{}\n", scale * 0.05 * f64::from(i), 40 * i, 40 * i);
        log("cw_01.csv", &((0..50).map(row).fold(format!("{name},ticks_left,ticks_right\n"), |all, row| all + &row)))
    };
    let time = |data: &Dataset| data.runs[0].log.as_ref().unwrap().time[49];
    for (name, scale) in [("t_s", 1.0), ("t_ms", 1e3), ("t_us", 1e6), ("t_ns", 1e9)] {
        let data = rows(name, scale);
        assert!((time(&data) - 2.45).abs() < 1e-9, "{name}");
        assert_eq!(data.warnings, Vec::<String>::new(), "{name}");
    }
    let told = rows("t_s", 1e3).warnings.join("\n");
    assert!(told.contains("the wheels roll at 0.50 mm/s, by rows that are 50 s apart"), "{told}");
    assert!(told.contains("call their column t_ms"), "{told}");
}
