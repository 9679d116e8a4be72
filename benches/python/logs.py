"""Many logs to ARX models and to heights, compared with pandas, polars and numpy for the same ARX.

    OPENBLAS_NUM_THREADS=1 POLARS_MAX_THREADS=1 python benches/python/logs.py

CG_BENCH_LOGS=20 makes a short one. Prints a section for benches/RESULTS.md. Everything runs in one
process, one after the other, on files that are in the system's cache, and on one thread unless a
number of threads is given. The variables limit numpy and polars to one thread.
"""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import polars as pl

import cgheight
from trips import VEHICLE, simulated

LOGS = int(os.environ.get("CG_BENCH_LOGS", "300"))
DURATION_S = 120.0
# Of a slow logger every sample is a row of the regression, of a fast one eight make a mean.
RATES_HZ = (20.0, 100.0)
ORDER, DELAY = 5, 0
ROUNDS = 3


def fitted(frame: Any) -> np.ndarray:
    """Fit the ARX to a data frame with numpy's lstsq."""
    u, y = frame["steer_rad"].to_numpy(), frame["roll_rad"].to_numpy()
    past = np.lib.stride_tricks.sliding_window_view(y, ORDER)[:-1, ::-1]
    drive = np.lib.stride_tricks.sliding_window_view(u, ORDER)[1:, ::-1]
    theta, *_ = np.linalg.lstsq(np.hstack([-past, drive]), y[ORDER:], rcond=None)
    return theta


def by_pandas(path: Path) -> np.ndarray:
    """Read a log with pandas, fit the ARX with numpy's lstsq."""
    is_csv = path.suffix == ".csv"
    return fitted(pd.read_csv(path, comment="#") if is_csv else pd.read_parquet(path))


def by_polars(path: Path) -> np.ndarray:
    """Read a log with polars, fit the ARX with numpy's lstsq."""
    is_csv = path.suffix == ".csv"
    return fitted(pl.read_csv(path, comment_prefix="#") if is_csv else pl.read_parquet(path))


def by_cgheight(path: Path, rate_hz: float) -> np.ndarray:
    """Do the same with this package's reader and ARX."""
    frame = cgheight.read_log(path)
    model = cgheight.arx(frame["steer_rad"], frame["roll_rad"], ORDER, ORDER, DELAY, 1 / rate_hz)
    return np.concatenate([model.a[1:], model.b])


def timed(work: Callable[[], object]) -> float:
    """Return the median of a few rounds, s."""
    times = []
    for _ in range(ROUNDS):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return float(np.median(times))


def table(paths: list[Path], rate_hz: float) -> list[tuple[str, float]]:
    """Return what was done with the logs, and its time, s; those of pandas and polars first."""
    truck = cgheight.Vehicle.load(VEHICLE)
    theirs, ours = by_pandas(paths[0]), by_cgheight(paths[0], rate_hz)
    # Both solve the same rows: they differ by rounding times the condition of the regressors.
    assert np.max(np.abs(ours - theirs)) < 1e-6 * np.max(np.abs(theirs))
    assert np.allclose(by_polars(paths[0]), theirs, rtol=1e-9, atol=0)

    def batch(jobs: int, **options: object) -> Callable[[], object]:
        return lambda: cgheight.estimate_logs(paths, vehicle=truck, jobs=jobs, **options)

    arx = {"method": cgheight.Arx(ORDER), "channel": "steer"}
    return [
        ("pandas and numpy lstsq: ARX [5 5 0]", timed(lambda: [by_pandas(p) for p in paths])),
        ("polars and numpy lstsq: the same", timed(lambda: [by_polars(p) for p in paths])),
        ("`read_log` and `arx`: the same ARX, with covariance",
         timed(lambda: [by_cgheight(p, rate_hz) for p in paths])),
        ('`estimate_logs(method="arx")`: ARX of order 5 to a height', timed(batch(1, **arx))),
        ("`estimate_logs()`: filtered ARX, both channels, to a height", timed(batch(1))),
        ("the same, two threads", timed(batch(2))),
    ]  # fmt: skip


def main() -> None:
    """Make the logs, run all benches, print the tables."""
    for variable in ("OPENBLAS_NUM_THREADS", "POLARS_MAX_THREADS"):
        if os.environ.get(variable) != "1":
            raise SystemExit(f"set {variable}=1: one thread for all that are compared")
    print(f"## {LOGS} logs in Python\n")
    print(f"Simulated drives of {DURATION_S:.0f} s with 7 columns; median of {ROUNDS} rounds, all "
          "in one run.\n")  # fmt: skip
    print("| logs | what | time | against pandas | against polars |\n|---|---|---|---|---|")
    for rate_hz in RATES_HZ:
        logs = simulated(LOGS, duration_s=DURATION_S, rate_hz=rate_hz)
        for kind in ("csv", "parquet"):
            with tempfile.TemporaryDirectory() as folder:
                paths = [Path(folder) / f"{k:04d}.{kind}" for k in range(LOGS)]
                for log, path in zip(logs, paths, strict=True):
                    if kind == "csv":
                        cgheight.write_log(log, path)
                    else:
                        log.to_frame().to_parquet(path)
                times = table(paths, rate_hz)
            (_, pandas_s), (_, polars_s), *_ = times
            for what, seconds in times:
                ratios = f"{pandas_s / seconds:.1f} × | {polars_s / seconds:.1f} ×"
                print(f"| {kind}, {rate_hz:.0f} Hz | {what} | {seconds:.2f} s | {ratios} |")
    print()


if __name__ == "__main__":
    main()
