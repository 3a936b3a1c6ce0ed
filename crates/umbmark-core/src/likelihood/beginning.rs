//! Start values of a fit: the motion alone determines clock and mounting of the reference, and the robot's sizes if these are far from
//! nominal.

use super::observed::Observed;
use crate::effect::{Model, ModelError, Part};
use crate::replay::Track;
use crate::setup::Mounting;
use crate::stats::{Measured, t_two_sided};

/// Clock and mounting of the reference are taken from the motion if they differ from zero by this many standard errors ...
const SURE: f64 = 5.0;
/// ... and exceed this: smaller ones are fitted with the model, and tested like any effect.
const LATE: f64 = 0.010;
const AWAY: f64 = 0.010;
const TURNED: f64 = 0.020;
/// Sizes of the robot that differ from nominal by this share: a fit from the nominal ones may end in another minimum.
pub(crate) const FAR: f64 = 0.04;
/// A ratio is used as a start value if it is this multiple of its standard error.
const KNOWN: f64 = 5.0;
/// A track counts as far off, too, if its final heading by the nominal robot is wrong by more than this \[rad\].
const AWAY_BY: f64 = 0.2;
/// Number of parts into which the data is split to estimate values from the motion.
const PARTS: f64 = 8.0;

/// Effects that look like a delay of the reference to the motion.
const CLOCKS: [&str; 3] = ["reference_delay", "reference_clock_rate", "encoder_skew"];

/// Effects of clock and mounting of the reference that the motion alone determines.
const OF_REFERENCE: [&str; 4] = ["reference_delay", "reference_clock_rate", "marker_offset", "marker_yaw"];

/// Whether the motion alone determines what an effect is for: a model that fixes it says otherwise.
pub(crate) fn stands_for_the_reference(effect: &str) -> bool {
    OF_REFERENCE.contains(&effect) || CLOCKS.contains(&effect)
}

/// An effect of the reference that was taken from the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taken {
    /// Its name.
    pub effect: &'static str,
    /// Its parameters, as estimated from the motion.
    pub values: [Option<(&'static str, Measured)>; 2],
    /// Probability of so large a value by chance.
    pub p: f64,
}

impl Taken {
    /// Sets the effect's numbers in a model, free to be fitted.
    pub fn put_on(&self, model: &mut Model) -> Result<(), ModelError> {
        for (parameter, measured) in self.values.into_iter().flatten() {
            model.set(self.effect, parameter, measured.value)?;
        }
        model.add(self.effect)?.free = true;
        Ok(())
    }
}

impl Observed {
    /// Prepares the fit of a model: sets clock and mounting of the reference as estimated from the motion, and start values near the
    /// robot's sizes.
    pub fn begin(&self, model: &Model) -> Result<(Model, Vec<Taken>), ModelError> {
        let (mut model, taken) = self.with_reference(model)?;
        if let Some(mounting) = &self.setup.mounting {
            self.start_near(&mut model, mounting)?;
        }
        Ok((model, taken))
    }

    /// The model with clock and mounting of the reference as estimated from the motion, if they are large and the model does not set them.
    fn with_reference(&self, model: &Model) -> Result<(Model, Vec<Taken>), ModelError> {
        let found = self.reference_beside(model);
        let mut begun = model.clone();
        found.iter().try_for_each(|found| found.put_on(&mut begun))?;
        let is_new = |found: &Taken| model.parts().iter().all(|part| part.effect.name() != found.effect);
        Ok((begun, found.into_iter().filter(is_new).collect()))
    }

    /// Clock and mounting of the reference as estimated from the motion, if they are large and the model does not set them.
    pub fn reference_beside(&self, model: &Model) -> Vec<Taken> {
        let Some(mounting) = self.setup.mounting else { return Vec::new() };
        let sights = self.runs.iter().filter_map(|run| run.track.sights().last());
        let duration = sights.map(|sight| sight.time).fold(0.0, f64::max);
        let at_work = |part: &Part| part.values.iter().any(|value| *value != 0.0);
        let clock_at_work = model.parts().iter().any(|part| at_work(part) && CLOCKS.contains(&part.effect.name()));
        let is_said = |found: &Taken| {
            // Values of the reference that the model sets are kept, except start values without influence.
            let says = |part: &Part| part.effect.name() == found.effect && (!part.free || at_work(part));
            // One of these effects already explains the delay that the motion shows.
            clock_at_work && CLOCKS.contains(&found.effect) || model.parts().iter().any(says)
        };
        of_reference(&mounting, duration).into_iter().filter(|found| !is_said(found)).collect()
    }

    /// The ratio of a first effect of a differential drive, estimated from the motion alone; `None` if the motion does not determine it.
    pub fn ratio_by_motion(&self, effect: &str) -> Option<f64> {
        let mounting = self.setup.mounting.as_ref().filter(|_| self.robot.drive.kind().has_axle_wheels())?;
        ratios(mounting, self.robot.drive.wheelbase()).into_iter().find(|(name, ..)| *name == effect)?.2
    }

    /// Whether, by the motion, the heading at the end of a track differs much from that of the nominal robot.
    fn turns_away(&self, track: &Track, mounting: &Mounting) -> bool {
        let turned = track.contexts().iter().map(|at| (at.turn_rate * at.duration).abs()).sum::<f64>();
        let known = |m: &Option<Measured>| m.filter(|m| m.is_beyond(2.0)).map(|m| m.value);
        let drift = known(&mounting.drift).map_or(0.0, |drift| (drift * track.length()).abs());
        drift.max(known(&mounting.gain).map_or(0.0, |gain| ((gain - 1.0) * turned).abs())) > AWAY_BY
    }

    /// Sets the free first effects of a differential drive to the values from the motion, if these are far from their start values.
    fn start_near(&self, model: &mut Model, mounting: &Mounting) -> Result<(), ModelError> {
        if !self.robot.drive.kind().has_axle_wheels() {
            return Ok(());
        }
        let values = ratios(mounting, self.robot.drive.wheelbase());
        let far = values.iter().any(|(_, _, value)| value.is_some_and(|value| (value - 1.0).abs() > FAR))
            || self.tracks().any(|track| self.turns_away(track, mounting));
        for (effect, parameter, value) in values.into_iter().filter(|_| far) {
            let is_free = model.parts().iter().any(|part| part.effect.name() == effect && part.free);
            if let Some(value) = value.filter(|_| is_free && model.get(effect, parameter) == Some(1.0)) {
                let (low, high) = crate::effect::find(effect)?.about.parameters[0].bounds;
                model.set(effect, parameter, value.clamp(low, high))?;
            }
        }
        Ok(())
    }
}

/// The effects of the reference that are significantly large, in runs of at most this duration \[s\].
pub(crate) fn of_reference(mounting: &Mounting, duration: f64) -> Vec<Taken> {
    let rate = mounting.rate.filter(|rate| rate.is_beyond(SURE) && rate.value.abs() * duration > LATE);
    // A delay is that at the beginning of a run.
    let delay = mounting.delay.less(rate.map_or(0.0, |rate| rate.value * mounting.middle));
    let mut found = Vec::new();
    if delay.is_beyond(SURE) && delay.value.abs() > LATE {
        found.push(("reference_delay", [Some(("delay_s", delay)), None]));
    }
    if let Some(rate) = rate {
        found.push(("reference_clock_rate", [Some(("ratio", rate)), None]));
    }
    if let (Some(ahead), Some(left)) = (mounting.ahead, mounting.left) {
        let large = |m: &Measured| m.is_beyond(SURE) && m.value.abs() > AWAY;
        if large(&ahead) || large(&left) {
            found.push(("marker_offset", [Some(("forward_m", ahead)), Some(("left_m", left))]));
        }
    }
    if let Some(yaw) = mounting.yaw.filter(|yaw| yaw.is_beyond(SURE) && yaw.value.abs() > TURNED) {
        found.push(("marker_yaw", [Some(("yaw_rad", yaw)), None]));
    }
    let p = |measured: &Measured| t_two_sided(measured.value / measured.std_error, PARTS - 1.0);
    let of = |(effect, values): (&'static str, [Option<(&'static str, Measured)>; 2])| {
        let p = values.iter().flatten().map(|(_, measured)| p(measured)).fold(1.0, f64::min);
        Taken { effect, values, p }
    };
    found.into_iter().map(of).collect()
}

/// The first effects of a differential drive, with their values from the motion.
pub(crate) fn ratios(mounting: &Mounting, wheelbase: f64) -> [(&'static str, &'static str, Option<f64>); 3] {
    let known = |m: &Measured| m.value > 0.0 && m.is_beyond(KNOWN);
    let value = |measured: &Option<Measured>| measured.filter(known).map(|m| m.value);
    let (scale, gain) = (value(&mounting.scale), value(&mounting.gain));
    let drift = mounting.drift.map_or(0.0, |drift| drift.value);
    let e_b = gain.map(|gain| scale.unwrap_or(1.0) / gain);
    // A metre ahead turns the robot by 2 g (E_d - 1)/((E_d + 1) b).
    let bend = gain.map(|gain| 0.5 * drift * wheelbase / gain);
    let e_d = bend.map(|bend| (1.0 + bend) / (1.0 - bend));
    [("scale", "e_s", scale), ("wheelbase", "e_b", e_b), ("wheel_diameter_ratio", "e_d", e_d)]
}
