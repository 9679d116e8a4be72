"""A truck learns itself from trips with the empty trailer, as with `cg run`."""

from __future__ import annotations

import json
import pickle

import numpy as np
import pytest

import cgheight
from conftest import FIXTURES

LOGS = FIXTURES / "logs"
EMPTY, LADEN = LOGS / "A_p00_v50_L.csv", LOGS / "A_p20_h190_v50_L.csv"
LADEN_M = 1.9


def driven(vehicle, path, **options):
    """Return the estimator after a log."""
    names = path.read_text().splitlines()[0].split(",")
    stream = cgheight.Estimator(vehicle, **options)
    for row in np.loadtxt(path, delimiter=",", skiprows=1):
        stream.push(**dict(zip(names, row.tolist(), strict=True)))
    return stream


@pytest.fixture(scope="module")
def learned(kraz):
    """Return what the truck learns from one trip with the empty trailer."""
    return driven(kraz, EMPTY).learned()


def test_an_empty_trip_mends_a_laden_one(kraz, learned):
    trips = json.loads(learned)["trips"]
    assert len(trips) == 1
    assert trips[0]["trailer_mass_kg"] == pytest.approx(kraz.empty_trailer_mass_kg, rel=1e-3)
    after = driven(kraz, LADEN, learned=learned)
    before, mended = (
        abs(one.estimate().height_m / LADEN_M - 1) for one in (driven(kraz, LADEN), after)
    )
    assert mended < 0.5 * before
    assert mended < 0.01
    # A laden trip teaches nothing.
    assert json.loads(after.learned()) == json.loads(learned)


def test_a_pickle_keeps_what_was_learned(kraz, learned):
    one = driven(kraz, EMPTY, learned=learned)
    assert len(json.loads(one.learned())["trips"]) == 2
    assert pickle.loads(pickle.dumps(one)).learned() == one.learned()


def test_a_log_teaches_what_its_rows_teach(kraz, learned):
    of_log = json.loads(cgheight.learn_log(EMPTY, vehicle=kraz))
    of_rows = json.loads(learned)
    ratio = [one.pop("ratio") for one in (*of_log["trips"], *of_rows["trips"])]
    assert of_log == of_rows
    assert ratio[0] == ratio[1]
    assert json.loads(cgheight.learn_log(LADEN, vehicle=kraz))["trips"] == []
    with pytest.raises(FileNotFoundError, match="nowhere"):
        cgheight.learn_log("nowhere.csv", vehicle=kraz)


def test_a_given_mass_teaches_nothing(kraz):
    stream = driven(kraz, EMPTY, trailer_mass_kg=kraz.empty_trailer_mass_kg)
    assert json.loads(stream.learned())["trips"] == []


def test_what_was_not_learned_is_refused(kraz, learned):
    unknown = learned.replace("speed_mps", "speed")
    impossible = learned.replace('"maneuvers":1', '"maneuvers":0')
    for text in ["", "{}", unknown, impossible]:
        with pytest.raises(ValueError, match="learned"):
            cgheight.Estimator(kraz, learned=text)


def test_what_another_truck_has_learned_is_refused(kraz, learned, tmp_path):
    other = kraz.with_({"steering_ratio": 20.0})
    with pytest.raises(ValueError, match="another truck than"):
        cgheight.Estimator(other, learned=learned)
    with pytest.raises(ValueError, match="another truck than"):
        cgheight.calibrate(other, [], tmp_path / "other.toml", from_state=[learned])
    # A state file says of which truck it is, its part of what was learned does not.
    of_state = json.loads(learned)
    del of_state["vehicle_crc32"]
    cgheight.Estimator(kraz, learned=json.dumps(of_state))


def test_a_trip_moves_a_calibration_unless_it_contains_the_trip(kraz, learned, tmp_path):
    def sd_m(truck, **options):
        return driven(truck, LADEN, **options).estimate().height_sd_m

    of_laden = cgheight.calibrate(kraz, [(LADEN, LADEN_M)], tmp_path / "laden.toml")
    moved = driven(of_laden, LADEN, learned=learned)
    assert abs(moved.estimate().height_m / LADEN_M - 1) < 0.02
    assert 0 < moved.estimate().height_sd_m < sd_m(of_laden)
    dates = [line for line in (tmp_path / "laden.toml").read_text().splitlines() if "date" in line]
    assert dates == [f'date = "{json.loads(moved.learned())["calibration_date"]}"']
    of_trip = cgheight.calibrate(kraz, [], tmp_path / "trip.toml", from_state=[learned])
    assert sd_m(of_trip, learned=learned) == sd_m(of_trip)
