"""Measure how fast the app is, from the real program: python studies/app_times.py [--json FILE] [ROW ...].

Each row starts ``crowdbot app`` as a process of its own, with an empty folder. A page in headless Chromium looks at it,
without a graphics card; the row ``server`` reads the states over the WebSocket, because a browser without a graphics
card takes fewer than 60 a second.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import dataclasses
import json
import os
import random
import re
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import aiohttp
from playwright.sync_api import Browser, Page, sync_playwright

from crowdbot.recording import record
from crowdbot.simulation import RunSummary
from crowdbot.trials import load_trial
from crowdbot.web import StateFrame
from crowdbot.web.simulator.kernel_preparation import PROGRAMS
from page_cost import measure

FLAGS = ["--no-sandbox", "--disable-gpu", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
PATIENCE = 300_000
"""Longest wait of the page [ms]."""
WALLS = """<trial name="walls" duration="60"><stage><wall points="2,-3 2,{:.1f}"/></stage><crowd type="orca"/>
<spawner count="20" zone="-6,-3 0,-3 0,3 -6,3" goal="5,-2 6,-2 6,2 5,2"/></trial>"""
CORRIDOR = """<trial name="corridor" duration="600" step="{step}">
<stage walkable="-{half},-8 {half},-8 {half},8 -{half},8"/>
<crowd type="orca"/><contact/><journey name="east"><direction heading="0"/></journey>
<journey name="west"><direction heading="3.14159"/></journey>
<spawner count="{count}" zone="-{zone},-7.5 {zone},-7.5 {zone},7.5 -{zone},7.5" journey="east"/>
<spawner count="{count}" zone="-{zone},-7.5 {zone},-7.5 {zone},7.5 -{zone},7.5" journey="west"/>
<portal zone="{zone},-8 {half},-8 {half},8 {zone},8" dx="-{way}"/>
<portal zone="-{half},-8 -{zone},-8 -{zone},8 -{half},8" dx="{way}"/>
<robot x="-10" y="0"><goal x="10" y="0"/><drive type="differential-drive"/><navigator type="orca"/>
<sensor type="lidar2d" rays="1080" range-max="25"/></robot><end collision="false" goal="false"/></trial>"""
"""People who walk both ways and come in again at the other end."""
HALL = """<trial name="hall" duration="600" step="0.1"><stage walkable="-8,-4 8,-4 8,4 -8,4"/>
<crowd type="orca"/><contact/>
<journey name="rounds" then="again"><zone points="-7,-3 -5,-3 -5,3 -7,3" aim="random"/>
<zone points="5,-3 7,-3 7,3 5,3" aim="random"/></journey>
<spawner count="10" zone="-6,-3 6,-3 6,3 -6,3" journey="rounds"/>
<robot x="-6" y="0"><goal x="6" y="0"/><drive type="differential-drive"/><navigator type="orca"/>
<sensor name="colour" type="rgb-camera" z="1.2" width="160" height="120" rate="2"/>
<sensor name="depth" type="depth-camera" z="1.2" width="160" height="120" rate="2"/>
</robot><end collision="false" goal="false"/></trial>"""
"""The same people walk to and fro, seen by the cameras of a robot."""
IMAGES = ("robot/colour/color", "robot/depth/depth")
"""Names of the images of the cameras in the page."""
STATES = 60.0
"""States a second that a window may get."""
SECONDS = 20.0
"""Length of a measurement of processor time [s]."""
EDITED = """async (texts) => {
  const { model } = crowdbot.tab("editor").tab;
  const times = [];
  for (const text of texts) {
    const before = JSON.stringify(model.people.ways), begin = performance.now();
    await model.edit("write", { text });
    while (JSON.stringify(model.people.ways) === before) await new Promise((resolve) => setTimeout(resolve, 1));
    times.push((performance.now() - begin) / 1000);
  }
  return times;
}"""
SOUGHT = """async (seconds) => {
  const view = crowdbot.tab("simulator"), { connection } = crowdbot, times = [];
  for (const time of seconds) {
    const begin = performance.now();
    await connection.call("simulator.seek", { time });
    while (Math.abs((view.picture.newest?.time ?? -1) - time) > 0.06)
      await new Promise((resolve) => setTimeout(resolve, 1));
    times.push((performance.now() - begin) / 1000);
  }
  return times;
}"""
OPENED = """async (name) => {
  const view = crowdbot.tab("simulator"), { connection } = crowdbot, begin = performance.now();
  await connection.call("simulator.open_episode", { name });
  while (!(view.status.name === name && view.status.state === "paused" && view.picture.newest))
    await new Promise((resolve) => setTimeout(resolve, 1));
  return (performance.now() - begin) / 1000;
}"""
IMAGES_SOUGHT = """async ([seconds, names]) => {
  const view = crowdbot.tab("simulator"), { connection } = crowdbot, times = [];
  const drawn = () => names.map((name) => view.display.images.figures.figure(name)?.drawn ?? 0);
  for (const time of seconds) {
    const before = drawn(), begin = performance.now();
    await connection.call("simulator.seek", { time });
    while (Math.abs((view.picture.newest?.time ?? -1) - time) > 0.06 || drawn().some((count, k) => count === before[k]))
      await new Promise((resolve) => setTimeout(resolve, 1));
    times.push((performance.now() - begin) / 1000);
  }
  return times;
}"""
DRAWN = """() => {
  const info = globalThis.crowdbot?.tab("simulator")?.picture.scene.info();
  const drawn = Boolean(info && info.people > 20 && info.frames > 0 && info.calls > 0);
  return drawn && [performance.now() / 1000, info.time];
}"""

LIVE = """() => {
  const { status, picture } = crowdbot.tab("simulator");
  return status.state === "running" && !status.recorded && picture.newest?.time > 0;
}"""


@dataclasses.dataclass(frozen=True)
class Time:
    """A measured value with its limit."""

    what: str
    value: float
    unit: str
    limit: float | None
    how: str

    def cells(self) -> list[str]:
        """Return the cells of a row of the table."""
        limit = "-" if self.limit is None else f"{self.limit:g} {self.unit}"
        return [self.what, f"{self.value:.3g} {self.unit}", limit, self.how]


@contextlib.contextmanager
def program(folder: Path, *words: str, cache: Path | None = None) -> Iterator[tuple[str, int, float]]:
    """Run ``crowdbot app`` and give its address, its process and the time of its start."""
    environment = dict(os.environ) | ({} if cache is None else {"CROWDBOT_CACHE": str(cache)})
    command = [sys.executable, "-m", "crowdbot", "app", "--port", "0", "--no-browser", "--folder", str(folder), *words]
    begin = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment)
    try:
        assert process.stdout is not None
        match = re.search(r"http://\S+", process.stdout.readline())
        if match is None:
            raise RuntimeError(f"{' '.join(command)}: no address")
        yield match[0], process.pid, begin
    finally:
        process.terminate()
        process.wait(60)


@contextlib.contextmanager
def window(browser: Browser, address: str) -> Iterator[Page]:
    """Open a page."""
    page = browser.new_page(viewport={"width": 1280, "height": 800}, reduced_motion="reduce")
    page.set_default_timeout(PATIENCE)
    page.goto(address)
    try:
        yield page
    finally:
        page.close()


def first_picture(browser: Browser, folder: Path) -> list[Time]:
    """From the request of the page to the first picture in space with people, while the trial runs."""
    times = []
    with program(folder) as (address, _, _):
        with window(browser, address) as page:
            page.wait_for_function("() => crowdbot.tab('simulator').status.state === 'running'")
        for _ in range(5):
            with window(browser, address) as page:
                times.append(page.wait_for_function(DRAWN).json_value()[0])
    how = f"median of {len(times)} openings, longest {max(times):.2f} s"
    return [Time("first picture on loopback", statistics.median(times), "s", 2.0, how)]


def cold_start(browser: Browser, folder: Path, beside: str = "") -> list[Time]:
    """From the start of the program with an empty cache of kernels to people who walk, and to the live run."""
    browser.new_page().close()
    with program(folder, cache=folder / "cache") as (address, process, begin), window(browser, address) as page:
        first = page.wait_for_function(DRAWN).json_value()[1]
        now = page.wait_for_function(
            f"() => crowdbot.tab('simulator').picture.scene.info().time > {first} + 0.2 && performance.now() / 1000"
        ).json_value()
        walking, used = time.monotonic() - begin, processor_time(process)
        page.wait_for_function(LIVE, timeout=4 * PATIENCE)
        live = time.monotonic() - begin
    how = f"at a load average of {os.getloadavg()[0]:.0f} on {os.cpu_count()} cores"
    return [
        Time(
            f"people walk, from an empty kernel cache{beside}",
            walking,
            "s",
            10.0,
            f"from the start of the program, {how}",
        ),
        Time(f"the same, from the request of the page{beside}", now, "s", 3.0, "without that of the program"),
        Time(f"the same, processor time of the server{beside}", used, "s", None, "until people walk"),
        Time(f"the run is live, from an empty kernel cache{beside}", live, "s", 20.0, "from the start of the program"),
    ]


def busy_cold_start(browser: Browser, folder: Path) -> list[Time]:
    """Measure the cold start beside a core that is busy with something else."""
    with subprocess.Popen([sys.executable, "-c", "while True: pass"]) as other:
        try:
            return cold_start(browser, folder, ", beside a busy core")
        finally:
            other.kill()


def compilation(browser: Browser, folder: Path) -> list[Time]:
    """Return the processor time until the first trial is compiled, by the processes of the server that do it."""
    folder.mkdir(parents=True)
    environment = dict(os.environ) | {"CROWDBOT_CACHE": str(folder)}
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with contextlib.ExitStack() as stack:
        commands = [[sys.executable, "-c", program] for program in PROGRAMS]
        processes = [subprocess.Popen(command, stdin=subprocess.PIPE, env=environment) for command in commands]
        if any(stack.enter_context(process).wait() for process in processes):
            raise RuntimeError("the kernels of the first trial were not compiled")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    how = "meanwhile the page plays a recording of the same run"
    return [Time("kernels of the first trial, processor time", used, "s", None, how)]


def edited_wall(browser: Browser, folder: Path) -> list[Time]:
    """From an edit of a wall in the editor to the new ways of 20 people."""
    with program(folder) as (address, _, _), window(browser, f"{address}#tab=editor") as page:
        page.wait_for_function("() => crowdbot.tab('editor').tab.model.state !== null")
        page.get_by_label("XML of the trial").fill(WALLS.format(3))
        page.get_by_role("button", name="Places").click()
        page.wait_for_function("() => crowdbot.tab('editor').tab.model.people?.ways.length === 20")
        times = page.evaluate(EDITED, [WALLS.format(3 + 0.1 * k) for k in range(1, 21)])
    how = f"median of {len(times)} edits, longest {max(times):.3f} s"
    return [Time("ways after the edit of a wall", statistics.median(times), "s", 0.2, how)]


def record_episodes(folder: Path, text: str) -> tuple[RunSummary, list[float]]:
    """Record a trial for one second to ``short.mcap`` and whole to ``long.mcap``; return it and 50 instants [s]."""
    folder.mkdir(parents=True)
    (folder / "trial.xml").write_text(text, encoding="utf-8")
    record(load_trial(folder / "trial.xml", duration="1"), 1, folder / "short.mcap")
    done = record(load_trial(folder / "trial.xml"), 1, folder / "long.mcap")
    chance = random.Random(1)  # noqa: S311 - instants of a measurement
    return done, [round(chance.uniform(0.0, done.end) / 0.1) * 0.1 for _ in range(50)]


@contextlib.contextmanager
def short_episode(browser: Browser, folder: Path) -> Iterator[tuple[Page, int]]:
    """Show the short episode first, so that no kernel is compiled for the long one; yields page and process."""
    with (
        program(folder, "--open", str(folder / "short.mcap")) as (address, process, _),
        window(browser, address) as page,
    ):
        page.get_by_label("View", exact=True).select_option("2d")
        page.wait_for_function("() => crowdbot.tab('simulator').picture.newest !== null")
        yield page, process


def machine_load() -> str:
    """Return the load of the machine, for a remark."""
    return f"at a load average of {os.getloadavg()[0]:.0f} on {os.cpu_count()} cores"


def seek(browser: Browser, folder: Path) -> list[Time]:
    """Open a 10-minute episode of people who get a new id at each portal, and jump in it."""
    done, wishes = record_episodes(folder, corridor(40, "0.05"))
    with short_episode(browser, folder) as (page, process):
        before = peak_memory(process)
        opened = page.evaluate(OPENED, "long.mcap")
        times = page.evaluate(SOUGHT, wishes)
        peak = peak_memory(process)
    what = "10-minute episode with portals"
    how = f"longest of {len(times)} random instants of {done.end:g} s, median {statistics.median(times):.3f} s"
    people = f"40 people, each with a new id at each portal, {done.agents} ids"
    return [
        Time(f"opening of a {what}", opened, "s", 5.0, f"to its first picture, {machine_load()}; {people}"),
        Time("the same, largest memory of the server", peak, "MB", 500.0, f"with the jumps; {before:.0f} MB before"),
        Time(f"seek in a {what}", max(times), "s", 0.3, how),
    ]


def camera_episode(browser: Browser, folder: Path) -> list[Time]:
    """Open a 10-minute episode with two cameras, and jump in it while both images are shown."""
    done, wishes = record_episodes(folder, HALL)
    size = (folder / "long.mcap").stat().st_size / 1e6
    with short_episode(browser, folder) as (page, process):
        before, used = peak_memory(process), processor_time(process)
        opened = page.evaluate(OPENED, "long.mcap")
        used = processor_time(process) - used
        page.evaluate("(names) => crowdbot.connection.call('simulator.cameras', { names })", list(IMAGES))
        page.wait_for_function("() => document.querySelectorAll('.camera-image').length === 2")
        times = page.evaluate(IMAGES_SOUGHT, [wishes, list(IMAGES)])
        peak = peak_memory(process)
    what = "10-minute episode with two cameras"
    how = f"{size:.0f} MB, 2 x 1200 images of 160 x 120 pixels, {done.end:g} s, 10 people"
    sought = f"longest of {len(times)} random instants, median {statistics.median(times):.3f} s"
    return [
        Time(f"opening of a {what}", opened, "s", 5.0, f"to its first picture, {machine_load()}; {how}"),
        Time("the same, processor time of the server", used, "s", None, "until then"),
        Time("the same, largest memory of the server", peak, "MB", 500.0, f"with the jumps; {before:.0f} MB before"),
        Time(f"seek in a {what}", max(times), "s", 0.3, f"to the picture and both images; {sought}"),
    ]


def page_work(browser: Browser, folder: Path) -> list[Time]:
    """Return the JavaScript of a picture of 200 people, a robot and 1080 beams."""
    page = browser.new_page(viewport={"width": 1100, "height": 1400})
    page.set_default_timeout(PATIENCE)
    found = measure(page, 200, 1080, 120)
    page.close()
    how = "200 people, a robot, 1080 beams; processor time without the calls that draw"
    return [Time(f"JavaScript a picture, {name}", value, "ms", 15.0, how) for name, value in found.items()]


def corridor(people: int, step: str) -> str:
    """Return a trial with a number of people in a corridor that is as long as they need."""
    half = 6 + people // 8
    return CORRIDOR.format(count=people // 2, half=half, zone=half - 3, way=2 * half - 6, step=step)


def processor_time(process: int) -> float:
    """Return the processor time [s] that a process has used."""
    fields = Path(f"/proc/{process}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


async def read_states(address: str, process: int) -> tuple[float, float, float]:
    """Read the states as a fast page does; return states/s, and the shares of a core with and without a window."""
    url = f"{address.rstrip('/')}/api/main/socket"
    async with aiohttp.ClientSession() as session, session.ws_connect(url, max_msg_size=0) as socket:
        await socket.send_json({"id": 1, "call": "simulator.layers", "args": {"names": ["scans"]}})
        count, begin, before = 0, 0.0, 0.0
        async for message in socket:
            if message.type != aiohttp.WSMsgType.BINARY:
                continue
            await socket.send_json({"drawn": StateFrame.decode(message.data).sequence})
            count += 1
            if count == 120:  # the kernels of the frames are compiled
                begin, before = time.monotonic(), processor_time(process)
            if count > 120 and time.monotonic() - begin > SECONDS:
                break
        wall = time.monotonic() - begin
        states, seen = (count - 120) / wall, (processor_time(process) - before) / wall
    begin, before = time.monotonic(), processor_time(process)
    await asyncio.sleep(SECONDS)
    unseen = (processor_time(process) - before) / (time.monotonic() - begin)
    return states, seen, unseen


def server(browser: Browser, folder: Path) -> list[Time]:
    """Return the processor time of the server for 60 states a second of 200 people, a robot and 1080 beams."""
    folder.mkdir(parents=True)
    (folder / "corridor.xml").write_text(corridor(200, repr(1 / 60)), encoding="utf-8")
    with program(folder, "--open", str(folder / "corridor.xml")) as found, ThreadPoolExecutor(1) as pool:
        # in a thread, because Playwright has an event loop in this one
        states, seen, unseen = pool.submit(asyncio.run, read_states(found[0], found[1])).result()
    share = 100.0 * (seen - unseen) * STATES / states
    how = f"for {STATES:g} states/s of 200 people, a robot and 1080 beams; measured at {states:.1f} states/s"
    return [
        Time("server, states to a window", share, "% of a core", 10.0, how),
        Time(
            "server, simulation of the same trial", 100.0 * unseen, "% of a core", None, "60 steps/s, without a window"
        ),
    ]


def memory(process: int) -> float:
    """Return the memory of a process [MB]."""
    pages = int(Path(f"/proc/{process}/statm").read_text(encoding="utf-8").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def peak_memory(process: int) -> float:
    """Return the largest memory that a process has had [MB]."""
    text = Path(f"/proc/{process}/status").read_text(encoding="utf-8")
    found = re.search(r"VmHWM:\s+(\d+) kB", text)
    assert found is not None
    return int(found[1]) * 1024 / 1e6


async def sleep_beside(address: str, process: int) -> tuple[int, float, float]:
    """Open a window that confirms nothing and then reads nothing.

    Returns:
        Frames that it got, growth of the memory of the server [MB], and simulated over real time of the run meanwhile.
    """
    base = f"{address.rstrip('/')}/api/main/socket"
    async with aiohttp.ClientSession() as session, session.ws_connect(base, max_msg_size=0) as socket:
        frames, begin = 0, time.monotonic()
        while time.monotonic() - begin < SECONDS:
            message = await socket.receive(SECONDS)
            frames += message.type == aiohttp.WSMsgType.BINARY
        before, at = memory(process), await _simulated(session, base)
        begin = time.monotonic()
        await asyncio.sleep(3 * SECONDS)
        wall = time.monotonic() - begin
        return frames, memory(process) - before, (await _simulated(session, base) - at) / wall


async def _simulated(session: aiohttp.ClientSession, url: str) -> float:
    """Return the simulated time [s] of the run."""
    async with session.ws_connect(url, max_msg_size=0) as socket:
        async for message in socket:
            if message.type == aiohttp.WSMsgType.TEXT:
                document = json.loads(message.data)
                if document.get("event") == "hello":
                    return float(document["data"]["desks"]["simulator"]["status"]["time"])
    raise RuntimeError("the server sends no greeting")


def slow_window(browser: Browser, folder: Path) -> list[Time]:
    """Return what a window that sleeps costs a run of 200 people."""
    folder.mkdir(parents=True)
    (folder / "corridor.xml").write_text(corridor(200, "0.05"), encoding="utf-8")
    with program(folder, "--open", str(folder / "corridor.xml")) as found, ThreadPoolExecutor(1) as pool:
        pool.submit(asyncio.run, read_states(found[0], found[1])).result()  # compiles
        frames, growth, factor = pool.submit(asyncio.run, sleep_beside(found[0], found[1])).result()
    how = f"in {3 * SECONDS:g} s, with the recording; the run goes at {factor:.2f} times real time"
    return [
        Time("frames to a window that confirms none", frames, "frames", 2.0, "200 people"),
        Time("memory of the server beside a window that sleeps", growth, "MB", 20.0, how),
    ]


def thousand(browser: Browser, folder: Path) -> list[Time]:
    """Return the states a second that a window gets of 1000 people."""
    folder.mkdir(parents=True)
    (folder / "corridor.xml").write_text(corridor(1000, "0.1"), encoding="utf-8")
    with program(folder, "--open", str(folder / "corridor.xml")) as found, ThreadPoolExecutor(1) as pool:
        states, _, _ = pool.submit(asyncio.run, read_states(found[0], found[1])).result()
    how = "a step of the trial is 0.1 s; the frames may take a tenth of a core"
    return [Time("states of 1000 people to a window", states, "states/s", None, how)]


ROWS: dict[str, Callable[[Browser, Path], list[Time]]] = {
    "first-picture": first_picture,
    "cold-start": cold_start,
    "busy-cold-start": busy_cold_start,
    "compilation": compilation,
    "edited-wall": edited_wall,
    "seek": seek,
    "camera-episode": camera_episode,
    "page": page_work,
    "server": server,
    "slow-window": slow_window,
    "thousand": thousand,
}


def main() -> int:
    """Measure, print, and fail if a limit is missed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rows", nargs="*", choices=[*ROWS, []], default=[], metavar="ROW", help=", ".join(ROWS))
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the values to a file")
    given = parser.parse_args()
    times: list[Time] = []
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=FLAGS)
        for name in given.rows or ROWS:
            with tempfile.TemporaryDirectory() as folder:
                times += ROWS[name](browser, Path(folder) / "files")
                print(f"measured {name}", file=sys.stderr, flush=True)
        browser.close()
    print("| what | value | limit | how |\n| --- | --- | --- | --- |")
    for one in times:
        print(f"| {' | '.join(one.cells())} |")
    if given.json is not None:
        rows = {"load": os.getloadavg()[0], "rows": [dataclasses.asdict(one) for one in times]}
        given.json.write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")
    return int(any(one.limit is not None and one.value > one.limit for one in times))


if __name__ == "__main__":
    sys.exit(main())
