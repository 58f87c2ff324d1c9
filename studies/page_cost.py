"""Measure the JavaScript of a picture of the app: python studies/page_cost.py [--people 200] [--beams 1080].

States of a walking crowd with a robot and its scan are decoded, blended, applied and drawn in headless Chromium, one
state for each picture. WebGL calls that draw or upload do nothing, so what is left is the work of the page itself.
Times are processor time of the main thread of the page, so other programs do not count. The CPU profile divides
them.
"""

from __future__ import annotations

import argparse
import base64
import dataclasses
import shutil
from collections import Counter
from importlib import resources
from typing import Any

from playwright.sync_api import CDPSession, Page, sync_playwright

from crowdbot.sensors import Lidar2D
from crowdbot.simulation import Simulation
from crowdbot.trials import Mount, load_trial
from crowdbot.web.scene import WalkingBodies, scene_description, scene_frame, scene_resource

FLAGS = ["--no-sandbox", "--disable-gpu", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
STUB = """() => {
  const calls = /^(draw[AER]|clear$|bufferSubData|texSubImage|texImage)/;
  const context = WebGL2RenderingContext.prototype;
  for (const [name, { value }] of Object.entries(Object.getOwnPropertyDescriptors(context))) {
    if (calls.test(name) && typeof value === "function") context[name] = () => {};
  }
}"""
LOAD = """async ({ files, description, frames }) => {
  const { Scene2D, Scene3D } = crowdbotPlayer;
  const bytes = (text) => Uint8Array.from(atob(text), (one) => one.charCodeAt(0));
  const url = (path) => URL.createObjectURL(new Blob([bytes(files[path])]));
  window.frames60 = frames.map((one) => bytes(one).buffer);
  for (const [name, Kind] of [["space", Scene3D], ["plan", Scene2D]]) {
    const canvas = document.createElement("canvas");
    canvas.style.cssText = "width:1000px;height:640px;display:block";
    document.body.append(canvas);
    window[name] = new Kind(canvas, url);
    await window[name].load(description);
  }
}"""
DRAW = """async ({ name, pictures }) => {
  const { decodeFrame, blendFrames, BlendBuffer } = crowdbotPlayer;
  const scene = window[name], buffer = new BlendBuffer();
  let before = null;
  for (let k = 0; k < pictures; k++) {
    const frame = decodeFrame(frames60[k % frames60.length].slice(0));
    scene.apply(before ? blendFrames(before, frame, 0.5, buffer) : frame);
    scene.render();
    before = k % frames60.length === frames60.length - 1 ? null : frame;
    if (k % 8 === 7) await new Promise((resolve) => setTimeout(resolve, 0));
  }
  return scene.info();
}"""


def states(people: int, beams: int, count: int) -> dict[str, Any]:
    """Return meshes, description and frames of a crowd that walks against a robot with a scanner."""
    trial = load_trial(f"challenge-against-{people}")
    scanner = dataclasses.replace(trial.robots[0], sensors=(Mount(sensor=Lidar2D(rays=beams, range_max=25.0)),))
    simulation = Simulation(dataclasses.replace(trial, robots=(scanner,)), 0)
    simulation.begin()
    bodies, frames = WalkingBodies(simulation), []
    for _ in range(count):
        simulation.advance()
        bodies.follow(simulation)
        frames.append(scene_frame(simulation, ["scans"], bodies.motion).encode())
    description = scene_description(simulation, bodies.motion)
    names = [f"bodies/{level}.bin" for level in range(3)] + [item["mesh"] for item in description["robots"]]
    files = {name: scene_resource(simulation, name, {}).data for name in names}
    return {
        "description": description,
        "files": {name: base64.b64encode(data).decode() for name, data in files.items()},
        "frames": [base64.b64encode(data).decode() for data in frames],
    }


def thread_time(session: CDPSession) -> float:
    """Return the processor time [s] of the main thread of the page."""
    rows = session.send("Performance.getMetrics")["metrics"]
    return float({row["name"]: row["value"] for row in rows}["TaskDuration"])


def parts(profile: dict[str, Any]) -> dict[str, float]:
    """Return the share of the samples of a CPU profile below each method that is called for a picture."""
    nodes = {node["id"]: node for node in profile["nodes"]}
    own = Counter(profile["samples"])
    found = Counter[str]()

    def add(number: int, part: str) -> None:
        name = nodes[number]["callFrame"]["functionName"]
        if name in ("(idle)", "(program)"):
            return
        part = part or (name if name in ("apply", "render", "(garbage collector)") else "")
        found[part or "decode and blend"] += own[number]
        for child in nodes[number].get("children", ()):
            add(child, part)

    add(profile["nodes"][0]["id"], "")
    return {name: count / sum(found.values()) for name, count in found.most_common()}


def measure(page: Page, people: int, beams: int, pictures: int) -> dict[str, float]:
    """Print and return the cost [ms] of a picture in space and from above."""
    costs = {}
    page.set_content("<!doctype html><title>cost</title><body></body>")
    script = resources.files("crowdbot").joinpath("assets", "web", "player.js").read_text("utf-8")
    page.add_script_tag(content=script, type="module")
    page.wait_for_function("() => Boolean(globalThis.crowdbotPlayer)")
    page.evaluate(LOAD, states(people, beams, 40))
    session = page.context.new_cdp_session(page)
    session.send("Performance.enable", {"timeDomain": "threadTicks"})
    session.send("Profiler.enable")
    session.send("Profiler.setSamplingInterval", {"interval": 200})
    for name, title in (("space", "in space"), ("plan", "from above")):
        page.evaluate(DRAW, {"name": name, "pictures": 2})  # compile shaders with real calls
        if name == "space":
            page.evaluate(STUB)
        page.evaluate(DRAW, {"name": name, "pictures": 60})  # let the browser compile the functions
        begin = thread_time(session)
        info = page.evaluate(DRAW, {"name": name, "pictures": pictures})
        cost = 1000.0 * (thread_time(session) - begin) / pictures
        what = f"{info['people']} people, {info['robots']} robot, {beams} beams"
        costs[title] = cost
        print(f"{title}: {cost:.1f} ms of JavaScript a picture, {what}")
        session.send("Profiler.start")
        page.evaluate(DRAW, {"name": name, "pictures": pictures})
        found = parts(session.send("Profiler.stop")["profile"])
        print("  " + ", ".join(f"{one} {100 * share:.0f} %" for one, share in found.items()))
    return costs


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--people", type=int, default=200, help="people of the challenge (default: 200)")
    parser.add_argument("--beams", type=int, default=1080, help="beams of the scanner (default: 1080)")
    parser.add_argument("--pictures", type=int, default=120, help="pictures of a measurement (default: 120)")
    given = parser.parse_args()
    with sync_playwright() as playwright:
        path = shutil.which("chromium") or shutil.which("chromium-browser")
        browser = playwright.chromium.launch(executable_path=path, args=FLAGS)
        page = browser.new_page(viewport={"width": 1100, "height": 1400})
        page.set_default_timeout(300_000)
        page.on("pageerror", lambda error: print(f"error: {error}"))
        measure(page, given.people, given.beams, given.pictures)
        browser.close()


if __name__ == "__main__":
    main()
