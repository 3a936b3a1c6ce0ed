//! CLAPPER: two differential trucks and a compliant link between their centres, whose direction corrects their headings.

use super::kinematics::Kinematics;
use super::{Counting, DifferentialDrive, DriveError, Encoder};
use crate::geometry::Real;
use crate::parameter::Parameter;

/// What the encoders of a link show: its length, and the angle at each truck.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinkReading<T = f64> {
    /// Distance of the trucks' centres \[m\].
    pub length: T,
    /// Angle of the line of trucks as seen from the front and the rear truck \[rad\]: 0 where a truck heads along it, positive
    /// where the line lies to the left.
    pub angles: [T; 2],
}

/// Two trucks, each a differential drive, and their link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClapperDrive {
    truck: DifferentialDrive,
    link: f64,
    rotary_ticks: f64,
    correction: bool,
    zero_difference: f64,
}

impl ClapperDrive {
    /// From the trucks, the length of the link \[m\], and the counts of its angles per revolution. The rotary encoders show 0 where
    /// trucks and link are in line.
    pub fn new(truck: DifferentialDrive, link: f64, rotary_ticks: f64, correction: bool) -> Result<Self, DriveError> {
        ClapperDrive { truck, link, rotary_ticks, correction, zero_difference: 0.0 }.checked()
    }

    /// One of its trucks.
    pub fn truck(&self) -> &DifferentialDrive {
        &self.truck
    }

    /// Distance of the trucks' centres \[m\].
    pub fn link(&self) -> f64 {
        self.link
    }

    /// What its encoders count of these readings: angles in whole counts. The linear encoder is taken to be as fine as it need
    /// be.
    pub fn counted(&self, reading: LinkReading) -> LinkReading {
        let count = std::f64::consts::TAU / self.rotary_ticks;
        LinkReading { angles: reading.angles.map(|angle| (angle / count).round() * count), ..reading }
    }

    /// The length and angles that its odometry makes of what the encoders show: the zeros of the angles are known to differ.
    #[inline]
    pub fn reckoned<T: Real>(&self, shown: LinkReading<T>) -> LinkReading<T> {
        let [front, rear] = shown.angles;
        let half = 0.5 * self.zero_difference;
        LinkReading { angles: [front - half, rear + half], ..shown }
    }

    /// Whether the link corrects the headings.
    pub fn corrects(&self) -> bool {
        self.correction
    }

    /// The same with the correction on or off.
    pub fn with_correction(self, correction: bool) -> ClapperDrive {
        ClapperDrive { correction, ..self }
    }
}

impl Kinematics for ClapperDrive {
    const NAME: &'static str = "clapper";

    const ABOUT: &'static str =
        "Two differential trucks and a link that corrects their headings; its axle is that of a truck.";

    const PARAMETERS: &'static [Parameter] = &[
        Parameter::shape(
            "wheelbase_m",
            "",
            "m",
            0.340,
            (1e-3, 100.0),
            "distance of the wheels' contact points, of both trucks",
        ),
        Parameter::shape("wheel_diameter_m", "", "m", 0.150, (1e-3, 10.0), "mean diameter of all wheels"),
        Parameter::shape("link_m", "", "m", 1.0, (1e-2, 100.0), "distance of the trucks' centres"),
        Parameter::shape(
            "rotary_ticks_per_revolution",
            "",
            "",
            8192.0,
            (4.0, 1e9),
            "counts of the link's two angles per revolution",
        ),
        Parameter::choice(
            "correction",
            "",
            &["off", "on"],
            1,
            "whether the link's angles correct the trucks' headings",
        ),
        Parameter::size(
            "rotary_zero_difference_rad",
            "",
            "rad",
            1e-3,
            (-0.5, 0.5),
            "what the front angle shows more than the rear one where trucks and link are in line",
        ),
        Parameter::size(
            "diameter_difference",
            "",
            "",
            1e-3,
            (-0.5, 0.5),
            "how much the right wheels are larger than the left ones, D_R/D_L - 1, of both trucks",
        ),
    ];

    /// Where the link corrects, the trucks' own errors hardly show and the link's do.
    fn first_effects(&self) -> [&'static str; 3] {
        if self.correction { ["rotary_zero_difference", "link_length", "scale"] } else { Self::FIRST_EFFECTS }
    }

    const HAS_TICK_LOGS: bool = false;

    const HAS_TRUCKS: bool = true;

    fn trucks(&self) -> Option<&ClapperDrive> {
        Some(self)
    }

    fn from_values(values: &[f64]) -> Result<Self, DriveError> {
        let left = 2.0 * values[1] / (2.0 + values[6]);
        let truck = DifferentialDrive::new(values[0], left, left * (1.0 + values[6]))?;
        let drive = ClapperDrive::new(truck, values[2], values[3], values[4] == 1.0)?;
        ClapperDrive { zero_difference: values[5], ..drive }.checked()
    }

    fn values(&self) -> Vec<f64> {
        let (left, right) = (self.truck.wheel_diameter_left(), self.truck.wheel_diameter_right());
        let correction = f64::from(u8::from(self.correction));
        let mean = if left == right { left } else { 0.5 * (left + right) };
        let difference = (right - left) / left;
        vec![self.truck.wheelbase(), mean, self.link, self.rotary_ticks, correction, self.zero_difference, difference]
    }

    fn axle(&self) -> &DifferentialDrive {
        &self.truck
    }

    /// `None` for arcs: it turns about the middle of its link.
    fn counting(&self, encoder: &Encoder, forward: f64, rotation: f64) -> Option<Counting> {
        (forward == 0.0 || rotation == 0.0).then(|| self.truck.counting(encoder, forward, rotation)).flatten()
    }

    /// With the correction: the zeros' difference \[rad\], the ratio of the link's true length to the nominal one, and E_s. Without:
    /// E_d, E_b, E_s of both trucks.
    fn corrected(&self, first: [f64; 3]) -> Result<Self, DriveError> {
        if !self.correction {
            return Ok(ClapperDrive { truck: self.truck.corrected(first)?, ..*self });
        }
        let [difference, ratio, scale] = first;
        let truck = self.truck.corrected([1.0, 1.0, scale])?;
        let drive = ClapperDrive::new(truck, self.link * ratio, self.rotary_ticks, true)?;
        ClapperDrive { zero_difference: self.zero_difference + difference, ..drive }.checked()
    }
}
