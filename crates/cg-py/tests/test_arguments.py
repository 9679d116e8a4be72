"""Arguments that are no such thing are refused with what to give, or are read as meant."""

from __future__ import annotations

import pytest

import cgheight
from cgheight.can import HeightListener
from conftest import FIXTURES, ONE_TURN

LOG = FIXTURES / "logs" / ONE_TURN
NOT_POSSIBLE = [
    ({"speed_mps": 60.1}, "speed_mps is 60.1: it must be at most 60"),
    ({"trailer_mass_kg": 281_390.0}, "trailer_mass_kg is 281390: it must be at most 200000"),
    ({"trailer_mass_kg": 29.0}, "29 kg is below the empty trailer's 8684 kg"),
]


@pytest.mark.parametrize(("option", "message"), NOT_POSSIBLE)
def test_what_no_truck_can_have_is_refused_by_every_way_in(option, message, kraz, turn):
    for call in (
        lambda: cgheight.estimate(**{**turn, **option}, vehicle=kraz),
        lambda: cgheight.estimate(**{**turn, **option}, vehicle=kraz, method="arx"),
        lambda: cgheight.estimate_log(LOG, vehicle=kraz, **option),
        lambda: cgheight.estimate_log(turn, vehicle=kraz, **option),
        lambda: cgheight.estimate_logs([LOG], vehicle=kraz, **option),
        lambda: cgheight.Estimator(kraz, **option),
        lambda: HeightListener(kraz, **option),
        lambda: cgheight.predict_roll(LOG, 1.7, vehicle=kraz, **option),
        lambda: cgheight.linear_model(kraz, **option),
        lambda: cgheight.rollover_measures(kraz, **option),
    ):
        with pytest.raises(ValueError, match=message):
            call()


def test_heights_and_simulated_loads_have_limits(kraz):
    with pytest.raises(ValueError, match="height_m is 19: it must be at most 6"):
        cgheight.predict_roll(LOG, 19.0, vehicle=kraz)
    with pytest.raises(ValueError, match="height_m is 19: it must be at most 6"):
        cgheight.linear_model(kraz, height_m=19.0)
    heavy = cgheight.Scenario("sine", trailer_mass_kg=3e5)
    with pytest.raises(ValueError, match="trailer_mass_kg is 300000: it must be at most 200000"):
        cgheight.simulate(kraz, heavy)


def test_the_listener_refuses_keywords_that_there_are_not(kraz):
    with pytest.raises(TypeError, match="there is no keyword spede_mps; there are speed_mps"):
        HeightListener(kraz, spede_mps=12.0)
    with pytest.raises(TypeError, match="there is no keyword learned"):
        HeightListener(kraz, learned="{}")
