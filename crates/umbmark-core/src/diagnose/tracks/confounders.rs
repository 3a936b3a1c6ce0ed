//! What effects that the model lacks would do to its first numbers.

use super::conclusion::surely;
use super::examination::Examination;
use crate::diagnose::confounder::{Bias, Confounder};
use crate::effect::{ActsOn, parameter_of};
use crate::evidence::Estimate;
use crate::evidence::tracks::Projected;
use nalgebra::DMatrix;

/// A bias below this share of a number's usual size is not told, however narrow its interval.
const MATTERS: f64 = 0.1;

/// The effects of the robot and the floor that may move one of the first numbers of the model beyond its interval: the worst of them first.
/// `fitted` is what is told of the model.
pub(super) fn confounders(exam: &Examination, fitted: &[Estimate], level: f64) -> Vec<Confounder> {
    let products = &exam.system.whole;
    let first = exam.fitted.model.robot().drive.first_effects();
    let mut confounders = Vec::new();
    for (index, effect, parameters) in exam.representatives() {
        if matches!(effect.about.acts_on, ActsOn::Reference | ActsOn::Start) {
            continue;
        }
        let projected = Projected::new(products, &exam.base(Some(index)));
        for (column, parameter) in exam.asked[index].columns.iter().zip(parameters) {
            let size = possible(&projected, products, *column, parameter.typical);
            let bias_of = |own: &Estimate| {
                let place = projected.base.iter().position(|column| {
                    exam.number(*column)
                        .is_some_and(|number| (number.effect, number.parameter) == (own.effect, own.parameter))
                })?;
                let bias = (projected.coefficients[(place, *column)] * size).abs();
                let (interval, usual) = (own.interval(level)?, parameter_of(own.effect, own.parameter)?.typical);
                let half_width = 0.5 * (interval.high - interval.low);
                (bias > half_width.max(MATTERS * usual)).then_some(Bias {
                    effect: own.effect,
                    parameter: own.parameter,
                    bias,
                    half_width,
                })
            };
            let biases: Vec<Bias> =
                fitted.iter().filter(|own| first.contains(&own.effect)).filter_map(bias_of).collect();
            if !biases.is_empty() {
                confounders.push(Confounder { effect: effect.about.name, parameter: parameter.name, size, biases });
            }
        }
    }
    confounders.sort_by(|a, b| b.worst().total_cmp(&a.worst()));
    confounders
}

/// How large an effect with this column may be that is left out: as these runs show it, else as usual, if these runs would not show that.
fn possible(projected: &Projected, products: &DMatrix<f64>, column: usize, usual: f64) -> f64 {
    if projected.absorbed(products, column) {
        return usual;
    }
    match projected.drop(&[column]) {
        Some((drop, step, _)) if drop.sqrt() > surely() => step[0].abs(),
        _ => usual.min(surely() / projected.products[(column, column)].sqrt()),
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{complete, fitted};
    use super::*;
    use crate::diagnose::Verdict;
    use crate::diagnose::confounder::sentence;
    use crate::evidence::tracks::estimates;

    /// Oracle: the fit to a robot that has the effect beside the fit to one that has not, same seed.
    #[test]
    fn an_effect_that_is_not_shown_moves_the_numbers_by_as_much_as_is_said_of_it() {
        let without = &complete().fitted;
        let told = confounders(complete(), &estimates(without), 0.95);
        let slip = told.iter().find(|own| own.effect == "turn_slip").unwrap();
        assert_eq!((slip.parameter, slip.size), ("share", 0.005));
        let with = estimates(&fitted(&[("turn_slip", "share", slip.size)]));
        let [bias] = &slip.biases[..] else { panic!("{slip:?}") };
        assert_eq!((bias.effect, bias.parameter), ("wheelbase", "e_b"));
        let moved = with.iter().zip(estimates(without)).find(|(own, _)| own.effect == "wheelbase");
        let moved = moved.map(|(with, without)| (with.value - without.value).abs()).unwrap();
        assert!((moved / bias.bias - 1.0).abs() < 0.1, "{moved} {bias:?}");
        assert!(bias.bias > bias.half_width);
    }

    #[test]
    fn of_each_number_the_worst_is_told_and_nothing_where_every_interval_is_wide_enough() {
        let fitted = estimates(&complete().fitted);
        let wide: Vec<Estimate> = fitted.iter().map(|own| Estimate { standard_error: 1.0, ..own.clone() }).collect();
        assert_eq!(confounders(complete(), &wide, 0.95), []);
        assert_eq!(sentence(&[], Verdict::Explained), None);
        let bias = |parameter, bias| Bias { effect: "scale", parameter, bias, half_width: 0.001 };
        let own = |effect, biases: Vec<Bias>| Confounder { effect, parameter: "s_per_m", size: 0.0149, biases };
        let both = [
            own("speed_slip_left", vec![bias("e_s", 0.002)]),
            own("speed_slip", vec![bias("e_s", 0.004), bias("e_b", 0.003)]),
        ];
        let told = sentence(&both, Verdict::Explained).unwrap();
        let expected = "would move e_s of scale by 0.0040 (speed_slip of 0.015 s/m), e_b of scale by 0.0030 (speed_slip of 0.015 s/m). \
                        What would show speed_slip: one straight leg at each of two speeds, measured by tape.";
        assert!(told.ends_with(expected), "{told}");
        assert!(told.starts_with("The intervals hold if the model lacks no effect."), "{told}");
        let told = sentence(&both, Verdict::UnlistedEffect).unwrap();
        assert!(told.starts_with("The intervals do not allow for what the model does not explain."), "{told}");
        assert!(told.ends_with(expected), "{told}");
    }
}
