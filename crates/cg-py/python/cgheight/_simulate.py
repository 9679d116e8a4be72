"""Simulated logs with known truth, and the accuracy of their estimates."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal, TypedDict

import numpy as np
from numpy.typing import NDArray

from cgheight import _native, _show
from cgheight._arrays import number
from cgheight._extras import need
from cgheight._frames import is_can
from cgheight._logs import write_log, write_request
from cgheight._scenario import Scenario

if TYPE_CHECKING:
    import pandas as pd


class RoadTruth(TypedDict):
    """The road of a simulated log, a dict with these keys.

    Attributes
    ----------
    name : str
        The kind of the road, or the path of its file.
    driven_m : float
        Distance driven, m.
    bank_rad : list of float
        Least and greatest bank on the way, left side higher positive, rad.
    is_twisted : bool
        Whether every axle stood on the bank of its own place.
    """

    name: str
    driven_m: float
    bank_rad: list[float]
    is_twisted: bool


class _OnRoad(TypedDict, total=False):
    road: RoadTruth
    level_offset_m: float
    level_noise_m: float
    level_quantisation_m: float
    accelerometer_offset_mps2: float
    accelerometer_noise_mps2: float
    accelerometer_quantisation_mps2: float
    tilt_offset_rad: float
    tilt_noise_rad: float
    tilt_quantisation_rad: float
    mounting_rad: float


class Truth(_OnRoad):
    """The true values of a simulated log, a dict with these keys.

    Attributes
    ----------
    vehicle : str
        Name of the vehicle.
    height_m : float
        Height of the trailer's sprung c.g. above ground at rest, m.
    trailer_mass_kg : float
        Mass of the whole semitrailer, kg.
    payload_behind_hitch_m, payload_left_m : float
        Distances of the payload's c.g. behind the fifth wheel and to the left of the middle, m.
    wind_mps, wind_from_rad : float
        Mean speed of the wind, m/s, and where it comes from, rad, as in `Scenario`.
    speed_mps : float
        Forward speed, m/s; in a drive, the speed about which it varies; on a road, the mean.
    steer_rad : float
        Amplitude of the steer angle at the road wheels, rad; with a driver, the greatest angle.
    ratio : float
        DC ratio of roll angle to steer angle of the linear model, rad/rad.
    noise_sd_rad : float
        Standard deviation of the noise on the roll angle, rad.
    snr_db, noise_lag_s, steer_noise_rad, lateral_noise_mps2, steer_play_rad, roll_limit_rad
        Noise, play and limit of the sensors, in the units of `Sensors`.
    roll_offset_rad, steer_offset_rad, quantisation_rad, delay_s, inclinometer, jitter_s
        Their offsets, quantization, delay and kind, as in `Sensors`.
    drop_out, steering_wheel
        The share of lost roll angles, and the kind of the steer angle, as in `Sensors`.
    rolled_over_s : float or None
        Time of the rollover, s, if there was one.
    seed : int
        Seed of the random numbers.
    road : RoadTruth
        The road, only in a drive on one, as are all that follow.
    level_offset_m, level_noise_m, level_quantisation_m
        Errors of the level sensors, as in `ChassisSensors`.
    accelerometer_offset_mps2, accelerometer_noise_mps2, accelerometer_quantisation_mps2
        Those of the accelerometers.
    tilt_offset_rad, tilt_noise_rad, tilt_quantisation_rad, mounting_rad
        Those of the inclinometers, and the roll angle at which both are mounted.
    """

    vehicle: str
    height_m: float
    trailer_mass_kg: float
    payload_behind_hitch_m: float
    payload_left_m: float
    wind_mps: float
    wind_from_rad: float
    speed_mps: float
    steer_rad: float
    ratio: float
    noise_sd_rad: float
    snr_db: float | None
    noise_lag_s: float
    steer_noise_rad: float
    lateral_noise_mps2: float
    steer_play_rad: float
    roll_limit_rad: float | None
    roll_offset_rad: float
    steer_offset_rad: float
    quantisation_rad: float
    delay_s: float
    inclinometer: bool
    jitter_s: float
    drop_out: float
    steering_wheel: bool
    rolled_over_s: float | None
    seed: int


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class SimulatedLog:
    """A simulated log and its true values.

    Attributes
    ----------
    signals : dict of str to array, shape (n,)
        The columns of the log by their SI names (``time_s``, ``steer_rad``, ``roll_rad``, …),
        with the errors of the sensors; NaN where a value was lost.
    truth : Truth
        The true height, the load and the maneuver, and the errors that the sensors added.
    track : dict of str to array, shape (m,), or None
        Where the vehicle was on its road, every 0.1 s: ``time_s``, ``distance_m`` (of the front
        axle), ``bank_rad`` and ``tractor_yaw_rate_radps``, which the log does not have (its yaw
        rate is that of the trailer); None for a maneuver.
    """

    signals: dict[str, NDArray[np.float64]]
    truth: Truth
    track: dict[str, NDArray[np.float64]] | None = None

    def to_frame(self) -> pd.DataFrame:
        """Return the columns as a pandas DataFrame, which `estimate_log` accepts."""
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


def simulate(
    vehicle: _native.Vehicle,
    scenario: Scenario,
    *,
    output: str | os.PathLike[str] | None = None,
    force: bool = False,
) -> SimulatedLog:
    """Simulate a log with known truth, as `cg simulate` does.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    scenario : Scenario
        The maneuver or the road, the load and the sensors.
    output : str or os.PathLike, optional
        Path to which the log is also written, as by `write_log`.
    force : bool
        Whether `output` may replace a file that this package did not write, or one of CAN frames,
        which look like recorded ones. The vehicle file and the file of a road are never replaced.

    Returns
    -------
    SimulatedLog
        The columns of the log and the true values.

    Raises
    ------
    ValueError
        A number is out of range, the load is impossible for the vehicle, or keywords exclude each
        other.
    FileExistsError
        `output` exists, was not written by this package, and `force` is false.
    FileNotFoundError
        `road` is neither a kind of road nor a file.
    OSError
        `output` cannot be written.

    Examples
    --------
    >>> import cgheight
    >>> truck = cgheight.Vehicle.load("fixtures/vehicles/baseline.toml")
    >>> noisy = cgheight.Sensors(snr_db=20)
    >>> turn = cgheight.Scenario("rounded-step", height_m=1.9, sensors=noisy)
    >>> log = cgheight.simulate(truck, turn)
    >>> log
    SimulatedLog(true height 1.900 m, trailer 31298 kg, 2001 rows, 20.0 s)
    >>> answer = cgheight.estimate(**log.signals, vehicle=truck)
    >>> low_m, high_m = answer.height_ci95_m
    >>> low_m < 1.9 < high_m
    True
    """
    if output is not None:
        request = write_request("output", output, None, vehicle, force)
        _native.may_write(request | {"road": scenario.road})
    signals, truth, track = _native.simulate_log(vehicle, scenario)
    log = SimulatedLog(signals, json.loads(truth), track)
    if output is not None:
        written = log
        if is_can(output):  # VDC2 has the yaw rate of the tractor
            written = replace(log, signals=_native.simulate_log(vehicle, scenario, on_bus=True)[0])
        write_log(written, output, vehicle=vehicle, force=force)
    return log


def accuracy_map(
    vehicle: _native.Vehicle,
    heights_m: Iterable[float],
    snr_db: Iterable[float],
    *,
    scenario: Scenario | None = None,
    truck: Literal["of-the-file", "drawn"] = "of-the-file",
    channel: Literal["auto", "steer", "lateral-acceleration"] = "auto",
    method: Literal["filtered", "arx", "gain"] = "filtered",
    runs: int = 100,
    jobs: int | None = None,
) -> pd.DataFrame:
    """Map the accuracy of the estimated height over true height and noise, with simulated logs.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle; its calibration is ignored.
    heights_m : iterable of float
        True heights of the trailer's sprung c.g., m.
    snr_db : iterable of float
        Noise on the roll angle, dB below its mean square.
    scenario : Scenario, optional
        The simulated scenario, whose height and noise are replaced by those of each cell; a rounded
        step if absent.
    truck : {"of-the-file", "drawn"}
        "of-the-file": the truck of the vehicle file in every run, so that noise is the only error,
        and the interval is that of the noise. "drawn": a different truck in every run, drawn from
        ``[uncertainty]`` in the vehicle file.
    channel, method
        As for `estimate`.
    runs : int
        Number of runs for each cell, 1 or more; an RMSE scatters by ``1/sqrt(2 runs)``.
    jobs : int, optional
        Number of threads; the number of processors if absent.

    Returns
    -------
    pandas.DataFrame
        One row for each cell: ``height_m, snr_db, answered, bias_percent, rmse_percent,
        stated_sd_percent, coverage_percent, bound_percent``. Coverage is in % of the runs with
        an estimate, the other errors are in % of the true height.

    Raises
    ------
    ValueError
        A number is out of range.
    ImportError
        pandas is not installed.
    """
    pandas = need("pandas", "pandas")
    base = Scenario("rounded-step") if scenario is None else scenario
    cells = [(number("heights_m", h), number("snr_db", s)) for h in heights_m for s in snr_db]

    def score(cell: tuple[float, float]) -> dict[str, float]:
        sensors = replace(base.sensors, snr_db=cell[1])
        one = replace(base, height_m=cell[0], sensors=sensors)
        found = _native.score_accuracy(vehicle, one, truck, channel, method, runs)
        row = {"height_m": cell[0], "snr_db": cell[1], "answered": found.pop("answered")}
        return row | {f"{name}_percent": 100 * value for name, value in found.items()}

    with ThreadPoolExecutor(jobs or os.cpu_count()) as pool:
        return pandas.DataFrame(list(pool.map(score, cells)))
