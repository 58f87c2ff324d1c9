"""Pages of other sites in a real browser, and requests by hand, against every server that drives a robot."""

from __future__ import annotations

import functools
import http.server
import socket
import subprocess
import sys
import threading

import pytest
from bridge_runs import wait
from partner_runs import ENDLESS, free_port

from crowdbot.bridges import Inbox, RobotInterface
from crowdbot.bridges.foxglove import FoxgloveServer
from crowdbot.bridges.rosbridge.server import RosbridgeServer
from crowdbot.trials import load_trial
from crowdbot.vr import VR_DESKS, VrServer
from web.conftest import serve

pytestmark = pytest.mark.live
KINDS = {"rosbridge": RosbridgeServer, "foxglove": FoxgloveServer}
TRY = """([address, protocols]) => new Promise(done => {
    const socket = new WebSocket(address, protocols);
    socket.onopen = () => done("open");
    socket.onerror = () => done("refused");
})"""


@pytest.fixture
def start():
    """Starts servers, and stops them after the test."""
    interface, servers = RobotInterface.of(load_trial("frontal")), []

    def started(kind, **options):
        servers.append(KINDS[kind](port=0, **options))
        servers[-1].start(interface, Inbox(interface))
        return servers[-1]

    yield started
    for server in servers:
        server.stop()


@pytest.fixture
def site(tmp_path):
    """Address of another server on this machine, with an empty page."""
    (tmp_path / "index.html").write_text("<title>other</title>")
    handler = functools.partial(http.server.SimpleHTTPRequestHandler, directory=str(tmp_path))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()


@pytest.fixture
def attack(site, chromium):
    """Function that connects from a page of another site, and from a frame in it whose origin is null."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        page = browser.new_page()
        page.goto(site)
        page.set_content('<iframe sandbox="allow-scripts" srcdoc="nothing"></iframe>')
        frames = page.frames
        assert len(frames) == 2

        def tries(address, protocols=(), place=None):
            if place is not None:
                page.goto(place)
            return [frame.evaluate(TRY, [address, list(protocols)]) for frame in ([page] if place else frames)]

        yield tries
        browser.close()


@pytest.mark.parametrize("kind", KINDS)
def test_no_page_of_a_browser_connects_without_the_token_or_a_name(kind, start, site, attack):
    def tries(query="", **options):
        address = f"ws://127.0.0.1:{start(kind, **options).port}/{query}"
        return attack(address, ["foxglove.sdk.v1"] * (kind == "foxglove"))

    assert tries() == ["refused", "refused"]
    assert tries(token="secret") == ["refused", "refused"]
    assert tries("?token=wrong", token="secret") == ["refused", "refused"]
    assert tries("?token=secret", token="secret") == ["open", "open"]
    assert tries(origins=[site]) == ["open", "refused"]


def test_no_other_page_connects_to_the_app_or_as_a_headset(attack, tmp_path):
    with serve(tmp_path / "files", VR_DESKS, VrServer) as server:
        base = server.url.replace("http", "ws", 1)
        paths = ("api/main/socket", "api/main/headset", "api/main/headset-window")
        assert [attack(base + path) for path in paths] == [["refused", "refused"]] * 3
        assert attack(base + paths[0], place=server.url) == ["open"]  # the page of the app itself


def test_no_page_connects_to_the_run_of_a_real_robot(attack):
    port = free_port()
    words = ["join", "frontal", *ENDLESS, "--area=-9,-9,9,9", "--bridge", f"rosbridge:{port}"]
    process = subprocess.Popen(
        [sys.executable, "-m", "crowdbot", *words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )

    def listens():
        with socket.socket() as probe:
            return probe.connect_ex(("127.0.0.1", port)) == 0

    try:
        wait(listens, 120.0, 0.1)
        assert attack(f"ws://127.0.0.1:{port}/") == ["refused", "refused"]
    finally:
        process.kill()
        process.wait()


@pytest.mark.parametrize("kind", KINDS)
def test_requests_without_a_host_or_with_a_wrong_one_are_refused_without_a_trace(start, kind, capfd, caplog):
    server = start(kind)
    for lines in ("", "Host:\r\n", "Host: [\r\n", "Host: evil.example\r\n", "Host: a\r\nHost: b\r\n", "Host: \xff\r\n"):
        with socket.create_connection(("127.0.0.1", server.port), timeout=10.0) as client:
            key = "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n"
            head = f"GET / HTTP/1.1\r\n{lines}Connection: Upgrade\r\nUpgrade: websocket\r\n{key}\r\n"
            client.sendall(head.encode("latin-1"))
            assert client.recv(100).split()[1] in (b"400", b"403"), lines
    assert "Traceback" not in capfd.readouterr().err + caplog.text
