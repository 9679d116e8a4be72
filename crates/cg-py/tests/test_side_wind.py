"""What a side wind does to heights, and to calibrations: the figures of docs/limits.md.

The plant has no wind, so its roll is added to the simulated roll angle: that of a force on the side
of the body whose moment about the roll axis is as great as that of a lateral acceleration. The path
of the truck stays as it is, because the driver steers against the wind.
``pytest -s`` prints the figures.
"""

from __future__ import annotations

import json

import numpy as np
import pytest

import cgheight
from conftest import FIXTURES

EMPTY_KG, EMPTY_M, UNSPRUNG_KG = 6318.0, 1.27, 2500.0
LADEN_M, TEST_M = 1.9, 1.9
EMPTY, TEST = (EMPTY_KG, EMPTY_M), (EMPTY_KG + 12e3, TEST_M)
# Side force on the trailer of a tractor with a box body over the dynamic pressure times 10 m², for
# each unit of the sine of the angle at which the wind meets it: an assumption of the usual size.
SIDE_FORCE = 0.75 * 5.0
PRESSURE_HEIGHT_M, ROLL_CENTER_M = 2.4, 0.75
GUSTS, GUST_S = 0.15, 3.0
DIRECTIONS = 8
UNIX_S = 1.79e9  # a date, as learning expects it


def windy(log: dict, load: tuple[float, float], wind_mps: float, direction: int) -> dict:
    """Add the roll by a wind from one of eight directions to a log of a load, kg and m."""
    mass_kg, height_m = load
    time_s, speed_mps = log["time_s"], log["speed_mps"]
    step_s = float(np.median(np.diff(time_s)))
    heading = np.cumsum(log["yaw_rate_radps"]) * step_s
    from_rad = 2 * np.pi * direction / DIRECTIONS + 0.3 - heading
    kept = np.exp(-step_s / GUST_S)
    white = np.random.default_rng(direction).standard_normal(time_s.size)
    gust = np.zeros(time_s.size)
    for k in range(1, time_s.size):
        gust[k] = kept * gust[k - 1] + np.sqrt(1 - kept**2) * white[k]
    wind = wind_mps * (1 + GUSTS * gust)
    ahead, aside = speed_mps + wind * np.cos(from_rad), wind * np.sin(from_rad)
    force_n = 0.5 * 1.2 * 10.0 * SIDE_FORCE * np.hypot(ahead, aside) * aside
    # What the roll angle is for each m/s², in this log.
    slope = np.polyfit(log["lateral_acceleration_mps2"], log["roll_rad"], 1)[0]
    arm = (PRESSURE_HEIGHT_M - ROLL_CENTER_M) / (height_m - ROLL_CENTER_M)
    roll_rad = slope * arm * force_n / (mass_kg - UNSPRUNG_KG)
    return {**log, "roll_rad": log["roll_rad"] + roll_rad}


@pytest.fixture(scope="module")
def truck() -> cgheight.Vehicle:
    return cgheight.Vehicle.load(FIXTURES / "vehicles" / "euro.toml").on_road("flat")


def drive(truck, maneuver: str, load: tuple[float, float], snr_db: float, seed: int) -> dict:
    mass_kg, height_m = load
    scenario = cgheight.Scenario(
        maneuver,
        plant="nonlinear",
        trailer_mass_kg=mass_kg,
        height_m=None if mass_kg == EMPTY_KG else height_m,
        rate_hz=50.0,
        duration_s=300.0 if maneuver == "drive" else 20.0,
        sensors=cgheight.Sensors(snr_db=snr_db),
        seed=seed,
    )
    return cgheight.simulate(truck, scenario).signals


def judged(
    name: str, answers: list[cgheight.Estimate], truth_m: float = TEST_M
) -> tuple[float, int, int, int]:
    """Print and return the rms error, the heights, how many hold and how many miss with a message.

    Without a height the error is NaN, which is below no bound.
    """
    heights = [one for one in answers if one.height_m is not None]
    if not heights:
        print(f"{name}: no height, {len(answers)} logs")
        return float("nan"), 0, 0, 0
    errors = np.array([one.height_m / truth_m - 1 for one in heights])
    missing = [
        one for one in heights if not one.height_ci95_m[0] <= truth_m <= one.height_ci95_m[1]
    ]
    silent = sum(not any("side wind" in message for message in one.messages) for one in missing)
    hold = len(heights) - len(missing)
    rms = float(np.sqrt(np.mean(errors**2)))
    stated = float(np.mean([one.height_sd_m for one in heights])) / truth_m
    print(
        f"{name}: {100 * rms:.1f} % rms, {100 * abs(errors).max():.1f} % at worst, "
        f"{100 * stated:.1f} % stated; {hold} of {len(heights)} hold, {silent} miss without a "
        f"message on wind, {len(answers)} logs"
    )
    return rms, len(heights), hold, len(missing) - silent


def test_a_side_wind_is_in_long_drives_but_not_in_single_turns(truck, tmp_path):
    laden = (EMPTY_KG + 18e3, LADEN_M)
    logs = {
        kind: [drive(truck, kind, load, 35.0, k) for k, load in enumerate((EMPTY, laden))]
        for kind in ("rounded-step", "drive")
    }
    turn, trip = (drive(truck, kind, TEST, 30.0, 3) for kind in ("rounded-step", "drive"))

    def calibrated(kind: str, wind_mps: float, direction: int) -> cgheight.Vehicle | None:
        of_empty, of_laden = (
            windy(log, load, wind_mps, direction)
            for log, load in zip(logs[kind], (EMPTY, laden), strict=True)
        )
        try:
            runs = [(of_empty, "empty"), (of_laden, LADEN_M)]
            return cgheight.calibrate(truck, runs, tmp_path / f"{kind}{wind_mps}{direction}.toml")
        except ValueError:
            return None  # the wind was told from the turns

    still = calibrated("rounded-step", 0.0, 0)
    found = {}
    tests = {"turn": (turn, TEST), "trip": (trip, TEST)}
    tests["turn, empty"] = (drive(truck, "rounded-step", EMPTY, 30.0, 3), EMPTY)
    for name, (log, load) in tests.items():
        for wind_mps in (0.0, 3.0, 5.0, 8.0):
            some = range(DIRECTIONS if wind_mps else 1)
            logs_of = [windy(log, load, wind_mps, direction) for direction in some]
            answers = [cgheight.estimate_log(one, vehicle=still) for one in logs_of]
            found[name, wind_mps] = judged(f"{name}, {wind_mps:.0f} m/s", answers, load[1])
    for kind in logs:
        for wind_mps in (3.0, 5.0):
            trucks = [calibrated(kind, wind_mps, direction) for direction in range(DIRECTIONS)]
            answers = [cgheight.estimate_log(trip, vehicle=one) for one in trucks if one]
            name = f"calibrated on {kind}, {wind_mps:.0f} m/s"
            found[kind, wind_mps] = judged(name, answers)
    # Without wind both are right.
    assert all(found[name, 0.0][0] < 0.01 for name in ("turn", "trip"))
    # A single turn says too little of the wind: this is a limit, and documented as one.
    rms, heights, hold, told = found["turn", 5.0]
    assert rms > 0.02
    assert hold < heights
    assert told > 0  # most of them are told as a drift
    assert found["rounded-step", 5.0][0] > 0.015
    # In a drive the wind comes from all sides: 95 % of sixteen are fifteen, less two for chance.
    assert found["trip", 3.0][2] + found["trip", 5.0][2] >= 13
    assert found["drive", 3.0][0] < 0.01


def test_what_is_learned_in_a_side_wind_is_right_after_a_drive_but_not_after_one_turn(
    truck, tmp_path
):
    trip = drive(truck, "drive", TEST, 30.0, 3)
    empty = {
        "rounded-step": drive(truck, "rounded-step", EMPTY, 30.0, 3),
        "drive": drive(truck, "drive", EMPTY, 35.0, 0),
    }

    def learned(log: dict) -> cgheight.Vehicle | None:
        mass_kg = np.full(log["time_s"].size, EMPTY_KG)
        dated = {**log, "time_s": log["time_s"] + UNIX_S, "trailer_mass_kg": mass_kg}
        text = cgheight.learn_log(dated, vehicle=truck)
        if not json.loads(text)["trips"]:
            return None  # the trip was refused
        out = tmp_path / "learned.toml"
        return cgheight.calibrate(truck, [], out, from_state=text, force=True)

    found = {}
    for kind, log in empty.items():
        for wind_mps in (0.0, 3.0, 5.0):
            some = range(DIRECTIONS if wind_mps else 1)
            trucks = [learned(windy(log, EMPTY, wind_mps, direction)) for direction in some]
            answers = [cgheight.estimate_log(trip, vehicle=one) for one in trucks if one]
            name = f"learned from one {kind}, {wind_mps:.0f} m/s"
            found[kind, wind_mps] = judged(name, answers)
    assert all(found[kind, 0.0][0] < 0.01 for kind in empty)
    # One turn says too little of the wind: this is a limit, and documented as one.
    rms, heights, hold, _ = found["rounded-step", 3.0]
    assert rms > 0.03
    assert hold < heights
    # 95 % of sixteen are fifteen, less two for chance; no more than two miss.
    held = [found["drive", wind_mps] for wind_mps in (3.0, 5.0)]
    assert sum(one[2] for one in held) >= 13
    assert sum(one[1] for one in held) <= sum(one[2] for one in held) + 2
