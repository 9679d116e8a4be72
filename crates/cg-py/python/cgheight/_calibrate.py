"""Calibration of a vehicle with logs and with what it has learned itself."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from datetime import UTC, datetime
from tempfile import TemporaryDirectory
from typing import Any, Literal, TypedDict, Unpack

from cgheight import _native
from cgheight._arrays import number
from cgheight._columns import flips, maps
from cgheight._frames import as_candump, is_can
from cgheight._logs import signals
from cgheight._tables import is_table

Log = str | os.PathLike[str] | Any
# A number, or a pair with its standard deviation.
Known = float | tuple[float, float]
Run = (
    tuple[Log, Known]
    | tuple[Log, Known, Known]
    | tuple[Log, None]
    | tuple[Log, None, Known]
    | tuple[Log, Literal["empty"]]
)
# The name of a run, whether the trailer is empty, and its height and mass if they are known, each
# with its standard deviation if it has one.
_Pair = tuple[float, float | None]
_Known = tuple[str, bool, _Pair | None, _Pair | None]


class Reading(TypedDict, total=False):
    """How the logs of `calibrate` are read, as for `estimate_log`."""

    columns: Mapping[str, str] | None
    flip: Iterable[str]
    channel: str


def _read_by(
    columns: Mapping[str, str] | None = None, flip: Iterable[str] = (), channel: str = "auto"
) -> tuple[Mapping[str, str] | None, Iterable[str], str]:
    return columns, flip, channel


def calibrate(
    vehicle: _native.Vehicle,
    runs: Iterable[Run],
    output: str | os.PathLike[str],
    *,
    from_state: Iterable[str | os.PathLike[str]] | str | os.PathLike[str] = (),
    model: Literal["complete", "as-printed"] = "complete",
    method: Literal["filtered", "arx", "gain"] = "filtered",
    procedure: Literal["maximum-a-posteriori", "compensation"] = "maximum-a-posteriori",
    part: Literal["vehicle", "tractor"] = "vehicle",
    force: bool = False,
    **reading: Unpack[Reading],
) -> _native.Vehicle:
    """Calibrate a vehicle with logs whose height is known, or with its trips without a load.

    The uncertain parameters of the truck are fitted to the runs and to ``[uncertainty]`` in the
    vehicle file. One run with the empty trailer is enough; a laden one makes it better. The
    calibration file contains what the runs could and could not determine.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    runs : iterable of (log, height_m), (log, height_m, trailer_mass_kg) or (log, "empty")
        Logs with turns at constant speed, in any form that `estimate_log` takes; height
        of the trailer's sprung c.g., m; mass of the
        whole semitrailer, kg, needed if it is not in the log. Height and mass of the empty trailer
        are in the vehicle file. A height that is None is not known and is found. Each of height
        and mass may be a pair with its standard deviation, ``(log, (1.9, 0.05))``; a height without
        one counts as exact.
    output : str or os.PathLike
        The calibration file (TOML) to write; it appears only when it is complete.
    from_state : iterable of str or os.PathLike, or one of them
        Trips of this truck with the empty trailer, which become runs: state files of ``cg run``, or
        the texts that `learn_log`, `Estimator.learned` and `cgheight.spark.learn_trips` give. They
        tell the truck of the newest trip; a trip that is given twice counts once.
    model : {"complete", "as-printed"}
        Equations of the vehicle.
    method : {"filtered", "arx", "gain"}
        Identification of the DC ratios of the runs, as for `estimate_log`; ``"arx"`` is the
        thesis's.
    procedure : {"maximum-a-posteriori", "compensation"}
        What the runs determine: all parameters, or with one run the compensation of each channel
        alone, as in the thesis.
    part : {"vehicle", "tractor"}
        What the calibration is for. One of the tractor alone holds with any trailer.
    force : bool
        Replace a file at `output` even if it is not a calibration, and calibrate even with runs
        that contradict the vehicle file; then every estimate has a message that says so. The runs
        and the vehicle file are never replaced.
    **reading
        How the logs are read: `columns`, `flip` and `channel`, as for `estimate_log`.

    Returns
    -------
    Vehicle
        The vehicle with this calibration.

    Raises
    ------
    FileNotFoundError
        There is no such log or state file.
    FileExistsError
        `output` exists, is not a calibration, and `force` is false.
    ValueError
        `output` is a run or the vehicle file; a run is not as described, has no turn, or has a load
        that is impossible for the vehicle; a state is of another vehicle file, or has no trip; or
        the runs contradict the vehicle file, and `force` is false.

    Examples
    --------
    >>> import cgheight, tempfile
    >>> truck = cgheight.Vehicle.load("fixtures/vehicles/kraz.toml")
    >>> empty, laden = "fixtures/logs/A_p00_v50_L.csv", "fixtures/logs/A_p20_h190_v50_L.csv"
    >>> runs = [(empty, 1.33), (laden, 1.9)]
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     truck = cgheight.calibrate(truck, runs, folder + "/truck.toml")
    >>> truck.is_calibrated
    True
    """
    columns, flip, channel = _read_by(**reading)
    request: dict[str, object] = {
        "model": model,
        "method": method,
        "channel": channel,
        "procedure": procedure,
        "part": part,
        "columns": maps(columns),
        "flip": flips(flip),
        "date": datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ"),
        "force": bool(force),
    }
    states = [_state(position, state) for position, state in enumerate(_listed(from_state))]
    with TemporaryDirectory() as folder:
        given = [_given(place, run, columns, flip, folder) for place, run in enumerate(runs)]
        _native.calibrate_files(vehicle, given, states, output, request)
    return vehicle.calibrated(output)


def _given(
    place: int, run: Run, columns: Mapping[str, str] | None, flip: Iterable[str], folder: str
) -> tuple[_Known, Any]:
    """Return what is known of a run, and its rows: a file or a table."""
    log, *load = run
    name = os.fspath(log) if isinstance(log, str | os.PathLike) else f"table {place}"
    known = _known(name, load, run)
    if not isinstance(log, str | os.PathLike) or is_table(log, columns):
        return known, signals(log, columns, flip)
    return known, as_candump(name, folder) if is_can(name) else name


def _known(name: str, load: list[Any], run: Run) -> _Known:
    match load:
        case ["empty"]:
            return name, True, None, None
        case [height_m]:
            return name, False, _optional("height_m", height_m), None
        case [height_m, mass_kg]:
            mass = _pair("trailer_mass_kg", mass_kg)
            return name, False, _optional("height_m", height_m), mass
    raise ValueError(f'run {run!r}: expected (log, height_m[, trailer_mass_kg]) or (log, "empty")')


def _optional(name: str, value: Known | None) -> _Pair | None:
    return None if value is None else _pair(name, value)


def _pair(name: str, value: Known) -> _Pair:
    match value:
        case (mean, sd):
            return number(name, mean), number(f"the standard deviation of {name}", sd)
        case tuple():
            raise ValueError(f"{name} is {value!r}: give a number, or a pair with its deviation")
    return number(name, value), None


def _listed(
    states: Iterable[str | os.PathLike[str]] | str | os.PathLike[str],
) -> Iterable[str | os.PathLike[str]]:
    return [states] if isinstance(states, str | os.PathLike) else states


def _state(position: int, state: str | os.PathLike[str]) -> tuple[str, str | None]:
    """Return the path of a state file, or a name and the text of what a truck has learned."""
    if isinstance(state, str) and state.lstrip().startswith("{"):
        return f"from_state[{position}]", state
    return os.fspath(state), None
