"""Foxglove Studio of npm in a real Chromium: it shows what the server sends, and its buttons drive the robot."""

from __future__ import annotations

import functools
import http.server
import io
import json
import shutil
import subprocess
import threading
from pathlib import Path

import numpy as np
import pytest
from bridge_runs import Running
from PIL import Image
from test_rviz import PERSON, TRIAL, colored

from crowdbot.bridges.foxglove import FoxgloveServer, foxglove_layout
from crowdbot.trials import parse_trial
from web.conftest import FLAGS

FOLDER = Path(__file__).with_name("studio")
WIDTH, HEIGHT, SIDE = 1280, 800, 420
"""Size of the window, and width of the list of topics on its left [pixels]."""


@pytest.fixture
def site(tmp_path):
    """Address of a page with the app and the layout of the trial."""
    shutil.copytree(FOLDER, tmp_path, dirs_exist_ok=True)
    subprocess.run(["npm", "ci", "--silent", "--no-audit"], cwd=tmp_path, check=True, timeout=300)
    layout = foxglove_layout(parse_trial(TRIAL, place="rviz"))
    (tmp_path / "layout.json").write_text(json.dumps(layout), encoding="utf-8")
    handler = functools.partial(http.server.SimpleHTTPRequestHandler, directory=str(tmp_path))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()


@pytest.mark.sweep
def test_foxglove_studio_shows_people_walls_and_scan_and_its_buttons_drive_the_robot(site, chromium, tmp_path):
    from playwright.sync_api import sync_playwright

    server = FoxgloveServer(port=0, origins=(site,))
    with Running(parse_trial(TRIAL, place="rviz"), [server]) as running, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=FLAGS)
        page = browser.new_page(viewport={"width": WIDTH, "height": HEIGHT})
        page.goto(f"{site}/index.html?server=ws://127.0.0.1:{server.port}")

        def picture():
            with Image.open(io.BytesIO(page.screenshot())) as image:
                return np.asarray(image.convert("RGB"))[:, SIDE:]

        def wait(reached):
            for _ in range(240):
                if reached():
                    return
                page.wait_for_timeout(500)
            page.screenshot(path=tmp_path / "foxglove.png")
            pytest.fail(f"the app does not show it: {tmp_path}/foxglove.png")

        wait(lambda: len(colored(picture(), PERSON)) > 500)
        wait(lambda: (picture() < 40).all(axis=-1).sum() > 1500)  # the walls of the map
        assert server.wants("/robot/scan")
        assert server.wants("/robot/ground_truth/odom")  # the plot of the speed
        page.mouse.move(1133, 533)  # the button for forward
        page.mouse.down()
        wait(lambda: running.run.port.inbox.count.velocities > 5)
        page.screenshot(path=tmp_path / "foxglove.png")
        page.mouse.up()
        browser.close()
    assert running.run.port.inbox.count.refused == 0
