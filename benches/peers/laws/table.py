"""The tables, in Markdown."""

from collections.abc import Iterator
from statistics import median, quantiles
from typing import Any, TypeAlias

Json: TypeAlias = dict[str, Any]

METHODS = ("E_d, E_b, E_s", "Gaussian process", "sparse regression", "symbolic regression")
OURS = "umbmark"
BOTH = (*METHODS, OURS)
WORSE = 1.02
"""An error that is larger by this factor is worse."""


def row(*cells: str) -> str:
    """A row."""
    return "| " + " | ".join(cells) + " |"


def table(results: list[Json]) -> str:
    """All tables of some results."""
    laws = [one for one in results if one.get("law")]
    nulls = [one for one in results if "law" in one and not one["law"]]
    others = [one for one in results if "law" not in one]
    parts = []
    if laws:
        parts += [*with_law(laws), "", *each_set(laws), ""]
    if nulls:
        parts += [*without_law(nulls), ""]
    if others:
        parts += [*elsewhere(others), ""]
    return "\n".join(parts)


def ratios(results: list[Json], method: str, over: str) -> list[float]:
    """Errors over those of another method."""
    return [one["error_m"][method] / one["error_m"][over] for one in results]


def spread(values: list[float]) -> str:
    """Median and quartiles."""
    if len(values) < 2:
        return f"{values[0]:.2f}"
    low, _, high = quantiles(values, n=4, method="inclusive")
    return f"{median(values):.2f} ({low:.2f} to {high:.2f})"


def seconds(results: list[Json], method: str) -> str:
    """The median time."""
    times = [one["seconds"][method] for one in results if method in one["seconds"]]
    return f"{median(times):.1f}" if times else ""


def counted(these: list[bool]) -> str:
    """How many of them hold."""
    return f"{sum(these)} of {len(these)}"


def with_law(results: list[Json]) -> Iterator[str]:
    """Sets with a hidden law."""
    yield row("hidden law", "error / error of the truth", "variable found", "nearest", "median s")
    yield "|---" * 5 + "|"
    for method in BOTH:
        nearest = counted([best_of(one) == method for one in results])
        has_law = method in results[0]["found"]
        found = counted([one["found"][method] for one in results]) if has_law else ""
        over_truth = spread(ratios(results, method, "truth"))
        yield row(method, over_truth, found, nearest, seconds(results, method))


def best_of(result: Json) -> str:
    """The method with the least error."""
    return min(BOTH, key=lambda method: result["error_m"][method])


def each_set(results: list[Json]) -> Iterator[str]:
    """Error of each set; * where the variable was found."""
    yield row("seed", "law", "truth [mm]", *BOTH)
    yield "|---" * (3 + len(BOTH)) + "|"
    for one in results:
        errors, found = one["error_m"], one["found"]
        cells = [
            f"{1e3 * errors[method]:.1f}" + ("*" if found.get(method) else "") for method in BOTH
        ]
        seed = one["set"].rpartition("-")[2]
        yield row(seed, one["law"], f"{1e3 * errors['truth']:.1f}", *cells)


def without_law(results: list[Json]) -> Iterator[str]:
    """Sets where nothing is hidden."""
    head = ["nothing hidden", "error / error of the truth", "something added", "terms"]
    yield row(*head, "worse by 2 %", "median s")
    yield "|---" * 6 + "|"
    for method in BOTH:
        over_truth = spread(ratios(results, method, "truth"))
        cells = [method, over_truth, "", "", ""]
        if method != METHODS[0]:
            terms = [one["terms"][method] for one in results]
            worse = [ratio > WORSE for ratio in ratios(results, method, METHODS[0])]
            cells[2:] = [counted(list(map(bool, terms))), str(sum(map(len, terms)))]
            cells.append(counted(worse))
        yield row(*cells, seconds(results, method))


def elsewhere(results: list[Json]) -> Iterator[str]:
    """Errors [mm] where there is no truth."""
    yield row("learnt on squares, judged on", *BOTH)
    yield "|---" * (1 + len(BOTH)) + "|"
    for one in results:
        yield row(one["set"], *(f"{1e3 * one['error_m'][method]:.1f}" for method in BOTH))
    yield row("median s", *(seconds(results, method) for method in BOTH))
