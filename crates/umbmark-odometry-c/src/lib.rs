//! The C edge of [`umbmark_odometry`]: `include/umbmark_odometry.h` says what each function does.
//!
//! The only unsafe code of odometry on the robot stands here: pointers of a C program are checked for null and read. No arithmetic is done.

#![cfg_attr(not(feature = "std"), no_std)]

use core::ffi::{c_char, c_int};
use core::mem::MaybeUninit;
use umbmark_odometry::context::Place;
use umbmark_odometry::geometry::Pose2;
use umbmark_odometry::{Estimate, Odometer, Table, TableError, UpdateError};

/// Room for readings: up to 1.2 kHz where a law reads speeds.
const READINGS: usize = 128;

/// Bytes of `umbmark_odometer` in the header.
const BYTES: usize = 4864;

/// What a C program holds before it has begun is anything else.
const BEGUN: u64 = 0x756d_626d_6f64_6f6d;

/// `umbmark_odometer`: opaque, and large enough on every machine.
#[repr(C, align(8))]
pub struct Opaque {
    begun: u64,
    place: MaybeUninit<[u8; BYTES - 8]>,
}

const _: () = assert!(size_of::<Opaque>() == BYTES && size_of::<Inner>() <= BYTES - 8 && align_of::<Inner>() <= 8);

type Inner = Odometer<'static, READINGS>;

/// `umbmark_run`.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Run {
    x_m: f64,
    y_m: f64,
    heading_rad: f64,
    number: f64,
    session_distance_m: f64,
    direction: f64,
}

/// `umbmark_estimate`.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct CEstimate {
    time_s: f64,
    x_m: f64,
    y_m: f64,
    heading_rad: f64,
    covariance: [f64; 6],
    covariance_known: c_int,
}

/// `umbmark_status`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Done.
    Ok = 0,
    /// A pointer is null.
    Null = 1,
    /// The odometer has not begun.
    NotBegun = 2,
    /// The numbers are no table.
    NotATable = 3,
    /// The table is of another version.
    Version = 4,
    /// More or fewer numbers than the table says.
    Length = 5,
    /// A number of the table is out of its range.
    Number = 6,
    /// A law that this library does not know, or too many.
    Law = 7,
    /// See [`UpdateError::Time`].
    Time = 8,
    /// See [`UpdateError::Count`].
    Count = 9,
    /// See [`UpdateError::TooFast`].
    TooFast = 10,
    /// See [`UpdateError::Lost`].
    Lost = 11,
    /// A number of a run is not finite.
    Run = 12,
}

impl From<TableError> for Status {
    fn from(error: TableError) -> Status {
        match error {
            TableError::Version(_) => Status::Version,
            TableError::Length { .. } => Status::Length,
            TableError::Number { .. } => Status::Number,
            TableError::UnknownLaw { .. } | TableError::TooManyLaws(_) => Status::Law,
            _ => Status::NotATable,
        }
    }
}

impl From<UpdateError> for Status {
    fn from(error: UpdateError) -> Status {
        match error {
            UpdateError::Time => Status::Time,
            UpdateError::Count => Status::Count,
            UpdateError::TooFast => Status::TooFast,
            _ => Status::Lost,
        }
    }
}

impl From<Estimate> for CEstimate {
    fn from(estimate: Estimate) -> CEstimate {
        let Pose2 { x, y, heading } = estimate.pose;
        CEstimate {
            time_s: estimate.time,
            x_m: x,
            y_m: y,
            heading_rad: heading,
            covariance: estimate.spread.unwrap_or_default().numbers(),
            covariance_known: estimate.spread.is_some().into(),
        }
    }
}

/// Begins a run at the START of the table.
///
/// # Safety
/// `odometer` is null or points to an `umbmark_odometer`; `table` is null or points to `numbers` numbers that live as long as it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbmark_begin(odometer: *mut Opaque, table: *const f64, numbers: usize) -> Status {
    // SAFETY: as the caller promises; a null `run` is allowed.
    unsafe { umbmark_begin_at(odometer, table, numbers, core::ptr::null()) }
}

/// Begins a run elsewhere.
///
/// # Safety
/// As [`umbmark_begin`]; `run` is null or points to an `umbmark_run`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbmark_begin_at(
    odometer: *mut Opaque,
    table: *const f64,
    numbers: usize,
    run: *const Run,
) -> Status {
    if odometer.is_null() || table.is_null() || numbers > isize::MAX as usize / size_of::<f64>() {
        return Status::Null;
    }
    // SAFETY: not null, and an `umbmark_odometer` as the caller promises. No reference is made before it is written: a program may not have
    // set it to anything.
    let odometer = unsafe {
        (&raw mut (*odometer).begun).write(0);
        &mut *odometer
    };
    // SAFETY: not null, of that length and living long enough as the caller promises.
    let table = match Table::read(unsafe { core::slice::from_raw_parts(table, numbers) }) {
        Ok(table) => table,
        Err(error) => return error.into(),
    };
    // SAFETY: null or a run as the caller promises.
    let begun = match unsafe { run.as_ref() } {
        None => Odometer::begin(&table),
        Some(run) => {
            let Run { x_m, y_m, heading_rad, number, session_distance_m, direction } = *run;
            if [x_m, y_m, heading_rad, number, session_distance_m, direction].iter().any(|n| !n.is_finite()) {
                return Status::Run;
            }
            let place = Place { run: number, session_distance: session_distance_m, direction };
            Odometer::begin_at(&table, Pose2::new(x_m, y_m, heading_rad), &place)
        }
    };
    // SAFETY: there is room and it is aligned, as the assertion at the top says.
    unsafe { odometer.place.as_mut_ptr().cast::<Inner>().write(begun) };
    odometer.begun = BEGUN;
    Status::Ok
}

/// The odometer that a C program holds, if it has begun.
///
/// # Safety
/// `odometer` is null or points to an `umbmark_odometer` that nothing else uses now.
unsafe fn begun<'a>(odometer: *mut Opaque) -> Result<&'a mut Inner, Status> {
    // SAFETY: as the caller promises.
    let odometer = unsafe { odometer.as_mut() }.ok_or(Status::Null)?;
    if odometer.begun != BEGUN {
        return Err(Status::NotBegun);
    }
    // SAFETY: `umbmark_begin_at` has written it before it set the mark.
    Ok(unsafe { &mut *odometer.place.as_mut_ptr().cast::<Inner>() })
}

/// Writes an estimate where there is one and a place for it.
///
/// # Safety
/// `out` is null or points to an `umbmark_estimate`.
unsafe fn tell(found: Result<Estimate, UpdateError>, out: *mut CEstimate) -> Status {
    match found {
        Ok(estimate) => {
            // SAFETY: as the caller promises.
            if let Some(out) = unsafe { out.as_mut() } {
                *out = estimate.into();
            }
            Status::Ok
        }
        Err(error) => error.into(),
    }
}

/// Takes a reading of both counters.
///
/// # Safety
/// `odometer` is null or points to an `umbmark_odometer` that nothing else uses now; `out` is null or points to an `umbmark_estimate`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbmark_update(
    odometer: *mut Opaque,
    time_s: f64,
    first: f64,
    second: f64,
    out: *mut CEstimate,
) -> Status {
    // SAFETY: as the caller promises.
    match unsafe { begun(odometer) } {
        // SAFETY: as the caller promises.
        Ok(odometer) => unsafe { tell(odometer.update(time_s, [first, second]), out) },
        Err(status) => status,
    }
}

/// The pose of the newest reading.
///
/// # Safety
/// As [`umbmark_update`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbmark_ahead(odometer: *mut Opaque, out: *mut CEstimate) -> Status {
    // SAFETY: as the caller promises.
    match unsafe { begun(odometer) } {
        // SAFETY: as the caller promises.
        Ok(odometer) => unsafe { tell(odometer.ahead(), out) },
        Err(status) => status,
    }
}

/// Path length that was driven in the session \[m\]; 0 where nothing has begun.
///
/// # Safety
/// `odometer` is null or points to an `umbmark_odometer` that nothing else uses now.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbmark_session_distance(odometer: *mut Opaque) -> f64 {
    // SAFETY: as the caller promises.
    unsafe { begun(odometer) }.map_or(0.0, |odometer| odometer.session_distance())
}

/// Counts of both counters per turn, from a table.
///
/// # Safety
/// `table` is null or points to `numbers` numbers; `out` is null or points to two numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn umbmark_counts_per_turn(table: *const f64, numbers: usize, out: *mut [f64; 2]) -> Status {
    if table.is_null() || numbers > isize::MAX as usize / size_of::<f64>() {
        return Status::Null;
    }
    // SAFETY: as the caller promises.
    let Some(out) = (unsafe { out.as_mut() }) else { return Status::Null };
    // SAFETY: as the caller promises.
    match Table::read(unsafe { core::slice::from_raw_parts(table, numbers) }) {
        Ok(table) => {
            *out = table.counts_per_turn;
            Status::Ok
        }
        Err(error) => error.into(),
    }
}

/// A status in words.
#[unsafe(no_mangle)]
pub extern "C" fn umbmark_status_text(status: c_int) -> *const c_char {
    let text = match status {
        0 => c"done",
        1 => c"a pointer is null",
        2 => c"the odometer has not begun: call umbmark_begin",
        3 => c"the numbers are no table of a model: write one with umbmark export --to embedded",
        4 => c"the table has another version than this library: write it anew with the umbmark of this library",
        5 => c"the table has more or fewer numbers than it says",
        6 => c"a number of the table is not finite or out of its range",
        7 => c"the table has a law that this library does not know, or too many laws",
        8 => c"the time of a reading is not finite, or not later than that of the one before",
        9 => c"a count is not finite, beyond 2^53, or not whole where counters roll over",
        10 => c"there is no room for so many readings within 0.1 s",
        11 => c"the pose is not finite: are the counts those of this robot?",
        12 => c"a number of the run is not finite",
        _ => c"unknown status",
    };
    text.as_ptr()
}

#[cfg(all(not(feature = "std"), not(test)))]
#[panic_handler]
fn halt(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}

#[cfg(test)]
mod tests;
