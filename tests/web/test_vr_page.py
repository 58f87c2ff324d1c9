"""A person with an emulated headset in a real browser: enters, walks, reaches, and what happens when things fail."""

import json

import numpy as np
import pytest
from vr_headset import STATE, call, desks, emulated_headsets, enter, wait

from crowdbot.recording import read_episode, replay
from crowdbot.vr import VrServer, read_headset_recording
from crowdbot.world import worlds_of

TRIAL = """<trial name="meet" duration="600" world="planar"><stage><wall points="-6,-4 6,-4 6,4 -6,4 -6,-4"/></stage>
<crowd type="orca"/><avatar name="guest" source="external" x="1" y="0.5" heading="0.5" body="man-20"/>
<agent x="4" y="1.2" goal="-5,1.2"/><robot name="robot" type="turtlebot2" x="3.5" y="0"><goal x="-5" y="-1"/>
<navigator type="straight" speed="0.05"/></robot><end goal="false" collision="false"/></trial>"""


@pytest.fixture
def app(tmp_path, serve):
    """The app with virtual reality; its first trial is a meeting in a room."""
    folder = tmp_path / "files"
    folder.mkdir()
    (folder / "meet.xml").write_text(TRIAL)
    with serve(folder, desks("meet.xml"), VrServer) as server:
        yield server


@pytest.fixture
def headset(browser, app, modules):
    """A function that opens the page of participants with an emulated headset."""
    with emulated_headsets(browser, app, modules) as opened:
        yield opened


def body(app):
    """Return simulation, row of the avatar and its bodies, between two steps."""
    run = app.sessions["main"].desk("simulator").run
    return run


def test_a_person_enters_walks_reaches_and_meets_limits(headset, app):
    page = headset()
    enter(page, app)
    wait(page, f"{STATE}?.steps > 2")
    run = body(app)

    def places():
        return run.simulation.world.environment_scene(0).position[0].copy()

    page.evaluate("device.position.set(0, 1.6, -1)")  # one metre ahead, in the direction of the avatar
    page.evaluate("device.controllers.right.position.set(0.2, 1.3, -1.5)")
    wait(page, f"Math.hypot({STATE}.place[0] - 1 - Math.cos(0.5), {STATE}.place[1] - 0.5 - Math.sin(0.5)) < 0.01")
    wait(page, f"{STATE}.hands.length === 2 && {STATE}.picture_median > 0")
    time_now = page.evaluate("crowdbotVr.status.time")
    wait(page, f"crowdbotVr.status.time > {time_now} + 0.5")
    place = places()[1]
    assert np.hypot(*(place - [1 + np.cos(0.5), 0.5 + np.sin(0.5)])) < 0.2  # the pelvis is below the neck
    state = page.evaluate(STATE)
    assert state["hands"] == ["left", "right"]
    assert 0 < state["picture_median"] < 2000
    assert abs(state["offset"]) > 0
    people = worlds_of(run.simulation.world)[0].people
    wrist = run.do(people.posture).position[1, 16]
    grip = np.array([1.0, 0.5, 0.0]) + [
        1.5 * np.cos(0.5) + 0.2 * np.sin(0.5),
        1.5 * np.sin(0.5) - 0.2 * np.cos(0.5),
        1.3,
    ]
    assert (
        np.linalg.norm(wrist - grip) < 0.16
    )  # the wrist is 8 cm from the palm, and that is not quite in the controller

    page.evaluate("device.primaryInputMode = 'hand'")
    page.evaluate("device.hands.left.position.set(-0.2, 1.4, -1.4)")
    wait(page, f"{STATE}.hands.includes('left')")
    info = page.evaluate("crowdbotVr.scene.info()")
    assert info["calls"] < 60
    assert page.evaluate("crowdbotVr._own()") == 1

    call(app, "vr.set", settings={"motion_delay": 0.15})
    saved = call(app, "vr.save", name="visit")
    assert saved == ["visit.mcap", "visit-guest.headset"]
    episode = app.folder / "visit.mcap"
    assert replay(episode).equal
    orders = [order for _, order in read_episode(episode).orders]
    assert len(orders) > 10
    records = list(read_headset_recording(app.folder / "visit-guest.headset"))
    steps = [one.note for one in records if one.note and "step" in one.note]
    assert len(steps) >= len(orders)
    assert steps[0]["pose"][:2] == pytest.approx([orders[0].x, orders[0].y])
    assert sum(one.sample is not None for one in records) > 20

    call(app, "vr.limit_room", room="person", corners=[[-3, -3], [3, -3], [3, 3], [-3, 3]])
    wait(page, "crowdbotVr.state.rooms.person.limits.length === 4 && crowdbotVr.room.warning === 0")
    page.evaluate("device.position.set(0, 1.6, -2.5)")
    wait(page, "crowdbotVr.room.warning > 0.5 && crowdbotVr.room.margin > 0")
    wait(page, f"{STATE}.margin > 0 && {STATE}.margin < 0.6")
    assert call(app, "vr.stop_robots") == ["robot"]
    wait(page, "crowdbotVr.state.warnings.includes('robots are stopped')")
    before = places()[2]
    at = run.status()["time"]
    wait(page, f"crowdbotVr.status.time > {at} + 0.6")
    after = places()[2]
    assert np.hypot(*(after - before)) < 0.02
    call(app, "vr.release_robots")
    call(app, "vr.pause")
    wait(page, "crowdbotVr.status.state === 'paused' && crowdbotVr.room.said.startsWith('Paused')")


def test_failures_and_the_page_of_the_operator(headset, app, browser, axe):
    first = headset()
    enter(first, app)
    second = headset()
    second.get_by_role("button", name="Enter VR").click()
    wait(second, "crowdbotVr.link?.refusal.includes('has a participant already: guest')")
    wait(second, "crowdbotVr.room.said.includes('participant already')")
    second.context.close()

    call(app, "vr.set", settings={"timeout": 0.6, "pause_when_lost": True})
    first.evaluate("crowdbotVr.link.send = () => false")  # a headset that sleeps: nothing is sent
    wait(first, "crowdbotVr.status.state === 'paused'")
    wait(first, "crowdbotVr.state.warnings.some((one) => one.includes('tracking of guest is lost'))")
    wait(first, "crowdbotVr.link.silent && crowdbotVr.room.said.includes('connection is lost')")
    call(app, "vr.set", settings={"timeout": 8.0, "pause_when_lost": False})
    first.evaluate("delete crowdbotVr.link.send")
    wait(first, "crowdbotVr.link.avatar === 'guest' && !crowdbotVr.link.silent")
    call(app, "vr.resume")
    wait(first, "crowdbotVr.status.state === 'running' && crowdbotVr.room.said === ''")

    first.evaluate("crowdbotVr.link._socket.close()")  # the net is cut and comes back
    wait(first, "crowdbotVr.link.avatar === null")
    wait(first, "crowdbotVr.link.avatar === 'guest'", 20)
    names = json.loads(json.dumps(first.evaluate("crowdbotVr.state.participants.map((one) => one.avatar)")))
    assert names == ["guest"]

    context = browser.new_context(viewport={"width": 1280, "height": 800}, reduced_motion="reduce")
    desk = context.new_page()
    desk.set_default_timeout(180_000)
    desk.goto(app.url + "#tab=vr")
    desk.get_by_role("rowheader", name="guest").wait_for()
    desk.get_by_role("cell", name="ms (p95").first.wait_for()
    assert desk.get_by_role("link", name="Enter VR").get_attribute("href").startswith("vr")
    desk.get_by_label("Added delay of motion [ms]").fill("100")
    desk.get_by_label("Added delay of motion [ms]").blur()
    wait(first, "crowdbotVr.state.settings.motion_delay === 0.1")
    room = desk.get_by_role("region", name="Room of the robot")
    for k, (x, y) in enumerate(((0, 0), (2, 0), (2, 3))):
        for axis, value in zip("xyz", (x, y, 1), strict=True):
            room.get_by_label(f"{axis} in the room [m]").fill(str(value))
            room.get_by_label(f"{axis} in the virtual room [m]").fill(str(value + (5 if axis == "x" else 0)))
        room.get_by_role("button", name="Add point").click()
        wait(first, f"crowdbotVr.state.rooms.robot.source.length === {k + 1}")
    room.get_by_role("button", name="Calibrate").click()
    room.get_by_text("Residual 0.000 m").wait_for()
    wait(first, "Math.abs(crowdbotVr.state.rooms.robot.x - 5) < 1e-6")
    assert axe(desk) == []
    context.close()
