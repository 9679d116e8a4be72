"""Simulated logs with known truth, and how well they are estimated."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from cgheight import _native, _show
from cgheight._arrays import number
from cgheight._extras import need
from cgheight._logs import write_log, write_request

if TYPE_CHECKING:
    import pandas as pd

ManeuverName = Literal["rounded-step", "steady-turn", "lane-change", "sine", "ramp", "drive"]
PlantName = Literal["linear", "reduced", "nonlinear"]

# Sensors without faults; the keys are keywords of `simulate`.
_SENSORS: dict[str, Any] = {
    "snr_db": None,
    "noise_lag_s": 0.0,
    "steer_noise_rad": 0.0,
    "lateral_noise_mps2": 0.0,
    "steer_play_rad": 0.0,
    "roll_limit_rad": None,
    "roll_offset_rad": 0.0,
    "steer_offset_rad": 0.0,
    "quantisation_rad": 0.0,
    "delay_s": 0.0,
    "inclinometer": False,
    "jitter_s": 0.0,
    "drop_out": 0.0,
    "steering_wheel": False,
}


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class SimulatedLog:
    """A simulated log and what is true of it.

    Attributes
    ----------
    signals : dict of str to array, shape (n,)
        The columns of the log by their SI names (``time_s``, ``steer_rad``, ``roll_rad``, …), as
        the sensors show them; NaN where a value was lost.
    truth : dict
        ``height_m``, ``trailer_mass_kg``, ``speed_mps``, ``steer_rad`` (amplitude), ``ratio``,
        ``noise_sd_rad`` and everything else that the sensors added.
    """

    signals: dict[str, NDArray[np.float64]]
    truth: dict[str, Any]

    def to_frame(self) -> pd.DataFrame:
        """Return the columns as a pandas DataFrame, which `estimate_log` takes."""
        return need("pandas", "pandas").DataFrame(self.signals)

    def __repr__(self) -> str:
        time_s = self.signals["time_s"]
        true = f"true height {self.truth['height_m']:.3f} m"
        mass = f"trailer {self.truth['trailer_mass_kg']:.0f} kg"
        return f"SimulatedLog({true}, {mass}, {len(time_s)} rows, {time_s[-1] - time_s[0]:.1f} s)"

    def _repr_html_(self) -> str:
        rows = [(key, f"{value:.6g}" if isinstance(value, float) else str(value))
                for key, value in self.truth.items()]  # fmt: skip
        return _show.pairs(f"Simulated log, {len(self.signals['time_s'])} rows: truth", rows)


def _request(maneuver: str, scenario: dict[str, Any]) -> dict[str, Any]:
    """Return the dict that the compiled half takes."""
    numbers = {
        "height_m": None,
        "trailer_mass_kg": None,
        "payload_kg": None,
        "speed_mps": None,
        "steer_rad": None,
        "rate_hz": 100.0,
        "start_s": 2.0,
        "duration_s": None,
        "step_rate_per_s": None,
        "turn_rad": None,
        "radius_m": None,
        "gate_m": None,
        "speed_change": None,
    }
    request: dict[str, Any] = {"maneuver": maneuver, "plant": "linear", "model": "complete"}
    request |= numbers | {"to_rollover": False, "seed": 1}
    sensors = dict(_SENSORS)
    for key, value in scenario.items():
        target = sensors if key in sensors else request
        if key not in target:
            known = ", ".join([*request, *sensors])
            raise TypeError(f"{key} is no keyword of a scenario; those are {known}")
        is_number = key in numbers or (key in sensors and not isinstance(_SENSORS[key], bool))
        target[key] = number(key, value) if is_number and value is not None else value
    return request | {"sensors": sensors}


def simulate(
    vehicle: _native.Vehicle,
    maneuver: ManeuverName,
    *,
    plant: PlantName = "linear",
    model: Literal["complete", "as-printed"] = "complete",
    height_m: float | None = None,
    trailer_mass_kg: float | None = None,
    payload_kg: float | None = None,
    speed_mps: float | None = None,
    steer_rad: float | None = None,
    rate_hz: float = 100.0,
    start_s: float = 2.0,
    duration_s: float | None = None,
    step_rate_per_s: float | None = None,
    turn_rad: float | None = None,
    radius_m: float | None = None,
    gate_m: float | None = None,
    speed_change: float | None = None,
    to_rollover: bool = False,
    snr_db: float | None = None,
    noise_lag_s: float = 0.0,
    steer_noise_rad: float = 0.0,
    lateral_noise_mps2: float = 0.0,
    steer_play_rad: float = 0.0,
    roll_limit_rad: float | None = None,
    roll_offset_rad: float = 0.0,
    steer_offset_rad: float = 0.0,
    quantisation_rad: float = 0.0,
    delay_s: float = 0.0,
    inclinometer: bool = False,
    jitter_s: float = 0.0,
    drop_out: float = 0.0,
    steering_wheel: bool = False,
    seed: int = 1,
    output: str | os.PathLike[str] | None = None,
    force: bool = False,
) -> SimulatedLog:
    """Simulate a log with known truth, as `cg simulate` does.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    maneuver : {"rounded-step", "steady-turn", "lane-change", "sine", "ramp", "drive"}
        What the driver does after `start_s` of straight driving.
    plant : {"linear", "reduced", "nonlinear"}
        What moves: the linear model in full, its 5th-order reduction, the nonlinear yaw/roll plant.
    model : {"complete", "as-printed"}
        Equations of the linear model.
    height_m : float, optional
        Height of the trailer's sprung c.g. above ground, m; the vehicle's reference if absent.
    trailer_mass_kg, payload_kg : float, optional
        Mass of the whole semitrailer, or of its payload, kg; one of them or neither.
    speed_mps : float, optional
        Forward speed, m/s; the vehicle's nominal speed if absent.
    steer_rad : float, optional
        Road-wheel amplitude, rad; for 0.17 g if absent.
    rate_hz, start_s, duration_s : float
        Samples per second; straight driving before the maneuver, s; length of the log, s
        (20, a drive 300, a driver's path as long as it takes).
    step_rate_per_s : float, optional
        Rate of rounded steps, 1/s.
    turn_rad, radius_m, gate_m : float, optional
        A path for the preview driver, with the nonlinear plant: a turn (rad, right if negative) on
        a radius (m) for "steady-turn", a gate length (m) for "lane-change".
    speed_change : float, optional
        Share by which the speed of a drive changes either way.
    to_rollover : bool
        Whether the log may end where the vehicle rolls over, with the nonlinear plant.
    snr_db, noise_lag_s : float
        Noise on the roll angle, dB below its mean square, and its time constant, s (0: white).
    steer_noise_rad, lateral_noise_mps2 : float
        Standard deviations of white noise on steer angle (rad) and lateral acceleration (m/s²).
    steer_play_rad : float
        Play between measured steer angle and road wheels from end to end, rad.
    roll_limit_rad : float, optional
        Greatest angle that the roll sensor can show, rad.
    roll_offset_rad, steer_offset_rad : float
        Constant offsets, rad.
    quantisation_rad, delay_s : float
        Step (rad) and delay (s) of the roll sensor.
    inclinometer : bool
        ``tilt_rad``, which feels lateral acceleration, in place of ``roll_rad``.
    jitter_s : float
        Time stamps lie up to this much beside the sample, s.
    drop_out : float
        Share of the rows whose roll angle is lost.
    steering_wheel : bool
        The steering-wheel angle in place of that of the road wheels.
    seed : int
        Seed of sensors and drive.
    output : str or os.PathLike, optional
        Also write the log, as `write_log` does.
    force : bool
        Whether `output` may replace a file that is no log of ours; never the vehicle file.

    Returns
    -------
    SimulatedLog
        Columns and truth.

    Raises
    ------
    ValueError
        A number is out of range, the vehicle has no such load, or keywords exclude each other.
    FileExistsError
        `output` is there and no log of ours, and `force` is false.
    OSError
        `output` cannot be written.

    Examples
    --------
    >>> import cgheight
    >>> truck = cgheight.Vehicle.load("fixtures/vehicles/baseline.toml")
    >>> log = cgheight.simulate(truck, "rounded-step", height_m=1.9, snr_db=20)
    >>> log
    SimulatedLog(true height 1.900 m, trailer 31298 kg, 2001 rows, 20.0 s)
    >>> answer = cgheight.estimate(**log.signals, vehicle=truck)
    >>> low_m, high_m = answer.height_ci95_m
    >>> low_m < 1.9 < high_m
    True
    """
    given = {key: value for key, value in locals().items()
             if key not in ("vehicle", "maneuver", "output", "force")}  # fmt: skip
    request = _request(maneuver, given)
    if output is not None:
        _native.may_write(write_request("output", output, None, vehicle, force))
    signals, truth = _native.simulate_log(vehicle, request)
    log = SimulatedLog(signals, json.loads(truth))
    if output is not None:
        write_log(log, output, vehicle=vehicle, force=force)
    return log


def accuracy_map(
    vehicle: _native.Vehicle,
    heights_m: Iterable[float],
    snr_db: Iterable[float],
    *,
    maneuver: ManeuverName = "rounded-step",
    truck: Literal["of-the-file", "drawn"] = "of-the-file",
    channel: Literal["auto", "steer", "lateral-acceleration"] = "auto",
    method: Literal["filtered", "arx", "gain"] = "filtered",
    runs: int = 100,
    jobs: int | None = None,
    **scenario: Any,
) -> pd.DataFrame:
    """Estimate simulated logs many times over height and noise, and score the heights.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle; without its calibration.
    heights_m : iterable of float
        True heights of the trailer's sprung c.g., m.
    snr_db : iterable of float
        Noise on the roll angle, dB below its mean square.
    maneuver
        As for `simulate`.
    truck : {"of-the-file", "drawn"}
        The truck of the file each time (noise alone is wrong; the interval judged is that of
        noise), or another one each time, drawn from the file's ``[uncertainty]``.
    channel, method
        As for `estimate`.
    runs : int
        Repetitions of each cell, 1 or more; an RMSE scatters by ``1/sqrt(2 runs)``.
    jobs : int, optional
        Threads; as many as there are processors if absent.
    **scenario
        Further keywords of `simulate`.

    Returns
    -------
    pandas.DataFrame
        One row for each cell: ``height_m, snr_db, answered, bias_percent, rmse_percent,
        stated_sd_percent, coverage_percent, bound_percent``, per cent of the true height.

    Raises
    ------
    ValueError
        A number is out of range.
    TypeError
        A keyword is unknown.
    ImportError
        pandas is not installed.
    """
    pandas = need("pandas", "pandas")
    cells = [(number("heights_m", h), number("snr_db", s)) for h in heights_m for s in snr_db]

    def score(cell: tuple[float, float]) -> dict[str, float]:
        request = _request(maneuver, scenario | {"height_m": cell[0], "snr_db": cell[1]})
        found = _native.score_accuracy(vehicle, request, truck, channel, method, runs)
        row = {"height_m": cell[0], "snr_db": cell[1], "answered": found.pop("answered")}
        return row | {f"{name}_percent": 100 * value for name, value in found.items()}

    with ThreadPoolExecutor(jobs or os.cpu_count()) as pool:
        return pandas.DataFrame(list(pool.map(score, cells)))
