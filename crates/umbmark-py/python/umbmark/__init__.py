"""Measure, explain and correct the odometry error of wheeled robots.

UMBmark is the benchmark test of Borenstein and Feng (1995): a robot drives a square in both
directions by its odometry alone, and the errors of its returns tell how wrong it is, and why.

Units are SI throughout: m, rad and s, with headings counter-clockwise positive. Where a name
carries a unit (``sigma_m``), that is its unit.
"""

from umbmark._umbmark import Score, __version__, score

__all__ = ["Score", "__version__", "score"]
