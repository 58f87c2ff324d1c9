"""The picture of a scene in a real browser: numbers of the drawn frame, picking, cameras, layers, player."""

import math
import re
import threading
from importlib import resources

import pytest

from crowdbot.cli import main
from crowdbot.recording import read_episode, record
from crowdbot.simulation import Simulation
from crowdbot.trials import load_trial
from crowdbot.web import Desk, Resource, command
from crowdbot.web.scene import episode_events, scene_description, scene_frame, scene_resource

PAGE = b"""<!doctype html><html lang="en"><title>scene</title><link rel="icon" href="data:,">
<style>body { margin: 0 } canvas { display: block; width: 100vw; height: 100vh }</style>
<canvas tabindex="0"></canvas><script type="module" src="player.js"></script></html>"""
DRAW = """async ({flat, theme, again}) => {
  const { Scene2D, Scene3D, decodeFrame } = crowdbotPlayer;
  const read = async (path) => decodeFrame(await (await fetch(path)).arrayBuffer());
  if (!window.scene) {
    window.scene = new (flat ? Scene2D : Scene3D)(document.querySelector("canvas"), (path) => path);
    scene.setTheme(theme);
    await scene.load(await (await fetch("description.json")).json());
  }
  const taken = scene.apply(await read(`frame.bin?layers=${scene.wanted().join(",")}`));
  scene.render();
  return { taken, ...scene.info() };
}"""


class SceneDesk(Desk):
    """Serves a scene of ``frontal`` and the page that draws it."""

    name = "scene"

    def __init__(self, session):
        super().__init__(session)
        self._lock = threading.Lock()
        self.simulation = Simulation(load_trial("frontal"), posed=True)
        for _ in range(20):
            self.simulation.advance()

    @command
    def step(self, count: int) -> float:
        """Advance the simulation."""
        with self._lock:
            for _ in range(count):
                self.simulation.advance()
            return float(self.simulation.world.times[0])

    def resource(self, path, query):
        """Return the page, its script, or a part of the scene."""
        import json

        with self._lock:
            if path == "page.html":
                return Resource(PAGE, "text/html")
            if path == "player.js":
                data = resources.files("crowdbot").joinpath("assets", "web", "player.js").read_bytes()
                return Resource(data, "text/javascript")
            if path == "description.json":
                return Resource(json.dumps(scene_description(self.simulation)).encode(), "application/json")
            if path == "frame.bin":
                return Resource(scene_frame(self.simulation, query.get("layers", "").split(",")).encode())
            return scene_resource(self.simulation, path, query)


@pytest.fixture
def window(browser, serve, tmp_path):
    """A window with the page of the desk; fails on errors and on requests beyond the server."""
    with serve(tmp_path / "files", (SceneDesk,)) as app:
        context = browser.new_context(viewport={"width": 480, "height": 320})
        page, faults = context.new_page(), []
        page.set_default_timeout(180_000)
        page.on("console", lambda one: faults.append(one.text) if one.type == "error" else None)
        page.on("pageerror", lambda one: faults.append(str(one)))
        page.on("request", lambda one: None if one.url.startswith((app.url, "blob:")) else faults.append(one.url))
        page.goto(f"{app.url}api/main/scene/page.html")
        page.wait_for_function("() => Boolean(globalThis.crowdbotPlayer)")
        yield page
        context.close()
        assert faults == []


@pytest.mark.live
@pytest.mark.parametrize("flat", [False, True])
def test_a_scene_is_drawn(window, flat):
    info = window.evaluate(DRAW, {"flat": flat, "theme": "dark"})
    assert info["taken"]
    assert (info["people"], info["robots"], info["time"], info["theme"]) == (1, 1, 1.0, "dark")
    if not flat:
        assert sum(info["levels"]) == 1
        assert info["triangles"] > 1500
        assert 5 < info["calls"] < 60
    names = [item["name"] for item in window.evaluate("scene.layers()")]
    assert {"people", "robots", "walls", "zones", "scans", "forces"} <= set(names)
    assert window.evaluate("scene.wanted()") == ["scans"]
    beside, eyes = ([], []) if flat else (["beside"], ["eyes"])
    cameras = [item["name"] for item in window.evaluate("scene.cameras()")]
    assert cameras == ["free", "overview", *beside, "follow", *eyes, "robot:robot"]


@pytest.mark.live
@pytest.mark.parametrize("flat", [False, True])
def test_people_and_robots_are_picked_where_they_are_drawn(window, flat):
    window.evaluate(DRAW, {"flat": flat, "theme": "light"})
    window.evaluate("scene.setCamera('overview')")
    window.evaluate("scene.render()")
    found = window.evaluate(
        """() => {
          const seen = {};
          for (let y = 0; y < 320; y += 2) for (let x = 0; x < 480; x += 2) {
            const one = scene.pick(x, y);
            if (one) seen[`${one.kind} ${one.id}`] = scene.floor(x, y);
          }
          return seen;
        }"""
    )
    assert sorted(found) == ["person 0", "robot 1"]
    place = window.evaluate("Array.from(scene.state.place('person', 0)).slice(0, 2)")
    assert found["person 0"]["x"] == pytest.approx(place[0], abs=1.5)
    window.evaluate("scene.highlight('person', 0)")
    window.evaluate("scene.setCamera('follow')")
    window.evaluate("scene.render()")
    assert window.evaluate("scene.info().camera") == "follow"
    assert window.evaluate("scene.pick(240, 160)") == {"kind": "person", "id": 0}


@pytest.mark.live
def test_layers_and_cameras_change_the_picture(window):
    before = window.evaluate(DRAW, {"flat": False, "theme": "light"})
    window.evaluate("scene.setLayer('people', false)")
    after = window.evaluate(DRAW, {"flat": False, "theme": "light"})
    assert after["triangles"] < before["triangles"] - 1000
    window.evaluate("scene.setLayer('people', true)")
    window.evaluate("scene.setCamera('robot:robot')")
    inside = window.evaluate(DRAW, {"flat": False, "theme": "light"})
    robot = window.evaluate("Array.from(scene.state.place('robot', 1)).slice(0, 2)")
    assert inside["eye"][:2] == pytest.approx(robot, abs=1e-6)
    with pytest.raises(Exception, match="the scene has no layer smell"):
        window.evaluate("scene.setLayer('smell', true)")


@pytest.mark.live
def test_the_first_person_looks_around_and_is_not_seen(window):
    before = window.evaluate(DRAW, {"flat": False, "theme": "light"})
    window.evaluate("scene.setCamera('eyes', { kind: 'person', id: 0 })")
    info = window.evaluate(DRAW, {"flat": False, "theme": "light"})
    place = window.evaluate("Array.from(scene.state.place('person', 0))")
    height = window.evaluate("scene.state.height('person', 0)")
    assert info["eye"] == pytest.approx([*place[:2], 0.93 * height], abs=1e-4)
    assert sum(before["levels"]) == sum(info["levels"]) + 1
    ahead = "(({ camera }) => camera.getWorldDirection(camera.up.clone()).toArray())(scene._views)"
    straight = window.evaluate(ahead)
    assert math.atan2(straight[1], straight[0]) == pytest.approx(place[2], abs=1e-3)
    window.locator("canvas").focus()
    window.keyboard.press("Shift+ArrowLeft")
    window.evaluate("scene.render()")
    turned = window.evaluate(ahead)
    assert math.remainder(math.atan2(turned[1], turned[0]) - place[2] - 0.12, math.tau) == pytest.approx(0, abs=1e-3)
    window.mouse.move(200, 150)
    window.mouse.down()
    window.mouse.move(200, 110)
    window.mouse.up()
    window.evaluate("scene.render()")
    assert window.evaluate(ahead)[2] > turned[2] + 0.15


@pytest.mark.live
@pytest.mark.parametrize("layer", ["paths", "density", "ttc"])
@pytest.mark.parametrize("flat", [False, True])
def test_layers_of_the_crowd_are_drawn(window, layer, flat):
    before = window.evaluate(DRAW, {"flat": flat, "theme": "light"})
    window.evaluate(f"scene.setLayer('{layer}', true)")
    taken = window.evaluate(DRAW, {"flat": flat, "theme": "light"})
    assert taken["taken"]
    assert window.evaluate(f"Object.keys(scene.state.frame.arrays).includes('{layer}')")
    if not flat and layer == "density":
        assert taken["triangles"] >= before["triangles"] + 2


@pytest.mark.live
def test_a_frame_of_another_description_is_not_drawn(window):
    window.evaluate(DRAW, {"flat": False, "theme": "light"})
    window.evaluate("scene.state.description.revision += 1")
    assert not window.evaluate(DRAW, {"flat": False, "theme": "light"})["taken"]


def test_the_player_plays_an_episode_without_a_server(browser, tmp_path, capsys):
    summary = record(load_trial("frontal", duration=2.0, **{"robot/drive/max-speed": 0.03}), out=tmp_path)
    page_file = tmp_path / "player.html"
    assert main(["export", str(summary.path), "--to", str(page_file)]) == 0
    assert re.search(r"player\.html: 21 frames, 2 s, \d\.\d MB", capsys.readouterr().out)
    context = browser.new_context(viewport={"width": 640, "height": 480}, offline=True)
    page, faults = context.new_page(), []
    page.on("console", lambda one: faults.append(one.text) if one.type == "error" else None)
    page.on("pageerror", lambda one: faults.append(str(one)))
    page.goto(page_file.as_uri())
    page.wait_for_function("() => globalThis.crowdbotPlayer?.player?.scene?.info().frames > 0")
    recorded = read_episode(summary.path)
    for instant in (0, 7, 20):
        page.evaluate(f"crowdbotPlayer.player.seek({recorded.times[instant]})")
        place = page.evaluate("Array.from(crowdbotPlayer.player.scene.state.place('person', 0)).slice(0, 2)")
        assert place == pytest.approx(recorded.position[instant, 0].tolist(), abs=1e-5)
    page.keyboard.press("Home")
    page.wait_for_function("() => crowdbotPlayer.player.time === 0")
    page.keyboard.press("ArrowRight")
    page.wait_for_function("() => Math.abs(crowdbotPlayer.player.time - 1) < 1e-9")
    page.get_by_role("button", name="Play", exact=True).click()
    page.wait_for_function("() => crowdbotPlayer.player.time > 1.2")
    page.evaluate("crowdbotPlayer.player.play(false)")
    events = episode_events(recorded)
    assert [event.kind for event in events] == ["stall"]  # the robot is slower than 0.05 m/s
    page.get_by_label("Event", exact=True).select_option(str(events[0].time).removesuffix(".0"))
    page.wait_for_function(f"() => Math.abs(crowdbotPlayer.player.time - {events[0].time}) < 1e-9")
    page.get_by_role("button", name="From above").click()
    page.wait_for_function("() => crowdbotPlayer.player.flat && crowdbotPlayer.player.scene.info().frames > 0")
    assert page.get_by_role("status").text_content() == "1 person, 1 robot"
    context.close()
    assert faults == []
    assert main(["export", str(summary.path), "--to", str(page_file)]) == 2
    assert "already exists" in capsys.readouterr().err


def test_wrong_options_of_a_page_are_refused(tmp_path, capsys):
    summary = record(load_trial("frontal", duration=0.5), out=tmp_path)
    episode = str(summary.path)
    assert main(["export", episode, "--to", str(tmp_path / "a.csv"), "--period", "0.1"]) == 2
    assert "--period, --images, --folder and --trust are for a page or labels" in capsys.readouterr().err
    assert main(["export", episode, "--to", str(tmp_path / "a.html"), "--table", "scans"]) == 2
    assert "--table is for a table" in capsys.readouterr().err
