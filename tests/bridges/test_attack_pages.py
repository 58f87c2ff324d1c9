"""Pages of other sites in a real browser, and requests by hand, against every server that drives a robot."""

from __future__ import annotations

import functools
import http.server
import socket
import threading

import pytest

from crowdbot.bridges import Inbox, RobotInterface
from crowdbot.bridges.foxglove import FoxgloveServer
from crowdbot.bridges.rosbridge.server import RosbridgeServer
from crowdbot.trials import load_trial

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


def test_no_page_of_a_browser_connects_without_the_token_or_a_name(start, site, chromium):
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        page = browser.new_page()
        page.goto(site)
        page.set_content('<iframe sandbox="allow-scripts" srcdoc="nothing"></iframe>')
        frames = page.frames
        assert len(frames) == 2  # the page, and a frame whose origin is null

        def tries(kind, query="", **options):
            address = f"ws://127.0.0.1:{start(kind, **options).port}/{query}"
            protocols = ["foxglove.sdk.v1"] * (kind == "foxglove")
            return [frame.evaluate(TRY, [address, protocols]) for frame in frames]

        for kind in KINDS:
            assert tries(kind) == ["refused", "refused"], kind
            assert tries(kind, token="secret") == ["refused", "refused"], kind
            assert tries(kind, "?token=wrong", token="secret") == ["refused", "refused"], kind
            assert tries(kind, "?token=secret", token="secret") == ["open", "open"], kind
            assert tries(kind, origins=[site]) == ["open", "refused"], kind
        browser.close()


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
