"""CAN logs and a live CAN bus.

Frames are decoded and their signals aligned as by `cg run`: J1939 (steering wheel, yaw rate and
lateral acceleration of VDC2 or SAS, roll angle of SSI2 or SSI, speed of CCVS1 or EBC2, trailer mass
of VW, axle load of EBS22), or signals of a DBC file in their place. Needs
``pip install 'cgheight[can]'``.
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
    read_channels,
    read_frames,
    reading,
    suffix,
)
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
    roll_compensated: str = "bit",
) -> pd.DataFrame:
    """Read a CAN log into a table that `estimate_log` takes.

    Each roll angle makes a row (where there is none, each angle of the inclinometer); the other
    signals are interpolated to its time, or held for a moment, as `cg run` does.

    Parameters
    ----------
    path : str or os.PathLike
        ``.log`` (candump), ``.asc``, ``.blf``, ``.trc``, or ``.mf4`` with CAN frames; without `dbc`
        but with `signals` also ``.mf4`` with measured channels.
    dbc : str or os.PathLike, optional
        A DBC file with signals that are not J1939's.
    signals : dict of str to str, optional
        With `dbc` or measured channels: signal of the log to name in the file, such as
        ``{"roll": "RollAngle", "steering_wheel": "EBC1.Angle[deg]"}``, in place of what J1939 has
        of it. Signals are those of `cgheight.SIGNALS` without their units. A unit in brackets
        overrides the file's; for a DBC file a factor and an offset may follow
        (``"TILT.Angle[deg]*-1+0.3"``).
    flip : iterable of str
        Signals whose sensor is mounted the other way round.
    roll_compensated : {"bit", "inverted-bit", "yes", "no"}
        Whether J1939's slope sensors (SSI, SSI2) take the vehicle's accelerations off their angle,
        which is a roll angle then and a tilt otherwise: as their bits say (0 on, 1 off; one that
        does not say does not), the same with 0 off and 1 on, always, or never.

    Returns
    -------
    pandas.DataFrame
        ``time_s``, the log's time stamps, s, and the signals found, in columns with SI names; NaN
        where a value is absent. ``attrs["remarks"]`` lists what was doubted.

    Raises
    ------
    FileNotFoundError
        There is no such file.
    ValueError
        The file is of no known kind or damaged, holds no roll angle, or a name or unit is unknown.
    ImportError
        python-can, or for ``.mf4`` asammdf, is not installed.
    """
    name = os.fspath(path)
    pandas = need("pandas", "can")
    if not is_can(name):
        known = ", ".join(CAN_SUFFIXES)
        raise ValueError(f"{name}: is no CAN log by its name; those end in {known}")
    if not os.path.exists(name):
        raise FileNotFoundError(f"{name}: cannot be read (there is no such file)")
    if suffix(name) == ".mf4" and dbc is None and signals:
        return pandas.DataFrame(read_channels(name, signals, flip))
    table, remarks = read_frames(name, reading(dbc, signals, flip, roll_compensated))
    frame = pandas.DataFrame(table)
    frame.attrs = {"remarks": remarks}
    return frame


class HeightListener(can.Listener):  # type: ignore[misc,name-defined]  # imported by `need`
    """Estimates from a live bus: attach it to a `can.Notifier`.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    on_estimate : callable, optional
        Called with an `Estimate` whenever a turn has ended, in the notifier's thread.
    dbc, signals, flip, roll_compensated
        As for `read_log`.
    **options
        Keywords of `Estimator`: ``calibration``, ``speed_mps``, ``trailer_mass_kg``, ….

    Attributes
    ----------
    frames, frames_used, rows : int
        Frames seen; those with a value that counts; rows made of them.

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
        roll_compensated: str = "bit",
        **options: Unpack[EstimatorOptions],
    ) -> None:
        """Begin a drive."""
        super().__init__()
        self._stream = _native.FrameStream(
            calibrated(vehicle, options.get("calibration")),
            reading(dbc, signals, flip, roll_compensated),
            stream_options(options),
        )
        self._frame = framed()
        self._on_estimate = on_estimate

    @property
    def frames(self) -> int:
        """Frames seen."""
        return self._stream.counts[0]

    @property
    def frames_used(self) -> int:
        """Frames with a value that counts."""
        return self._stream.counts[1]

    @property
    def rows(self) -> int:
        """Rows made of them."""
        return self._stream.counts[2]

    def on_message_received(self, msg: Any) -> None:
        """Take in a frame; python-can calls it."""
        frame = self._frame(msg)
        if frame is None:
            return
        if self._stream.push(*frame) and self._on_estimate is not None:
            self._on_estimate(self.estimate())

    def estimate(self) -> Estimate:
        """Return the answer so far.

        Returns
        -------
        Estimate
            With status "rejected" as long as no maneuver gave a height.
        """
        return self._stream.estimate()
