"""Measure, explain and correct the odometry error of wheeled robots.

UMBmark is the benchmark test of Borenstein and Feng (1995): a robot drives a square in both
directions by its odometry alone, and the errors of its returns tell how wrong it is, and why.

Units are SI throughout: m, rad and s, with headings counter-clockwise positive. Where a name
carries a unit (``sigma_m``), that is its unit. What the command does, this package does:

=================================  ===========================================================
``load_dataset``, ``inspect``      read measurements, and look at them
``score``, ``calibrate``           E_max,sys and the rest; E_d, E_b and E_s
``calibrate_gears``                the same for drives other than the differential one
``compare``, ``diagnose``          what models explain, and what they are missing
``fit``, ``learn``                 fit a model; add what is missing until nothing is
``simulate``, ``monte_carlo``      one test, recorded; thousands of tests
``sensitivity``, ``sweep``         which parameter drives which metric; what its values do
``tolerance``                      the cheapest tolerances with which enough robots are good
``plan``, ``separate``             how many runs, and which experiment, before any is driven
``Robot``, ``Path``, ``Model``     what all of it is about; ``effects`` lists what there is
``umbmark.distributed``            Monte Carlo and sensitivity past one machine, on Dask
=================================  ===========================================================
"""

from umbmark._calibration import (
    Calibration,
    Correction,
    GearCalibration,
    calibrate,
    calibrate_gears,
)
from umbmark._comparison import Comparison, TrackComparison, compare
from umbmark._diagnosis import Diagnosis, Fitted, Learnt, diagnose, fit, learn
from umbmark._effects import Effect, effects
from umbmark._formula import formula_of
from umbmark._inspection import Inspection, inspect
from umbmark._monte_carlo import MonteCarlo, monte_carlo
from umbmark._plan import Plan, Separation, plan, separate
from umbmark._scores import Score, score
from umbmark._sensitivity import Sensitivity, sensitivity
from umbmark._simulation import simulate
from umbmark._sweep import Sweep, sweep
from umbmark._tolerance import Tolerance, tolerance
from umbmark._umbmark import (
    Dataset,
    Ensemble,
    Model,
    Path,
    Robot,
    Run,
    Study,
    __version__,
    load_dataset,
    presets,
)

__all__ = [
    "Calibration",
    "Comparison",
    "Correction",
    "Dataset",
    "Diagnosis",
    "Effect",
    "Ensemble",
    "Fitted",
    "GearCalibration",
    "Inspection",
    "Learnt",
    "Model",
    "MonteCarlo",
    "Path",
    "Plan",
    "Robot",
    "Run",
    "Score",
    "Sensitivity",
    "Separation",
    "Study",
    "Sweep",
    "Tolerance",
    "TrackComparison",
    "__version__",
    "calibrate",
    "calibrate_gears",
    "compare",
    "diagnose",
    "effects",
    "fit",
    "formula_of",
    "inspect",
    "learn",
    "load_dataset",
    "monte_carlo",
    "plan",
    "presets",
    "score",
    "sensitivity",
    "separate",
    "simulate",
    "sweep",
    "tolerance",
]
