"""What tests share: where the real recordings and reference steps lie, and how properties are searched.

Property tests draw the same examples every time, so that a run can be trusted and repeated; ``HUNT=1`` draws new ones.
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from hypothesis import settings

settings.register_profile("same", derandomize=True, deadline=None)
settings.register_profile("hunt", deadline=None)
settings.load_profile("hunt" if os.environ.get("HUNT") else "same")


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
