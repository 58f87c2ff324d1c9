"""The command that trains the default weights: a mixture without the sources left out, resumable, and reproducible."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from crowdbot.prediction.anchor_net.own_weights import wrong_array
from crowdbot.prediction.pretrained_weights import read_weights

TOOL = Path(__file__).parents[2] / "studies" / "train_anchor_net.py"


@pytest.fixture
def tool(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """Load the tool with few simulated scenes."""
    spec = importlib.util.spec_from_file_location("train_anchor_net", TOOL)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    monkeypatch.setattr(module, "CROWDS", 1)
    monkeypatch.setattr(module, "MEETINGS", 2)
    monkeypatch.setitem(module.SOURCES, "simulated", 300)
    return module


def test_the_default_weights_come_from_one_command(
    tool: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["--fold", "open", "--updates", "2", "--leave-out", "ucy", "hermes", "juelich"]
    found = []
    for name in ("one", "other"):
        out = tmp_path / name
        monkeypatch.setattr(sys, "argv", ["train_anchor_net.py", "train", str(tmp_path), str(out), *words])
        tool.main()
        found.append(read_weights(out / "anchor-net-open.npz"))
        assert read_weights(out / "anchors-open.npz")["shapes"].shape == (20, 12, 2)
    said = capsys.readouterr().out
    assert "simulated, train: 3" in said
    assert "robots, train: " in said
    assert "ucy" not in said
    assert wrong_array(found[0]) == ""
    assert {"reach", "line_share", "share"} <= set(found[0])
    assert all(np.array_equal(found[0][name], found[1][name]) for name in found[0])
    tool.main()
    assert "anchor-net-open.npz is there already" in capsys.readouterr().out
