"""Column names, and the conversion of tables to signals in SI units."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cgheight import _native
from cgheight._arrays import column
from cgheight._clock import is_clock, seconds

#: The signals of a log: SI column names with their meanings.
SIGNALS: Mapping[str, str] = MappingProxyType(_native.signals())

_CLOCK = "clock"


def maps(columns: Mapping[str, str] | None, keyword: str = "columns") -> list[str]:
    """Return column names in the form of the compiled module: ``roll=MyName[deg]``."""
    if columns is not None and not isinstance(columns, Mapping):
        raise ValueError(
            f"{keyword} is a {type(columns).__name__}: give a dict of signals and their names, "
            'such as {"roll": "MyName[deg]"}'
        )
    return [f"{signal}={name}" for signal, name in (columns or {}).items()]


def flips(flip: Iterable[str]) -> list[str]:
    """Return the signals whose sign is reversed as a list."""
    return [flip] if isinstance(flip, str) else list(flip)


def table_signals(table: Any, maps: list[str], flips: list[str]) -> dict[str, NDArray[np.float64]]:
    """Return the signals of a data frame, or of a dict of arrays, in SI units.

    An index that has a name, or contains points in time, is a column too.
    """
    columns = _columns(table)
    names = [name for name, _ in columns]
    units = [_CLOCK if is_clock(get()) else "" for _, get in columns]
    found = _native.resolve_columns(names, units, maps, flips)
    resolved = {}
    for signal, (place, factor) in found.items():
        name, get = columns[place]
        if units[place] == _CLOCK:
            resolved[signal] = seconds(name, get())
            continue
        values = column(name, get())
        resolved[signal] = values if factor == 1.0 else values * factor
    return resolved


def _at(table: Any, place: int, key: Any) -> Callable[[], Any]:
    """Return how to get a column: by its place if there may be two of a name."""
    if hasattr(table, "iloc"):
        return lambda: table.iloc[:, place]
    if hasattr(table, "column_names"):
        return partial(table.column, place)
    return partial(table.__getitem__, key)


def _columns(table: Any) -> list[tuple[str, Callable[[], Any]]]:
    """Return the columns: their names as text, and how to get their values."""
    if type(table).__name__ == "LazyFrame":
        raise ValueError("log is a LazyFrame without values: give what its collect() returns")
    if isinstance(table, Mapping):
        keys = list(table)
    elif hasattr(table, "column_names"):  # a table of Arrow
        keys = list(table.column_names)
    elif hasattr(table, "columns") and hasattr(table, "__getitem__"):
        keys = list(table.columns)
    else:
        kind = type(table).__name__
        raise ValueError(f"log is of type {kind}: give a path or a data frame")
    columns: list[tuple[str, Callable[[], Any]]] = [
        (str(key), _at(table, place, key)) for place, key in enumerate(keys)
    ]
    index = getattr(table, "index", None)
    if index is None or callable(index) or not hasattr(index, "name"):
        return columns
    name = str(index.name or "index")
    clocks = any(is_clock(get()) for _, get in columns)
    if (is_clock(index) and not clocks) or (index.name is not None and name not in dict(columns)):
        columns.append((name, lambda: index))
    return columns
