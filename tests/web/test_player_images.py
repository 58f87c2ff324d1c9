"""The file of a player shows the recorded images of cameras, without a server."""

import pytest
from test_camera_images import TRIAL

from crowdbot.core import InputError
from crowdbot.recording import read_episode, record
from crowdbot.trials import parse_trial
from crowdbot.web.scene import player as player_file
from crowdbot.web.scene import write_player

PLAYER = "crowdbotPlayer.player"


@pytest.fixture(scope="module")
def episode(tmp_path_factory):
    path = tmp_path_factory.mktemp("seen") / "seen.mcap"
    record(parse_trial(TRIAL.replace('duration="3"', 'duration="1.5"')), 1, path)
    return path


def test_a_player_shows_the_recorded_images(browser, episode, tmp_path):
    file = write_player(episode, tmp_path / "seen.html", images=True).path
    recorded = read_episode(episode).readings
    context = browser.new_context(viewport={"width": 800, "height": 600}, offline=True)
    page, faults = context.new_page(), []
    page.set_default_timeout(180_000)
    page.on("console", lambda one: faults.append(one.text) if one.type == "error" else None)
    page.on("pageerror", lambda one: faults.append(str(one)))
    page.goto(file.as_uri())
    page.wait_for_function("() => globalThis.crowdbotPlayer?.player?.scene?.info().frames > 0")
    page.evaluate(f"{PLAYER}.show(true)")
    count = page.evaluate(f"{PLAYER}.index.images.map((one) => [one.image.name, one.times.length])")
    assert count == [
        ["eye/color/color", len(recorded["eye/color"])],
        ["eye/color/labels", len(recorded["eye/color"])],
        ["eye/depth/depth", len(recorded["eye/depth"])],
        ["eye/depth/labels", len(recorded["eye/depth"])],
    ]
    page.get_by_text("Layers").click()
    page.get_by_label("eye / depth: depth").check()
    page.evaluate(f"{PLAYER}.seek(0.95)")
    figure = f"{PLAYER}.images.figure('eye/depth/depth')"
    page.wait_for_function(f"() => Math.abs({figure}.time - 0.8) < 1e-6")
    page.evaluate(f"{PLAYER}.seek(0.41)")
    page.wait_for_function(f"() => Math.abs({figure}.time - 0.4) < 1e-6")
    before = page.evaluate(f"{figure}.drawn")
    page.evaluate(f"{PLAYER}.seek(0.45)")
    assert page.evaluate(f"{figure}.drawn") == before  # the same image is not drawn again
    page.get_by_role("button", name="Close: eye / depth: depth").click()
    assert not page.get_by_label("eye / depth: depth").is_checked()
    context.close()
    assert faults == []


def test_too_many_images_are_refused(episode, tmp_path, monkeypatch):
    monkeypatch.setattr(player_file, "LARGEST", 60_000)
    with pytest.raises(InputError, match="too long for one file"):
        write_player(episode, tmp_path / "seen.html", images=True)
    assert not (tmp_path / "seen.html").exists()


def test_a_page_holds_images_by_choice(episode, tmp_path, monkeypatch):
    monkeypatch.setattr(player_file, "encode_image", None)
    assert write_player(episode, tmp_path / "seen.html").frames == 16
    assert "image/0/0" not in (tmp_path / "seen.html").read_text(encoding="utf-8")
