"""What a tab shows is the present state of the server: opened late, in a second window, after a restart."""

import re

import pytest
from simulator_session import ready, simulator, wait_until

from crowdbot.core import InputError
from crowdbot.recording import record
from crowdbot.trials import load_trial
from crowdbot.web.simulator import FIRST
from crowdbot.web.simulator.first_trial import RunAddress, read_link

TAB = "#tab=jobs"
STATUS = "crowdbot.tab('simulator').status"
SHOWN = "crowdbot.tab('simulator').picture.newest"
GREETING = "crowdbot.connection.call('simulator.greet').catch(() => ({ status: {} }))"
TRIAL = '<trial name="mine" duration="9" seed="1"><stage/><agent x="0" y="0" goal="4,0"/></trial>'


def call(page, address, **arguments):
    """Call a command, as another window of the session does."""
    return page.evaluate("([a, b]) => crowdbot.connection.call(a, b)", [address, arguments])


def show(page, title):
    page.get_by_role("tab", name=re.compile(f"^{title}")).click()


@pytest.mark.live
def test_a_tab_that_is_opened_late_shows_what_happened_since_the_connection(page, app):
    record(load_trial("frontal", duration=1.0), 4, app.folder / "frontal.mcap")
    call(page, "simulator.open", name="frontal", seed=7, paused=True)
    revision = call(page, "editor.greet")["revision"]
    call(page, "editor.write", text=TRIAL, revision=revision)
    call(page, "prediction.example", name="bottleneck")
    call(page, "experiments.open", experiment="robot-speed", participant=11)

    show(page, "Simulator")
    page.get_by_text("frontal, seed 7: paused").wait_for()
    show(page, "Editor")
    page.wait_for_function("text => document.querySelector('.editor textarea').value === text", arg=TRIAL)
    show(page, "Prediction")
    page.get_by_role("region", name="Recording").get_by_text("bottleneck").first.wait_for()
    show(page, "Experiments")
    page.get_by_role("heading", name="participant 11").wait_for()
    assert page.evaluate(f"[{STATUS}.trial, {STATUS}.seed, {STATUS}.state]") == ["frontal", 7, "paused"]


@pytest.mark.live
def test_the_address_opens_the_same_run_at_the_same_time_after_a_restart(browser, serve, tmp_path):
    context = browser.new_context(viewport={"width": 1280, "height": 800}, reduced_motion="reduce")
    page = context.new_page()
    page.set_default_timeout(180_000)
    with serve(tmp_path / "files") as server:
        page.goto(f"{server.url}#view=2d&trial=circle-crossing&seed=5&time=1.5&paused=yes")
        page.wait_for_function(f"() => {STATUS}.state === 'paused' && {STATUS}.time > 1.4")
        assert page.evaluate(f"[{STATUS}.trial, {STATUS}.seed, {STATUS}.time]") == ["circle-crossing", 5, 1.5]
        call(page, "simulator.open", name="circle-crossing", settings={"duration": "30"}, seed=6, paused=True)
        call(page, "simulator.step", count=50)
        page.wait_for_function("() => new URLSearchParams(location.hash.slice(1)).get('time') === '2.5'")
        people = call(page, "simulator.inspect", id=0)
        port = int(re.search(r":(\d+)/", server.url)[1])
    page.wait_for_selector(".connection.lost")
    with serve(tmp_path / "files", port=port):
        wait_until(lambda: page.evaluate(f"{GREETING}.then((state) => state.status.time)") == 2.5)
        page.wait_for_function(f"() => {STATUS}.state === 'paused' && {STATUS}.time === 2.5")
        assert page.evaluate(f"[{STATUS}.trial, {STATUS}.seed, {STATUS}.duration]") == ["circle-crossing", 6, 30]
        assert call(page, "simulator.inspect", id=0) == people  # the same instant of the same run
        page.reload()
        page.wait_for_function("() => globalThis.crowdbot?.tab('simulator')?.status.time === 2.5")
        assert page.evaluate(f"{STATUS}.state") == "paused"
    context.close()


@pytest.mark.live
def test_a_hidden_picture_gets_no_states_and_shows_the_present_one_when_it_is_seen_again(browser, app):
    context = browser.new_context(viewport={"width": 1280, "height": 800}, reduced_motion="reduce")
    page, states = context.new_page(), []
    page.set_default_timeout(180_000)
    take = lambda data: states.append(data) if isinstance(data, bytes) else None  # noqa: E731
    page.on("websocket", lambda one: one.on("framereceived", take))
    page.goto(f"{app.url}#view=2d&trial=circle-crossing&seed=5")
    page.wait_for_function(f"() => globalThis.crowdbot?.tab('simulator') && {STATUS}.state === 'running' && {SHOWN}")

    def advance(count):
        call(page, "simulator.pause")
        at = call(page, "simulator.greet")["status"]["time"]
        call(page, "simulator.step", count=count)
        page.wait_for_function(f"() => {STATUS}.time > {at + 0.05 * count - 0.01}")

    def is_silent():
        """Whether no state comes while the run goes on, after those that were on their way."""
        advance(1)
        before = len(states)
        advance(40)
        return len(states) == before

    show(page, "Jobs")
    assert is_silent()
    show(page, "Simulator")
    page.wait_for_function(f"() => {STATUS}.state === 'paused' && {SHOWN} && {SHOWN}.time === {STATUS}.time")
    assert not is_silent()
    page.evaluate("Object.defineProperty(document, 'hidden', { value: true, configurable: true })")
    page.evaluate("document.dispatchEvent(new Event('visibilitychange'))")
    assert is_silent()
    page.evaluate("delete document.hidden")
    page.evaluate("document.dispatchEvent(new Event('visibilitychange'))")
    page.wait_for_function(f"() => {SHOWN} && {SHOWN}.time === {STATUS}.time")
    context.close()


@pytest.mark.live
def test_the_first_window_opens_what_its_address_names_and_no_later_one_does(tmp_path):
    with simulator(tmp_path) as desk:
        desk.visit({"trial": "frontal", "seed": "9", "time": "1.0", "values": '{"duration": "20"}', "paused": "yes"})
        wait_until(lambda: desk._status()["state"] == "paused" and desk._status()["time"] >= 1.0)
        status = desk._status()
        assert (status["trial"], status["seed"], status["time"], status["duration"]) == ("frontal", 9, 1.0, 20.0)
        desk.visit({"trial": "circle-crossing"})
        assert desk.greet()["source"]["name"] == "frontal"


@pytest.mark.live
def test_an_address_that_names_nothing_is_told_and_opens_nothing(tmp_path):
    for address in ({"trial": "../secret.xml"}, {"trial": "fronta"}, {"trial": "frontal", "time": "1e999"}):
        with simulator(tmp_path) as desk:
            desk.visit(address)
            assert ready(desk)["state"] == "failed"
            (problem,) = desk._status()["problems"]
            assert re.search("outside the folder|there is no trial 'fronta'|time='1e999'", problem)


@pytest.mark.live
def test_a_server_that_was_started_with_a_trial_shows_it(tmp_path):
    for address, time in (({"trial": FIRST[0]}, 0.0), ({"trial": "frontal", "time": "0.5", "paused": "yes"}, 0.5)):
        with simulator(tmp_path) as desk:
            desk.first = "frontal"  # as --open does
            desk.visit(address)
            wait_until(lambda: desk._status()["state"] in ("running", "paused") and desk._status()["time"] >= time)  # noqa: B023
            assert desk._status()["trial"] == "frontal"


def test_addresses_are_read():
    assert read_link({"tab": "jobs", "seed": "3"}) is None
    assert read_link({"episode": "a.mcap", "time": "2", "seed": "x"}) == RunAddress("a.mcap", episode=True, time=2.0)
    assert read_link({"trial": "a", "seed": "123456789012345678"}).seed == 123456789012345678


@pytest.mark.parametrize(
    ("name", "text"),
    [("seed", "1.5"), ("seed", ""), ("seed", "9" * 5000), ("time", "-1"), ("time", "nan"), ("time", "1e9"),
     ("time", "١"), ("variant", "-1"), ("values", "["), ("values", "[]"), ("values", '{"a": 1}'),
     ("values", "[" * 100_000)],
)  # fmt: skip
def test_other_addresses_are_refused(name, text):
    with pytest.raises(InputError, match=f"the address of the page has {name}="):
        read_link({"trial": "frontal", name: text})
