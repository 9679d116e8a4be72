"""A roll rate in the place of a roll angle, and beside one, with the faults of a gyroscope."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import cgheight
from cgheight import Scenario, Sensors

HEIGHT_M = 1.6


@pytest.fixture(scope="module")
def truck(kraz, tmp_path_factory):
    """Return the truck on a test track, calibrated on drives of the nonlinear plant."""
    flat = kraz.on_road("flat")
    runs = [(drive(flat, seed, height_m, 30), height_m) for seed, height_m in ((1, 1.4), (2, 2.1))]
    return cgheight.calibrate(flat, runs, tmp_path_factory.mktemp("rate") / "truck.toml")


def drive(truck, seed, height_m, snr_db=None) -> dict[str, np.ndarray]:
    sensors = Sensors(snr_db=snr_db)
    scenario = Scenario("drive", height_m=height_m, plant="nonlinear", seed=seed, sensors=sensors)
    return dict(cgheight.simulate(truck, scenario).signals)


@pytest.fixture(scope="module")
def clean(truck):
    """Return a drive that is not in the calibration."""
    return drive(truck, 3, HEIGHT_M)


def rate(log, offset_degps, drift_degps_per_min, mounting_deg) -> np.ndarray:
    """Return what a gyroscope with noise of 0.005 °/s/√Hz at 100 Hz measures."""
    time_s = log["time_s"]
    noise = 0.05 * np.random.default_rng(1).standard_normal(len(time_s))
    wrong = offset_degps + drift_degps_per_min * time_s / 60 + noise
    felt = np.sin(np.radians(mounting_deg)) * log["yaw_rate_radps"]
    return np.gradient(log["roll_rad"], time_s) + np.radians(wrong) + felt


FAULTS = [(0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.5, 0.0, 1.0), (-0.5, 0.1, -1.0)]


def test_a_table_has_the_interval_of_its_file(truck, clean, tmp_path):
    log = {**clean, "roll_rate_radps": rate(clean, *FAULTS[3])}
    del log["roll_rad"]
    path = tmp_path / "rate.csv"
    columns = np.column_stack(list(log.values()))
    np.savetxt(path, columns, delimiter=",", header=",".join(log), comments="", fmt="%.12g")
    of_table, of_file = (cgheight.estimate_log(one, vehicle=truck) for one in (log, path))
    assert of_table.height_ci95_m == pytest.approx(of_file.height_ci95_m, rel=1e-6)


@pytest.mark.parametrize("fault", FAULTS)
def test_a_rate_alone_gives_an_interval_that_holds(fault, truck, clean):
    log = {**clean, "roll_rate_radps": rate(clean, *fault)}
    del log["roll_rad"]
    answer = cgheight.estimate_log(log, vehicle=truck)
    low, high = answer.height_ci95_m
    assert low <= HEIGHT_M <= high
    assert high - low < 0.2 * HEIGHT_M
    assert any("integral of roll_rate" in message for message in answer.messages)
    assert len(cgheight.read_log(log).columns) == len(log) + 1


@pytest.mark.parametrize("fault", FAULTS)
def test_a_rate_beside_an_angle_gives_an_interval_that_holds(fault, truck, clean):
    log = {**drive(truck, 3, HEIGHT_M, 30), "roll_rate_radps": rate(clean, *fault)}
    answer = cgheight.estimate_log(log, vehicle=truck)
    low, high = answer.height_ci95_m
    assert low <= HEIGHT_M <= high
    assert any("fast part" in message for message in answer.messages)


def test_a_rate_with_the_wrong_sign_is_not_used_and_told(truck, clean):
    alone = cgheight.estimate_log(clean, vehicle=truck)
    log = {**clean, "roll_rate_radps": -rate(clean, 0.0, 0.0, 0.0)}
    answer = cgheight.estimate_log(log, vehicle=truck)
    assert answer.height_m == alone.height_m
    assert any('flip="roll_rate"' in message for message in answer.messages)
    right = cgheight.estimate_log(log, vehicle=truck, flip="roll_rate")
    assert not any("flip" in message for message in right.messages)


def test_too_few_turns_give_no_height_from_a_rate(truck):
    scenario = Scenario("lane-change", height_m=HEIGHT_M, plant="nonlinear")
    log = dict(cgheight.simulate(truck, scenario).signals)
    log["roll_rate_radps"] = np.gradient(log.pop("roll_rad"), log["time_s"])
    answer = cgheight.estimate_log(log, vehicle=truck)
    assert answer.height_m is None
    assert any("the first 3 only show" in message for message in answer.messages)


def test_a_rate_that_cannot_be_used_is_told(truck, clean):
    log = {**clean, "tilt_rad": clean["roll_rad"], "roll_rate_radps": rate(clean, 0.0, 0.0, 0.0)}
    del log["roll_rad"]
    answer = cgheight.estimate_log(log, vehicle=truck)
    (told,) = [message for message in answer.messages if "roll_rate is not used" in message]
    assert "the log has tilt instead" in told


def test_an_estimator_of_rows_says_that_it_does_not_use_a_rate(truck, clean):
    with_rate = cgheight.Estimator(truck)
    without = cgheight.Estimator(truck)
    names = ("speed_mps", "lateral_acceleration_mps2")
    for row in range(0, 2000):
        signals = {name: clean[name][row] for name in names}
        arguments = (clean["time_s"][row], clean["steer_rad"][row], clean["roll_rad"][row])
        without.push(*arguments, **signals)
        with_rate.push(*arguments, **signals, roll_rate_radps=0.0)
    with_rate = pickle.loads(pickle.dumps(with_rate))
    (told,) = set(with_rate.estimate().messages) - set(without.estimate().messages)
    assert "cgheight.estimate_log uses it" in told
