"""What tests share: where the real recordings and the reference steps of other engines lie."""

from __future__ import annotations

import os
from pathlib import Path

import pytest


def _shared(folder: str) -> Path:
    root = Path(os.environ.get("CROWDBOT_SHARED", Path(__file__).parents[2] / "shared"))
    path = root / folder
    if not path.is_dir():
        pytest.fail(
            f"{path} is missing: set CROWDBOT_SHARED to the folder that holds data/ and reference/", pytrace=False
        )
    return path


@pytest.fixture(scope="session")
def recordings() -> Path:
    """Folder of real pedestrian recordings in their original formats."""
    return _shared("data")


@pytest.fixture(scope="session")
def reference() -> Path:
    """Folder of reference steps of other crowd engines."""
    return _shared("reference")
