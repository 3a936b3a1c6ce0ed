use super::*;
use umbmark_odometry::example::TABLE;

fn odometer() -> Box<Opaque> {
    Box::new(Opaque { begun: 0, place: MaybeUninit::uninit() })
}

fn begin(odometer: &mut Opaque, table: &'static [f64]) -> Status {
    unsafe { umbmark_begin(odometer, table.as_ptr(), table.len()) }
}

fn estimate() -> CEstimate {
    CEstimate { time_s: -1.0, x_m: 0.0, y_m: 0.0, heading_rad: 0.0, covariance: [0.0; 6], covariance_known: 0 }
}

fn update(odometer: &mut Opaque, time: f64, counts: [f64; 2], out: &mut CEstimate) -> Status {
    unsafe { umbmark_update(odometer, time, counts[0], counts[1], out) }
}

#[test]
fn c_gets_the_estimates_of_rust() {
    let (mut c, mut out) = (odometer(), estimate());
    assert_eq!(begin(&mut c, &TABLE), Status::Ok);
    let table = Table::read(&TABLE).unwrap();
    let mut rust = Odometer::<2>::begin(&table);
    for k in 0..50 {
        let (time, counts) = (0.02 * f64::from(k), [f64::from(20 * k), f64::from(23 * k)]);
        assert_eq!(update(&mut c, time, counts, &mut out), Status::Ok);
        let found = rust.update(time, counts).unwrap();
        let pose = found.pose;
        assert_eq!((out.time_s, out.x_m, out.y_m, out.heading_rad), (found.time, pose.x, pose.y, pose.heading));
        assert_eq!((out.covariance, out.covariance_known), (found.spread.unwrap().numbers(), 1));
    }
    let last = (out.x_m, out.y_m);
    assert_eq!(unsafe { umbmark_ahead(&mut *c, &mut out) }, Status::Ok);
    assert_eq!((out.x_m, out.y_m), last);
    assert!(unsafe { umbmark_session_distance(&mut *c) } > 0.2);
    let run = Run { x_m: 1.0, y_m: 2.0, heading_rad: 0.5, number: 1.0, session_distance_m: 3.0, direction: 0.0 };
    assert_eq!(unsafe { umbmark_begin_at(&mut *c, TABLE.as_ptr(), TABLE.len(), &run) }, Status::Ok);
    assert_eq!(update(&mut c, 0.0, [7.0, 7.0], &mut out), Status::Ok);
    assert_eq!((out.x_m, out.y_m, out.heading_rad), (1.0, 2.0, 0.5));
    assert_eq!(unsafe { umbmark_session_distance(&mut *c) }, 3.0);
    let mut counts = [0.0; 2];
    assert_eq!(unsafe { umbmark_counts_per_turn(TABLE.as_ptr(), TABLE.len(), &mut counts) }, Status::Ok);
    assert_eq!(counts, [2000.0; 2]);
}

#[test]
fn whatever_is_wrong_is_a_status_and_begins_nothing() {
    let (mut c, mut out) = (odometer(), estimate());
    assert_eq!(update(&mut c, 0.0, [0.0; 2], &mut out), Status::NotBegun);
    let null = core::ptr::null_mut();
    assert_eq!(unsafe { umbmark_begin(null, TABLE.as_ptr(), TABLE.len()) }, Status::Null);
    assert_eq!(unsafe { umbmark_begin(&mut *c, core::ptr::null(), 30) }, Status::Null);
    assert_eq!(unsafe { umbmark_update(null, 0.0, 0.0, 0.0, &mut out) }, Status::Null);
    assert_eq!(unsafe { umbmark_ahead(&mut *c, &mut out) }, Status::NotBegun);
    assert_eq!(unsafe { umbmark_session_distance(&mut *c) }, 0.0);
    assert_eq!(unsafe { umbmark_counts_per_turn(TABLE.as_ptr(), TABLE.len(), core::ptr::null_mut()) }, Status::Null);
    // A table that was good does not stay when another is refused.
    assert_eq!(begin(&mut c, &TABLE), Status::Ok);
    for (place, value, status) in [
        (0, 1.0, Status::NotATable),
        (1, 2.0, Status::Version),
        (2, 31.0, Status::Length),
        (4, f64::NAN, Status::Number),
        (7, -1.0, Status::Number),
        (26, 999.0, Status::Law),
        (25, 25.0, Status::Law),
        (25, 1.0, Status::Length),
    ] {
        let mut bad = TABLE.to_vec();
        bad[place] = value;
        assert_eq!(begin(&mut c, bad.leak()), status, "number {place}");
        assert_eq!(update(&mut c, 0.0, [0.0; 2], &mut out), Status::NotBegun);
    }
    let run = Run { x_m: f64::NAN, y_m: 0.0, heading_rad: 0.0, number: 0.0, session_distance_m: 0.0, direction: 0.0 };
    assert_eq!(unsafe { umbmark_begin_at(&mut *c, TABLE.as_ptr(), TABLE.len(), &run) }, Status::Run);
    assert_eq!(begin(&mut c, &TABLE), Status::Ok);
    assert_eq!(update(&mut c, f64::NAN, [0.0; 2], &mut out), Status::Time);
    assert_eq!(update(&mut c, 0.0, [f64::NAN, 0.0], &mut out), Status::Count);
    assert_eq!(out.time_s, -1.0);
    // Nobody has to want the estimate.
    assert_eq!(unsafe { umbmark_update(&mut *c, 0.0, 0.0, 0.0, core::ptr::null_mut()) }, Status::Ok);
}

#[test]
fn the_header_says_what_the_library_has() {
    let header = include_str!("../include/umbmark_odometry.h");
    assert!(header.contains(&format!("#define UMBMARK_ODOMETER_BYTES {BYTES}\n")));
    for (status, name) in [
        (Status::Ok, "OK"),
        (Status::Null, "NULL"),
        (Status::NotBegun, "NOT_BEGUN"),
        (Status::NotATable, "NOT_A_TABLE"),
        (Status::Version, "VERSION"),
        (Status::Length, "LENGTH"),
        (Status::Number, "NUMBER"),
        (Status::Law, "LAW"),
        (Status::Time, "TIME"),
        (Status::Count, "COUNT"),
        (Status::TooFast, "TOO_FAST"),
        (Status::Lost, "LOST"),
        (Status::Run, "RUN"),
    ] {
        assert!(header.contains(&format!("UMBMARK_{name} = {}", status as i32)), "{name}");
        let text = unsafe { core::ffi::CStr::from_ptr(umbmark_status_text(status as i32)) };
        assert_ne!(text, c"unknown status", "{name}");
    }
}
