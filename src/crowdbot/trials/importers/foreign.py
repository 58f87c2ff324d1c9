"""Import of a trial from another simulator; the kind of file is detected."""

from __future__ import annotations

from collections.abc import Callable, Collection
from pathlib import Path

from crowdbot.core import TrialError
from crowdbot.trials.xml.trial_text import parse_trial_xml, read_trial_bytes

from .arena import import_arena, is_arena
from .building import import_building, is_building
from .dxf import import_dxf, is_dxf
from .foreign_text import json_of, yaml_of
from .gazebo import import_gazebo
from .hunavsim import import_hunavsim
from .irsim import import_irsim, is_irsim
from .jupedsim import import_jupedsim
from .menge import import_menge
from .original import ImportedTrial, import_original
from .pedsim import import_pedsim
from .umans import import_umans
from .vadere import import_vadere

XML_FILES: dict[str, Callable[[Path], ImportedTrial]] = {
    "Simulation": import_umans,
    "scenario": import_pedsim,
    "sdf": import_gazebo,
    "gazebo": import_gazebo,
    "geometry": import_jupedsim,
    "JuPedSim": import_jupedsim,
    "Project": import_menge,
    "Experiment": import_menge,
}
"""Importers of XML files by their root element."""


def import_trial(
    path: str | Path, root: str | Path | None = None, layers: Collection[str] = (), unit: str = ""
) -> ImportedTrial:
    """Read a file of another simulator, a drawing in DXF, or a building in glTF.

    Args:
        path: a Vadere scenario (JSON), a UMANS ``Simulation``, a pedsim ``scenario``, an agent file of HuNavSim
            (YAML), a world of IR-SIM (YAML), a scenario of Arena-Rosnav (JSON), a world of Gazebo (SDF), a project or
            geometry of JuPedSim (XML), a project or scene of Menge (XML), a drawing (ASCII DXF), a building
            (``.glb``), or as in :func:`import_original`.
        root: project folder of the CrowdBot simulator, see :func:`import_original`.
        layers, unit: layers and unit of a drawing, see :func:`import_dxf`.

    Raises:
        TrialError: the file is missing, malformed or of another kind.
    """
    path = Path(path)
    if is_building(path):
        if layers or unit:
            raise TrialError(f"{path}: layers and units belong to drawings in DXF, and this is none")
        return import_building(path)
    data = read_trial_bytes(path).lstrip(b"\xef\xbb\xbf \t\r\n")
    if is_dxf(data) or path.suffix.lower() == ".dxf":
        return import_dxf(path, layers, unit)
    if layers or unit:
        raise TrialError(f"{path}: layers and units belong to drawings in DXF, and this is none")
    if path.suffix.lower() in (".yaml", ".yml") or b"hunav_loader" in data[:10_000]:
        return import_irsim(path) if is_irsim(yaml_of(path)) else import_hunavsim(path)
    if data[:1] == b"{":
        return import_arena(path) if is_arena(json_of(path)) else import_vadere(path)
    if data[:1] == b"<":
        tag = parse_trial_xml(data, str(path)).tag
        if tag in XML_FILES:
            return XML_FILES[tag](path)
        if tag not in ("Trial", "Config"):
            raise TrialError(
                f"{path}: the root element <{tag[:40]}> is not known; files of UMANS have Simulation, of pedsim"
                " scenario, of Gazebo sdf, of JuPedSim JuPedSim or geometry, of Menge Project"
                " or Experiment, of the CrowdBot simulator Trial or Config"
            )
    return import_original(path, root=root)
