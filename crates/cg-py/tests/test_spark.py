"""Trips on a local Spark with two workers give the same heights as on one machine."""

from __future__ import annotations

import os
import pickle
import sys

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest
from pyspark.sql import SparkSession

import cgheight
from cgheight.spark import _complete_trips, estimate_files, estimate_trips, learn_files, learn_trips
from conftest import FIXTURES, LOGS

TRIPS = 240
# PySpark 4 warns about pandas 3; only the conversion from Arrow is used here.
pytestmark = pytest.mark.filterwarnings("ignore:PySpark does not yet fully support pandas")


@pytest.fixture(scope="module")
def spark():
    """Start Spark with two workers."""
    os.environ["PYSPARK_PYTHON"] = os.environ["PYSPARK_DRIVER_PYTHON"] = sys.executable
    builder = SparkSession.builder.master("local[2]").appName("cgheight")
    for key, value in {
        "spark.ui.enabled": "false",
        "spark.sql.shuffle.partitions": "4",
        "spark.driver.host": "127.0.0.1",
        "spark.driver.bindAddress": "127.0.0.1",
    }.items():
        builder = builder.config(key, value)
    session = builder.getOrCreate()
    session.sparkContext.setLogLevel("ERROR")
    yield session
    session.stop()


@pytest.fixture(scope="module")
def trips(baseline, tmp_path_factory):
    """Simulate trips; return them in memory and the folder of their Parquet files."""
    folder = tmp_path_factory.mktemp("trips")
    random = np.random.default_rng(4)
    logs = []
    for k in range(TRIPS):
        log = cgheight.simulate(
            baseline,
            cgheight.Scenario(
                "steady-turn",
                height_m=random.uniform(1.6, 2.2),
                payload_kg=random.uniform(5e3, 2e4),
                rate_hz=20,
                sensors=cgheight.Sensors(snr_db=20),
                seed=k,
            ),
        )
        logs.append(log.to_frame().assign(trip=f"trip-{k:03d}"))
    for part in range(6):
        table = pd.concat(logs[part::6]).sample(frac=1, random_state=part)  # rows in any order
        table.to_parquet(folder / f"part-{part}.parquet")
    return logs, folder


def test_hundreds_of_trips_have_the_heights_of_one_machine(spark, trips, baseline):
    logs, folder = trips
    table = spark.read.parquet(str(folder))
    rows = estimate_trips(table, vehicle=baseline, channel="steer").collect()
    found = pd.DataFrame([row.asDict() for row in rows]).sort_values("log", ignore_index=True)
    one_machine = cgheight.estimate_logs(
        [log.drop(columns="trip") for log in logs], vehicle=baseline, channel="steer"
    ).to_frame()
    assert found["log"].tolist() == [log.trip.iloc[0] for log in logs]
    assert len(found) == TRIPS
    assert found.height_m.notna().all()
    for name in one_machine.columns.drop("log"):
        # The arithmetic and the rows are the same, so the results agree to the last bit.
        pd.testing.assert_series_equal(found[name], one_machine[name], check_dtype=False,
                                       check_exact=True)  # fmt: skip


@pytest.mark.parametrize("rows", [1, 3, 7, 100])
def test_trips_are_whole_however_their_rows_arrive(rows):
    table = pa.table({
        "trip": ["a"] * 4 + [None] + ["b"] * 5 + ["c"] * 3,
        "t": [0.3, 0.1, 0.2, 0.4, 5.0, 1.0, 2.0, 3.0, 4.0, 5.0, 9.0, 8.0, 7.0],
        "x": list(range(13)),
        "note": ["text"] * 13,
    })  # fmt: skip
    found = list(_complete_trips(iter(table.to_batches(rows)), "trip", "t"))
    assert all(found)
    trips = [trip for complete in found for trip in complete]
    assert [name for name, _ in trips] == ["a", None, "b", "c"]
    # Rows without a trip are none.
    _, no_log = trips.pop(1)
    with pytest.raises(ValueError, match="the column trip is null in 1 rows"):
        raise no_log
    assert [log["x"].tolist() for _, log in trips] == [
        [1, 2, 0, 3], [5, 6, 7, 8, 9], [12, 11, 10],
    ]  # fmt: skip
    assert all(list(log) == ["t", "x"] for _, log in trips)


def test_a_text_is_no_missing_name():
    table = pa.table({"trip": ["None", None, "None"], "t": [1.0, 2.0, 3.0]})
    found = _complete_trips(iter(table.to_batches()), "trip", "t")
    assert [name for trips in found for name, _ in trips] == ["None", None, "None"]


def test_rows_without_a_trip_and_text_that_is_numbers(spark, kraz):
    log = FIXTURES / "logs" / "A_p20_h190_v50_L.csv"
    text = pd.read_csv(log, dtype=str)
    both = pd.concat([text.assign(trip="text"), text.assign(trip=None)])
    names = list(both)
    kinds = ", ".join(f"{name} string" for name in names)
    table = spark.createDataFrame(both.to_numpy().tolist(), kinds)
    found = {row.log: row for row in estimate_trips(table, vehicle=kraz).collect()}
    assert found["text"].height_m == cgheight.estimate_log(log, vehicle=kraz).height_m
    count = len(text)
    assert found[None].status == "rejected"
    assert f"the column trip is null in {count} rows" in found[None].messages


def test_a_partition_without_rows_has_no_trips():
    empty = pa.table({"trip": pa.array([], pa.string()), "t": pa.array([], pa.float64())})
    for batches in ([], empty.to_batches(), [pa.RecordBatch.from_pylist([], empty.schema)] * 2):
        assert list(_complete_trips(iter(batches), "trip", "t")) == []


def test_no_more_rows_are_read_than_the_trip_needs():
    table = pa.table({"trip": list("aaabbbccc"), "t": np.arange(9.0)})
    read = []
    batches = table.to_batches(2)  # aa ab bb cc c
    found = _complete_trips((read.append(batch) or batch for batch in batches), "trip", "t")
    seen = [([name for name, _ in complete], len(read)) for complete in found]
    assert seen == [(["a"], 2), (["b"], 4), (["c"], 5)]


def test_columns_that_may_be_signals_are_kept_in_the_order_of_time():
    count = 40  # numpy's quicksort keeps the order of 16 equal rows and fewer
    times = pa.array([f"{1 - k % 2}" for k in range(count)])
    numbers = pa.array(range(count))
    table = pa.table({
        "trip": pa.array([7] * count),
        "t": times,
        "float": numbers.cast(pa.float32()),
        "integer": numbers,
        "decimal": numbers.cast(pa.decimal128(20, 1)),
        "stamp": numbers.cast(pa.timestamp("us")),
        "duration": numbers.cast(pa.duration("us")),
        "text": times,
        "note": [f"row {k}" for k in range(count)],
        "flag": [True] * count,
    })  # fmt: skip
    [[(name, log)]] = _complete_trips(iter(table.to_batches()), "trip", "t")
    assert name == "7"
    assert list(log) == ["t", "float", "integer", "decimal", "stamp", "duration", "text"]
    assert log["t"].tolist() == [0.0] * 20 + [1.0] * 20
    for kept in ("float", "integer", "decimal"):
        assert [int(x) for x in log[kept]] == [*range(1, count, 2), *range(0, count, 2)]


def test_a_calibrated_vehicle_travels_and_bad_files_are_rejected_not_fatal(spark, kraz, tmp_path):
    log = FIXTURES / "logs" / "A_p20_h190_v50_L.csv"
    truck = cgheight.calibrate(kraz, [(log, 1.9)], tmp_path / "truck.toml")
    paths = [str(FIXTURES / "logs" / name) for name in LOGS] + [str(tmp_path / "nowhere.csv")]
    files = spark.createDataFrame([(path,) for path in paths], "path string").repartition(3)
    found = {row["log"]: row for row in estimate_files(files, vehicle=truck).collect()}
    expected = cgheight.estimate_logs(paths, vehicle=truck, errors="reject")
    assert len(found) == len(paths)
    for path, answer in zip(paths, expected, strict=True):
        assert found[path]["height_m"] == answer.height_m
        assert found[path]["messages"] == "; ".join(answer.messages)
    assert found[paths[-1]]["status"] == "rejected"
    assert "nowhere.csv: cannot be opened" in found[paths[-1]]["messages"]


def test_the_empty_trips_of_a_truck_become_its_calibration(spark, kraz, tmp_path):
    tables, day_s = [], 86_400.0
    for name, log, day in [("a", "A_p00_v50_L.csv", 1), ("b", "A_p20_h190_v50_L.csv", 2),
                           ("c", "A_p00_v50_L.csv", 9)]:  # fmt: skip
        rows = pd.read_csv(FIXTURES / "logs" / log)
        rows["time_s"] += day * day_s
        tables.append(rows.assign(trip=name))
    table = spark.createDataFrame(pd.concat(tables).sample(frac=1, random_state=1))
    found = sorted(learn_trips(table, vehicle=kraz).collect(), key=lambda row: row["log"])
    assert [(row["log"], row["trips"]) for row in found] == [("a", 1), ("b", 0), ("c", 1)]
    texts = [row["learned"] for row in found if row["trips"]]
    assert texts[0] == cgheight.learn_log(tables[0].drop(columns="trip"), vehicle=kraz)
    truck = cgheight.calibrate(kraz, [], tmp_path / "fleet.toml", from_state=texts)
    assert (tmp_path / "fleet.toml").read_text().count("[[run]]") == len(texts)
    laden = FIXTURES / "logs" / "A_p20_h190_v50_L.csv"
    before = cgheight.estimate_log(laden, vehicle=kraz)
    after = cgheight.estimate_log(laden, vehicle=truck)
    assert abs(after.height_m / 1.9 - 1) < 0.01 < abs(before.height_m / 1.9 - 1)
    paths = [(str(FIXTURES / "logs" / "A_p00_v50_L.csv"),), ("nowhere.csv",)]
    files = learn_files(spark.createDataFrame(paths, "path string"), vehicle=kraz).collect()
    by_name = {row["log"]: row for row in files}
    assert by_name[paths[0][0]]["learned"] == cgheight.learn_log(paths[0][0], vehicle=kraz)
    lost = by_name["nowhere.csv"]
    assert (lost["learned"], lost["trips"]) == (None, 0)
    assert "cannot be opened" in lost["messages"]


def test_a_column_that_is_not_there_is_named(spark, kraz):
    table = spark.createDataFrame([("a", 0.0)], "trip string, t double")
    with pytest.raises(ValueError, match="no column time_s; it has trip, t"):
        estimate_trips(table, vehicle=kraz)
    with pytest.raises(ValueError, match="no column path"):
        estimate_files(table, vehicle=kraz)
    with pytest.raises(ValueError, match="no column time_s; it has trip, t"):
        learn_trips(table, vehicle=kraz)
    with pytest.raises(ValueError, match="no column path"):
        learn_files(table, vehicle=kraz)


def test_a_rejected_trip_has_the_given_mass_also_with_its_standard_deviation(kraz, tmp_path):
    logs = [("one", str(tmp_path / "nowhere.csv"))]
    options = {"trailer_mass_kg": (20_000.0, 300.0)}
    table = cgheight.spark._table(cgheight.spark._estimated, pickle.dumps(kraz), logs, options)
    assert table.column("trailer_mass_kg").to_pylist() == [20_000.0]
    assert table.column("status").to_pylist() == ["rejected"]
