"""Import of a trial from another simulator; the kind of file is detected."""

from __future__ import annotations

from pathlib import Path

from crowdbot.core import TrialError
from crowdbot.trials.xml.trial_text import parse_trial_xml, read_trial_bytes

from .original import ImportedTrial, import_original
from .pedsim import import_pedsim
from .umans import import_umans
from .vadere import import_vadere

__all__ = ["import_trial"]


def import_trial(path: str | Path, root: str | Path | None = None) -> ImportedTrial:
    """Read a file of Vadere, UMANS, pedsim_ros or the CrowdBot simulator of 2021.

    Args:
        path: a Vadere scenario (JSON), a UMANS ``Simulation``, a pedsim ``scenario``, or as in :func:`import_original`.
        root: project folder of the CrowdBot simulator, see :func:`import_original`.

    Raises:
        TrialError: the file is missing, malformed or of another kind.
    """
    path = Path(path)
    data = read_trial_bytes(path).lstrip(b"\xef\xbb\xbf \t\r\n")
    if data[:1] == b"{":
        return import_vadere(path)
    if data[:1] == b"<":
        tag = parse_trial_xml(data, str(path)).tag
        if tag in ("Simulation", "scenario"):
            return import_umans(path) if tag == "Simulation" else import_pedsim(path)
        if tag not in ("Trial", "Config"):
            raise TrialError(
                f"{path}: the root element <{tag[:40]}> is not known; files of UMANS have Simulation, of pedsim"
                " scenario, of the CrowdBot simulator Trial or Config"
            )
    return import_original(path, root=root)
