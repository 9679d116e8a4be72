"""Whatever holds numbers, as the arrays that the compiled half reads in place."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def column(name: str, values: Any) -> NDArray[np.float64]:
    """Return `values` as a contiguous float64 array: itself if it is one, else one copy.

    What a mask hides becomes NaN. Raises ValueError, naming the argument, where that cannot be.
    """
    try:
        if getattr(getattr(values, "dtype", None), "kind", None) in ("m", "M"):
            raise ValueError("dates and durations have no SI unit, give plain numbers")
        if isinstance(values, np.ma.MaskedArray):
            values = np.ma.filled(values.astype(np.float64), np.nan)
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name} does not hold numbers: {error}") from error
    if array.ndim != 1:
        raise ValueError(
            f"{name} has shape {array.shape}: it must be one-dimensional, one value for each row"
        )
    return np.ascontiguousarray(array)


def number(name: str, value: Any) -> float:
    """Return `value` as a float; ValueError, naming the argument, where that cannot be."""
    try:
        return float(value)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name} is no number: {error}") from error
