"""Simulated trips for benches: one file each, random loads, fixed seeds."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

import cgheight

ROOT = Path(__file__).resolve().parents[2]
VEHICLE = ROOT / "fixtures" / "vehicles" / "baseline.toml"


def simulated(count: int, *, duration_s: float, rate_hz: float) -> list[cgheight.SimulatedLog]:
    """Return drives of the linear model with noise of 20 dB under loads of 5 to 20 t."""
    truck = cgheight.Vehicle.load(VEHICLE)
    random = np.random.default_rng(1)
    loads = [(random.uniform(1.6, 2.2), random.uniform(5e3, 20e3)) for _ in range(count)]

    def one(seed: int) -> cgheight.SimulatedLog:
        height_m, payload_kg = loads[seed]
        return cgheight.simulate(
            truck,
            cgheight.Scenario(
                "drive",
                height_m=height_m,
                payload_kg=payload_kg,
                duration_s=duration_s,
                rate_hz=rate_hz,
                sensors=cgheight.Sensors(snr_db=20),
                seed=seed + 1,
            ),
        )

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(one, range(count)))
