"""The server for headsets without a browser: joining, refusals, silence, the end of the server, HTTPS and tokens."""

import asyncio
import json
import os
import re
import ssl
import stat

import aiohttp
import numpy as np
import pytest
from headset_messages import message

from crowdbot.core import AccessPolicy, InputError
from crowdbot.vr import (
    VR_DESKS,
    VrServer,
    certificate_files,
    link_picture,
    link_text,
    local_addresses,
    tls_context,
    token_of_session,
)

TRIAL = """<trial name="meet" duration="600"><stage/><crowd type="orca"/>{avatar}
<agent x="4" y="1.2" goal="-5,1.2"/><end collision="false"/></trial>"""
AVATAR = '<avatar name="guest" source="external" x="1" y="0.5" heading="0.5"/>'


def desks(first="meet.xml"):
    return tuple(
        type("SimulatorDesk", (item,), {"first": first}) if item.name == "simulator" else item for item in VR_DESKS
    )


class Window:
    """A window of the session that calls commands."""

    def __init__(self, socket):
        self.socket, self.number = socket, 0

    async def call(self, name, **arguments):
        self.number += 1
        await self.socket.send_str(json.dumps({"id": self.number, "call": name, "args": arguments}))
        async for item in self.socket:
            if item.type == aiohttp.WSMsgType.BINARY:
                continue
            answer = json.loads(item.data)
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise InputError(answer["error"])
                return answer["result"]
        raise AssertionError("the window was closed")

    async def until(self, check):
        """Wait until the state of virtual reality passes a check."""
        while not check(result := await self.call("vr.state")):
            await asyncio.sleep(0.05)
        return result


async def poses(headset, count=1, start=0, **how):
    """Send poses, and return the answers without contacts."""
    loop, answers, exchange = asyncio.get_running_loop(), [], how.pop("exchange", None)
    for k in range(count):
        more = {} if exchange is None else {"clock": np.array(exchange)}
        await headset.send_bytes(message(loop.time() + 99.0, number=start + k + 1, **how, **more))
        answer = json.loads(await headset.receive_str())
        exchange = (*answer["clock"], loop.time() + 99.0)
        answers.append(answer)
        await asyncio.sleep(0.01)
    return answers, exchange


async def until_closed(socket):
    """Read until the server closes the connection, and return the code."""
    async for _ in socket:
        pass
    return socket.close_code


def play(story, folder, avatar=AVATAR):
    """Run a story with a server, a window and an HTTP client."""
    folder.mkdir()
    (folder / "meet.xml").write_text(TRIAL.format(avatar=avatar))

    async def main():
        async with (
            VrServer(desks(), folder, port=0).running() as server,
            aiohttp.ClientSession(server.url) as http,
            http.ws_connect("/api/main/socket") as socket,
        ):
            window = Window(socket)
            while not server.sessions:
                await asyncio.sleep(0.01)
            await story(server, http, window)

    asyncio.run(main())


@pytest.mark.live
def test_two_headsets_silence_and_messages_that_are_none(tmp_path):
    async def story(server, http, window):
        async with http.ws_connect("/api/main/headset") as first:
            assert json.loads(await first.receive_str()) == {"joined": "guest"}
            answers, exchange = await poses(first, 12)
            sent, arrived, answered = answers[-1]["clock"]
            assert answered >= arrived
            state = await window.until(lambda one: one["participants"][0]["offset"] is not None)
            assert state["participants"][0]["offset"] == pytest.approx(arrived - sent, abs=0.2)
            async with http.ws_connect("/api/main/headset") as second:
                refusal = json.loads(await second.receive_str())["refused"]
                assert "each avatar of the trial has a participant already: guest" in refusal
                assert (await second.receive()).type == aiohttp.WSMsgType.CLOSE
            await poses(first, 40, 12, exchange=exchange)
            await window.until(lambda one: "paused since tracking of guest was lost" in one["warnings"])
            assert server.sessions["main"].desk("simulator").run.loop.paused
            await window.call("simulator.play")
            await window.until(
                lambda one: one["pause"] is None and not any("paused" in text for text in one["warnings"])
            )
            await window.call("vr.pause")
            await window.call("vr.resume")
            assert not server.sessions["main"].desk("simulator").run.loop.paused
            await first.send_bytes(b"CBF1 nothing")
            assert "is not whole" in json.loads(await first.receive_str())["refused"]
        await window.until(lambda one: one["participants"] == [])

    play(story, tmp_path / "files")


@pytest.mark.live
def test_commands_of_the_operator_and_their_errors(tmp_path):
    async def story(server, http, window):
        for name, arguments, text in (
            ("set", {"settings": {"delay": 1}}, "setting 'delay' does not exist"),
            ("set", {"settings": {"motion_delay": 9}}, "motion_delay = 9: expected 0 to 2"),
            ("add_wrist_pair", {"avatar": "guest", "x": 0, "y": 0, "z": 1}, "avatar 'guest' has no participant"),
            ("calibrate", {"room": "hall"}, "room = 'hall': expected person or robot"),
            ("limit_room", {"room": "robot", "corners": [[0, 0]]}, "expected 3 to 100 corners"),
        ):
            with pytest.raises(InputError, match=re.escape(text)):
                await window.call(f"vr.{name}", **arguments)
        async with http.ws_connect("/api/main/headset") as headset:
            await headset.receive_str()
            _, exchange = await poses(headset, 4)
            for k, (x, y) in enumerate(((0.3, -0.2), (0.5, 0.2), (0.1, 0.4))):
                _, exchange = await poses(headset, 35, 40 * k + 4, right=(x, y, 1.0), exchange=exchange)
                assert await window.call("vr.add_wrist_pair", avatar="guest", x=x + 2, y=y - 1, z=1.0) == k + 1
            found = await window.call("vr.calibrate", room="person")
            assert (found["x"], found["y"], found["heading"]) == pytest.approx((2.0, -1.0, 0.0), abs=1e-5)
            measure, number = asyncio.create_task(window.call("vr.measure_body", avatar="guest")), 200
            while not measure.done():  # the headset goes on, however long the trial takes to begin anew
                _, exchange = await poses(headset, 5, number, exchange=exchange)
                number += 5
            stature = await measure
            assert stature == pytest.approx(1.6 / 0.94, abs=0.05)
            await poses(headset, 10, number, exchange=exchange)
            run = server.sessions["main"].desk("simulator").run
            assert run.trial.avatars[0].height == stature
            await window.until(lambda one: one["participants"][0]["steps"] > 0)
        async with http.get("/api/main/vr/link.svg") as picture:
            assert picture.content_type == "image/svg+xml"
        async with http.get("/vr") as page:
            assert "vr.js" in await page.text()

    play(story, tmp_path / "files")


@pytest.mark.live
def test_a_trial_without_an_avatar_gets_one_and_the_end_of_the_server_closes_the_headset(tmp_path):
    folder = tmp_path / "files"
    folder.mkdir()
    (folder / "meet.xml").write_text(TRIAL.format(avatar=""))

    async def main():
        async with aiohttp.ClientSession() as http:
            async with VrServer(desks(), folder, port=0).running() as server:
                window = await http.ws_connect(f"{server.url}api/main/socket")
                headset = await http.ws_connect(f"{server.url}api/main/headset")
                assert json.loads(await headset.receive_str()) == {"joined": "participant"}
                await poses(headset, 3)
                desk = server.sessions["main"].desk("vr")
                ends = asyncio.gather(until_closed(headset), until_closed(window))
            assert await ends == [1001, 1001]  # going away
            assert not desk._watcher.is_alive()

    asyncio.run(main())


@pytest.mark.live
def test_https_with_an_own_certificate_and_a_token(tmp_path):
    certificate, key = certificate_files(tmp_path / "user", ("192.0.2.7",))
    again = certificate_files(tmp_path / "user", ("192.0.2.7",))
    text = certificate.read_bytes()
    assert again == (certificate, key)
    assert certificate.read_bytes() == text
    assert stat.S_IMODE(os.stat(key).st_mode) == 0o600
    certificate_files(tmp_path / "user", ("192.0.2.8",))
    assert certificate.read_bytes() != text  # another address, another certificate
    trust = ssl.create_default_context(cafile=str(certificate))

    async def main():
        policy = AccessPolicy("0.0.0.0", token="secret")
        server = VrServer((), tmp_path / "files", "127.0.0.1", 0, policy, tls=tls_context(certificate, key))
        async with server.running(), aiohttp.ClientSession() as http:
            assert server.vr_url.startswith("https://127.0.0.1:")
            assert server.vr_url.endswith("/vr?token=" + token_of_session("secret", "main"))
            async with http.get(server.vr_url, ssl=trust) as page:
                assert page.status == 200
                assert "secure" in page.headers["Set-Cookie"].casefold()
            http.cookie_jar.clear()
            async with http.get(server.vr_url.partition("?")[0], ssl=trust) as page:
                assert page.status == 403

    asyncio.run(main())
    assert all(address.count(".") == 3 for address in local_addresses())


def test_the_code_of_a_link_has_finders_in_three_corners():
    address = "https://192.0.2.1:8700/vr?token=abc"
    rows = link_text(address).splitlines()
    assert len({len(row) for row in rows}) == 1
    assert rows[1][2:9] == rows[1][-9:-2]
    assert link_picture(address).count(b"<path") >= 1
