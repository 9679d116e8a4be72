"""Shared fixtures: vehicles and the logs of the independent truck."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest

import cgheight

FIXTURES = Path(__file__).resolve().parents[3] / "fixtures"
LOGS = sorted(path.name for path in (FIXTURES / "logs").glob("*.csv*"))
ONE_TURN = "A_p10_h170_v50_L.csv"


def read(name: str) -> dict[str, np.ndarray]:
    """Read a log of the independent truck as arrays, without the package under test."""
    table = np.genfromtxt(FIXTURES / "logs" / name, delimiter=",", names=True)
    return {column: np.ascontiguousarray(table[column]) for column in table.dtype.names}


def cg() -> str:
    """Return the command-line program: the one that `make` gives in CG, or the newest build."""
    builds = [FIXTURES.parent / "target" / profile / "cg" for profile in ("release", "debug")]
    there = sorted(
        (path for path in builds if path.exists()), key=lambda path: path.stat().st_mtime
    )
    found = os.environ.get("CG") or (str(there[-1]) if there else None)
    assert found, "no cg: run cargo build --package cg-cli"
    return found


@pytest.fixture(scope="session")
def kraz() -> cgheight.Vehicle:
    """Return the independent truck."""
    return cgheight.Vehicle.load(FIXTURES / "vehicles" / "kraz.toml")


@pytest.fixture(scope="session")
def baseline() -> cgheight.Vehicle:
    """Return the vehicle of the thesis."""
    return cgheight.Vehicle.load(FIXTURES / "vehicles" / "baseline.toml")


@pytest.fixture(scope="session")
def turn() -> dict[str, np.ndarray]:
    """Return a log with one turn, as arrays."""
    return read(ONE_TURN)


@pytest.fixture(scope="session")
def truth() -> dict[str, dict]:
    """Return the known values of each log by its name."""
    entries = json.loads((FIXTURES / "logs" / "truth.json").read_text())
    return {entry["log"]: entry for entry in entries}
