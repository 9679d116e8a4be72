"""The logs of the independent truck, through every entry point."""

from __future__ import annotations

import gzip
import json
import tomllib

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest

import cgheight
from conftest import FIXTURES, LOGS, ONE_TURN, read

JSON_KEYS = [
    "status", "height_m", "height_sd_m", "height_ci95_m", "ratio", "ratio_sd", "method", "channel",
    "speed_mps", "trailer_mass_kg", "lift_axle", "snr_db", "fit_percent",
    "static_rollover_threshold_g", "static_rollover_threshold_ci95_g", "road_share",
    "channels", "maneuvers", "messages",
]  # fmt: skip
MANEUVER_KEYS = [
    "start_s", "end_s", "height_m", "height_sd_m", "ratio", "ratio_sd", "snr_db", "status",
    "reason",
]  # fmt: skip

# A log and its arrays contain the same float64 numbers, and the arithmetic is the same. If a unit
# is converted, each value changes by one rounding (1.1e-16) and a mean of them by less.
SAME = 1e-12


def arrays(name: str, vehicle: cgheight.Vehicle, **options) -> cgheight.Estimate:
    signals = read(name)
    fixed = [signals.pop(key) for key in ("time_s", "steer_rad", "roll_rad")]
    return cgheight.estimate(*fixed, **signals, vehicle=vehicle, **options)


def assert_same(one: cgheight.Estimate, other: cgheight.Estimate) -> None:
    assert one.status == other.status == "ok"
    assert one.height_m == pytest.approx(other.height_m, rel=SAME)
    assert one.height_sd_m == pytest.approx(other.height_sd_m, rel=SAME)
    assert (one.channel, one.messages) == (other.channel, other.messages)
    assert len(one.maneuvers) == len(other.maneuvers) >= 1


def test_there_are_logs():
    assert len(LOGS) == 10
    assert sum(name.endswith(".gz") for name in LOGS) == 1


@pytest.mark.parametrize("name", LOGS)
def test_arrays_files_frames_and_rows_give_the_same_height(name, kraz):
    from_arrays = arrays(name, kraz)
    assert_same(from_arrays, cgheight.estimate_log(FIXTURES / "logs" / name, vehicle=kraz))
    signals = read(name)
    assert_same(from_arrays, cgheight.estimate_log(pd.DataFrame(signals), vehicle=kraz))
    stream = cgheight.Estimator(kraz)
    for values in zip(*(column.tolist() for column in signals.values()), strict=True):
        stream.push(**dict(zip(signals, values, strict=True)))
    assert_same(from_arrays, stream.estimate())


@pytest.mark.parametrize("name", LOGS)
def test_the_true_height_lies_within_three_standard_deviations(name, kraz, truth):
    answer = arrays(name, kraz)
    error_m = answer.height_m - truth[name]["height_m"]
    # Without calibration. The probability that one of ten logs is outside 3 σ is 0.03.
    assert abs(error_m) <= 3 * answer.height_sd_m


@pytest.mark.parametrize("options", [
    {"method": "gain"},
    {"method": cgheight.Arx(3)},
    {"channel": "steer"},
    {"channel": "lateral-acceleration", "model": "complete"},
])  # fmt: skip
def test_options_reach_arrays_files_and_rows_alike(options, kraz, turn):
    answer = arrays(ONE_TURN, kraz, **options)
    assert_same(
        answer, cgheight.estimate_log(FIXTURES / "logs" / ONE_TURN, vehicle=kraz, **options)
    )
    stream = cgheight.Estimator(kraz, **options)
    for index in range(len(turn["time_s"])):
        stream.push(**{name: column[index] for name, column in turn.items()})
    assert_same(answer, stream.estimate())
    method = options.get("method", "filtered")
    assert answer.method == ("arx" if isinstance(method, cgheight.Arx) else method)
    assert answer.channel == options.get("channel", answer.channel)
    if set(options) - {"channel", "model"}:
        assert answer.height_m != arrays(ONE_TURN, kraz).height_m


def test_a_number_for_speed_and_mass_is_an_array_of_it(kraz, turn):
    rows = len(turn["time_s"])
    signals = [turn["time_s"], turn["steer_rad"], turn["roll_rad"]]
    numbers = cgheight.estimate(
        *signals, speed_mps=13.9, trailer_mass_kg=np.float64(18684), vehicle=kraz
    )
    columns = cgheight.estimate(
        *signals,
        speed_mps=np.full(rows, 13.9),
        trailer_mass_kg=np.full(rows, 18684.0),
        vehicle=kraz,
    )
    assert_same(numbers, columns)
    assert numbers.trailer_mass_kg == 18684
    assert numbers.channel == "steer"
    slower = cgheight.estimate(*signals, speed_mps=12.0, trailer_mass_kg=18684, vehicle=kraz)
    assert slower.height_m > numbers.height_m + 0.05  # less lateral acceleration, same roll


def test_lists_strided_and_single_precision_arrays_are_converted(kraz, turn):
    reference = arrays(ONE_TURN, kraz)
    signals = dict(turn)
    for name in ("time_s", "steer_rad", "roll_rad"):
        signals[name] = signals[name].tolist()
    strided = np.empty((len(turn["time_s"]), 2))
    strided[:, 0] = turn["speed_mps"]
    signals["speed_mps"] = strided[:, 0]
    signals["trailer_mass_kg"] = turn["trailer_mass_kg"].astype(np.int32)  # whole kilograms
    assert_same(reference, cgheight.estimate(**signals, vehicle=kraz))
    signals["roll_rad"] = turn["roll_rad"].astype(np.float32)
    # float32 has 24 bits: 6e-8 of each roll angle, 1e-6 with a wide margin.
    single = cgheight.estimate(**signals, vehicle=kraz)
    assert single.height_m == pytest.approx(reference.height_m, rel=1e-6)
    assert single.height_m != reference.height_m


def test_what_a_mask_hides_is_absent(kraz, turn):
    hidden = np.zeros(1700, dtype=bool)
    hidden[[3, 800]] = True
    roll_rad = np.where(hidden, 1e9, turn["roll_rad"])
    masked = {**turn, "roll_rad": np.ma.masked_array(roll_rad, hidden)}
    absent = {**turn, "roll_rad": np.where(hidden, np.nan, turn["roll_rad"])}
    answer = cgheight.estimate(**masked, vehicle=kraz)
    assert answer == cgheight.estimate(**absent, vehicle=kraz)
    assert any("2 of 1700 rows" in message for message in answer.messages)


def test_contiguous_float64_arrays_are_not_copied(turn):
    from cgheight._arrays import column

    assert column("x", turn["roll_rad"]) is turn["roll_rad"]
    assert not np.shares_memory(column("x", turn["roll_rad"][::2]), turn["roll_rad"])


def in_other_units(turn: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    return {
        "time_ms": turn["time_s"] * 1e3,
        "steer_deg": np.degrees(turn["steer_rad"]),
        'Tilt; left, "raw"': -np.degrees(turn["roll_rad"]),
        "speed_kmh": turn["speed_mps"] * 3.6,
        "lateral_acceleration_g": turn["lateral_acceleration_mps2"] / 9.80665,
        "yaw_rate_degps": np.degrees(turn["yaw_rate_radps"]),
        "trailer_mass_t": turn["trailer_mass_kg"] / 1e3,
        "remark": np.zeros(len(turn["time_s"])),
    }


def test_frames_in_other_units_and_names_follow_the_rules_of_files(kraz, turn, tmp_path):
    frame = pd.DataFrame(in_other_units(turn))
    options = {"columns": {"roll": 'Tilt; left, "raw"[deg]'}, "flip": ("roll",), "vehicle": kraz}
    from_frame = cgheight.estimate_log(frame, **options)
    path = tmp_path / "log.csv"
    frame.to_csv(path, index=False, float_format="%.17g")
    assert_same(from_frame, cgheight.estimate_log(path, **options))
    assert_same(from_frame, arrays(ONE_TURN, kraz))
    assert_same(from_frame, cgheight.estimate_log(str(path), **{**options, "flip": "roll"}))


def test_frames_may_have_gaps_and_only_need_columns_and_items(kraz, turn):
    class Table:
        def __init__(self, data):
            self.data = data
            self.columns = list(data)

        def __getitem__(self, name):
            return self.data[name].tolist()

    assert_same(arrays(ONE_TURN, kraz), cgheight.estimate_log(Table(turn), vehicle=kraz))
    frame = pd.DataFrame(turn)
    frame["roll_rad"] = frame["roll_rad"].astype("Float64")
    frame.loc[3, "roll_rad"] = pd.NA
    answer = cgheight.estimate_log(frame, vehicle=kraz)
    assert answer.status == "ok"
    assert any("1 of 1700 rows" in message for message in answer.messages)


@pytest.mark.parametrize("absent", [None, pd.NA, np.nan])
def test_every_way_to_say_that_a_value_is_absent(absent, kraz, turn):
    gaps = {name: column.copy() for name, column in turn.items()}
    gaps["roll_rad"][700:760] = np.nan
    expected = cgheight.estimate(**gaps, vehicle=kraz)
    assert expected != cgheight.estimate(**turn, vehicle=kraz)
    frame = pd.DataFrame(turn).astype({"roll_rad": object})
    frame.loc[700:759, "roll_rad"] = absent
    assert_same(cgheight.estimate_log(frame, vehicle=kraz), expected)
    if absent is not pd.NA:  # which is no number anywhere else
        stream = cgheight.Estimator(kraz)
        for index in range(len(turn["time_s"])):
            row = {name: column[index] for name, column in turn.items()}
            stream.push(**row | ({"roll_rad": absent} if 700 <= index < 760 else {}))
        assert_same(stream.estimate(), expected)


@pytest.mark.parametrize("form", ["arrow", "pandas"])
def test_other_columns_may_share_a_name(form, kraz, turn):
    names = [*turn, "note", "note"]
    values = [*turn.values(), np.zeros(len(turn["time_s"])), np.ones(len(turn["time_s"]))]
    if form == "arrow":
        table = pa.table(values, names=names)
    else:
        table = pd.DataFrame(np.transpose(values), columns=names)
    assert_same(cgheight.estimate_log(table, vehicle=kraz), cgheight.estimate(**turn, vehicle=kraz))


def test_gzip_is_read_as_what_it_holds(kraz, tmp_path):
    path = tmp_path / "log.csv.gz"
    path.write_bytes(gzip.compress((FIXTURES / "logs" / ONE_TURN).read_bytes()))
    assert_same(arrays(ONE_TURN, kraz), cgheight.estimate_log(path, vehicle=kraz))


def test_wheel_and_tilt_stand_in_for_steer_and_roll(kraz, turn, tmp_path):
    text = (FIXTURES / "vehicles" / "kraz.toml").read_text()
    file = tomllib.loads(text)
    tilt_rad = turn["roll_rad"] + turn["lateral_acceleration_mps2"] / file["gravity_mps2"]
    signals = {key: value for key, value in turn.items() if key != "roll_rad"}
    flat = kraz.on_road("flat")  # a tilt gives the roll angle relative to gravity
    answer = cgheight.estimate(**signals, roll_rad=None, tilt_rad=tilt_rad, vehicle=flat)
    # One rounding of each angle: 1e-16 of 0.3 rad against a roll angle of 0.03 rad.
    assert answer.height_m == pytest.approx(arrays(ONE_TURN, kraz).height_m, rel=1e-9)
    assert "steering_ratio" not in file
    path = tmp_path / "wheel.toml"
    path.write_text("steering_ratio = 20.0\n" + text)
    signals = {key: value for key, value in turn.items() if key != "steer_rad"}
    answer = cgheight.estimate(
        **signals,
        steer_rad=None,
        steering_wheel_rad=20.0 * turn["steer_rad"],
        vehicle=cgheight.Vehicle.load(path),
        channel="steer",
    )
    expected = arrays(ONE_TURN, kraz, channel="steer").height_m
    assert answer.height_m == pytest.approx(expected, rel=1e-9)  # one rounding, too


def test_the_load_of_the_axles_stands_in_for_the_mass(kraz, turn):
    signals = {key: value for key, value in turn.items() if key != "trailer_mass_kg"}

    def by_axles(load_kg):
        loads_kg = np.full(len(turn["time_s"]), load_kg)
        return cgheight.estimate(**signals, trailer_axle_load_kg=loads_kg, vehicle=kraz)

    # The mass is a linear function of the axle load: two points give the load of the known mass.
    light, heavy = (by_axles(load_kg).trailer_mass_kg for load_kg in (10e3, 20e3))
    assert heavy - light > 10e3
    mass_kg = float(turn["trailer_mass_kg"][0])
    answer = by_axles(10e3 + 10e3 * (mass_kg - light) / (heavy - light))
    assert answer.trailer_mass_kg == pytest.approx(mass_kg, rel=1e-12)
    assert answer.height_m == pytest.approx(arrays(ONE_TURN, kraz).height_m, rel=1e-9)


def test_the_attributes_are_the_keys_of_the_json_output(kraz):
    answer = arrays(ONE_TURN, kraz)
    plain = json.loads(json.dumps(answer.to_dict()))
    assert list(plain) == JSON_KEYS
    assert list(plain["maneuvers"][0]) == MANEUVER_KEYS
    for key in JSON_KEYS[:-3]:
        value = getattr(answer, key)
        assert plain[key] == (list(value) if isinstance(value, tuple) else value)
    assert [channel["height_m"] for channel in plain["channels"]] == [
        channel.height_m for channel in answer.channels
    ]
    assert plain["maneuvers"][0]["height_m"] == answer.maneuvers[0].height_m
    low, high = answer.height_ci95_m
    # 1.96 is the quantile to three digits.
    assert high - low == pytest.approx(2 * 1.96 * answer.height_sd_m, rel=1e-3)


def test_answers_are_frozen_and_show_themselves(kraz):
    answer = arrays(ONE_TURN, kraz, channel="steer")
    expected = f"height {answer.height_m:.2f} ± {answer.height_sd_m:.2f} m"
    assert repr(answer) == f"Estimate({expected}, steer channel, 1 maneuver)"
    assert repr(answer.maneuvers[0]).startswith("Maneuver(1.93 to ")
    assert repr(kraz).startswith('Vehicle("kraz", 13.89 m/s')
    with pytest.raises(AttributeError):
        answer.height_m = 2.0
    with pytest.raises(AttributeError):
        kraz.name = "other"


def test_a_log_without_a_turn_is_rejected_not_an_error(kraz, turn):
    straight = {name: column[:150] for name, column in turn.items()}
    answer = cgheight.estimate(**straight, vehicle=kraz)
    assert (answer.status, answer.height_m, answer.maneuvers) == ("rejected", None, ())
    assert answer.messages[0].startswith("rejected: unexcited")
    assert repr(answer).startswith("Estimate(rejected: unexcited")
    assert json.loads(json.dumps(answer.to_dict()))["height_ci95_m"] is None


def test_messages_name_python_keywords(kraz, turn):
    answer = cgheight.estimate(turn["time_s"], turn["steer_rad"], turn["roll_rad"], vehicle=kraz)
    text = " ".join(answer.messages)
    assert "give speed_mps" in text
    assert "give trailer_mass_kg" in text
    assert "--" not in text


def test_the_stream_tells_straight_from_turning(kraz, turn):
    stream = cgheight.Estimator(kraz)
    seen = [
        stream.push(**{name: column[index] for name, column in turn.items()})
        for index in range(len(turn["time_s"]))
    ]
    assert stream.push(99.0) == "absent"
    assert set(seen) == {"straight", "turning"}
    turning = np.abs(turn["lateral_acceleration_mps2"])
    # A turn begins above 0.5 m/s² and ends below 0.3 m/s². The status lags the signal by 0.25 s, in
    # which the signal changes by less than 0.8 m/s².
    assert all(status == "turning" for status, a in zip(seen, turning, strict=True) if a > 1.3)
    assert all(status == "straight" for status, a in zip(seen, turning, strict=True) if a < 0.3)


def test_the_answer_so_far_does_not_end_the_log(kraz, turn):
    stream = cgheight.Estimator(kraz)
    assert stream.estimate().status == "rejected"
    for index in range(len(turn["time_s"])):
        stream.push(**{name: column[index] for name, column in turn.items()})
        if index == 900:
            early = stream.estimate()
    assert early.status == "ok"
    assert_same(stream.estimate(), arrays(ONE_TURN, kraz))
    assert stream.estimate() == stream.estimate()
