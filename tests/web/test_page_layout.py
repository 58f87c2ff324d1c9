"""Panes of every tab are resized, folded and reset, by mouse and by keyboard, and stay so over a reload."""

import pytest
from playwright.sync_api import expect

pytestmark = pytest.mark.live

TAB = "#tab=jobs"
PANES = {
    "simulator": {"Trials and episodes": "right", "Inspector, display and plots": "left"},
    "prediction": {"Recording, predictors and run": "right", "Metrics": "up", "Person and plots": "left"},
    "editor": {"Elements": "right", "Problems and XML": "up", "Chosen element": "left"},
    "evaluation": {"Evaluations": "right"},
    "experiments": {"Operator": "left"},
    "jobs": {"New job": "right"},
}
"""The panes of each tab, and the way in which their dividers make them larger."""
AHEAD = {"right": (1, 0), "left": (-1, 0), "up": (0, -1)}


def show(page, tab):
    page.locator(f"#tab-{tab}").click()
    expect(page.locator(f"#panel-{tab} .divider").first).to_be_visible()


def divider(page, title):
    return page.get_by_role("separator", name=f"Size of {title}", exact=True)


def button(page, word, title):
    return page.get_by_role("button", name=f"{word} {title}", exact=True)


def pane(page, title):
    return page.locator(f"[id='{button(page, 'Fold', title).get_attribute('aria-controls')}']")


def size(page, title, way):
    """Size of a pane that is seen [px]."""
    return pane(page, title).bounding_box()["width" if AHEAD[way][0] else "height"]


def drag(page, title, way, by):
    box = divider(page, title).bounding_box()
    x, y = box["x"] + box["width"] / 2 + 0.2, box["y"] + 3.0  # above the button that folds
    if not AHEAD[way][0]:
        x, y = box["x"] + 3.0, box["y"] + box["height"] / 2 + 0.2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + AHEAD[way][0] * by, y + AHEAD[way][1] * by, steps=4)
    page.mouse.up()


def reload(page):
    page.reload()
    page.wait_for_selector(".connection:not(.lost):has-text('connected')")


@pytest.mark.parametrize("tab", PANES)
def test_panes_are_dragged_and_folded_and_stay_so(page, tab):
    show(page, tab)
    first = {title: size(page, title, way) for title, way in PANES[tab].items()}
    for title, way in PANES[tab].items():
        drag(page, title, way, 60)
        assert size(page, title, way) == pytest.approx(first[title] + 60, abs=1.5)
        assert float(divider(page, title).get_attribute("aria-valuenow")) == pytest.approx(first[title] + 60, abs=1.5)
    reload(page)
    for title, way in PANES[tab].items():
        assert size(page, title, way) == pytest.approx(first[title] + 60, abs=1.5)
        divider(page, title).dblclick(position={"x": 3, "y": 3})
        assert size(page, title, way) == first[title]
        hidden = pane(page, title)
        button(page, "Fold", title).click()
        expect(hidden).to_be_hidden()
        expect(divider(page, title)).to_have_count(0)
    reload(page)
    for title, way in PANES[tab].items():
        button(page, "Unfold", title).click()
        expect(pane(page, title)).to_be_visible()
        assert size(page, title, way) == first[title]
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")


def test_panes_work_with_the_keyboard_alone(page):
    show(page, "prediction")
    for title, way in PANES["prediction"].items():
        less, more = {"right": ("ArrowLeft", "ArrowRight"), "left": ("ArrowRight", "ArrowLeft")}.get(
            way, ("ArrowDown", "ArrowUp")
        )
        line = divider(page, title)
        line.focus()
        page.keyboard.press("Home")
        low = size(page, title, way)
        assert low == float(line.get_attribute("aria-valuemin")) == float(line.get_attribute("aria-valuenow"))
        page.keyboard.press(more)
        assert size(page, title, way) == low + 16
        page.keyboard.press(f"Shift+{more}")
        assert size(page, title, way) == low + 80
        page.keyboard.press(less)
        assert size(page, title, way) == low + 64
        page.keyboard.press("End")
        assert size(page, title, way) == pytest.approx(float(line.get_attribute("aria-valuemax")), abs=1.0)
        page.keyboard.press("Home")
        page.keyboard.press("Enter")
        expect(button(page, "Unfold", title)).to_be_focused()
        page.keyboard.press("Enter")
        expect(button(page, "Fold", title)).to_be_focused()
        assert size(page, title, way) == low


def test_a_layout_is_that_of_its_tab_and_other_texts_in_its_place_are_no_layout(page):
    for text in ("[", "7", "null", '{"jobs/New job": 5}', '{"jobs/New job": {"size": "9em", "folded": 1}}'):
        page.evaluate("text => localStorage.setItem('layout', text)", text)
        reload(page)
        assert size(page, "New job", "right") == 320
    button(page, "Fold", "New job").click()
    for tab in PANES:
        show(page, tab)
        expect(page.locator(f"#panel-{tab} .fold[aria-expanded='false']")).to_have_count(1 if tab == "jobs" else 0)


def test_axe_finds_nothing_in_folded_panes(page, axe):
    show(page, "prediction")
    for title in ("Metrics", "Person and plots"):
        button(page, "Fold", title).click()
    assert axe(page) == []


def test_tools_of_a_page_of_1280_px_leave_the_room_to_its_picture(page):
    show(page, "simulator")
    settings = page.get_by_role("button", name="Settings of circle-crossing")
    trial = page.locator("button[data-name='circle-crossing']")
    settings.wait_for()
    assert page.locator(".simulator .tools").first.bounding_box()["height"] < 45  # one row
    assert settings.bounding_box()["x"] >= trial.bounding_box()["x"] + trial.bounding_box()["width"]  # beside it
    assert settings.bounding_box()["height"] < trial.bounding_box()["height"]
    show(page, "editor")
    assert page.locator(".editor .bar").bounding_box()["height"] < 90  # two rows


def test_a_server_without_virtual_reality_shows_no_controls_for_it(page):
    page.locator("#tab-vr").click()
    expect(page.get_by_text("This server has no virtual reality.")).to_be_visible()
    assert page.locator("#panel-vr").get_by_role("button").count() == 0
    assert page.locator("#panel-vr").get_by_role("img").count() == 0


COVERED = """() => {
  const notes = document.querySelector('.messages');
  const controls = document.querySelectorAll('button, input, select, textarea, summary, a[href], [role=separator]');
  return [...controls].filter((one) => one.checkVisibility() && !notes.contains(one)).filter((one) => {
    const box = one.getBoundingClientRect();
    const hit = document.elementFromPoint(box.x + box.width / 2, box.y + box.height / 2);
    return hit && notes.contains(hit);
  }).map((one) => one.title || one.textContent || one.outerHTML);
}"""


@pytest.mark.parametrize(("width", "height"), [(1280, 800), (1920, 1080)])
def test_messages_cover_no_control_in_any_tab(page, width, height):
    page.set_viewport_size({"width": width, "height": height})
    for tab in PANES:
        show(page, tab)
        for count in range(3):
            page.evaluate("(file) => crowdbot.openInSimulator({ file })", "no-such-hall" * (1 + 4 * count) + ".mcap")
        expect(page.locator(".message.error")).to_have_count(3)
        page.wait_for_function(f"() => ({COVERED})().length === 0")
        box = page.locator(".messages").bounding_box()
        assert 0 <= box["x"] <= width - box["width"]
        assert 0 <= box["y"] <= height - box["height"]
        for _ in range(3):
            page.get_by_role("button", name="Close message").first.click()
        expect(page.locator(".message")).to_have_count(0)


def test_an_error_is_read_and_closed_while_a_dialog_is_open(page):
    show(page, "prediction")
    page.get_by_role("button", name="Open…").click()
    dialog = page.get_by_role("dialog")
    for name in ("first", "second"):
        page.evaluate("(file) => crowdbot.openInSimulator({ file })", f"no-such-{name}.mcap")
    message = page.locator(".message.error")
    expect(message).to_have_count(2)
    page.wait_for_function(f"() => ({COVERED})().length === 0")
    message.first.get_by_role("button", name="Close message").click()  # it takes clicks, so nothing lies above it
    expect(message).to_have_count(1)
    expect(message).to_contain_text("no-such-second.mcap")
    dialog.get_by_role("button", name="Close", exact=True).click()
    expect(dialog).to_have_count(0)
    expect(message).to_be_visible()
    message.get_by_role("button", name="Close message").click()
    expect(message).to_have_count(0)
