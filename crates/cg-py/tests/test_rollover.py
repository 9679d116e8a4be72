"""Rollover measures: those of the command line, and what is refused."""

from __future__ import annotations

import json
import subprocess

import pytest

import cgheight
from conftest import FIXTURES, cg

TRUCK = FIXTURES / "vehicles" / "kraz.toml"


def test_the_measures_are_those_of_the_command_line() -> None:
    found = cgheight.rollover_measures(
        cgheight.Vehicle.load(TRUCK), height_m=2.0, radius_m=100.0, share=0.5, height_sd_m=0.05
    )
    curve = ["--radius-m", "100", "--share", "0.5", "--height-sd-m", "0.05"]
    command = [cg(), "rollover", "--vehicle", TRUCK, "--height-m", "2", "--format", "json", *curve]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    printed = json.loads(done.stdout)
    assert found == {name: printed[name] for name in printed["meaning"]}
    assert {"side_pull_ratio", "tilt_table_ratio", "curve_speed_mps"} < found.keys()


def test_a_curve_is_an_option_and_impossible_numbers_are_refused() -> None:
    vehicle = cgheight.Vehicle.load(TRUCK)
    assert "curve_speed_mps" not in cgheight.rollover_measures(vehicle)
    for wrong, said in [
        ({"radius_m": -1.0}, "radius_m is -1"),
        ({"share": 0.0}, "at most 1"),
        ({"share": 1.1}, "at most 1"),
        ({"height_sd_m": -0.1}, "not negative"),
        ({"height_sd_m": float("nan")}, "not negative"),
        ({"height_m": 0.0}, "height_m is 0"),
        ({"trailer_mass_kg": 100.0}, "empty trailer"),
    ]:
        with pytest.raises(ValueError, match=said):
            cgheight.rollover_measures(vehicle, **{"radius_m": 100.0, **wrong})
