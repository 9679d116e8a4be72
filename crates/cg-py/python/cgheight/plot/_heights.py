"""Figure of the heights of many logs."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from cgheight._batch import Estimates
from cgheight.plot._style import BLUE, GREY, RED, figure, style

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def heights(estimates: Estimates, *, true_heights_m: Mapping[str, float] | None = None) -> Figure:
    """Draw the height of each log with its 95 % interval, next to the true heights if known.

    How to read it: nineteen of twenty intervals should contain the true height. A log without a
    height is marked at the left edge, with the reason in `messages` of its estimate.

    Parameters
    ----------
    estimates : Estimates
        From `cgheight.estimate_logs`.
    true_heights_m : dict of str to float, optional
        The known height of a log (m) by its name, or by the last component of its path if no other
        log has the same.

    Returns
    -------
    matplotlib.figure.Figure
        One row for each log, in their order, over the height of the trailer's sprung c.g. (m).

    Raises
    ------
    ValueError
        There is no log, or a true height has a name that several logs have.
    ImportError
        matplotlib is not installed.
    """
    if len(estimates) == 0:
        raise ValueError("no log to draw: give at least one")
    known = true_heights_m or {}
    names = _names(estimates.logs)
    ends = [os.path.basename(log) for log in estimates.logs]
    for name in known:
        if name not in estimates.logs and ends.count(name) > 1:
            raise ValueError(f"{name}: several logs have this name; give the whole path")
    made, (axes,) = figure(1, [1.1 + 0.28 * len(names)])
    with style():
        for place, answer in enumerate(estimates):
            if answer.height_m is None or answer.height_ci95_m is None:
                axes.annotate(f"no height: {answer.status}", (0.01, place), color=RED, fontsize=8,
                              xycoords=("axes fraction", "data"), va="center")  # fmt: skip
                continue
            axes.plot(answer.height_ci95_m, [place, place], color=BLUE, linewidth=3, alpha=0.35,
                      solid_capstyle="butt")  # fmt: skip
            axes.plot(answer.height_m, place, "o", color=BLUE, markersize=5)
        for place, (log, end) in enumerate(zip(estimates.logs, ends, strict=True)):
            true_m = known.get(log, known.get(end))
            if true_m is not None:
                axes.plot(true_m, place, "|", color=RED, markersize=13, markeredgewidth=2)
        axes.set_yticks(range(len(names)), names, fontsize=8)
        axes.set_ylim(len(names) - 0.5, -0.5)
        axes.grid(visible=False, axis="y")
        axes.tick_params(axis="y", colors=GREY, length=0)
        axes.set_xlabel("c.g. height (m)")
        marks = "; red: true height" if known else ""
        axes.set_title(f"Heights of {len(names)} logs; bars: 95 % interval{marks}")
    return made


def _names(logs: Sequence[str]) -> list[str]:
    """Return the file names of logs, or their paths below the common folder if two are the same."""
    ends = [os.path.basename(log) or log for log in logs]
    if len(set(ends)) == len(ends):
        return ends
    paths = {log for log in logs if os.path.dirname(log)}
    if len({os.path.isabs(log) for log in paths}) != 1:
        return list(logs)
    common = os.path.commonpath([os.path.dirname(log) for log in paths])
    return [os.path.relpath(log, common or ".") if log in paths else log for log in logs]
