"""CAN logs and a live CAN bus.

Frames are decoded by J1939 (steering wheel, yaw rate and lateral acceleration of VDC2 or SAS, roll
angle of SSI2 or SSI, speed of CCVS1 or EBC2, trailer mass of VW), or by a DBC file. Needs
``pip install 'cgheight[can]'``.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

import numpy as np

from cgheight import _native
from cgheight._estimate import Estimator
from cgheight._extras import need
from cgheight._frames import COLUMNS, SLOW, Rows, split, usual_unit
from cgheight._logs import CAN_SUFFIXES, table_signals
from cgheight._results import Estimate

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["HeightListener", "read_log"]

can = need("can", "can")


def read_log(
    path: str | os.PathLike[str],
    *,
    dbc: str | os.PathLike[str] | None = None,
    signals: Mapping[str, str] | None = None,
    flip: Iterable[str] = (),
    hold_s: float = 1.0,
    roll_compensated: str = "bit",
) -> pd.DataFrame:
    """Read a CAN log into a table that `estimate_log` takes.

    Each frame with the roll angle makes a row (where there is none, each frame with the
    inclinometer's); the other signals keep their last value.

    Parameters
    ----------
    path : str or os.PathLike
        ``.log`` (candump), ``.asc``, ``.blf``, ``.trc``, or ``.mf4`` with CAN frames; without `dbc`
        but with `signals` also ``.mf4`` with measured channels.
    dbc : str or os.PathLike, optional
        The file that says what the frames hold; J1939's standard groups if absent.
    signals : dict of str to str, optional
        With `dbc` or measured channels: signal of the log to name in the file, such as
        ``{"roll": "RollAngle", "steering_wheel": "EBC1.Angle[deg]"}``. Signals are ``steer``,
        ``steering_wheel``, ``roll``, ``tilt``, ``speed``, ``lateral_acceleration``, ``yaw_rate``,
        ``trailer_mass``, ``trailer_axle_load``, ``trailer_suspension_pressure``; a unit in brackets
        overrides the file's.
    flip : iterable of str
        Signals whose sensor is mounted the other way round.
    hold_s : float
        How long a signal keeps its last value, s.
    roll_compensated : {"bit", "inverted-bit", "yes", "no"}
        Whether J1939's slope sensors (SSI, SSI2) take the vehicle's accelerations off their angle,
        which is a roll angle then and a tilt otherwise: as their bits say (0 on, 1 off; one that
        does not say does not), the same with 0 off and 1 on, always, or never.

    Returns
    -------
    pandas.DataFrame
        ``time_s`` from the first frame on, s, and the signals found, in columns with SI names; NaN
        where a value is absent. ``attrs`` counts ``frames``, ``frames_used`` and
        ``rows_out_of_order`` (left out).

    Raises
    ------
    FileNotFoundError
        There is no such file.
    ValueError
        The file is of no known kind or damaged, holds no roll angle, or a name or unit is unknown.
    ImportError
        python-can, or for ``.mf4`` asammdf, for `dbc` cantools, is not installed.
    """
    name, suffix = os.fspath(path), PurePath(path).suffix.lower()
    pandas = need("pandas", "can")
    if suffix not in CAN_SUFFIXES:
        known = ", ".join(CAN_SUFFIXES)
        raise ValueError(f"{name}: is no CAN log by its name; those end in {known}")
    if not os.path.exists(name):
        raise FileNotFoundError(f"{name}: cannot be read (there is no such file)")
    if suffix == ".mf4":
        need("asammdf", "can")
        if dbc is None and signals:
            return pandas.DataFrame(_channels(name, signals, flip))
    rows = Rows(dbc, signals, flip, hold_s, roll_compensated)
    table: dict[str, list[float]] = {}
    counted = _read(name, rows, table)
    if not table:
        raise ValueError(
            f"{name}: none of its {rows.frames} frames completes a row: a roll angle is needed "
            "(J1939 SSI2 or SSI); for other frames give dbc and signals"
        )
    frame = pandas.DataFrame({key: table[key] for key in COLUMNS if key in table})
    # The trailer was as heavy before its first message as after.
    for weight in frame.columns.intersection(SLOW):
        frame[weight] = frame[weight].bfill()
    frame.attrs = {"frames": rows.frames, "frames_used": rows.used, "rows_out_of_order": counted}
    return frame


def _read(name: str, rows: Rows, table: dict[str, list[float]]) -> int:
    """Fill `table` with the rows of a file; return how many did not follow the one before."""
    origin_s, previous_s, length, disordered = np.nan, -np.inf, 0, 0
    try:
        with can.LogReader(name) as reader:
            for message in reader:
                if origin_s != origin_s:
                    origin_s = message.timestamp
                if message.is_error_frame or message.is_remote_frame:
                    continue
                row = rows.push(message)
                if row is None:
                    continue
                row["time_s"] -= origin_s
                if row["time_s"] <= previous_s:
                    disordered += 1
                    continue
                previous_s = row["time_s"]
                for key in row.keys() - table.keys():
                    table[key] = [np.nan] * length
                for key, values in table.items():
                    values.append(row.get(key, np.nan))
                length += 1
    except OSError:
        raise
    except Exception as error:  # each reader of python-can has its own kinds
        raise ValueError(
            f"{name}, after {rows.frames} frames: cannot be read as what its name says: {error}"
        ) from error
    return disordered


def _channels(
    name: str, signals: Mapping[str, str], flip: Iterable[str]
) -> dict[str, np.ndarray[Any, np.dtype[np.float64]]]:
    """Read measured channels of an MDF file, at the times of the roll angle."""
    master = signals.get("roll", signals.get("tilt"))
    if master is None:
        raise ValueError("signals names no roll angle: give 'roll' or 'tilt'")
    table: dict[str, Any] = {}
    texts: dict[str, str] = {}
    with need("asammdf", "can").MDF(name) as file:
        known = set(file.channels_db)
        channels = {}
        for key, text in signals.items():
            channel, unit = split(text)
            if channel not in known:
                raise ValueError(f"{name}: has no channel {channel}; it has {_some(known)}")
            channels[key] = file.get(channel)
            texts[key] = f"{channel}[{unit or _unit(channels[key].unit, channel, name)}]"
        times_s = channels["roll" if "roll" in signals else "tilt"].timestamps
        table["time_s"] = times_s - times_s[0]
        for channel in channels.values():
            before = np.searchsorted(channel.timestamps, times_s, side="right") - 1
            values = np.asarray(channel.samples, dtype=np.float64)
            table[channel.name] = np.where(before < 0, np.nan, values[before])
    return table_signals(table, [f"{key}={text}" for key, text in texts.items()], list(flip))


def _some(names: set[str]) -> str:
    more = "" if len(names) <= 20 else f" and {len(names) - 20} more"
    return ", ".join(sorted(names)[:20]) + more


def _unit(text: str, channel: str, name: str) -> str:
    unit = usual_unit(text)
    if not unit:
        raise ValueError(f"{name}: {channel} has the unit {text!r}: name it, as '{channel}[deg]'")
    return unit


class HeightListener(can.Listener):  # type: ignore[misc,name-defined]  # imported by `need`
    """Estimates from a live bus: attach it to a `can.Notifier`.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    on_estimate : callable, optional
        Called with an `Estimate` whenever a turn has ended, in the notifier's thread.
    dbc, signals, flip, hold_s, roll_compensated
        As for `read_log`.
    **options
        Keywords of `Estimator`: ``calibration``, ``speed_mps``, ``trailer_mass_kg``, ….

    Attributes
    ----------
    frames, frames_used, rows, rows_out_of_order : int
        Frames seen; those with a signal of ours; rows made of them; rows left out because their
        time did not follow the row before.

    Raises
    ------
    FileNotFoundError
        There is no such DBC or calibration file.
    ValueError
        An option is out of range, or the DBC file has no such signal.

    Examples
    --------
    >>> import can, cgheight
    >>> from cgheight.can import HeightListener
    >>> truck = cgheight.Vehicle.load("fixtures/vehicles/kraz.toml")
    >>> listener = HeightListener(truck, on_estimate=print)
    >>> with can.Bus("demo", interface="virtual") as bus, can.Notifier(bus, [listener]):
    ...     pass  # drive
    >>> listener.estimate().status
    'rejected'
    """

    def __init__(
        self,
        vehicle: _native.Vehicle,
        *,
        on_estimate: Callable[[Estimate], object] | None = None,
        dbc: str | os.PathLike[str] | None = None,
        signals: Mapping[str, str] | None = None,
        flip: Iterable[str] = (),
        hold_s: float = 1.0,
        roll_compensated: str = "bit",
        **options: Any,
    ) -> None:
        """Begin a drive."""
        super().__init__()
        self._rows = Rows(dbc, signals, flip, hold_s, roll_compensated)
        self._estimator = Estimator(vehicle, **options)
        self._on_estimate = on_estimate
        self._previous_s = -np.inf
        self._turning = False
        self.rows = 0
        self.rows_out_of_order = 0

    @property
    def frames(self) -> int:
        """Frames seen."""
        return self._rows.frames

    @property
    def frames_used(self) -> int:
        """Frames with a signal of ours."""
        return self._rows.used

    def on_message_received(self, msg: Any) -> None:
        """Take in a frame; python-can calls it."""
        if msg.is_error_frame or msg.is_remote_frame:
            return
        row = self._rows.push(msg)
        if row is None:
            return
        # A microsecond is the resolution of time.
        if row["time_s"] < self._previous_s + 1e-6:
            self.rows_out_of_order += 1
            return
        self._previous_s = row["time_s"]
        self.rows += 1
        was_turning = self._turning
        self._turning = self._estimator.push(**row) == "turning"
        if was_turning and not self._turning and self._on_estimate is not None:
            self._on_estimate(self.estimate())

    def estimate(self) -> Estimate:
        """Return the answer so far.

        Returns
        -------
        Estimate
            With status "rejected" as long as no maneuver gave a height.
        """
        return self._estimator.estimate()
