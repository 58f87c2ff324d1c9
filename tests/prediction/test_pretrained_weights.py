"""Pretrained weights: every file has its hash; those outside the package are found, checked, or named as missing."""

import hashlib
import sys
from pathlib import Path

import pytest

from crowdbot.core import DataError
from crowdbot.prediction import pretrained_weights
from crowdbot.prediction.pretrained_weights import find_weights, weight_hashes, weights_folder

ASSETS = Path(pretrained_weights.__file__).parents[1] / "assets" / "predictors"


@pytest.fixture
def wheel(tmp_path, monkeypatch):
    """Make a package folder as the wheel has it, without leave-one-out weights, and a folder for them."""
    package, extra = tmp_path / "package", tmp_path / "weights"
    for name in ("SHA256SUMS", "anchor-net-open.npz"):
        (package / name).parent.mkdir(exist_ok=True)
        (package / name).write_bytes((ASSETS / name).read_bytes())
    extra.mkdir()
    monkeypatch.setattr(pretrained_weights, "_package_folder", lambda: package)
    monkeypatch.setenv("CROWDBOT_WEIGHTS", str(extra))
    return extra


def test_every_file_has_its_hash():
    files = {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in ASSETS.glob("*.npz")}
    assert files == weight_hashes()


def test_weights_of_the_package_come_first(wheel):
    (wheel / "anchor-net-open.npz").write_bytes(b"something else")
    assert find_weights("anchor-net", "open").parent.name == "package"


def test_weights_outside_the_package_are_found_and_checked(wheel):
    (wheel / "anchors-hotel.npz").write_bytes((ASSETS / "anchors-hotel.npz").read_bytes())
    assert find_weights("anchors", "hotel") == wheel / "anchors-hotel.npz"
    (wheel / "anchors-eth.npz").write_bytes((ASSETS / "anchors-hotel.npz").read_bytes())
    with pytest.raises(DataError, match=r"anchors-eth.npz has SHA-256 .*: it is damaged or of another version"):
        find_weights("anchors", "eth")


def test_missing_weights_are_named_in_a_sentence(wheel):
    with pytest.raises(DataError) as found:
        find_weights("anchor-net", "zara1")
    assert str(found.value) == (
        "anchor-net-zara1.npz is not installed, since the wheel has the default weights only: unpack"
        f" crowdbot-weights.zip of the release into {wheel}, or set CROWDBOT_WEIGHTS to a folder that has it"
    )


@pytest.mark.parametrize(
    ("platform", "variable", "end"),
    [
        ("linux", "XDG_DATA_HOME", "place/crowdbot/weights"),
        ("win32", "LOCALAPPDATA", "place/crowdbot/weights"),
        ("darwin", "HOME", "place/Library/Application Support/crowdbot/weights"),
    ],
)
def test_the_folder_of_each_system(monkeypatch, platform, variable, end):
    monkeypatch.delenv("CROWDBOT_WEIGHTS", raising=False)
    monkeypatch.setattr(sys, "platform", platform)
    monkeypatch.setenv(variable, "/place")
    assert weights_folder().as_posix() == f"/{end}"
