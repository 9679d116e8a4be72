"""The page of `cg estimate --report`, in a browser: headless Chromium."""

from __future__ import annotations

import gzip
import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from selenium.webdriver.common.by import By

import cgheight
from chromium import PHONE, asked_for, browser, check_contrast, is_within
from conftest import FIXTURES, LOGS, cg

ROOT = FIXTURES.parent
PATHS = [str(FIXTURES / "logs" / name) for name in LOGS]
HOSTILE = "<img src=x onerror=alert(1)>&\"'.csv"


@pytest.fixture(scope="module")
def page(tmp_path_factory) -> Path:
    """Write the report of the ten logs, of a rejected, a hostile and an unreadable one."""
    folder = tmp_path_factory.mktemp("report")
    text = Path(PATHS[0]).read_text().splitlines()
    (folder / "straight.csv").write_text("\n".join(text[:150]) + "\n")
    shutil.copy(PATHS[1], folder / HOSTILE)
    (folder / "broken.csv").write_text("time_s,steer_rad,roll_rad\n0,</script><b>,0\n")
    logs = [*PATHS, *(str(folder / name) for name in ("straight.csv", HOSTILE, "broken.csv"))]
    out = folder / "report.html"
    arguments = ["--vehicle", FIXTURES / "vehicles" / "kraz.toml", "--truth",
                 FIXTURES / "logs" / "truth.json", "--report", out]  # fmt: skip
    done = subprocess.run([cg(), "estimate", *logs, *arguments], capture_output=True, check=False)
    assert done.returncode == 2, done.stderr  # one log cannot be read
    assert b"broken.csv" in done.stderr
    return out


@pytest.fixture(scope="module", params=[(1280, 900), PHONE], ids=["desktop", "phone"])
def opened(request, page):
    """Open the page on a desktop and on a phone."""
    driver = browser(request.param)
    driver.get(page.as_uri())
    yield driver
    driver.quit()


def cells(driver, column: int) -> list[str]:
    rows = "[...document.querySelectorAll('tr.log')]"
    script = f"return {rows}.map(row => row.cells[arguments[0]].textContent)"
    return driver.execute_script(script, column)


def test_the_table_has_every_log_and_what_became_of_it(opened):
    names = cells(opened, 0)
    assert len(names) == len(PATHS) + 3
    # The common folder is not shown; the whole path is in the title.
    assert all(path.endswith(name) for path, name in zip(PATHS, names, strict=False))
    rows = opened.find_elements(By.CSS_SELECTOR, "tr.log")[: len(PATHS)]
    assert [row.get_attribute("title") for row in rows] == PATHS
    heights = dict(zip(names, cells(opened, 1), strict=True))
    states = {Path(name).name: height for name, height in heights.items()}
    assert states["straight.csv"] == "rejected"
    assert states["broken.csv"] == "unreadable"
    assert states[HOSTILE] == states[LOGS[1]]
    assert re.fullmatch(r"\d\.\d{3} m", states[HOSTILE])
    tiles = opened.find_element(By.ID, "totals").text
    assert "13\nlogs" in tiles
    assert "1\nunreadable" in tiles


def test_a_heading_sorts_both_ways_and_absent_values_come_last(opened):
    button = opened.find_elements(By.CSS_SELECTOR, "#logs th button")[1]
    orders = []
    for expected in ("ascending", "descending"):
        button.click()
        head = opened.find_elements(By.CSS_SELECTOR, "#logs th")[1]
        assert head.get_attribute("aria-sort") == expected
        column = cells(opened, 1)
        assert set(column[-2:]) == {"rejected", "unreadable"}
        orders.append([float(text.removesuffix(" m")) for text in column[:-2]])
    assert orders[0] == sorted(orders[0])
    assert orders[1] == orders[0][::-1]


def test_a_row_opens_its_pictures_and_messages(opened):
    rows = opened.find_elements(By.CSS_SELECTOR, "tr.log")
    for row in rows:
        opened.execute_script("arguments[0].click()", row)
    details = opened.find_elements(By.CSS_SELECTOR, "tr.detail")
    assert len(details) == len(rows)
    text = "\n".join(detail.text for detail in details)
    assert "rejected: unexcited" in text
    assert "</script><b>" in text  # the text of the log, not markup
    pictures = opened.find_elements(By.CSS_SELECTOR, "tr.detail svg")
    assert len(pictures) == 3 * (len(PATHS) + 1) + 2  # the straight log has signals only
    script = (
        "return [...document.querySelectorAll('tr.detail path.roll')].map(p => p.getTotalLength())"
    )
    assert min(opened.execute_script(script)) > 100  # each roll angle spans its plot
    assert not opened.find_elements(By.CSS_SELECTOR, "tr.log img, tr.log b, tr.detail b")


def test_the_page_is_no_wider_than_its_screen_and_says_nothing_to_the_console(opened):
    assert is_within(opened)
    assert opened.get_log("browser") == []


def test_nothing_is_fetched(opened, page):
    asked = asked_for(opened)
    assert asked <= {page.as_uri(), "data:,"}
    assert page.as_uri() in asked


def test_every_pair_of_signals_in_the_log_is_drawn(tmp_path):
    """A truck with sensors of the chassis and a roll angle relative to gravity, then without it."""
    log = FIXTURES / "roads" / "B_rural_p16_h170.csv.gz"
    table = [line.split(",") for line in gzip.decompress(log.read_bytes()).decode().splitlines()]
    unused = {"roll_rad", "bank_rad", "axle_roll_rad"}
    road = {"steer_rad", "lateral_acceleration_mps2", "yaw_rate_radps", "roll_to_gravity_rad"}
    force = "suspension roll of the {}, ° and specific force, 0.1 g"
    pairs = [force.format(unit) for unit in ("trailer", "tractor")]
    inputs = ["steer, ° and lateral acceleration, 0.1 g", "roll relative to gravity, °"]
    driver = browser((1280, 900))
    try:
        for without, expected in ((unused, inputs + pairs), (unused | road, pairs)):
            kept = [k for k, name in enumerate(table[0]) if name not in without]
            path, out = tmp_path / "chassis.csv", tmp_path / "chassis.html"
            path.write_text("\n".join(",".join(row[k] for k in kept) for row in table) + "\n")
            run = [cg(), "estimate", path, "--vehicle", FIXTURES / "vehicles" / "euro.toml"]
            run += ["--trailer-mass-kg", "22318", "--report", out]
            subprocess.run(run, capture_output=True, check=True)
            driver.get(out.as_uri())  # the only log is open
            pictures = driver.find_elements(By.CSS_SELECTOR, "tr.detail svg")
            names = [picture.get_attribute("aria-label") for picture in pictures]
            assert names == [*expected, "Heights of chassis.csv"]
            # Each curve spans its plot, which is 408 wide.
            length = "return arguments[0].getTotalLength()"
            for picture in pictures[-3:-1]:
                for line in ("path.roll", "path.lateral"):
                    curve = picture.find_element(By.CSS_SELECTOR, line)
                    assert driver.execute_script(length, curve) > 400
    finally:
        driver.quit()


def test_light_and_dark_can_both_be_read(page):
    """Text and background have at least the WCAG contrast of 4.5 in both color schemes."""
    for scheme in ("light", "dark"):
        driver = browser((1280, 900), scheme)
        try:
            driver.get(page.as_uri())
            check_contrast(driver, scheme, ("body", ".quiet", "td.bad"))
        finally:
            driver.quit()


def test_a_hundred_logs_make_a_page_of_a_few_hundred_kib_and_a_rejected_target_leaves_nothing(
    tmp_path,
):
    out = tmp_path / "many.html"
    vehicle = FIXTURES / "vehicles" / "kraz.toml"
    run = [cg(), "estimate", *(PATHS * 10), "--vehicle", vehicle, "--report"]
    assert subprocess.run([*run, out], capture_output=True, check=False).returncode == 0
    assert out.stat().st_size < 900 * 1024
    refused = subprocess.run([*run, tmp_path], capture_output=True, check=False)
    assert refused.returncode == 2
    assert b"is a folder; give --report a file" in refused.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["many.html"]


def contents(page: Path) -> tuple[str, dict]:
    """Return the page without its data, and its data without the time of writing."""
    text = page.read_text()
    found = re.search(r'<script[^>]*type="application/json"[^>]*>(.*?)</script>', text, re.S)
    data = json.loads(found[1])
    assert re.fullmatch(r"20\d\d-\d\d-\d\d \d\d:\d\d UTC", data.pop("written"))
    return text.replace(found[1], ""), data


def test_the_page_of_python_is_that_of_the_command(tmp_path, kraz):
    """Tables, frames, a drive that makes no height, and a log that cannot be read."""
    frames, straight = tmp_path / "frames.log", tmp_path / "straight.csv"
    truck = kraz.with_(steering_ratio=20.0)
    (tmp_path / "truck.toml").write_text(truck.toml)
    truck = cgheight.Vehicle.load(tmp_path / "truck.toml").on_road("flat")
    cgheight.write_log(PATHS[1], frames, vehicle=truck)
    straight.write_text("\n".join(Path(PATHS[1]).read_text().splitlines()[:150]) + "\n")
    broken = tmp_path / "broken.csv"
    broken.write_text("time_s,steer_rad,roll_rad\n0,<b>,0\n")
    logs = [PATHS[1], PATHS[-1], str(frames), str(broken), str(straight)]
    truth = FIXTURES / "logs" / "truth.json"
    arguments = ["--vehicle", tmp_path / "truck.toml", "--truth", truth, "--road", "flat",
                 "--trailer-mass-kg", "18684", "--report", tmp_path / "cg.html"]  # fmt: skip
    done = subprocess.run([cg(), "estimate", *logs, *arguments], capture_output=True, check=False)
    assert done.returncode == 2, done.stderr
    heights_m = {one["log"]: one["height_m"] for one in json.loads(truth.read_text())}
    options = {"vehicle": truck, "true_heights_m": heights_m, "trailer_mass_kg": 18684}
    answers = cgheight.report(logs, tmp_path / "py.html", errors="reject", **options)
    frame, data = contents(tmp_path / "cg.html")
    own_frame, own = contents(tmp_path / "py.html")
    assert own_frame == frame
    for ours, theirs in zip(own["logs"], data["logs"], strict=True):
        # Messages have the names of options: speed_mps=… here, --speed-mps there.
        words = [[re.sub(r"[^a-z]+", " ", text.lower()) for text in one.pop("messages", [])]
                 for one in (ours, theirs)]  # fmt: skip
        assert words[0] == words[1]
    assert own == data
    assert [one["log"] for one in own["logs"]] == [*logs[:3], logs[4], logs[3]]
    assert "signals" not in own["logs"][4]
    assert own["logs"][0]["known_height_m"] == heights_m[Path(PATHS[1]).name]
    assert [one.status for one in answers][2:] == ["ok", "rejected", "rejected"]
    assert answers[0].height_m == own["logs"][0]["height_m"]
    # It replaces itself, but no input and no other file; and a log that cannot be read is an error.
    cgheight.report(logs[0], tmp_path / "py.html", vehicle=truck)
    with pytest.raises(ValueError, match="broken"):
        cgheight.report(logs, tmp_path / "py.html", vehicle=truck)
    before = straight.read_bytes()
    with pytest.raises(ValueError, match=r"straight\.csv"):
        cgheight.report(straight, straight, vehicle=truck, force=True)
    with pytest.raises(FileExistsError, match=r"broken\.csv"):
        cgheight.report(logs[0], broken, vehicle=truck)
    assert straight.read_bytes() == before


def test_tables_and_calibrations_are_in_the_report(tmp_path, kraz, turn):
    calibrated = cgheight.calibrate(kraz, [(PATHS[0], "empty")], tmp_path / "truck.toml")
    page = tmp_path / "page.html"
    for vehicle, options, named in (
        (kraz, {}, None),
        (calibrated, {}, "the calibration of this vehicle"),
        (kraz, {"calibration": tmp_path / "truck.toml"}, str(tmp_path / "truck.toml")),
    ):
        cgheight.report({"north": turn}, page, vehicle=vehicle, **options)
        _, data = contents(page)
        assert data["calibration"] == named
        (log,) = data["logs"]
        assert log["log"] == "north"
        assert len(log["signals"]["time_s"]) > 100
    with pytest.raises(ValueError, match="errors is 'skip'"):
        cgheight.report([turn], page, vehicle=kraz, errors="skip")
    with pytest.raises(ValueError, match="jobs is 0"):
        cgheight.report([turn], page, vehicle=kraz, jobs=0)


def test_true_heights_of_other_logs_only_are_refused(tmp_path, kraz):
    page = tmp_path / "page.html"
    known = {"other.csv": 1.7}
    with pytest.raises(ValueError, match=r"none of its names \(other\.csv, …\) is that of a log"):
        cgheight.report(PATHS[:1], page, vehicle=kraz, true_heights_m=known)
    assert not page.exists()
