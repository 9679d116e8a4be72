"""The plant steps; plants and estimators copy and pickle."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

import cgheight
from cgheight import Estimator, Plant, Scenario

LOAD = {"height_m": 1.9, "payload_kg": 12e3}


def test_steps_drive_as_a_simulated_log(baseline):
    # At the rate of the plant's steps, so that the steer angle between two rows is the same too.
    scenario = Scenario(
        "drive",
        plant="nonlinear",
        duration_s=5,
        start_s=0.5,
        rate_hz=1000,
        speed_change=0.1,
        **LOAD,
    )
    log = cgheight.simulate(baseline, scenario).signals
    steer, speed = log["steer_rad"], log["speed_mps"]
    assert np.ptp(steer) > 0.005
    plant = Plant(baseline, speed_mps=speed[0], **LOAD)
    start = plant.signals
    driven = plant.drive(steer[1:], 1e-3, speed_mps=speed[1:])
    for name, values in log.items():
        ours = np.array([start[name], *driven[name]])
        # Rounding: the times of the log are multiples of the interval, those of the plant a sum.
        assert np.max(np.abs(ours - values)) <= 1e-9, name
    assert plant.time_s == pytest.approx(5.0)
    # The true states contain what the sensors show.
    assert np.array_equal(driven["trailer_roll_rad"], driven["roll_rad"])
    assert plant.states["trailer_roll_rad"] == driven["roll_rad"][-1]


def test_traces_are_steps_one_after_the_other(kraz):
    steer = 0.02 * np.sin(np.arange(50) / 8)
    bank = np.linspace(0.0, 0.03, 50)
    together, alone = Plant(kraz), Plant(kraz)
    table = together.drive(list(steer), 0.02, bank_rad=bank)
    for k in range(50):
        row = alone.step(steer[k], 0.02, bank_rad=bank[k])
        assert all(table[name][k] == value for name, value in row.items())
    assert together.states == alone.states
    # On a bank whose left side is higher, it leans to the right. The bank is across the mean
    # heading of both units, so a unit sees less of it by half of its turn's square.
    heading_rad = max(abs(alone.states[f"{unit}_yaw_rad"]) for unit in ("tractor", "trailer"))
    lean_rad = alone.signals["roll_to_gravity_rad"] - alone.signals["roll_rad"]
    assert lean_rad == pytest.approx(0.03, rel=heading_rad**2)
    assert heading_rad < 0.1
    # Without a speed it keeps its own, and so does the road.
    assert alone.step(0.0, 0.02)["speed_mps"] == kraz.nominal_speed_mps
    assert alone.signals["roll_to_gravity_rad"] > alone.signals["roll_rad"]


@pytest.mark.parametrize(("height_m", "other_m"), [(1.4, 2.2), (2.2, 1.4)])
def test_an_estimator_on_the_plant_finds_the_height(kraz, height_m, other_m):
    plant, estimator = Plant(kraz, height_m=height_m, payload_kg=12e3), Estimator(kraz)
    for k in range(1500):
        steer = float(np.interp(k / 100, [3, 4, 9, 10], [0.0, 0.03, 0.03, 0.0]))
        estimator.push(**plant.step(steer, 0.01))
    answer = estimator.estimate()
    low, high = answer.height_ci95_m
    assert low < height_m < high
    assert not low < other_m < high


def test_a_driver_follows_a_path(baseline):
    x = np.linspace(0.0, 300.0, 301)
    # Into the next lane within 60 m.
    y = 3.5 * np.clip((x - 40.0) / 60.0, 0.0, 1.0)
    plant = Plant(baseline, speed_mps=15.0, path_m=np.column_stack([x, y]))
    plant.drive(np.full(900, np.nan), 0.02)
    assert plant.states["position_x_m"] == pytest.approx(270.0, abs=1.0)
    # The preview driver has no integral part; on a straight path he has no lasting error.
    assert plant.states["position_y_m"] == pytest.approx(3.5, abs=0.05)
    # He may be overruled.
    before = plant.states["tractor_yaw_rad"]
    plant.drive(np.full(100, 0.02), 0.02)
    assert plant.states["tractor_yaw_rad"] > before + 0.05
    with pytest.raises(ValueError, match="the driver keeps the speed"):
        plant.step(None, 0.02, speed_mps=10.0)


def test_a_vehicle_that_rolls_over_stays(baseline):
    plant = Plant(baseline, height_m=2.4, speed_mps=25.0)
    plant.drive(np.full(200, 0.1), 0.05)
    assert plant.rolled_over
    assert "rolled over" in repr(plant)
    there = plant.states
    plant.step(0.0, 1.0)
    assert plant.states == there


DUPLICATES = {
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
    "pickle": lambda one: pickle.loads(pickle.dumps(one)),
}


@pytest.mark.parametrize("duplicate", DUPLICATES.values(), ids=DUPLICATES)
@pytest.mark.parametrize("count", [0, 20])
def test_a_copy_of_the_plant_goes_its_own_way(kraz, duplicate, count):
    load = {**LOAD, "payload_behind_hitch_m": 5.5, "payload_left_m": 0.1}
    path_m = [(0, 0), (50, 0), (100, 20)]
    plant = Plant(kraz, **load, speed_mps=12.0, bank_rad=0.01, grade_rad=0.02, path_m=path_m)
    plant.drive(np.full(count, np.nan), 0.1, bank_rad=np.linspace(0.01, 0.03, count))
    other = duplicate(plant)
    here = plant.states
    assert (other.states, other.signals) == (here, plant.signals)
    other.drive(np.full(30, np.nan), 0.1)
    assert plant.states == here
    assert repr(other) != repr(plant)
    plant.drive(np.full(30, np.nan), 0.1)
    assert plant.states == other.states
    # A copy of a copy, which the driver leaves.
    third = duplicate(other)
    third.drive([0.02] * 10, 0.05)
    other.drive([0.02] * 10, 0.05)
    assert third.states == other.states


def test_a_pickled_plant_that_rolled_over_stays(baseline):
    plant = Plant(baseline, height_m=2.4, speed_mps=25.0)
    plant.drive(np.full(200, 0.1), 0.05)
    other = pickle.loads(pickle.dumps(plant))
    assert other.rolled_over
    other.step(0.0, 1.0)
    assert (other.states, other.time_s) == (plant.states, plant.time_s)


def test_the_plant_of_another_version_or_a_damaged_one_is_refused(baseline):
    restore, (version, *parts, state) = Plant(baseline).__reduce__()
    with pytest.raises(ValueError, match=r"this Plant was pickled by cgheight 0\.0\.1, and"):
        restore("0.0.1", *parts, state)
    with pytest.raises(ValueError, match="the state of a plant is damaged"):
        restore(version, *parts, state[:100])
    with_driver = Plant(baseline, path_m=[(0, 0), (50, 0)]).__reduce__()[1][-1]
    with pytest.raises(ValueError, match="a driver and no path"):
        restore(version, *parts, with_driver)


@pytest.mark.parametrize(
    ("start", "step", "message"),
    [
        ({"height_m": 19.0}, {}, "height"),
        ({"payload_kg": 1e3, "trailer_mass_kg": 2e4}, {}, "both given: give one"),
        ({"speed_mps": 0.0}, {}, "speed_mps 0 must be positive"),
        ({"bank_rad": 1.0}, {}, r"bank_rad 1 must lie between -0\.5 and 0\.5"),
        ({"path_m": [(0, 0)]}, {}, "path_m has 1 points"),
        ({"path_m": [(0, 0), (float("nan"), 0)]}, {}, "it must be finite"),
        ({}, {"steer_rad": None}, "steer_rad is absent, and there is no driver"),
        ({}, {"steer_rad": 3.0}, "steer_rad 3 must lie"),
        ({}, {"interval_s": 0.0}, "interval_s 0 must be positive"),
        ({}, {"grade_rad": float("inf")}, "grade_rad inf must lie"),
    ],
)
def test_what_the_plant_cannot_do_is_an_error(baseline, start, step, message):
    def go() -> None:
        plant = Plant(baseline, **start)
        plant.step(**{"steer_rad": 0.0, "interval_s": 0.01} | step)

    with pytest.raises(ValueError, match=message):
        go()


def test_a_drive_that_fails_leaves_the_plant_where_it_was(baseline):
    plant = Plant(baseline)
    with pytest.raises(ValueError, match=r"step 2: steer_rad 9 must lie"):
        plant.drive([0.0, 0.01, 9.0], 0.1)
    assert plant.time_s == 0.0
    with pytest.raises(ValueError, match="bank_rad has 2 values and steer_rad has 3"):
        plant.drive([0.0, 0.0, 0.0], 0.1, bank_rad=[0.0, 0.0])


@pytest.mark.parametrize("method", ["filtered", "arx", "gain", cgheight.Arx(3)])
@pytest.mark.parametrize("duplicate", DUPLICATES.values(), ids=DUPLICATES)
def test_a_copy_of_an_estimator_goes_on_to_the_last_bit(kraz, turn, method, duplicate):
    rows = [dict(zip(turn, row, strict=True)) for row in zip(*turn.values(), strict=True)]
    alone = Estimator(kraz, method=method)
    states = [alone.push(**row) for row in rows]
    # In straight driving, in the turn, after it.
    turning = [k for k, state in enumerate(states) if state == "turning"]
    for place in (10, turning[0] + 5, turning[-1] - 3, len(rows) - 1):
        first = Estimator(kraz, method=method)
        for row in rows[:place]:
            first.push(**row)
        second = duplicate(first)
        there = first.estimate()
        with pytest.raises(ValueError, match="does not come after"):
            second.push(**rows[place - 1])
        assert [second.push(**row) for row in rows[place:]] == states[place:]
        assert second.estimate() == alone.estimate()
        # The first one is where it was.
        assert first.estimate() == there


def test_a_pickle_keeps_options_calibration_and_what_was_learned(kraz, turn, tmp_path):
    calibration = tmp_path / "c.toml"
    cgheight.calibrate(kraz, [(turn, 1.7)], calibration)
    one = Estimator(kraz, calibration=calibration, trailer_mass_kg=(2.4e4, 500.0), channel="steer")
    one.note = "left at the depot"
    other = pickle.loads(pickle.dumps(one))
    assert type(other) is Estimator
    assert other.note == "left at the depot"
    for k in range(len(turn["time_s"])):
        row = {name: values[k] for name, values in turn.items()}
        one.push(**row)
        other.push(**row)
    assert one.estimate().height_m is not None
    assert one.estimate() == other.estimate()
    assert one.learned() == other.learned()
    # A pickle of a pickle.
    assert pickle.loads(pickle.dumps(other)).estimate() == one.estimate()


def test_the_pickle_of_another_version_or_a_damaged_one_is_refused(kraz):
    restore, (kind, _, parts), _ = Estimator(kraz).__reduce__()
    with pytest.raises(ValueError, match=r"pickled by cgheight 0\.0\.1, and this is"):
        restore(kind, "0.0.1", parts)
    with pytest.raises(ValueError, match="the state of an estimator is damaged"):
        restore(kind, cgheight.__version__, (*parts[:3], parts[3][:100]))
