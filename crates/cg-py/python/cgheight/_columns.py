"""Column names, and the conversion of tables to signals in SI units."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cgheight import _native
from cgheight._arrays import column

#: The signals of a log: SI column names with their meanings.
SIGNALS: Mapping[str, str] = MappingProxyType(_native.signals())


def maps(columns: Mapping[str, str] | None) -> list[str]:
    """Return column names in the form of the compiled module: ``roll=MyName[deg]``."""
    return [f"{signal}={name}" for signal, name in (columns or {}).items()]


def flips(flip: Iterable[str]) -> list[str]:
    """Return the signals whose sign is reversed as a list."""
    return [flip] if isinstance(flip, str) else list(flip)


def table_signals(table: Any, maps: list[str], flips: list[str]) -> dict[str, NDArray[np.float64]]:
    """Return the signals of a data frame, or of a dict of arrays, in SI units."""
    if isinstance(table, Mapping):
        keys = list(table)
    elif hasattr(table, "columns") and hasattr(table, "__getitem__"):
        keys = list(table.columns)
    else:
        kind = type(table).__name__
        raise ValueError(f"log is of type {kind}: give a path or a data frame")
    found = _native.resolve_columns([str(key) for key in keys], maps, flips)
    resolved = {}
    for name, (place, factor) in found.items():
        values = column(str(keys[place]), table[keys[place]])
        resolved[name] = values if factor == 1.0 else values * factor
    return resolved
