"""Prediction of the roll angle with the model."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from cgheight import _native
from cgheight._arrays import number
from cgheight._estimate import shared_options
from cgheight._logs import signals


def predict_roll(
    log: Any,
    height_m: float,
    *,
    vehicle: _native.Vehicle,
    channel: Literal["steer", "lateral-acceleration", "suspension", "tractor"] = (
        "lateral-acceleration"
    ),
    columns: Mapping[str, str] | None = None,
    flip: Iterable[str] = (),
    speed_mps: float | None = None,
    trailer_mass_kg: float | None = None,
    model: Literal["complete", "as-printed"] = "complete",
) -> NDArray[np.float64]:
    """Predict the roll angle of a log for a c.g. height, from one of its inputs.

    The prediction is the response of the reduced model to the input, with the DC ratio at the given
    height, speed and mass. It does not include the offset of the roll sensor. In all channels
    except that of the steer angle, the estimator passes the roll angle through two lags of 0.15 s,
    because the tractor rolls before the trailer's own acceleration changes; the prediction contains
    them.

    A lift axle is where the vehicle has it, or where the log says at its end.

    Parameters
    ----------
    log
        As for `estimate_log`.
    height_m : float
        Height of the trailer's sprung c.g. above ground, m.
    vehicle : Vehicle
        The vehicle.
    channel : {"steer", "lateral-acceleration", "suspension", "tractor"}
        The input.
    columns, flip, speed_mps, trailer_mass_kg, model
        As for `estimate_log`.

    Returns
    -------
    array, shape (n,)
        Roll angle at each row, rad (after the lags of the channel); NaN where speed or mass is
        outside the vehicle's range, and before the first value of the input.

    Raises
    ------
    FileNotFoundError
        There is no such file.
    ValueError
        The log is not as described, the vehicle cannot have the height, the speed or the mass, or
        no row has a prediction.
    """
    options = shared_options("filtered", "auto", model, speed_mps, trailer_mass_kg)
    height = number("height_m", height_m)
    roll_rad = _native.predict_roll(vehicle, signals(log, columns, flip), channel, height, options)
    if np.isnan(roll_rad).all():
        raise ValueError(
            f"no row has a prediction: the log lacks the input of the {channel} channel, or its "
            "speed or mass is outside the vehicle's range"
        )
    return roll_rad
