"""What tests of robots share: where real URDF files lie."""

from __future__ import annotations

import os
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def urdf() -> Path:
    """Folder of URDF files of real robots."""
    path = Path(os.environ.get("CROWDBOT_SHARED", Path(__file__).parents[3] / "shared")) / "urdf"
    if not path.is_dir():
        pytest.fail(f"{path} is missing: set CROWDBOT_SHARED to the folder that holds urdf/", pytrace=False)
    return path
