"""Import of a trial from another simulator; the kind of file is detected."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection
from pathlib import Path

from crowdbot.core import TrialError
from crowdbot.trials.xml.trial_text import read_trial_bytes

from .arena import import_arena, is_arena
from .building import import_building, is_building
from .clear_places import clear_places
from .dxf import import_dxf, is_dxf
from .foreign_text import json_of, xml_of, yaml_of
from .gazebo import import_gazebo
from .hunavsim import import_hunavsim
from .irsim import import_irsim, is_irsim
from .jupedsim import import_jupedsim
from .jupedsim_editor import import_jupedsim_editor, is_editor
from .menge import import_menge
from .original import ImportedTrial, import_original
from .other_kinds import describe_binary, describe_json, describe_text, describe_xml, is_json_text, keys_of
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
XML_ROOT = re.compile(rb"<([A-Za-z_][A-Za-z0-9_]{0,40})[\s/>]")


def import_trial(
    path: str | Path, root: str | Path | None = None, layers: Collection[str] = (), unit: str = ""
) -> ImportedTrial:
    """Read a file of another simulator, a drawing in DXF, or a building in glTF.

    Args:
        path: a Vadere scenario (JSON), a UMANS ``Simulation``, a pedsim ``scenario``, an agent file of HuNavSim
            (YAML), a world of IR-SIM (YAML), a scenario of Arena-Rosnav or of the JuPedSim editor (JSON), a world of
            Gazebo (SDF), a project or geometry of JuPedSim (XML), a project or scene of Menge (XML), a drawing (ASCII
            DXF), a building (``.glb``), or as in :func:`import_original`.
        root: project folder of the CrowdBot simulator, see :func:`import_original`.
        layers, unit: layers and unit of a drawing, see :func:`import_dxf`.

    People, robots and zones without room are moved, cut or left out, see :mod:`.clear_places`.

    Raises:
        TrialError: the file is missing, malformed or of another kind.
    """
    done = _import(Path(path), root, layers, unit)
    notes = dict.fromkeys(done.left_out)
    trials = [(name, clear_places(trial, lambda note: notes.update({note: None}))) for name, trial in done.trials]
    return ImportedTrial(tuple(trials), tuple(notes))


def _import(path: Path, root: str | Path | None, layers: Collection[str], unit: str) -> ImportedTrial:
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
        return _import_yaml(path)
    if is_json_text(data) or path.suffix.lower() == ".json":
        return _import_json(path)
    if data[:1] == b"<":
        tag = _root_of(path, data)
        if tag in XML_FILES:
            return XML_FILES[tag](path)
        if tag not in ("Trial", "Config"):
            _refuse(path, describe_xml(tag))
            raise TrialError(
                f"{path}: the root element <{tag[:40]}> is not known; files of UMANS have Simulation, of pedsim"
                " scenario, of Gazebo sdf, of JuPedSim JuPedSim or geometry, of Menge Project"
                " or Experiment, of the CrowdBot simulator Trial or Config"
            )
    _refuse(path, describe_binary(path, data))
    if data[:1] != b"<":
        _refuse(path, describe_text(data))
    return import_original(path, root=root)


def _import_yaml(path: Path) -> ImportedTrial:
    content = yaml_of(path)
    if is_irsim(content):
        return import_irsim(path)
    _refuse(path, describe_json(path, content))
    if isinstance(content, dict) and "hunav_loader" not in content:
        raise TrialError(
            f"{path} is not a YAML scene that can be imported, {keys_of(content)}; files of HuNavSim have hunav_loader"
            " with ros__parameters, worlds of IR-SIM have world and obstacle"
        )
    return import_hunavsim(path)


def _import_json(path: Path) -> ImportedTrial:
    content = json_of(path)
    if is_arena(content):
        return import_arena(path)
    if is_editor(content):
        return import_jupedsim_editor(path)
    _refuse(path, describe_json(path, content))
    if not isinstance(content, dict) or not {"scenario", "topography"} & set(content):
        raise TrialError(
            f"{path} is not a JSON scene that can be imported, {keys_of(content)}; scenarios of Vadere have scenario"
            " with topography, those of Arena-Rosnav have obstacles and robots, those of the JuPedSim editor"
            " distributions and exits"
        )
    return import_vadere(path)


def _root_of(path: Path, data: bytes) -> str:
    """Root element of an XML file; drawings with a DOCTYPE are named before it is refused."""
    try:
        return xml_of(path).tag
    except TrialError:
        first = XML_ROOT.search(data[:5000])
        _refuse(path, describe_xml(first[1].decode()) if first else "")
        raise


def _refuse(path: Path, why: str) -> None:
    """Raise :class:`TrialError` if the kind of the file is known."""
    if why:
        raise TrialError(f"{path} {why}")
