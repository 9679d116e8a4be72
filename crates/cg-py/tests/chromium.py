"""Pages in headless Chromium, on a desktop and on a phone, light and dark."""

from __future__ import annotations

import json
import re
import shutil

from selenium import webdriver
from selenium.webdriver.common.by import By

PHONE = (390, 844)


def browser(size: tuple[int, int], scheme: str = "light") -> webdriver.Chrome:
    """Open a window of this size with this color scheme."""
    options = webdriver.ChromeOptions()
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(options, webdriver.ChromeService(shutil.which("chromedriver")))
    # A window cannot be as narrow as a phone.
    metrics = {"width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": size == PHONE}
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
    features = [{"name": "prefers-color-scheme", "value": scheme}]
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": features})
    return driver


def asked_for(driver: webdriver.Chrome) -> set[str]:
    """Return the addresses of all requests since the last call."""
    entries = (json.loads(entry["message"])["message"] for entry in driver.get_log("performance"))
    return {
        entry["params"]["request"]["url"]
        for entry in entries
        if entry["method"] == "Network.requestWillBeSent"
    }


def is_within(driver: webdriver.Chrome) -> bool:
    """Return whether the page is no wider than its screen."""
    script = "const e = document.documentElement; return e.scrollWidth <= e.clientWidth"
    return driver.execute_script(script)


def check_contrast(driver: webdriver.Chrome, scheme: str, selectors: tuple[str, ...]) -> None:
    """Check that texts have at least the WCAG contrast of 4.5 on a page of this color scheme."""
    body = driver.find_element(By.CSS_SELECTOR, "body")
    paper = luminance(body.value_of_css_property("background-color"))
    assert (paper > 0.5) == (scheme == "light")
    for selector in selectors:
        element = driver.find_element(By.CSS_SELECTOR, selector)
        ink = luminance(element.value_of_css_property("color"))
        contrast = (max(ink, paper) + 0.05) / (min(ink, paper) + 0.05)
        assert contrast >= 4.5, (scheme, selector, contrast)


def luminance(color: str) -> float:
    """Return the relative luminance of `rgb(r, g, b)` according to WCAG."""
    parts = [int(part) / 255 for part in re.findall(r"\d+", color)[:3]]
    linear = [
        part / 12.92 if part <= 0.03928 else ((part + 0.055) / 1.055) ** 2.4 for part in parts
    ]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
