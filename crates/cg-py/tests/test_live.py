"""The page of `cg run --serve`, in a browser: headless Chromium.

This command takes the pictures of docs/live.md:

    CG_FIGURES=docs/figures .venv/bin/python -m pytest crates/cg-py/tests/test_live.py -k read
"""

from __future__ import annotations

import contextlib
import json
import os
import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from selenium import webdriver
from selenium.webdriver.common.by import By

from chromium import PHONE, asked_for, browser, check_contrast, is_within
from conftest import FIXTURES, cg
from test_schemas import VALIDATORS

TRUCK = FIXTURES / "vehicles" / "kraz.toml"
HOSTILE = '<img src=x onerror="alert(1)">'
# A turn of 0.2 g is a warning of level 2 for a truck that rolls over at 0.5 g.
WARN = ["--warn", "0.1,0.3,0.9"]


class Live:
    """A program that serves the rows which the test writes to its standard input."""

    def __init__(self, log: Path, *more: str, truck: Path = TRUCK, port: int = 0) -> None:
        """Start it and read its first line."""
        command = [cg(), "run", "--vehicle", truck, "--csv", "-", "--serve", str(port), *more]
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
        self.process = subprocess.Popen(command, **pipes)
        text = [line for line in log.read_text().splitlines() if not line.startswith("#")]
        self.rows = iter(text)
        self.lines: list[dict] = []
        self.reader = threading.Thread(target=self.read)
        self.reader.start()
        # The program waits for the header before it starts.
        self.feed(1)
        self.url = until(lambda: self.lines and self.lines[0].get("page"))

    def read(self) -> None:
        """Collect the lines."""
        self.lines.extend(json.loads(line) for line in self.process.stdout)

    def feed(self, count: int) -> None:
        """Write this number of rows, all at once."""
        rows = [row for _, row in zip(range(count), self.rows, strict=False)]
        self.process.stdin.write("".join(f"{row}\n" for row in rows))
        self.process.stdin.flush()

    def drive(self, rows: int) -> dict:
        """Write rows, the last ones as slowly as they were recorded; return the last status."""
        self.feed(rows - 50)
        for _ in range(5):
            time.sleep(0.1)
            self.feed(10)
        return until(lambda: self.of("status") and self.of("status")[-1])

    def of(self, event: str) -> list[dict]:
        """Return the lines of this kind."""
        return [line for line in self.lines if line["event"] == event]

    def end(self) -> None:
        """Kill the program."""
        self.process.kill()
        self.process.wait()
        self.reader.join()
        self.process.stdout.close()
        with contextlib.suppress(BrokenPipeError):
            self.process.stdin.close()


def until(condition: Callable[[], object], within_s: float = 20.0):
    """Wait for a condition and return what it gives."""
    end = time.monotonic() + within_s
    while not (found := condition()):
        assert time.monotonic() < end, "nothing has changed"
        time.sleep(0.05)
    return found


def text(driver: webdriver.Chrome, name: str) -> str:
    return driver.find_element(By.ID, name).text


def simulated(path: Path, *more: str) -> Path:
    scenario = ["--maneuver", "drive", "--duration-s", "240", "--seed", "5", "--snr-db", "25"]
    command = [cg(), "simulate", "--vehicle", TRUCK, *scenario, *more, "-o", path]
    subprocess.run(command, check=True)
    return path


@pytest.fixture(scope="module")
def log(tmp_path_factory) -> Path:
    """Return a drive of four minutes with an amplitude of 0.2 g."""
    return simulated(tmp_path_factory.mktemp("live") / "drive.csv")


@pytest.fixture(scope="module")
def live(log) -> Iterator[Live]:
    """Serve a truck in a turn after some maneuvers."""
    served = Live(log, "--status-s", "0.001", *WARN)
    served.drive(21_500)
    yield served
    served.end()


@pytest.fixture(scope="module", params=[(1280, 900), PHONE], ids=["desktop", "phone"])
def opened(request, live) -> Iterator[webdriver.Chrome]:
    """Open the page on a desktop and on a phone."""
    driver = browser(request.param)
    driver.get(live.url)
    until(lambda: text(driver, "link") == "live" and text(driver, "state") != "–")
    yield driver
    driver.quit()


def test_the_values_are_those_of_the_events(opened, live):
    """The page shows its newest event, and that is a line of the output."""
    now = opened.execute_script("return known.now")
    assert now in live.of("status")
    for line in (now, opened.execute_script("return known.turn"), live.lines[0]):
        VALIDATORS["events"].validate(line)
    low, high = now["height_ci95_m"]
    assert text(opened, "vehicle") == "kraz"
    assert text(opened, "height") == f"{now['height_m']:.2f} m"
    assert text(opened, "interval") == f"{low:.2f} to {high:.2f}"
    assert text(opened, "threshold") == f"{now['static_rollover_threshold_g']:.2f} g"
    assert text(opened, "state") == now["state"]
    assert text(opened, "mass") == f"{now['trailer_mass_kg'] / 1000:.1f} t"
    assert text(opened, "maneuvers") == str(now["maneuvers"])
    lateral_g = abs(now["lateral_acceleration_g"])
    assert text(opened, "margin").startswith(f"{now['margin_g']:.2f} g left: {lateral_g:.2f} g of ")


def test_the_pictures_show_the_maneuvers(opened, live):
    maneuvers = [line for line in live.of("maneuver") if line["height_m"]]
    assert len(maneuvers) > 2
    assert len(opened.find_elements(By.CSS_SELECTOR, "#heights circle")) >= len(maneuvers) - 1
    # In one step, because the page makes the bands anew while they are read.
    bands = "[...document.querySelectorAll('#heights rect.band')]"
    widths = opened.execute_script(f"return {bands}.map(band => band.getAttribute('width'))")
    assert sum(map(float, widths)) > 300  # of 408
    # The line of the model and the points are of the last maneuver.
    turn = opened.execute_script("return known.turn")
    assert turn["end_s"] == pytest.approx(live.of("maneuver")[-1]["steer"]["end_s"])
    points = opened.find_elements(By.CSS_SELECTOR, "#turn circle.point")
    assert len(points) == len(turn["roll_rad"]) > 20
    assert len(opened.find_elements(By.CSS_SELECTOR, "#turn path.model")) == 1
    assert len(opened.find_elements(By.CSS_SELECTOR, "#turn path.band")) == 2


def test_the_gauge_shows_the_share_of_the_threshold(opened):
    now = opened.execute_script("return known.now")
    used, limit = opened.execute_script(
        "return [document.querySelector('#gauge .used').getBBox().width,"
        " document.querySelector('#gauge .limit').getBBox().x - 14]"
    )
    share = abs(now["lateral_acceleration_g"]) / now["static_rollover_threshold_g"]
    assert share > 0.1  # in a turn
    # SVG coordinates are in single precision.
    assert used / limit == pytest.approx(share, rel=1e-5)


def test_a_warning_is_shown_as_long_as_it_lasts(opened, live):
    level = live.of("warning")[-1]["level"]
    alarm = opened.find_element(By.ID, "alarm")
    assert level > 0
    assert alarm.is_displayed()
    assert f"level {level}: " in alarm.text
    # In one step, because the page makes the list anew while it is read.
    lines = "return [...document.querySelectorAll('#messages li')].map(line => line.textContent)"
    told = [one for one in opened.execute_script(lines) if "Rollover warning, level" in one]
    assert len(told) == sum(line["level"] > 0 for line in live.of("warning"))


def test_the_page_fits_says_nothing_to_the_console_and_asks_for_its_events_only(opened, live):
    assert is_within(opened)
    assert opened.get_log("browser") == []
    assert asked_for(opened) <= {live.url, f"{live.url}events", "data:,"}


def test_new_events_change_the_page(opened, live):
    before = opened.execute_script("return known.now.samples")
    live.drive(60)
    until(lambda: opened.execute_script("return known.now.samples") > before)
    shown = "return document.getElementById('foot').textContent.includes(`${known.now.samples} s`)"
    until(lambda: opened.execute_script(shown))


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_light_and_dark_can_both_be_read(live, scheme):
    driver = browser(PHONE, scheme)
    try:
        driver.get(live.url)
        until(lambda: text(driver, "state") != "–")
        check_contrast(driver, scheme, ("body", ".quiet", "#alarm", "#link.live", ".chips li"))
        if folder := os.environ.get("CG_FIGURES"):
            height = driver.execute_script("return document.documentElement.scrollHeight")
            metrics = {"width": PHONE[0], "height": height, "deviceScaleFactor": 1, "mobile": True}
            driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
            time.sleep(0.5)
            assert driver.save_screenshot(str(Path(folder) / f"live-{scheme}.png"))
    finally:
        driver.quit()


@pytest.fixture
def phone() -> Iterator[webdriver.Chrome]:
    driver = browser(PHONE, "dark")
    yield driver
    driver.quit()


def test_missing_signals_are_named(phone, log, tmp_path):
    """Without speed and mass. The name of a file is text, not markup."""
    rows = [line.split(",") for line in log.read_text().splitlines() if line[0] != "#"]
    unused = {"speed_mps", "trailer_mass_kg"}
    kept = [k for k, name in enumerate(rows[0]) if name not in unused]
    assert len(kept) < len(rows[0])
    path = tmp_path / "less.csv"
    path.write_text("\n".join(",".join(row[k] for k in kept) for row in rows) + "\n")
    truck = tmp_path / "truck.toml"
    truck.write_text(TRUCK.read_text().replace('name = "kraz"', f"name = '{HOSTILE}'"))
    served = Live(path, truck=truck)
    try:
        served.drive(1000)
        phone.get(served.url)
        gone = "#signals li.gone"
        until(lambda: len(phone.find_elements(By.CSS_SELECTOR, gone)) == 2)
        names = {one.text for one in phone.find_elements(By.CSS_SELECTOR, gone)}
        assert names == {"speed missing", "trailer mass missing"}
        here = {one.text for one in phone.find_elements(By.CSS_SELECTOR, "#signals li.here")}
        assert {"steer", "roll"} <= here
        check_contrast(phone, "dark", ("#signals li.gone",))
        assert text(phone, "vehicle") == HOSTILE
        assert not phone.find_elements(By.CSS_SELECTOR, "main img, h1 img")
        assert text(phone, "height") == "–"
        assert "no threshold" in text(phone, "margin")
    finally:
        served.end()


def test_a_stopped_program_is_shown_and_a_new_one_found_again(phone, log):
    served = Live(log)
    try:
        served.drive(300)
        phone.get(served.url)
        until(lambda: text(phone, "link") == "live")
        port = int(served.url.rstrip("/").rsplit(":", 1)[1])
        served.end()
        until(lambda: text(phone, "link") == "disconnected")
        assert "lost" in phone.find_element(By.TAG_NAME, "body").get_attribute("class")
        served = Live(log, port=port)
        served.drive(100)
        until(lambda: text(phone, "link") == "live")
        until(lambda: phone.execute_script("return known.now && known.now.samples") < 200)
        assert served.process.stdin.close() is None
        assert served.process.wait() in (0, 1)
        until(lambda: text(phone, "link") == "ended")
        assert "The estimation has ended: end of log." in text(phone, "messages")
    finally:
        served.end()


def test_a_height_of_before_the_start_is_shown_as_such(phone, log, tmp_path):
    """The words are beside the number of maneuvers, and the page still fits a phone."""
    kept = ["--state", str(tmp_path / "state.json")]
    replay = [cg(), "run", "--vehicle", TRUCK, "--csv", log, *kept]
    subprocess.run(replay, check=True, stdout=subprocess.DEVNULL)
    served = Live(log, *kept)
    try:
        served.drive(100)
        phone.get(served.url)
        until(lambda: text(phone, "used") == "maneuvers used, none since the start")
        assert text(phone, "maneuvers").isdigit()
        assert text(phone, "height").endswith(" m")
        assert is_within(phone)
    finally:
        served.end()
