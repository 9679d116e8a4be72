"""Estimates from arrays, from logs, and row by row."""

from __future__ import annotations

import operator
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal, Self, TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cgheight import _native
from cgheight._arrays import column, number
from cgheight._clock import is_clock, seconds
from cgheight._columns import flips, maps
from cgheight._frames import estimate_frames, is_can
from cgheight._logs import log_table, prepared, refuse_columns
from cgheight._results import Estimate
from cgheight._tables import is_table


def calibrated(
    vehicle: _native.Vehicle, calibration: str | os.PathLike[str] | None
) -> _native.Vehicle:
    return vehicle if calibration is None else vehicle.calibrated(calibration)


@dataclass(frozen=True, slots=True)
class Arx:
    """The method "arx" with an order other than 5.

    Attributes
    ----------
    order : int
        Order of the classical ARX model, 1 to 10.
    """

    order: int = 5


Method = Literal["filtered", "arx", "gain"] | Arx
ChannelName = Literal["auto", "steer", "lateral-acceleration", "suspension", "tractor"]
ModelName = Literal["complete", "as-printed"]


def shared_options(
    method: Method,
    channel: str,
    model: str,
    speed_mps: object = None,
    trailer_mass_kg: object = None,
) -> dict[str, Any]:
    """Return the options of all estimates in the form of the compiled module."""
    pair = trailer_mass_kg if isinstance(trailer_mass_kg, tuple) else (trailer_mass_kg, None)
    if len(pair) != 2:
        raise ValueError(f"trailer_mass_kg {pair!r}: expected a mass or (mass, standard deviation)")
    (mass, mass_sd), speed = pair, speed_mps
    return {
        "method": "arx" if isinstance(method, Arx) else method,
        "channel": channel,
        "order": operator.index((method if isinstance(method, Arx) else Arx()).order),
        "model": model,
        "speed_mps": None if speed is None else number("speed_mps", speed),
        "trailer_mass_kg": None if mass is None else number("trailer_mass_kg", mass),
        "trailer_mass_sd_kg": None if mass_sd is None else number("trailer_mass_kg", mass_sd),
    }


def estimate(
    time_s: ArrayLike,
    steer_rad: ArrayLike | None,
    roll_rad: ArrayLike | None,
    *,
    vehicle: _native.Vehicle,
    calibration: str | os.PathLike[str] | None = None,
    method: Method = "filtered",
    channel: ChannelName = "auto",
    model: ModelName = "complete",
    **signals: ArrayLike | None,
) -> Estimate:
    """Estimate the height of the trailer's c.g. from arrays.

    One-dimensional contiguous float64 arrays are read in place; anything else that contains
    numbers is copied once. All arrays must have the same length. NaN marks an absent value. Signs
    are those of ISO 8855 (all values are positive in a left turn).

    Parameters
    ----------
    time_s : array, shape (n,)
        Time stamps from any origin, s, strictly increasing.
    steer_rad : array, shape (n,), or None
        Mean road-wheel angle, rad.
    roll_rad : array, shape (n,), or None
        Roll angle of the trailer's sprung mass relative to the road, rad.
    vehicle : Vehicle
        The vehicle.
    calibration : str or os.PathLike, optional
        A calibration file of this vehicle. For many logs, it is faster to call
        `vehicle.calibrated(path)` once.
    method : {"filtered", "arx", "gain"} or Arx
        Identification: ARX on filtered signals, classical ARX (`Arx` sets its order), or the gain
        only.
    channel : {"auto", "steer", "lateral-acceleration", "suspension", "tractor"}
        The pair of signals: roll angle by steer angle or by lateral acceleration, suspension roll
        by specific force of the trailer or of the tractor; "auto" combines all, weighted by their
        uncertainty.
    model : {"complete", "as-printed"}
        Equations of the vehicle.
    **signals : array, shape (n,), optional
        The other signals of `cgheight.SIGNALS`: ``lateral_acceleration_mps2``,
        ``yaw_rate_radps``, …. ``speed_mps`` (m/s), ``trailer_mass_kg`` (the whole semitrailer as
        weighed, kg) and ``trailer_mass_sd_kg`` may be one number for all rows, and the mass a pair
        with its standard deviation; if absent, they are taken from the vehicle.

    Returns
    -------
    Estimate
        Its status is "rejected", with a reason, if the data give no height.

    Raises
    ------
    ValueError
        An array is not one-dimensional, has a different length than `time_s` or contains infinity;
        the time is NaN or does not increase (the message gives the index); an option is out of
        range.
    TypeError
        There is no such signal.
    FileNotFoundError
        There is no such calibration file.
    """
    scalars: dict[str, object] = {"speed_mps": None}
    given: dict[str, Any] = {"time_s": time_s, "steer_rad": steer_rad, "roll_rad": roll_rad}
    given |= signals
    scalars["trailer_mass_kg"] = _one_mass(given)
    speed = given.get("speed_mps")
    if speed is not None and np.ndim(speed) == 0:
        scalars["speed_mps"], given["speed_mps"] = speed, None
    if is_clock(time_s):
        given["time_s"] = seconds("time_s", time_s)
    arrays = {name: column(name, values) for name, values in given.items() if values is not None}
    options = shared_options(method, channel, model, **scalars)
    return estimate_table(calibrated(vehicle, calibration), arrays, options)


def _one_mass(signals: dict[str, Any]) -> object:
    """Take the mass of all rows, or its pair with the standard deviation, out of the signals.

    If one of both is an array, the other one becomes an array of the same number.
    """
    mass, sd = signals.get("trailer_mass_kg"), signals.get("trailer_mass_sd_kg")
    if isinstance(mass, tuple) and sd is not None:
        raise ValueError(
            "trailer_mass_kg is a pair with a standard deviation, and trailer_mass_sd_kg is given "
            "too: give one of them"
        )
    one_mass = mass is not None and (isinstance(mass, tuple) or np.ndim(mass) == 0)
    one_sd = sd is not None and np.ndim(sd) == 0
    if one_mass and (sd is None or one_sd):
        signals["trailer_mass_kg"] = signals["trailer_mass_sd_kg"] = None
        return mass if sd is None else (mass, sd)
    rows = np.size(signals["time_s"])
    if one_mass:
        signals["trailer_mass_kg"] = np.full(rows, number("trailer_mass_kg", mass))
    if one_sd:
        signals["trailer_mass_sd_kg"] = np.full(rows, number("trailer_mass_sd_kg", sd))
    return None


def estimate_table(
    vehicle: _native.Vehicle, arrays: dict[str, NDArray[np.float64]], options: dict[str, Any]
) -> Estimate:
    """Estimate from the signals of a table, with the remarks about its preparation."""
    arrays, remarks = prepared(arrays, vehicle)
    answer = _native.estimate_arrays(vehicle, arrays, options)
    return replace(answer, messages=(*answer.messages, *remarks)) if remarks else answer


def estimate_log(
    log: str | os.PathLike[str] | Any,
    *,
    vehicle: _native.Vehicle,
    columns: Mapping[str, str] | None = None,
    flip: Iterable[str] = (),
    speed_mps: float | None = None,
    trailer_mass_kg: float | tuple[float, float] | None = None,
    calibration: str | os.PathLike[str] | None = None,
    method: Method = "filtered",
    channel: ChannelName = "auto",
    model: ModelName = "complete",
) -> Estimate:
    """Estimate the height of the trailer's c.g. from a log.

    Columns are found by the names in `cgheight.SIGNALS`. Required are ``time_s``, a roll angle
    (``roll_rad``, ``roll_to_gravity_rad`` or ``tilt_rad``) and an input (``steer_rad``,
    ``steering_wheel_rad``, ``lateral_acceleration_mps2`` or ``yaw_rate_radps``), or a suspension
    roll and a specific force of the same unit; all other columns are optional. The suffix
    gives the unit, which may also be ``_deg``, ``_degps``, ``_kmh``, ``_g``, ``_ms``, ``_t``,
    ``_bar``, …. The same rules apply to files and data frames. A CAN log is read in the same way as
    in `cg run`; if it needs a DBC file, read it with `cgheight.can.read_log` first.

    Parameters
    ----------
    log : str, os.PathLike, or data frame
        A file: ``.csv``, ``.csv.gz``, ``.parquet``, ``.feather``, ``.mat``, channels in ``.mf4``,
        or
        J1939 frames in ``.log`` (candump), ``.asc``, ``.blf``, ``.mf4``, ``.trc``; or anything with
        ``columns`` and ``__getitem__`` such as a data frame of pandas or polars; or a dict of
        arrays. The time may be points in time, also as the index of a data frame.
    vehicle : Vehicle
        The vehicle.
    columns : dict, optional
        Other column names: the column and its unit for each signal, such as
        ``{"roll": "MyName[deg]"}``.
    flip : iterable of str
        Signals whose sign is reversed, such as ``("roll",)``, for sensors that are mounted the
        other way round.
    speed_mps, trailer_mass_kg : float, optional
        Speed (m/s) and mass of the whole semitrailer (kg), which override those of the log. A mass
        may be given with its standard deviation, ``(25_000.0, 500.0)``; its effect is part of the
        interval. Without any mass, the interval contains any load.
    calibration, method, channel, model
        As for `estimate`.

    Returns
    -------
    Estimate
        Its status is "rejected", with a reason, if the log gives no height.

    Raises
    ------
    FileNotFoundError
        There is no such file, or no such calibration file.
    ValueError
        The log is not as described; the message gives the line (or row), the column and a remedy.
    ImportError
        The package that reads the format is not installed: python-can for ``.blf`` and ``.trc``,
        asammdf for ``.mf4``, scipy or h5py for ``.mat``, pyarrow for ``.feather``.
    """
    options = shared_options(method, channel, model, speed_mps, trailer_mass_kg)
    vehicle = calibrated(vehicle, calibration)
    if not isinstance(log, str | os.PathLike) or is_table(log, columns):
        return estimate_table(vehicle, log_table(log, columns, flip), options)
    if is_can(log):
        refuse_columns(columns)
        return estimate_frames(log, vehicle, flips(flip), options)
    return _native.estimate_file(vehicle, os.fspath(log), maps(columns), flips(flip), options)


class EstimatorOptions(TypedDict, total=False):
    """The keywords of `Estimator`, except `learned`."""

    speed_mps: float | None
    trailer_mass_kg: float | tuple[float, float] | None
    calibration: str | os.PathLike[str] | None
    method: Method
    channel: ChannelName
    model: ModelName


def stream_options(options: EstimatorOptions) -> dict[str, Any]:
    """Return the keywords of `Estimator` in the form of the compiled module."""
    known = EstimatorOptions.__annotations__
    unknown = [name for name in options if name not in known]
    if unknown:
        raise TypeError(f"there is no keyword {', '.join(unknown)}; there are {', '.join(known)}")
    return shared_options(
        options.get("method", "filtered"),
        options.get("channel", "auto"),
        options.get("model", "complete"),
        options.get("speed_mps"),
        options.get("trailer_mass_kg"),
    )


def _restored(kind: type[Estimator], version: str, parts: tuple[Any, ...]) -> Estimator:
    """Return an estimator in the state in which it was copied or pickled."""
    if version != _native.__version__:
        raise ValueError(
            f"this Estimator was pickled by cgheight {version}, and this is {_native.__version__}, "
            "whose state is another one: push its rows to a new Estimator"
        )
    return _native.Stream.__new__(kind, *parts)


class Estimator(_native.Stream):
    """Estimator that processes one row at a time and gives its estimate at any time.

    It can be used from several threads, but the rows must come in the order of time. A copy
    (`copy.copy`, `copy.deepcopy`) or a pickle goes on to the last bit as the original would; a
    pickle can be read by the version that wrote it.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    speed_mps, trailer_mass_kg : float, optional
        Speed (m/s) and mass of the whole semitrailer (kg), which override those of the rows; the
        mass may be a pair with its standard deviation.
    calibration, method, channel, model
        As for `estimate`.
    learned : str, optional
        What the truck has learned from its earlier trips with the empty trailer: the text that
        `learned` of another `Estimator` returned. Then ``time_s`` of all rows must be Unix time,
        because older trips count for less. With a calibration the trips move what it says; those
        that it contains do not count again.

    Raises
    ------
    ValueError
        An option is out of range; or `learned` is not such a text.
    FileNotFoundError
        There is no such calibration file.
    """

    def __new__(
        cls,
        vehicle: _native.Vehicle,
        *,
        speed_mps: float | None = None,
        trailer_mass_kg: float | tuple[float, float] | None = None,
        calibration: str | os.PathLike[str] | None = None,
        method: Method = "filtered",
        channel: ChannelName = "auto",
        model: ModelName = "complete",
        learned: str | None = None,
    ) -> Self:
        """Start a log."""
        options = shared_options(method, channel, model, speed_mps, trailer_mass_kg)
        return super().__new__(cls, calibrated(vehicle, calibration), options, learned)

    def __reduce__(self) -> tuple[Any, ...]:
        """Return what restores it: its vehicle, options and state."""
        return _restored, (type(self), _native.__version__, self._parts()), self.__dict__ or None
