"""Simulated logs, their truth, and the tables of the thesis."""

from __future__ import annotations

import json
import tomllib
from dataclasses import fields, replace
from typing import get_type_hints

import numpy as np
import pytest

import cgheight
from cgheight import Scenario, Sensors
from conftest import FIXTURES


def test_a_simulated_log_gives_its_height_back_whichever_way_it_is_read(baseline, tmp_path):
    path = tmp_path / "turn.csv"
    log = cgheight.simulate(
        baseline, Scenario("steady-turn", height_m=1.85, payload_kg=12e3), output=path
    )
    assert log.truth["height_m"] == 1.85
    assert log.truth["trailer_mass_kg"] == baseline.empty_trailer_mass_kg + 12e3
    answer = cgheight.estimate(**log.signals, vehicle=baseline)
    # Without noise and model errors, the grid of the design remains (tests/design.rs).
    assert answer.height_m == pytest.approx(1.85, rel=2e-3)
    frame = log.to_frame()
    assert list(frame) == list(log.signals)
    assert cgheight.estimate_log(frame, vehicle=baseline) == answer
    assert cgheight.estimate_log(log, vehicle=baseline) == answer
    # The file has time stamps in microseconds and all digits of the other values.
    back = cgheight.read_log(path)
    for name, values in log.signals.items():
        assert np.max(np.abs(back[name] - values)) <= (5e-7 if name == "time_s" else 0.0)


@pytest.mark.parametrize("sensors", [Sensors(), Sensors(snr_db=20, roll_limit_rad=0.05)])
def test_the_truth_has_the_documented_keys_and_types(baseline, sensors):
    log = cgheight.simulate(baseline, Scenario("sine", duration_s=5, sensors=sensors))
    types = get_type_hints(cgheight.Truth)
    assert set(log.truth) == cgheight.Truth.__required_keys__
    for key, value in log.truth.items():
        assert isinstance(value, types[key]), key
    for field in fields(Sensors):
        assert log.truth[field.name] == getattr(sensors, field.name)


def test_sensors_do_what_their_keywords_say(baseline):
    sine = Scenario("sine", duration_s=10)
    perfect = cgheight.simulate(baseline, sine).signals
    sensors = Sensors(snr_db=20, roll_offset_rad=0.01, drop_out=0.1)
    noisy = cgheight.simulate(baseline, replace(sine, sensors=sensors, seed=3))
    there = np.isfinite(noisy.signals["roll_rad"])
    # Binomial: 1001 rows, 4 sd.
    assert abs(np.mean(~there) - 0.1) < 4 * np.sqrt(0.1 * 0.9 / 1001)
    error = noisy.signals["roll_rad"][there] - perfect["roll_rad"][there]
    sd = noisy.truth["noise_sd_rad"]
    # 20 dB: a hundredth of the mean square.
    assert sd == pytest.approx(0.1 * np.sqrt(np.mean(perfect["roll_rad"] ** 2)), rel=1e-9)
    assert np.mean(error) == pytest.approx(0.01, abs=4 * sd / np.sqrt(len(error)))
    assert np.std(error) == pytest.approx(sd, rel=4 / np.sqrt(2 * len(error)))
    tilt = cgheight.simulate(baseline, replace(sine, sensors=Sensors(inclinometer=True))).signals
    file = tomllib.loads((FIXTURES / "vehicles" / "baseline.toml").read_text())
    felt = perfect["roll_rad"] + perfect["lateral_acceleration_mps2"] / file["gravity_mps2"]
    # One rounding of each of two angles below 1 rad.
    assert np.max(np.abs(tilt["tilt_rad"] - felt)) <= 2 * np.finfo(float).eps
    assert "roll_rad" not in tilt


def test_the_driver_and_the_nonlinear_plant(baseline):
    turn = Scenario("steady-turn", plant="nonlinear", turn_rad=0.7, radius_m=120, rate_hz=50)
    log = cgheight.simulate(baseline, turn)
    yaw = np.trapezoid(log.signals["yaw_rate_radps"], log.signals["time_s"])
    # The trailer follows the tractor through the turn and settles within 5 s.
    assert yaw == pytest.approx(0.7, rel=0.02)
    right = cgheight.simulate(baseline, replace(turn, turn_rad=-0.7))
    assert right.signals["roll_rad"].min() < -0.5 * log.signals["roll_rad"].max()


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({"maneuver": "loop"}, 'maneuver is "loop": it must be "rounded-step"'),
        ({"plant": "real"}, 'plant is "real": it must be "linear"'),
        ({"height_m": 19.0}, "height"),
        ({"height_m": "high"}, "height_m is not a number"),
        ({"rate_hz": -1.0}, "rate_hz -1 must be positive"),
        ({"duration_s": 1.0}, "start_s 2 must lie between 0 and duration_s 1"),
        ({"payload_kg": 1e3, "trailer_mass_kg": 2e4}, "both given: give one"),
        ({"gate_m": 20.0}, 'gate_m for "lane-change"'),
        ({"turn_rad": 1.0, "maneuver": "steady-turn"}, 'need plant="nonlinear"'),
        ({"speed_change": 0.2}, 'for maneuver="drive"'),
        (
            {"payload_left_m": 0.1, "model": "as-printed"},
            'payload_left_m needs model="complete"',
        ),
        ({"payload_kg": -1.0}, "payload_kg is -1: it must be zero or more"),
        ({"payload_kg": float("nan")}, "payload_kg is NaN: it must be zero or more"),
        ({"payload_left_m": 1.3}, r"payload_left_m 1\.3 must lie between -1\.22 and 1\.22"),
        ({"payload_behind_hitch_m": 30.0}, "payload_behind_hitch_m 30 must be positive"),
        ({"sensors": {"drop_out": 2.0}}, "drop-out"),
        ({"sensors": {"delay_s": "late"}}, "delay_s is not a number"),
        ({"output": "log.txt"}, r"log\.txt: the name of a log ends in \.csv or"),
    ],
)
def test_what_cannot_be_simulated_says_so_in_python_words(baseline, keywords, message):
    scenario = {"maneuver": "sine"} | keywords
    output, sensors = scenario.pop("output", None), scenario.pop("sensors", {})

    def simulated():
        asked = Scenario(**scenario, sensors=Sensors(**sensors))
        return cgheight.simulate(baseline, asked, output=output)

    with pytest.raises(ValueError, match=message) as raised:
        simulated()
    assert "--" not in str(raised.value)


def test_an_empty_trailer_has_its_own_height(kraz):
    empty = cgheight.simulate(kraz, Scenario("sine", payload_kg=0, duration_s=4)).truth
    tare_m = tomllib.loads(kraz.toml)["trailer"]["tare"]["cg_height_m"]
    assert empty["height_m"] == tare_m < kraz.reference_height_m
    laden = cgheight.simulate(kraz, Scenario("sine", payload_kg=2, duration_s=4)).truth
    assert laden["height_m"] == kraz.reference_height_m


def test_the_payload_stands_where_the_scenario_says(baseline):
    beside = Scenario("sine", plant="nonlinear", duration_s=4, payload_left_m=-0.1,
                      payload_behind_hitch_m=6.0)  # fmt: skip
    log = cgheight.simulate(baseline, beside)
    assert log.truth["payload_left_m"] == -0.1
    assert log.truth["payload_behind_hitch_m"] == 6.0
    # It leans to the right before the maneuver begins.
    assert log.signals["roll_rad"][0] > 0.005


def test_an_accuracy_map_follows_the_noise(baseline):
    table = cgheight.accuracy_map(
        baseline,
        [1.8, 2.1],
        [10, 30],
        scenario=Scenario("rounded-step", duration_s=10, rate_hz=50),
        runs=40,
        jobs=2,
    )
    assert list(table.height_m) == [1.8, 1.8, 2.1, 2.1]
    assert (table.answered == 40).all()
    loud, quiet = table[table.snr_db == 10], table[table.snr_db == 30]
    # Ten times the noise. An RMSE of 40 runs scatters by 11 %, the ratio of two by 16 %; 4 sd.
    ratio = loud.rmse_percent.to_numpy() / quiet.rmse_percent.to_numpy()
    assert np.all((ratio > 10 * 0.36) & (ratio < 10 * 1.64))
    # No estimator has a smaller error than the bound; the RMS of 40 runs may by 4 sd.
    assert (table.rmse_percent > table.bound_percent * (1 - 4 * 0.11)).all()
    with pytest.raises(TypeError, match="unexpected keyword argument 'wheels'"):
        Scenario("sine", wheels=3)
    with pytest.raises(ValueError, match="runs is 0"):
        cgheight.accuracy_map(baseline, [1.8], [10], runs=0)


def test_the_tables_of_the_thesis_as_a_frame():
    rows = cgheight.reproduce("5.17")
    columns = ["table", "item", "thesis", "ours", "relative_error", "criterion",
               "criterion_reason", "verdict", "same_digits", "note"]  # fmt: skip
    assert list(rows) == columns
    assert (rows.table == "5.17").all()
    assert rows.same_digits.all()
    compared = rows[rows.criterion.notna()]
    assert (compared.verdict == "same").all()
    assert ((compared.ours - compared.thesis).abs() <= compared.criterion).all()
    assert rows.relative_error.abs().max() < 1e-3
    with pytest.raises(ValueError, match=r"5\.11"):
        cgheight.reproduce("17")
    with pytest.raises(ValueError, match="runs is 0"):
        cgheight.reproduce("5.9", runs=0)


def test_a_simulated_log_shows_itself(baseline):
    log = cgheight.simulate(baseline, Scenario("sine", duration_s=5))
    assert repr(log).startswith("SimulatedLog(true height ")
    assert "noise_sd_rad" in log._repr_html_()
    json.dumps(log.truth)
