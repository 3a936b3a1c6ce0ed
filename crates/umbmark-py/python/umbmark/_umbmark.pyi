from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from pathlib import Path as PathlibPath
from typing import Any, Self, TypeAlias, final

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike, NDArray

from umbmark._documents import Effect

__all__ = [
    "Dataset",
    "Ensemble",
    "Figure",
    "Model",
    "Path",
    "Robot",
    "Run",
    "Sobol",
    "Study",
    "__version__",
    "apply",
    "calibrate",
    "calibrate_gears",
    "compare",
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
    "sweep",
    "tolerance",
    "write",
]

__version__: str

Place: TypeAlias = str | PathLike[str]
# A number, a word, a distribution, a formula.
Key: TypeAlias = (
    float | str | bool | Mapping[str, float] | Callable[..., Any] | Sequence[Sequence[float]] | None
)
Floats: TypeAlias = NDArray[np.float64]

@final
class Robot:
    def __new__(cls, **keys: float | str | None) -> Self: ...
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
    __hash__: None  # type: ignore[assignment]
    def __eq__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class Path:
    def __new__(cls, shape: str = "square", **keys: float | ArrayLike | None) -> Self: ...
    @staticmethod
    def umbmark() -> Path: ...
    @staticmethod
    def shapes() -> dict[str, str]: ...
    def to_dict(self) -> dict[str, Any]: ...
    @property
    def shape(self) -> str: ...
    @property
    def length_m(self) -> float: ...
    def end(self, direction: str) -> tuple[float, float, float]: ...
    __hash__: None  # type: ignore[assignment]
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
    def add(self, name: str, **keys: Key) -> Model: ...
    def remove(self, name: str) -> Model: ...
    def get(self, effect: str, parameter: str) -> float | None: ...
    @property
    def noise(self) -> dict[str, float] | None: ...
    @property
    def robot(self) -> Robot: ...
    @property
    def effects(self) -> list[str]: ...
    def to_toml(self) -> str: ...
    def to_dict(self) -> dict[str, Any]: ...
    __hash__: None  # type: ignore[assignment]
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
        time_s: Floats | None = None,
        ticks_left: Floats | None = None,
        ticks_right: Floats | None = None,
        reference_sample: NDArray[np.int64] | None = None,
        reference_pose: Floats | None = None,
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
    def __reduce__(self) -> tuple[Any, ...]: ...
    @staticmethod
    def _from_json(text: str) -> Run: ...

@final
class Dataset:
    def __new__(
        cls, robot: Robot | None = None, path: Path | None = None, runs: Sequence[Run] = ...
    ) -> Self: ...
    @property
    def robot(self) -> Robot | None: ...
    @property
    def path(self) -> Path | None: ...
    @property
    def runs(self) -> tuple[Run, ...]: ...
    @property
    def warnings(self) -> tuple[str, ...]: ...
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
        seed: int = 1,
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
    def _document(self, ensemble: Ensemble, partial: bool, trials_per_s: float | None) -> str: ...
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
    def quantile(self, metric: str, shares: Floats) -> Floats: ...
    def share_below(self, metric: str, values: Floats) -> Floats: ...
    __hash__: None  # type: ignore[assignment]
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
def merge(files: Sequence[Place], output: Place | None, replace: bool) -> tuple[str, Ensemble]: ...
def paper(
    names: Sequence[str],
    trials: int,
    seed: int,
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
    place: Place, *, ticks: str | None = None, reference: str | None = None
) -> Dataset: ...
def inspect(data: Dataset, place: str) -> str: ...
def effects() -> dict[str, Effect]: ...
def formula_variables() -> list[str]: ...
def presets() -> dict[str, tuple[Model, Path]]: ...
def score_arrays(
    cw: Floats,
    ccw: Floats,
    bumps_cw: Floats | None,
    bumps_ccw: Floats | None,
    level: float,
    convention: str,
) -> str: ...
def score_dataset(data: Dataset, level: float, convention: str) -> str: ...
def sensitivity(
    study: Study,
    parameters: str | Mapping[str, Any] | None,
    method: str,
    effort: int,
    second_order: bool,
    noise_free: bool,
    threads: int,
    progress: Callable[[int], object] | None,
) -> str: ...

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
    def document(self, numbers: Floats) -> str: ...

def sweep(
    study: Study,
    axes: Sequence[tuple[str, float, float, int]],
    checkpoint: tuple[Place, bool, bool] | None,
    threads: int,
    progress: Callable[[int], object] | None,
) -> str: ...
def tolerance(
    study: Study,
    parameters: str | Mapping[str, Any],
    metric: str,
    target: tuple[float, float],
    robots: int,
    with_noise: bool,
    threads: int,
    progress: Callable[[int], object] | None,
) -> tuple[str, list[float]]: ...
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
) -> tuple[str, str, str]: ...
def separate(
    pair: tuple[str, str],
    whose: object,
    runs: int,
    options: tuple[float, int, int],
    threads: int,
) -> str: ...
def calibrate_gears(data: Dataset, level: float) -> tuple[str, Model, Robot]: ...
def calibrate(
    data: Dataset, level: float, heading_arm_m: float | None, radius_wheelbase: str
) -> str: ...
def export(
    model: Model,
    to: str,
    path: Path | None,
    controller: str | None,
    urdf: tuple[str, list[str] | None] | None,
    usual: list[float],
    start: tuple[float, float, float],
) -> tuple[str, list[str]]: ...
def compare(
    data: Dataset,
    models: Sequence[tuple[str, Model]],
    options: tuple[float, int, int],
    return_poses: bool,
    threads: int,
) -> str: ...
def diagnose(
    data: Dataset,
    model: Model | None,
    options: tuple[float, int, int],
    return_poses: bool,
    threads: int,
) -> tuple[str, Model]: ...
def fit(
    data: Dataset, model: Model | None, add: Sequence[str], level: float
) -> tuple[str, Model]: ...
def learn(
    data: Dataset,
    start: Model | None,
    options: tuple[float, int, int],
    return_poses: bool,
    threads: int,
    progress: Callable[[int], object] | None,
) -> tuple[str, Model]: ...
def solve(
    data: Dataset,
    options: tuple[float, int, int],
    return_poses: bool,
    threads: int,
    progress: Callable[[int], object] | None,
) -> tuple[str, Model]: ...
def apply(
    data: Dataset, model: Model, start: tuple[float, float, float]
) -> list[tuple[str, Floats, Floats, Floats | None]]: ...
def simulate(
    model: Model,
    path: Path | None = None,
    *,
    runs: int | tuple[int, int] | None = None,
    reference_rate_hz: float = 20.0,
    seed: int = 1,
    trial: int = 0,
) -> Dataset: ...
