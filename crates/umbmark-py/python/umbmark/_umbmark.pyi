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
    def __new__(cls, **keys: Unpack[RobotKeys]) -> Self: ...
    @staticmethod
    def labmate() -> Robot: ...
    @staticmethod
    def drives() -> dict[str, str]: ...
    @staticmethod
    def read(file: Place) -> Robot: ...
    @staticmethod
    def from_toml(text: str) -> Robot: ...
    def to_toml(self) -> str: ...
    def to_dict(self) -> dict[str, Any]: ...
    @property
    def name(self) -> str: ...
    @property
    def wheelbase_m(self) -> float: ...
    @property
    def wheel_diameter_left_m(self) -> float: ...
    @property
    def wheel_diameter_right_m(self) -> float: ...
    @property
    def ticks_per_revolution(self) -> float: ...
    @property
    def encoder_rate_hz(self) -> float | None: ...
    def __hash__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

class UmbmarkError(ValueError): ...
class DataError(UmbmarkError): ...
class ModelError(UmbmarkError): ...
class FitError(UmbmarkError): ...

@final
class Path:
    def __new__(cls, shape: Shape = "square", **keys: Unpack[PathKeys]) -> Self: ...
    @staticmethod
    def umbmark() -> Path: ...
    @staticmethod
    def square(side_m: float, **keys: Unpack[MotionKeys]) -> Path: ...
    @staticmethod
    def shapes() -> dict[str, str]: ...
    def to_dict(self) -> dict[str, Any]: ...
    @property
    def shape(self) -> str: ...
    @property
    def length_m(self) -> float: ...
    def end(self, direction: str) -> tuple[float, float, float]: ...
    def __hash__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    @staticmethod
    def _from_toml(text: str) -> Path: ...

@final
class Model:
    def __new__(cls, robot: Robot | None = None) -> Self: ...
    @staticmethod
    def from_toml(text: str, robot: Robot | None = None) -> Model: ...
    @staticmethod
    def read(file: Place, robot: Robot | None = None) -> Model: ...
    def add(
        self,
        name: EffectName | str | Suggestion | Repeated | UnlistedLaw,
        **keys: Unpack[EffectKeys],
    ) -> Model: ...
    def remove(self, name: str) -> Model: ...
    def get(self, effect: str, parameter: str) -> float | None: ...
    @property
    def noise(self) -> dict[str, float] | None: ...
    @property
    def doubt(self) -> str | None: ...
    @property
    def robot(self) -> Robot: ...
    @property
    def effects(self) -> list[str]: ...
    def to_toml(self) -> str: ...
    def to_dict(self) -> dict[str, Any]: ...
    def __hash__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class Run:
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
    def name(self) -> str: ...
    @property
    def number(self) -> int: ...
    @property
    def direction(self) -> str | None: ...
    @property
    def test(self) -> str: ...
    @property
    def returned(self) -> tuple[float, float, float | None] | None: ...
    @property
    def time_s(self) -> Floats | None: ...
    @property
    def ticks_left(self) -> Floats | None: ...
    @property
    def ticks_right(self) -> Floats | None: ...
    @property
    def reference_sample(self) -> NDArray[np.int64] | None: ...
    @property
    def reference_pose(self) -> Floats | None: ...
    @property
    def relative(self) -> bool | None: ...
    def __hash__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    @staticmethod
    def _from_json(text: str) -> Run: ...

@final
class Dataset:
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
    ) -> Dataset: ...
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
    ) -> Dataset: ...
    @property
    def robot(self) -> Robot | None: ...
    @property
    def path(self) -> Path | None: ...
    @property
    def runs(self) -> tuple[Run, ...]: ...
    @property
    def warnings(self) -> tuple[str, ...]: ...
    @property
    def conditions(self) -> dict[str, list[str | float | None]]: ...
    def with_conditions(
        self, **conditions: str | float | Iterable[str | float | None] | None
    ) -> Dataset: ...
    def __len__(self) -> int: ...
    @overload
    def __getitem__(self, key: SupportsIndex | str, /) -> Run: ...
    @overload
    def __getitem__(self, key: slice, /) -> Dataset: ...
    def __iter__(self) -> Iterator[Run]: ...
    def __hash__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...
    def returns(self, direction: str, test: str = "systematic") -> Floats: ...
    def save(
        self, place: Place, *, layout: str | None = None, replace: bool = False
    ) -> list[str]: ...
    def plot(self, ax: Axes | None = None, *, tracks: bool = False) -> Axes: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    @staticmethod
    def _from_parts(robot: Robot | None, path: Path | None, rest: bytes) -> Dataset: ...

@final
class Study:
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
    def n(self) -> int: ...
    @property
    def seed(self) -> int: ...
    @property
    def model(self) -> Model: ...
    @property
    def path(self) -> Path: ...
    @property
    def metrics(self) -> list[str]: ...
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
    ) -> tuple[Ensemble, dict[str, Floats] | None, float]: ...
    def _document(
        self, ensemble: Ensemble, partial: bool, trials_per_s: float | None
    ) -> tuple[str, str]: ...
    def __getnewargs_ex__(self) -> tuple[tuple[Model, Path], dict[str, Any]]: ...

@final
class Ensemble:
    @property
    def trials(self) -> int: ...
    @property
    def missing(self) -> list[tuple[int, int]]: ...
    @property
    def metrics(self) -> list[str]: ...
    def merge(self, *others: Ensemble) -> Ensemble: ...
    def mean(self, metric: str) -> float: ...
    def std_dev(self, metric: str) -> float: ...
    def std_error(self, metric: str) -> float: ...
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
    @property
    def kind(self) -> str: ...
    @property
    def title(self) -> str: ...
    @property
    def shows(self) -> str: ...
    @property
    def good(self) -> str: ...
    @property
    def says(self) -> str: ...
    def table(self) -> list[dict[str, str]]: ...
    def to_svg(self, *, width_mm: float = 88.0) -> str: ...
    def to_png(self, *, width_mm: float = 88.0, dpi: int = 300) -> bytes: ...
    def to_pdf(self, *, width_mm: float = 88.0) -> bytes: ...
    def to_plotly(self) -> dict[str, Any]: ...
    def save(
        self, place: Place, *, width_mm: float = 88.0, dpi: int = 300, replace: bool = False
    ) -> None: ...
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
) -> tuple[PathlibPath, ...]: ...
def merge(
    files: Sequence[Place], output: Place | None, replace: bool
) -> tuple[str, str, Ensemble]: ...
def paper(
    names: Sequence[str],
    trials: int,
    seed: Seed,
    threads: int,
    progress: Callable[[int], object] | None,
) -> str: ...
def kinds() -> dict[str, str]: ...
def figure(
    kind: str,
    asked: tuple[str, Dataset, tuple[str, Model] | None],
    how: tuple[tuple[float, int, int], bool, int],
    threads: int,
    progress: Callable[[int], object] | None,
) -> Figure: ...
def report(
    asked: Sequence[tuple[str, Dataset, tuple[str, Model] | None]],
    how: tuple[tuple[float, int, int], bool, int],
    call: str,
    places: Sequence[Place],
    threads: int,
    progress: Callable[[int], object] | None,
) -> tuple[str, str]: ...
def write(place: Place, bytes: bytes, replace: bool) -> None: ...
def load_dataset(
    place: Place | Sequence[Place], *, ticks: str | None = None, reference: str | None = None
) -> Dataset: ...
def inspect(data: Dataset, place: str) -> tuple[str, str]: ...
def effects() -> dict[str, Effect]: ...
def formula_variables() -> list[str]: ...
def presets() -> dict[str, tuple[Model, Path]]: ...
def score_arrays(
    cw: Numbers,
    ccw: Numbers,
    bumps_cw: Numbers | None,
    bumps_ccw: Numbers | None,
    level: float,
    convention: str,
) -> tuple[str, str]: ...
def score_dataset(data: Dataset, level: float, convention: str) -> tuple[str, str]: ...
def sensitivity(
    study: Study,
    parameters: str | Mapping[str, Any] | None,
    method: str,
    effort: int,
    second_order: bool,
    noise_free: bool,
    threads: int,
    progress: Callable[[int], object] | None,
) -> tuple[str, str]: ...

@final
class Sobol:
    def __new__(
        cls,
        study: Study,
        parameters: str | Mapping[str, Any] | None,
        base_points: int,
        second_order: bool,
        noise_free: bool,
    ) -> Self: ...
    @property
    def blocks(self) -> int: ...
    def sums(self, first: int, end: int) -> Floats: ...
    def document(self, numbers: Floats) -> tuple[str, str]: ...

def sweep(
    study: Study,
    axes: Sequence[tuple[str, float, float, int]],
    checkpoint: tuple[Place, bool, bool] | None,
    threads: int,
    progress: Callable[[int], object] | None,
) -> tuple[str, str]: ...
def tolerance(
    study: Study,
    parameters: str | Mapping[str, Any],
    metric: str,
    target: tuple[float, float],
    robots: int,
    with_noise: bool,
    threads: int,
    progress: Callable[[int], object] | None,
) -> tuple[str, str, list[float]]: ...
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
) -> tuple[str, str, str, str]: ...
def separate(
    pair: tuple[str, str],
    whose: object,
    runs: int,
    options: tuple[float, int, int],
    threads: int,
) -> tuple[str, str]: ...
def calibrate_gears(data: Dataset, level: float) -> tuple[str, Model, Robot]: ...
def calibrate(
    data: Dataset,
    level: float,
    heading_arm_m: float | None,
    radius_wheelbase: str,
    learn: bool,
    threads: int,
) -> tuple[str, str]: ...
def export(
    model: Model,
    to: str,
    path: Path | None,
    controller: str | None,
    urdf: tuple[str, list[str] | None] | None,
    usual: list[float],
    start: tuple[float, float, float],
    force: bool,
) -> tuple[str, list[str]]: ...
def compare(
    data: Dataset,
    models: Sequence[tuple[str, Model]],
    options: tuple[float, int, int],
    return_poses: bool,
    threads: int,
) -> tuple[str, str]: ...
def diagnose(
    data: Dataset,
    model: Model | None,
    options: tuple[float, int, int],
    return_poses: bool,
    threads: int,
) -> tuple[str, str, Model]: ...
def fit(
    data: Dataset,
    model: Model | None,
    add: Sequence[str],
    fix: Sequence[tuple[str, float | None]],
    level: float,
) -> tuple[str, str, Model]: ...
def learn(
    data: Dataset,
    start: Model | None,
    options: tuple[float, int, int],
    return_poses: bool,
    threads: int,
    progress: Callable[[int], object] | None,
) -> tuple[str, str, Model]: ...
def solve(
    data: Dataset,
    options: tuple[float, int, int],
    return_poses: bool,
    threads: int,
    progress: Callable[[int], object] | None,
) -> tuple[str, str, Model]: ...
def changed(
    before: Dataset,
    after: Dataset,
    start: Model | None,
    options: tuple[float, int, int],
    return_poses: bool,
    threads: int,
    progress: Callable[[int], object] | None,
) -> tuple[str, str]: ...
def conditions(
    data: Dataset,
    start: Model | None,
    size: float,
    return_poses: bool,
    threads: int,
    progress: Callable[[int], object] | None,
) -> tuple[str, str]: ...
def survey(
    robots: Sequence[tuple[str, Dataset]],
    diagnosis: bool,
    options: tuple[float, int, int],
    return_poses: bool,
    threads: int,
    progress: Callable[[int], object] | None,
) -> tuple[str, str]: ...
def watch(
    data: Dataset,
    state: str | None,
    false_alarms: float | None,
    runs_per_month: int | None,
    restart: str | None,
    seed: int,
    threads: int,
) -> tuple[str, str]: ...
def apply(
    data: Dataset, model: Model, start: tuple[float, float, float]
) -> list[tuple[str, Floats, Floats, Floats | None]]: ...
def tracks(
    data: Dataset, model: Model
) -> list[tuple[str, str | None, Floats, list[Floats], Floats | None]]: ...
def simulate(
    model: Model,
    path: Path | None = None,
    *,
    runs: int | tuple[int, int] | None = None,
    reference_rate_hz: float = 20.0,
    seed: Seed = 1,
    trial: int = 0,
) -> Dataset: ...
