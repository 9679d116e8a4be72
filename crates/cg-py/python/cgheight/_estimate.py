"""Estimates: from arrays, from logs, row by row."""

from __future__ import annotations

import operator
import os
from collections.abc import Iterable, Mapping
from typing import Any, Literal, Self

import numpy as np
from numpy.typing import ArrayLike

from cgheight import _native
from cgheight._arrays import column, number
from cgheight._logs import flips, is_can, maps, signals
from cgheight._results import Estimate


def _calibrated(
    vehicle: _native.Vehicle, calibration: str | os.PathLike[str] | None
) -> _native.Vehicle:
    return vehicle if calibration is None else vehicle.calibrated(calibration)


def _options(
    method: str,
    channel: str,
    order: int,
    model: str,
    speed_mps: object = None,
    trailer_mass_kg: object = None,
) -> dict[str, Any]:
    mass, speed = trailer_mass_kg, speed_mps
    return {
        "method": method,
        "channel": channel,
        "order": operator.index(order),
        "model": model,
        "speed_mps": None if speed is None else number("speed_mps", speed),
        "trailer_mass_kg": None if mass is None else number("trailer_mass_kg", mass),
    }


def estimate(
    time_s: ArrayLike,
    steer_rad: ArrayLike | None,
    roll_rad: ArrayLike | None,
    *,
    speed_mps: ArrayLike | None = None,
    lateral_acceleration_mps2: ArrayLike | None = None,
    yaw_rate_radps: ArrayLike | None = None,
    trailer_mass_kg: ArrayLike | None = None,
    steering_wheel_rad: ArrayLike | None = None,
    tilt_rad: ArrayLike | None = None,
    trailer_axle_load_kg: ArrayLike | None = None,
    trailer_suspension_pressure_pa: ArrayLike | None = None,
    vehicle: _native.Vehicle,
    calibration: str | os.PathLike[str] | None = None,
    method: Literal["filtered", "arx", "gain"] = "filtered",
    channel: Literal["auto", "steer", "lateral-acceleration"] = "auto",
    order: int = 5,
    model: Literal["complete", "as-printed"] = "complete",
) -> Estimate:
    """Estimate the height of the trailer's c.g. from arrays.

    One-dimensional contiguous float64 arrays are read in place; anything else that holds
    numbers is copied once. All have one length; NaN stands for an absent value. Signs are those
    of ISO 8855 (a left turn gives all positive).

    Parameters
    ----------
    time_s : array, shape (n,)
        Time stamps from any origin, s, strictly increasing.
    steer_rad : array, shape (n,), or None
        Mean road-wheel angle, rad.
    roll_rad : array, shape (n,), or None
        Roll angle of the trailer's sprung mass to the road, rad.
    speed_mps : float or array, shape (n,), optional
        Forward speed, m/s; the vehicle's nominal speed if absent.
    lateral_acceleration_mps2 : array, shape (n,), optional
        Lateral acceleration of the trailer, m/s².
    yaw_rate_radps : array, shape (n,), optional
        Yaw rate of the trailer, rad/s; stands in for an absent lateral acceleration.
    trailer_mass_kg : float or array, shape (n,), optional
        Mass of the whole semitrailer as weighed, kg; the vehicle's reference if absent.
    steering_wheel_rad : array, shape (n,), optional
        Steering-wheel angle, rad; used where `steer_rad` is absent.
    tilt_rad : array, shape (n,), optional
        What an accelerometer inclinometer shows, rad; used where `roll_rad` is absent.
    trailer_axle_load_kg : array, shape (n,), optional
        Load of the trailer's axles on the road, kg; used where `trailer_mass_kg` is absent.
    trailer_suspension_pressure_pa : array, shape (n,), optional
        Pressure in the trailer's air suspension, mean of both sides, Pa; used where both are absent
        if the vehicle file has ``trailer.suspension_pressure``.
    vehicle : Vehicle
        The vehicle.
    calibration : str or os.PathLike, optional
        A calibration file of this vehicle. For many logs, `vehicle.calibrated(path)` once is
        quicker.
    method : {"filtered", "arx", "gain"}
        Identification: ARX on filtered signals, classical ARX, gain alone.
    channel : {"auto", "steer", "lateral-acceleration"}
        Input; "auto" takes the one that knows the height best.
    order : int
        Order of the classical ARX, 1 to 10.
    model : {"complete", "as-printed"}
        Equations of the vehicle.

    Returns
    -------
    Estimate
        With status "rejected" and a reason where the data give no height.

    Raises
    ------
    ValueError
        An array is not one-dimensional, has another length than `time_s` or holds infinity;
        time is NaN or does not increase (named with index); an option is out of range.
    FileNotFoundError
        There is no such calibration file.
    """
    scalars: dict[str, object] = {"speed_mps": None, "trailer_mass_kg": None}
    given = {
        "time_s": time_s,
        "steer_rad": steer_rad,
        "steering_wheel_rad": steering_wheel_rad,
        "roll_rad": roll_rad,
        "tilt_rad": tilt_rad,
        "speed_mps": speed_mps,
        "lateral_acceleration_mps2": lateral_acceleration_mps2,
        "yaw_rate_radps": yaw_rate_radps,
        "trailer_mass_kg": trailer_mass_kg,
        "trailer_axle_load_kg": trailer_axle_load_kg,
        "trailer_suspension_pressure_pa": trailer_suspension_pressure_pa,
    }
    for name in scalars:
        value = given[name]
        if value is not None and np.ndim(value) == 0:
            scalars[name], given[name] = value, None
    arrays = {name: column(name, values) for name, values in given.items() if values is not None}
    options = _options(method, channel, order, model, **scalars)
    return _native.estimate_arrays(_calibrated(vehicle, calibration), arrays, options)


def estimate_log(
    log: str | os.PathLike[str] | Any,
    *,
    vehicle: _native.Vehicle,
    columns: Mapping[str, str] | None = None,
    flip: Iterable[str] = (),
    speed_mps: float | None = None,
    trailer_mass_kg: float | None = None,
    calibration: str | os.PathLike[str] | None = None,
    method: Literal["filtered", "arx", "gain"] = "filtered",
    channel: Literal["auto", "steer", "lateral-acceleration"] = "auto",
    order: int = 5,
    model: Literal["complete", "as-printed"] = "complete",
) -> Estimate:
    """Estimate the height of the trailer's c.g. from a log.

    Columns are found by name: ``time_s``, ``steer_rad`` (or ``steering_wheel_rad``),
    ``roll_rad`` (or ``tilt_rad``) and, if there, ``speed_mps``, ``lateral_acceleration_mps2``,
    ``yaw_rate_radps``, ``trailer_mass_kg`` (or ``trailer_axle_load_kg``, or
    ``trailer_suspension_pressure_pa``); units by suffix, also ``_deg``, ``_degps``, ``_kmh``,
    ``_g``, ``_ms``, ``_us``, ``_t``, ``_kpa``, ``_bar``. The same rules hold for files and data
    frames.

    Parameters
    ----------
    log : str, os.PathLike, or data frame
        A file: ``.csv``, ``.csv.gz``, ``.parquet``, or J1939 frames in ``.log`` (candump),
        ``.asc``, ``.blf``, ``.mf4``, ``.trc``; or anything with ``columns`` and ``__getitem__``
        such as a data frame of pandas or polars; or a dict of arrays.
    vehicle : Vehicle
        The vehicle.
    columns : dict, optional
        Foreign names, such as ``{"roll": "MyName[deg]"}``: signal to column and unit.
    flip : iterable of str
        Signals whose sensor is mounted the other way round, such as ``("roll",)``.
    speed_mps, trailer_mass_kg : float, optional
        Speed (m/s) and mass of the whole semitrailer (kg), whatever the log says.
    calibration, method, channel, order, model
        As for `estimate`.

    Returns
    -------
    Estimate
        With status "rejected" and a reason where the log gives no height.

    Raises
    ------
    FileNotFoundError
        There is no such file, or no such calibration file.
    ValueError
        The log is not as described; the message names line (or row), column and remedy.
    ImportError
        The log holds CAN frames and python-can is not installed.
    """
    options = _options(method, channel, order, model, speed_mps, trailer_mass_kg)
    vehicle = _calibrated(vehicle, calibration)
    if isinstance(log, str | os.PathLike) and not is_can(log):
        return _native.estimate_file(vehicle, os.fspath(log), maps(columns), flips(flip), options)
    return _native.estimate_arrays(vehicle, signals(log, columns, flip), options)


class Estimator(_native.Stream):
    """The estimator, one row at a time, with its answer at any time.

    Usable from several threads; rows must still come in the order of time.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    speed_mps, trailer_mass_kg : float, optional
        Speed (m/s) and mass of the whole semitrailer (kg), whatever the rows say.
    calibration, method, channel, order, model
        As for `estimate`.

    Raises
    ------
    ValueError
        An option is out of range.
    FileNotFoundError
        There is no such calibration file.
    """

    def __new__(
        cls,
        vehicle: _native.Vehicle,
        *,
        speed_mps: float | None = None,
        trailer_mass_kg: float | None = None,
        calibration: str | os.PathLike[str] | None = None,
        method: Literal["filtered", "arx", "gain"] = "filtered",
        channel: Literal["auto", "steer", "lateral-acceleration"] = "auto",
        order: int = 5,
        model: Literal["complete", "as-printed"] = "complete",
    ) -> Self:
        """Begin a log."""
        options = _options(method, channel, order, model, speed_mps, trailer_mass_kg)
        return super().__new__(cls, _calibrated(vehicle, calibration), options)
