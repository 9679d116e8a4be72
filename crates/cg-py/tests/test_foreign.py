"""Logs as people have them: each form works at the first try, through every function.

One test for each row of the table of files in docs/python.md.
"""

from __future__ import annotations

import re
from datetime import UTC, datetime, timedelta

import asammdf
import h5py
import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pyarrow.feather
import pyarrow.parquet
import pytest
import scipy.io

import cgheight
from cgheight import Scenario, Sensors
from conftest import FIXTURES, ONE_TURN, read

# A Unix time in double precision has a resolution of 2.4e-7 s, beside steps of 0.01 s. What follows
# from a whole turn changes by much less than one step of 2.4e-5.
CLOCK = 1e-4
START = datetime(2024, 5, 1, 12, tzinfo=UTC)


@pytest.fixture(scope="module")
def height(kraz) -> float:
    """Return the height from the log as this project writes it."""
    answer = cgheight.estimate_log(FIXTURES / "logs" / ONE_TURN, vehicle=kraz)
    assert answer.status == "ok"
    return answer.height_m


def stamps(turn: dict[str, np.ndarray]) -> np.ndarray:
    """Return points in time, ns."""
    since_ns = np.round(turn["time_s"] * 1e9).astype("timedelta64[ns]")
    return np.datetime64("2024-05-01T12:00:00", "ns") + since_ns


def clocked(turn: dict[str, np.ndarray], name: str = "when") -> pd.DataFrame:
    frame = pd.DataFrame({key: values for key, values in turn.items() if key != "time_s"})
    frame.insert(0, name, stamps(turn))
    return frame


CLOCKS = {
    "column of datetime64": lambda frame: frame,
    "DatetimeIndex": lambda frame: frame.set_index("when"),
    "DatetimeIndex without a name": lambda frame: frame.set_index("when").rename_axis(None),
    "TimedeltaIndex": lambda frame: frame.set_index(
        pd.TimedeltaIndex(frame.pop("when") - pd.Timestamp("2024-05-01 12:00"))
    ),
    "time zone": lambda frame: frame.assign(when=frame.when.dt.tz_localize("Europe/Berlin")),
    "timedelta64": lambda frame: frame.assign(when=frame.when - frame.when[0]),
    "objects": lambda frame: frame.assign(when=frame.when.dt.to_pydatetime().astype(object)),
    "text": lambda frame: frame.assign(when=frame.when.astype(str)),
    "polars Datetime": pl.from_pandas,
    "polars Duration": lambda frame: pl.from_pandas(frame).with_columns(
        pl.col("when") - START.replace(tzinfo=None)
    ),
    "Arrow timestamp": lambda frame: pa.Table.from_pandas(frame),
    "pandas with Arrow": lambda frame: frame.astype({"when": "timestamp[us][pyarrow]"}),
}


@pytest.mark.parametrize("form", CLOCKS)
def test_time_stamps_of_data_frames(form, kraz, turn, height):
    table = CLOCKS[form](clocked(turn))
    assert cgheight.estimate_log(table, vehicle=kraz).height_m == pytest.approx(height, rel=CLOCK)
    time_s = cgheight.read_log(table).time_s.to_numpy()
    assert time_s - time_s[0] == pytest.approx(turn["time_s"] - turn["time_s"][0], abs=1e-6)
    if form in (
        "column of datetime64",
        "DatetimeIndex",
        "polars Datetime",
        "Arrow timestamp",
        "text",
    ):
        assert time_s[0] == pytest.approx(START.timestamp() + turn["time_s"][0], abs=1e-6)


def test_time_stamps_of_arrays(kraz, turn, height):
    signals = {**turn, "time_s": stamps(turn)}
    answer = cgheight.estimate(**signals, vehicle=kraz)
    assert answer.height_m == pytest.approx(height, rel=CLOCK)


def test_two_columns_of_time_are_not_guessed(turn, kraz):
    frame = clocked(turn).assign(sent=stamps(turn) + np.timedelta64(1, "s"))
    with pytest.raises(ValueError, match=r"no column for time_s; the columns are when, "):
        cgheight.estimate_log(frame, vehicle=kraz)
    answer = cgheight.estimate_log(frame, vehicle=kraz, columns={"time": "sent"})
    assert answer.status == "ok"


FILES = {
    "parquet timestamp[ns]": ("log.parquet", lambda frame, path: frame.to_parquet(path)),
    "parquet timestamp[us, tz]": (
        "log.parquet",
        lambda frame, path: frame.assign(
            when=frame.when.dt.tz_localize("UTC").astype("datetime64[us, UTC]")
        ).to_parquet(path),
    ),
    "parquet duration": (
        "log.parquet",
        lambda frame, path: pa.parquet.write_table(
            pa.Table.from_pandas(
                frame.assign(when=frame.when - frame.when[0]), preserve_index=False
            ),
            path,
        ),
    ),
    "parquet duration of polars": (
        "log.parquet",
        lambda frame, path: pl.from_pandas(
            frame.assign(when=frame.when - frame.when[0])
        ).write_parquet(path),
    ),
    "parquet timestamp of Spark": (
        "log.parquet",
        lambda frame, path: frame.to_parquet(path, use_deprecated_int96_timestamps=True),
    ),
    "parquet timestamp with another unit in its name": (
        "log.parquet",
        lambda frame, path: frame.rename(columns={"when": "time_ms"}).to_parquet(path),
    ),
    "parquet index": ("log.parquet", lambda frame, path: frame.set_index("when").to_parquet(path)),
    "csv of dates": ("log.csv", lambda frame, path: frame.to_csv(path, index=False)),
    "csv of a DatetimeIndex": ("log.csv", lambda frame, path: frame.set_index("when").to_csv(path)),
    "csv of an index without name": (
        "log.csv",
        lambda frame, path: frame.set_index("when").rename_axis(None).to_csv(path),
    ),
    "feather": ("log.feather", lambda frame, path: frame.to_feather(path)),
    "feather, compressed otherwise": (
        "log.arrow",
        lambda frame, path: frame.to_feather(path, compression="zstd"),
    ),
    "semicolons and decimal commas": (
        "log.csv",
        lambda frame, path: frame.to_csv(path, sep=";", decimal=",", index=False),
    ),
}


@pytest.mark.parametrize("form", FILES)
def test_files_with_time_stamps(form, kraz, turn, height, tmp_path):
    name, write = FILES[form]
    path = tmp_path / name
    write(clocked(turn), path)
    assert cgheight.estimate_log(path, vehicle=kraz).height_m == pytest.approx(height, rel=CLOCK)
    assert cgheight.read_log(path).time_s[0] == pytest.approx(
        (0.0 if "duration" in form else START.timestamp()) + turn["time_s"][0], abs=1e-6
    )


def test_a_spreadsheet_in_latin_1_with_decimal_commas_and_a_row_of_units(
    kraz, turn, height, tmp_path
):
    path = tmp_path / "messung.csv"
    wanted = {
        "Zeit": ("ms", turn["time_s"] * 1e3),
        "Lenkung": ("°", np.degrees(turn["steer_rad"])),
        "Neigung": ("°", np.degrees(turn["roll_rad"])),
        "Geschw.": ("km/h", turn["speed_mps"] * 3.6),
        "Querbeschl.": ("m/s²", turn["lateral_acceleration_mps2"]),
        "Masse": ("t", turn["trailer_mass_kg"] / 1e3),
    }
    lines = [";".join(wanted), ";".join(unit for unit, _ in wanted.values())]
    columns = [values for _, values in wanted.values()]
    lines += [
        ";".join(f"{v:.17g}".replace(".", ",") for v in row) for row in zip(*columns, strict=True)
    ]
    path.write_bytes("\r\n".join(lines).encode("latin-1"))
    names = {
        "time": "Zeit",
        "steer": "Lenkung",
        "roll": "Neigung",
        "speed": "Geschw.",
        "lateral_acceleration": "Querbeschl.",
        "trailer_mass": "Masse",
    }
    answer = cgheight.estimate_log(path, vehicle=kraz, columns=names)
    # Without the yaw rate, which only checks the acceleration. One rounding of each value.
    assert answer.height_m == pytest.approx(height, rel=1e-9)


def test_names_with_units_in_brackets(kraz, turn, height):
    frame = pd.DataFrame(
        {
            "Time [ms]": turn["time_s"] * 1e3,
            "Steer [deg]": np.degrees(turn["steer_rad"]),
            "Roll (°)": np.degrees(turn["roll_rad"]),
            "Speed [km/h]": turn["speed_mps"] * 3.6,
            "Lateral acceleration [g]": turn["lateral_acceleration_mps2"] / 9.80665,
            "Trailer mass [t]": turn["trailer_mass_kg"] / 1e3,
        }
    )
    answer = cgheight.estimate_log(frame, vehicle=kraz)
    assert answer.height_m == pytest.approx(height, rel=1e-9)


MATLAB = {
    "vectors": lambda turn, path: scipy.io.savemat(path, turn),
    "row vectors and parameters": lambda turn, path: scipy.io.savemat(
        path, {**turn, "note": "run 3", "gain": 2.5, "matrix": np.eye(3)}, oned_as="row"
    ),
    "a structure": lambda turn, path: scipy.io.savemat(path, {"log": turn}),
    "version 7.3": lambda turn, path: save_hdf5(turn, path),
}


def save_hdf5(turn: dict[str, np.ndarray], path) -> None:
    """Save as MATLAB 7.3 does: a user block with its name, and column vectors."""
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in turn.items():
            file["log/" + name] = values.reshape(1, -1)
    with open(path, "r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")


@pytest.mark.parametrize("form", MATLAB)
def test_matlab_files(form, kraz, turn, height, tmp_path):
    path = tmp_path / "log.mat"
    MATLAB[form](turn, path)
    assert cgheight.estimate_log(path, vehicle=kraz).height_m == height


def test_two_logs_in_a_file_are_not_mixed(kraz, turn, tmp_path):
    filtered = {"time_s": turn["time_s"], "roll_rad": 1.2 * turn["roll_rad"]}
    matlab, hdf5 = tmp_path / "two.mat", tmp_path / "two.h5"
    scipy.io.savemat(matlab, {"raw": turn, "filtered": filtered})
    with h5py.File(hdf5, "w") as file:
        for group, signals in (("raw", turn), ("filtered", filtered)):
            for name, values in signals.items():
                file[f"{group}/{name}"] = values
    for path in (matlab, hdf5):
        with pytest.raises(ValueError, match=r"occurs twice, in (raw|filtered) and in"):
            cgheight.estimate_log(path, vehicle=kraz)


def test_a_damaged_file_spoils_no_batch(kraz, turn, tmp_path):
    whole, damaged = tmp_path / "whole.mat", tmp_path / "damaged.mat"
    scipy.io.savemat(whole, turn, do_compression=True)
    data = whole.read_bytes()
    damaged.write_bytes(data[: len(data) // 2] + bytes(50) + data[len(data) // 2 + 50 :])
    answers = cgheight.estimate_logs([damaged, whole], vehicle=kraz, errors="reject")
    assert [answer.status for answer in answers] == ["rejected", "ok"]
    assert "damaged.mat: damaged, or not a MATLAB file" in answers[0].messages[0]


def test_columns_of_lists_are_no_clocks(kraz, turn, height):
    lists = [[1.0, 2.0]] * len(turn["time_s"])
    for frame in (pd.DataFrame(turn).assign(x=lists), pl.DataFrame({**turn, "x": lists})):
        answer = cgheight.estimate_log(frame, vehicle=kraz)
        assert answer.height_m == pytest.approx(height, rel=1e-9)


def test_what_a_matlab_file_lacks_is_said(kraz, tmp_path):
    path = tmp_path / "log.mat"
    scipy.io.savemat(path, {"x": np.eye(3)})
    with pytest.raises(ValueError, match=r"log\.mat: contains no numeric vectors; .*table2struct"):
        cgheight.estimate_log(path, vehicle=kraz)
    scipy.io.savemat(path, {"t": np.arange(9.0), "steer_rad": np.arange(9.0)})
    with pytest.raises(ValueError, match=r"log\.mat: there is no column for time_s; .*steer_rad"):
        cgheight.estimate_log(path, vehicle=kraz)


@pytest.fixture(scope="module")
def measured(turn, tmp_path_factory):
    """Write the turn as channels of an MF4 file: roll 100 Hz, steer 50 Hz, speed and mass 10 Hz."""
    mdf = asammdf.MDF()
    time_s = turn["time_s"]
    for step, channels in [
        (1, [("roll", np.degrees(turn["roll_rad"]), "deg")]),
        (
            2,
            [
                ("Wheel", np.degrees(turn["steer_rad"]), "°"),
                ("ay", turn["lateral_acceleration_mps2"], "m/s^2"),
            ],
        ),
        (
            10,
            [
                ("speed", turn["speed_mps"] * 3.6, "km/h"),
                ("trailer_mass", turn["trailer_mass_kg"], "kg"),
            ],
        ),
    ]:
        mdf.append(
            [
                asammdf.Signal(values[::step], time_s[::step], name=name, unit=unit)
                for name, values, unit in channels
            ]
        )
    return mdf.save(tmp_path_factory.mktemp("mf4") / "drive.mf4")


NAMES = {"steer": "Wheel", "lateral_acceleration": "ay"}


def test_damaged_mf4_files_are_rejected_one_by_one(measured, kraz, tmp_path):
    junk, cut = tmp_path / "junk.mf4", tmp_path / "cut.mf4"
    junk.write_bytes(b"MDF     4.10" + b"x" * 200)
    cut.write_bytes(measured.read_bytes()[:900])
    for damaged in (junk, cut):
        with pytest.raises(ValueError, match=rf"{damaged.name}: damaged"):
            cgheight.read_log(damaged)
        with pytest.raises(ValueError, match=rf"{damaged.name}: damaged"):
            cgheight.estimate_log(damaged, vehicle=kraz)
    some = [measured, junk, cut]
    found = cgheight.estimate_logs(some, vehicle=kraz, columns=NAMES, errors="reject")
    assert [answer.status for answer in found.estimates] == ["ok", "rejected", "rejected"]


def test_channels_of_different_rasters_in_mf4(measured, kraz, height, tmp_path):
    answer = cgheight.estimate_log(measured, vehicle=kraz, columns=NAMES)
    # Interpolation between 50 Hz and 100 Hz in a turn that builds up in a second.
    assert answer.height_m == pytest.approx(height, rel=2e-3)
    assert len(cgheight.read_log(measured, columns=NAMES)) == 1700
    truck = cgheight.calibrate(kraz, [(measured, 1.7)], tmp_path / "t.toml", columns=NAMES)
    assert truck.is_calibrated
    cgheight.plot.log(measured, vehicle=kraz, columns=NAMES)


@pytest.mark.parametrize("kind", ["csv", "parquet", "frame"])
def test_a_table_with_a_row_for_each_time_stamp_of_any_channel(kind, kraz, turn, height, tmp_path):
    """An outer join of two recorders that are 3 ms apart: no row has all signals."""
    roll = pd.DataFrame({"time_s": turn["time_s"], "roll_rad": turn["roll_rad"]})
    rest = pd.DataFrame({key: values for key, values in turn.items() if key != "roll_rad"})
    late = {
        key: np.interp(turn["time_s"] + 0.003, turn["time_s"], values)
        for key, values in rest.items()
    }
    late["time_s"] = turn["time_s"] + 0.003
    frame = roll.merge(pd.DataFrame(late), on="time_s", how="outer")
    assert len(frame) == 2 * len(roll)
    log = frame
    if kind != "frame":
        log = tmp_path / f"log.{kind}"
        frame.to_csv(log, index=False) if kind == "csv" else frame.to_parquet(log)
    answer = cgheight.estimate_log(log, vehicle=kraz)
    # Linear interpolation over 10 ms of a turn that builds up in a second.
    assert answer.height_m == pytest.approx(height, rel=1e-3)
    assert any("time stamps of their own" in message for message in answer.messages)


def test_patterns_folders_and_names(kraz, tmp_path):
    pattern = str(FIXTURES / "logs" / "A_p20_h*_v50_L.csv")
    answers = cgheight.estimate_logs(pattern, vehicle=kraz)
    assert len(answers) >= 3
    assert list(answers.logs) == sorted(answers.logs)
    assert cgheight.estimate_logs([pattern], vehicle=kraz) == answers
    one = cgheight.estimate_logs(FIXTURES / "logs" / ONE_TURN, vehicle=kraz)
    assert [answer.status for answer in one] == ["ok"]
    frame = pd.DataFrame(read(ONE_TURN))
    assert cgheight.estimate_logs(frame, vehicle=kraz).logs == ("table 0",)
    named = cgheight.estimate_logs({"trip 7": frame, "trip 8": frame}, vehicle=kraz)
    assert named.logs == ("trip 7", "trip 8")
    with pytest.raises(FileNotFoundError, match=r"none\*\.csv: no file matches this pattern"):
        cgheight.estimate_logs(str(tmp_path / "none*.csv"), vehicle=kraz)


def test_calibrate_takes_what_estimate_takes(kraz, tmp_path):
    def calibrated(log, **options) -> str:
        path = tmp_path / "c.toml"
        # A height that is not exact: the statement names no log.
        cgheight.calibrate(kraz, [(log, (1.7, 0.01))], path, force=True, **options)
        text = path.read_text()
        return re.sub(r"(?m)^((log|date) = .*|# crc32 .*)$", "", text)

    turn = read(ONE_TURN)
    expected = calibrated(FIXTURES / "logs" / ONE_TURN)
    assert calibrated(pd.DataFrame(turn)) == expected
    assert calibrated(pl.DataFrame(turn)) == expected
    scipy.io.savemat(tmp_path / "log.mat", turn)
    assert calibrated(tmp_path / "log.mat") == expected


@pytest.mark.parametrize("suffix", [".asc", ".blf", ".mf4", ".trc"])
def test_calibrate_takes_frames_of_every_format(suffix, kraz, tmp_path):
    # The frames have an angle to gravity.
    truck = kraz.with_({"steering_ratio": 20.0}).on_road("flat")
    log = cgheight.simulate(
        truck, Scenario("steady-turn", height_m=1.9, sensors=Sensors(snr_db=30))
    )
    paths = [tmp_path / "turn.log", tmp_path / f"turn{suffix}"]
    for path in paths:
        cgheight.write_log(log, path, vehicle=truck)
    ratios = [
        [float(value) for value in re.findall(r"(?m)^ratio = (.*)$", text)]
        for text in (
            cgheight.calibrate(truck, [(path, 1.9)], tmp_path / f"{n}.toml").toml
            and (tmp_path / f"{n}.toml").read_text()
            for n, path in enumerate(paths)
        )
    ]
    assert len(ratios[0]) >= 2
    # ASC and TRC store times to 10 µs and 100 µs of steps of 20 ms.
    assert ratios[1] == pytest.approx(ratios[0], rel=1e-3)


def test_a_sensor_upside_down_is_told_with_the_option_that_turns_it(kraz, turn):
    for channel in ("auto", "steer", "lateral-acceleration"):
        upside_down = {**turn, "roll_rad": -turn["roll_rad"]}
        answer = cgheight.estimate_log(upside_down, vehicle=kraz, channel=channel)
        assert answer.height_m is None
        assert any('flip="roll"' in message for message in answer.messages), channel
        again = cgheight.estimate_log(upside_down, vehicle=kraz, channel=channel, flip="roll")
        assert again.status == "ok"


def test_a_duration_of_a_day_is_no_problem(kraz, turn, height):
    later = pd.DataFrame(turn).set_index(
        pd.to_timedelta(turn["time_s"], unit="s") + timedelta(days=1)
    )
    answer = cgheight.estimate_log(later.drop(columns="time_s"), vehicle=kraz)
    assert answer.height_m == pytest.approx(height, rel=1e-6)
