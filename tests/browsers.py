"""A headless browser for the tests that look at pages, and what to say where there is none."""

import importlib.util
import os
import shutil

import pytest

BROWSER, DRIVER = shutil.which("chromium") or shutil.which("google-chrome"), shutil.which("chromedriver")
FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync", "--window-size=1200,1600",
)  # fmt: skip
MISSING = [
    *["selenium (pip install selenium)"] * (importlib.util.find_spec("selenium") is None),
    *["chromium and chromedriver (Debian: apt install chromium chromium-driver)"] * (None in (BROWSER, DRIVER)),
]
NEEDED = pytest.mark.skipif(bool(MISSING), reason=f"no browser to look with: install {' and '.join(MISSING)}")


def started(profile):
    """A driver whose console is kept; quit it when done."""
    from selenium.webdriver import Chrome, ChromeOptions, ChromeService

    options = ChromeOptions()
    options.binary_location = BROWSER
    for flag in (*FLAGS, f"--user-data-dir={profile}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return Chrome(options=options, service=ChromeService(DRIVER, log_output=os.devnull))
