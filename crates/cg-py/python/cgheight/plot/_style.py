"""Colors, sizes and axes that all figures share."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from cgheight._extras import need

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# The palette of Okabe and Ito can be distinguished with color blindness, and in print.
BLUE, ORANGE, GREEN, RED, GREY = "#0072B2", "#E69F00", "#009E73", "#D55E00", "#6B6B6B"
CYCLE = (BLUE, RED, GREEN, "#CC79A7", ORANGE, "#56B4E9")

_STYLE: dict[str, Any] = {
    "font.size": 10,
    "axes.titlesize": 11,
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#DDDDDD",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "lines.linewidth": 1.4,
    "legend.frameon": False,
    "legend.fontsize": 9,
    "savefig.dpi": 150,
}


def figure(
    rows: int, heights: Sequence[float], *, width: float = 9.0, sharex: bool = True
) -> tuple[Figure, list[Axes]]:
    """Return a figure with panels one above the other, with heights in inches."""
    # Created outside the style, because a backend keeps the settings of its first figure.
    pyplot = need("matplotlib.pyplot", "plot")
    made = pyplot.figure(figsize=(width, sum(heights)), layout="constrained")
    with style():
        axes = made.subplots(
            rows, 1, sharex=sharex, squeeze=False, gridspec_kw={"height_ratios": list(heights)}
        )
    return made, list(axes[:, 0])


def style() -> Any:
    """Return the context that applies the style to a figure."""
    return need("matplotlib.pyplot", "plot").rc_context(_STYLE)
