"""Tables in files that other packages read: MATLAB, Feather, and measured channels in MF4."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cgheight import _native
from cgheight._arrays import column
from cgheight._columns import flips, maps, table_signals
from cgheight._extras import need

_MATLAB, _HDF5, _ARROW, _MDF = "MATLAB", "HDF5", "Arrow", "MDF"
# The first bytes of a file.
_MAGIC = {
    b"MATLAB 7.3": _HDF5,
    b"MATLAB": _MATLAB,
    b"\x89HDF": _HDF5,
    b"ARROW1": _ARROW,
    b"FEA1": _ARROW,
    b"MDF ": _MDF,
    b"UnFinMF": _MDF,
}


def _kind(path: str | os.PathLike[str]) -> str | None:
    try:
        with open(path, "rb") as file:
            head = file.read(16)
    except OSError:
        return None  # whoever reads it says why it cannot be read
    return next((kind for magic, kind in _MAGIC.items() if head.startswith(magic)), None)


def is_table(path: str | os.PathLike[str], columns: Mapping[str, str] | None) -> bool:
    """Return whether `read_table` reads this file: its first bytes say so.

    An MF4 file is a table if it has no CAN frames, or if columns of it are named.
    """
    kind = _kind(path)
    if kind != _MDF or columns:
        return kind is not None
    mdf = need("asammdf", "can").MDF
    try:
        with mdf(path) as file:
            return not any(getattr(file, "bus_logging_map", {}).get("CAN", {}).values())
    except OSError:
        raise
    except Exception as error:  # asammdf raises its own and many others
        name = os.fspath(path)
        raise ValueError(
            f"{name}: damaged, or not an MF4 file: copy it again, or let its program save it anew"
        ) from error


def read_table(
    path: str | os.PathLike[str], columns: Mapping[str, str] | None, flip: Iterable[str]
) -> dict[str, NDArray[np.float64]]:
    """Return the signals of such a file in SI units."""
    name, kind = os.fspath(path), _kind(path)
    try:
        if kind == _MDF:
            return channels(name, maps(columns), flips(flip))
        table = {_MATLAB: _matlab, _HDF5: _hdf5, _ARROW: _feather}[str(kind)](name)
        return table_signals(table, maps(columns), flips(flip))
    except ValueError as error:
        said = str(error).removeprefix("the table, line 1: ").removeprefix("the table: ")
        raise ValueError(f"{name}: {said}") from error
    except (OSError, ImportError):
        raise
    except Exception as error:  # each of these readers raises its own exceptions
        raise ValueError(f"{name}: damaged, or not a {kind} file: {error}") from error


def _matlab(name: str) -> dict[str, NDArray[Any]]:
    held = need("scipy.io", "mat").loadmat(name, squeeze_me=True, struct_as_record=True)
    table: dict[str, NDArray[Any]] = {}
    sources: dict[str, str] = {}
    for key, value in held.items():
        if key.startswith("__"):
            continue
        array = np.atleast_1d(value)
        # The fields of a structure are columns.
        fields = array.dtype.names if array.size == 1 else None
        for field, item in [(key, array)] if not fields else [(f, array[f][0]) for f in fields]:
            item = np.atleast_1d(item)
            if item.ndim == 1 and item.dtype.kind in "biuf":
                _once(sources, field, key if fields else "")
                table[field] = item
    remedy = (
        "a table or a timetable must be saved as a structure of vectors: "
        "s = table2struct(T, 'ToScalar', true); save('log.mat', '-struct', 's')"
    )
    return _rows_of(table, remedy)


def _hdf5(name: str) -> dict[str, NDArray[Any]]:
    table: dict[str, NDArray[Any]] = {}
    sources: dict[str, str] = {}

    def visit(key: str, item: Any) -> None:
        kind = getattr(getattr(item, "dtype", None), "kind", "")
        if kind and kind in "biuf" and "#refs#" not in key:
            array = np.squeeze(item[()])
            if array.ndim == 1:
                group, _, field = key.rpartition("/")
                _once(sources, field, group)
                table[field] = array

    with need("h5py", "mat").File(name, "r") as file:
        file.visititems(visit)
    return _rows_of(table, "save the log as numeric vectors of one length")


def _once(sources: dict[str, str], field: str, source: str) -> None:
    """Refuse a column that two structures or groups of a file have: they may be two logs."""
    if field in sources:
        both = " and in ".join(one or "the file itself" for one in (sources[field], source))
        raise ValueError(
            f"{field} occurs twice, in {both}: save one log in a file, or read the one that is "
            "meant and give its columns as a dict"
        )
    sources[field] = source


def _rows_of(table: dict[str, NDArray[Any]], remedy: str) -> dict[str, NDArray[Any]]:
    """Return the columns of the most frequent length; the others are parameters."""
    lengths = [len(values) for values in table.values() if len(values) > 1]
    if not lengths:
        raise ValueError(f"contains no numeric vectors; {remedy}")
    rows = max(set(lengths), key=lengths.count)
    return {key: values for key, values in table.items() if len(values) == rows}


def _feather(name: str) -> Any:
    return need("pyarrow.feather", "arrow").read_table(name)


# More names than this do not fit into a message; then only those that may be signals are resolved.
_MANY = 500


def channels(name: str, maps: list[str], flips: list[str]) -> dict[str, NDArray[np.float64]]:
    """Return measured channels of an MDF file, with a row for each time stamp of any of them."""
    with need("asammdf", "can").MDF(name) as file:
        known = _channel_names(file, maps)
        units = [_unit(file, channel) for channel in known]
        found = _native.resolve_columns(["time_s", *known], ["", *units], maps, flips)
        used = {place - 1 for place, _ in found.values()}
        shown = [
            channel if place in used or not unit else f"{channel} [{unit}]"
            for place, (channel, unit) in enumerate(zip(known, units, strict=True))
        ]
        if not maps:
            # A unit that is not understood is an error, as it is in the header of a table.
            _native.resolve_columns(["time_s", *shown], ["", *units], [], flips)
        held = {}
        for signal, (place, factor) in found.items():
            if place > 0:
                channel = known[place - 1]
                values = file.get(channel)
                samples = column(channel, values.samples) * factor
                held[signal] = (_times_s(file, channel, values.timestamps), samples)
    return _side_by_side(held)


# What is not a second, and how many seconds it is.
_SECONDS = {"ms": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9}
_TIME = 1  # the kind of master channel, of which the others are angle, distance and index


def _times_s(file: Any, channel: str, stamps: Any) -> NDArray[np.float64]:
    """Return the time stamps of a channel in seconds."""
    group, _ = file.channels_db[channel][0]
    master = file.masters_db.get(group)
    times_s = column("timestamps", stamps)
    if master is not None:
        kind = file.get_channel_metadata(group=group, index=master)
        if getattr(kind, "sync_type", _TIME) > _TIME:
            over = file.get_channel_name(group, master)
            raise ValueError(
                f"{channel} is recorded over {over}, which is not a time: export it over the time"
            )
        unit = str(file.get_channel_unit(group=group, index=master) or "").strip()
        times_s = times_s * _SECONDS.get(unit, 1.0)
    back = np.flatnonzero(~(np.diff(times_s) >= 0.0))
    if len(back):
        k = int(back[0])
        raise ValueError(
            f"{channel}: the time stamp {times_s[k + 1]:.6g} s of value {k + 1} does not come "
            f"after {times_s[k]:.6g} s: sort the channel by time, or split the file there"
        )
    return times_s


class SideBySide(dict[str, NDArray[np.float64]]):
    """A table of channels with time stamps of their own, with a row for each of any of them."""


def _side_by_side(
    held: Mapping[str, tuple[NDArray[np.float64], NDArray[np.float64]]],
) -> dict[str, NDArray[np.float64]]:
    """Return signals as a table, in which cells are empty if their time stamps differ."""
    # Stamps of one instant differ by rounding.
    stamps = {signal: np.round(times_s, 6) for signal, (times_s, _) in held.items()}
    time_s = np.unique(np.concatenate([[], *stamps.values()]))
    apart = not all(np.array_equal(own, time_s) for own in stamps.values())
    table = SideBySide(time_s=time_s) if apart else {"time_s": time_s}
    for signal, (_, values) in held.items():
        table[signal] = np.full(len(time_s), np.nan)
        table[signal][np.searchsorted(time_s, stamps[signal])] = values
    return table


def _channel_names(file: Any, maps: list[str]) -> list[str]:
    masters = set(file.masters_db.items())
    names = sorted(
        name
        for name, places in file.channels_db.items()
        if not all((group, index) in masters for group, index in places)
    )
    if len(names) <= _MANY:
        return names
    wanted = " ".join(maps)
    stems = tuple(signal.rpartition("_")[0].replace("_", "") for signal in _native.signals())
    plain = {name: "".join(filter(str.isalnum, name)).lower() for name in names}
    return [name for name in names if name in wanted or plain[name].startswith(stems)]


def _unit(file: Any, channel: str) -> str:
    group, index = file.channels_db[channel][0]
    unit = file.get_channel_unit(channel, group, index) or ""
    # A degree sign in UTF-8 that was decoded as Latin-1 is preceded by an Â.
    return str(unit).replace("Â", "")


def read_channels(
    name: str, signals: Mapping[str, str], flip: Iterable[str]
) -> dict[str, NDArray[np.float64]]:
    """Return the measured channels of an MDF file that `signals` names, as `channels` does."""
    if "roll" not in signals and "tilt" not in signals:
        raise ValueError("signals contains no roll angle: give 'roll' or 'tilt'")
    held = {}
    with need("asammdf", "can").MDF(name) as file:
        known = set(file.channels_db)
        for signal, text in signals.items():
            channel, unit = _split(text)
            if channel not in known:
                raise ValueError(f"{name}: has no channel {channel}; it has {_some(known)}")
            unit = unit or _unit(file, channel)
            key, factor = _native.channel_factor(signal, channel, unit, flips(flip))
            values = file.get(channel)
            samples = column(channel, values.samples) * factor
            held[key] = (_times_s(file, channel, values.timestamps), samples)
    return _side_by_side(held)


def _split(text: str) -> tuple[str, str]:
    """Return name and unit of ``Name[unit]``; the unit is empty if there are no brackets."""
    name, bracket, unit = text.partition("[")
    return name.strip(), unit.removesuffix("]").strip() if bracket else ""


def _some(names: set[str]) -> str:
    more = "" if len(names) <= 20 else f" and {len(names) - 20} more"
    return ", ".join(sorted(names)[:20]) + more
