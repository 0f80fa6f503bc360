"""The documentation opened from the disk: its search runs in a frame, since browsers start no worker there."""

from pathlib import Path

import pytest
from browsers import NEEDED, started

ROOT = Path(__file__).resolve().parents[1]
pytestmark = NEEDED

PAGE = """<!doctype html><meta charset="utf-8"><body><script src="{shim}"></script><script>
const worker = new Worker("worker.js");
window.heard = [];
worker.addEventListener("message", (event) => heard.push(event.data));
["sent at once", "and again"].forEach((text) => worker.postMessage({{ text }}));
</script>"""
WORKER = "addEventListener('message', (event) => postMessage(event.data.text + ' and answered'));"


@pytest.fixture
def browser(tmp_path):
    driver = started(tmp_path / "profile")
    yield driver
    driver.quit()


def test_a_worker_on_the_disk_answers_all_messages_in_order(browser, tmp_path):
    from selenium.webdriver.support.ui import WebDriverWait

    (tmp_path / "worker.js").write_text(WORKER)
    (tmp_path / "page.html").write_text(PAGE.format(shim=(ROOT / "docs/making/iframe-worker.js").as_uri()))
    browser.get((tmp_path / "page.html").as_uri())
    heard = WebDriverWait(browser, 10).until(lambda page: page.execute_script("return heard.length == 2 && heard"))
    assert heard == ["sent at once and answered", "and again and answered"]
    browser.execute_script("worker.postMessage({text: 'later'})")
    assert browser.execute_script("return heard[2]") == "later and answered"
    assert browser.get_log("browser") == []
