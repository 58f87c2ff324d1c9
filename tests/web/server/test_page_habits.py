"""Habits of the page: the keyboard alone, reduced motion, and a link that shows the same."""

import re

import pytest
from playwright.sync_api import expect

pytestmark = pytest.mark.live

TABS = ("prediction", "editor", "evaluation", "experiments", "jobs")
CONTROLS = (
    "button:not([disabled]):not([tabindex='-1']), select:not([disabled]), input:not([disabled]):not([type=radio]), "
    "textarea:not([disabled]), a[href], [tabindex='0']"
)

SCENE = "globalThis.crowdbot?.tab('simulator')?.picture.scene"
"""The picture of the simulator."""


def show(page, tab):
    page.get_by_role("tab", name=re.compile(tab, re.IGNORECASE)).click()
    page.wait_for_function("tab => crowdbot.tab(tab) !== undefined && !crowdbot.connection.busy", arg=tab)
    page.wait_for_load_state("networkidle")
    if tab == "editor":
        page.wait_for_function("() => document.querySelector('.editor textarea').value.includes('trial')")


def address(page):
    """Address that the page shows now; ``page.url`` learns later of what it writes itself."""
    return page.evaluate("location.href")


STILL_SHOWN = """(i) => {
  const one = document.querySelector(`[data-control="${i}"]:not(:disabled)`);
  return one?.checkVisibility() ? one.outerHTML.slice(0, 120) : null;
}"""
"""The text of a control, unless it has been disabled or hidden meanwhile."""


@pytest.mark.parametrize(
    "tab", ["prediction", "jobs", *(pytest.param(item, marks=pytest.mark.sweep) for item in TABS[1:4])]
)
def test_every_control_is_reached_with_the_tab_key_and_shows_it(page, tab):
    show(page, tab)
    page.evaluate("document.activeElement.blur()")
    count = page.evaluate(
        """(controls) => {
          const shown = [...document.querySelectorAll(controls)].filter((one) => one.checkVisibility());
          shown.forEach((one, i) => (one.dataset.control = i));
          return shown.length;
        }""",
        CONTROLS,
    )
    reached, without = set(), []
    for _ in range(2 * count + 10):  # after the last control the focus leaves the page and comes back
        page.keyboard.press("Tab")
        number, outline, name = page.evaluate(
            """() => {
              const one = document.activeElement;
              return [one.dataset.control, getComputedStyle(one).outlineStyle, one.outerHTML.slice(0, 120)];
            }"""
        )
        reached.add(number)
        if outline == "none" and not name.startswith("<body"):
            without.append(name)
        if len(reached - {None}) == count:
            break
    missed = [page.evaluate(STILL_SHOWN, i) for i in range(count) if str(i) not in reached]
    assert [item for item in missed if item is not None] == []
    assert without == []


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_axe_finds_nothing_on_the_tabs_of_an_empty_start(page, axe, theme):
    page.get_by_label("View", exact=True).select_option("2d")
    page.evaluate("theme => document.documentElement.dataset.theme = theme", theme)
    found = {}
    for tab in ("simulator", *TABS):
        show(page, tab)
        found[tab] = axe(page)
    assert found == {tab: [] for tab in found}


def test_tabs_and_a_job_by_keyboard_alone(page):
    page.evaluate("document.getElementById('tab-simulator').focus()")
    for _ in range(5):
        page.keyboard.press("ArrowRight")
    page.wait_for_function("() => crowdbot.keys.active === 'jobs'")
    page.get_by_role("button", name="Search for failures").focus()
    page.keyboard.press("Enter")
    page.get_by_role("form", name="Search for failures").get_by_label("Name of the results").focus()
    page.keyboard.press("Control+A")
    page.keyboard.type("../a")
    page.keyboard.press("Enter")
    page.get_by_text("file '../a' is outside the folder of the app").wait_for()
    assert page.locator(".job").count() == 0
    page.keyboard.press("Escape")


def test_nothing_moves_with_reduced_motion(page):
    for tab in TABS:
        show(page, tab)
        assert page.evaluate("document.getAnimations().length") == 0
        assert (
            page.evaluate(
                "[...document.querySelectorAll('progress:indeterminate')].filter((e) => e.checkVisibility()).length"
            )
            == 0
        )


def test_a_link_shows_the_same(page, browser, app):
    show(page, "editor")
    page.evaluate("crowdbot.connection.call('editor.start', {trial: 'frontal'})")
    page.get_by_role("listbox", name="Elements").get_by_role("option", name="robot").click()
    page.wait_for_function("() => location.hash.includes('element=')")
    other = browser.new_page()
    other.goto(address(page))
    other.locator(".inspector h3").get_by_text("<robot>").wait_for()

    show(page, "prediction")
    page.evaluate("crowdbot.connection.call('prediction.example', {name: 'bottleneck'})")
    page.wait_for_function("() => crowdbot.tab('prediction').store.frame !== null")
    page.get_by_label("Jump to frame").fill("17")
    page.get_by_label("Jump to frame").press("Enter")
    page.locator("canvas.scene[data-frame='10']").wait_for()
    page.get_by_role("checkbox", name="Numbers").check()
    page.get_by_role("checkbox", name="Observed").uncheck()
    page.evaluate("crowdbot.tab('prediction').store.emit('plot', {variable: 'cost', person: 3})")
    other.goto("about:blank")
    other.goto(address(page))
    other.locator("canvas.scene[data-frame='10']").wait_for()
    expect(other.get_by_role("checkbox", name="Numbers")).to_be_checked()
    expect(other.get_by_role("checkbox", name="Observed")).not_to_be_checked()
    assert "curves=cost%403" in address(other)

    show(page, "jobs")
    page.get_by_role("button", name="Generate data").click()
    other.goto("about:blank")
    other.goto(address(page))
    other.get_by_role("form", name="Generate data").wait_for()
    assert other.evaluate("crowdbot.keys.active") == "jobs"
    other.close()


@pytest.mark.parametrize(("view", "eye"), [("2d", [1.5, -2.0, 40.0]), ("3d", [-3.0, -4.0, 5.0, 1.0, 2.0, 0.5])])
def test_a_link_shows_the_same_view_of_the_simulator(page, browser, app, view, eye):
    page.wait_for_function(f"() => {SCENE}.info().people > 20")
    if view == "2d":
        page.get_by_label("View", exact=True).select_option("2d")
        page.wait_for_function(f"() => {SCENE}.info().calls === 0 && {SCENE}.info().people > 20")
    page.wait_for_function("() => crowdbot.tab('simulator').status.state === 'running'")
    page.evaluate("crowdbot.connection.call('simulator.pause')")
    page.evaluate("crowdbot.tab('simulator').inspector.select({ kind: 'person', id: 7 })")
    page.wait_for_function("() => location.hash.includes('chosen=person-7')")
    page.get_by_label("Camera", exact=True).select_option("free")
    page.get_by_role("checkbox", name="Zones").uncheck()
    page.evaluate(f"(eye) => {SCENE}.setViewpoint(eye)", eye)
    page.locator("canvas.stage").dispatch_event("pointerup")
    page.wait_for_function(
        f"() => new URLSearchParams(location.hash.slice(1)).get('eye') === '{','.join(f'{item:g}' for item in eye)}'"
    )
    other = browser.new_page(viewport={"width": 1280, "height": 800}, reduced_motion="reduce")
    other.set_default_timeout(180_000)
    other.goto(address(page))
    other.wait_for_function(
        f"() => {SCENE}?.info().people > 20 && crowdbot.tab('simulator').inspector.chosen?.id === 7"
    )
    other.wait_for_function(f"(eye) => {SCENE}.viewpoint().every((one, i) => Math.abs(one - eye[i]) < 0.02)", arg=eye)
    assert other.evaluate(f"{SCENE}.camera") == "free"
    assert other.evaluate(f"{SCENE}.layers().find((one) => one.name === 'zones').visible") is False
    assert f"view={view}" in address(other) or view == "3d"
    other.close()
