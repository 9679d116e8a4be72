"""Scenarios for simulation, and the errors of the sensors."""

from __future__ import annotations

import operator
import os
from dataclasses import KW_ONLY, dataclass, fields
from typing import Any, Literal

import numpy as np

from cgheight._arrays import number

ManeuverName = Literal["rounded-step", "steady-turn", "lane-change", "sine", "ramp", "drive"]
RoadName = Literal["rural", "motorway", "roundabouts"]
PlantName = Literal["linear", "reduced", "nonlinear"]


# What a drive on a road does not have.
_OF_MANEUVERS = (
    "steer_rad",
    "start_s",
    "step_rate_per_s",
    "turn_rad",
    "radius_m",
    "gate_m",
    "speed_change",
    "to_rollover",
)


# The seeds of the random numbers have 64 bits.
_GREATEST_SEED = 2**64 - 1


def _numbers(options: Any) -> None:
    """Convert the fields of type float and bool, or raise a ValueError that names the wrong one."""
    for each in fields(options):
        value = getattr(options, each.name)
        if each.type == "bool":
            if not isinstance(value, bool | np.bool_):
                raise ValueError(f"{each.name} is {value!r}: it must be True or False")
            object.__setattr__(options, each.name, bool(value))
        if "float" in str(each.type) and value is not None:
            object.__setattr__(options, each.name, number(each.name, value))


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensors:
    """Errors that the sensors add to the truth; the default is none.

    Attributes
    ----------
    snr_db, noise_lag_s : float
        Noise on the roll angle, dB below its mean square, and its time constant, s (0: white
        noise).
    steer_noise_rad, lateral_noise_mps2 : float
        Standard deviation of white noise on the steer angle (rad) and on the lateral acceleration
        (m/s²).
    steer_play_rad : float
        Play between the steer sensor and the road wheels, from end to end, rad.
    roll_limit_rad : float, optional
        Greatest angle that the roll sensor can show, rad.
    roll_offset_rad, steer_offset_rad : float
        Constant offsets of the roll angle and of the steer angle, rad.
    quantisation_rad, delay_s : float
        Quantization step (rad) and delay (s) of the roll sensor.
    inclinometer : bool
        Whether an inclinometer replaces the roll sensor: ``tilt_rad``, which also responds to
        lateral acceleration, in place of ``roll_rad``.
    jitter_s : float
        Largest difference between a time stamp and the time of its sample, s.
    drop_out : float
        Share of the rows whose roll angle is randomly lost.
    steering_wheel : bool
        Whether the log has the steering-wheel angle in place of the road-wheel angle.
    """

    snr_db: float | None = None
    noise_lag_s: float = 0.0
    steer_noise_rad: float = 0.0
    lateral_noise_mps2: float = 0.0
    steer_play_rad: float = 0.0
    roll_limit_rad: float | None = None
    roll_offset_rad: float = 0.0
    steer_offset_rad: float = 0.0
    quantisation_rad: float = 0.0
    delay_s: float = 0.0
    inclinometer: bool = False
    jitter_s: float = 0.0
    drop_out: float = 0.0
    steering_wheel: bool = False

    def __post_init__(self) -> None:
        """Check the numbers."""
        _numbers(self)


@dataclass(frozen=True, slots=True, kw_only=True)
class ChassisSensors:
    """Errors of the sensors on frames and axles, in a drive on a road; the default is none.

    Attributes
    ----------
    level_offset_m, level_noise_m, level_quantisation_m : float
        Constant offset of the left level sensors, standard deviation of white noise on each level,
        and quantization step, m.
    accelerometer_offset_mps2, accelerometer_noise_mps2, accelerometer_quantisation_mps2 : float
        The same of the accelerometers, m/s².
    tilt_offset_rad, tilt_noise_rad, tilt_quantisation_rad : float
        The same of the inclinometers, rad; those on the axles have no offset.
    mounting_rad : float
        Roll angle at which accelerometers and inclinometers are mounted on the frames, rad.
    """

    level_offset_m: float = 0.0
    level_noise_m: float = 0.0
    level_quantisation_m: float = 0.0
    accelerometer_offset_mps2: float = 0.0
    accelerometer_noise_mps2: float = 0.0
    accelerometer_quantisation_mps2: float = 0.0
    tilt_offset_rad: float = 0.0
    tilt_noise_rad: float = 0.0
    tilt_quantisation_rad: float = 0.0
    mounting_rad: float = 0.0

    def __post_init__(self) -> None:
        """Check the numbers."""
        _numbers(self)


@dataclass(frozen=True, slots=True)
class Scenario:
    """A maneuver or a drive on a road, and how it is simulated and measured.

    Attributes
    ----------
    maneuver : {"rounded-step", "steady-turn", "lane-change", "sine", "ramp", "drive"}, optional
        The maneuver after `start_s` of straight driving; give it or `road`.
    road : {"rural", "motorway", "roundabouts"} or path, optional
        A road that the nonlinear plant drives along: a usual kind, whose curves `seed` determines,
        or a CSV file (``distance_m, curvature_per_m, bank_rad`` and, with speed limits or grades,
        ``speed_mps`` and ``grade_rad``). The log then also has the signals of the chassis: levels,
        specific forces, inclinometers, suspension roll, of trailer and tractor.
    road_twist : bool
        Whether every axle stands on the bank of its own place; otherwise the whole truck stands on
        one bank.
    chassis : ChassisSensors
        The errors of these signals.
    plant : {"linear", "reduced", "nonlinear"}
        The simulated model of a maneuver: the full linear model, its 5th-order reduction, or the
        nonlinear plant. A drive on a road always takes the nonlinear plant.
    model : {"complete", "as-printed"}
        Equations of the linear model.
    height_m : float, optional
        Height of the trailer's sprung c.g. above ground, m; the vehicle's reference if absent.
    trailer_mass_kg, payload_kg : float, optional
        Mass of the whole semitrailer, or of its payload, kg; give at most one of them.
    payload_behind_hitch_m : float, optional
        Distance of the payload's c.g. behind the fifth wheel, m; if absent, as in the vehicle file.
    payload_left_m : float
        Distance of the payload's c.g. to the left of the middle, m, negative to the right. To the
        linear and the reduced model it adds the lean; the printed equations have none.
    wind_mps, wind_from_rad : float
        Mean speed of the wind on the trailer's body, m/s, with gusts of 15 %, and where it comes
        from at the start, rad: 0 from ahead, pi/2 from the left. For the nonlinear plant and a
        vehicle file with ``[wind]``.
    speed_mps : float, optional
        Forward speed, m/s, on a road the greatest one; if absent, the vehicle's nominal speed, or
        the limits of the road.
    steer_rad : float, optional
        Amplitude of the road-wheel angle, rad; if absent, the one that gives 0.17 g.
    rate_hz, start_s, duration_s : float
        Samples per second; straight driving before the maneuver, s; length of the log, s. The
        default length is 20 s, 300 s for a drive, as long as needed for a driver's path, and 120 to
        150 s on a road.
    step_rate_per_s : float, optional
        Rate of the rounded steps, 1/s.
    turn_rad, radius_m, gate_m : float, optional
        A path for the preview driver, with the nonlinear plant only: the angle of a turn (rad,
        negative to the right) and its radius (m) for "steady-turn", or the length of the gate (m)
        for "lane-change".
    speed_change : float, optional
        Share by which the speed of a drive varies up and down.
    to_rollover : bool
        Whether the log may end with a rollover of the vehicle, with the nonlinear plant.
    sensors : Sensors
        The errors of the sensors.
    seed : int
        Seed of the random numbers for sensors, drive and road, 0 or more.
    """

    maneuver: ManeuverName | None = None
    _: KW_ONLY
    road: RoadName | str | os.PathLike[str] | None = None
    road_twist: bool = False
    chassis: ChassisSensors = ChassisSensors()
    plant: PlantName = "linear"
    model: Literal["complete", "as-printed"] = "complete"
    height_m: float | None = None
    trailer_mass_kg: float | None = None
    payload_kg: float | None = None
    payload_behind_hitch_m: float | None = None
    payload_left_m: float = 0.0
    wind_mps: float = 0.0
    wind_from_rad: float = 0.0
    speed_mps: float | None = None
    steer_rad: float | None = None
    rate_hz: float = 100.0
    start_s: float = 2.0
    duration_s: float | None = None
    step_rate_per_s: float | None = None
    turn_rad: float | None = None
    radius_m: float | None = None
    gate_m: float | None = None
    speed_change: float | None = None
    to_rollover: bool = False
    sensors: Sensors = Sensors()
    seed: int = 1

    def __post_init__(self) -> None:
        """Check the numbers, and that they are those of a maneuver or those of a road."""
        if (self.maneuver is None) == (self.road is None):
            raise ValueError("give either maneuver or road")
        others = ("road_twist", "chassis") if self.road is None else _OF_MANEUVERS
        usual = {each.name: each.default for each in fields(self)}
        given = [name for name in others if getattr(self, name) != usual[name]]
        if given:
            kind = "a drive on a road" if self.road is None else "a maneuver"
            raise ValueError(f"{', '.join(given)}: only for {kind}; leave it out")
        _numbers(self)
        seed = operator.index(self.seed)
        if not 0 <= seed <= _GREATEST_SEED:
            raise ValueError(f"seed is {seed}: it must be from 0 to {_GREATEST_SEED}")
        object.__setattr__(self, "seed", seed)
