"""Images of a recorded episode show what happened, from the episode alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from crowdbot.cli import main
from crowdbot.core import InputError
from crowdbot.recording import branch, open_rerun, open_run
from crowdbot.rendering import RenderRequest, render_images
from crowdbot.simulation import AvatarOrder
from crowdbot.trials import parse_trial

TRIAL = """<trial name="hand" duration="0.6"><stage/><crowd type="orca"/>
<avatar name="guide" source="external" x="0" y="0" body="man-20"/>
<camera name="front" x="3" y="0" z="1.3" heading="3.14159" width="160" height="160"/></trial>"""


def episode(folder: Path, hand: tuple[float, ...] | None) -> Path:
    trial = parse_trial(TRIAL)
    with open_run(trial, out=folder) as running:
        while running.outcome is None:
            time = (running.simulation.tick + 1) * trial.step
            running.step([AvatarOrder(avatar="guide", time=time, x=0.0, y=0.0, right_hand=hand)])
    return folder / "episode.mcap"


def people(path: Path) -> np.ndarray:
    with open_rerun(path) as rerun:
        request = RenderRequest(0.5)
        (image,) = render_images(
            rerun.trial, "front", request, seed=rerun.seed, segmentation=True, sources=rerun.sources,
            prepare=rerun.prepare,
        )  # fmt: skip
    assert image.segmentation is not None
    return np.asarray(image.segmentation == 0)


def test_an_image_of_an_episode_shows_the_raised_hand(tmp_path: Path) -> None:
    down = people(episode(tmp_path / "down", None))
    up = people(episode(tmp_path / "up", (0.1, -0.25, 1.95, 0.7071, 0.0, -0.7071, 0.0)))
    top = np.flatnonzero(down.any(axis=1))[0]
    assert not down[:top].any()
    assert up[:top, :80].sum() > 20  # the right hand is above the head, on the left of an image from ahead
    assert not up[:top, 90:].any()


def test_the_command_draws_an_episode_but_does_not_change_it(tmp_path: Path) -> None:
    path = episode(tmp_path / "one", None)
    assert main(["render", str(path), "--camera", "front", "--at", "0.5", "--out", str(tmp_path / "one.png")]) == 0
    assert (tmp_path / "one.png").stat().st_size > 1000
    assert main(["render", str(path), "--seed", "3", "--out", str(tmp_path / "two.png")]) == 2
    branch(path, at=0.2, out=tmp_path / "branch")
    with pytest.raises(InputError, match="is a branch"), open_rerun(tmp_path / "branch" / "episode.mcap"):
        pass
