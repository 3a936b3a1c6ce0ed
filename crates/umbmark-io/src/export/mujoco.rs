//! A twin of the robot in MuJoCo.

use super::text::number;
use super::{Comment, Export, ExportError, Target, Written};

/// Width of a wheel, as a share of its radius.
const WIDTH: f64 = 0.3;

/// A model that loads and drives: two wheels of their own sizes, a castor, and a velocity actuator a wheel. MuJoCo has no noise of
/// wheels, so its sizes are numbers in the file, for the program that steps it.
pub static TARGET: Target = Target {
    name: "mujoco",
    about: "MJCF of a robot with the true wheels and wheelbase, and the sizes of its noise as custom numbers",
    holds_all: false,
    write,
};

fn write(export: &Export) -> Result<Written, ExportError> {
    let corrected = export.corrected()?;
    let drive = &corrected.drive;
    if !drive.kind().has_axle_wheels() {
        return Err(export.no_drive(TARGET.name));
    }
    let [left, right] = [drive.wheel_diameter_left(), drive.wheel_diameter_right()].map(|diameter| 0.5 * diameter);
    let (half, height) = (0.5 * drive.wheelbase(), left.max(right));
    let mut notes = export.uncorrected();
    let mut numbers = String::new();
    if let Some(noise) = export.noise_or(&mut notes) {
        for (name, size) in [
            ("heading_noise_rad_per_sqrt_m", noise.heading_per_metre),
            ("heading_noise_rad_per_sqrt_rad", noise.heading_per_radian),
            ("forward_noise_m_per_sqrt_m", noise.forward_per_metre),
            ("sideways_noise_m_per_sqrt_m", noise.sideways_per_metre),
        ] {
            numbers += &format!("    <numeric name=\"{name}\" data=\"{}\"/>\n", number(size));
        }
        notes.push(
            "MuJoCo has no noise of wheels: its sizes are custom numbers, for the program that steps the model"
                .to_owned(),
        );
    }
    let wheel = |side: &str, y: f64, radius: f64| {
        format!(
            "      <body name=\"{side}_wheel\" pos=\"0 {} {}\">\n        \
             <joint name=\"{side}_wheel_joint\" type=\"hinge\" axis=\"0 1 0\"/>\n        \
             <geom name=\"{side}_wheel\" type=\"cylinder\" size=\"{} {}\" euler=\"90 0 0\"/>\n      </body>\n",
            number(y),
            number(radius - height),
            number(radius),
            number(0.5 * WIDTH * radius)
        )
    };
    let actuator =
        |side: &str| format!("    <velocity name=\"{side}_wheel\" joint=\"{side}_wheel_joint\" kv=\"1.0\"/>\n");
    let castor = 0.5 * height;
    let custom = if numbers.is_empty() { numbers } else { format!("  <custom>\n{numbers}  </custom>\n") };
    let head = Comment::Xml.line(&export.heading()) + &Comment::Xml.lines(&notes);
    let text = format!(
        "{head}<mujoco model=\"robot\">\n  <compiler angle=\"degree\"/>\n{custom}  <worldbody>\n    \
         <geom name=\"floor\" type=\"plane\" size=\"0 0 1\"/>\n    \
         <body name=\"robot\" pos=\"0 0 {}\">\n      <freejoint/>\n      \
         <geom name=\"chassis\" type=\"box\" size=\"{} {} {}\" mass=\"5.0\"/>\n      \
         <geom name=\"castor\" type=\"sphere\" pos=\"{} 0 {}\" size=\"{}\" friction=\"0.001\"/>\n{}{}    </body>\n  </worldbody>\n  \
         <actuator>\n{}{}  </actuator>\n</mujoco>\n",
        number(height),
        number(0.8 * half),
        number(0.8 * half),
        number(0.3 * height),
        number(-0.7 * half),
        number(castor - height),
        number(castor),
        wheel("left", half, left),
        wheel("right", -half, right),
        actuator("left"),
        actuator("right"),
    );
    Ok(Written { text, notes })
}
