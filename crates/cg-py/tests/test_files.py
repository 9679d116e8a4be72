"""Protection of files: what may be written, and what may be replaced."""

from __future__ import annotations

import os
import shutil

import pytest

import cgheight
from conftest import FIXTURES, ONE_TURN

RUN = FIXTURES / "logs" / ONE_TURN


@pytest.fixture
def truck(tmp_path):
    """Return the independent truck, read from a copy of its file."""
    shutil.copy(FIXTURES / "vehicles" / "kraz.toml", tmp_path / "v.toml")
    return cgheight.Vehicle.load(tmp_path / "v.toml")


@pytest.mark.parametrize("force", [False, True])
def test_no_output_replaces_an_input(truck, tmp_path, force):
    log = tmp_path / "a.csv"
    shutil.copy(RUN, log)
    (tmp_path / "link.csv").symlink_to("a.csv")
    for name in ["a.csv", "link.csv"]:
        with pytest.raises(ValueError, match="given to log and to path"):
            cgheight.write_log(log, tmp_path / name, force=force)
        with pytest.raises(ValueError, match="given to runs and to output"):
            cgheight.calibrate(truck, [(log, 1.9)], tmp_path / name, force=force)
    with pytest.raises(ValueError, match="given to vehicle and to output"):
        cgheight.calibrate(truck, [(log, 1.9)], tmp_path / "v.toml", force=force)
    assert log.read_bytes() == RUN.read_bytes()
    kraz = FIXTURES / "vehicles" / "kraz.toml"
    assert (tmp_path / "v.toml").read_bytes() == kraz.read_bytes()


def test_a_foreign_file_needs_force_and_ours_keeps_its_mode(truck, tmp_path):
    def simulated(path, force=False):
        sine = cgheight.Scenario("sine", duration_s=5)
        cgheight.simulate(truck, sine, output=path, force=force)

    def written(path, force=False):
        cgheight.write_log(RUN, path, force=force)

    def calibrated(path, force=False):
        cgheight.calibrate(truck, [(RUN, 1.9)], path, force=force)

    for write, name in [(simulated, "s.csv"), (simulated, "s.csv.gz"), (simulated, "s.log"),
                        (written, "w.csv"), (calibrated, "c.toml")]:  # fmt: skip
        path = tmp_path / name
        path.write_text("precious")
        with pytest.raises(FileExistsError, match=r"exists already.*force=True to replace it"):
            write(path)
        assert path.read_text() == "precious"
        write(path, force=True)
        path.chmod(0o600)
        if name.endswith(".log"):  # CAN frames look like recorded ones
            with pytest.raises(FileExistsError, match="exists already; give"):
                write(path)
        write(path, force=name.endswith(".log"))
        assert path.stat().st_mode & 0o777 == 0o600
        assert "precious" not in path.read_bytes().decode("latin-1")
    assert not [name for name in os.listdir(tmp_path) if name.endswith(".part")]


def test_frames_of_another_format_always_need_force(truck, tmp_path):
    pytest.importorskip("can")
    log = cgheight.simulate(truck, cgheight.Scenario("sine", duration_s=3))
    path = tmp_path / "drive.asc"
    cgheight.write_log(log, path)
    before = path.read_bytes()
    with pytest.raises(FileExistsError, match="exists already; give"):
        cgheight.write_log(log, path)
    assert path.read_bytes() == before
    cgheight.write_log(log, path, force=True)
    assert sorted(os.listdir(tmp_path)) == ["drive.asc", "v.toml"]


def test_a_folder_that_is_not_there_is_an_error_of_the_system(truck, tmp_path):
    with pytest.raises(FileNotFoundError, match="cannot be written"):
        cgheight.simulate(
            truck, cgheight.Scenario("sine", duration_s=3), output=tmp_path / "none" / "a.csv"
        )


def test_an_edited_calibration_is_refused(truck, tmp_path):
    path = tmp_path / "c.toml"
    cgheight.calibrate(truck, [(RUN, 1.9)], path)
    text = path.read_text()
    path.write_text(text.replace("chi_square = ", "chi_square = 1", 1))
    with pytest.raises(ValueError, match="edited or damaged"):
        truck.calibrated(path)
