"""What the package has: each name is loaded where it is first used."""

from . import results
from ._apply import Corrected, CorrectedRuns, apply
from ._arguments import Numbers, Seed
from ._calibration import Calibration, GearCalibration, calibrate, calibrate_gears
from ._changed import Changed, changed
from ._comparison import Comparison, TrackComparison, compare
from ._conditions import Conditions, conditions
from ._diagnosis import Diagnosis, Fitted, Learnt, diagnose, fit, learn
from ._documents import Correction, Effect, Setup
from ._each import Each, each, fleet
from ._errors import MissingDependencyError
from ._export import Exported, export
from ._formula import formula_of
from ._inspection import Inspection, inspect
from ._keys import (
    ActsOn,
    Drawn,
    Drive,
    EffectKeys,
    EffectName,
    PathKeys,
    RobotKeys,
    Shape,
)
from ._monte_carlo import MonteCarlo, merge, monte_carlo
from ._paper import Paper, paper
from ._plan import Plan, Separation, plan, separate
from ._report import Report, figures, plot, report
from ._scores import Score, score
from ._sensitivity import Sensitivity, sensitivity
from ._solution import Solution, solve
from ._survey import Survey, survey
from ._sweep import Sweep, sweep
from ._tolerance import Tolerance, tolerance
from ._tracks import Track, Tracks, tracks
from ._umbmark import (
    DataError,
    Dataset,
    Ensemble,
    Figure,
    FitError,
    Model,
    ModelError,
    Path,
    Robot,
    Run,
    Study,
    UmbmarkError,
    __version__,
    effects,
    init,
    load_dataset,
    presets,
    simulate,
)
from ._unlisted import Unlisted
from ._warnings import ConversionWarning, UmbmarkWarning
from ._watch import Watched, watch
from ._workbench import Workbench, open

__all__ = [
    "ActsOn",
    "Calibration",
    "Changed",
    "Comparison",
    "Conditions",
    "ConversionWarning",
    "Corrected",
    "CorrectedRuns",
    "Correction",
    "DataError",
    "Dataset",
    "Diagnosis",
    "Drawn",
    "Drive",
    "Each",
    "Effect",
    "EffectKeys",
    "EffectName",
    "Ensemble",
    "Exported",
    "Figure",
    "FitError",
    "Fitted",
    "GearCalibration",
    "Inspection",
    "Learnt",
    "MissingDependencyError",
    "Model",
    "ModelError",
    "MonteCarlo",
    "Numbers",
    "Paper",
    "Path",
    "PathKeys",
    "Plan",
    "Report",
    "Robot",
    "RobotKeys",
    "Run",
    "Score",
    "Seed",
    "Sensitivity",
    "Separation",
    "Setup",
    "Shape",
    "Solution",
    "Study",
    "Survey",
    "Sweep",
    "Tolerance",
    "Track",
    "TrackComparison",
    "Tracks",
    "UmbmarkError",
    "UmbmarkWarning",
    "Unlisted",
    "Watched",
    "Workbench",
    "__version__",
    "apply",
    "calibrate",
    "calibrate_gears",
    "changed",
    "compare",
    "conditions",
    "diagnose",
    "each",
    "effects",
    "export",
    "figures",
    "fit",
    "fleet",
    "formula_of",
    "init",
    "inspect",
    "learn",
    "load_dataset",
    "merge",
    "monte_carlo",
    "open",
    "paper",
    "plan",
    "plot",
    "presets",
    "report",
    "results",
    "score",
    "sensitivity",
    "separate",
    "simulate",
    "solve",
    "survey",
    "sweep",
    "tolerance",
    "tracks",
    "watch",
]
