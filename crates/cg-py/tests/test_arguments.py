"""Arguments that are no such thing are refused with what to give, or are read as meant."""

from __future__ import annotations

import numpy as np
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


def test_an_array_that_is_not_aligned_is_copied(kraz, turn):
    raw = b"\0" * 5 + turn["roll_rad"].tobytes()
    odd = np.frombuffer(raw, offset=5, dtype="f8")
    assert not odd.flags.aligned
    expected = cgheight.estimate(**turn, vehicle=kraz)
    assert cgheight.estimate(**{**turn, "roll_rad": odd}, vehicle=kraz) == expected


@pytest.mark.parametrize("form", [np.asarray, list])
def test_complex_numbers_are_refused(form, kraz, turn):
    both = {**turn, "roll_rad": form(turn["roll_rad"] + 1j)}
    with pytest.raises(ValueError, match=r"roll_rad does not contain numbers: .*their real part"):
        cgheight.estimate(**both, vehicle=kraz)
    with pytest.raises(ValueError, match="speed_mps is not a number"):
        cgheight.estimate_log(LOG, vehicle=kraz, speed_mps=np.complex128(3))


@pytest.mark.parametrize(("option", "message"), [
    ({"method": 3}, 'method is "3": it must be "filtered", "arx" or "gain"'),
    ({"channel": None}, 'channel is "None": it must be'),
    ({"model": 3}, 'model is "3": it must be'),
    ({"columns": ["a"]}, "columns is a list: give a dict of signals and their names"),
])  # fmt: skip
def test_options_of_another_type_are_named(option, message, kraz):
    with pytest.raises(ValueError, match=message):
        cgheight.estimate_log(LOG, vehicle=kraz, **option)


def test_scenarios_of_another_type_are_named(kraz):
    with pytest.raises(ValueError, match="seed is -1: it must be from 0 to 18446744073709551615"):
        cgheight.Scenario("sine", seed=-1)
    with pytest.raises(ValueError, match="seed is 18446744073709551616"):
        cgheight.Scenario("sine", seed=2**64)
    with pytest.raises(ValueError, match="inclinometer is 'no': it must be True or False"):
        cgheight.Sensors(inclinometer="no")
    with pytest.raises(ValueError, match='plant is "3": it must be "linear"'):
        cgheight.simulate(kraz, cgheight.Scenario("sine", plant=3))
    with pytest.raises(ValueError, match='maneuver is "3": it must be "rounded-step"'):
        cgheight.simulate(kraz, cgheight.Scenario(3))


@pytest.mark.parametrize("snr_db", [np.nan, np.inf, -301.0])
def test_a_signal_to_noise_ratio_has_limits(snr_db, kraz):
    scenario = cgheight.Scenario("sine", sensors=cgheight.Sensors(snr_db=snr_db))
    with pytest.raises(ValueError, match=r"signal-to-noise ratio \(dB\) .* between -300 and 300"):
        cgheight.simulate(kraz, scenario)


def test_one_state_may_stand_alone(kraz, tmp_path):
    empty = FIXTURES / "logs" / "A_p00_v50_L.csv"
    state = tmp_path / "state.json"
    state.write_text(cgheight.learn_log(empty, vehicle=kraz))
    known = [cgheight.calibrate(kraz, [], tmp_path / "one.toml", from_state=state)]
    known.append(cgheight.calibrate(kraz, [], tmp_path / "two.toml", from_state=str(state)))
    assert all(truck.is_calibrated for truck in known)
    with pytest.raises(FileNotFoundError, match=r"nowhere\.json: cannot be read"):
        cgheight.calibrate(kraz, [], tmp_path / "x.toml", from_state="nowhere.json")


@pytest.mark.parametrize("steer_rad", [np.nan, np.inf, -np.inf, 1.5])
@pytest.mark.parametrize("plant", ["reduced", "linear", "nonlinear"])
@pytest.mark.parametrize("maneuver", ["rounded-step", "lane-change", "drive"])
def test_a_steer_angle_has_limits(steer_rad, plant, maneuver, kraz):
    scenario = cgheight.Scenario(maneuver, plant=plant, steer_rad=steer_rad)
    with pytest.raises(ValueError, match=r"steer_rad .* must lie between -1 and 1"):
        cgheight.simulate(kraz, scenario)


def test_a_mass_has_a_standard_deviation_however_it_is_given(kraz, turn):
    rows, mass_kg, sd_kg = len(turn["time_s"]), turn["trailer_mass_kg"], 2000.0
    one_kg = float(np.mean(mass_kg))

    def height(mass, sd=None):
        given = {**turn, "trailer_mass_kg": mass}
        if sd is not None:
            given["trailer_mass_sd_kg"] = sd
        return cgheight.estimate(**given, vehicle=kraz)

    exact = height(one_kg)
    same = [
        height((one_kg, sd_kg)),
        height(one_kg, sd_kg),
        height(one_kg, np.full(rows, sd_kg)),
        height(np.full(rows, one_kg), sd_kg),
        height(np.full(rows, one_kg), np.full(rows, sd_kg)),
    ]
    for found in same:
        assert found.height_sd_m > 1.2 * exact.height_sd_m
        # A mass of all rows and one in each row are smoothed differently.
        assert found.height_sd_m == pytest.approx(same[0].height_sd_m, rel=1e-3)
    with pytest.raises(ValueError, match="give one of them"):
        height((one_kg, sd_kg), np.full(rows, sd_kg))
    with pytest.raises(ValueError, match="negative"):
        height(one_kg, -1.0)
