"""What is simulated, and what sensors make of it."""

from __future__ import annotations

import operator
from dataclasses import KW_ONLY, dataclass, fields
from typing import Any, Literal

from cgheight._arrays import number

ManeuverName = Literal["rounded-step", "steady-turn", "lane-change", "sine", "ramp", "drive"]
PlantName = Literal["linear", "reduced", "nonlinear"]


def _numbers(options: Any) -> None:
    """Make numbers of the fields that are to be; ValueError names the one that cannot."""
    for each in fields(options):
        value = getattr(options, each.name)
        if "float" in str(each.type) and value is not None:
            object.__setattr__(options, each.name, number(each.name, value))


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensors:
    """What sensors add to the truth; as they are, nothing.

    Attributes
    ----------
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


@dataclass(frozen=True, slots=True)
class Scenario:
    """What is simulated.

    Attributes
    ----------
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
    sensors : Sensors
        What the sensors add.
    seed : int
        Seed of sensors and drive.
    """

    maneuver: ManeuverName
    _: KW_ONLY
    plant: PlantName = "linear"
    model: Literal["complete", "as-printed"] = "complete"
    height_m: float | None = None
    trailer_mass_kg: float | None = None
    payload_kg: float | None = None
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
        """Check the numbers."""
        _numbers(self)
        object.__setattr__(self, "seed", operator.index(self.seed))
