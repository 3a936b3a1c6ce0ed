//! learning on tracks
use super::Options;
use super::examination::{Examination, Question, worth};
use super::system::{Misses, Projected};
use super::tracks::{Finding, class, look};
use crate::effect::{Model, ModelError};
use crate::likelihood::{Fitted, Noise, Observed};
use nalgebra::DVector;

/// Share by which the held-out error must fall.
const LEAST_GAIN: f64 = 0.01;

#[derive(Clone, Debug)]
pub struct Step {
    pub added: Option<&'static str>,
    pub class: Vec<&'static str>,
    pub p: Option<f64>,
    pub inside: Misses,
    pub heldout: Misses,
    pub note: String,
}

pub fn in_sample(exam: &Examination) -> Misses {
    exam.system.misses(|_| (vec![], DVector::zeros(0)))
}

/// Leave one run out with the model as it is, and with one more effect chosen anew in each fold.
pub fn held_out(exam: &Examination) -> Misses {
    exam.system.misses(|run| {
        let products = exam.system.sum(|unit| unit.run != run);
        (exam.free.clone(), Projected::fit(&products, &exam.free))
    })
}

pub fn nested(exam: &Examination) -> (Misses, Vec<&'static str>) {
    let picks = std::cell::RefCell::new(Vec::new());
    let misses = exam.system.misses(|run| {
        let products = exam.system.sum(|unit| unit.run != run);
        let base = exam.base(None);
        let projected = Projected::new(&products, &base);
        let best = exam
            .asked
            .iter()
            .enumerate()
            .filter(|(_, a)| a.effect().is_some())
            .filter_map(|(index, asked)| {
                if asked.nuisance {
                    exam.answer(&Projected::new(&products, &exam.base(Some(index))), &products, index)
                } else {
                    exam.answer(&projected, &products, index)
                }
            })
            .max_by(|a, b| worth(a).total_cmp(&worth(b)));
        let mut columns = exam.free.clone();
        if let Some(best) = best {
            picks.borrow_mut().push(exam.asked[best.asked].effect().unwrap().about.name);
            columns.extend(best.columns);
        }
        let values = Projected::fit(&products, &columns);
        (columns, values)
    });
    (misses, picks.into_inner())
}

fn extended(exam: &Examination, finding: &Finding) -> Result<Model, ModelError> {
    let Question::Effect(entry, parameters) = &exam.asked[finding.answer.asked].question else { unreachable!() };
    let mut model = exam.fitted.model.clone();
    model.add(entry.about.name)?.free = true;
    for (k, column) in finding.answer.columns.iter().enumerate() {
        let which = exam.asked[finding.answer.asked].columns.iter().position(|c| c == column).unwrap();
        let parameter = parameters[which];
        let zero = parameter.default.resolve(model.robot());
        let value = (zero + finding.answer.step[k]).clamp(parameter.bounds.0, parameter.bounds.1);
        model.set(entry.about.name, parameter.name, value)?;
    }
    Ok(model)
}

fn refit(observed: &Observed, model: &Model, noise: &Noise) -> Result<Fitted, ModelError> {
    let fitted = observed.fit(
        model,
        &{
            let _ = noise;
            Noise::default()
        },
        &[],
    )?;
    Ok(fitted)
}

pub fn learn(observed: &Observed, options: &Options, say: &mut dyn FnMut(&Step)) -> Result<Fitted, ModelError> {
    let mut model = Model::new(&observed.robot);
    let mut noise = Noise::default();
    for name in [None, Some("wheel_diameter_ratio"), Some("wheelbase"), Some("scale")] {
        if let Some(name) = name {
            model.add(name)?.free = true;
        }
        let fitted = observed.fit(&model, &Noise::default(), &[])?;
        let exam = Examination::bare(fitted);
        model = exam.fitted.model.clone();
        noise = exam.fitted.noise;
        say(&Step {
            added: name,
            class: vec![],
            p: None,
            inside: in_sample(&exam),
            heldout: held_out(&exam),
            note: String::new(),
        });
    }
    let _ = noise;
    let mut fitted = observed.fit(&model, &Noise::default(), &[])?;
    for _ in 0..6 {
        let exam = Examination::new(fitted.clone())?;
        let findings = look(&exam, &[], false, options);
        let smooths = look(&exam, &[], true, options);
        let before = held_out(&exam);
        let (after, picks) = nested(&exam);
        let Some(best) = findings.first() else { break };
        let name = exam.asked[best.answer.asked].effect().unwrap().about.name;
        let smooth = &smooths[0];
        println!(
            "   best {name} drop {:.1} p_f {:.1e} flips {:.4} step {:?}; smooth {:?} {:.1} {:.1e} {:.4}; held out {:.3} -> {:.3} mm, {:.3} -> {:.3} mrad {:?}",
            best.answer.drop,
            best.p_f,
            best.p_flips,
            best.answer.step.as_slice(),
            match &exam.asked[smooth.answer.asked].question {
                Question::Smooth(c, m) => (c.name, m.name()),
                _ => ("", ""),
            },
            smooth.answer.drop,
            smooth.p_f,
            smooth.p_flips,
            1e3 * before.position,
            1e3 * after.position,
            1e3 * before.heading.unwrap_or(0.0),
            1e3 * after.heading.unwrap_or(0.0),
            picks
        );
        {
            let su = super::tracks::suspect(&exam, best, &[]).unwrap();
            println!(
                "   {:?}",
                su.estimate.iter().map(|e| (e.parameter, e.value, e.standard_error)).collect::<Vec<_>>()
            );
            println!("   cov {:?}", best.answer.covariance);
            println!(
                "   scores {:?}",
                super::tracks::scores(&exam, best).units.iter().map(|u| u.as_slice().to_vec()).collect::<Vec<_>>()
            );
        }
        for f in findings.iter().skip(1).take(3) {
            println!(
                "        then {} drop {:.1} p_f {:.1e} flips {:.4} {:?}",
                exam.asked[f.answer.asked].effect().unwrap().about.name,
                f.answer.drop,
                f.p_f,
                f.p_flips,
                f.answer.step.as_slice()
            );
        }
        let gain = (1.0 - after.position / before.position)
            .max(1.0 - after.heading.unwrap_or(1.0) / before.heading.unwrap_or(1.0));
        if !best.certified(options) || gain < LEAST_GAIN {
            break;
        }
        let members = class(&exam, best, &[]);
        let p = best.p_adjusted();
        let model = extended(&exam, best)?;
        fitted = refit(observed, &model, &exam.fitted.noise)?;
        let exam = Examination::bare(fitted.clone());
        say(&Step {
            added: Some(name),
            class: members,
            p: Some(p),
            inside: in_sample(&exam),
            heldout: held_out(&exam),
            note: format!(
                "{:?}",
                fitted.model.parts().iter().map(|p| (p.effect.about.name, p.values.clone())).collect::<Vec<_>>()
            ),
        });
    }
    Ok(fitted)
}
