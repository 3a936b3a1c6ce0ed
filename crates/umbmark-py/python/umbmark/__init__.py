"""Measure, explain and correct the odometry error of wheeled robots.

UMBmark is the benchmark test of Borenstein and Feng (1995): a robot drives a square in both
directions by its odometry alone, and the errors of its returns tell how wrong it is, and why.

Units are SI throughout: m, rad and s, with headings counter-clockwise positive. Where a name
carries a unit (``sigma_m``), that is its unit. What the command does, this package does:

=================================  ===========================================================
``init``                           files to fill in, or a robot.toml proposed from logs
``load_dataset``, ``inspect``      read measurements, and look at them
``score``, ``calibrate``           E_max,sys and the rest; E_d, E_b and E_s
``calibrate_gears``                the same for drives other than the differential one
``compare``, ``diagnose``          what models explain, and what they are missing
``solve``                          the one answer: what to write into the robot
``changed``                        what changed of a robot between two tests
``conditions``                     which of its numbers depend on floor, load or day
``watch``                          whether a robot that is tested again and again changes
``apply``                          corrected odometry from counts and a model
``tracks``                         measured runs beside odometry and a model: residuals as arrays
``fit``, ``learn``                 fit a model; add what is missing until nothing is
``export``                         a model for ROS 2, Nav2, URDF, C, Gazebo or MuJoCo
``report``, ``plot``               everything on one page; one figure of it
``simulate``, ``monte_carlo``      one test, recorded; thousands of tests
``merge``                          shards and checkpoints of studies put together
``sensitivity``, ``sweep``         which parameter drives which metric; what its values do
``tolerance``                      the cheapest tolerances with which enough robots are good
``paper``                          the experiments of the paper, beside its numbers
``plan``, ``separate``             how many runs, and which experiment, before any is driven
``Robot``, ``Path``, ``Model``     what all of it is about; ``effects`` lists what there is
``survey``                         many robots: a row each, and how far they are apart
``each``, ``fleet``                one of these calls for many robots, in parallel
``umbmark.results``                the classes of the parts of results, for annotations
``umbmark.distributed``            studies on Dask, Ray, joblib or any other executor
=================================  ===========================================================
"""

import logging

from umbmark import results
from umbmark._apply import Corrected, CorrectedRuns, apply
from umbmark._arguments import Numbers, Seed
from umbmark._calibration import Calibration, GearCalibration, calibrate, calibrate_gears
from umbmark._changed import Changed, changed
from umbmark._comparison import Comparison, TrackComparison, compare
from umbmark._conditions import Conditions, conditions
from umbmark._diagnosis import Diagnosis, Fitted, Learnt, diagnose, fit, learn
from umbmark._documents import Correction, Effect, Setup
from umbmark._each import Each, each, fleet
from umbmark._errors import MissingDependencyError
from umbmark._export import Exported, export
from umbmark._formula import formula_of
from umbmark._inspection import Inspection, inspect
from umbmark._keys import (
    ActsOn,
    Drawn,
    Drive,
    EffectKeys,
    EffectName,
    PathKeys,
    RobotKeys,
    Shape,
)
from umbmark._monte_carlo import MonteCarlo, merge, monte_carlo
from umbmark._paper import Paper, paper
from umbmark._plan import Plan, Separation, plan, separate
from umbmark._report import Report, figures, plot, report
from umbmark._scores import Score, score
from umbmark._sensitivity import Sensitivity, sensitivity
from umbmark._solution import Solution, solve
from umbmark._survey import Survey, survey
from umbmark._sweep import Sweep, sweep
from umbmark._tolerance import Tolerance, tolerance
from umbmark._tracks import Track, Tracks, tracks
from umbmark._umbmark import (
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
from umbmark._unlisted import Unlisted
from umbmark._warnings import ConversionWarning, UmbmarkWarning
from umbmark._watch import Watched, watch

# Nothing is logged unless the program that uses this package asks for it.
logging.getLogger("umbmark").addHandler(logging.NullHandler())

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
