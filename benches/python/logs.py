"""Many logs to ARX models and to heights, compared with pandas and numpy for the same ARX.

    OPENBLAS_NUM_THREADS=1 python benches/python/logs.py    # CG_BENCH_LOGS=20 for a short one

Prints a section for benches/RESULTS.md. Everything runs in one process, one after the other, on
files that are in the system's cache, and on one thread unless a number of threads is given. The
variable limits numpy to one thread.
"""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd

import cgheight
from trips import VEHICLE, simulated

LOGS = int(os.environ.get("CG_BENCH_LOGS", "1000"))
DURATION_S, RATE_HZ = 120.0, 20.0
ORDER, DELAY = 5, 0
ROUNDS = 3


def by_pandas(path: Path) -> np.ndarray:
    """Read a log with pandas, fit the ARX with numpy's lstsq."""
    frame = pd.read_csv(path, comment="#")
    u, y = frame["steer_rad"].to_numpy(), frame["roll_rad"].to_numpy()
    past = np.lib.stride_tricks.sliding_window_view(y, ORDER)[:-1, ::-1]
    drive = np.lib.stride_tricks.sliding_window_view(u, ORDER)[1:, ::-1]
    theta, *_ = np.linalg.lstsq(np.hstack([-past, drive]), y[ORDER:], rcond=None)
    return theta


def by_cgheight(path: Path) -> np.ndarray:
    """Do the same with this package's reader and ARX."""
    frame = cgheight.read_log(path)
    model = cgheight.arx(frame["steer_rad"], frame["roll_rad"], ORDER, ORDER, DELAY, 1 / RATE_HZ)
    return np.concatenate([model.a[1:], model.b])


def timed(work: Callable[[], object]) -> float:
    """Return the median of a few rounds, s."""
    times = []
    for _ in range(ROUNDS):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return float(np.median(times))


def main() -> None:
    """Make the logs, run all benches, print the table."""
    if os.environ.get("OPENBLAS_NUM_THREADS") != "1":
        raise SystemExit("set OPENBLAS_NUM_THREADS=1: one thread for numpy as for the others")
    truck = cgheight.Vehicle.load(VEHICLE)
    with tempfile.TemporaryDirectory() as folder:
        paths = []
        for k, log in enumerate(simulated(LOGS, duration_s=DURATION_S, rate_hz=RATE_HZ)):
            paths.append(Path(folder) / f"{k:04d}.csv")
            cgheight.write_log(log, paths[-1])
        rows = int(DURATION_S * RATE_HZ) + 1
        size = sum(path.stat().st_size for path in paths) / 2**20
        theirs, ours = by_pandas(paths[0]), by_cgheight(paths[0])
        # Both solve the same rows: they differ by rounding times the condition of the regressors.
        assert np.max(np.abs(ours - theirs)) < 1e-6 * np.max(np.abs(theirs))

        def batch(jobs: int, **options: object) -> Callable[[], object]:
            return lambda: cgheight.estimate_logs(paths, vehicle=truck, jobs=jobs, **options)

        peer = timed(lambda: [by_pandas(path) for path in paths])
        arx = {"method": cgheight.Arx(ORDER), "channel": "steer"}
        table = [
            ("pandas.read_csv and numpy lstsq: ARX [5 5 0]", peer),
            ("`read_log` and `arx`: the same ARX, with covariance",
             timed(lambda: [by_cgheight(path) for path in paths])),
            ("`estimate_logs(method=\"arx\")`: ARX of order 5 to a height", timed(batch(1, **arx))),
            ("`estimate_logs()`: filtered ARX, both channels, to a height", timed(batch(1))),
            ("the same, two threads", timed(batch(2))),
        ]  # fmt: skip
    print(f"## {LOGS} logs in Python\n")
    print(f"{LOGS} simulated drives, {rows} rows of 7 columns each, {size:.0f} MiB of CSV; "
          f"median of {ROUNDS} rounds, all in one run.\n")  # fmt: skip
    print("| what | time | against pandas and numpy |\n|---|---|---|")
    for name, seconds in table:
        ratio = "" if seconds is peer else f"{peer / seconds:.1f} × as fast"
        print(f"| {name} | {seconds:.2f} s | {ratio} |")
    print()


if __name__ == "__main__":
    main()
