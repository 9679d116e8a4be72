"""Points in time and durations in tables, as seconds."""

from __future__ import annotations

import re
from datetime import UTC, datetime, timedelta
from typing import Any

import numpy as np
from numpy.typing import NDArray

_TIME_OF_DAY = re.compile(r"\d\d?:\d\d:\d\d")


def is_clock(values: Any) -> bool:
    """Return whether a column contains points in time or durations."""
    kind = getattr(values, "dtype", getattr(values, "type", None))
    if getattr(kind, "kind", None) in ("m", "M"):
        return True
    # The types of polars and Arrow, also in pandas.
    if str(kind).lower().startswith(("datetime", "duration", "timestamp", "timedelta")):
        return True
    if getattr(kind, "kind", "O") not in ("O", "U", "T"):
        return False
    first = next((one for one in _some(values) if not _is_missing(one)), None)
    return isinstance(first, datetime | timedelta | np.datetime64 | np.timedelta64) or (
        isinstance(first, str) and _TIME_OF_DAY.search(first) is not None and "-" in first
    )


def _is_missing(one: Any) -> bool:
    try:
        return one is None or bool(one != one)
    except (TypeError, ValueError):
        return False  # a list or an array in a cell


def _some(values: Any) -> list[Any]:
    try:
        return list(values[:100])
    except (TypeError, ValueError, KeyError):
        return []


def seconds(name: str, values: Any) -> NDArray[np.float64]:
    """Return Unix time, or the length of durations, s; NaN where a value is absent.

    Times without a zone are taken to be UTC.
    """
    array = _as_numpy(values)
    if array.dtype.kind not in ("m", "M"):
        array = _of_objects(name, array)
    whole = array.astype(f"{array.dtype.kind}8[s]")
    # Whole seconds are exact in double precision, so that the sum is rounded once.
    rest = (array - whole) / np.timedelta64(1, "s")
    return np.where(np.isnat(array), np.nan, whole.astype(np.int64) + rest)


def _as_numpy(values: Any) -> NDArray[Any]:
    kind = getattr(getattr(values, "dtype", None), "kind", None)
    if hasattr(values, "to_numpy"):
        # With this type, pandas converts zones to UTC.
        form = {"M": "datetime64[ns]", "m": "timedelta64[ns]"}.get(kind or "")
        if form is not None:
            return np.asarray(values.to_numpy(dtype=form))
        return np.asarray(values.to_numpy())
    return np.asarray(values)


def _of_objects(name: str, array: NDArray[Any]) -> NDArray[Any]:
    def plain(one: Any) -> Any:
        if isinstance(one, str):
            one = datetime.fromisoformat(one)
        if isinstance(one, datetime) and one.tzinfo is not None:
            return one.astimezone(UTC).replace(tzinfo=None)
        return one

    try:
        found = [plain(one) for one in array]
        form = "m8[us]" if any(isinstance(one, timedelta) for one in found) else "M8[us]"
        return np.array([None if one != one else one for one in found], dtype=form)
    except (TypeError, ValueError) as error:
        raise ValueError(
            f"{name} contains points in time that cannot be read: {error}; convert them with "
            "pandas.to_datetime"
        ) from error
