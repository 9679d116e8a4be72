"""CAN logs and a live CAN bus.

Frames are decoded and their signals are aligned in the same way as in `cg run`. The signals are
those of J1939 (steering wheel, yaw rate and lateral acceleration from VDC2 or SAS, roll angle from
SSI2 or SSI, speed from CCVS1 or EBC2, trailer mass from VW, axle load from EBS22), or signals of a
DBC file in their place. This module needs ``pip install 'cgheight[can]'``.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any, Unpack

from cgheight import _native
from cgheight._estimate import EstimatorOptions, calibrated, stream_options
from cgheight._extras import need
from cgheight._frames import (
    CAN_SUFFIXES,
    framed,
    is_can,
    read_frames,
    reading,
    suffix,
)
from cgheight._logs import prepared
from cgheight._results import Estimate
from cgheight._tables import read_channels

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
    roll_compensated: str = "bit",
    vdc2: str = "specific-force",
    bus: str | int | None = None,
) -> pd.DataFrame:
    """Read a CAN log into a table that `estimate_log` takes.

    Each roll angle gives a row (or each angle of the inclinometer, if there is no roll angle). The
    other signals are interpolated to its time, or held for a short time, as in `cg run`.

    Parameters
    ----------
    path : str or os.PathLike
        ``.log`` (candump), ``.asc``, ``.blf``, ``.trc``, or ``.mf4`` with CAN frames. With
        `signals` but without `dbc`, an ``.mf4`` file with measured channels.
    dbc : str or os.PathLike, optional
        A DBC file that describes signals that are not in J1939.
    signals : dict of str to str, optional
        For `dbc` or measured channels: the name in the file for each signal of the log, such as
        ``{"roll": "RollAngle", "steering_wheel": "EBC1.Angle[deg]"}``. These replace the J1939
        signals of the same quantity. The signals are those of `cgheight.SIGNALS` without their
        units. A unit in brackets overrides that of the file. With a DBC file, a factor and an
        offset may follow (``"TILT.Angle[deg]*-1+0.3"``).
    flip : iterable of str
        Signals whose sign is reversed, for sensors that are mounted the other way round.
    roll_compensated : {"bit", "inverted-bit", "yes", "no"}
        Whether the J1939 slope sensors (SSI, SSI2) compensate their angle for the accelerations of
        the vehicle. A compensated angle is a roll angle, an uncompensated one is a tilt. "bit":
        according to the compensation bits, 0 on, 1 off; without valid bits the angle is not
        compensated. "inverted-bit": the bits with inverted meaning, 0 off, 1 on. "yes", "no": the
        bits are ignored.
    vdc2 : {"specific-force", "acceleration"}
        What the lateral acceleration of the J1939 group VDC2 is: the specific force of the tractor,
        gravity included, or the acceleration of the path, if the device compensates gravity.
    bus : str or int, optional
        The only bus whose frames are used, by its name or number in the file. Without it, each
        signal is taken from the bus on which it appears first, and ``attrs["remarks"]`` names them.

    Returns
    -------
    pandas.DataFrame
        ``time_s``, the time stamps of the log in s, and the signals found, in columns with SI
        names; NaN where a value is absent. ``attrs["remarks"]`` lists doubtful values and frames.
        The yaw rate of J1939 is that of the tractor, and the column ``yaw_rate_on_tractor`` says
        so.

    Raises
    ------
    FileNotFoundError
        There is no such file.
    ValueError
        The file has an unknown format, is damaged or contains no roll angle, or a name, a unit or
        the bus is unknown.
    ImportError
        python-can, or for ``.mf4`` asammdf, is not installed.
    """
    name = os.fspath(path)
    pandas = need("pandas", "can")
    if not is_can(name):
        known = ", ".join(CAN_SUFFIXES)
        raise ValueError(f"{name}: is not a CAN log by its name; give a file that ends in {known}")
    if not os.path.exists(name):
        raise FileNotFoundError(f"{name}: cannot be read (there is no such file)")
    if suffix(name) == ".mf4" and dbc is None and signals:
        table, remarks = prepared(read_channels(name, signals, flip))
    else:
        table, remarks = read_frames(name, reading(dbc, signals, flip, roll_compensated, vdc2, bus))
    frame = pandas.DataFrame(table)
    frame.attrs = {"remarks": remarks}
    return frame


class HeightListener(can.Listener):  # type: ignore[misc,name-defined]  # imported by `need`
    """Estimates the height from a live bus; attach it to a `can.Notifier`.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    on_estimate : callable, optional
        Called with an `Estimate` at the end of each turn, in the thread of the notifier.
    dbc, signals, flip, roll_compensated, vdc2
        As for `read_log`.
    **options
        Keywords of `Estimator` except ``learned``: ``calibration``, ``speed_mps``,
        ``trailer_mass_kg``, ``method``, ``channel``, ``model``.

    Attributes
    ----------
    frames, frames_used, rows : int
        Number of frames received, of frames with a value that is used, and of rows made from them.

    Raises
    ------
    FileNotFoundError
        There is no such DBC or calibration file.
    ValueError
        An option is out of range, or the DBC file does not contain a signal.
    TypeError
        There is no such keyword.

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
        roll_compensated: str = "bit",
        vdc2: str = "specific-force",
        **options: Unpack[EstimatorOptions],
    ) -> None:
        """Start a drive."""
        super().__init__()
        self._stream = _native.FrameStream(
            calibrated(vehicle, options.get("calibration")),
            reading(dbc, signals, flip, roll_compensated, vdc2),
            stream_options(options),
        )
        self._frame = framed()
        self._on_estimate = on_estimate

    @property
    def frames(self) -> int:
        """Number of frames received."""
        return self._stream.counts[0]

    @property
    def frames_used(self) -> int:
        """Number of frames with a value that is used."""
        return self._stream.counts[1]

    @property
    def rows(self) -> int:
        """Number of rows made from the frames."""
        return self._stream.counts[2]

    def on_message_received(self, msg: Any) -> None:
        """Process a frame; python-can calls this method."""
        frame = self._frame(msg)
        if frame is None:
            return
        if self._stream.push(*frame) and self._on_estimate is not None:
            self._on_estimate(self.estimate())

    def estimate(self) -> Estimate:
        """Return the estimate so far.

        Returns
        -------
        Estimate
            Its status is "rejected" until a maneuver has given a height.
        """
        return self._stream.estimate()
