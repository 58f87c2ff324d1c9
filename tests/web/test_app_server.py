"""The server: commands, events, state frames with credit, access, files, limits."""

import asyncio
import contextlib
import gc
import io
import json
import threading
import time
import warnings
from socket import create_connection

import aiohttp
import numpy as np
import pytest

from crowdbot.core import AccessPolicy, InputError
from crowdbot.web import (
    CREDIT,
    AppServer,
    Desk,
    Resource,
    SessionLimits,
    StateFrame,
    Workspace,
    command,
)


class Counter(Desk):
    """Counts."""

    name = "counter"
    hangs, goes_on = threading.Event(), threading.Event()

    def __init__(self, session):
        super().__init__(session)
        self.count = 0

    def greet(self):
        return {"count": self.count}

    @command
    def add(self, step: int = 1) -> int:
        self.count += step
        self.session.tell("counter.count", {"count": self.count})
        return self.count

    @command
    def fail(self, kind: str) -> None:
        if kind == "input":
            raise InputError("the value is wrong")
        raise ZeroDivisionError("a bug")

    @command
    def answer(self, kind: str) -> object:
        values = {"nan": float("nan"), "infinity": [1.0, {"far": -float("inf")}], "array": np.zeros(2)}
        return {"value": values[kind]}

    @command
    def burst(self, count: int) -> None:
        for number in range(count):
            self.session.show(StateFrame("count", float(number), {"n": np.array([number], dtype=np.int32)}))
            time.sleep(0.001)

    @command
    def turn_over(self) -> None:
        """Show more frames than a window gets at once, then something else."""
        self.burst(CREDIT + 1)
        self.session.discard("count")
        self.session.tell("counter.turned", {})

    @command
    def hang(self) -> None:
        self.hangs.set()
        self.goes_on.wait(180)

    @command
    def save(self, name: str, text: str) -> str:
        path = self.session.workspace.writable(name)
        path.write_text(text)
        return self.session.workspace.readable(name).read_text()

    def resource(self, path, query):
        if path != "double.bin":
            raise KeyError(path)
        return Resource(query["text"].encode() * 2, name="double.bin")


def serve(tmp_path, talk, **options):
    """Run ``talk(server, client)`` against a running server and return its result."""

    async def main():
        server = AppServer((Counter,), tmp_path / "files", port=0, **options)
        async with server.running(), aiohttp.ClientSession() as client:
            return await asyncio.wait_for(talk(server, client), 30)

    return asyncio.run(main())


@contextlib.asynccontextmanager
async def window(server, client, session="main", **options):
    """Open a window and return its socket and greeting."""
    async with client.ws_connect(server.url + f"api/{session}/socket", **options) as socket:
        yield socket, await socket.receive_json()


async def ask(socket, call, number=1, **arguments):
    await socket.send_json({"id": number, "call": call, "args": arguments})
    while True:
        answer = await socket.receive_json()
        if answer.get("id") == number:
            return answer


@pytest.mark.live
def test_a_window_calls_commands_and_all_windows_get_the_events(tmp_path):
    async def talk(server, client):
        async with window(server, client) as (one, greeting), window(server, client) as (two, _):
            answer = await ask(one, "counter.add", step=3)
            event = await two.receive_json()
            async with window(server, client) as (_, later), window(server, client, "other") as (_, other):
                return greeting, answer, event, later, other

    greeting, answer, event, later, other = serve(tmp_path, talk)
    assert greeting == {"event": "hello", "data": {"session": "main", "desks": {"counter": {"count": 0}}}}
    assert answer == {"id": 1, "result": 3}
    assert event == {"event": "counter.count", "data": {"count": 3}}
    assert later["data"]["desks"] == {"counter": {"count": 3}}
    assert other["data"]["desks"] == {"counter": {"count": 0}}  # a session has its own desks


@pytest.mark.live
@pytest.mark.parametrize(
    ("call", "arguments", "sentence"),
    [
        ("counter.fail", {"kind": "input"}, "the value is wrong"),
        ("counter.fail", {"kind": "bug"}, "ZeroDivisionError: a bug; this is a bug in crowdbot or in your code"),
        ("counter.ad", {}, "command 'ad' does not exist, did you mean 'add'?"),
        ("countr.add", {}, "tab 'countr' does not exist, did you mean 'counter'?"),
        ("counter.add", {"step": "3"}, "add: step = '3': expected a whole number"),
        ("counter.add", {"steps": 3}, "add: argument 'steps' is unknown"),
        ("counter.fail", {}, "fail: argument 'kind' is missing"),
        ("counter.resource", {}, "command 'resource' does not exist"),
        ("counter.__init__", {}, "command '__init__' does not exist"),
        ("counter.save", {"name": "../../x", "text": "a"}, "file '../../x' is outside the folder of the app"),
        ("counter.save", {"name": "/etc/x", "text": "a"}, "file '/etc/x' is outside the folder of the app"),
        ("counter.save", {"name": "", "text": "a"}, "name of a file = ''"),
    ],
)
def test_wrong_calls_are_answered_with_a_sentence(tmp_path, call, arguments, sentence):
    async def talk(server, client):
        async with window(server, client) as (socket, _):
            wrong = await ask(socket, call, **arguments)
            right = await ask(socket, "counter.add", number=2)
            return wrong, right

    wrong, right = serve(tmp_path, talk)
    assert sentence in wrong["error"]
    assert right["result"] == 1  # the window goes on


@pytest.mark.live
@pytest.mark.parametrize(
    ("kind", "answer"),
    [
        ("nan", {"id": 1, "result": {"value": None}}),
        ("infinity", {"id": 1, "result": {"value": [1.0, {"far": None}]}}),
        (
            "array",
            {
                "id": 1,
                "error": "counter.answer: TypeError: Object of type ndarray is not JSON serializable; this is a bug in "
                "crowdbot or in your code",
            },
        ),
    ],
)
def test_every_command_is_answered_even_with_what_json_cannot_hold(tmp_path, kind, answer):
    async def talk(server, client):
        async with window(server, client) as (socket, _):
            assert await ask(socket, "counter.answer", kind=kind) == answer
            assert (await ask(socket, "counter.add"))["result"] == 1

    serve(tmp_path, talk)


@pytest.mark.live
@pytest.mark.parametrize("text", ["", "[", "[]", "7", '"x"', '{"id": "1", "call": "counter.add"}', "[" * 100_000])
def test_a_window_that_sends_other_text_is_closed(tmp_path, text):
    async def talk(server, client):
        async with window(server, client) as (socket, _):
            await socket.send_str(text)
            message = await socket.receive()
        async with window(server, client) as (socket, _):
            return message.type, (await ask(socket, "counter.add"))["result"]

    closed, answer = serve(tmp_path, talk)
    assert closed in (aiohttp.WSMsgType.CLOSE, aiohttp.WSMsgType.CLOSED)
    assert answer == 1


@pytest.mark.live
def test_a_slow_window_gets_the_newest_frame_and_never_more_than_its_credit(tmp_path):
    async def talk(server, client):
        async with window(server, client) as (socket, _):
            await socket.send_json({"id": 1, "call": "counter.burst", "args": {"count": 200}})
            frames = []
            while True:
                message = await socket.receive()
                if message.type == aiohttp.WSMsgType.BINARY:
                    frames.append(StateFrame.decode(message.data))
                else:
                    break
            assert json.loads(message.data) == {"id": 1, "result": None}
            await socket.send_json({"drawn": frames[-1].sequence})
            return frames, StateFrame.decode((await socket.receive()).data)

    frames, last = serve(tmp_path, talk)
    assert len(frames) <= CREDIT
    assert last.arrays["n"].tolist() == [199]


@pytest.mark.live
def test_a_frame_that_waits_never_comes_after_the_event_of_what_is_shown_next(tmp_path):
    async def talk(server, client):
        async with window(server, client) as (socket, _):
            await socket.send_json({"id": 1, "call": "counter.turn_over", "args": {}})
            frames = []
            while (message := await socket.receive()).type == aiohttp.WSMsgType.BINARY or "turned" not in message.data:
                frames += [StateFrame.decode(message.data)] if message.type == aiohttp.WSMsgType.BINARY else []
            await socket.send_json({"drawn": CREDIT})
            await socket.send_json({"id": 2, "call": "counter.burst", "args": {"count": 1}})
            while (message := await socket.receive()).type != aiohttp.WSMsgType.BINARY:
                pass
            return [int(frame.arrays["n"][0]) for frame in frames], StateFrame.decode(message.data)

    before, after = serve(tmp_path, talk)
    assert len(before) <= CREDIT
    assert (after.sequence, int(after.arrays["n"][0])) == (len(before) + 1, 0)


@pytest.mark.live
def test_a_window_gets_the_channels_that_it_shows_and_desks_know_it(tmp_path):
    async def burst(socket, ready, wants=None):
        if wants is not None:
            await socket.send_json({"wants": wants})
        await ask(socket, "counter.add")
        await socket.send_json({"id": 7, "call": "counter.burst", "args": {"count": 1}})
        kinds = set()
        while (message := await socket.receive()).type == aiohttp.WSMsgType.BINARY or "7" not in message.data:
            kinds.add(message.type)
            if message.type == aiohttp.WSMsgType.BINARY:
                await socket.send_json({"drawn": StateFrame.decode(message.data).sequence})
        return aiohttp.WSMsgType.BINARY in kinds, ready("count"), ready("other"), ready()

    async def talk(server, client):
        async with window(server, client) as (socket, _):
            ready = server.sessions["main"].is_ready
            found = [await burst(socket, ready, wants) for wants in (None, ["other"], [], ["count", "other"])]
            await socket.send_json({"wants": "count"})
            while (message := await socket.receive()).type in (aiohttp.WSMsgType.TEXT, aiohttp.WSMsgType.BINARY):
                pass
            return found, message.type

    found, closed = serve(tmp_path, talk)
    assert [sent for sent, *_ in found] == [True, False, False, True]
    assert found[1:3] == [(False, False, True, True), (False, False, False, False)]
    assert closed in (aiohttp.WSMsgType.CLOSE, aiohttp.WSMsgType.CLOSED)


@pytest.mark.live
def test_files_of_desks_and_of_the_page(tmp_path):
    async def talk(server, client):
        answers = []
        for path in (
            "",
            "app.js",
            "api/main/counter/double.bin?text=ab",
            "api/main/counter/none",
            "x/../../etc/passwd",
        ):
            async with client.get(server.url + path) as answer:
                answers.append((answer.status, answer.headers, await answer.read()))
        return answers

    page, script, double, missing, outside = serve(tmp_path, talk)
    assert page[0] == script[0] == 200
    assert "default-src 'self'" in page[1]["Content-Security-Policy"]
    assert double[::2] == (200, b"abab")
    assert missing[::2] == (404, b"file 'none' does not exist\n")
    assert outside[0] == 404


@pytest.mark.live
@pytest.mark.parametrize(
    ("headers", "sentence"),
    [
        ({"Origin": "https://example.org"}, "requests from https://example.org are refused"),
        ({"Host": "example.org"}, "the server answers on the loopback address only, not as example.org"),
        ({"Origin": "null"}, "requests from null are refused"),
    ],
)
def test_other_sites_are_refused(tmp_path, headers, sentence):
    async def talk(server, client):
        async with client.get(server.url + "api/main/socket", headers=headers) as answer:
            return answer.status, await answer.text()

    status, text = serve(tmp_path, talk)
    assert status == 403
    assert sentence in text


@pytest.mark.live
def test_beyond_loopback_a_token_is_needed(tmp_path):
    async def talk(server, client):
        base, _, token = server.url.partition("?token=")
        answers = []
        for query in ("", "?token=wrong", f"?token={token}", ""):  # the last one has the cookie
            async with client.get(base.replace("0.0.0.0", "127.0.0.1") + query) as answer:
                answers.append(answer.status)
        return answers, token

    jar = {"host": "0.0.0.0", "access": AccessPolicy("0.0.0.0", "secret-token")}

    async def main():
        server = AppServer((Counter,), tmp_path / "files", port=0, **jar)
        async with server.running(), aiohttp.ClientSession(cookie_jar=aiohttp.CookieJar(unsafe=True)) as client:
            return await talk(server, client)

    answers, token = asyncio.run(main())
    assert token == "secret-token"
    assert answers == [403, 403, 200, 200]


@pytest.mark.live
def test_links_that_lead_outside_are_refused(tmp_path):
    (tmp_path / "secret.txt").write_text("secret")
    (tmp_path / "files").mkdir()
    (tmp_path / "files" / "link").symlink_to(tmp_path)

    async def talk(server, client):
        async with window(server, client) as (socket, _):
            return await ask(socket, "counter.save", name="link/secret.txt", text="x")

    assert "outside the folder" in serve(tmp_path, talk)["error"]
    assert (tmp_path / "secret.txt").read_text() == "secret"


@pytest.mark.live
def test_uploads_are_kept_by_their_last_name(tmp_path):
    async def talk(server, client):
        async with client.post(server.url + "api/main/upload?name=../../tracks.csv", data=b"id,x") as answer:
            return await answer.json()

    assert serve(tmp_path, talk) == {"name": "tracks.csv"}
    assert (tmp_path / "files" / "tracks.csv").read_bytes() == b"id,x"


@pytest.mark.live
def test_uploads_are_larger_than_messages_and_have_a_limit(tmp_path):
    async def talk(server, client):
        async with client.post(
            server.url + "api/main/upload?name=large.csv", data=io.BytesIO(bytes(5 << 20))
        ) as answer:
            first = answer.status
        server.limits = SessionLimits(upload=1e6)
        async with client.post(server.url + "api/main/upload?name=huge.csv", data=io.BytesIO(bytes(2 << 20))) as answer:
            return first, answer.status

    assert serve(tmp_path, talk) == (200, 413)
    assert [item.name for item in (tmp_path / "files").iterdir()] == ["large.csv"]


@pytest.mark.live
def test_a_server_for_other_machines_takes_no_code(tmp_path):
    async def main():
        server = AppServer((Counter,), tmp_path / "files", "0.0.0.0", 0, AccessPolicy("0.0.0.0", "secret"))
        async with server.running(), aiohttp.ClientSession() as client:
            url = server.url.replace("0.0.0.0", "127.0.0.1").replace("/?", "/api/main/upload?name=mine.py&")
            async with client.post(url, data=b"import os") as answer:
                return answer.status, await answer.text()

    status, text = asyncio.run(main())
    assert (status, text) == (403, "'mine.py' is code; a server for other machines takes data only\n")
    assert not (tmp_path / "files" / "mine.py").exists()


@pytest.mark.live
def test_the_server_stops_while_a_command_runs(tmp_path, monkeypatch):
    hangs, goes_on = threading.Event(), threading.Event()
    monkeypatch.setattr(Counter, "hangs", hangs)
    monkeypatch.setattr(Counter, "goes_on", goes_on)

    async def talk(server, client):
        async with window(server, client) as (socket, _):
            await socket.send_json({"id": 1, "call": "counter.hang", "args": {}})
            await asyncio.get_running_loop().run_in_executor(None, hangs.wait)
            return True

    try:
        assert serve(tmp_path, talk)
        assert any(item.name == "crowdbot-counter" for item in threading.enumerate())
    finally:
        goes_on.set()


@pytest.mark.live
@pytest.mark.parametrize("turns", range(6))
def test_a_connection_that_comes_while_the_server_stops_is_closed(tmp_path, turns):
    async def main():
        async with AppServer((), tmp_path / "files", port=0).running() as server:
            client = create_connection(("127.0.0.1", int(server.url.rsplit(":", 1)[1].strip("/"))))
            for _ in range(turns):  # of the event loop, while it accepts
                await asyncio.sleep(0)
        return client

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        client = asyncio.run(main())
        gc.collect()
    with client, contextlib.suppress(ConnectionResetError):  # never accepted
        client.settimeout(60.0)
        assert client.recv(1) == b""
    assert [str(item.message) for item in caught] == []


@pytest.mark.live
def test_a_port_in_use_is_told(tmp_path):
    async def talk(server, client):
        port = int(server.url.rsplit(":", 1)[1].strip("/"))
        with pytest.raises(InputError, match=f"cannot listen on 127.0.0.1 port {port}: .*; give another --port"):
            async with AppServer((), tmp_path, port=port).running():
                pass
        return port

    assert serve(tmp_path, talk) > 0


def test_only_trials_are_listed_as_trials(tmp_path):
    space = Workspace(tmp_path)
    texts = {"own.xml": "<!-- mine --><trial name='a'/>", "questions.xml": "<experiment/>", "broken.xml": "<tri"}
    for name, text in texts.items():
        (tmp_path / name).write_text(text)
    assert space.trials() == ["broken.xml", "own.xml"]
    assert space.files("*.xml") == ["broken.xml", "own.xml", "questions.xml"]
