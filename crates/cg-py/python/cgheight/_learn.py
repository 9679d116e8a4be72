"""What a truck learns from its logs."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from typing import Any

from cgheight import _native
from cgheight._logs import signals


def learn_log(
    log: str | os.PathLike[str] | Any,
    *,
    vehicle: _native.Vehicle,
    columns: Mapping[str, str] | None = None,
    flip: Iterable[str] = (),
) -> str:
    """Learn from the trips with the empty trailer in a log, as ``cg run`` does.

    A maneuver counts if a mass in the log says that the trailer is empty. A trip counts if its
    ratios are possible for the vehicle file, or for its calibration.

    Parameters
    ----------
    log, columns, flip
        As for `estimate_log`. The time stamps should be Unix time, because older trips count for
        less.
    vehicle : Vehicle
        The vehicle, with its calibration if it has one.

    Returns
    -------
    str
        JSON text of the trips, for `from_state` of `calibrate` and for `learned` of `Estimator`;
        ``json.loads(text)["trips"]`` is empty if nothing was learned.

    Raises
    ------
    FileNotFoundError
        There is no such file.
    ValueError
        The log is not as described; the message gives the line (or row), the column and a remedy.
    ImportError
        The log is ``.asc``, ``.blf``, ``.mf4`` or ``.trc`` and python-can is not installed.

    Examples
    --------
    >>> import cgheight, json
    >>> truck = cgheight.Vehicle.load("fixtures/vehicles/kraz.toml")
    >>> text = cgheight.learn_log("fixtures/logs/A_p00_v50_L.csv", vehicle=truck)
    >>> len(json.loads(text)["trips"])
    1
    """
    return learned(log, vehicle, columns, flip)[0]


def learned(
    log: Any,
    vehicle: _native.Vehicle,
    columns: Mapping[str, str] | None = None,
    flip: Iterable[str] = (),
) -> tuple[str, list[str]]:
    """Return the text of `learn_log`, and what became of each trip."""
    return _native.learn_arrays(vehicle, signals(log, columns, flip))
