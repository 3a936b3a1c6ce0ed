"""What a fit found as plain text: values with standard errors, and how large the residuals are."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from umbmark._documents import Estimate, Fitted, KnownBefore
from umbmark._umbmark import effects

if TYPE_CHECKING:
    from umbmark._tracks import Tracks

HEADER = ("parameter", "value", "standard error", "interval", "unit")


def report(fitted: tuple[Estimate, ...], runs: int, tracks: Tracks | None, of: Any) -> str:
    """Write down a fit: its free parameters, its residuals on tracks, and its criteria."""
    parameters = "1 parameter" if len(fitted) == 1 else f"{len(fitted)} parameters"
    rows = [HEADER, *(_row(estimate) for estimate in fitted)]
    lines = [f"{parameters}, {runs} runs", "", *_aligned(rows), "", *_residuals(tracks)]
    for name, value in (("AICc", getattr(of, "aicc", None)), ("BIC", getattr(of, "bic", None))):
        if value is not None:
            lines.append(f"{name:<17}{value:.2f}")
    if isinstance(of, Fitted):
        lines.append(f"{'fit':<17}{of.ended.how}, step {of.ended.steps}")
        lines.extend(_known(known) for known in of.known)
    return "\n".join(lines)


def _known(known: KnownBefore) -> str:
    """Say what was known of a number, and what became of it."""
    said = f"{'known before':<17}{known.effect}.{known.parameter}"
    if known.low is not None or known.high is not None:
        ends = ("" if end is None else f"{end:g}" for end in (known.low, known.high))
        said += f", bounds {':'.join(ends)}{' (held there)' if known.held else ''}"
    if known.mean is not None:
        said += f", prior {known.mean:g} ± {known.sd:g}"
    if known.contradiction is not None:
        said += f", the runs are {known.contradiction:+.1f} standard deviations from it"
    return said


def _row(estimate: Estimate) -> tuple[str, ...]:
    """Give the words of a parameter; its value has two digits more than its error's first."""
    name = f"{estimate.effect}.{estimate.parameter}"
    unit = _unit(estimate)
    error = estimate.standard_error
    if not error:
        return name, f"{estimate.value:.6g}", "not determined", "", unit
    digits = int(np.clip(1 - np.floor(np.log10(error)), 0, 15))
    low, high = estimate.interval or (np.nan, np.nan)
    written = [f"{value:.{digits}f}" for value in (estimate.value, error, low, high)]
    return name, written[0], written[1], f"{written[2]} to {written[3]}", unit


def _unit(estimate: Estimate) -> str:
    effect = effects().get(estimate.effect)
    units = {one.name: one.unit for one in effect.parameters} if effect else {}
    return units.get(estimate.parameter, "")


def _aligned(rows: list[tuple[str, ...]]) -> list[str]:
    """Give rows with columns of one width, words to the left and numbers to the right."""
    widths = [max(len(row[column]) for row in rows) for column in range(len(HEADER))]
    return [
        "  ".join(
            cell.ljust(width) if column in (0, 4) else cell.rjust(width)
            for column, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    ]


def _residuals(tracks: Tracks | None) -> list[str]:
    if tracks is None:
        return ["residuals        of return poses alone: see compare"]
    lines = [f"positions        {1e3 * tracks.rms_m:.3g} mm rms, {tracks.poses} poses"]
    if np.isfinite(tracks.rms_rad):
        lines.append(f"headings         {np.degrees(tracks.rms_rad):.3g} deg rms")
    if tracks.chi2 is not None:
        share = f", {tracks.reduced_chi2:.3f} each" if tracks.reduced_chi2 else ""
        lines.append(
            f"chi2             {tracks.chi2:.1f} of {tracks.whitened_count} residuals{share}"
        )
    return lines
