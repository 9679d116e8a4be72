"""Banked roads: channels that do not feel the bank, the roads of a vehicle, simulated drives."""

from __future__ import annotations

import json
import pickle
import subprocess

import numpy as np
import pytest

import cgheight
from cgheight import ChassisSensors, Scenario, Sensors
from conftest import FIXTURES, cg

LOG = FIXTURES / "roads" / "B_rural_p16_h170.csv.gz"
MASS_KG, HEIGHT_M = 22_318.23, 1.7


@pytest.fixture(scope="module")
def truck():
    """Return the independent truck of these logs, not calibrated."""
    return cgheight.Vehicle.load(FIXTURES / "vehicles" / "euro.toml")


@pytest.mark.parametrize("channel", ["auto", "suspension", "tractor"])
def test_a_banked_road_does_not_change_the_height(truck, channel):
    answer = cgheight.estimate_log(LOG, vehicle=truck, trailer_mass_kg=MASS_KG, channel=channel)
    assert answer.channel == ("combined" if channel == "auto" else channel)
    # The data sheet alone; the static gains of the truck differ from it by 0.8 %.
    assert answer.height_m == pytest.approx(HEIGHT_M, rel=0.02)
    low, high = answer.height_ci95_m
    assert low < HEIGHT_M < high


def test_a_roll_sensor_has_no_height_unless_the_road_is_said_to_be_flat(truck):
    log = cgheight.read_log(LOG)
    names = ["steer_rad", "speed_mps", "lateral_acceleration_mps2", "roll_to_gravity_rad"]
    columns = {name: log[name] for name in ["time_s", *names]}
    refused = cgheight.estimate_log(columns, vehicle=truck, trailer_mass_kg=MASS_KG)
    assert refused.height_m is None or refused.height_sd_m > 0.2
    assert any('vehicle.on_road("flat")' in message for message in refused.messages)
    flat = pickle.loads(pickle.dumps(truck.on_road("flat")))
    answer = cgheight.estimate_log(columns, vehicle=flat, trailer_mass_kg=MASS_KG)
    # This road is not flat, and the curves show it.
    assert answer.height_m is None
    assert any("the road is banked" in message for message in answer.messages)
    with pytest.raises(ValueError, match="expected flat, public, or the standard deviation"):
        truck.on_road("steep")


@pytest.fixture
def banked(tmp_path):
    """Return a straight road of 100 m whose left side is the higher one."""
    path = tmp_path / "road.csv"
    path.write_text("distance_m,curvature_per_m,bank_rad\n0,0,0.02\n100,0,0.02\n")
    return path


def test_a_drive_on_a_road_is_that_of_the_command_line(truck, tmp_path):
    python, program, truth_file = (tmp_path / name for name in ("p.csv", "c.csv", "truth.json"))
    log = cgheight.simulate(
        truck,
        Scenario(
            road="roundabouts",
            road_twist=True,
            height_m=1.8,
            payload_kg=12e3,
            duration_s=15,
            rate_hz=50,
            sensors=Sensors(snr_db=30),
            chassis=ChassisSensors(level_noise_m=5e-4, tilt_quantisation_rad=1e-3),
            seed=3,
        ),
        output=python,
    )
    options = (
        "--road roundabouts --road-twist --height-m 1.8 --payload-kg 12000 --duration-s 15 "
        "--rate-hz 50 --snr-db 30 --level-noise-m 5e-4 --tilt-quantisation-rad 1e-3 --seed 3"
    )
    files = ["--vehicle", FIXTURES / "vehicles" / "euro.toml", "-o", program, "--truth", truth_file]
    subprocess.run([cg(), "simulate", *options.split(), *files], check=True)
    truth = json.loads(truth_file.read_text())
    track = truth.pop("track")
    assert log.truth == truth
    assert {name: values.tolist() for name, values in log.track.items()} == track
    ours, theirs = cgheight.read_log(python), cgheight.read_log(program)
    assert set(ours) == set(theirs) == set(log.signals)
    assert {"level_left_m", "tractor_tilt_rad", "lateral_specific_force_mps2"} < set(ours)
    for name, values in theirs.items():
        assert np.array_equal(ours[name], values), name
        # The files have time stamps in microseconds.
        rounding = 5e-7 if name == "time_s" else 0.0
        assert np.max(np.abs(log.signals[name] - values)) <= rounding, name


def test_a_simulated_drive_on_a_banked_road_gives_its_height_back(truck):
    log = cgheight.simulate(
        truck, Scenario(road="rural", height_m=1.9, payload_kg=16e3, rate_hz=50)
    )
    answer = cgheight.estimate_log(log, vehicle=truck)
    # Like the table of docs/sensors.md for this truck on rural roads: 0.6 % at worst.
    assert answer.height_m == pytest.approx(1.9, rel=0.01)
    bank_rad = log.track["bank_rad"]
    assert log.truth["road"]["bank_rad"] == [bank_rad.min(), bank_rad.max()]
    assert bank_rad.min() < -0.03
    assert bank_rad.max() > 0.03


def test_a_road_is_read_from_a_file_that_stays(truck, banked):
    drive = Scenario(road=banked, speed_mps=10, duration_s=8)
    log = cgheight.simulate(truck, drive)
    assert set(log.track["bank_rad"]) == {0.02}
    # The speed is held by the driver; 8 s at 10 m/s.
    assert log.truth["road"]["driven_m"] == pytest.approx(80, rel=0.01)
    assert cgheight.simulate(truck, Scenario("sine", duration_s=5)).track is None
    with pytest.raises(ValueError, match="road"):
        cgheight.simulate(truck, drive, output=banked, force=True)
    assert banked.read_text().startswith("distance_m")


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({}, "give either maneuver or road"),
        ({"maneuver": "sine", "road": "rural"}, "give either maneuver or road"),
        ({"maneuver": "sine", "chassis": {"tilt_noise_rad": 1e-3}}, "chassis: only for a drive on"),
        ({"road": "rural", "gate_m": 20.0, "start_s": 3.0}, "start_s, gate_m: only for a maneuver"),
        ({"road": "rural", "chassis": {"level_noise_m": "much"}}, "level_noise_m is not a number"),
        ({"road": "rural", "chassis": {"level_noise_m": -1.0}}, "level noise"),
        ({"road": "rural", "sensors": {"inclinometer": True}}, "inclinometer: a log of a drive on"),
        ({"speed_mps": 10.0, "duration_s": 12.0}, "ends after 10.0 s; reduce duration_s"),
    ],
)
def test_what_cannot_be_driven_says_so_in_python_words(truck, banked, keywords, message):
    if "speed_mps" in keywords:
        keywords = keywords | {"road": banked}
    parts = {"chassis": ChassisSensors, "sensors": Sensors}

    def simulated():
        made = {name: parts[name](**keywords[name]) for name in parts if name in keywords}
        return cgheight.simulate(truck, Scenario(**(keywords | made)))

    with pytest.raises(ValueError, match=message) as raised:
        simulated()
    assert "--" not in str(raised.value)


def test_an_unknown_road_and_an_unreadable_one_are_named(truck, banked):
    with pytest.raises(FileNotFoundError, match=r"rurla .*one of rural, motorway, roundabouts"):
        cgheight.simulate(truck, Scenario(road="rurla"))
    banked.write_text("distance_m,curvature_per_m,bank_rad\n0,0,0\n9,0,x\n")
    with pytest.raises(ValueError, match=r"road\.csv: line 3, column 3 `bank_rad`"):
        cgheight.simulate(truck, Scenario(road=banked))
    with pytest.raises(ValueError, match="road: the accuracy is mapped with a maneuver"):
        cgheight.accuracy_map(truck, [1.8], [20], scenario=Scenario(road="rural"), runs=1)
