"""A person's path through the simulator tab in a real browser, from an empty start."""

import threading
import time

import numpy as np
import pytest
from playwright.sync_api import expect

from crowdbot.recording import read_episode, record, replay
from crowdbot.simulation import PushOrder
from crowdbot.trials import load_trial, trial_groups
from crowdbot.web.simulator import FIRST, live_run
from crowdbot.web.simulator.trial_preview import trial_preview

pytestmark = pytest.mark.live

VIEW = "window.crowdbot._views.get('simulator')"
FIRST_RUN = 300_000
"""Longest time [ms] of a first run, which compiles kernels."""


def wait(page, expression, seconds=180.0):
    """Wait until a JavaScript expression is true; the page forbids functions made from text."""
    end = time.monotonic() + seconds
    while not page.evaluate(expression):
        if time.monotonic() > end:
            raise TimeoutError(f"{expression}: {page.evaluate(f'JSON.stringify({VIEW}.status)')[:500]}")
        page.wait_for_timeout(50)


def state(page, *names):
    wait(page, f"{list(names)}.includes({VIEW}.status.state)", FIRST_RUN / 1000)


def status(page, name):
    return page.evaluate(f"{VIEW}.status.{name}")


def show_from_above(page):
    """The picture in space takes long without a graphics card."""
    page.get_by_label("View", exact=True).select_option("2d")


def open_trial(page, name):
    page.get_by_label("Search trials").fill(name)
    page.locator(f"button[data-name='{name}']").click()
    wait(page, f"{VIEW}.status.trial === '{name}'")
    state(page, "running", "paused", "ended")


@pytest.fixture
def files(app):
    return app.folder


def test_an_empty_start_shows_a_robot_among_walking_people(page, files):
    expect(page.get_by_role("tab", name="Simulator")).to_have_attribute("aria-selected", "true")
    wait(page, f"{VIEW}.status.trial === '{FIRST[0]}'")
    wait(page, "document.querySelectorAll('.trials li img').length > 30")
    state(page, "running")
    wait(page, f"{VIEW}.picture.scene.info().people > 20 && {VIEW}.picture.scene.info().robots === 1", 120)
    wait(page, f"{VIEW}.picture.scene.info().calls > 0")  # drawn in space
    wait(page, "document.querySelectorAll('[aria-label=\"Choose a person or robot\"] option').length > 20", 60)
    show_from_above(page)
    at = status(page, "time")
    wait(page, f"{VIEW}.status.time > {at} + 0.5")
    page.get_by_role("button", name="Pause").click()
    state(page, "paused")
    page.reload()
    page.wait_for_selector(".connection:not(.lost):has-text('connected')")
    state(page, "paused")
    wait(page, "location.hash.includes('view=2d')")  # a link shows the same
    expect(page.get_by_label("View", exact=True)).to_have_value("2d")
    wait(page, f"{VIEW}.plots.rows.length > 1")


def test_a_distance_is_measured_and_a_legend_explains_the_zones_of_the_trial(page, files):
    show_from_above(page)
    open_trial(page, "crossing-flows")
    page.get_by_role("button", name="Pause").click()
    legend = page.get_by_role("list", name="Legend")
    wait(page, f"{VIEW}.picture.scene.state.description?.zones.some((zone) => zone.kind === 'start')")
    expect(legend.get_by_role("listitem").first).to_have_text("Start of people")
    expect(legend.get_by_role("listitem").nth(1)).to_have_text("Goal of people")
    assert "Portal" not in legend.inner_text()
    picture, strip = (page.locator(f".simulator {one}").bounding_box() for one in (".picture", ".picture-legend"))
    assert strip["y"] >= picture["y"] + picture["height"]  # it covers nothing of the picture
    assert strip["height"] < 30
    page.get_by_text("Legend", exact=True).click()
    expect(legend).to_be_hidden()
    page.reload()
    page.locator(".picture-legend:not([hidden]) summary").wait_for()
    expect(legend).to_be_hidden()
    page.get_by_text("Legend", exact=True).click()
    expect(legend).to_be_visible()
    page.get_by_label("Zones").uncheck()
    wait(page, "!document.querySelector('.picture-legend').textContent.includes('Start')")
    wait(page, f"{VIEW}.picture.scene.state.frame")
    page.get_by_role("button", name="Measure").click()
    box, scale = page.locator("canvas.stage").bounding_box(), page.evaluate(f"{VIEW}.picture.scene.viewpoint()[2]")
    for share in (0.3, 0.7):
        page.mouse.click(box["x"] + share * box["width"], box["y"] + 0.5 * box["height"])
    note = page.locator(".picture-note")
    note.get_by_text("m in x").wait_for()
    assert float(note.inner_text().split(" m")[0]) == pytest.approx(0.4 * box["width"] / scale, abs=3.0 / scale + 0.01)
    drawn = f"{VIEW}.picture.scene._measured.length"
    assert page.evaluate(drawn) == 2
    page.get_by_label("View", exact=True).select_option("3d")
    wait(page, f"{VIEW}.picture.scene._measured.visible === true")
    page.keyboard.press("Escape")
    wait(page, f"{VIEW}.picture.scene._measured.visible === false")
    expect(note).to_be_hidden()


def test_a_view_that_is_changed_while_it_loads_is_no_error(page, files):
    wait(page, f"{VIEW}.picture.scene.info().people > 20 && {VIEW}._listing === null", FIRST_RUN / 1000)
    wait(page, f"{VIEW}.picture._loading === null")
    page.evaluate(
        f"""async () => {{
          const {{ picture }} = {VIEW}, {{ scene }} = picture, load = scene.load.bind(scene);
          scene.load = async (description) => {{ await load(description); picture.setView("2d"); }};
          await picture._load();
        }}"""
    )
    wait(page, f"{VIEW}.picture.view === '2d' && {VIEW}.picture.scene.info().people > 20")
    assert page.locator(".message.error").count() == 0
    wait(page, "document.querySelectorAll('[aria-label=\"Choose a person or robot\"] option').length > 20")


def test_a_run_is_steered_saved_and_replays(page, files):
    show_from_above(page)
    open_trial(page, "circle-crossing")
    page.get_by_role("button", name="Pause").click()
    state(page, "paused")
    wait(page, f"{VIEW}.picture.scene.info().people === 5")
    at = status(page, "time")
    page.get_by_role("button", name="Step", exact=True).click()
    wait(page, f"Math.abs({VIEW}.status.time - {at} - 0.05) < 1e-6")

    page.get_by_role("button", name="Add person").click()
    box = page.locator("canvas.stage").bounding_box()
    for x, y in ((0.3, 0.5), (0.7, 0.5)):
        page.mouse.click(box["x"] + x * box["width"], box["y"] + y * box["height"])
    wait(page, f"{VIEW}.status.values.people === 6")

    page.get_by_label("Choose a person or robot").focus()
    wait(page, "document.querySelectorAll('option[value=\"person 6\"]').length === 1")
    page.get_by_label("Choose a person or robot").select_option("person 6")
    page.get_by_role("rowheader", name="preferred speed").wait_for()
    page.get_by_label("x [m]", exact=True).fill("2")
    page.get_by_label("y [m]", exact=True).fill("3")
    page.get_by_role("button", name="Set goal").click()
    page.get_by_role("cell", name="2.00, 3.00 m").wait_for()
    page.get_by_label("Force of a push [N]").fill("150")
    page.get_by_role("button", name="Push +x").click()
    wait(page, f"{VIEW}.status.orders === 3")

    page.get_by_label("Choose a person or robot").select_option("robot 5")
    page.get_by_label("Navigator").select_option("straight")
    page.get_by_role("cell", name="straight").wait_for()
    page.get_by_role("button", name="Save", exact=True).click()
    page.get_by_role("button", name="circle-crossing-seed").wait_for()
    saved = next(files.glob("circle-crossing-seed-*.mcap"))
    orders = [order for _, order in read_episode(saved).orders]
    assert len(orders) == 4
    assert PushOrder(person=6, force=150, source="app") in orders
    assert replay(saved).equal


def test_clicks_before_the_first_picture_are_kept(page, files, monkeypatch):
    show_from_above(page)
    gate, inner = threading.Event(), live_run.open_run

    def late(*arguments, **options):
        assert gate.wait(180.0)
        return inner(*arguments, **options)

    def begin(name):
        page.locator(f"button[data-name='{name}']").click()
        wait(page, f"{VIEW}.status.trial === '{name}' && {VIEW}.status.state === 'preparing'")
        page.locator("canvas.preview").wait_for()

    def add(start, goal):
        """Click two places of the floor [m] as the preview shows it."""
        page.get_by_role("button", name="Add person").click()
        for words, (x, y) in (("Click where the person starts", start), ("Click the goal of the person", goal)):
            page.locator(".picture-note").get_by_text(words).wait_for()
            away = x - (left + right) / 2, y - (low + high) / 2  # from the middle of the picture
            page.mouse.click(
                box["x"] + box["width"] / 2 + scale * away[0], box["y"] + box["height"] / 2 - scale * away[1]
            )
        page.get_by_text("this is done as soon as it runs").first.wait_for()

    page.locator("button[data-name='circle-crossing']").wait_for()
    monkeypatch.setattr(live_run, "open_run", late)
    try:
        begin("circle-crossing")
        left, low, right, high = trial_preview(load_trial("circle-crossing"))["bounds"]
        box = page.locator("canvas.stage").bounding_box()
        scale = 0.92 * min(box["width"] / (right - left), box["height"] / (high - low))
        add((-3.0, 1.0), (2.0, -2.0))
        begin("dense-circle")  # another run
        page.get_by_text("not done: another run was opened").wait_for()
        begin("circle-crossing")
        add((1.0, 3.0), (-2.0, -3.0))
    finally:
        gate.set()
    wait(page, f"{VIEW}.status.values?.people === 6")
    page.get_by_role("button", name="Save", exact=True).click()
    page.get_by_role("button", name="circle-crossing-seed").wait_for()
    (order,) = [order for _, order in read_episode(next(files.glob("*.mcap"))).orders]
    assert (order.x, order.y, order.goal_x, order.goal_y) == pytest.approx((1.0, 3.0, -2.0, -3.0), abs=0.03)


def test_a_click_without_a_picture_is_answered(browser, serve, tmp_path):
    page = browser.new_page(viewport={"width": 1280, "height": 800}, reduced_motion="reduce")
    with serve(tmp_path / "files") as server:
        page.goto(f"{server.url}#view=2d&trial=nowhere")
        wait(page, f"{VIEW}?.status.state === 'failed'", 60)
        page.get_by_role("button", name="Measure").click()
        page.locator("canvas.stage").click()
        page.get_by_text("The picture does not show the floor yet").wait_for()
        assert page.evaluate(f"{VIEW}.status.state") == "failed"  # the click has started nothing
    page.close()


PAUSES = """async (count) => {
  const found = [], { scene } = crowdbot.tab("simulator").picture;
  for (let k = 0; k < count; k++) {
    await new Promise((resolve) => setTimeout(resolve, 20));
    found.push(scene.busy);
  }
  return found;
}"""
"""Whether a picture in space leaves the page to others, asked again and again."""


def test_a_picture_without_a_graphics_card_leaves_time_to_the_compiler(browser, serve, tmp_path, monkeypatch):
    compiled = threading.Event()

    def prepare(closed, compiling):
        compiling()
        while not (closed() or compiled.wait(0.05)):
            pass

    monkeypatch.setattr(live_run, "prepare_kernels", prepare)
    canvas = f"{VIEW}.picture.canvas"
    with serve(tmp_path / "files") as server:
        page = browser.new_page(viewport={"width": 1280, "height": 800}, reduced_motion="reduce")
        page.goto(server.url)
        wait(page, f"{VIEW}?.picture.scene.info().frames > 1")
        wait(page, f"{canvas}.width < 0.6 * {canvas}.clientWidth")
        shown = page.evaluate(f"{VIEW}.picture.scene.info().time")
        wait(page, f"{VIEW}.picture.scene.info().time > {shown}")  # people walk all the same
        assert status(page, "recorded")
        assert sum(page.evaluate(f"{VIEW}.picture.scene.rests") for _ in range(100)) > 50
        compiled.set()
        state(page, "running")
        wait(page, f"{canvas}.width === {canvas}.clientWidth")
        assert not page.evaluate(f"{VIEW}.picture.scene.rests")
        drawn = page.evaluate(f"{VIEW}.picture.scene.info().frames")
        wait(page, f"{VIEW}.picture.scene.info().frames > {drawn + 2}")
        asked = page.evaluate(PAUSES, 30)
        assert sum(asked) > 20  # as a rule the page is asked in a pause, and not held up by the next picture
        page.close()


def test_a_robot_is_driven_by_keys_and_the_joystick(page, files):
    show_from_above(page)
    open_trial(page, "static-crowd")
    page.get_by_label("Choose a person or robot").focus()
    people = page.evaluate("crowdbot.connection.call('simulator.people')")
    robot = next(f"robot {person['id']}" for person in people if person["kind"] == "robot")
    wait(page, f"[...document.querySelectorAll('option')].some((one) => one.value === '{robot}')")
    page.get_by_label("Choose a person or robot").select_option(robot)
    page.get_by_role("button", name="Drive").click()
    page.locator(".drive").wait_for()
    page.keyboard.down("a")
    page.get_by_role("cell", name="0.00 m/s, 1.20 rad/s, 0.00 m/s").wait_for()
    page.keyboard.up("a")
    page.get_by_role("cell", name="0.00 m/s, 0.00 rad/s, 0.00 m/s").wait_for()
    pad = page.locator(".joystick").bounding_box()
    page.mouse.move(pad["x"] + pad["width"] / 2, pad["y"] + 4)
    page.mouse.down()
    page.get_by_role("cell", name="0.5").first.wait_for()
    page.mouse.up()
    page.evaluate("navigator.getGamepads = () => [null, { mapping: 'standard', axes: [0, -1, 0.05, 0], buttons: [] }]")
    page.get_by_role("cell", name="0.60 m/s, 0.00 rad/s, 0.00 m/s").wait_for()
    page.evaluate("navigator.getGamepads = () => [{ mapping: '', axes: [1, 0], buttons: [] }]")
    page.get_by_role("cell", name="0.00 m/s, -1.20 rad/s, 0.00 m/s").wait_for()
    page.evaluate("navigator.getGamepads = () => []")
    page.keyboard.press("Escape")
    wait(page, f"{VIEW}.drive.subject === null")
    page.get_by_role("cell", name="orca", exact=True).wait_for()
    page.get_by_role("button", name="Save", exact=True).click()
    page.get_by_role("button", name="static-crowd-seed").wait_for()
    saved = next(files.glob("static-crowd-seed-*.mcap"))
    assert replay(saved).equal
    kinds = {type(order).__name__ for _, order in read_episode(saved).orders}
    assert {"ParameterOrder", "VelocityOrder"} <= kinds


def test_the_keyboard_alone_runs_restarts_and_ends_with_the_digest_of_the_command_line(page, files):
    show_from_above(page)
    open_trial(page, "circle-crossing")
    page.evaluate("document.activeElement.blur()")
    page.keyboard.press("n")  # another seed
    wait(page, f"{VIEW}.source.seed !== 1 && {VIEW}.status.trial === 'circle-crossing'")
    state(page, "running", "paused", "ended")
    for _ in range(5):
        page.keyboard.press("]")
    wait(page, f"{VIEW}.status.speed === null")
    state(page, "ended")
    page.get_by_role("button", name="Save", exact=True).focus()
    page.keyboard.press("Enter")
    page.get_by_role("button", name="circle-crossing-seed").wait_for()
    episode = read_episode(next(files.glob("circle-crossing-seed-*.mcap")))
    assert episode.digest == record(load_trial("circle-crossing"), episode.seed).digest


def test_an_episode_is_opened_scrubbed_and_branched_and_two_windows_agree(page, files, browser, app):
    record(load_trial("circle-crossing"), 4, files / "one.mcap")
    show_from_above(page)
    page.evaluate(f"{VIEW}.library.loadEpisodes()")
    page.get_by_role("button", name="one.mcap").click()
    wait(page, f"{VIEW}.status.name === 'one.mcap'")
    state(page, "paused")
    wait(page, f"{VIEW}.plots.rows.length > 20")
    page.get_by_role("slider", name="Time").fill("5")
    wait(page, f"Math.abs({VIEW}.status.time - 5) < 0.051")
    page.evaluate("document.activeElement.blur()")
    page.keyboard.press("ArrowLeft")
    wait(page, f"Math.abs({VIEW}.status.time - 4) < 0.051")
    other = browser.new_page(reduced_motion="reduce")
    other.goto(app.url + "#view=2d")
    wait(other, f"{VIEW}?.status.name === 'one.mcap' && {VIEW}.picture.scene.info().people === 5")
    assert abs(other.evaluate(f"{VIEW}.status.time") - 4) < 0.051
    other.close()
    page.get_by_role("button", name="Branch from here").click()
    page.get_by_label("Navigator of the robot").select_option("straight")
    page.get_by_role("dialog").get_by_role("button", name="Branch", exact=True).click()
    wait(page, f"{VIEW}.status.name?.startsWith('one-from-4s') ?? false")
    state(page, "paused")
    assert status(page, "begin") == 4.0


def test_trials_stand_in_groups_with_pictures_of_people(page, files):
    (files / "mine.xml").write_text('<trial name="mine" duration="9"><stage/><agent x="0" y="0" goal="4,0"/></trial>')
    page.reload()
    show_from_above(page)
    trials = page.locator(".trials")
    trials.locator("section").first.wait_for()
    groups = [item.get_attribute("aria-label") for item in trials.locator("section").all()]
    assert groups == ["Files of the folder", *dict.fromkeys(trial_groups().values())]
    for name, group in [("mine.xml", groups[0]), *trial_groups().items()]:
        row = trials.get_by_role("region", name=group).locator(f"button[data-name='{name}'] img")
        expect(row, name).to_have_count(1)
    for name, people in (("frontal", 1), ("dense-circle", 20)):
        picture = page.request.get(page.evaluate(f"document.querySelector('[data-name=\"{name}\"] img').src"))
        assert picture.text().count("<circle") == people + 1  # the people and the robot
    page.get_by_label("Search trials").fill("circle")
    shown = [one.get_attribute("aria-label") for one in trials.locator("section:visible").all()]
    assert shown == [group for group in groups if group in ("Crowds in open places", "CrowdNav")]
    trials.locator("button[data-name='crowdnav-circle-5']").click()
    wait(page, f"{VIEW}.status.trial === 'crowdnav-circle-5'")


def test_the_summary_of_the_picture_is_that_of_the_instant_of_a_pause(page):
    show_from_above(page)
    open_trial(page, "circle-crossing")
    page.get_by_role("button", name="Pause").click()
    state(page, "paused")
    for _ in range(2):
        before = status(page, "time")
        page.get_by_role("button", name="Step", exact=True).click()
        wait(page, f"{VIEW}.status.time > {before}")
        shown = page.evaluate(f"{VIEW}.status.time.toFixed(1)")
        expect(page.get_by_role("status", name="Summary of the picture")).to_contain_text(f"At {shown} s: ")


def test_a_run_that_ends_as_its_trial_plans_is_not_called_a_timeout(page):
    show_from_above(page)
    values = {"duration": "1", "end/goal": "false"}
    page.evaluate("settings => crowdbot.connection.call('simulator.open', { name: 'frontal', settings })", values)
    wait(page, f"{VIEW}.status.state === 'ended' && {VIEW}.status.trial === 'frontal'", FIRST_RUN / 1000)
    expect(page.locator(".status-line")).to_contain_text("frontal, seed 1: ended as planned")


CROWD = """<trial name="crowd" duration="3600"><stage walkable="-15,-15 15,-15 15,15 -15,15"/><crowd type="orca"/>
<journey name="east"><direction heading="0"/></journey>
<spawner count="200" zone="-14,-14 14,-14 14,14 -14,14" journey="east"/></trial>"""
"""No computer takes 2000 steps of it in a second."""


def test_a_run_that_cannot_keep_its_speed_says_so_until_another_speed_is_chosen(page, files):
    show_from_above(page)
    (files / "crowd.xml").write_text(CROWD)
    page.evaluate("crowdbot.connection.call('simulator.open', { name: 'crowd.xml' })")
    wait(page, f"{VIEW}.status.trial === 'crowd' && {VIEW}.status.time > 1")
    remark = page.get_by_role("status").filter(has_text="cannot keep up with speed")
    page.evaluate("crowdbot.connection.call('simulator.speed', { speed: 100 })")
    expect(remark).to_be_visible()
    assert "This computer cannot keep up with speed 100x" in remark.text_content()
    page.get_by_label("Speed relative to real time").select_option("0.1")
    expect(remark).to_have_count(0)


def test_axe_finds_nothing_in_both_themes(page, axe):
    show_from_above(page)
    open_trial(page, "circle-crossing")
    page.get_by_role("button", name="Pause").click()
    page.get_by_label("Choose a person or robot").focus()
    wait(page, "document.querySelectorAll('option[value=\"person 0\"]').length === 1")
    page.get_by_label("Choose a person or robot").select_option("person 0")
    page.get_by_text("Values of the trial").click()
    page.get_by_label("Search values").fill("robot/drive")
    for _ in range(2):
        assert axe(page) == []
        page.get_by_role("button", name="Theme").click()


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # the cut connection, at its deletion
def test_a_lost_server_is_said_and_the_page_connects_again(page, app):
    page.evaluate("window.crowdbot.connection._socket.close()")
    page.wait_for_selector(".connection.lost")
    page.wait_for_selector(".connection:not(.lost):has-text('connected')")
    wait(page, f"{VIEW}.status.state !== 'none'")
    assert np.isfinite(status(page, "time"))
