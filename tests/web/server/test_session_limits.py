"""A class of thirty: sandboxes, limits with sentences, sessions that end when nobody uses them."""

import asyncio
import io
from dataclasses import replace

import aiohttp
import pytest
from job_functions import count

from crowdbot.bridges.stack_link import StackProgram
from crowdbot.cli import main
from crowdbot.core import PROGRAMS, AccessPolicy, InputError
from crowdbot.navigation import ProcessNavigator
from crowdbot.simulation import RunFailureWarning, simulate
from crowdbot.trials import load_trial
from crowdbot.web import CLASSROOM, AppServer, Desk, SessionLimits, Workspace, command
from crowdbot.web.jobs import JobWork


class Notebook(Desk):
    """Writes files and starts jobs."""

    name = "notes"

    @command
    def write(self, text: str) -> list:  # type: ignore[type-arg]
        self.session.workspace.writable("note.txt").write_text(text)
        return [self.session.workspace.readable("note.txt").read_text(), self.session.workspace.files()]

    @command
    def work(self, steps: int) -> int:
        return self.session.jobs.submit(JobWork("count", "counts", count, (steps, 0.01))).record.number


def serve(folder, talk, **options):
    """Run ``talk(server, client)`` against a server and return its result."""

    async def main():
        server = AppServer((Notebook,), folder, port=0, **options)
        async with server.running(), aiohttp.ClientSession() as client:
            return await asyncio.wait_for(talk(server, client), 120)

    return asyncio.run(main())


async def ask(socket, call, **arguments):
    await socket.send_json({"id": 1, "call": call, "args": arguments})
    while "id" not in (answer := await socket.receive_json()):
        pass
    return answer


@pytest.mark.live
def test_thirty_students_share_a_server(tmp_path):
    async def student(server, client, number):
        async with client.ws_connect(server.url + f"api/student-{number}/socket") as socket:
            await socket.receive_json()
            own = await ask(socket, "notes.write", text=f"I am {number}")
            job = await ask(socket, "notes.work", steps=5)
            async with client.post(
                server.url + f"api/student-{number}/upload?name=large.csv", data=io.BytesIO(bytes(3000))
            ) as answer:
                refusal = (answer.status, await answer.text())
            return own["result"], job["result"], refusal

    async def talk(server, client):
        found = await asyncio.gather(*(student(server, client, number) for number in range(30)))
        while any(session.jobs.active for session in server.sessions.values()):
            await asyncio.sleep(0.05)
        return found, [session.jobs.records[0].state for session in server.sessions.values()]

    limits = SessionLimits(jobs=1, upload=2000.0)
    found, states = serve(tmp_path, talk, limits=limits, most_sessions=30)
    sentence = "large.csv is larger than 0.002 MB, the largest file that is taken\n"
    assert found == [([f"I am {number}", ["note.txt"]], 1, (413, sentence)) for number in range(30)]
    assert states == ["done"] * 30


@pytest.mark.live
def test_each_limit_is_refused_with_a_sentence(tmp_path):
    async def talk(server, client):
        async with client.ws_connect(server.url + "api/one/socket") as socket:
            await socket.receive_json()
            answers = [await ask(socket, "notes.work", steps=10_000) for _ in range(3)]
            texts = []
            for path in ("one", "two"):
                async with client.get(server.url + f"api/{path}/socket") as answer:
                    texts.append((answer.status, await answer.text()))
            async with client.post(server.url + "api/one/upload?name=a.csv", data=io.BytesIO(bytes(9000))) as answer:
                texts.append((answer.status, await answer.text()))
            return answers, texts

    limits = SessionLimits(jobs=1, waiting=1, windows=1, disk=8000.0)
    answers, texts = serve(tmp_path, talk, limits=limits, most_sessions=1)
    assert [answer.get("result") for answer in answers] == [1, 2, None]
    assert answers[2]["error"] == "1 jobs are waiting, the limit of a session; wait, or cancel one of them"
    assert texts[0] == (503, "session one has 1 windows, its limit; close one of them\n")
    assert texts[1] == (503, "1 sessions are open, the limit of this server; try again later\n")
    assert texts[2][0] == 400
    assert texts[2][1].startswith("your folder is full: 0 of 0 MB are used; remove jobs")


@pytest.mark.live
def test_a_session_that_nobody_uses_ends_and_keeps_its_files(tmp_path):
    async def talk(server, client):
        async with client.ws_connect(server.url + "api/one/socket") as socket:
            await socket.receive_json()
            await ask(socket, "notes.write", text="kept")
            await asyncio.sleep(0.6)
            during = list(server.sessions)
        while server.sessions:
            await asyncio.sleep(0.05)
        async with client.ws_connect(server.url + "api/one/socket") as socket:
            await socket.receive_json()
            return during, (await ask(socket, "notes.write", text="more"))["result"]

    during, (text, files) = serve(tmp_path, talk, limits=SessionLimits(idle=0.3))
    assert (during, text, files) == (["one"], "more", ["note.txt"])


def test_the_first_session_does_not_see_the_files_of_others(tmp_path):
    space = Workspace(tmp_path)
    other = Workspace(tmp_path / "sessions" / "anna")
    other.writable("secret.xml").write_text("<trial/>")
    assert other.files() == ["secret.xml"]
    assert space.files() == []
    assert space.size() == 0
    for act in (space.readable, space.writable):
        with pytest.raises(InputError, match="outside the folder of the app"):
            act("sessions/anna/secret.xml")


@pytest.mark.live
def test_the_address_of_a_student_opens_no_other_session(tmp_path):
    access = AccessPolicy("0.0.0.0", "secret")

    async def talk(server, _):
        base, _, rest = server.session_address("anna").replace("0.0.0.0", "127.0.0.1").partition("?")
        token, _, session = rest.partition("#")
        assert session == "session=anna"
        async with aiohttp.ClientSession(cookie_jar=aiohttp.CookieJar(unsafe=True)) as client:
            answers = []
            for path in (f"?{token}", "app.js", "api/anna/notes/x", "api/ben/notes/x", "api/main/socket"):
                async with client.get(base + path) as answer:  # after the first one, with the cookie
                    answers.append(answer.status)
            origin = {"Origin": base.rstrip("/")}
            async with client.ws_connect(f"{base}api/anna/socket", headers=origin) as socket:
                assert (await socket.receive_json())["data"]["session"] == "anna"
            with pytest.raises(aiohttp.WSServerHandshakeError):
                await client.ws_connect(f"{base}api/ben/socket", headers=origin)
        forged = token.replace("anna", "ben")
        async with aiohttp.ClientSession() as client, client.get(f"{base}api/ben/notes/x?{forged}") as answer:
            answers.append(answer.status)
        with pytest.raises(InputError, match="expected 1 to 40 letters"):
            server.session_address("../x")
        return answers

    assert serve(tmp_path, talk, host="0.0.0.0", access=access) == [200, 200, 404, 403, 403, 403]


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--jobs", "0"], "--jobs = 0: expected a positive number"),
        (["--disk-space", "nan"], "--disk-space = nan: expected a positive number"),
        (["--sessions", "0"], "--sessions = 0: expected at least 1"),
    ],
)
def test_wrong_limits_of_the_command_line(capsys, words, sentence):
    assert main(["app", "--no-browser", "--port", "0", *words]) == 2
    assert sentence in capsys.readouterr().err


def test_limits_of_the_command_line_reach_the_server(monkeypatch, tmp_path):
    from crowdbot.cli import app

    servers = []

    async def stop(server, browser, vr, place, students):
        servers.append(server)

    monkeypatch.setattr(app, "_serve", stop)
    monkeypatch.setenv(PROGRAMS, "")
    folder = ["--folder", str(tmp_path), "--no-browser"]
    assert main(["app", *folder]) == 0
    assert main(["app", *folder, "--host", "0.0.0.0", "--disk-space", "500", "--idle-time", "5"]) == 0
    assert servers[0].limits == SessionLimits()
    assert servers[1].limits.disk == 500e6
    assert servers[1].limits.idle == 300.0
    assert servers[1].limits.cpu == CLASSROOM.cpu


@pytest.mark.program
@pytest.mark.parametrize(
    ("words", "may"),
    [([], True), (["--host", "0.0.0.0"], False), (["--host", "0.0.0.0", "--programs"], True)],
)
def test_trials_on_a_server_for_other_machines_start_no_programs(monkeypatch, tmp_path, words, may):
    from crowdbot.cli import app

    async def stop(server, browser, vr, place, students):
        assert server.access.needs_token == bool(words)

    monkeypatch.setattr(app, "_serve", stop)
    monkeypatch.setenv(PROGRAMS, "")
    assert main(["app", "--folder", str(tmp_path), "--no-browser", *words]) == 0
    written = tmp_path / "written"
    navigator = ProcessNavigator(command=f"touch {written}", sandbox=False)
    trial = load_trial("frontal", duration=1.0)
    trial = replace(trial, robots=(replace(trial.robots[0], navigator=navigator),))
    with pytest.warns(
        RunFailureWarning, match="its process has ended" if may else "navigator touch is a program, and this server"
    ):
        simulate(trial, 0)
    assert written.exists() == may
    with pytest.raises(InputError, match="cannot be started" if may else "'none-such' is a program, and this server"):
        StackProgram("none-such", {}, {})


def test_a_limit_is_positive():
    with pytest.raises(InputError, match="limit jobs = 0 must be positive"):
        SessionLimits(jobs=0)
