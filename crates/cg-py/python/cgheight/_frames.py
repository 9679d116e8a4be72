"""CAN frames to rows: J1939 by the core's table, anything else by a DBC file."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from typing import Any, Protocol

from cgheight import _native
from cgheight._extras import need
from cgheight._logs import flips, maps

# How DBC files write the units that a column of a log may come in.
UNITS = {
    "s": "s", "ms": "ms", "us": "us", "µs": "us",
    "rad": "rad", "deg": "deg", "°": "deg", "degree": "deg", "degrees": "deg",
    "m/s": "mps", "mps": "mps", "km/h": "kmh", "kmh": "kmh", "kph": "kmh",
    "m/s2": "mps2", "m/s^2": "mps2", "m/s²": "mps2", "mps2": "mps2", "g": "g",
    "rad/s": "radps", "radps": "radps", "deg/s": "degps", "°/s": "degps", "degps": "degps",
    "kg": "kg", "t": "t", "pa": "pa", "kpa": "kpa", "bar": "bar",
}  # fmt: skip
# The columns of a log, in their usual order.
COLUMNS = (
    "time_s",
    "steer_rad",
    "steering_wheel_rad",
    "roll_rad",
    "tilt_rad",
    "speed_mps",
    "lateral_acceleration_mps2",
    "yaw_rate_radps",
    "trailer_mass_kg",
    "trailer_axle_load_kg",
    "trailer_suspension_pressure_pa",
)
# Sent now and then, and the same all the drive.
SLOW = COLUMNS[-3:]


class Frame(Protocol):
    """What is needed of a `can.Message`."""

    timestamp: float
    arbitration_id: int
    is_extended_id: bool
    data: bytearray


# The signals of a frame: SI column names to value and rank.
Decode = Callable[[Frame], dict[str, tuple[float, int]]]


class Rows:
    """Puts frames together to rows of a log.

    A frame with the roll angle (or, where there is none, the inclinometer's) makes a row; the
    other signals keep their last value for `hold_s` seconds, what weighs the trailer for ever.
    Where several devices send the same signal, the first is kept while it lives, unless J1939 has
    a better source for it.
    """

    def __init__(
        self,
        dbc: str | os.PathLike[str] | None,
        signals: Mapping[str, str] | None,
        flip: Iterable[str],
        hold_s: float,
        roll_compensated: str = "bit",
    ) -> None:
        """Begin a log."""
        if not hold_s > 0:
            raise ValueError(f"hold_s is {hold_s}: it must be positive")
        if dbc is None and signals:
            raise ValueError("signals names signals of a DBC file: give dbc too")
        self.frames = 0
        self.used = 0
        self._hold_s = hold_s
        _native.decode_j1939(0, b"", roll_compensated)  # refuses an unknown word
        self._decode: Decode = (
            _j1939(flip, roll_compensated) if dbc is None else Dbc(dbc, signals, flip).decode
        )
        self._last: dict[str, tuple[float, float, int, int]] = {}

    def push(self, frame: Frame) -> dict[str, float] | None:
        """Take in a frame; the row that it completes, if it does."""
        self.frames += 1
        values = self._decode(frame)
        if not values:
            return None
        self.used += 1
        now_s, sender = frame.timestamp, frame.arbitration_id
        taken = {
            name
            for name, (value, rank) in values.items()
            if self._take(name, now_s, value, rank, sender)
        }
        trigger = "roll_rad" if self._is_fresh("roll_rad", now_s) else "tilt_rad"
        if trigger not in taken:
            return None
        row = {"time_s": now_s}
        for name, (_, value, _, _) in self._last.items():
            if name in SLOW or self._is_fresh(name, now_s):
                row[name] = value
        if trigger == "roll_rad":
            row.pop("tilt_rad", None)
        return row

    def _take(self, name: str, now_s: float, value: float, rank: int, sender: int) -> bool:
        """Keep a value, unless a sender that is preferred, or was there first, still lives."""
        known = self._last.get(name)
        if known is not None and self._is_fresh(name, now_s):
            _, _, known_rank, known_sender = known
            if sender != known_sender and rank >= known_rank:
                return False
        self._last[name] = (now_s, value, rank, sender)
        return True

    def _is_fresh(self, name: str, now_s: float) -> bool:
        known = self._last.get(name)
        return known is not None and now_s - known[0] <= self._hold_s


def _j1939(flip: Iterable[str], roll_compensated: str) -> Decode:
    # The sign of each signal, by the rules for columns.
    found = _native.resolve_columns(list(COLUMNS), [], flips(flip))
    turned = {name for name, (_, factor) in found.items() if factor < 0}
    # A slope sensor measures the one or the other.
    slope = {"roll_rad", "tilt_rad"}
    turned |= slope if turned & slope else set()

    def decode(frame: Frame) -> dict[str, tuple[float, int]]:
        if not frame.is_extended_id:
            return {}
        values = _native.decode_j1939(frame.arbitration_id, bytes(frame.data), roll_compensated)
        for name in turned & values.keys():
            value, rank = values[name]
            values[name] = -value, rank
        return values

    return decode


#: The most bytes of a DBC file, as in the compiled half.
_LARGEST = 16 << 20


class Dbc:
    """The signals of a DBC file that a log is made of."""

    def __init__(
        self,
        dbc: str | os.PathLike[str],
        signals: Mapping[str, str] | None,
        flip: Iterable[str],
    ) -> None:
        """Find the signals in the file."""
        cantools = need("cantools", "can")
        path = os.fspath(dbc)
        with open(path, "rb") as file:
            if len(file.read(_LARGEST + 1)) > _LARGEST:
                limit = _LARGEST >> 20
                raise ValueError(f"{path}: has more than the {limit} MiB that a DBC file may have")
        try:
            database = cantools.database.load_file(path, strict=False)
        except OSError:
            raise
        except Exception as error:  # cantools has one class of error for each format
            raise ValueError(f"{path}: is no DBC file that cantools reads: {error}") from error
        if not signals:
            raise ValueError(
                f"{path}: say which of its signals are which, such as signals={{'roll': 'Name', "
                f"'steering_wheel': 'Name'}}; it has {_names(database)}"
            )
        # The rules for names, units and signs are those of columns.
        labels, texts = ["time_s"], {}
        places: list[tuple[Any, Any]] = []
        for key, text in signals.items():
            name, unit = split(text)
            message, signal = _find(database, name, path)
            unit = unit or usual_unit(signal.unit)
            if not unit:
                raise ValueError(
                    f"{path}: {name} has the unit {signal.unit!r}: name it, such as "
                    f"{{{key!r}: '{name}[deg]'}}"
                )
            labels.append(name)
            texts[key] = f"{name}[{unit}]"
            places.append((message, signal))
        found = _native.resolve_columns(labels, maps(texts), flips(flip))
        self._by_id: dict[tuple[bool, int], Any] = {}
        self._by_group: dict[int, Any] = {}
        self._columns: dict[tuple[str, str], tuple[str, float]] = {}
        for column, (place, factor) in found.items():
            if column == "time_s":
                continue
            message, signal = places[place - 1]
            self._columns[message.name, signal.name] = (column, factor)
            if message.protocol == "j1939":
                self._by_group[_group(message.frame_id)] = message
            else:
                self._by_id[message.is_extended_frame, message.frame_id] = message

    def decode(self, frame: Frame) -> dict[str, tuple[float, int]]:
        """Return the signals of a frame by their SI column names, all of one rank."""
        identifier, extended = frame.arbitration_id, frame.is_extended_id
        message = self._by_id.get((extended, identifier))
        if message is None and extended and self._by_group:
            message = self._by_group.get(_group(identifier))
        if message is None:
            return {}
        try:
            decoded = message.decode(bytes(frame.data), decode_choices=False, allow_truncated=True)
        except Exception:  # a frame of the same identifier that is not of this form
            return {}
        values = {}
        for signal in message.signals:
            target = self._columns.get((message.name, signal.name))
            value = decoded.get(signal.name)
            if target is None or not isinstance(value, int | float) or not _is_valid(signal, value):
                continue
            values[target[0]] = value * target[1], 0
        return values


def usual_unit(text: str | None) -> str:
    """Return our name of a unit as files write it; nothing if it is none of ours."""
    # A degree sign in UTF-8 that was read as Latin-1 has an Â before it.
    return UNITS.get((text or "").strip().lower().replace("â°", "°").replace("â²", "²"), "")


def split(text: str) -> tuple[str, str]:
    """Return name and unit of ``Name[unit]``; no unit if there are no brackets."""
    name, bracket, unit = text.partition("[")
    return name.strip(), unit.removesuffix("]").strip() if bracket else ""


def _names(database: Any) -> str:
    names = [f"{m.name}.{s.name}" for m in database.messages for s in m.signals]
    more = "" if len(names) <= 20 else f" and {len(names) - 20} more"
    return ", ".join(names[:20]) + more


def _find(database: Any, name: str, path: str) -> tuple[Any, Any]:
    where, dot, bare = name.rpartition(".")
    found = [
        (message, signal)
        for message in database.messages
        if not dot or message.name == where
        for signal in message.signals
        if signal.name == bare
    ]
    if not found:
        raise ValueError(f"{path}: has no signal {name}; it has {_names(database)}")
    if len(found) > 1:
        both = ", ".join(f"{message.name}.{signal.name}" for message, signal in found)
        raise ValueError(f"{path}: {name} is in several messages: give one of {both}")
    return found[0]


def _is_valid(signal: Any, value: float) -> bool:
    """Whether a value is one: beyond the file's range stands "not available" or "error"."""
    low, high = signal.minimum, signal.maximum
    if low is None or high is None or not low < high:
        return True
    return bool(low <= value <= high)


def _group(identifier: int) -> int:
    """Return the parameter group of a 29-bit identifier."""
    j1939 = need("cantools", "can").j1939
    parts = j1939.frame_id_unpack(identifier)
    specific = 0 if parts.pdu_format < 240 else parts.pdu_specific
    group: int = j1939.pgn_pack(parts.reserved, parts.data_page, parts.pdu_format, specific)
    return group
