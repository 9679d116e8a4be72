"""Banked roads: channels that do not feel the bank, and the roads of a vehicle."""

from __future__ import annotations

import pickle

import pytest

import cgheight
from conftest import FIXTURES

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
    assert not any("on_road" in message for message in answer.messages)
    with pytest.raises(ValueError, match="expected flat, public, or the standard deviation"):
        truck.on_road("steep")
