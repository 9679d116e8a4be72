"""Logs in all supported formats as the arrays that the compiled module reads."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterable, Mapping
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cgheight import _native
from cgheight._columns import flips, maps, table_signals
from cgheight._extras import need
from cgheight._frames import CANDUMP, is_can, read_frames, reading, suffix
from cgheight._tables import SideBySide, is_table, read_table

if TYPE_CHECKING:
    import pandas as pd


def refuse_columns(columns: Mapping[str, str] | None) -> None:
    """Refuse names of columns for a log of CAN frames."""
    if columns:
        raise ValueError(
            "columns applies to tables only: read a CAN log with "
            "cgheight.can.read_log(path, dbc=…, signals=…)"
        )


def prepared(
    table: dict[str, NDArray[np.float64]], vehicle: _native.Vehicle | None = None
) -> tuple[dict[str, NDArray[np.float64]], list[str]]:
    """Align channels of different rasters, and make roll angles of a roll rate.

    Values that the vehicle cannot have are absent then.
    """
    return _native.prepare(table, vehicle, isinstance(table, SideBySide)) or (table, [])


def log_table(
    log: Any, columns: Mapping[str, str] | None, flip: Iterable[str]
) -> dict[str, NDArray[np.float64]]:
    """Return the signals of a table as they are."""
    if isinstance(log, str | os.PathLike):
        return read_table(log, columns, flip)
    if isinstance(getattr(log, "signals", None), dict):
        log = log.signals  # a SimulatedLog
    return table_signals(log, maps(columns), flips(flip))


def signals(
    log: Any, columns: Mapping[str, str] | None, flip: Iterable[str]
) -> dict[str, NDArray[np.float64]]:
    """Return the signals of a file or a table in SI units, with their SI column names as keys."""
    if not isinstance(log, str | os.PathLike) or is_table(log, columns):
        return prepared(log_table(log, columns, flip))[0]
    if not is_can(log):
        return _native.read_file(os.fspath(log), maps(columns), flips(flip))
    refuse_columns(columns)
    return read_frames(log, reading(flip=flip))[0]


def read_log(
    log: str | os.PathLike[str] | Any,
    *,
    columns: Mapping[str, str] | None = None,
    flip: Iterable[str] = (),
) -> pd.DataFrame:
    """Read a log in any supported format into a table in SI units.

    Parameters
    ----------
    log : str, os.PathLike, or data frame
        As for `estimate_log`.
        `cgheight.can.read_log` reads CAN logs that need a DBC file.
    columns, flip
        As for `estimate_log`.

    Returns
    -------
    pandas.DataFrame
        The signals of the log in columns with SI names; NaN where a value is absent.

    Raises
    ------
    FileNotFoundError
        There is no such file.
    ValueError
        The log is not as described; the message gives the line (or row), the column and a remedy.
    ImportError
        pandas, or the package that reads the format, is not installed.
    """
    return need("pandas", "pandas").DataFrame(signals(log, columns, flip))


def write_request(
    keyword: str,
    path: str | os.PathLike[str],
    log: Any,
    vehicle: _native.Vehicle | None,
    force: bool,
) -> dict[str, Any]:
    """Return what the compiled module needs to decide whether a log may be written."""
    source = os.fspath(log) if isinstance(log, str | os.PathLike) else None
    return {
        "keyword": keyword,
        "path": os.fspath(path),
        "log": source,
        "road": None,
        "vehicle": vehicle,
        "force": bool(force),
    }


def write_log(
    log: str | os.PathLike[str] | Any,
    path: str | os.PathLike[str],
    *,
    vehicle: _native.Vehicle | None = None,
    columns: Mapping[str, str] | None = None,
    flip: Iterable[str] = (),
    force: bool = False,
) -> None:
    """Write a log to a file, as a table or as the J1939 frames that a truck would send.

    Parameters
    ----------
    log, columns, flip
        As for `estimate_log`.
    path : str or os.PathLike
        ``.csv`` or ``.csv.gz``, with SI columns; or CAN frames in ``.log`` (candump), ``.asc``,
        ``.blf``, ``.mf4``, ``.trc``. The file appears only when it is complete.
    vehicle : Vehicle, optional
        Needed for CAN frames: J1939 has a signal for the steering-wheel angle only, and the
        vehicle's steering ratio converts the road-wheel angle to it. The yaw rate of the log
        becomes that of VDC2, which is read as the tractor's; with that of the trailer, read the
        frames with ``[sensors.yaw_rate] on_tractor = false`` in the vehicle file. Without a
        vehicle, the frames
        contain no steering angle unless the log has the steering-wheel angle.
    force : bool
        Whether `path` may replace a file that this package did not write. `log` itself and the
        vehicle file are never replaced. Existing files in ``.asc``, ``.blf``, ``.log``, ``.mf4`` or
        ``.trc`` cannot be distinguished from recordings and are replaced only with `force`.

    Raises
    ------
    FileExistsError
        `path` exists, was not written by this package, and `force` is false.
    ValueError
        The log is not as described, or `path` has another suffix.
    OSError
        The file cannot be written.
    ImportError
        python-can is not installed; ``.csv``, ``.csv.gz`` and ``.log`` do not need it.

    Warns
    -----
    UserWarning
        Values outside the range of their J1939 signal were written as "not available", or columns
        of a log that was not simulated have no J1939 signal and are not in the file.
    """
    target = os.fspath(path)
    request = write_request("path", target, log, vehicle, force)
    _native.may_write(request)
    table = signals(log, columns, flip)
    simulated = getattr(log, "truth", {})
    truth = [f"truth {key} = {value}" for key, value in simulated.items()]
    if not is_can(target) or suffix(target) == CANDUMP:
        lost, unsent = _native.write_file(request, table, truth)
    else:
        can = need("can", "can")
        if suffix(target) == ".mf4":
            need("asammdf", "can")
        with TemporaryDirectory() as folder:
            frames = os.path.join(folder, "frames.log")
            lost, unsent = _native.write_file(request | {"path": frames}, table, truth)
            packed = os.path.join(folder, "packed" + suffix(target))
            with can.LogReader(frames) as reader, can.Logger(packed) as writer:
                for message in reader:
                    message.is_rx = True
                    writer.on_message_received(message)
            _native.copy_file(packed, request)
    if lost:
        warnings.warn(
            f"{target}: {lost} values are outside the range of their J1939 signal and were "
            'written as "not available"',
            stacklevel=2,
        )
    if unsent and not simulated:  # which has all signals
        warnings.warn(
            f"{target}: contains no {', '.join(unsent)}: J1939 has no signal for them, or the "
            "steering ratio of the vehicle is needed",
            stacklevel=2,
        )
