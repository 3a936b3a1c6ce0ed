from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from os import PathLike
from pathlib import Path as PathlibPath
from typing import Any, Self, SupportsIndex, TypeAlias, Unpack, final, overload

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from umbmark._arguments import Numbers, Seed
from umbmark._documents import Effect, Repeated, Suggestion, UnlistedLaw
from umbmark._keys import EffectKeys, EffectName, MotionKeys, PathKeys, RobotKeys, Shape

__all__ = [
    "DataError",
    "Dataset",
    "Ensemble",
    "Figure",
    "FitError",
    "Model",
    "ModelError",
    "Path",
    "Robot",
    "Run",
    "Server",
    "Sobol",
    "Study",
    "UmbmarkError",
    "__version__",
    "apply",
    "calibrate",
    "calibrate_gears",
    "changed",
    "compare",
    "conditions",
    "diagnose",
    "effects",
    "export",
    "figure",
    "fit",
    "formula_variables",
    "init",
    "inspect",
    "kinds",
    "learn",
    "load_dataset",
    "merge",
    "paper",
    "plan",
    "presets",
    "report",
    "score_arrays",
    "score_dataset",
    "sensitivity",
    "separate",
    "serve",
    "simulate",
    "solve",
    "survey",
    "sweep",
    "tolerance",
    "tracks",
    "watch",
    "write",
]

__version__: str

Place: TypeAlias = str | PathLike[str]
Floats: TypeAlias = NDArray[np.float64]

@final
class Robot:
    """A nominal robot: what its odometry believes of itself.

    Parameters
    ----------
    **keys
        The keys of ``[robot]`` in a robot.toml: ``wheelbase_m``, ``wheel_diameter_m`` (or
        ``wheel_diameter_left_m`` and ``wheel_diameter_right_m``, or ``wheel_radius_m``) in m,
        ``ticks_per_revolution``, and where they are known ``name``, ``drive``, ``encoder_rate_hz``
        in Hz and ``counter_bits``. A ``drive`` other than "differential", one of `Robot.drives()`,
        has lengths of its own.

    Raises
    ------
    ValueError
        If a key is missing, unknown or out of its range, in the words of the file's reader.

    Examples
    --------
    >>> import umbmark
    >>> robot = umbmark.Robot(wheelbase_m=0.34, wheel_diameter_m=0.15, ticks_per_revolution=2000)
    >>> robot.wheelbase_m
    0.34
    >>> umbmark.Robot(wheelbase_m=-0.34, wheel_diameter_m=0.15, ticks_per_revolution=2000)
    Traceback (most recent call last):
    ...
    ValueError: Robot: wheelbase_m must be between 0.001 and 100 m, got -0.34
    """
    def __new__(cls, **keys: Unpack[RobotKeys]) -> Self: ...
    @staticmethod
    def labmate() -> Robot:
        """The TRC LabMate of the paper: wheelbase 0.340 m; wheels of 0.150 m and 2000 ticks per
        revolution are assumed.
        """
    @staticmethod
    def drives() -> dict[str, str]:
        """Give the names of all drives, each with what it is."""
    @staticmethod
    def read(file: Place) -> Robot:
        """Read the robot of a robot.toml."""
    @staticmethod
    def from_toml(text: str) -> Robot:
        """Read the robot of the text of a robot.toml."""
    def to_toml(self) -> str:
        """Write it as the text of a robot.toml, which reads back to the last bit."""
    def to_dict(self) -> dict[str, Any]:
        """Give its keys and values, as results have them."""
    @property
    def name(self) -> str:
        """What people call it."""
    @property
    def wheelbase_m(self) -> float:
        """Nominal wheelbase b in m: the distance between the wheels' contact points."""
    @property
    def wheel_diameter_left_m(self) -> float:
        """Nominal diameter of the left wheel in m."""
    @property
    def wheel_diameter_right_m(self) -> float:
        """Nominal diameter of the right wheel in m."""
    @property
    def ticks_per_revolution(self) -> float:
        """Encoder ticks per wheel revolution, after gearing and quadrature."""
    @property
    def encoder_rate_hz(self) -> float | None:
        """How often the counters are read in Hz; None for every tick."""
    def __hash__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

class UmbmarkError(ValueError):
    """What cannot be done with what was given. Arguments that are out of range raise
    ``ValueError`` itself.
    """

class DataError(UmbmarkError):
    """A file that cannot be read, or measurements that do not hold what was asked of them."""

class ModelError(UmbmarkError):
    """A model with an effect, a parameter, a value or a formula that there is not."""

class FitError(UmbmarkError):
    """A model that cannot be fitted to these measurements."""

@final
class Path:
    """A path to be driven in either direction, from START along its heading.

    Parameters
    ----------
    shape : str, default "square"
        One of `Path.shapes()`.
    **keys
        The other keys of ``[path]`` in a robot.toml: the sizes of the shape (``side_m`` of a
        square, ``points_m`` of waypoints, shape (n, 2)) in m, and ``speed_m_s``,
        ``acceleration_m_s2`` and ``pause_s``.

    Raises
    ------
    ValueError
        If a key is missing, unknown or out of its range, in the words of the file's reader.

    Examples
    --------
    >>> import umbmark
    >>> umbmark.Path(side_m=4.0).length_m
    16.0
    """
    def __new__(cls, shape: Shape = "square", **keys: Unpack[PathKeys]) -> Self: ...
    @staticmethod
    def umbmark() -> Path:
        """The paper's 4 x 4 m square at 0.2 m/s."""
    @staticmethod
    def square(side_m: float, **keys: Unpack[MotionKeys]) -> Path:
        """A square with sides of this length in m; the other keys as of ``Path``."""
    @staticmethod
    def shapes() -> dict[str, str]:
        """Give the names of all shapes, each with what it is."""
    def to_dict(self) -> dict[str, Any]:
        """Give shape, sizes in m and length in m, as results have them."""
    @property
    def shape(self) -> str:
        """Name of its shape."""
    @property
    def length_m(self) -> float:
        """Length travelled by the centre of the axle in m."""
    def end(self, direction: str) -> tuple[float, float, float]:
        """Where a robot without errors ends, (x, y, heading) in m and rad, seen from START,
        driven "cw" or "ccw".
        """
    def __hash__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    @staticmethod
    def _from_toml(text: str) -> Path: ...

@final
class Model:
    """A nominal robot and the effects that make it err. Models are frozen: each change gives
    another one.

    Parameters
    ----------
    robot : Robot, optional
        The nominal robot; the paper's LabMate where none is given.

    Examples
    --------
    >>> import numpy as np
    >>> import umbmark
    >>> model = umbmark.Model().add("wheel_diameter_ratio", e_d=1.002)
    >>> model = model.add("wheelbase", e_b={"mean": 1.01, "sd": 0.002})  # drawn anew for each trial
    >>> model.get("wheelbase", "e_b")
    1.01
    >>> own = model.add(
    ...     "carpet",
    ...     acts_on="heading_per_metre",
    ...     formula=lambda at, k, h0: k * np.sin(at.heading - h0),
    ...     parameters={"k": 0.001, "h0": 0.5},
    ... )
    >>> print(own.to_toml().split("\n\n")[-1], end="")
    [[effect]]
    name = "carpet"
    acts_on = "heading_per_metre"
    formula = "k * sin(heading - h0)"
    parameters = { k = 0.001, h0 = 0.5 }
    """
    def __new__(cls, robot: Robot | None = None) -> Self: ...
    @staticmethod
    def from_toml(text: str, robot: Robot | None = None) -> Model:
        """Read the text of a model.toml, for a robot, or for the one it names, or the paper's
        LabMate.
        """
    @staticmethod
    def read(file: Place, robot: Robot | None = None) -> Model:
        """Read a model.toml, for a robot, or for the one it names, or the paper's LabMate.

        A file that names another robot than the given one is converted, with a
        ``ConversionWarning`` that says what changed.
        """
    def add(
        self,
        name: EffectName | str | Suggestion | Repeated | UnlistedLaw,
        **keys: Unpack[EffectKeys],
    ) -> Model:
        """Add an effect of the catalogue, or one of your own, or change one that is there.

        Parameters
        ----------
        name : str, or a law of a result
            Name of the effect; ``umbmark.effects()`` has the catalogue. Or a law that ``learn`` or
            ``diagnose`` found: the ``suggestion`` of ``unlisted``, ``repeats``, the ``law`` of a
            step, or one of its ``others``.
        **keys
            The keys of ``[[effect]]`` in a model.toml: the effect's parameters (a number, a word
            where it takes words, ``{"mean": .., "sd": ..}`` or ``{"min": .., "max": ..}`` for one
            that is drawn), and ``free=True`` for effects to be fitted. An effect of your own has
            ``acts_on``, ``formula`` (text, or a function of the quantities and the parameters,
            written with NumPy) and ``parameters`` (a dict of start values).

        Returns
        -------
        Model
            This one with the effect.

        Raises
        ------
        ValueError
            If the catalogue, a range or the language of formulas refuses it, in the words of the
            file's reader.
        TypeError
            If a function cannot be written as a formula.
        """
    def remove(self, name: str) -> Model:
        """Take an effect away."""
    def get(self, effect: str, parameter: str) -> float | None:
        """Value of a parameter of an effect, the middle of its distribution where it is drawn;
        None without the effect.
        """
    @property
    def noise(self) -> dict[str, float] | None:
        """Sizes of the noise that was fitted to tracks with it, under the keys of ``[noise]`` in
        a model.toml; None without.
        """
    @property
    def doubt(self) -> str | None:
        """What speaks against its values, in a sentence or more, as ``learn`` and ``solve``
        found it; None without.
        """
    @property
    def robot(self) -> Robot:
        """The nominal robot."""
    @property
    def effects(self) -> list[str]:
        """Names of the effects, in the order in which they act."""
    def to_toml(self) -> str:
        """Write it as the text of a model.toml with its robot, which reads back to the last bit."""
    def to_dict(self) -> dict[str, Any]:
        """Give its effects, as results have them."""
    def __hash__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class Run:
    """One drive round the path: what the encoders showed, where the robot really was, and how it
    returned. Frozen.

    Parameters
    ----------
    direction : str or None
        "cw" or "ccw"; None for paths that have no sense of driving.
    number : int
        Its number, unique within its direction and test.
    name : str, optional
        Its name.
    test : str, default "systematic"
        "systematic", or "bumps" for the extended test.
    returned : tuple of float, optional
        Return error (x, y) in m or (x, y, heading) in m and rad, absolute minus computed (Eq. 1),
        in the frame of START.
    time_s, ticks_left, ticks_right : array of numbers, shape (n,), optional
        Times of the samples in s, and the wheels' cumulative counts.
    reference_sample : array of whole numbers, shape (m,), optional
        For each absolute pose, the sample that it belongs to.
    reference_pose : array of numbers, shape (m, 3) or (m, 2), optional
        The absolute poses: x in m, y in m, heading in rad (NaN, or no third column, where it was
        not measured), in the frame of START. NaN for all x and y of a reference that tells headings
        only, such as a compass.
    relative : bool, default False
        Whether each pose tells only how the robot moved since the one before, as poses of visual
        odometry do, and headings that a gyro added up.

    An array is whatever has numbers: a sequence, a NumPy array of any real type, a column of
    pandas, polars or Arrow.

    Raises
    ------
    TypeError
        If an argument has no numbers.
    ValueError
        If arrays do not belong together, a number is not finite, or times do not increase.
    """
    def __new__(
        cls,
        direction: str | None,
        number: int,
        *,
        name: str | None = None,
        test: str = "systematic",
        returned: Sequence[float] | None = None,
        time_s: Numbers | None = None,
        ticks_left: Numbers | None = None,
        ticks_right: Numbers | None = None,
        reference_sample: Numbers | None = None,
        reference_pose: Numbers | None = None,
        relative: bool = False,
    ) -> Self: ...
    @property
    def name(self) -> str:
        """Its name."""
    @property
    def number(self) -> int:
        """Its number, unique within its direction and test."""
    @property
    def direction(self) -> str | None:
        """ "cw" or "ccw"; None for paths that have no sense of driving."""
    @property
    def test(self) -> str:
        """ "systematic", or "bumps" for the extended test."""
    @property
    def returned(self) -> tuple[float, float, float | None] | None:
        """Return error (x, y, heading) in m and rad, heading None where it was not measured;
        None without a return.
        """
    @property
    def time_s(self) -> Floats | None:
        """Times of the samples in s, shape (n,); None without ticks."""
    @property
    def ticks_left(self) -> Floats | None:
        """Cumulative counts of the left wheel, roll-overs undone, shape (n,); None without
        ticks.
        """
    @property
    def ticks_right(self) -> Floats | None:
        """Cumulative counts of the right wheel, roll-overs undone, shape (n,); None without
        ticks.
        """
    @property
    def reference_sample(self) -> NDArray[np.int64] | None:
        """For each absolute pose the sample that it belongs to, shape (m,); None without ticks."""
    @property
    def reference_pose(self) -> Floats | None:
        """The absolute poses x, y in m and heading in rad, NaN for what was not measured, shape
        (m, 3); None without ticks.
        """
    @property
    def relative(self) -> bool | None:
        """Whether each pose tells only how the robot moved since the one before; None without
        ticks.
        """
    def __hash__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    @staticmethod
    def _from_json(text: str) -> Run: ...

@final
class Dataset:
    """A robot and its runs, measured or simulated. Frozen; ``umbmark.load_dataset`` reads one.

    It is a sequence of its runs: ``len(data)``, ``data[0]``, ``data["cw_01"]``, ``for run in
    data``; a slice is the dataset of those runs. Datasets are equal if robot, path and runs are.

    Parameters
    ----------
    robot : Robot, optional
        The nominal robot; scores do without.
    path : Path, optional
        The path that it was told to drive.
    runs : sequence of Run
        Its runs; two of one direction and test have different numbers, and all have different
        names.

    Raises
    ------
    ValueError
        If two runs have the same number or name.

    Examples
    --------
    >>> import umbmark
    >>> runs = [umbmark.Run("cw", 1, returned=(-0.21, -0.19, -0.05))]
    >>> data = umbmark.Dataset(umbmark.Robot.labmate(), umbmark.Path.umbmark(), runs)
    >>> data.returns("cw")
    array([[-0.21, -0.19, -0.05]])
    """
    def __new__(
        cls, robot: Robot | None = None, path: Path | None = None, runs: Sequence[Run] = ...
    ) -> Self: ...
    @staticmethod
    def from_arrays(
        cw: Numbers | None = None,
        ccw: Numbers | None = None,
        *,
        robot: Robot | None = None,
        path: Path | None = None,
        bumps_cw: Numbers | None = None,
        bumps_ccw: Numbers | None = None,
    ) -> Dataset:
        """Make a dataset of return errors in arrays, one row a run.

        Parameters
        ----------
        cw, ccw : array of numbers, shape (n, 3) or (n, 2), optional
            Return errors of the clockwise and of the counter-clockwise runs: x in m, y in m,
            heading in rad, each absolute minus computed (Eq. 1), in the frame of START; NaN, or no
            third column, for a heading that was not measured.
        robot : Robot, optional
            The nominal robot; scores do without.
        path : Path, optional
            The path that it was told to drive.
        bumps_cw, bumps_ccw : array of numbers, shape (n, 3) or (n, 2), optional
            The same of the extended test, driven over bumps.

        Returns
        -------
        Dataset
            The runs of each array are numbered from 1.

        Raises
        ------
        TypeError, ValueError
            If an argument has no such numbers; it names the argument.

        Examples
        --------
        >>> import umbmark
        >>> cw, ccw = [[-0.21, -0.19, -0.05]], [[0.02, 0.01, 0.01], [0.01, -0.02, 0.02]]
        >>> robot, path = umbmark.Robot.labmate(), umbmark.Path.umbmark()
        >>> data = umbmark.Dataset.from_arrays(cw, ccw, robot=robot, path=path)
        >>> data
        Dataset(TRC LabMate, square of 16.000000 m: 1 cw + 2 ccw runs, 0 with ticks)
        """
    @staticmethod
    def from_frame(
        frame: Any,
        *,
        robot: Robot | None = None,
        path: Path | None = None,
        run: str | None = "run",
        t: str = "t_s",
        ticks: tuple[str, str] = ("ticks_left", "ticks_right"),
        pose: Sequence[str] | None = ("x_ref_m", "y_ref_m", "theta_ref_rad"),
    ) -> Dataset:
        """Make a dataset of logs in one frame, a row for each reading of the counters.

        Rows are read as those of ``runs/*.csv`` are: counters may roll over, poses may stand in a
        frame of their own, and START is found from them; ``warnings`` say what was mended.

        Parameters
        ----------
        frame : pandas, polars or Arrow table, xarray.Dataset, or dict of str to array
            The columns, also of anything that hands over a stream of Arrow.
        robot : Robot, optional
            The nominal robot.
        path : Path, optional
            The path that it was told to drive.
        run : str or None, default "run"
            The column that names the run of each row. A name such as "cw_01" or "ccw_03" tells
            direction and number; of other names, the direction follows from the counts. None where
            all rows are one run.
        t : str, default "t_s"
            The column of times in s, or of dates.
        ticks : tuple of str, default ("ticks_left", "ticks_right")
            The columns of the two counters.
        pose : tuple of str or None, default ("x_ref_m", "y_ref_m", "theta_ref_rad")
            The columns of the absolute poses: x in m, y in m and, where it was measured, heading in
            rad; NaN where there was no measurement. None where there are no poses.

        Returns
        -------
        Dataset

        Raises
        ------
        TypeError, ValueError
            If a column is missing or has no such numbers, or a file with these rows would be
            refused; it names the column.

        Examples
        --------
        >>> import umbmark
        >>> counts = [0, 100, 200]
        >>> frame = {"run": ["cw_01"] * 3, "t": [0, 1, 2], "left": counts, "right": counts}
        >>> umbmark.Dataset.from_frame(frame, t="t", ticks=("left", "right"), pose=None)
        Dataset(unknown robot, unknown path: 1 cw + 0 ccw runs, 1 with ticks)
        """
    @property
    def robot(self) -> Robot | None:
        """The nominal robot; None where a return sheet was given without one."""
    @property
    def path(self) -> Path | None:
        """The path that it was told to drive, where that is known."""
    @property
    def runs(self) -> tuple[Run, ...]:
        """The runs."""
    @property
    def warnings(self) -> tuple[str, ...]:
        """What the reader noticed and mended, one sentence each."""
    @property
    def conditions(self) -> dict[str, list[str | float | None]]:
        """What is stated of the conditions of its runs: each condition with its value of every
        run, a word or a number; None where it is not known.
        """
    def with_conditions(
        self, **conditions: str | float | Iterable[str | float | None] | None
    ) -> Dataset:
        """Give the same dataset with the conditions of its runs; what was stated before is kept
        unless it is given anew.

        Parameters
        ----------
        **conditions : str, number, or sequence of them
            Each condition by its name, which ends in the unit of a number: one value for all runs,
            or one for each run in the order of ``runs``; None or NaN where it is not known. Words
            are levels; numbers are amounts on which the robot may depend by a slope.

        Returns
        -------
        Dataset

        Raises
        ------
        TypeError, ValueError
            If a value is neither a word nor a finite number, or if there are not as many as runs;
            it names the condition.

        Examples
        --------
        >>> import umbmark
        >>> data = umbmark.Dataset.from_arrays([[0.1, 0.2, 0.0]] * 3, robot=umbmark.Robot.labmate())
        >>> data.with_conditions(floor=["tile", "tile", "carpet"], load_kg=2).conditions
        {'floor': ['tile', 'tile', 'carpet'], 'load_kg': [2.0, 2.0, 2.0]}
        """
    def __len__(self) -> int: ...
    @overload
    def __getitem__(self, key: SupportsIndex | str, /) -> Run: ...
    @overload
    def __getitem__(self, key: slice, /) -> Dataset: ...
    def __iter__(self) -> Iterator[Run]: ...
    def __hash__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...
    def returns(self, direction: str, test: str = "systematic") -> Floats:
        """Give the known return errors of a direction.

        Parameters
        ----------
        direction : str
            "cw" or "ccw".
        test : str, default "systematic"
            "systematic", or "bumps" for the extended test.

        Returns
        -------
        ndarray of float64, shape (n, 3)
            x in m, y in m and heading in rad, absolute minus computed (Eq. 1), in the frame of
            START; NaN for a heading that was not measured.
        """
    def save(self, place: Place, *, layout: str | None = None, replace: bool = False) -> list[str]:
        """Write it in a layout.

        Parameters
        ----------
        place : path-like
            Folder to write, or NAME.mcap for one run as a log of ROS 2.
        layout : str, optional
            "csv", "mcap", "optiodom", "tum" or "returns"; "csv" where nothing is said, and "mcap"
            for NAME.mcap.
        replace : bool, default False
            Whether files that exist are replaced.

        Returns
        -------
        list of str
            What the layout cannot hold, a sentence each.

        Raises
        ------
        ValueError
            If files are there already, or nothing can be written.
        """
    def plot(self, ax: Axes | None = None, *, tracks: bool = False) -> Axes:
        """Draw the return errors, cw and ccw, or the tracks.

        Parameters
        ----------
        ax : matplotlib axes, optional
            Where to draw; a new figure where none is given.
        tracks : bool, default False
            Whether to draw the measured tracks instead of the return errors.

        Returns
        -------
        matplotlib axes
        """
    def __reduce__(self) -> tuple[Any, ...]: ...
    @staticmethod
    def _from_parts(robot: Robot | None, path: Path | None, rest: bytes) -> Dataset: ...

@final
class Study:
    """A Monte Carlo study, described: whole UMBmark tests, each with its own random numbers.
    Frozen.

    Parameters
    ----------
    model : Model
        The robot and its effects; parameters with a distribution are drawn anew for each trial.
    path : Path, optional
        The path; the paper's 4 x 4 m square where none is given.
    n : int, default 1000
        Number of trials, each a whole test.
    runs : int or tuple of int, default 5
        Runs in each direction, or (cw, ccw).
    seed : int, numpy Generator, BitGenerator or SeedSequence, or None, default 1
        Seed of all random numbers: the same seed gives the same bits for any number of threads,
        shards and machines. None draws a fresh one; ``seed`` has it.
    odometry : str, default "robot"
        How the robot computes its pose: "robot" (at the encoder rate where there is one, else at
        every tick), "ticks", "tick_by_tick" (slow, the reference) or "continuous" (without
        quantisation).
    update : str, default "arc"
        How sampled odometry follows the counts: "arc", "midpoint" or "euler".
    phase : str, default "random"
        Where within a tick the wheels come to rest: "random" or "edge".

    Raises
    ------
    ValueError
        If the test cannot be driven, a number is out of range, or a word is unknown.
    """
    def __new__(
        cls,
        model: Model,
        path: Path | None = None,
        *,
        n: int = 1000,
        runs: int | tuple[int, int] | None = None,
        seed: Seed = 1,
        odometry: str = "robot",
        update: str = "arc",
        phase: str = "random",
    ) -> Self: ...
    @property
    def n(self) -> int:
        """Number of trials."""
    @property
    def seed(self) -> int:
        """Seed of all random numbers."""
    @property
    def model(self) -> Model:
        """The robot and its effects."""
    @property
    def path(self) -> Path:
        """The path."""
    @property
    def metrics(self) -> list[str]:
        """Names of the metrics of a trial."""
    def run(
        self,
        shard: tuple[int, int] = ...,
        *,
        known: Ensemble | None = None,
        checkpoint: Place | None = None,
        resume: bool = False,
        replace: bool = False,
        threads: int = 0,
        until_std_error_m: float | None = None,
        keep: bool = False,
        progress: Callable[[int], object] | None = None,
    ) -> tuple[Ensemble, dict[str, Floats] | None, float]:
        """Run a shard of the study, or what is left of it.

        Parameters
        ----------
        shard : tuple of int, default (0, 1)
            (index, count): the index-th, from 0, of so many shards of whole chunks of 256 trials.
        known : Ensemble, optional
            What is done already of the same study and shard.
        checkpoint : path-like, optional
            Write what is done to this file every two seconds and at the end, Ctrl-C included: the
            file of ``umbmark mc --checkpoint``, which ``umbmark.merge`` reads.
        resume : bool, default False
            Go on with the study of that file, where it is there.
        replace : bool, default False
            Begin anew where that file is there.
        threads : int, default 0
            Threads to use; 0 for all processors. No number depends on it.
        until_std_error_m : float, optional
            Stop as soon as the standard error of the mean E_max,sys is this small, in m.
        keep : bool, default False
            Whether to keep the metrics of every trial.
        progress : callable, optional
            Called with the number of trials done.

        Returns
        -------
        ensemble : Ensemble
            The statistics.
        trials : dict of str to ndarray of float64, shape (n,), or None
            The metrics of every trial, where they were to be kept.
        trials_per_s : float
            Speed.

        Raises
        ------
        ValueError
            If what is known, or the file, is of another study or shard; or the file exists and the
            caller did not say what to do.
        """
    def _document(
        self, ensemble: Ensemble, partial: bool, trials_per_s: float | None
    ) -> tuple[str, str]: ...
    def __getnewargs_ex__(self) -> tuple[tuple[Model, Path], dict[str, Any]]: ...

@final
class Ensemble:
    """The statistics of the trials that are done: of a study, of a shard, or of shards merged.
    Frozen.

    Sums and bins are integers, so ensembles merge in any order to the same bits, and what merges to
    a whole study equals it.
    """
    @property
    def trials(self) -> int:
        """Trials done."""
    @property
    def missing(self) -> list[tuple[int, int]]:
        """Ranges [first, end) of trials of the whole study that are not done."""
    @property
    def metrics(self) -> list[str]:
        """Names of its metrics."""
    def merge(self, *others: Ensemble) -> Ensemble:
        """Give this ensemble and others of the same study together.

        Raises
        ------
        ValueError
            If they belong to different studies, or have trials in common.
        """
    def mean(self, metric: str) -> float:
        """Mean of a metric in its unit; NaN without trials."""
    def std_dev(self, metric: str) -> float:
        """Standard deviation of a metric, n - 1; NaN with fewer than two trials."""
    def std_error(self, metric: str) -> float:
        """Standard error of the mean of a metric."""
    @overload
    def quantile(self, metric: str, shares: float) -> float: ...  # pyright: ignore[reportOverlappingOverload]
    @overload
    def quantile(self, metric: str, shares: Numbers) -> Floats: ...
    @overload
    def share_below(self, metric: str, values: float) -> float: ...  # pyright: ignore[reportOverlappingOverload]
    @overload
    def share_below(self, metric: str, values: Numbers) -> Floats: ...
    def __hash__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    @staticmethod
    def _unpacked(packed: bytes) -> Ensemble: ...

@final
class Figure:
    """A figure of a report: numbers, axes and three sentences, drawn as SVG, PNG, PDF or by Plotly.
    Frozen.

    ``umbmark.plot`` makes one. Notebooks show it as SVG.
    """
    @property
    def kind(self) -> str:
        """Its kind."""
    @property
    def title(self) -> str:
        """A few words."""
    @property
    def shows(self) -> str:
        """What it shows, in a sentence or two."""
    @property
    def good(self) -> str:
        """What would be good."""
    @property
    def says(self) -> str:
        """What this one says."""
    def table(self) -> list[dict[str, str]]:
        """Give the numbers behind it as words, one dict a row."""
    def to_svg(self, *, width_mm: float = 88.0) -> str:
        """Draw it as SVG, ``width_mm`` wide (88 mm: a column of a journal)."""
    def to_png(self, *, width_mm: float = 88.0, dpi: int = 300) -> bytes:
        """Draw it as PNG."""
    def to_pdf(self, *, width_mm: float = 88.0) -> bytes:
        """Draw it as PDF."""
    def to_plotly(self) -> dict[str, Any]:
        """Give it as ``plotly.graph_objects.Figure`` takes it: ``data`` and ``layout``."""
    def save(
        self, place: Place, *, width_mm: float = 88.0, dpi: int = 300, replace: bool = False
    ) -> None:
        """Write it as NAME.svg, NAME.png, NAME.pdf, or NAME.json for Plotly.

        Parameters
        ----------
        place : path-like
            The file.
        width_mm : float, default 88
            Width, from 40 to 400 mm.
        dpi : int, default 300
            Dots per inch of a PNG, from 30 to 1200.
        replace : bool, default False
            Whether a file that exists is replaced.

        Raises
        ------
        ValueError
            If the ending is none of these, a number is out of range, or the file is there already.
        """
    def _repr_svg_(self) -> str: ...
    __hash__: None  # type: ignore[assignment]
    def __eq__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    @staticmethod
    def _from_json(text: str) -> Figure: ...

def init(
    folder: Place = ...,
    *,
    logs: Place | None = None,
    urdf: Place | None = None,
    controller_yaml: Place | None = None,
    ticks: str | None = None,
    reference: str | None = None,
    replace: bool = False,
) -> tuple[PathlibPath, ...]:
    """Write a robot.toml and a returns.csv to fill in, or propose a robot.toml from logs.

    Parameters
    ----------
    folder : path-like, default "."
        Where to write; it is made where it is not there.
    logs : path-like, optional
        A log in CSV or MCAP, a bag of ROS 1 or 2, or a folder of these. A robot.toml is proposed
        from them, and they are put into ``runs``. What they do not show is left to fill in, in
        lines marked FILL IN.
    urdf : path-like, optional
        Take wheelbase and wheel diameters from this URDF; with ``logs``.
    controller_yaml : path-like, optional
        Take them from the parameters of this ROS 2 controller; with ``logs``.
    ticks, reference : str, optional
        Topics of MCAP files and bags, as of ``load_dataset``.
    replace : bool, default False
        Whether files that exist are replaced.

    Returns
    -------
    tuple of pathlib.Path
        The files that were written: two to fill in, or the proposed robot.toml.

    Raises
    ------
    ValueError
        If files are there already, if nothing can be written, or if no log shows how the wheels
        turned.
    """

def merge(files: Sequence[Place], output: Place | None, replace: bool) -> tuple[str, str, Ensemble]:
    """Shards or checkpoints of one study: the document of what they know together, its words,
    and the ensemble.
    """

def paper(
    names: Sequence[str],
    trials: int,
    seed: Seed,
    threads: int,
    progress: Callable[[int], object] | None,
) -> tuple[str, str]:
    """Experiments of the paper, as one document and in words; all of them where none is named."""

def kinds() -> dict[str, str]:
    """The kinds of figures, and what each shows."""

def figure(
    kind: str,
    asked: tuple[str, Dataset, tuple[str, Model] | None],
    how: tuple[tuple[float, int, int], bool, int],
    threads: int,
    progress: Callable[[int], object] | None,
) -> Figure:
    """One figure of a dataset and a model."""

def report(
    asked: Sequence[tuple[str, Dataset, tuple[str, Model] | None]],
    how: tuple[tuple[float, int, int], bool, int],
    call: str,
    places: Sequence[Place],
    threads: int,
    progress: Callable[[int], object] | None,
) -> tuple[str, str]:
    """The page of one study or of two side by side, and its document. `call` is how Python
    asked, `places` what it read.
    """

def write(place: Place, bytes: bytes, replace: bool) -> None:
    """Writes a file, whole or not at all."""

def load_dataset(
    place: Place | Sequence[Place], *, ticks: str | None = None, reference: str | None = None
) -> Dataset:
    """Read a dataset: a folder, an OptiOdom folder, or one file of either.

    Parameters
    ----------
    place : path-like or sequence of path-like
        A folder with robot.toml and returns.csv, and logs in runs; a folder of OptiOdom; a return
        sheet; a log in CSV or MCAP; a bag of ROS 1 (.bag) or ROS 2 (.db3, or its folder). Several
        of one robot are read as one; each is a session.
    ticks : str, optional
        Topic of the wheels in MCAP files and bags, where it is not found by type; ":LEFT,RIGHT"
        behind it names the joints, ":left,right" or ":right,left" the order in a list of counts.
    reference : str, optional
        Topic of the absolute poses in MCAP files and bags; ":FRAME" behind it picks one of several
        transforms, "none" reads no poses.

    Returns
    -------
    Dataset
        Its ``warnings`` say what the reader noticed and mended.

    Raises
    ------
    ValueError
        If a file is missing or wrong: file, line, key, value, allowed range, and what to do.
    """

def inspect(data: Dataset, place: str) -> tuple[str, str]:
    """What a dataset holds, whether it is any good, and what it can determine."""

def effects() -> dict[str, Effect]:
    """Give the catalogue of effects by their names, in the order in which they act.

    Returns
    -------
    dict of str to Effect

    Examples
    --------
    >>> import umbmark
    >>> umbmark.effects()["crab"].parameters[0].name
    'angle_rad'
    """

def formula_variables() -> list[str]:
    """The names of what formulas may depend on."""

def presets() -> dict[str, tuple[Model, Path]]:
    """Give the robots of the paper's Table I, ready to be driven, with their paths.

    Returns
    -------
    dict of str to tuple of Model and Path
        By their names in flags, in the order of the table. The wheel noise is set to give the
        published sigma.

    Examples
    --------
    >>> import umbmark
    >>> model, path = umbmark.presets()["trc-labmate-nocal"]
    >>> round(umbmark.monte_carlo(model, path, n=1).noise_free.e_max_sys_m, 4)
    0.3056
    """

def score_arrays(
    cw: Numbers,
    ccw: Numbers,
    bumps_cw: Numbers | None,
    bumps_ccw: Numbers | None,
    level: float,
    convention: str,
) -> tuple[str, str]:
    """The score of return errors in arrays, as a document and in words."""

def score_dataset(data: Dataset, level: float, convention: str) -> tuple[str, str]:
    """The score of a dataset, as a document and in words."""

def sensitivity(
    study: Study,
    parameters: str | Mapping[str, Any] | None,
    method: str,
    effort: int,
    second_order: bool,
    noise_free: bool,
    threads: int,
    progress: Callable[[int], object] | None,
) -> tuple[str, str]:
    """Sensitivities of a study to the parameters that its model draws, or that are given."""

@final
class Sobol:
    """Sobol indices in blocks that can be done anywhere."""
    def __new__(
        cls,
        study: Study,
        parameters: str | Mapping[str, Any] | None,
        base_points: int,
        second_order: bool,
        noise_free: bool,
    ) -> Self: ...
    @property
    def blocks(self) -> int:
        """How many blocks there are."""
    def sums(self, first: int, end: int) -> Floats:
        """What blocks first to end - 1 come to, as numbers."""
    def document(self, numbers: Floats) -> tuple[str, str]:
        """The document of all blocks, in their order, and its words."""

def sweep(
    study: Study,
    axes: Sequence[tuple[str, float, float, int]],
    checkpoint: tuple[Place, bool, bool] | None,
    threads: int,
    progress: Callable[[int], object] | None,
) -> tuple[str, str]:
    """A study on every point of a grid, as a document and in words; axes are (name, first, last,
    count), a checkpoint (file, resume, replace).
    """

def tolerance(
    study: Study,
    parameters: str | Mapping[str, Any],
    metric: str,
    target: tuple[float, float],
    robots: int,
    with_noise: bool,
    threads: int,
    progress: Callable[[int], object] | None,
) -> tuple[str, str, list[float]]:
    """How many robots keep a target, and the cheapest grades that make it enough: the document, its
    words, and the sizes of the robots as they are now, in order.
    """

def plan(
    whose: object,
    runs: int,
    see: Sequence[tuple[str, float]],
    power: float,
    numbers: Sequence[int],
    order: str,
    options: tuple[float, int, int],
    threads: int,
    progress: Callable[[int], object] | None,
) -> tuple[str, str, str, str]:
    """What a test would show: its document, its words, and the sheet to drive it by as Markdown
    and as HTML.
    """

def separate(
    pair: tuple[str, str],
    whose: object,
    runs: int,
    options: tuple[float, int, int],
    threads: int,
) -> tuple[str, str]:
    """Experiments that tell two effects apart, together with the data or a planned test."""

def calibrate_gears(
    data: Dataset, level: float, learn: bool, threads: int
) -> tuple[str, str, Model, Robot]:
    """A calibration of any drive by its first effects: the document, the text, the model, and
    the corrected robot.
    """

def calibrate(
    data: Dataset,
    level: float,
    heading_arm_m: float | None,
    radius_wheelbase: str,
    learn: bool,
    threads: int,
) -> tuple[str, str]:
    """A calibration by every method that the data allows, that of the learnt model only where it
    is asked for, as a document and in words.
    """

def export(
    model: Model,
    to: str,
    path: Path | None,
    controller: str | None,
    urdf: tuple[str, list[str] | None] | None,
    usual: list[float],
    start: tuple[float, float, float],
    force: bool,
) -> tuple[str, list[str]]:
    """A model as text for a target, and what the text does not hold."""

def compare(
    data: Dataset,
    models: Sequence[tuple[str, Model]],
    options: tuple[float, int, int],
    return_poses: bool,
    threads: int,
) -> tuple[str, str]:
    """Models beside measurements; without any, the nominal robot, and the first model fitted to
    the data.
    """

def diagnose(
    data: Dataset,
    model: Model | None,
    options: tuple[float, int, int],
    return_poses: bool,
    threads: int,
) -> tuple[str, str, Model]:
    """What a model is missing, and the model with its free parameters fitted."""

def fit(
    data: Dataset,
    model: Model | None,
    add: Sequence[str],
    fix: Sequence[tuple[str, float | None]],
    knowledge: tuple[
        Sequence[tuple[str, tuple[float, float]]], Sequence[tuple[str, tuple[float, float]]]
    ],
    level: float,
) -> tuple[str, str, Model]:
    """A model with its free effects fitted, those of `add` too, but for the parameters of `fix`, at
    their values or others; within bounds, and with earlier measurements.
    """

def learn(
    data: Dataset,
    start: Model | None,
    options: tuple[float, int, int],
    return_poses: bool,
    threads: int,
    progress: Callable[[int], object] | None,
) -> tuple[str, str, Model]:
    """The whole loop, from a model where one is given, and the model that was learnt."""

def solve(
    data: Dataset,
    options: tuple[float, int, int],
    return_poses: bool,
    threads: int,
    progress: Callable[[int], object] | None,
) -> tuple[str, str, Model]:
    """The one answer, and the model that it rests on."""

def changed(
    before: Dataset,
    after: Dataset,
    start: Model | None,
    options: tuple[float, int, int],
    return_poses: bool,
    threads: int,
    progress: Callable[[int], object] | None,
) -> tuple[str, str]:
    """What changed of a robot between two tests."""

def conditions(
    data: Dataset,
    start: Model | None,
    size: float,
    return_poses: bool,
    threads: int,
    progress: Callable[[int], object] | None,
) -> tuple[str, str]:
    """Which numbers of a robot depend on the conditions of its runs."""

def survey(
    robots: Sequence[tuple[str, Dataset]],
    diagnosis: bool,
    options: tuple[float, int, int],
    return_poses: bool,
    threads: int,
    progress: Callable[[int], object] | None,
) -> tuple[str, str]:
    """Many robots of one kind: a row each, and how far they are apart."""

def watch(
    data: Dataset,
    state: str | None,
    false_alarms: float | None,
    runs_per_month: int | None,
    restart: str | None,
    seed: int,
    threads: int,
) -> tuple[str, str]:
    """Whether a robot that is tested again and again changes."""

@final
class Server:
    """A server that answers on a thread of its own until it is closed."""
    @property
    def address(self) -> str:
        """The address of its page."""
    def is_open(self) -> bool:
        """Whether it still answers."""
    def close(self) -> None:
        """Ends it; a server that is closed stays closed."""

def serve(
    place: str | None,
    drops: str,
    port: int,
    tests: tuple[float, int, int],
    threads: int,
) -> Server:
    """Opens the dataset at a place, and serves it."""

def apply(
    data: Dataset, model: Model, start: tuple[float, float, float]
) -> list[tuple[str, Floats, Floats, Floats | None]]:
    """The corrected odometry of each run that has a log."""

def tracks(
    data: Dataset, model: Model
) -> list[tuple[str, str | None, Floats, list[Floats], Floats | None]]:
    """The tracks of a dataset beside a model."""

def simulate(
    model: Model,
    path: Path | None = None,
    *,
    runs: int | tuple[int, int] | None = None,
    reference_rate_hz: float = 20.0,
    seed: Seed = 1,
    trial: int = 0,
) -> Dataset:
    """Simulate one test and record it as a dataset.

    Parameters
    ----------
    model : Model
        The robot and its effects; parameters with a distribution are drawn once.
    path : Path, optional
        The path; the paper's 4 x 4 m square where none is given.
    runs : int or tuple of int, default 5
        Runs in each direction, or (cw, ccw).
    reference_rate_hz : float, default 20
        How often the absolute pose is measured on the way, in Hz; 0 for the end pose alone.
    seed : int, numpy Generator, BitGenerator or SeedSequence, or None, default 1
        Seed of all random numbers; None draws a fresh one.
    trial : int, default 0
        Which trial of this seed: each has random numbers of its own.

    Returns
    -------
    Dataset
        Ticks at the robot's encoder rate, or at 100 Hz, absolute poses and return errors; with
        bumps placed, the extended test too.

    Raises
    ------
    ValueError
        If the test cannot be driven.

    Examples
    --------
    >>> import umbmark
    >>> data = umbmark.simulate(umbmark.Model().add("wheelbase", e_b=1.01), runs=1)
    >>> data.runs[0].name, data.returns("ccw").shape
    ('cw_01', (1, 3))
    """
