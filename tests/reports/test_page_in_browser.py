"""The page in a browser: clicks, keys, the pointer, and both colour schemes."""

import pytest
from browsers import NEEDED, started
from reports.test_page import HOSTILE

import hysdel_py as hys

pytestmark = NEEDED


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    driver = started(tmp_path_factory.mktemp("profile"))
    yield driver
    driver.quit()


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    model = hys.load(HOSTILE)
    path = tmp_path_factory.mktemp("page") / "page.html"
    path.write_text(hys.html_report(model, model.simulate([2.0], [[0.0], [1.0], [1.0], [0.0]])), encoding="utf-8")
    return path.as_uri()


@pytest.fixture
def opened(browser, page):
    browser.get(page)
    return browser


def find(browser, query):
    return browser.find_elements("css selector", query)


def texts(browser, query):
    return [one.text for one in find(browser, query)]


def test_nothing_of_the_model_runs_and_nothing_is_complained_about(opened):
    assert opened.title == "hostile: hysdel report"
    assert opened.get_log("browser") == []
    assert opened.execute_script("return performance.getEntriesByType('resource').length") == 0


def test_a_line_shows_its_rows_and_lets_go(opened):
    button = find(opened, "button[data-line='0-9']")[0]
    button.click()
    assert button.get_attribute("aria-pressed") == "true"
    assert [text.split()[0] for text in texts(opened, ".rows .on")] == ["E0", "E1"]
    assert texts(opened, "#chosen") == ["line 9, 2 rows: E0, E1"]
    button.click()
    assert texts(opened, ".rows .on") == []


def test_a_row_shows_its_lines(opened):
    find(opened, ".rows button")[1].click()
    assert [text.split()[0] for text in texts(opened, ".lines .on")] == ["9", "10"]
    find(opened, ".rows button")[0].click()  # the other one is let go
    assert [text.split()[0] for text in texts(opened, ".lines .on")] == ["12"]
    assert texts(opened, "#chosen") == ["row x0: line 12"]


def test_the_pointer_reads_the_run(opened):
    from selenium.webdriver import ActionChains

    frame = find(opened, ".frame")[0]
    ActionChains(opened).move_to_element(frame).perform()
    read = texts(opened, "#readout")[0]
    assert read.startswith("t = 2,")
    model = hys.load(HOSTILE)
    x = model.simulate([2.0], [[0.0], [1.0], [1.0], [0.0]])["x"][2]
    assert f"x = {x:.6g} " in read
    assert len(find(opened, ".cursor")) == len(find(opened, "#run .chart"))


def test_keys_read_the_run_too(opened):
    from selenium.webdriver import Keys

    frame = find(opened, ".frame")[0]
    frame.send_keys(Keys.ARROW_RIGHT)
    assert texts(opened, "#readout")[0].startswith("t = 0,")
    frame.send_keys(Keys.END)
    assert texts(opened, "#readout")[0].startswith("t = 4,")
    frame.send_keys(Keys.ARROW_LEFT)
    assert texts(opened, "#readout")[0].startswith("t = 3,")


def test_a_mode_shows_its_arrows(opened):
    from selenium.webdriver import Keys

    node = find(opened, ".node")[0]
    node.send_keys(Keys.ENTER)
    edges = find(opened, ".edge.on")
    assert edges
    assert all("0" in (e.get_attribute("data-from"), e.get_attribute("data-to")) for e in edges)
    assert texts(opened, "#modes-table tr.on")[0].startswith("0")


def luminance(colour):
    parts = [int(part) / 255 for part in colour.split("(")[1].rstrip(")").split(",")[:3]]
    linear = [p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_words_stand_out_in_both_schemes(browser, page, scheme):
    """Contrast as the Web Content Accessibility Guidelines 2.1 measure it: at least 4.5."""
    features = {"features": [{"name": "prefers-color-scheme", "value": scheme}]}
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", features)
    browser.get(page)
    paper = luminance(find(browser, "body")[0].value_of_css_property("background-color"))
    assert (paper < 0.2) == (scheme == "dark")
    find(browser, ".rows button")[0].click()
    for query in ("p", "th", "td", "nav a", ".lines button", ".lines .plain", ".rows .on b"):
        one = find(browser, query)[0]
        behind = find(browser, ".rows .on button")[0] if ".on" in query else find(browser, "body")[0]
        lights = (
            luminance(one.value_of_css_property("color")),
            luminance(behind.value_of_css_property("background-color")),
        )
        assert (max(lights) + 0.05) / (min(lights) + 0.05) >= 4.5, query
