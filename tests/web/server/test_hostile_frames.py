"""Torn and hostile frames: no trace, no memory, no effect on another session."""

import asyncio
import json
import logging
import os
import random
import time
from urllib.parse import urlsplit

import aiohttp
import pytest
from hostile_frames import send_frames

from crowdbot.web import DESKS

ATTACKERS = 8
"""Windows that attack at the same time."""


def resident():
    """Return the memory of this process [MB]."""
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


async def healthy(url, stop):
    """Use the editor of another session; return the number of answers, each within 60 s."""
    answers = 0
    async with aiohttp.ClientSession() as client, client.ws_connect(url + "api/healthy/socket") as socket:
        await socket.receive_json()
        while not stop.is_set():
            await socket.send_json({"id": 1, "call": "editor.undo", "args": {}})
            while True:
                message = await asyncio.wait_for(socket.receive(), 60)
                answer = json.loads(message.data) if message.type == aiohttp.WSMsgType.TEXT else {}
                if answer.get("id") == 1:
                    break
            assert "error" not in answer, answer
            answers += 1
            await asyncio.sleep(0.02)
    return answers


async def attack(url, count, seed):
    """Send ``count`` hostile frames; return answers that tell a bug, the number of healthy answers, and the memory."""
    place, rng, stop = urlsplit(url), random.Random(seed), asyncio.Event()
    commands = [
        f"{desk.name}.{name}"
        for desk in DESKS
        for name in dir(desk)
        if desk.name in ("prediction", "editor", "evaluation", "jobs")
        and getattr(getattr(desk, name), "__command__", False)
    ]
    watcher = asyncio.create_task(healthy(url, stop))
    bugs, memory = [], []

    async def attacker():
        sent = 0
        while sent < count / ATTACKERS:
            done, answers = await send_frames(place.hostname, place.port, "evil", rng, commands, rng.randrange(1, 60))
            sent += done
            bugs.extend([answers] if b"this is a bug" in answers else [])
            memory.append(resident())

    await asyncio.gather(*(attacker() for _ in range(ATTACKERS)))
    stop.set()
    return bugs, await watcher, memory


def check(serve, folder, count, caplog, capfd):
    """Attack a server and check what is left of it."""
    before = {item: item.stat().st_mtime_ns for item in folder.parent.iterdir()}
    with serve(folder, DESKS[1:]) as server, caplog.at_level(logging.WARNING):
        bugs, answers, memory = asyncio.run(attack(server.url, count, 7))
        end = time.monotonic() + 180
        while server.sessions["evil"].windows:
            if time.monotonic() > end:
                raise TimeoutError
            time.sleep(0.05)
    assert bugs == []
    assert answers > 0
    begin = max(memory[: len(memory) // 3])
    assert memory[-1] - begin < 50.0, (begin, memory[-1])
    assert [record for record in caplog.records if record.levelno >= logging.ERROR] == []
    assert "Traceback" not in capfd.readouterr().err
    assert {item: item.stat().st_mtime_ns for item in folder.parent.iterdir() if item != folder} == {
        item: when for item, when in before.items() if item != folder
    }  # nothing is written elsewhere


@pytest.mark.live
def test_a_thousand_hostile_frames(serve, tmp_path, caplog, capfd):
    (tmp_path / "secret.xml").write_text("<trial/>")
    check(serve, tmp_path / "files", 1000, caplog, capfd)


@pytest.mark.sweep
def test_a_hundred_thousand_hostile_frames(serve, tmp_path, caplog, capfd):
    (tmp_path / "secret.xml").write_text("<trial/>")
    check(serve, tmp_path / "files", 100_000, caplog, capfd)
