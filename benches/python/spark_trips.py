"""Trips on Spark with two workers, compared with `cg estimate --jobs 2` on the same Parquet files.

    python benches/python/spark_trips.py     # 400 trips; CG_BENCH_TRIPS=20 for a short one

Prints a section for benches/RESULTS.md. CG names the program, target/release/cg by default.
"""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pandas as pd
from pyspark.sql import SparkSession

import cgheight
import cgheight.spark
from trips import ROOT, VEHICLE, simulated

TRIPS = int(os.environ.get("CG_BENCH_TRIPS", "400"))
DURATION_S, RATE_HZ = 120.0, 50.0
TRIPS_OF_FILE = 50  # of the table
WARM = 3
ROUNDS = 1 + WARM
CG = os.environ.get("CG", str(ROOT / "target" / "release" / "cg"))


def main() -> None:
    """Make the trips, run both, print the table."""
    truck = cgheight.Vehicle.load(VEHICLE)
    with tempfile.TemporaryDirectory() as folder:
        logs = simulated(TRIPS, duration_s=DURATION_S, rate_hz=RATE_HZ)
        frames = [log.to_frame().assign(trip=k) for k, log in enumerate(logs)]
        paths = [f"{folder}/{k:04d}.parquet" for k in range(TRIPS)]
        for frame, path in zip(frames, paths, strict=True):
            frame.to_parquet(path)
        for k in range(0, TRIPS, TRIPS_OF_FILE):
            part = pd.concat(frames[k : k + TRIPS_OF_FILE], ignore_index=True)
            part.to_parquet(f"{folder}/table-{k:04d}.parquet")
        start = time.perf_counter()
        command = [CG, "estimate", *paths, "--vehicle", str(VEHICLE), "--jobs", "2"]
        done = subprocess.run([*command, "--format", "json"], capture_output=True, check=True)
        alone = time.perf_counter() - start
        expected = [json.loads(line)["height_m"] for line in done.stdout.splitlines()]
        os.environ["PYSPARK_PYTHON"] = sys.executable
        builder = SparkSession.builder.master("local[2]").config("spark.ui.enabled", "false")
        spark = builder.config("spark.sql.shuffle.partitions", "4").getOrCreate()
        spark.sparkContext.setLogLevel("ERROR")
        table = spark.read.parquet(f"{folder}/table-*.parquet")
        files = spark.createDataFrame([(path,) for path in paths], "path string").repartition(2)
        queries = [
            lambda: cgheight.spark.estimate_trips(table, vehicle=truck).collect(),
            lambda: cgheight.spark.estimate_files(files, vehicle=truck).collect(),
        ]
        times: list[list[float]] = [[], []]
        for query, times_s in ROUNDS * list(zip(queries, times, strict=True)):
            start = time.perf_counter()
            found = query()
            times_s.append(time.perf_counter() - start)
            heights = {int(Path(row["log"]).stem): row["height_m"] for row in found}
            assert [heights[k] for k in range(TRIPS)] == expected
        spark.stop()
    print(f"## {TRIPS} trips on Spark\n")
    what = f"{TRIPS} simulated drives of {DURATION_S:.0f} s at {RATE_HZ:.0f} Hz in Parquet"
    print(f"{what}; both give the same heights to the last bit.")
    print("Spark runs on one machine with two workers.\n")
    print("| what | time | trips a second |\n|---|---|---|")
    of_trips, of_files = times
    for name, seconds in (
        ("`cg estimate --jobs 2`, including its start", alone),
        ("`estimate_trips`, rows of one table in any order: first query", of_trips[0]),
        (f"the same, median of the {WARM} queries after it", statistics.median(of_trips[1:])),
        ("`estimate_files`, the same trips as files: first query", of_files[0]),
        (f"the same, median of the {WARM} queries after it", statistics.median(of_files[1:])),
    ):
        print(f"| {name} | {seconds:.2f} s | {TRIPS / seconds:.0f} |")
    print()


if __name__ == "__main__":
    main()
