"""The token of a headset opens the page of participants of one session, and the operator's token everything."""

import asyncio
import json

import aiohttp
import pytest

from crowdbot.core import AccessPolicy
from crowdbot.vr import HEADSET_COMMANDS, VR_DESKS, VrServer, session_of_token, token_of_session

SECRET = "secret-of-the-operator"
TRIAL = """<trial name="meet" duration="600"><stage/><crowd type="orca"/>
<avatar name="guest" source="external" x="1" y="0"/>
<agent x="4" y="1.2" goal="-5,1.2"/><end collision="false"/></trial>"""


def play(story, folder):
    """Run a story with a server that needs tokens."""
    folder.mkdir()
    (folder / "meet.xml").write_text(TRIAL)
    desks = tuple(
        type("SimulatorDesk", (item,), {"first": "meet.xml"}) if item.name == "simulator" else item for item in VR_DESKS
    )

    async def main():
        policy = AccessPolicy("0.0.0.0", token=SECRET)
        server = VrServer(desks, folder, "127.0.0.1", 0, policy)
        async with server.running(), aiohttp.ClientSession(cookie_jar=aiohttp.DummyCookieJar()) as http:
            await story(server, http, server.url.partition("?")[0])

    asyncio.run(main())


def test_tokens_belong_to_a_session_and_a_server():
    token = token_of_session(SECRET, "room-2")
    assert session_of_token(SECRET, token) == "room-2"
    assert session_of_token("another", token) is None
    assert session_of_token(SECRET, token.replace("room-2", "main")) is None
    assert session_of_token(SECRET, SECRET) is None
    assert session_of_token(SECRET, "") is None
    assert SECRET not in token


@pytest.mark.live
def test_a_headset_opens_its_page_and_nothing_of_the_operator(tmp_path):
    async def story(server, http, base):
        token = token_of_session(SECRET, "main")
        assert server.vr_url == f"{base}vr?token={token}"
        assert server.headset_address("other").endswith(f"{token_of_session(SECRET, 'other')}#session=other")

        async def status(path, given=token):
            async with http.get(f"{base}{path}", params={"token": given}) as answer:
                return answer.status

        for path in ("vr", "vr.js", "vr.css", "icon.svg"):
            assert await status(path) == 200, path
        async with http.ws_connect(f"{base}api/main/headset-window", params={"token": token}):
            for _ in range(600):
                if (mesh := await status("api/main/simulator/bodies/2.bin")) != 400:  # the trial is being prepared
                    break
                await asyncio.sleep(0.1)
        assert mesh == 200
        refused = ("", "app.js", "index.html", "api/main/socket", "api/main/vr/link.svg", "api/other/headset-window",
                   "api/other/headset", "api/main/simulator/thumbnail/frontal.svg",
                   "api/main/simulator/bodies/..%2f..%2fx.bin")  # fmt: skip
        for path in refused:
            assert await status(path) == 403, path
        assert await status("vr", "main.AAAA") == 403
        assert await status("", SECRET) == 200
        async with http.post(f"{base}api/main/upload", params={"token": token, "name": "x.xml"}, data=b"x") as answer:
            assert answer.status == 403
        async with http.get(f"{base}vr", params={"token": token}) as answer:
            assert "crowdbot-headset" in answer.cookies
            assert "crowdbot-token" not in answer.cookies
        async with http.get(f"{base}vr", params={"token": token}, headers={"Origin": "https://example.org"}) as answer:
            assert answer.status == 403

    play(story, tmp_path / "files")


@pytest.mark.live
def test_the_window_of_a_headset_may_look_answer_and_stop_only(tmp_path):
    async def story(server, http, base):
        token = token_of_session(SECRET, "main")
        async with http.ws_connect(f"{base}api/main/headset-window", params={"token": token}) as socket:
            numbers = iter(range(1, 1000))

            async def answer(call, **arguments):
                number = next(numbers)
                await socket.send_str(json.dumps({"id": number, "call": call, "args": arguments}))
                while True:
                    message = await asyncio.wait_for(socket.receive(), 60)
                    if message.type != aiohttp.WSMsgType.TEXT:
                        continue
                    document = json.loads(message.data)
                    if document.get("id") == number:
                        return document
                    seen.add(document["event"])

            hello = json.loads((await socket.receive()).data)
            seen = set()
            assert hello["event"] == "hello"
            assert set(hello["data"]["desks"]) == {"vr", "simulator", "experiments"}
            assert "address" not in hello["data"]["desks"]["vr"]
            assert "source" not in hello["data"]["desks"]["simulator"]
            for name in ("vr.set", "vr.release_robots", "vr.resume", "simulator.run", "experiments.open",
                         "experiments.answers", "experiments.next", "jobs.start", "nothing"):  # fmt: skip
                assert (await answer(name))["error"] == f"a headset may not call {name!r}"
            stopped = await answer("vr.stop_robots")
            assert stopped.get("result") == [], stopped
            for _ in range(600):
                if "nothing is open" not in (shown := await answer("simulator.show_frame")).get("error", ""):
                    break
                await asyncio.sleep(0.1)  # the trial is being prepared
            assert "result" in shown, shown
            assert "error" in await answer("experiments.finish_screen", index=0, answers={})
            assert seen <= {"vr.state", "simulator.status", "simulator.opened", "experiments.state"}

    play(story, tmp_path / "files")


@pytest.mark.parametrize("name", sorted(HEADSET_COMMANDS))
def test_the_commands_of_a_headset_exist(name):
    desk, _, command = name.partition(".")
    kind = next(item for item in VR_DESKS if item.name == desk)
    assert getattr(getattr(kind, command), "__command__", False)
