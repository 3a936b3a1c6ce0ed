//! What messages of ROS 2 are made of, as they are written.

use re_cdr::{CdrWriter, LittleEndian};

/// A message on its way.
pub(super) type Cdr<'a> = CdrWriter<'a, LittleEndian>;

/// A std_msgs/Header; the time counts nanoseconds.
pub(super) fn header(cdr: &mut Cdr, time: u64, frame: &str) {
    cdr.write_i32((time / 1_000_000_000) as i32);
    cdr.write_u32((time % 1_000_000_000) as u32);
    cdr.write_string(frame);
}

/// Numbers one after the other.
pub(super) fn numbers<const N: usize>(cdr: &mut Cdr, numbers: [f64; N]) {
    for number in numbers {
        cdr.write_f64(number);
    }
}

/// Rotation by a heading as a quaternion.
pub(super) fn orientation(heading: f64) -> [f64; 4] {
    [0.0, 0.0, libm::sin(0.5 * heading), libm::cos(0.5 * heading)]
}
