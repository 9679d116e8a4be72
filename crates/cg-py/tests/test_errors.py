"""Errors: which input is refused, and the messages."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

import cgheight
from conftest import FIXTURES, ONE_TURN


def changed(turn, name, index, value):
    column = turn[name].copy()
    column[index] = value
    return {**turn, name: column}


def test_a_missing_vehicle_file_is_file_not_found(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"nowhere\.toml: cannot be read"):
        cgheight.Vehicle.load(tmp_path / "nowhere.toml")


def test_a_vehicle_file_with_a_bad_value_names_line_key_and_remedy(tmp_path):
    text = (FIXTURES / "vehicles" / "kraz.toml").read_text()
    line = next(row for row in text.splitlines() if row.startswith("nominal_speed_mps"))
    number = text.splitlines().index(line) + 1
    path = tmp_path / "bad.toml"
    path.write_text(text.replace(line, "nominal_speed_mps = -3.0"))
    with pytest.raises(ValueError, match=rf"bad\.toml:{number}:\d+: nominal_speed_mps = -3"):
        cgheight.Vehicle.load(path)
    path.write_text("name = 3 =")
    with pytest.raises(ValueError, match=r"bad\.toml: .*line 1, column"):
        cgheight.Vehicle.load(path)


def test_a_directory_for_a_vehicle_is_an_os_error(tmp_path):
    with pytest.raises(OSError, match="cannot be read"):
        cgheight.Vehicle.load(tmp_path)


@pytest.mark.parametrize("name", ["steer_rad", "roll_rad", "speed_mps", "yaw_rate_radps"])
def test_lengths_must_agree(name, kraz, turn):
    short = {**turn, name: turn[name][:-1]}
    with pytest.raises(ValueError, match=f"{name} has 1699 values and time_s has 1700"):
        cgheight.estimate(**short, vehicle=kraz)


def test_arrays_must_have_one_dimension(kraz, turn):
    flat = {**turn, "roll_rad": turn["roll_rad"][:, None]}
    with pytest.raises(ValueError, match=r"roll_rad has shape \(1700, 1\)"):
        cgheight.estimate(**flat, vehicle=kraz)
    with pytest.raises(ValueError, match=r"time_s has shape \(\)"):
        cgheight.estimate(**{**turn, "time_s": 1.0}, vehicle=kraz)


def test_arrays_must_hold_numbers(kraz, turn):
    words = {**turn, "steer_rad": ["left"] * 1700}
    with pytest.raises(ValueError, match="steer_rad does not contain numbers"):
        cgheight.estimate(**words, vehicle=kraz)
    dates = {**turn, "steer_rad": np.arange(1700).astype("datetime64[s]")}
    with pytest.raises(ValueError, match="steer_rad does not contain numbers: dates"):
        cgheight.estimate(**dates, vehicle=kraz)


def test_time_must_be_there_and_increase(kraz, turn):
    with pytest.raises(ValueError, match=r"time_s\[7\] is NaN"):
        cgheight.estimate(**changed(turn, "time_s", 7, np.nan), vehicle=kraz)
    with pytest.raises(ValueError, match=r"time_s\[0\] is NaN"):
        cgheight.estimate(**changed(turn, "time_s", 0, np.nan), vehicle=kraz)
    with pytest.raises(ValueError, match=r"time_s\[9\] = 0.08 does not come after time_s\[8\]"):
        cgheight.estimate(**changed(turn, "time_s", 9, 0.08), vehicle=kraz)
    with pytest.raises(ValueError, match=r"time_s\[9\] = -1 does not come after time_s\[8\]"):
        cgheight.estimate(**changed(turn, "time_s", 9, -1.0), vehicle=kraz)
    # A tenth of a microsecond is below the resolution of the estimator.
    with pytest.raises(ValueError, match=r"time_s\[9\] = 0.0800001: .* does not follow"):
        cgheight.estimate(**changed(turn, "time_s", 9, 0.0800001), vehicle=kraz)


@pytest.mark.parametrize("value", [np.inf, -np.inf])
@pytest.mark.parametrize("name", ["steer_rad", "roll_rad", "trailer_mass_kg"])
def test_infinity_is_refused(name, value, kraz, turn):
    with pytest.raises(ValueError, match=rf"{name}\[40\] = -?inf is not finite"):
        cgheight.estimate(**changed(turn, name, 40, value), vehicle=kraz)


def test_a_negative_standard_deviation_is_refused(kraz, turn):
    sd_kg = np.full(len(turn["time_s"]), 500.0)
    sd_kg[40] = -500.0
    with pytest.raises(ValueError, match=r"trailer_mass_sd_kg\[40\] = -500 is negative"):
        cgheight.estimate(**turn, trailer_mass_sd_kg=sd_kg, vehicle=kraz)


def test_nothing_cannot_be_estimated(kraz, turn):
    empty = {name: column[:0] for name, column in turn.items()}
    with pytest.raises(ValueError, match="time_s is empty"):
        cgheight.estimate(**empty, vehicle=kraz)
    with pytest.raises(ValueError, match="roll_rad is missing"):
        cgheight.estimate(turn["time_s"], turn["steer_rad"], None, vehicle=kraz)
    with pytest.raises(ValueError, match="steer_rad is missing"):
        cgheight.estimate(turn["time_s"], None, turn["roll_rad"], vehicle=kraz)


@pytest.mark.parametrize(("option", "message"), [
    ({"method": "magic"}, 'method is "magic": it must be "filtered", "arx" or "gain"'),
    ({"channel": "yaw"}, 'channel is "yaw"'),
    ({"model": "simple"}, 'model is "simple"'),
    ({"method": cgheight.Arx(0)}, "order is 0: it must be from 1 to 10"),
    ({"method": cgheight.Arx(11)}, "order is 11"),
    ({"speed_mps": -1.0}, "speed_mps is -1: it must be positive"),
    ({"speed_mps": "fast"}, "speed_mps is not a number"),
    ({"trailer_mass_kg": np.nan}, "trailer_mass_kg is NaN: it must be positive"),
])  # fmt: skip
def test_options_are_checked_by_every_way_in(option, message, kraz, turn):
    with pytest.raises(ValueError, match=message):
        cgheight.estimate(**{**turn, **option}, vehicle=kraz)
    with pytest.raises(ValueError, match=message):
        cgheight.estimate_log(FIXTURES / "logs" / ONE_TURN, vehicle=kraz, **option)
    with pytest.raises(ValueError, match=message):
        cgheight.Estimator(kraz, **option)


def test_a_calibration_that_is_none_is_refused_by_every_way_in(kraz, turn, tmp_path):
    nowhere = tmp_path / "nowhere.toml"
    with pytest.raises(FileNotFoundError, match=r"nowhere\.toml"):
        cgheight.estimate(**turn, vehicle=kraz, calibration=nowhere)
    with pytest.raises(FileNotFoundError, match=r"nowhere\.toml"):
        cgheight.estimate_log(FIXTURES / "logs" / ONE_TURN, vehicle=kraz, calibration=nowhere)
    with pytest.raises(FileNotFoundError, match=r"nowhere\.toml"):
        cgheight.Estimator(kraz, calibration=nowhere)


def test_a_signal_that_there_is_not_is_refused_with_those_there_are(kraz, turn):
    with pytest.raises(TypeError, match=r"rol_rad is not a signal; the signals are time_s"):
        cgheight.estimate(**turn, rol_rad=turn["roll_rad"], vehicle=kraz)
    with pytest.raises(TypeError, match="rol_rad is not a signal"):
        cgheight.Estimator(kraz).push(0.0, 0.0, 0.0, rol_rad=0.1)
    assert list(cgheight.SIGNALS)[:3] == ["time_s", "steer_rad", "steering_wheel_rad"]


def test_a_missing_log_is_file_not_found(kraz, tmp_path):
    with pytest.raises(FileNotFoundError, match=r"nowhere\.csv: cannot be opened"):
        cgheight.estimate_log(tmp_path / "nowhere.csv", vehicle=kraz)


def test_a_bad_row_is_named_with_file_line_and_column(kraz, tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("time_s,steer_rad,roll_rad\n0.0,0.0,0.0\n0.1,0.0,much\n")
    with pytest.raises(ValueError, match=r"log\.csv, line 3, column 3 `roll_rad`: `much`"):
        cgheight.estimate_log(path, vehicle=kraz)
    path.write_text("time_s,steer_rad,roll_rad\n0.0,0.0,0.0\n0.0000001,0.0,0.0\n")
    with pytest.raises(ValueError, match=r"log\.csv, line 3: .* does not follow"):
        cgheight.estimate_log(path, vehicle=kraz)


@pytest.mark.parametrize("kind", ["file", "frame"])
def test_a_missing_column_comes_with_a_remedy_in_python(kind, kraz, turn, tmp_path):
    frame = pd.DataFrame(turn).rename(columns={"roll_rad": "Roll sensor"})
    log = frame
    if kind == "file":
        log = tmp_path / "log.csv"
        frame.to_csv(log, index=False)
    with pytest.raises(ValueError, match="no column for roll_rad or tilt_rad") as caught:
        cgheight.estimate_log(log, vehicle=kraz)
    assert 'columns={"roll": "Roll sensor[deg]"}' in str(caught.value)
    assert "--" not in str(caught.value)
    with pytest.raises(ValueError, match="`Roll` is not a signal"):
        cgheight.estimate_log(log, vehicle=kraz, columns={"Roll": "Roll sensor"})
    with pytest.raises(ValueError, match="`kmh` is not a unit of roll"):
        cgheight.estimate_log(log, vehicle=kraz, columns={"roll": "Roll sensor[kmh]"})
    options = {"columns": {"roll": "Roll sensor[rad]"}, "flip": ["time"]}
    with pytest.raises(ValueError, match="time cannot be flipped"):
        cgheight.estimate_log(log, vehicle=kraz, **options)


def test_a_frame_must_be_one(kraz, turn):
    with pytest.raises(ValueError, match="log is of type list: give a path or a data frame"):
        cgheight.estimate_log(list(turn.values()), vehicle=kraz)
    with pytest.raises(ValueError, match="two different ones; the units of roll are rad, deg"):
        cgheight.estimate_log(
            pd.DataFrame(turn).rename(columns={"roll_rad": "roll_grad"}), vehicle=kraz
        )


def test_the_stream_refuses_a_row_and_goes_on(kraz, turn):
    stream = cgheight.Estimator(kraz)
    reference = cgheight.Estimator(kraz)
    for index in range(len(turn["time_s"])):
        row = {name: column[index] for name, column in turn.items()}
        stream.push(**row)
        reference.push(**row)
        if index == 700:
            with pytest.raises(ValueError, match="time_s is NaN"):
                stream.push(np.nan, 0.1, 0.1)
            with pytest.raises(ValueError, match=r"time_s = 7 does not come after 7"):
                stream.push(7.0, 0.1, 0.1)
            with pytest.raises(ValueError, match="does not follow"):
                stream.push(7.0000001, 0.1, 0.1)
            with pytest.raises(ValueError, match="roll_rad = inf is not finite"):
                stream.push(7.005, 0.1, np.inf)
            with pytest.raises(ValueError, match="trailer_mass_sd_kg = -1 is negative"):
                stream.push(7.005, 0.1, 0.1, trailer_mass_sd_kg=-1.0)
    assert stream.estimate().height_m == reference.estimate().height_m


def test_a_stream_may_not_begin_with_an_absent_time(kraz):
    stream = cgheight.Estimator(kraz)
    with pytest.raises(ValueError, match="time_s is NaN"):
        stream.push(np.nan)
    assert stream.push(5.0, 0.0, 0.0, speed_mps=10.0) == "straight"


@pytest.mark.parametrize(("arguments", "message"), [
    ({"na": -1}, "na is -1: it must be 0 or more"),
    ({"nb": 0}, "nb is 0: it must be 1 or more"),
    ({"nk": -1}, "nk is -1"),
    ({"na": 21, "nb": 20}, r"na \+ nb is 41: it must be 40 or less"),
    ({"nb": 9, "nk": 41}, r"nk \+ nb is 50: it must be 49 or less"),
    ({"ts": 0.0}, "ts is 0: it must be positive"),
    ({"ts": "slow"}, "ts is not a number"),
    ({"y": np.zeros(9)}, "y has 9 values and u has 100"),
    ({"u": np.zeros((100, 1))}, r"u has shape \(100, 1\)"),
    ({"y": [np.nan] * 100}, r"y\[0\] is NaN"),
    ({"u": [0.0] * 99 + [np.inf]}, r"u\[99\] is inf"),
])  # fmt: skip
def test_arx_checks_its_arguments(arguments, message):
    random = np.random.default_rng(1)
    good = {"u": random.standard_normal(100), "y": random.standard_normal(100)}
    good |= {"na": 2, "nb": 2, "nk": 1, "ts": 0.05}
    assert cgheight.arx(**good).rows == 98
    with pytest.raises(ValueError, match=message):
        cgheight.arx(**{**good, **arguments})


def test_unexcited_data_name_the_regressor():
    random = np.random.default_rng(2)
    y = random.standard_normal(50)
    with pytest.raises(ValueError, match=r"unexcited: the regressor u\(t-1\) is a linear"):
        cgheight.arx(np.zeros(50), y, 2, 2, 1, 0.05)
    with pytest.raises(ValueError, match=r"unexcited: the regressor u\(t-4\)"):
        cgheight.arx(np.ones(50), y, 2, 2, 3, 0.05)
    with pytest.raises(ValueError, match=r"unexcited: the regressor u\(t\)"):
        cgheight.arx(np.zeros(50), y, 2, 2, 0, 0.05)
    with pytest.raises(ValueError, match=r"unexcited: the regressor y\(t-1\)"):
        cgheight.arx(random.standard_normal(50), np.zeros(50), 2, 2, 1, 0.05)
    with pytest.raises(ValueError, match="unexcited: 3 rows for 4 coefficients"):
        cgheight.arx(np.arange(5.0), y[:5], 2, 2, 1, 0.05)


def test_what_is_unusual_in_a_vehicle_file_is_a_warning(tmp_path):
    text = (FIXTURES / "vehicles" / "kraz.toml").read_text()
    path = tmp_path / "unusual.toml"
    key = "spring_stiffness_n_per_m"
    path.write_text(text.replace(f"{key} = 592176.3", f"{key} = 6e6"))
    with pytest.warns(UserWarning, match=r"unusual\.toml:\d+:\d+: warning: tractor\.axle\[0\]"):
        cgheight.Vehicle.load(path)


def test_all_that_is_wrong_with_a_vehicle_file_is_told_at_once(tmp_path):
    text = (FIXTURES / "vehicles" / "kraz.toml").read_text()
    text = text.replace("floor_height_m = 1.27", "floor_height_m = 1270")
    text = text.replace("sprung_mass_kg = 10000.0", "sprung_mass_kg = 10.0")
    path = tmp_path / "wrong.toml"
    path.write_text(text)
    with pytest.raises(ValueError, match=r"sprung_mass_kg = 10: ") as refused:
        cgheight.Vehicle.load(path)
    assert "trailer.payload.floor_height_m = 1270: " in str(refused.value)


def test_an_endless_file_is_refused_at_once(kraz, tmp_path):
    with pytest.raises(OSError, match=r"/dev/zero: cannot be read \(it has more than the 1 MiB"):
        cgheight.Vehicle.load("/dev/zero")
    with pytest.raises(OSError, match=r"/dev/zero: cannot be read \(it has more than the 1 MiB"):
        kraz.calibrated("/dev/zero")
    (tmp_path / "a.log").write_text("")
    with pytest.raises(OSError, match=r"/dev/zero: cannot be read: it has more than the 16 MiB"):
        cgheight.can.read_log(tmp_path / "a.log", dbc="/dev/zero", signals={"roll": "Roll"})
