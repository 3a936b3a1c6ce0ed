//! The motion noise of AMCL in Nav2.
//!
//! AMCL moves its particles once in a step, by a turn, a way d and a second turn, and draws for each of them (Thrun, Burgard & Fox,
//! Probabilistic Robotics, table 5.6, with alphas that are variances)
//!
//! ```text
//! variance of each turn   α1 turn² + α2 d²
//! variance of the way     α3 d² + α4 (turn₁² + turn₂²)
//! ```
//!
//! Its variances grow with the square of a step, those of wheels with the way itself. Way L is made of L/d steps, with two turns in
//! each, and a rotation Φ on the spot of Φ/θ steps, with one turn in each. So the two agree where
//!
//! ```text
//! α1 = r²/θ      α2 = h²/(2 d)      α3 = f²/d      α4 = 0
//! ```
//!
//! with the noise of the heading per root metre h and per root radian r, and that of the way f. α5, to the side, is read by the
//! motion model of robots that can drive sideways.

use super::covariance::NO_NOISE;
use super::text::number;
use super::{Comment, Export, ExportError, Target, Written};

/// AMCL takes a step after so much way \[m\] or so much rotation \[rad\]: the usual values of Nav2.
const STEP: (f64, f64) = (0.25, 0.2);

/// The alphas stand beside the steps that they are right for.
pub static TARGET: Target = Target {
    name: "amcl",
    about: "YAML for AMCL of Nav2: alpha1 to alpha5 from the fitted noise",
    holds_all: false,
    write,
};

fn write(export: &Export) -> Result<Written, ExportError> {
    let noise = export.noise.ok_or(ExportError::Missing { target: TARGET.name, what: NO_NOISE })?;
    let (way, turn) = STEP;
    let square = |size: f64| size * size;
    let mut body = String::new();
    for (key, value) in [
        ("alpha1", square(noise.heading_per_radian) / turn),
        ("alpha2", square(noise.heading_per_metre) / (2.0 * way)),
        ("alpha3", square(noise.forward_per_metre) / way),
        ("alpha4", 0.0),
        ("alpha5", square(noise.sideways_per_metre) / way),
        ("update_min_d", way),
        ("update_min_a", turn),
    ] {
        body += &format!("    {key}: {}\n", number(value));
    }
    let mut notes = export.uncorrected();
    notes.push(format!(
        "the alphas are right for steps of {way} m and {turn} rad, update_min_d and update_min_a; for other steps divide by them: \
         alpha2, alpha3 and alpha5 by the way, alpha1 by the turn"
    ));
    notes.push("where the robot turns while it drives, AMCL takes up to half the noise of the turn".to_owned());
    let head = Comment::Hash.line(&export.heading()) + &Comment::Hash.lines(&notes);
    let model = "    robot_model_type: \"nav2_amcl::DifferentialMotionModel\"\n";
    Ok(Written { text: format!("{head}amcl:\n  ros__parameters:\n{model}{body}"), notes })
}

#[cfg(test)]
mod tests {
    use super::super::tests::value;
    use super::*;
    use umbmark_core::drive::Robot;
    use umbmark_core::effect::Model;
    use umbmark_core::likelihood::Noise;

    /// Oracle: what AMCL adds over 10 m straight and over two turns on the spot, summed step by step, and the laws of the noise.
    #[test]
    fn the_alphas_add_up_to_the_noise_over_many_steps() {
        let noise =
            Noise { heading_per_metre: 0.004, heading_per_radian: 0.03, forward_per_metre: 0.005, ..Noise::default() };
        let model = Model::new(&Robot::labmate());
        let text = TARGET.write(&Export { noise: Some(noise), ..Export::of(&model) }).unwrap().text;
        let alpha = |n: usize| value(&text, &format!("alpha{n}"), ": ");
        let (mut heading, mut way) = (0.0, 0.0);
        for _ in 0..40 {
            heading += 2.0 * alpha(2) * 0.25 * 0.25;
            way += alpha(3) * 0.25 * 0.25;
        }
        assert!((heading / (0.004 * 0.004 * 10.0) - 1.0).abs() < 1e-6, "{heading}");
        assert!((way / (0.005 * 0.005 * 10.0) - 1.0).abs() < 1e-6, "{way}");
        let turned: f64 = (0..60).map(|_| alpha(1) * 0.2 * 0.2).sum();
        assert!((turned / (0.03 * 0.03 * 12.0) - 1.0).abs() < 1e-6, "{turned}");
    }

    #[test]
    fn without_noise_there_is_nothing_to_write() {
        let model = Model::new(&Robot::labmate());
        let said = TARGET.write(&Export::of(&model)).unwrap_err().to_string();
        assert_eq!(said, format!("amcl: {NO_NOISE}"));
    }
}
