"""Calibration gives the same as on the command line."""

from __future__ import annotations

import pytest

import cgheight
from conftest import FIXTURES, ONE_TURN

LOGS = FIXTURES / "logs"
RUNS = [(LOGS / "A_p00_v50_L.csv", 1.32963), (LOGS / "A_p20_h190_v50_L.csv", 1.90, 28684.0)]


@pytest.fixture(scope="module")
def calibration(kraz, tmp_path_factory):
    """Write a calibration of the independent truck and return its path."""
    path = tmp_path_factory.mktemp("calibration") / "truck.toml"
    truck = cgheight.calibrate(kraz, RUNS, path)
    assert truck.is_calibrated
    assert not kraz.is_calibrated
    assert "calibrated" in repr(truck)
    return path


def test_two_runs_mend_another_log(kraz, calibration, turn, truth):
    known_m = truth[ONE_TURN]["height_m"]
    before = cgheight.estimate_log(LOGS / ONE_TURN, vehicle=kraz)
    after = cgheight.estimate_log(LOGS / ONE_TURN, vehicle=kraz, calibration=calibration)
    # The test of the library with these runs gives 4.7 % and 0.4 %.
    assert abs(before.height_m / known_m - 1) > 0.03
    assert abs(after.height_m / known_m - 1) < 0.015
    assert after.height_sd_m < 0.25 * before.height_sd_m
    # Every entry point gives the same.
    arrays = cgheight.estimate(**turn, vehicle=kraz, calibration=calibration)
    again = cgheight.estimate_log(LOGS / ONE_TURN, vehicle=kraz.calibrated(calibration))
    assert arrays.height_m == pytest.approx(after.height_m, rel=1e-12)
    assert again.height_m == after.height_m


def test_a_calibration_belongs_to_its_vehicle_and_model(kraz, baseline, calibration, tmp_path):
    with pytest.raises(ValueError, match='belongs to the vehicle "kraz", not to "baseline"'):
        baseline.calibrated(calibration)
    with pytest.raises(ValueError, match="other model"):
        cgheight.estimate_log(
            LOGS / ONE_TURN, vehicle=kraz, calibration=calibration, model="as-printed"
        )
    broken = tmp_path / "broken.toml"
    broken.write_text(calibration.read_text().replace("residual_sd", "residue"))
    with pytest.raises(ValueError, match="residue"):
        kraz.calibrated(broken)


def test_runs_that_cannot_be_are_refused_and_nothing_is_written(kraz, tmp_path):
    out = tmp_path / "c.toml"
    with pytest.raises(ValueError, match="expected \\(log, height_m"):
        cgheight.calibrate(kraz, [(RUNS[0][0],)], out)
    with pytest.raises(FileNotFoundError, match="nowhere"):
        cgheight.calibrate(kraz, [(tmp_path / "nowhere.csv", 1.9)], out)
    with pytest.raises(ValueError, match="below the empty trailer"):
        cgheight.calibrate(kraz, [(RUNS[1][0], 1.9, 500.0)], out)
    with pytest.raises(ValueError, match="outside the vehicle file's range"):
        cgheight.calibrate(kraz, [(RUNS[1][0], 190.0)], out)
    with pytest.raises(ValueError, match="given twice"):
        cgheight.calibrate(kraz, [RUNS[0], RUNS[0]], out)
    with pytest.raises(ValueError, match="no run"):
        cgheight.calibrate(kraz, [], out)
    assert not list(tmp_path.iterdir())
