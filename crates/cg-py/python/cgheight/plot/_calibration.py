"""Figure of what a calibration has moved."""

from __future__ import annotations

import os
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from cgheight.plot._style import BLUE, GREY, figure, style

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def calibration(path: str | os.PathLike[str]) -> Figure:
    """Draw what a calibration has moved: each uncertain parameter of the truck, before and after.

    How to read it: the gray band is what the vehicle file says, one standard deviation to each
    side. Points and bars are the values after the calibration, with their standard deviation: a
    short bar was determined by the runs, and a bar as wide as the band was not. A point outside the
    band was moved against the vehicle file; beyond three, look for an error in the file or in the
    runs. The number is the value itself, a factor on the vehicle file's value or a shift.

    Parameters
    ----------
    path : str or os.PathLike
        A calibration file, from `cgheight.calibrate` or ``cg calibrate``.

    Returns
    -------
    matplotlib.figure.Figure
        One row for each parameter that the runs have narrowed by 1 % or more, the most first, over
        the change in standard deviations of the vehicle file.

    Raises
    ------
    FileNotFoundError
        There is no such file.
    ValueError
        The file is not a calibration.
    ImportError
        matplotlib is not installed.
    """
    try:
        rows = tomllib.loads(Path(path).read_text(encoding="utf-8"))["parameter"]
        known = [one for one in rows if one["prior_sd"] > 0]
        known = [one for one in known if one["sd"] <= 0.99 * one["prior_sd"]]
        known.sort(key=lambda one: one["sd"] / one["prior_sd"])
        # A factor is 1 and a shift is 0 in the vehicle file.
        shift = [one["value"] - (one["unit"] == "factor") for one in known]
        prior = np.array([one["prior_sd"] for one in known])
        wide = np.array([one["sd"] for one in known]) / prior
        moved = np.array(shift) / prior
        texts = [f"{one['value']:.3f}" if one["unit"] == "factor" else
                 f"{one['value']:+.3f} {one['unit']}" for one in known]  # fmt: skip
    except (KeyError, TypeError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise ValueError(f"{os.fspath(path)} is not a calibration: {error}") from error
    made, (axes,) = figure(1, [1.4 + 0.3 * max(len(known), 1)])
    with style():
        axes.axvspan(-1, 1, color=GREY, alpha=0.15, linewidth=0, label="vehicle file, ± 1 sd")
        places = np.arange(len(known))
        axes.errorbar(moved, places, xerr=wide, fmt="o", color=BLUE, markersize=5, elinewidth=2,
                      label="calibrated, ± 1 sd")  # fmt: skip
        for place, text in enumerate(texts):
            axes.annotate(text, (1.01, place), xycoords=("axes fraction", "data"), va="center",
                          fontsize=8, color=GREY)  # fmt: skip
        names = [one["name"].replace("_", " ") for one in known]
        axes.set_yticks(places, names, fontsize=8)
        axes.set_ylim(len(known) - 0.5, -0.5)
        reach = max(1.5, 1.1 * float(np.max(np.abs(moved) + wide, initial=0.0)))
        axes.set_xlim(-reach, reach)
        axes.grid(visible=False, axis="y")
        axes.tick_params(axis="y", length=0)
        axes.set_xlabel("change, in standard deviations of the vehicle file")
        rest = len(rows) - len(known)
        axes.set_title(f"What the calibration moved; {rest} parameters stay as in the vehicle file")
        made.legend(loc="outside lower center", ncols=2)
    return made
