"""Estimates of many logs, tables of other packages, and output in notebooks."""

from __future__ import annotations

import numpy as np
import pandas as pd
import polars as pl
import pytest

import cgheight
from conftest import FIXTURES, LOGS, ONE_TURN

PATHS = [FIXTURES / "logs" / name for name in LOGS]


def test_a_batch_is_its_logs_one_by_one_in_their_order(kraz):
    batch = cgheight.estimate_logs(PATHS, vehicle=kraz, jobs=2, progress=True)
    assert batch.logs == tuple(map(str, PATHS))
    assert list(batch) == [cgheight.estimate_log(path, vehicle=kraz) for path in PATHS]
    assert batch[1] == batch.estimates[1]
    assert repr(batch) == f"Estimates({len(PATHS)} of {len(PATHS)} logs with a height)"


def test_the_frames_have_what_the_answers_have(kraz):
    batch = cgheight.estimate_logs(PATHS, vehicle=kraz, channel="steer")
    frame = batch.to_frame()
    assert list(frame.height_m) == [one.height_m for one in batch]
    assert list(frame.height_ci95_high_m) == [one.height_ci95_m[1] for one in batch]
    assert (frame.channel == "steer").all()
    assert list(frame.maneuvers) == [len(one.maneuvers) for one in batch]
    turns = batch.maneuvers_frame()
    assert len(turns) == frame.maneuvers.sum()
    assert set(turns.log) == set(frame.log)
    assert turns.height_m.dtype == "float64"


def test_a_log_that_cannot_be_read_raises_or_is_rejected(kraz, tmp_path):
    logs = [PATHS[0], tmp_path / "nowhere.csv", PATHS[1]]
    with pytest.raises(FileNotFoundError, match="nowhere"):
        cgheight.estimate_logs(logs, vehicle=kraz)
    batch = cgheight.estimate_logs(logs, vehicle=kraz, errors="reject")
    assert [one.status for one in batch] == ["ok", "rejected", "ok"]
    assert "nowhere.csv: cannot be opened" in batch[1].messages[0]
    frame = batch.to_frame()
    assert frame.height_m.isna().tolist() == [False, True, False]
    assert "nowhere" in batch._repr_html_()
    good = pd.read_csv(PATHS[0])
    tables = {"good": good, "truck 7": good.assign(roll_rad=np.inf)}
    with pytest.raises(ValueError, match=r"^truck 7: roll_rad\[0\] = inf"):
        cgheight.estimate_logs(tables, vehicle=kraz)
    with pytest.raises(ValueError, match="errors is 'hide'"):
        cgheight.estimate_logs(logs, vehicle=kraz, errors="hide")
    with pytest.raises(ValueError, match="jobs is 0"):
        cgheight.estimate_logs(logs, vehicle=kraz, jobs=0)


def test_a_frame_without_logs_has_the_columns_and_types_of_others(kraz):
    none = cgheight.estimate_logs([], vehicle=kraz).to_frame()
    some = cgheight.estimate_logs(PATHS[:1], vehicle=kraz).to_frame()
    assert len(none) == 0
    assert list(none) == list(some)
    numbers = some.select_dtypes("number").dtypes
    assert none.dtypes[numbers.index].equals(numbers)


@pytest.mark.parametrize(("mass_kg", "shown_kg"), [
    ((20_000.0, 300.0), 20_000.0), (21_000, 21_000.0), (None, None),
])  # fmt: skip
def test_a_rejected_log_has_the_given_mass_however_it_was_given(mass_kg, shown_kg, kraz, tmp_path):
    logs = [PATHS[0], tmp_path / "nowhere.csv"]
    batch = cgheight.estimate_logs(logs, vehicle=kraz, trailer_mass_kg=mass_kg, errors="reject")
    shown_kg = shown_kg or kraz.reference_trailer_mass_kg
    assert batch[1].trailer_mass_kg == shown_kg
    assert list(batch.to_frame().trailer_mass_kg)[1] == shown_kg
    assert f"{shown_kg:.0f} kg" in batch[1]._repr_html_()


def test_polars_pandas_arrow_and_files_give_the_same(kraz, turn, tmp_path):
    expected = cgheight.estimate(**turn, vehicle=kraz)
    lazy = pl.DataFrame(turn)
    assert cgheight.estimate_log(lazy, vehicle=kraz) == expected
    assert cgheight.estimate_log(turn, vehicle=kraz) == expected
    with pytest.raises(ValueError, match=r"LazyFrame.*collect"):
        cgheight.estimate_log(lazy.lazy(), vehicle=kraz)
    lazy.write_parquet(tmp_path / "a.parquet")
    pd.DataFrame(turn).to_parquet(tmp_path / "b.parquet")
    for name in ("a.parquet", "b.parquet"):
        assert cgheight.estimate_log(tmp_path / name, vehicle=kraz) == expected
    batch = cgheight.estimate_logs([lazy, pd.DataFrame(turn)], vehicle=kraz)
    assert batch.logs == ("table 0", "table 1")
    assert set(batch) == {expected}
    there = pl.when(pl.col("time_s") != 3.0).then(pl.col("roll_rad"))
    gaps = lazy.with_columns(roll_rad=there)
    answer = cgheight.estimate_log(gaps, vehicle=kraz)
    assert any("1 of 1700 rows" in message for message in answer.messages)


def test_simulated_logs_are_logs_alone_and_in_a_dict(kraz):
    log = cgheight.simulate(kraz, cgheight.Scenario("rounded-step", duration_s=20.0, rate_hz=50.0))
    expected = cgheight.estimate_log(log, vehicle=kraz)
    assert list(cgheight.estimate_logs(log, vehicle=kraz)) == [expected]
    assert cgheight.estimate_logs({"a": log}, vehicle=kraz).logs == ("a",)
    with pytest.raises(ValueError, match="log is of type int: give a path"):
        cgheight.estimate_logs(3, vehicle=kraz)


@pytest.mark.parametrize(("compression", "name"), [("lz4", "LZ4"), ("brotli", "Brotli")])
def test_a_compression_that_is_not_read_is_named(compression, name, kraz, turn, tmp_path):
    path = tmp_path / "log.parquet"
    pd.DataFrame(turn).to_parquet(path, compression=compression)
    with pytest.raises(
        ValueError, match=rf"{name}, which is not read here; export it again with snappy"
    ):
        cgheight.estimate_log(path, vehicle=kraz)


def test_names_and_messages_are_escaped_in_a_notebook(kraz, tmp_path):
    batch = cgheight.estimate_logs(
        [tmp_path / "<b>x</b>.csv"], vehicle=kraz, errors="reject", jobs=1
    )
    text = batch._repr_html_()
    assert "<b>" not in text
    assert "&lt;b&gt;x" in text
    answer = cgheight.estimate_log(FIXTURES / "logs" / ONE_TURN, vehicle=kraz)
    shown = answer._repr_html_()
    assert f"{answer.height_m:.2f} ± {answer.height_sd_m:.2f} m" in shown
    assert "95 % interval" in shown
    assert "kraz" in kraz._repr_html_()


def test_logs_are_read_into_frames_in_si_units(tmp_path):
    path = tmp_path / "deg.csv"
    path.write_text("time_ms,steer_deg,MyRoll\n0,1.0,2.0\n10,1.0,\n")
    frame = cgheight.read_log(path, columns={"roll": "MyRoll[deg]"}, flip="roll")
    assert list(frame) == ["time_s", "steer_rad", "roll_rad"]
    assert frame.time_s.tolist() == [0.0, 0.01]
    assert frame.roll_rad[0] == pytest.approx(-np.radians(2.0), rel=1e-15)
    assert pd.isna(frame.roll_rad[1])


@pytest.mark.parametrize("option", [
    {"method": "foo"}, {"channel": "roll"}, {"columns": ["a"]}, {"speed_mps": -1.0},
    {"trailer_mass_kg": "heavy"},
])  # fmt: skip
def test_an_option_that_cannot_be_is_no_fault_of_a_log(option, kraz, tmp_path):
    with pytest.raises(ValueError, match=next(iter(option))):
        cgheight.estimate_logs(PATHS, vehicle=kraz, errors="reject", **option)
    page = tmp_path / "report.html"
    with pytest.raises(ValueError, match=next(iter(option))):
        cgheight.report(PATHS, page, vehicle=kraz, errors="reject", **option)
    assert not page.exists()
