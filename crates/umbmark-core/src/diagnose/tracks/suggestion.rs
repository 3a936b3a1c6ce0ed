//! A formula for what the catalogue does not list: of a small family, the one that explains most of what the smooth does.
//!
//! Each formula of the family is tested as an effect is, by its own columns beside the model, so it is judged by the data and
//! not by the looks of a curve. Its sizes start at their values after one step from zero, its shape at the one tried.

use super::examination::Examination;
use super::finding::{Finding, worth_of};
use super::smooth::{Covariate, Exposure, Motion, Scales};
use crate::effect::{Formula, Model, Target};
use crate::evidence::tracks::{Projected, System};
use crate::likelihood::Column;

/// A formula is suggested where it explains at least this share of what the smooth does.
const ENOUGH: f64 = 0.5;

/// A formula to try.
#[derive(Clone, Debug, PartialEq)]
pub struct Suggestion {
    /// A model that holds it alone, free and with start values.
    pub model: Model,
    /// Share of the smooth's drop that it explains, at most 1.
    pub share: f64,
}

/// A member of the family.
struct Member {
    text: String,
    /// Parameters that the formula is linear in.
    sizes: &'static [&'static str],
    /// A further parameter with its start value.
    shape: Option<(&'static str, f64)>,
}

/// The formula that explains most of what a smooth does, if one does.
pub fn suggestion(exam: &Examination, finding: &Finding, covariate: &Covariate, motion: Motion) -> Option<Suggestion> {
    let scales = Scales::new(&exam.fitted.observed);
    let targets = targets(covariate, motion);
    let both = targets.iter().flat_map(|target| family(covariate, &scales).into_iter().map(move |m| (*target, m)));
    let members: Vec<(Member, Model)> =
        both.filter_map(|(target, member)| own_model(exam, target, &member).map(|model| (member, model))).collect();
    let base = exam.base(None);
    let system = with_members(exam, &base, &members);
    let projected = Projected::new(&system.whole, &(0..base.len()).collect::<Vec<_>>());
    let mut first = base.len();
    let mut best: Option<(f64, Suggestion)> = None;
    for (member, mut model) in members {
        let columns: Vec<usize> = (first..first + member.sizes.len()).collect();
        first += member.sizes.len();
        let Some((drop, step, _)) = projected.drop(&columns) else { continue };
        let worth = worth_of(drop, columns.len() + usize::from(member.shape.is_some()));
        for (name, value) in member.sizes.iter().zip(step.iter()) {
            let rounded = format!("{value:.2e}").parse().unwrap_or(*value);
            model.set(NAME, name, rounded).ok()?;
        }
        if best.as_ref().is_none_or(|(most, _)| worth > *most) {
            best = Some((worth, Suggestion { model, share: (drop / finding.answer.drop).min(1.0) }));
        }
    }
    best.map(|(_, suggestion)| suggestion).filter(|suggestion| suggestion.share >= ENOUGH)
}

/// The name that a suggested effect has.
const NAME: &str = "unlisted";

/// What a formula has to act on to do what the smooth does.
fn targets(covariate: &Covariate, motion: Motion) -> Vec<Target> {
    match (covariate.exposure, motion) {
        (Exposure::WheelWay(0), _) => vec![Target::LeftWheelScale],
        (Exposure::WheelWay(_), _) => vec![Target::RightWheelScale],
        (Exposure::Rotation | Exposure::TimeInSense, Motion::Yaw) => vec![Target::TurnScale],
        (Exposure::Rotation, Motion::Forward) => vec![Target::ForwardPerRadian],
        (Exposure::Rotation, Motion::Sideways) => vec![Target::SidewaysPerRadian],
        (_, Motion::Yaw) => vec![Target::HeadingPerMetre],
        (_, Motion::Forward) => vec![Target::ForwardScale],
        (_, Motion::Sideways) => vec![Target::SidewaysPerMetre],
    }
}

/// The family of formulas in one variable.
fn family(covariate: &Covariate, scales: &Scales) -> Vec<Member> {
    let x = covariate.name;
    let member = |text: String| Member { text, sizes: &["k"], shape: None };
    let shaped = |text: String, name, value| Member { text, sizes: &["k"], shape: Some((name, value)) };
    match x {
        "heading" | "wheel_angle_left" | "wheel_angle_right" => (1..=3)
            .map(|n| Member {
                text: format!("a * cos({n} * {x}) + b * sin({n} * {x})"),
                sizes: &["a", "b"],
                shape: None,
            })
            .collect(),
        "since_turn" | "since_turn * last_turn" => {
            let sense = if x == "since_turn" { "k" } else { "k * last_turn" };
            let trails = [0.03, 0.05, 0.1, 0.15, 0.25, 0.5];
            trails.map(|l| shaped(format!("{sense} * exp(-since_turn / l)"), "l", l)).into()
        }
        "time" => {
            let fades = [0.03, 0.06, 0.12, 0.25, 0.5];
            let fades = fades.map(|share| shaped("k * exp(-time / t)".into(), "t", round(share * scales.duration)));
            std::iter::once(member("k * time".into())).chain(fades).collect()
        }
        "last_turn" | "direction" | "distance" | "session_distance" => vec![member(format!("k * {x}"))],
        _ => {
            let size = if x == "speed" { x.to_owned() } else { format!("abs({x})") };
            let above = |share: f64| {
                let text = format!("k * (1 + sign({size} - threshold)) / 2");
                shaped(text, "threshold", round(share * (covariate.scale)(scales)))
            };
            let plain = [format!("k * {x}"), format!("k * abs({x})"), format!("k * {x}^2")].map(member);
            plain.into_iter().chain((1..10).map(|tenth| above(0.1 * f64::from(tenth)))).collect()
        }
    }
}

fn round(value: f64) -> f64 {
    format!("{value:.1e}").parse().unwrap_or(value)
}

/// A model that holds a formula alone, if it is one that this robot's runs allow.
fn own_model(exam: &Examination, target: Target, member: &Member) -> Option<Model> {
    let names: Vec<&str> = member.sizes.iter().copied().chain(member.shape.map(|(name, _)| name)).collect();
    let values: Vec<f64> = member.sizes.iter().map(|_| 0.0).chain(member.shape.map(|(_, value)| value)).collect();
    let formula = Formula::new(NAME, target, &member.text, &names).ok()?;
    let mut model = Model::new(&exam.fitted.observed.robot);
    model.add_formula(formula, &values).ok()?.free = true;
    exam.fitted.observed.tracks().try_for_each(|track| track.check(&model)).ok().map(|()| model)
}

/// The base's columns, those of each member's sizes, and the residual.
fn with_members(exam: &Examination, base: &[usize], members: &[(Member, Model)]) -> System {
    let observed = &exam.fitted.observed;
    let mut columns: Vec<Vec<Column>> = exam.some_columns(base);
    for (member, own) in members {
        let mut with = exam.fitted.model.clone();
        own.parts().iter().for_each(|part| with.adopt(part));
        let first = with.values().count() - own.values().count();
        let sizes: Vec<usize> = (first..first + member.sizes.len()).collect();
        columns.iter_mut().zip(observed.columns(&with, &sizes)).for_each(|(all, new)| all.extend(new));
    }
    let residual = exam.some_columns(&[exam.system.residual()]);
    columns.iter_mut().zip(residual).for_each(|(all, new)| all.extend(new));
    System::new(observed, &exam.fitted.noise, &columns)
}

#[cfg(test)]
mod tests {
    use super::super::smooth::COVARIATES;
    use super::*;

    #[test]
    fn a_formula_acts_on_what_the_smooth_is_in_proportion_to() {
        let told =
            |name: &str, motion| targets(COVARIATES.iter().find(|covariate| covariate.name == name).unwrap(), motion);
        assert_eq!(told("turn_rate", Motion::Forward), [Target::ForwardPerRadian]);
        assert_eq!(told("turn_rate", Motion::Sideways), [Target::SidewaysPerRadian]);
        assert_eq!(told("turn_rate", Motion::Yaw), [Target::TurnScale]);
        assert_eq!(told("speed", Motion::Forward), [Target::ForwardScale]);
        assert_eq!(told("heading", Motion::Sideways), [Target::SidewaysPerMetre]);
        assert_eq!(told("wheel_angle_right", Motion::Yaw), [Target::RightWheelScale]);
    }

    #[test]
    fn thresholds_are_tried_at_every_tenth_of_the_greatest_value() {
        let scales = Scales { speed: 0.2, turn_rate: 1.2, duration: 100.0, runs: 6.0, wheelbase: 0.34, turns: true };
        let covariate = COVARIATES.iter().find(|covariate| covariate.name == "speed").unwrap();
        let tried: Vec<f64> = family(covariate, &scales).iter().filter_map(|member| Some(member.shape?.1)).collect();
        assert_eq!(tried, [0.02, 0.04, 0.06, 0.08, 0.1, 0.12, 0.14, 0.16, 0.18]);
    }
}
