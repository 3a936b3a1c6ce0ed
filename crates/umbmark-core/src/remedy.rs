//! Which action is the way out of an error, however deep the error lies in others. No message names it: each edge has words of its own.

use crate::action::{Action, Wording};
use crate::apply::{ApplyError, CompileError};
use crate::calibrate::CalibrateError;
use crate::changed::ChangeError;
use crate::conditions::ConditionsError;
use crate::dataset::NoRobot;
use crate::drift::DriftError;
use crate::effect::ModelError;
use crate::evidence::FitError;
use crate::learn::GearError;
use crate::likelihood::KnowledgeError;
use crate::monte_carlo::{QuantityError, StudyError, SweepError};
use crate::paper::PaperError;
use crate::plan::PlanError;
use crate::sensitivity::SensitivityError;
use std::error::Error;

/// For each type of error, which of it has a way out, or holds an error that may have one.
macro_rules! by_type {
    ($error:ident; $($kind:ident: $($case:pat => $found:expr),+;)*) => {
        $(if let Some(error) = $error.downcast_ref::<$kind>() {
            return match error {
                $($case => $found,)+
                #[allow(unreachable_patterns, reason = "an error of one kind only")]
                _ => None,
            };
        })*
    };
}

/// What to do about an error; `None` where its message says it, or nothing can be done.
///
/// ```
/// use umbmark_core::{action::Action, effect::find, remedy};
/// let unknown = find("zzz").unwrap_err();
/// assert_eq!(unknown.to_string(), "there is no effect \"zzz\"");
/// assert_eq!(remedy::of(&unknown), Some(Action::ListEffects));
/// let misspelt = find("wheelbas").unwrap_err();
/// assert_eq!((misspelt.to_string().ends_with("did you mean \"wheelbase\"?"), remedy::of(&misspelt)), (true, None));
/// ```
pub fn of(error: &(dyn Error + 'static)) -> Option<Action> {
    by_type! {
        error;
        ModelError: ModelError::UnknownEffect { nearest: None, .. } => Some(Action::ListEffects);
        QuantityError: QuantityError::Unknown { nearest: None, .. } => Some(Action::ListEffects);
        NoRobot: NoRobot => Some(Action::Begin);
        FitError:
            FitError::NoRobot => Some(Action::Begin),
            FitError::Model(error) => of(error),
            FitError::Knowledge(error) => of(error);
        KnowledgeError: KnowledgeError::Model(error) => of(error);
        CompileError: CompileError::Formula { .. } | CompileError::Rollers { .. } => Some(Action::CorrectLogs);
        StudyError: StudyError::Model(error) => of(error), StudyError::Quantity(error) => of(error);
        PlanError:
            PlanError::UnknownSize { nearest: None, .. } => Some(Action::ListEffects),
            PlanError::Study(error) => of(error),
            PlanError::Diagnose(error) => of(error);
        ApplyError: ApplyError::Model(error) => of(error);
        CalibrateError: CalibrateError::Fit(error) => of(error);
        ChangeError: ChangeError::Fit { source, .. } => of(source);
        ConditionsError: ConditionsError::Fit { source, .. } => of(source);
        DriftError: DriftError::Data(error) => of(error);
        GearError: GearError::Fit(error) => of(error);
        PaperError: PaperError::Model(error) => of(error);
        SensitivityError: SensitivityError::Study(error) => of(error);
        SweepError: SweepError::Study(error) => of(error);
    }
    None
}

/// The message of an error, and behind it what to do in the words of an edge.
///
/// ```
/// use umbmark_core::{action::Action, effect::find, remedy};
/// let said = remedy::worded(&find("zzz").unwrap_err(), Action::plain);
/// assert_eq!(said, "there is no effect \"zzz\"; the catalogue lists them");
/// ```
pub fn worded(error: &(dyn Error + 'static), words: Wording) -> String {
    match of(error) {
        Some(action) => format!("{error}; {}", action.remedy(words)),
        None => error.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_within_others_keeps_its_way_out() {
        let unknown = || ModelError::UnknownEffect { name: "zzz".into(), nearest: None };
        let study = || StudyError::Model(unknown());
        let fit = || FitError::Model(unknown());
        let wrapped: [&(dyn Error + 'static); 12] = [
            &fit(),
            &KnowledgeError::Model(unknown()),
            &FitError::Knowledge(KnowledgeError::Model(unknown())),
            &PlanError::Study(study()),
            &PlanError::Diagnose(fit()),
            &ApplyError::Model(unknown()),
            &CalibrateError::Fit(fit()),
            &ChangeError::Fit { test: "before", source: fit() },
            &DriftError::Data(fit()),
            &GearError::Fit(fit()),
            &SensitivityError::Study(study()),
            &SweepError::Study(study()),
        ];
        for error in wrapped {
            let told = worded(error, Action::plain);
            assert!(told.ends_with("there is no effect \"zzz\"; the catalogue lists them"), "{told}");
        }
        assert_eq!(of(&FitError::NoRobot), of(&NoRobot));
        assert_eq!(of(&CompileError::TooMany { laws: 99 }), None);
    }
}
