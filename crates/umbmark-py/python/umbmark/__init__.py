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

import lazy_loader

# What the package has stands in its stub.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

# Nothing is logged unless the program that uses this package asks for it.
logging.getLogger("umbmark").addHandler(logging.NullHandler())
