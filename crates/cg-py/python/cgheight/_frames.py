"""CAN frames: python-can reads them, and the compiled module turns them into rows and estimates.

The rows are the same as in `cg run`, because the decoder and the alignment of signals are the same.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from pathlib import PurePath
from tempfile import mkstemp
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cgheight import _native
from cgheight._columns import flips, maps
from cgheight._extras import need
from cgheight._results import Estimate

# File formats of CAN frames. The compiled module reads those in text, python-can the others.
CANDUMP = ".log"
NATIVE = (CANDUMP, ".asc")
CAN_SUFFIXES = (*NATIVE, ".blf", ".mf4", ".trc")
#: The largest number of buses that can be distinguished.
_BUSES = 32

# A frame: (time stamp in seconds, bus), identifier, whether it has 29 bits, payload.
Frame = tuple[tuple[float, int], int, bool, bytes]


def suffix(path: str | os.PathLike[str]) -> str:
    """Return the suffix of a file name in lower case."""
    return PurePath(path).suffix.lower()


def is_can(path: str | os.PathLike[str]) -> bool:
    """Return whether a file with this name contains CAN frames."""
    return suffix(path) in CAN_SUFFIXES


def reading(
    dbc: str | os.PathLike[str] | None = None,
    signals: Mapping[str, str] | None = None,
    flip: Iterable[str] = (),
    roll_compensated: str = "bit",
    vdc2: str = "specific-force",
    bus: str | int | None = None,
) -> dict[str, Any]:
    """Return the rules for decoding frames in the form of the compiled module."""
    if dbc is None and signals:
        raise ValueError("signals contains names from a DBC file: give dbc too")
    if dbc is not None and not signals:
        raise ValueError(
            f"{os.fspath(dbc)}: give the names of the signals in it, such as "
            "signals={'roll': 'Name', 'steering_wheel': 'Name'}"
        )
    return {
        "dbc": None if dbc is None else os.fspath(dbc),
        "signals": maps(signals, "signals"),
        "flip": flips(flip),
        "roll_compensated": roll_compensated,
        "vdc2": vdc2,
        "bus": None if bus is None else str(bus),
    }


def framed(
    only: str | None = None, buses: dict[Hashable, int] | None = None
) -> Callable[[Any], Frame | None]:
    """Return a function that converts python-can messages to frames.

    It returns None for messages without data and for those of other buses than `only`. `buses` gets
    the names of all.
    """
    buses = {} if buses is None else buses

    def frame(message: Any) -> Frame | None:
        if message.is_error_frame or message.is_remote_frame:
            return None
        bus = buses.setdefault(message.channel, min(len(buses), _BUSES - 1))
        if only is not None and str(message.channel) != only:
            return None
        place = (float(message.timestamp), bus)
        return place, message.arbitration_id, message.is_extended_id, bytes(message.data)

    return frame


def _frames(
    name: str, only: str | None = None, buses: dict[Hashable, int] | None = None
) -> Iterator[Frame]:
    """Read the frames of a file, or of one of its buses, with python-can."""
    can = need("can", "can")
    if suffix(name) == ".mf4":
        need("asammdf", "can")
    if not os.path.exists(name):
        raise FileNotFoundError(f"{name}: cannot be read (there is no such file)")
    frame, count = framed(only, buses), 0
    try:
        with can.LogReader(name) as reader:
            _refuse_cut(name, reader)
            for message in reader:
                count += 1
                found = frame(message)
                if found is not None:
                    yield found
    except OSError:
        raise
    except Exception as error:  # each reader of python-can raises its own exceptions
        raise ValueError(
            f"{name}, after {count} frames: cannot be read in the format of its name: {error}"
        ) from error


def _refuse_cut(name: str, reader: Any) -> None:
    """Refuse a BLF file that is shorter than its header says; python-can reads it all the same."""
    if suffix(name) == ".blf" and (size := os.path.getsize(name)) < reader.file_size:
        raise ValueError(
            f"the file is cut off: it has {size} of {reader.file_size} bytes; copy it again, or "
            "let its program save it anew"
        )


def _refuse_empty(name: str, rows: int, frames: int, remarks: list[str]) -> None:
    if rows == 0:
        doubts = "".join(f"; {remark}" for remark in remarks)
        raise ValueError(
            f"{name}: none of its {frames} frames contains a valid roll angle (J1939 SSI2 "
            f"or SSI); for another sensor give dbc and signals{doubts}"
        )


def read_frames(
    path: str | os.PathLike[str], understood: dict[str, Any]
) -> tuple[dict[str, NDArray[np.float64]], list[str]]:
    """Return the rows of a CAN log as SI columns, and the remarks about its signals."""
    name = os.fspath(path)
    if suffix(name) in NATIVE:
        return _native.read_frames(name, understood)
    table, buses = _native.FrameTable(understood), dict[Hashable, int]()
    for frame in _frames(name, understood["bus"], buses):
        table.push(*frame)
    signals, remarks = table.finish(), table.remarks()
    several = _native.several_buses(name, understood["bus"], [str(bus) for bus in buses])
    remarks += [several] if several else []
    _refuse_empty(name, len(signals), table.frames[0], remarks)
    return signals, remarks


def estimate_frames(
    path: str | os.PathLike[str], vehicle: _native.Vehicle, flip: list[str], options: dict[str, Any]
) -> Estimate:
    """Estimate from a CAN log with J1939 signals."""
    name = os.fspath(path)
    if suffix(name) in NATIVE:
        return _native.estimate_file(vehicle, name, [], flip, options)
    stream = _native.FrameStream(vehicle, reading(flip=flip), options)
    for frame in _frames(name):
        stream.push(*frame)
    _refuse_empty(name, stream.finish(), stream.counts[0], stream.remarks())
    return stream.estimate()


def as_candump(name: str, folder: str) -> str:
    """Return a log that the compiled module reads; other frames are converted in `folder`."""
    if suffix(name) in NATIVE:
        return name
    # Only its suffix is fixed: two runs may have the same name.
    handle, path = mkstemp(CANDUMP, dir=folder)
    with open(handle, "w", encoding="ascii") as out:
        for (time_s, bus), identifier, extended, data in _frames(name):
            digits = 8 if extended else 3
            mark = "#" if len(data) <= 8 else "##0"
            out.write(
                f"({time_s:.6f}) can{bus} {identifier:0{digits}X}{mark}{data.hex().upper()}\n"
            )
    return path
