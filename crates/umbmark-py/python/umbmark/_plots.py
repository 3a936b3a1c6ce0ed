"""Figures of results, with matplotlib: each on new axes, or on those that are given."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from umbmark._errors import needs

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from umbmark._calibration import Calibration, GearCalibration
    from umbmark._changed import Changed
    from umbmark._comparison import Comparison, TrackComparison
    from umbmark._conditions import Conditions
    from umbmark._diagnosis import Diagnosis, Fitted, Learnt
    from umbmark._documents import Estimate
    from umbmark._inspection import Inspection
    from umbmark._monte_carlo import MonteCarlo
    from umbmark._paper import Paper
    from umbmark._plan import Plan, Separation
    from umbmark._scores import Score
    from umbmark._sensitivity import Sensitivity
    from umbmark._solution import Solution
    from umbmark._survey import Survey
    from umbmark._sweep import Sweep
    from umbmark._tolerance import Tolerance
    from umbmark._umbmark import Dataset
    from umbmark._unlisted import Unlisted
    from umbmark._watch import Watched

COLOURS = {"cw": "tab:blue", "ccw": "tab:orange"}
MARKS = {"cw": "o", "ccw": "s"}
MM = 1e3
# As many robots have a line each.
MOST_NAMES = 50


def _axes(ax: Axes | None, names: int = 0) -> Axes:
    """Give the axes, or new ones with room for so many names one above the other."""
    if ax is not None:
        return ax
    with needs("plot"):
        from matplotlib import pyplot

    figsize = (6.4, max(4.8, 0.2 * names))
    return pyplot.subplots(layout="constrained", figsize=figsize)[1]


def _seen_from_above(ax: Axes, unit: str) -> None:
    ax.set(xlabel=f"x [{unit}]", ylabel=f"y [{unit}]", aspect="equal")
    ax.set_adjustable("datalim")
    ax.plot(0, 0, "k+", markersize=10)
    ax.legend()


def dataset(data: Dataset, ax: Axes | None, tracks: bool) -> Axes:
    """Draw return errors in mm, or tracks in m."""
    ax = _axes(ax)
    for direction, colour in COLOURS.items():
        if tracks:
            runs = [run for run in data.runs if run.direction == direction]
            poses = [run.reference_pose for run in runs if run.reference_pose is not None]
            for index, pose in enumerate(poses):
                label = f"{direction}, measured" if index == 0 else None
                ax.plot(pose[:, 0], pose[:, 1], color=colour, linewidth=0.8, label=label)
        else:
            errors = MM * data.returns(direction)
            mark = MARKS[direction]
            ax.plot(errors[:, 0], errors[:, 1], mark, color=colour, label=f"{direction} runs")
    _seen_from_above(ax, "m" if tracks else "mm")
    return ax


def score(result: Score, ax: Axes | None) -> Axes:
    """Draw centres of gravity with their ellipses, and the circle of E_max,sys, in mm."""
    ax = _axes(ax)
    from matplotlib.patches import Circle, Ellipse

    centres = {"cw": result.centroid_cw_m, "ccw": result.centroid_ccw_m}
    ellipses = {"cw": result.centroid_cw_ellipse, "ccw": result.centroid_ccw_ellipse}
    for direction, centre in centres.items():
        if centre is None:
            continue
        colour, (x, y) = COLOURS[direction], (MM * centre[0], MM * centre[1])
        ax.plot(x, y, "*", color=colour, markersize=12, label=f"centre of gravity {direction}")
        ellipse = ellipses[direction]
        if ellipse is not None:
            width, height = 2 * MM * ellipse.semi_major_m, 2 * MM * ellipse.semi_minor_m
            turned = np.degrees(ellipse.angle_rad)
            ax.add_patch(Ellipse((x, y), width, height, angle=turned, color=colour, alpha=0.25))
    if result.e_max_sys_m is not None:
        radius = MM * result.e_max_sys_m
        ax.add_patch(Circle((0, 0), radius, fill=False, linestyle="--", edgecolor="grey"))
        ax.set_title(f"E_max,sys {radius:.0f} mm")
    _seen_from_above(ax, "mm")
    ax.autoscale_view()
    return ax


def calibration(result: Calibration, ax: Axes | None) -> Axes:
    """Draw E_b over E_d of each method."""
    ax = _axes(ax)
    for name, found in result.methods.items():
        if found is None or found.e_d is None or found.e_b is None:
            continue
        low, high = found.e_d_interval or (found.e_d,) * 2
        xerr = [[found.e_d - low], [high - found.e_d]]
        low, high = found.e_b_interval or (found.e_b,) * 2
        yerr = [[found.e_b - low], [high - found.e_b]]
        ax.errorbar(found.e_d, found.e_b, xerr=xerr, yerr=yerr, fmt="o", capsize=3, label=name)
    ax.set(xlabel="E_d", ylabel="E_b")
    ax.ticklabel_format(useOffset=False)
    ax.legend()
    return ax


def _small_p(ax: Axes, names: list[str], p: list[float], size: float) -> None:
    """Bars of p on a logarithmic scale, the first name at the top, and the size of the test."""
    least = 1e-6
    ax.barh(names, [-np.log10(max(value, least)) for value in p])
    ax.axvline(-np.log10(size), color="tab:red", linestyle="--", label=f"p = {size}")
    ax.invert_yaxis()
    ax.set_xlabel("-log10 p")
    ax.legend()


def comparison(result: Comparison, ax: Axes | None) -> Axes:
    """Draw p of every statistic of every model."""
    rows = result.table()
    ax = _axes(ax, len(rows))
    names = [f"{row['direction']} {row['quantity']}, {row['model']}" for row in rows]
    _small_p(ax, names, [row["p"] for row in rows], result.size)
    return ax


def track_comparison(result: TrackComparison, ax: Axes | None) -> Axes:
    """Draw errors along the way and at its end, in mm."""
    ax = _axes(ax)
    rows = result.table()
    for place, (key, label) in enumerate((("rmse_m", "along"), ("end_rmse_m", "at the end"))):
        at = np.arange(len(rows)) + 0.4 * place
        ax.bar(at, [MM * (row[key] or np.nan) for row in rows], 0.4, label=label)
    ax.set_xticks(np.arange(len(rows)) + 0.2, [row["model"] for row in rows])
    ax.set_ylabel("root mean square error [mm]")
    ax.legend()
    return ax


def diagnosis(result: Diagnosis, ax: Axes | None) -> Axes:
    """Draw p of the first classes of the ranking."""
    ax = _axes(ax)
    first = result.table()[:10]
    names = [row["class"] if len(row["class"]) < 50 else row["class"][:47] + "..." for row in first]
    _small_p(ax, names, [row["p_adjusted"] for row in first], result.size)
    ax.set_title(result.verdict.replace("_", " "))
    return ax


def fitted(result: Fitted | GearCalibration, ax: Axes | None) -> Axes:
    """Draw how far each value lies from what does nothing, in standard errors."""
    from umbmark._umbmark import effects

    ax = _axes(ax)
    catalogue = effects()
    for place, estimate in enumerate(result.fitted):
        known = catalogue.get(estimate.effect)
        defaults = {p.name: p.default for p in known.parameters} if known else {}
        nothing = defaults.get(estimate.parameter, 0.0)
        if estimate.standard_error and not isinstance(nothing, str):
            ax.errorbar(
                (estimate.value - nothing) / estimate.standard_error, place, xerr=1, fmt="o"
            )
    names = [f"{estimate.parameter} of {estimate.effect}" for estimate in result.fitted]
    ax.set_yticks(range(len(names)), names)
    ax.axvline(0, color="grey", linewidth=0.8)
    ax.set_xlabel("departure [standard errors]")
    return ax


def learnt(result: Learnt, ax: Axes | None) -> Axes:
    """Draw the error in mm falling from step to step."""
    ax = _axes(ax)
    rows = result.table()
    names = [str(row["added"]) for row in rows]
    drawn = {"rmse_m": "runs fitted to", "heldout_rmse_m": "runs left out"}
    for condition in result.conditions:
        name = condition.names[0]
        drawn[f"by_{name}_rmse_m"] = f"runs of each {name} left out"
    for key, label in drawn.items():
        ax.plot(names, [MM * (row[key] or np.nan) for row in rows], "o-", label=label)
    ax.set(ylabel="root mean square error [mm]", ylim=(0, None))
    ax.tick_params(axis="x", rotation=30)
    ax.legend()
    return ax


def solution(result: Solution, ax: Axes | None) -> Axes:
    """Draw by how much each number of the robot changes, in per cent, with its interval."""
    ax = _axes(ax)
    for place, change in enumerate(result.correction.values()):
        new, *ends = (
            100 * (np.nan if value is None else value / change.old - 1)
            for value in (change.new, change.low, change.high)
        )
        ax.errorbar(new, place, xerr=[[new - ends[0]], [ends[1] - new]], fmt="C0o", capsize=3)
    names = [name.rpartition("_")[0].replace("_", " ") for name in result.correction]
    ax.set_yticks(range(len(names)), names)
    ax.invert_yaxis()
    ax.axvline(0, color="grey", linewidth=0.8)
    ax.set_xlabel("new against old [%]")
    return ax


def unlisted(result: Unlisted, ax: Axes | None) -> Axes:
    """Draw the curve of a missing effect with its band, over what it depends on."""
    ax = _axes(ax)
    points = result.curve.points
    at = [point.at for point in points]
    ax.plot(at, [point.value for point in points], color="tab:green", label="missing")
    low, high = ([getattr(point, end) for point in points] for end in ("low", "high"))
    ax.fill_between(at, low, high, color="tab:green", alpha=0.25, label="95 %")
    ax.axhline(0, color="grey", linewidth=0.8)
    named = ((result.depends_on, result.curve.at_unit), (result.acts_on, result.curve.unit))
    labels = [name.replace("_", " ") + (f" [{unit}]" if unit else "") for name, unit in named]
    ax.set(xlabel=labels[0], ylabel=labels[1])
    ax.legend()
    return ax


def inspection(result: Inspection, ax: Axes | None) -> Axes:
    """Draw numbers of runs, and of what they have."""
    ax = _axes(ax)
    names = [f"{group.test} {group.direction or ''}".strip() for group in result.groups]
    for place, key in enumerate(("runs", "returns", "headings", "logs")):
        at = np.arange(len(names)) + 0.2 * place
        ax.bar(at, [getattr(group, key) for group in result.groups], 0.2, label=key)
    ax.set_xticks(np.arange(len(names)) + 0.3, names)
    ax.legend()
    return ax


def sensitivity(result: Sensitivity, ax: Axes | None, metric: str) -> Axes:
    """Draw each index of each parameter, with its interval."""
    ax = _axes(ax)
    rows = [row for row in result.table() if row["metric"] == metric]
    names = list(dict.fromkeys(row["parameter"] for row in rows))
    indices = list(dict.fromkeys(row["index"] for row in rows))
    for place, index in enumerate(indices):
        own = [row for row in rows if row["index"] == index]
        value = np.array([row["value"] for row in own], float)
        ends = np.array([[row["low"], row["high"]] for row in own], float).T
        at = np.arange(len(own)) + 0.8 * place / len(indices)
        error = np.abs(ends - value)
        ax.barh(at, value, 0.8 / len(indices), xerr=error, label=index.replace("_", " "))
    ax.set_yticks(np.arange(len(names)) + 0.4 * (1 - 1 / max(1, len(indices))), names)
    ax.invert_yaxis()
    ax.set_title(metric)
    ax.legend()
    return ax


def monte_carlo(result: MonteCarlo, ax: Axes | None, metric: str) -> Axes:
    """Draw the distribution of a metric, in mm or degrees."""
    ax = _axes(ax)
    low, high = result.ensemble.quantile(metric, np.array([0.001, 0.999]))
    edges = np.linspace(low, high, 41) if high > low else np.array([low - 1e-6, low + 1e-6])
    below = result.ensemble.share_below(metric, edges)
    scale, name, unit = _metric(metric)
    ax.stairs(np.diff(below), scale * edges, fill=True, alpha=0.6)
    mean = scale * result.ensemble.mean(metric)
    ax.axvline(mean, color="tab:red", label=f"mean {mean:.4g} {unit}")
    ax.set(xlabel=f"{name} [{unit}]", ylabel="share of trials", title=f"{result.n} trials")
    ax.legend()
    return ax


def _metric(metric: str) -> tuple[float, str, str]:
    """Give the scale of a metric, its name in words, and the unit of both."""
    scale, unit = (np.degrees(1.0), "deg") if metric.endswith("_rad") else (MM, "mm")
    return scale, metric.removesuffix("_rad").removesuffix("_m").replace("_", " "), unit


def sweep(result: Sweep, ax: Axes | None, metric: str) -> Axes:
    """Draw the mean of a metric along one axis with its 5 and 95 % quantiles, or as a map."""
    scale, name, unit = _metric(metric)
    ends = [(axis.first, axis.last, axis.count) for axis in result.axes]
    if len(ends) > 2:
        raise ValueError(f"a figure has one axis or two, the sweep {len(ends)}; use table()")
    ax = _axes(ax)
    told = [point.metrics[metric] for point in result.points]
    mean = scale * np.array([one.mean for one in told], float)
    if len(ends) == 1:
        at = [point.values[0] for point in result.points]
        low, high = (
            scale * np.array([one.quantiles[share] for one in told], float)
            for share in ("0.05", "0.95")
        )
        ax.plot(at, mean, label="mean")
        ax.fill_between(at, low, high, alpha=0.3, label="5 to 95 %")
        ax.set(xlabel=result.axes[0].flag, ylabel=f"{name} [{unit}]")
        ax.legend()
        return ax
    up, right = (np.linspace(*axis) for axis in ends)
    grid = np.full(len(up) * len(right), np.nan)
    grid[: len(mean)] = mean
    drawn = ax.pcolormesh(right, up, grid.reshape(len(up), len(right)), shading="nearest")
    ax.figure.colorbar(drawn, ax=ax, label=f"mean {name} [{unit}]")
    ax.set(xlabel=result.axes[1].flag, ylabel=result.axes[0].flag)
    return ax


def tolerance(result: Tolerance, ax: Axes | None) -> Axes:
    """Draw the distribution of the metric over the robots as they are now, and the target."""
    scale, name, unit = _metric(result.metric)
    ax = _axes(ax)
    ax.hist(scale * np.array(result.sizes), bins=40, alpha=0.6)
    wanted = result.target.at_most_m or result.target.at_most_rad
    at = scale * float(wanted or 0.0)
    within = 100 * (result.now.share_within.value or 0.0)
    ax.axvline(at, color="tab:red", label=f"{within:.1f} % within {at:.4g} {unit}")
    ax.set(xlabel=f"{name} [{unit}]", ylabel="robots", title=f"{result.robots} robots")
    ax.legend()
    return ax


def plan(result: Plan, ax: Axes | None) -> Axes:
    """Draw what E_max,sys would read with each number of runs, in mm."""
    ax = _axes(ax)
    runs = [row.runs for row in result.by_runs]
    told = [row.e_max_sys_m for row in result.by_runs]
    mean, spread, half, band = (
        MM * np.array(values)
        for values in zip(
            *((e.mean, e.std_dev, e.interval_half_width_m, e.noise_band_m) for e in told),
            strict=True,
        )
    )
    ax.errorbar(runs, mean, yerr=spread, fmt="o", capsize=3, label="E_max,sys as it would read")
    ax.plot(runs, half, "s--", label="half of its interval")
    ax.plot(runs, band, ":", label="chance alone stays below")
    ax.axhline(MM * result.e_max_sys_m, color="grey", linewidth=0.8, label="the robot itself")
    ax.set(xlabel="runs in each direction", ylabel="mm", ylim=(0, None))
    ax.legend()
    return ax


def separation(result: Separation, ax: Axes | None) -> Axes:
    """Draw how many standard deviations apart each experiment puts two effects."""
    ax = _axes(ax)
    rows = result.table()[:10]
    ax.barh([row["experiment"] for row in rows], [row["sd"] for row in rows])
    ax.axvline(3.24, color="tab:red", linestyle="--", label="told in nine cases of ten")
    ax.invert_yaxis()
    ax.set(xlabel="standard deviations apart", title=" or ".join(result.separates))
    ax.legend()
    return ax


def paper(result: Paper, ax: Axes | None, quantity: str | None) -> Axes:
    """Draw a quantity as it was found, where simulated tests lie, and as it was published."""
    wanted = quantity or str(result.table()[0]["quantity"])
    rows = [row for row in result.table() if row["quantity"] == wanted]
    if not rows:
        known = ", ".join(sorted({str(row["quantity"]) for row in result.table()}))
        raise ValueError(f"there is no quantity {wanted!r}; there are {known}")
    scale, unit = (MM, "mm") if wanted.endswith("_m") else (180 / np.pi, "deg")
    ax = _axes(ax)
    places = np.arange(len(rows))
    found = scale * np.array([row["value"] for row in rows])
    ends = [[row[end] for row in rows] for end in ("low", "high")]
    if None not in ends[0]:
        low, high = scale * np.array(ends)
        ax.hlines(places, low, high, linewidth=6, alpha=0.3, label="middle 95 % of simulated tests")
        published = scale * np.array([row["published"] for row in rows])
        ax.plot(published, places, "o", color="tab:red", label="published")
    ax.plot(found, places, "|", markersize=12, label="found")
    ax.set_yticks(places, [f"{row['experiment']}: {row['what']}" for row in rows])
    ax.invert_yaxis()
    ax.set(xlabel=f"{wanted.rsplit('_', 1)[0]} [{unit}]")
    ax.legend()
    return ax


def changed(result: Changed, ax: Axes | None) -> Axes:
    """Draw how far each number moved, in standard errors of the change, with its interval."""
    rows = [*result.robot, *result.reference]
    ax = _axes(ax, len(rows))
    for place, row in enumerate(rows):
        values = np.array([row.change, *(row.interval or (np.nan, np.nan))])
        if row.of == "scatter":
            # A factor, whose errors are those of its logarithm.
            values = np.log(values)
        error = np.hypot(row.before_standard_error, row.after_standard_error)
        change, low, high = values / error if error > 0 else np.full(3, np.nan)
        colour = "tab:red" if row.changed else "tab:blue"
        ax.errorbar(
            change, place, xerr=[[change - low], [high - change]], fmt="o", color=colour, capsize=3
        )
    ax.set_yticks(range(len(rows)), [row.key for row in rows])
    ax.invert_yaxis()
    ax.axvline(0, color="grey", linewidth=0.8)
    ax.set_xlabel("after against before [standard errors]")
    return ax


def conditions(result: Conditions, ax: Axes | None) -> Axes:
    """Draw p of every number under every condition."""
    ax = _axes(ax, len(result.asked))
    names = [f"{asked.key} by {asked.condition}" for asked in result.asked]
    _small_p(ax, names, [asked.p_adjusted for asked in result.asked], result.size)
    return ax


def survey(result: Survey, ax: Axes | None, number: str | None) -> Axes:
    """Draw a number of every robot with its interval, and how far the robots are apart.

    A histogram of many robots.
    """
    told: dict[str, dict[str, Estimate]] = {}
    for robot in result.robots:
        for one in robot.fitted:
            told.setdefault(f"{one.effect}.{one.parameter}", {})[robot.robot] = one
    if not told:
        raise ValueError("no number was found of any robot")
    number = number or next(iter(told))
    if number not in told:
        raise ValueError(f'there is no number "{number}"; there are {", ".join(told)}')
    apart = {robot.robot for robot in result.robots if number in {s.key for s in robot.stands_out}}
    named = len(told[number]) <= MOST_NAMES
    ax = _axes(ax, len(told[number]) if named else 0)
    if named:
        for place, (name, one) in enumerate(told[number].items()):
            low, high = one.interval or (np.nan, np.nan)
            colour = "tab:red" if name in apart else "tab:blue"
            ends = [[one.value - low], [high - one.value]]
            ax.errorbar(one.value, place, xerr=ends, fmt="o", color=colour, capsize=3)
        ax.set_yticks(range(len(told[number])), [*told[number]])
        ax.invert_yaxis()
    else:
        ax.hist([one.value for one in told[number].values()], bins=40, alpha=0.6)
        ax.set_ylabel("robots")
    for among in (among for among in result.among if among.key == number):
        spread = f"robots apart by {among.sd_between:.2g} (1 sd)"
        low, high = among.mean - among.sd_between, among.mean + among.sd_between
        ax.axvspan(low, high, color="grey", alpha=0.25, label=spread)
        ax.axvline(among.mean, color="grey", linewidth=0.8)
        ax.legend()
    ax.ticklabel_format(axis="x", useOffset=False)
    ax.set_xlabel(number)
    return ax


def watched(result: Watched, ax: Axes | None) -> Axes:
    """Draw the likelihood ratios of changes over the runs, each with its limit."""
    ax = _axes(ax)
    at = np.arange(1, len(result.runs) + 1)
    for kind, colour in (
        ("numbers", "tab:blue"),
        ("place", "tab:orange"),
        ("scatter", "tab:green"),
    ):
        height, limit = (
            np.array([getattr(run, key) for run in result.runs], float)
            for key in (kind, f"{kind}_limit")
        )
        ax.plot(at, height, "o-", color=colour, markersize=3, label=kind)
        ax.plot(at, limit, "--", color=colour, linewidth=0.8)
    ax.set(xlabel="run", ylabel="log likelihood ratio of a change (dashed: limit)")
    ax.set_title("changed" if result.changed else "no change")
    ax.legend()
    return ax
