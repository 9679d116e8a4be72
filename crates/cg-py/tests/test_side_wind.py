"""What a side wind does to heights, calibrations and trips: the figures of docs/limits.md.

The nonlinear plant is driven with the side of a box body, in winds with gusts from many directions.
``pytest -s`` prints the figures.
"""

from __future__ import annotations

import json

import numpy as np
import pytest

import cgheight
from conftest import FIXTURES

BOX = {"side_area_m2": 34.0, "side_height_m": 2.4, "speed_mps": 3.0}
EMPTY_KG = 6318.0
Load = tuple[float, float | None]
EMPTY: Load = (0.0, None)
LADEN: Load = (18e3, 1.9)
TEST: Load = (12e3, 1.9)
DIRECTIONS = 8
# A drive turns to all sides, so its direction at the start matters less, and it takes a second.
WINDS = {"rounded-step": (0.0, 3.0, 5.0), "drive": (0.0, 3.0)}
STARTS = {"rounded-step": range(8), "drive": range(0, 8, 2)}
UNIX_S = 1.79e9  # a date, as learning expects it


@pytest.fixture(scope="module")
def plain(tmp_path_factory) -> cgheight.Vehicle:
    """Load a vehicle file that says nothing of the wind."""
    text = (FIXTURES / "vehicles" / "euro.toml").read_text()
    file = tmp_path_factory.mktemp("plain") / "plain.toml"
    file.write_text(text.partition("[wind]")[0])
    return cgheight.Vehicle.load(file).on_road("flat")


@pytest.fixture(scope="module")
def boxed(plain) -> cgheight.Vehicle:
    return plain.with_({"wind": BOX})


def drive(boxed, maneuver: str, load: Load, wind: tuple[float, int], noise: tuple[float, int]):
    """Simulate a drive in a wind, m/s and direction, with noise, dB and seed."""
    (payload_kg, height_m), (wind_mps, direction), (snr_db, seed) = load, wind, noise
    scenario = cgheight.Scenario(
        maneuver,
        plant="nonlinear",
        payload_kg=payload_kg,
        height_m=height_m,
        rate_hz=50.0,
        duration_s=300.0 if maneuver == "drive" else 20.0,
        sensors=cgheight.Sensors(snr_db=snr_db),
        wind_mps=wind_mps,
        wind_from_rad=2 * np.pi * direction / DIRECTIONS + 0.3,
        seed=seed + 10 * direction,
    )
    return cgheight.simulate(boxed, scenario)


class Judged:
    """The answers to some logs of one load, printed."""

    def __init__(self, name: str, answers: list[cgheight.Estimate], truth_m: float) -> None:
        """Judge the answers by the true height."""
        heights = [one for one in answers if one.height_m is not None]
        missing = [
            one for one in heights if not one.height_ci95_m[0] <= truth_m <= one.height_ci95_m[1]
        ]
        # Without a height both are NaN, which is within no bound.
        errors = np.array([one.height_m / truth_m - 1 for one in heights] or [np.nan])
        stated = np.array([one.height_sd_m / truth_m for one in heights] or [np.nan])
        self.rms = float(np.sqrt(np.mean(errors**2)))
        self.stated = float(np.sqrt(np.mean(stated**2)))
        self.heights, self.hold = len(heights), len(heights) - len(missing)
        silent = sum(not any("side wind" in text for text in one.messages) for one in missing)
        self.silent = silent
        print(
            f"{name}: {100 * self.rms:.1f} % rms, {100 * self.stated:.1f} % stated; "
            f"{self.hold} of {self.heights} hold, {silent} miss without a message on wind, "
            f"{len(answers)} logs"
        )


def intervals_hold(cases) -> None:
    """Check that 95 % of the intervals hold, less three standard deviations of the binomial."""
    cases = list(cases)
    heights, hold = (sum(getattr(one, name) for one in cases) for name in ("heights", "hold"))
    assert heights >= 22  # of 24
    assert hold >= 0.95 * heights - 3 * np.sqrt(0.95 * 0.05 * heights)


def calibrated(boxed, file, kind: str, wind_mps: float, direction: int, out):
    """Calibrate a vehicle file on an empty and a laden run in a wind from any two directions.

    None if it is refused, because the turns of a run contradict each other.
    """
    of_empty, of_laden = (
        drive(boxed, kind, load, (wind_mps, (1 + 2 * k) * direction % DIRECTIONS), (35.0, k))
        for k, load in enumerate((EMPTY, LADEN))
    )
    runs = [(of_empty.signals, "empty"), (of_laden.signals, LADEN[1])]
    try:
        return cgheight.calibrate(file, runs, out)
    except ValueError:
        return None


def test_a_side_wind_is_in_the_interval_if_the_file_describes_the_body(plain, boxed, tmp_path):
    files = {
        name: calibrated(boxed, file, "rounded-step", 0.0, 0, tmp_path / f"{name}.toml")
        for name, file in {"with [wind]": boxed, "without": plain}.items()
    }
    found = {}
    for kind, winds in WINDS.items():
        for load in (TEST, EMPTY):
            for wind_mps in winds:
                some = STARTS[kind] if wind_mps else range(1)
                logs = [drive(boxed, kind, load, (wind_mps, k), (30.0, 3)) for k in some]
                for name, file in files.items():
                    answers = [cgheight.estimate_log(one.signals, vehicle=file) for one in logs]
                    case = f"{kind}, {load[0] / 1e3:.0f} t, {wind_mps:.0f} m/s, {name}"
                    truth_m = logs[0].truth["height_m"]
                    found[kind, load, wind_mps, name] = Judged(case, answers, truth_m)
    intervals_hold(
        found[kind, load, 3.0, "with [wind]"] for kind in WINDS for load in (TEST, EMPTY)
    )
    for load in (TEST, EMPTY):
        # The interval is neither too narrow nor too wide: for eight errors, three standard
        # deviations of their mean square are 1.5 of it.
        step = found["rounded-step", load, 3.0, "with [wind]"]
        assert step.rms < 1.6 * step.stated
        assert step.stated < 2.0 * step.rms
        # A file that says nothing of the body has intervals without the wind, and messages on it.
        alone = found["rounded-step", load, 3.0, "without"]
        assert alone.stated < 0.7 * alone.rms
        assert alone.hold < alone.heights
        assert alone.silent == 0
    # Nothing changes in a calm, but what is stated.
    calm = [found["drive", TEST, 0.0, name] for name in files]
    assert all(one.rms < 0.005 for one in calm)


def test_calibrations_and_trips_in_a_side_wind_say_so(boxed, tmp_path):
    trip = drive(boxed, "drive", TEST, (0.0, 0), (30.0, 3)).signals

    def learned(kind: str, wind_mps: float, direction: int) -> cgheight.Vehicle | None:
        log = drive(boxed, kind, EMPTY, (wind_mps, direction), (30.0, 5)).signals
        mass_kg = np.full(log["time_s"].size, EMPTY_KG)
        dated = {**log, "time_s": log["time_s"] + UNIX_S, "trailer_mass_kg": mass_kg}
        text = cgheight.learn_log(dated, vehicle=boxed)
        if not json.loads(text)["trips"]:
            return None  # the trip was refused
        return cgheight.calibrate(boxed, [], tmp_path / "l.toml", from_state=text, force=True)

    found = {}
    for kind, winds in WINDS.items():
        for wind_mps in winds:
            some = STARTS[kind] if wind_mps else range(1)
            trucks = {
                "calibrated on": [
                    calibrated(boxed, boxed, kind, wind_mps, k, tmp_path / "c.toml") for k in some
                ],
                "learned from": [learned(kind, wind_mps, k) for k in some],
            }
            for how, each in trucks.items():
                answers = [cgheight.estimate_log(trip, vehicle=one) for one in each if one]
                name = f"{how} {kind}, {wind_mps:.0f} m/s"
                found[how, kind, wind_mps] = Judged(name, answers, TEST[1])
    intervals_hold(one for (_, _, wind_mps), one in found.items() if wind_mps == 3.0)
    for how in ("calibrated on", "learned from"):
        step = found[how, "rounded-step", 3.0]
        assert step.rms < 1.6 * step.stated
    # A stronger wind than the file says is worse, and is not hidden by wide intervals.
    assert found["learned from", "rounded-step", 5.0].rms > 0.02
