"""The server is killed in a trial: what has come until then is on disk, and the session continues afterwards."""

import asyncio
import contextlib
import re
import subprocess
import sys

import aiohttp
import pytest
from test_vr_server import Window, poses

from crowdbot.cli import main
from crowdbot.experiments import read_log
from crowdbot.recording import read_episode, replay
from crowdbot.vr import read_headset_recording

pytestmark = pytest.mark.live

EXPERIMENT = """<experiment name="visit"><instructions name="hello" text="Please stand."/>
<block name="main"><trial name="meet" source="meet.xml"/></block></experiment>"""
TRIAL = """<trial name="meet" duration="300"><stage/><crowd type="orca"/>
<avatar name="guest" source="external" x="1" y="0.5" body="man-30"/>
<agent x="4" y="1.2" goal="-500,1.2"/><end goal="false" collision="false"/></trial>"""


@contextlib.contextmanager
def app(folder):
    """Start the app, and yield its process and address."""
    words = [sys.executable, "-m", "crowdbot", "app", "--no-browser", "--port", "0", "--folder", str(folder)]
    with subprocess.Popen([*words, "--open", str(folder / "meet.xml")], stdout=subprocess.PIPE, text=True) as process:
        try:
            yield process, re.search(r"http://[\d.]+:\d+/", process.stdout.readline()).group()
        finally:
            process.kill()


async def send_poses(headset):
    """Send poses as long as the connection is open."""
    number, exchange = 0, None
    while True:
        _, exchange = await poses(headset, 10, number, exchange=exchange)
        number += 10


async def steps_of(window):
    return (await window.call("vr.state"))["participants"][0]["steps"]


async def visit(address, process):
    """Take part until the server is killed; return what ends the connection of the headset."""
    async with (
        aiohttp.ClientSession(address) as http,
        http.ws_connect("/api/main/socket") as socket,
        http.ws_connect("/api/main/headset") as headset,
    ):
        window = Window(socket)
        await headset.receive_str()
        sender = asyncio.create_task(send_poses(headset))
        await window.call("vr.set", settings={"timeout": 8.0, "pause_when_lost": False})
        state = await window.call("experiments.open", experiment="visit.xml", participant=1)
        await window.call("experiments.finish_screen", index=state["index"], answers={})
        before = await steps_of(window)  # the other trial is paused
        while await steps_of(window) < before + 25:
            await asyncio.sleep(0.05)
        process.kill()
        return (await asyncio.gather(sender, return_exceptions=True))[0]


async def look(address):
    """Return the warnings of the session after the server was started again."""
    async with aiohttp.ClientSession(address) as http, http.ws_connect("/api/main/socket") as socket:
        window = Window(socket)
        await window.call("experiments.open", experiment="visit.xml", participant=1, resume=True)
        return (await window.until(lambda state: state["warnings"]))["warnings"]


def test_a_killed_server_loses_no_raw_data_and_the_session_continues(tmp_path):
    folder = tmp_path / "files"
    folder.mkdir()
    (folder / "visit.xml").write_text(EXPERIMENT)
    (folder / "meet.xml").write_text(TRIAL)
    with app(folder) as (process, address):
        ending = asyncio.run(asyncio.wait_for(visit(address, process), 500))
        assert process.wait(30) == -9
    assert isinstance(ending, TypeError | aiohttp.ClientError | ConnectionError)  # no answer comes any more
    home = folder / "experiments" / "visit" / "participant-001"
    raw = list(read_headset_recording(home / "001-meet" / "guest.headset"))
    assert sum(item.sample is not None for item in raw) > 20
    assert sum(item.note is not None and "step" in item.note for item in raw) > 20
    assert read_log(home / "session.jsonl")  # the last line is whole
    episode = home / "001-meet" / "episode.mcap"
    assert main(["repair", str(episode)]) == 0
    orders = [order for _, order in read_episode(episode).orders]
    assert len(orders) > 5
    assert {order.avatar for order in orders} == {"guest"}
    assert replay(episode).equal
    with app(folder) as (_, address):
        warnings = asyncio.run(asyncio.wait_for(look(address), 300))
    assert warnings == ["nothing moves 'guest': it needs a headset or motion capture"]  # the trial is repeated
    assert (home / "001-meet-attempt-2").is_dir()
