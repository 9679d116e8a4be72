"""Memory does not grow with repeated calls."""

from __future__ import annotations

import gc
import os
from pathlib import Path

import pytest

import cgheight
from cgheight import _native
from cgheight._frames import reading
from conftest import FIXTURES, ONE_TURN

LOG = FIXTURES / "logs" / ONE_TURN
ROUNDS = 400
# If one array of 1700 rows is not freed, 400 repetitions lose 5.4 MB.
ALLOWED_BYTES = 2_000_000


def resident_bytes() -> int:
    gc.collect()
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")


WORK = {
    "arrays": lambda truck, turn: cgheight.estimate(**turn, vehicle=truck),
    "file": lambda truck, _: cgheight.estimate_log(LOG, vehicle=truck),
    "read": lambda *_: cgheight.read_log(LOG),
    "arx": lambda _, turn: cgheight.arx(turn["steer_rad"], turn["roll_rad"], 5, 5, 1, 0.01),
    "predict": lambda truck, turn: cgheight.predict_roll(turn, 1.7, vehicle=truck),
    "simulate": lambda truck, _: cgheight.simulate(truck, cgheight.Scenario("sine", rate_hz=85)),
    "frames": lambda *_: _rows_of_frames(),
    "vehicle": lambda *_: cgheight.Vehicle.load(FIXTURES / "vehicles" / "kraz.toml"),
    "refused": lambda truck, turn: _refused(truck, turn),
}


def _refused(truck, turn) -> None:
    with pytest.raises(ValueError, match="does not come after"):
        cgheight.estimate(**{**turn, "time_s": turn["time_s"][::-1]}, vehicle=truck)


@pytest.mark.parametrize("name", WORK)
def test_nothing_is_kept(name, kraz, turn):
    for _ in range(50):  # allocators and caches settle
        WORK[name](kraz, turn)
    before = resident_bytes()
    for _ in range(ROUNDS):
        WORK[name](kraz, turn)
    assert resident_bytes() - before < ALLOWED_BYTES


def _rows_of_frames():
    table = _native.FrameTable(reading())
    for k in range(100):
        table.push((0.01 * k, 0), 0x0CF029E4, True, bytes.fromhex("FFFFFF00007DCFFF"))
    assert len(table.finish()["roll_to_gravity_rad"]) == 100
