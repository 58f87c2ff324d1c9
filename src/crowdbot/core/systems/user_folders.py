"""Folders of the user, where each operating system expects them."""

from __future__ import annotations

import os
import sys
from pathlib import Path


def user_cache_folder() -> Path:
    """Return the folder of crowdbot for what can be computed anew.

    >>> user_cache_folder().name
    'crowdbot'
    """
    if sys.platform == "win32":
        folder = _local_data()
    elif sys.platform == "darwin":
        folder = Path.home() / "Library" / "Caches"
    else:
        folder = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache"))
    return folder / "crowdbot"


def user_data_folder() -> Path:
    """Return the folder of crowdbot for files that the user has put there.

    >>> user_data_folder().name
    'crowdbot'
    """
    if sys.platform == "win32":
        folder = _local_data()
    elif sys.platform == "darwin":
        folder = Path.home() / "Library" / "Application Support"
    else:
        folder = Path(os.environ.get("XDG_DATA_HOME", Path.home() / ".local" / "share"))
    return folder / "crowdbot"


def _local_data() -> Path:
    return Path(os.environ.get("LOCALAPPDATA", Path.home() / "AppData" / "Local"))
