//! What the package raises beside Python's own exceptions.

use std::any::Any;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use umbmark_core::calibrate::CalibrateError;
use umbmark_core::changed::ChangeError;
use umbmark_core::conditions::ConditionsError;
use umbmark_core::dataset::NoRobot;
use umbmark_core::drift::DriftError;
use umbmark_core::effect::{FormulaError, ModelError as CoreModelError};
use umbmark_core::evidence::FitError as CoreFitError;
use umbmark_core::joined::JoinError;
use umbmark_core::learn::GearError;
use umbmark_core::remedy;
use umbmark_core::score::ScoreError;
use umbmark_io::checkpoint::CheckpointError;
use umbmark_io::{DatasetError, StateError};

use crate::actions;

/// Each exception with its base and its documentation, and those of the core that become it.
macro_rules! exceptions {
    ($($name:ident($base:ty, $about:literal) $(= $($error:ty),+)?;)*) => {
        $(pyo3::create_exception!(umbmark, $name, $base, $about);)*

        /// What is refused, in its own words, as the exception that it belongs to.
        pub fn refused(error: impl std::error::Error + 'static) -> PyErr {
            let (text, any) = (remedy::worded(&error, actions), &error as &dyn Any);
            $($(if false $(|| any.is::<$error>())+ {
                return $name::new_err(text);
            })?)*
            UmbmarkError::new_err(text)
        }

        /// Adds them to the module.
        pub fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
            $(module.add(stringify!($name), module.py().get_type::<$name>())?;)*
            Ok(())
        }
    };
}

exceptions! {
    UmbmarkError(
        PyValueError,
        "What cannot be done with what was given. Arguments that are out of range raise ``ValueError`` itself."
    );
    DataError(
        UmbmarkError,
        "A file that cannot be read, or measurements that do not hold what was asked of them."
    ) = DatasetError, JoinError, NoRobot, ScoreError, CalibrateError, CheckpointError, DriftError, StateError;
    ModelError(UmbmarkError, "A model with an effect, a parameter, a value or a formula that there is not.")
        = CoreModelError, FormulaError;
    FitError(UmbmarkError, "A model that cannot be fitted to these measurements.") = CoreFitError, GearError, ChangeError, ConditionsError;
}
