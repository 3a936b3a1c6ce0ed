//! Corrected odometry as files: CSV, a TUM trajectory, or a log of ROS 2.

use crate::csv_text::CsvText;
use crate::layout::{mcap, tum};
use crate::probe::extension;
use std::path::Path;
use umbmark_core::apply::Corrected;

/// How corrected odometry is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CorrectedFormat {
    /// A row a sample: time, pose and, where it is known, covariance.
    Csv,
    /// `nav_msgs/Odometry` on `/odom`, with covariance.
    Mcap,
    /// A trajectory without covariance.
    Tum,
}

/// The columns of a pose.
const POSE: [&str; 4] = ["t_s", "x_m", "y_m", "theta_rad"];
/// The columns of its covariance, which stand behind those where it is known.
const COVARIANCE: [&str; 6] =
    ["var_x_m2", "cov_x_y_m2", "var_y_m2", "cov_x_theta_m_rad", "cov_y_theta_m_rad", "var_theta_rad2"];

impl CorrectedFormat {
    /// All of them.
    pub const ALL: [CorrectedFormat; 3] = [CorrectedFormat::Csv, CorrectedFormat::Mcap, CorrectedFormat::Tum];

    /// The ending of its files, and its name.
    pub fn name(self) -> &'static str {
        match self {
            CorrectedFormat::Csv => "csv",
            CorrectedFormat::Mcap => "mcap",
            CorrectedFormat::Tum => "tum",
        }
    }

    /// The format that the name of a file asks for.
    pub fn of_file(file: &Path) -> Option<CorrectedFormat> {
        let ending = extension(file);
        CorrectedFormat::ALL.into_iter().find(|format| format.name() == ending)
    }

    /// A whole file.
    pub fn bytes(self, corrected: &Corrected) -> std::io::Result<Vec<u8>> {
        match self {
            CorrectedFormat::Csv => Ok(csv(corrected)),
            CorrectedFormat::Mcap => mcap::corrected(corrected).map_err(std::io::Error::other),
            CorrectedFormat::Tum => Ok(tum::corrected(corrected).into_bytes()),
        }
    }
}

/// The time of a sample \[s\] as in the log, to the nanosecond where its clock is of a calendar.
pub(crate) fn time_text(corrected: &Corrected, sample: usize) -> String {
    match corrected.stamp_ns(sample) {
        Some(stamp) => format!("{}.{:09}", stamp / 1_000_000_000, stamp % 1_000_000_000),
        None => format!("{:?}", corrected.time[sample]),
    }
}

fn csv(corrected: &Corrected) -> Vec<u8> {
    let mut text = CsvText::behind("");
    let spread = corrected.spread.as_deref();
    text.row(POSE.into_iter().chain(spread.iter().flat_map(|_| COVARIANCE)));
    for (sample, pose) in corrected.poses.iter().enumerate() {
        let covariance = spread.map(|spread| spread[sample].numbers());
        text.cell(time_text(corrected, sample));
        for value in [pose.x, pose.y, pose.heading].into_iter().chain(covariance.into_iter().flatten()) {
            text.decimal(value);
        }
        text.end();
    }
    text.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbmark_core::apply::Spread;
    use umbmark_core::geometry::Pose2;

    fn corrected(spread: bool) -> Corrected {
        let at = Spread { xx: 1e-6, xy: -2e-7, yy: 3e-6, x_heading: 1e-5, y_heading: -2e-5, heading: 1.0 / 3.0 };
        Corrected {
            time: vec![0.0, 0.1],
            poses: vec![Pose2::IDENTITY, Pose2::new(1.0 / 3.0, -0.25, 7.0)],
            begin_ns: 0,
            spread: spread.then(|| vec![Spread::default(), at]),
            motion_variances: spread.then(|| vec![[0.0; 3], [1e-6, 4e-6, 9e-6]]),
            way: 0.5,
        }
    }

    #[test]
    fn a_row_has_the_pose_and_its_covariance_where_that_is_known() {
        let text = |spread| String::from_utf8(CorrectedFormat::Csv.bytes(&corrected(spread)).unwrap()).unwrap();
        assert_eq!(text(false), "t_s,x_m,y_m,theta_rad\n0.0,0.0,0.0,0.0\n0.1,0.3333333333333333,-0.25,7.0\n");
        assert_eq!(
            text(true),
            "t_s,x_m,y_m,theta_rad,var_x_m2,cov_x_y_m2,var_y_m2,cov_x_theta_m_rad,cov_y_theta_m_rad,var_theta_rad2\n\
             0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0\n\
             0.1,0.3333333333333333,-0.25,7.0,1e-6,-2e-7,3e-6,1e-5,-2e-5,0.3333333333333333\n"
        );
    }

    #[test]
    fn times_of_a_calendar_are_written_to_the_nanosecond() {
        let corrected = Corrected { begin_ns: 1_760_000_000_123_456_789, ..corrected(true) };
        for format in [CorrectedFormat::Csv, CorrectedFormat::Tum] {
            let text = String::from_utf8(format.bytes(&corrected).unwrap()).unwrap();
            assert!(text.contains("\n1760000000.123456789") && text.contains("\n1760000000.223456789"), "{text}");
        }
        let bytes = CorrectedFormat::Mcap.bytes(&corrected).unwrap();
        let message = ::mcap::MessageStream::new(&bytes).unwrap().last().unwrap().unwrap();
        assert_eq!(message.log_time, 1_760_000_000_223_456_789);
        // Variances of the twist: of the motion, by the square of a tenth of a second.
        let twist = &message.data[message.data.len() - 36 * 8..];
        let number = |place: usize| f64::from_le_bytes(twist[8 * place..][..8].try_into().unwrap());
        for (place, variance) in [(0, 1e-4), (7, 4e-4), (35, 9e-4), (1, 0.0)] {
            assert!((number(place) - variance).abs() < 1e-15, "{place}: {}", number(place));
        }
    }

    #[test]
    fn a_trajectory_reads_back_as_one_and_the_ending_says_the_format() {
        let bytes = CorrectedFormat::Tum.bytes(&corrected(true)).unwrap();
        let rows = tum::parse_tum(crate::source::Source::of("f", &bytes[..]).unwrap(), &mut Vec::new()).unwrap();
        assert_eq!((rows.time.len(), rows.poses[1].0), (2, 1.0 / 3.0));
        // An odometry message ends with its pose, 36 numbers of covariance, the twist and 36 numbers more.
        let bytes = CorrectedFormat::Mcap.bytes(&corrected(true)).unwrap();
        let message = ::mcap::MessageStream::new(&bytes).unwrap().last().unwrap().unwrap();
        let numbers: Vec<f64> =
            message.data.rchunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect();
        let pose: Vec<f64> = numbers[36 + 6..36 + 6 + 36 + 7].iter().rev().copied().collect();
        assert_eq!(pose[..2], [1.0 / 3.0, -0.25]);
        assert_eq!([7, 8, 12, 13, 14, 18].map(|i| pose[i]), [1e-6, -2e-7, 1e-5, -2e-7, 3e-6, -2e-5]);
        assert_eq!(CorrectedFormat::of_file(Path::new("a/b.MCAP")), Some(CorrectedFormat::Mcap));
        assert_eq!(CorrectedFormat::of_file(Path::new("out")), None);
    }
}
