//! CLAPPER: two differential trucks and a compliant link between their centres, whose direction corrects their headings.

use super::kinematics::Kinematics;
use super::{DifferentialDrive, DriveError, positive};
use crate::parameter::{DefaultValue, Parameter};

const fn number(
    name: &'static str,
    unit: &'static str,
    typical: f64,
    bounds: (f64, f64),
    meaning: &'static str,
) -> Parameter {
    Parameter { name, flag: "", unit, default: DefaultValue::Value(typical), typical, bounds, meaning, choices: &[] }
}

/// Two trucks, each a differential drive, and their link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClapperDrive {
    truck: DifferentialDrive,
    link: f64,
    rotary_ticks: f64,
    correction: bool,
}

impl ClapperDrive {
    /// From the trucks, the length of the link \[m\], and the counts of its angles per revolution.
    pub fn new(truck: DifferentialDrive, link: f64, rotary_ticks: f64, correction: bool) -> Result<Self, DriveError> {
        positive("link", link, "m")?;
        positive("rotary ticks per revolution", rotary_ticks, "ticks")?;
        Ok(ClapperDrive { truck, link, rotary_ticks, correction })
    }

    /// One of its trucks.
    pub fn truck(&self) -> &DifferentialDrive {
        &self.truck
    }

    /// Distance of the trucks' centres \[m\].
    pub fn link(&self) -> f64 {
        self.link
    }

    /// An angle of the link as its rotary encoder shows it \[rad\].
    pub fn shown(&self, angle: f64) -> f64 {
        let count = std::f64::consts::TAU / self.rotary_ticks;
        (angle / count).round() * count
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

    const PARAMETERS: &'static [Parameter] = &[
        number("wheelbase_m", "m", 0.340, (1e-3, 100.0), "distance of the wheels' contact points, of both trucks"),
        number("wheel_diameter_m", "m", 0.150, (1e-3, 10.0), "diameter of all wheels"),
        number("link_m", "m", 1.0, (1e-2, 100.0), "distance of the trucks' centres"),
        number("rotary_ticks_per_revolution", "", 8192.0, (4.0, 1e9), "counts of the link's two angles per revolution"),
        Parameter {
            choices: &["off", "on"],
            ..number("correction", "", 1.0, (0.0, 1.0), "whether the link's angles correct the trucks' headings")
        },
    ];

    const HAS_ONE_AXLE: bool = false;

    fn from_values(values: &[f64]) -> Result<Self, DriveError> {
        let truck = DifferentialDrive::new(values[0], values[1], values[1])?;
        ClapperDrive::new(truck, values[2], values[3], values[4] == 1.0)
    }

    fn values(&self) -> Vec<f64> {
        let (truck, correction) = (&self.truck, f64::from(u8::from(self.correction)));
        vec![truck.wheelbase(), truck.wheel_diameter_left(), self.link, self.rotary_ticks, correction]
    }

    fn axle(&self) -> &DifferentialDrive {
        &self.truck
    }

    /// What its own trucks have is corrected by the link; nothing of it is known from returns.
    fn corrected(&self, _first: [f64; 3]) -> Result<Self, DriveError> {
        Ok(*self)
    }
}
