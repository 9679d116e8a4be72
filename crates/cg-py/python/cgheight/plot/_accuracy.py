"""Map of the accuracy of estimated heights."""

from __future__ import annotations

from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np

from cgheight._extras import need
from cgheight.plot._style import figure, style

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

_LABELS = {
    "height_m": "true c.g. height (m)",
    "snr_db": "signal-to-noise ratio of the roll angle (dB)",
    "rmse_percent": "root mean square error of the height (%)",
    "bias_percent": "mean error of the height (%)",
    "stated_sd_percent": "stated standard deviation of the height (%)",
    "coverage_percent": "95 % intervals that contain the truth (%)",
    "bound_percent": "Cramér-Rao bound of the standard deviation (%)",
}


def accuracy_map(
    table: pd.DataFrame,
    *,
    value: str = "rmse_percent",
    x: str = "snr_db",
    y: str = "height_m",
) -> Figure:
    """Draw a map, with numbers, of the error of the height over two conditions.

    How to read it: avoid the conditions of dark cells. As the noise decreases, the error should
    decrease in proportion. With ``value="coverage_percent"`` every cell should be about 95; a lower
    number means that the stated interval is too narrow.

    Parameters
    ----------
    table : pandas.DataFrame
        From `cgheight.accuracy_map`, or any table with one row for each cell.
    value : str
        Column to show, in percent.
    x, y : str
        Columns with the two conditions.

    Returns
    -------
    matplotlib.figure.Figure
        One cell with its number for each pair of conditions.

    Raises
    ------
    ValueError
        A column is missing, or several rows belong to one cell.
    ImportError
        matplotlib is not installed.
    """
    absent = [name for name in (value, x, y) if name not in table]
    if absent:
        known = ", ".join(map(str, table))
        raise ValueError(f"the table has no column {absent[0]}; it has {known}")
    if table.duplicated([x, y]).any():
        raise ValueError(f"several rows have the same {x} and {y}: select one of them first")
    grid = table.pivot(index=y, columns=x, values=value).sort_index()
    values = grid.to_numpy(dtype=float)
    width = max(6.0, 2.6 + 0.85 * values.shape[1])
    made, (axes,) = figure(1, [max(3.0, 1.6 + 0.5 * values.shape[0])], width=width)
    with style():
        colors, limits = _colors(value, values)
        digits = 2 if np.nanmax(np.abs(values)) < 10 else 0
        image = axes.pcolormesh(values, cmap=colors, edgecolors="white", linewidth=1.5, **limits)
        axes.set_xticks(np.arange(values.shape[1]) + 0.5, [f"{v:g}" for v in grid.columns])
        axes.set_yticks(np.arange(values.shape[0]) + 0.5, [f"{v:g}" for v in grid.index])
        axes.tick_params(length=0)
        axes.grid(visible=False)
        axes.spines[["left", "bottom"]].set_visible(False)
        for (row, place), number in np.ndenumerate(values):
            red, green, blue, _ = image.cmap(image.norm(number))
            # White text on dark cells, black text on bright cells.
            dark = 0.299 * red + 0.587 * green + 0.114 * blue < 0.55
            text = "–" if np.isnan(number) else f"{number:.{digits}f}"
            axes.text(place + 0.5, row + 0.5, text, ha="center", va="center",
                      color="white" if dark else "black", fontsize=9)  # fmt: skip
        axes.set_xlabel(_LABELS.get(x, x))
        axes.set_ylabel(_LABELS.get(y, y))
        # The label is along the bar, which is lower than the label is long: two lines.
        label = fill(_LABELS.get(value, value), 30)
        made.colorbar(image, ax=axes, label=label, pad=0.02)
    return made


def _colors(value: str, values: Any) -> tuple[Any, dict[str, Any]]:
    maps = need("matplotlib", "plot").colormaps
    if value == "bias_percent":
        most = float(np.nanmax(np.abs(values))) or 1.0
        return maps["RdBu_r"], {"vmin": -most, "vmax": most}
    if value == "coverage_percent":
        return maps["Blues_r"], {"vmin": min(80.0, float(np.nanmin(values))), "vmax": 100.0}
    return maps["Blues"], {"vmin": 0.0}
