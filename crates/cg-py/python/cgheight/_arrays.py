"""Conversion of arguments to the arrays that the compiled module reads in place."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def column(name: str, values: Any) -> NDArray[np.float64]:
    """Return `values` as an array of float64 that the compiled module reads in place.

    It is contiguous and aligned; `values` are copied only if they are not. Masked values become
    NaN. A ValueError that names the argument is raised if the conversion is not possible.
    """
    try:
        if getattr(getattr(values, "dtype", None), "kind", None) in ("m", "M"):
            raise ValueError("dates and durations have no SI unit; convert them to numbers")
        _refuse_complex(values)
        if isinstance(values, np.ma.MaskedArray):
            values = np.ma.filled(values.astype(np.float64), np.nan)
        if hasattr(values, "isna") and getattr(values.dtype, "kind", None) == "O":
            values = values.to_numpy(dtype=np.float64, na_value=np.nan)
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name} does not contain numbers: {error}") from error
    if array.ndim != 1:
        raise ValueError(
            f"{name} has shape {array.shape}: it must be one-dimensional, one value for each row"
        )
    return np.require(array, requirements=["C_CONTIGUOUS", "ALIGNED"])


def _refuse_complex(values: Any) -> None:
    kind = getattr(getattr(values, "dtype", None), "kind", None)
    if kind == "c" or (isinstance(values, list | tuple) and np.iscomplexobj(values)):
        raise ValueError("it has complex numbers; give their real part or their magnitude")


def number(name: str, value: Any) -> float:
    """Return `value` as a float, or raise a ValueError that names the argument."""
    try:
        _refuse_complex(value)
        return float(value)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name} is not a number: {error}") from error
