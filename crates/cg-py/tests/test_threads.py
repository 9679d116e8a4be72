"""Threads give the same results, and loops do not block the interpreter."""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import cgheight
from conftest import FIXTURES

DRIVE = FIXTURES / "logs" / "F_drive1_p15_h155.csv.gz"


def test_eight_threads_agree(turn):
    vehicle = cgheight.Vehicle.load(FIXTURES / "vehicles" / "kraz.toml")  # no design computed yet
    start = threading.Barrier(8)

    def work(number: int) -> tuple[cgheight.Estimate, cgheight.Estimate]:
        start.wait()
        return cgheight.estimate(**turn, vehicle=vehicle), cgheight.estimate_log(
            DRIVE, vehicle=vehicle
        )

    with ThreadPoolExecutor(8) as pool:
        answers = list(pool.map(work, range(8)))
    assert answers[0][0].status == answers[0][1].status == "ok"
    assert all(answer == answers[0] for answer in answers)  # equal to the last bit


def test_one_stream_may_be_pushed_and_asked_from_several_threads(kraz, turn):
    stream = cgheight.Estimator(kraz)
    rows = [
        {name: float(column[index]) for name, column in turn.items()}
        for index in range(len(turn["time_s"]))
    ]
    done = threading.Event()
    early: list[cgheight.Estimate] = []

    def ask() -> None:
        while not done.is_set():
            early.append(stream.estimate())

    with ThreadPoolExecutor(2) as pool:
        asking = [pool.submit(ask) for _ in range(2)]
        for row in rows:
            stream.push(**row)
        done.set()
        for future in asking:
            future.result()
    assert early
    assert stream.estimate() == cgheight.estimate(**turn, vehicle=kraz)


@pytest.mark.parametrize("work", ["estimate", "arx"])
def test_other_threads_go_on_while_a_loop_runs(work, kraz, turn):
    random = np.random.default_rng(4)
    copies = 3000
    roll, steer = (np.tile(turn[name], copies) for name in ("roll_rad", "steer_rad"))
    time_s = 0.01 * np.arange(len(roll))
    noise = random.standard_normal(250_000)

    def compute() -> None:
        if work == "estimate":
            cgheight.estimate(time_s, steer, roll, vehicle=kraz)
        else:
            cgheight.arx(noise, noise[::-1], 20, 20, 1, 0.01)

    worker = threading.Thread(target=compute)
    begin = time.perf_counter()
    worker.start()
    longest, before = 0.0, begin
    while worker.is_alive():
        time.sleep(0.001)
        now = time.perf_counter()
        longest, before = max(longest, now - before), now
    whole = time.perf_counter() - begin
    # A loop that blocked the interpreter would stop this thread for nearly all of its time.
    assert whole > 0.2
    assert longest < 0.5 * whole


def test_ctrl_c_ends_a_simulation_without_a_panic():
    """In a process of its own, whose first array from the library comes after Ctrl-C."""
    script = f"""
import os, signal, threading
import cgheight
truck = cgheight.Vehicle.load({str(FIXTURES / "vehicles" / "kraz.toml")!r})
drive = cgheight.Scenario("drive", plant="nonlinear", duration_s=300)
press = threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT))
press.start()
try:
    cgheight.simulate(truck, drive)
except KeyboardInterrupt:
    print("ended")
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert (done.stdout, done.stderr, done.returncode) == ("ended\n", "", 0)
