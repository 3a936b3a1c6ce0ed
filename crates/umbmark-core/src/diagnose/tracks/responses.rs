//! What the effects and smooths that a model lacks would do to the poses of its runs.

use super::smooth::{self, Covariate, Motion, smooth_columns};
use crate::effect::{Changes, Entry, Model, ModelError, Number, Shapes, Shown, of_drive};
use crate::geometry::{Pose2, wrap};
use crate::likelihood::{Column, Fitted, NUISANCE, Observed};
use crate::parameter::Parameter;
use std::sync::Arc;

/// What is tested.
#[derive(Clone, Debug)]
pub enum Question {
    /// An effect of the catalogue, with the parameters that its columns stand for.
    Effect(&'static Entry, Vec<&'static Parameter>),
    /// A smooth of a covariate.
    Smooth(&'static Covariate, Motion),
}

/// A group of columns that may be missing from the model.
#[derive(Clone, Debug)]
pub struct Asked {
    /// What it is.
    pub question: Question,
    /// Its columns.
    pub columns: Vec<usize>,
    /// Its shapes that are tried at other values than the usual ones.
    pub shapes: Vec<(&'static Parameter, f64)>,
    /// Whether it is an effect of the reference, fitted out for the others.
    pub nuisance: bool,
}

impl Asked {
    /// The effect, if it is one.
    pub fn effect(&self) -> Option<&'static Entry> {
        match self.question {
            Question::Effect(entry, _) => Some(entry),
            Question::Smooth(..) => None,
        }
    }
}

/// All groups that are tested, with derivatives of the poses along a model.
#[derive(Clone, Debug)]
pub struct Responses {
    /// The groups.
    pub asked: Vec<Asked>,
    /// What the columns of the catalogue's effects are derivatives by; those of the smooths stand behind them.
    pub numbers: Vec<Number>,
    /// Run by run.
    pub columns: Vec<Vec<Column>>,
    /// The true poses, run by run, by the model that the derivatives were taken along.
    pub along: Vec<Arc<[Pose2]>>,
}

impl Responses {
    /// Of every effect of the catalogue that a model lacks and that shows in its runs, and of every smooth.
    pub fn new(fitted: &Fitted) -> Result<Responses, ModelError> {
        let (observed, model) = (&fitted.observed, &fitted.model);
        let offers = offers(model, observed);
        let numbers: Vec<Number> = offers.iter().flat_map(Offer::numbers).collect();
        let mut columns = observed.columns_of(model, &numbers)?;
        let shows = |number: usize| columns.iter().any(|run| run[number].iter().any(|c| *c != [0.0; 3]));
        let (mut asked, mut kept, mut next, mut silent) = (Vec::new(), Vec::new(), 0, None);
        for Offer { effect, shapes, sizes } in offers {
            let (first, own) = (kept.len(), next..next + sizes.len());
            next = own.end;
            let shown = sizes.into_iter().zip(own).filter(|(_, number)| silent != Some(effect) && shows(*number));
            let (parameters, shown): (Vec<_>, Vec<_>) = shown.unzip();
            if parameters.is_empty() {
                silent = Some(effect);
                continue;
            }
            kept.extend(shown);
            let nuisance = NUISANCE.contains(&effect.about.name);
            let columns = (first..kept.len()).collect();
            asked.push(Asked { question: Question::Effect(effect, parameters), columns, shapes, nuisance });
        }
        for (run, smooths) in columns.iter_mut().zip(smooth_columns(observed, model)) {
            *run = kept.iter().map(|number| std::mem::take(&mut run[*number])).chain(smooths).collect();
        }
        for (covariate, motion, first, terms) in smooth::groups() {
            let columns = (kept.len() + first..kept.len() + first + terms).collect();
            asked.push(Asked {
                question: Question::Smooth(covariate, motion),
                columns,
                shapes: Vec::new(),
                nuisance: false,
            });
        }
        let numbers = kept.into_iter().map(|number| numbers[number]).collect();
        Ok(Responses { asked, numbers, columns, along: places(observed) })
    }
}

fn places(observed: &Observed) -> Vec<Arc<[Pose2]>> {
    observed.runs.iter().map(|run| Arc::clone(&run.places)).collect()
}

/// Derivatives are kept while no pose has moved by more than this share of the farthest one's distance from START, and no heading by
/// more than so many radians: they are off by as small a share. A test may ask in any direction; this one is no farther
/// from that in which an effect moves the poses.
const STILL: f64 = 0.02;

/// Whether responses along these poses are those along the runs as they are laid now.
pub fn hold(along: &[Arc<[Pose2]>], observed: &Observed) -> bool {
    along.iter().zip(places(observed)).all(|(then, now)| {
        let far = then.iter().map(|pose| pose.x.hypot(pose.y)).fold(0.0, f64::max);
        then.iter().zip(now.iter()).all(|(then, now)| {
            (now.x - then.x).hypot(now.y - then.y) <= STILL * far && wrap(now.heading - then.heading).abs() <= STILL
        })
    })
}

/// An effect of the catalogue that a model lacks, with one value of each of its shapes.
struct Offer {
    effect: &'static Entry,
    shapes: Vec<(&'static Parameter, f64)>,
    sizes: Vec<&'static Parameter>,
}

impl Offer {
    fn numbers(&self) -> impl Iterator<Item = Number> + '_ {
        let mut shapes = Shapes::default();
        for (place, (parameter, value)) in shapes.iter_mut().zip(&self.shapes) {
            *place = Some((parameter.name, *value));
        }
        self.sizes.iter().map(move |size| Number { effect: self.effect.about.name, parameter: size.name, shapes })
    }
}

/// Every effect of the catalogue that the model lacks and that may move some observation, with each value of its shapes.
fn offers(model: &Model, observed: &Observed) -> Vec<Offer> {
    let missing = of_drive(model.robot().drive.kind()).filter(|entry| {
        entry.changes.include(Changes::MEAN) && model.parts().iter().all(|part| part.effect != **entry)
    });
    let shown = Shown { robot: model.robot(), extent: observed.extent() };
    let mut offers = Vec::new();
    for effect in missing {
        let parameters = &effect.about.parameters;
        let sizes: Vec<&Parameter> = parameters.iter().filter(|p| p.nothing().is_some()).collect();
        let offer = |tried: Vec<(&str, f64)>| {
            let of = |(name, value)| Some((parameters.iter().find(|p| p.name == name)?, value));
            Offer { effect, shapes: tried.into_iter().filter_map(of).collect(), sizes: sizes.clone() }
        };
        offers.extend((effect.tried)(&shown).into_iter().map(offer));
    }
    offers
}

#[cfg(test)]
mod tests {
    use super::super::{Examination, growth};
    use super::*;
    use crate::diagnose::{Options, first_model};
    use crate::drive::Robot;
    use crate::likelihood::watched::watched;
    use crate::path::{Direction, Path};
    use crate::replay::Track;

    /// Six and six squares, seed 4: a kick, and the castor's trail is yet to be found.
    #[test]
    fn responses_kept_while_a_model_grows_are_nearly_those_along_the_grown_one() {
        let robot = Robot::labmate();
        let mut truth = Model::new(&robot);
        truth.set("wheelbase", "e_b", 1.004).unwrap();
        truth.set("caster_kick", "kick_rad", 0.004).unwrap();
        truth.set("reference_noise", "position_sd_m", 5e-4).unwrap();
        truth.set("reference_noise", "heading_sd_rad", 5e-4).unwrap();
        let data = watched(&truth, 6, 4);
        let fitted =
            crate::evidence::tracks::fit(&Observed::new(&data, &robot).unwrap(), &first_model(&data).unwrap()).unwrap();
        let exam = Examination::new(fitted).unwrap();
        let findings = super::super::significance::effects(&exam, &Options::default());
        let suspect = super::super::class::suspect(&exam, &findings[0]).unwrap();
        assert!(suspect.class.contains(&"caster_kick"), "{:?}", suspect.class);
        let grown = growth::grown(&exam, &suspect).unwrap();
        assert!(hold(&exam.along, &grown.observed));
        let (kept, anew) = (exam.of_grown(grown.clone()).unwrap(), Examination::new(grown).unwrap());
        assert!(Arc::ptr_eq(&kept.along[0], &exam.along[0]) && !Arc::ptr_eq(&anew.along[0], &exam.along[0]));
        let names =
            |exam: &Examination| exam.asked.iter().map(|a| format!("{:?} {:?}", a.question, a.columns)).collect();
        let (kept_names, anew_names): (Vec<String>, Vec<String>) = (names(&kept), names(&anew));
        assert_eq!(kept_names, anew_names);
        let delay = crate::diagnose::Suspect { best: "reference_delay", estimate: Vec::new(), ..suspect };
        let delayed = exam.of_grown(growth::grown(&exam, &delay).unwrap()).unwrap();
        assert!(hold(&exam.along, &delayed.fitted.observed) && !Arc::ptr_eq(&delayed.along[0], &exam.along[0]));
        for column in 0..kept.system.residual() {
            let length = |sum: f64, value: &f64| sum + value * value;
            let runs = kept.some_columns(&[column]).into_iter().zip(anew.some_columns(&[column]));
            let (mut off, mut whole) = (0.0, 0.0);
            for (kept, anew) in runs {
                for (kept, anew) in kept[0].iter().zip(&anew[0]) {
                    off = [0, 1, 2].map(|k| kept[k] - anew[k]).iter().fold(off, length);
                    whole = anew.iter().fold(whole, length);
                }
            }
            assert!(off <= (STILL * STILL) * whole, "{:?}: {}", kept.number(column), (off / whole).sqrt());
        }
    }

    #[test]
    fn responses_hold_no_longer_where_a_heading_or_a_place_has_moved() {
        let robot = Robot::labmate();
        let track = || Track::with_stops(&Path::umbmark(), Direction::Ccw, &robot);
        let watched = Observed::new(&watched(&Model::new(&robot), 1, 3), &robot).unwrap();
        let model = |e_b: f64, e_s: f64| {
            let mut model = Model::new(&robot);
            model.set("wheelbase", "e_b", e_b).unwrap();
            model.set("scale", "e_s", e_s).unwrap();
            model
        };
        let of = |model: &Model| {
            let run = crate::likelihood::ObservedRun::planned(track(), Direction::Ccw, &watched.runs[0], model);
            Observed {
                robot: robot.clone(),
                runs: vec![run],
                path: None,
                setup: Default::default(),
                conditions: Default::default(),
                knowledge: Default::default(),
            }
        };
        let along = places(&of(&model(1.0, 1.0)));
        assert!(hold(&along, &of(&model(1.0, 1.0))) && hold(&along, &of(&model(1.002, 1.004))));
        assert!(!hold(&along, &of(&model(1.004, 1.0))) && !hold(&along, &of(&model(1.0, 1.021))));
    }
}
