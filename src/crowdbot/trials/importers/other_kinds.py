"""What a file is that no importer reads, and what to do with it."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

AREA = 'a trial names it itself: <stage area="{name}"/>, see crowdbot new stage'
DRAWING = "export its walls as ASCII DXF and import that"
WKT = re.compile(rb"(?:SRID=\d+;)?\s*(?:MULTI)?(?:POINT|LINESTRING|POLYGON)\b|GEOMETRYCOLLECTION\b", re.IGNORECASE)
BEGINNINGS = (
    (
        re.compile(rb"ISO-10303-21;[\s\S]{0,4000}?IFC"),
        "is a building in IFC, which is not read; export it as binary glTF (.glb) or its floor plan as ASCII DXF, and"
        " import that",
    ),
    (re.compile(rb"ISO-10303-21"), f"is a STEP file, which is not read; {DRAWING}"),
    (re.compile(rb"AC10\d\d"), f"is a drawing in DWG, which is not read; {DRAWING}"),
    (re.compile(rb"%PDF"), f"is a PDF document, which is not read; {DRAWING}"),
    (re.compile(rb"PK\x03\x04"), "is a zip archive (or an Office file); unpack it and import the scene in it"),
    (re.compile(rb"SQLite format 3|\x89HDF|PAR1|\x89MCAP|#ROSBAG"), "{recording}"),
    (re.compile(rb"glTF"), "is binary glTF; name it .glb"),
    (re.compile(rb"\x89PNG|\xff\xd8\xff|P[1-6]\s|BM"), "{picture}"),
    (re.compile(rb"BLENDER|Kaydara FBX"), "is a 3D scene of an editor; export it as binary glTF (.glb)"),
    (re.compile(rb"#usda|PXR-USDC"), "is a scene in USD, which is not read; export it as binary glTF (.glb)"),
    (re.compile(rb"solid\b[^\n]*\n\s*facet\b"), "is a mesh in STL; export it as binary glTF (.glb) and import that"),
    (
        re.compile(rb"(?:[ \t]*(?:#[^\n]*)?\n)*(?:mtllib|[ogv])[ \t][^\n]*\n[ \t]*(?:usemtl|[ogsvf]|v[nt])[ \t]"),
        "is a mesh in OBJ; export it as binary glTF (.glb) and import that",
    ),
    (
        re.compile(rb"ply\r?\n|(?:#[^\n]*\n)*VERSION [^\n]*\nFIELDS "),
        "is a cloud of points or a mesh (PLY, PCD), which is not read; give its walls as a map of ROS, as ASCII DXF or"
        " as binary glTF (.glb)",
    ),
)  # fmt: skip
RECORDING = (
    "is probably a recording of people, not a scene: read it by crowdbot predict --data, or make a trial of it by"
    " crowdbot new trial FILE --recorded"
)
PICTURE = 'is a picture; a map of ROS is its .yaml beside it, which a trial names itself: <stage map="map.yaml"/>'
ROOTS = {
    "svg": f"is a drawing in SVG, which is not read; {DRAWING}",
    "osm": "is a map of OpenStreetMap, which is not read; write the free area as GeoJSON in metres, and "
    "<stage area=\"...\"/> names it",
    "robot": "is a robot in URDF; convert it by crowdbot new robot",
    "COLLADA": "is a mesh in COLLADA; export it as binary glTF (.glb) and import that",
    "kml": "is a map in KML, which is not read; write the free area as GeoJSON in metres",
    "launch": "is a launch file of ROS; import the world that it names",
    "html": "is a web page, perhaps about the file; download the file itself",
    "trial": "is a trial of crowdbot already; copy it by crowdbot new trial FILE --from",
    "mujoco": "is a model of MuJoCo, which is not read; a robot needs URDF or SDF, a scene a world of Gazebo or IR-SIM",
    "JPSreport": "is the settings of JPSreport; import the geometry that it names",
    "routing": "is a routing file of JuPedSim; import its project or geometry",
}  # fmt: skip
"""Root elements of XML files that no importer reads."""
KINDS = (
    "scenes are imported from Vadere, Arena-Rosnav and the JuPedSim editor (JSON), HuNavSim and IR-SIM (YAML), UMANS,"
    " pedsim, Gazebo, JuPedSim and Menge (XML), drawings in ASCII DXF, buildings in binary glTF (.glb), and trials and"
    " orders of the CrowdBot simulator"
)
TRIAL_NAME = re.compile(r"[^;,<>]*\.xml\s*(?:[;,]|$)", re.IGNORECASE)
"""The first line of an order of the CrowdBot simulator: a file of a trial, and perhaps more columns."""
MOST_KEYS = 8
JSON = re.compile(rb"\{\s*(?:[\"}]|//|$)|\[\s*(?:[\"{\[\]\d+-]|//|$|true\b|false\b|null\b)")
NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")


def describe_binary(path: Path, data: bytes) -> str:
    """Return what a file is by its beginning, after its path; empty if its kind is not known."""
    for beginning, what in BEGINNINGS:
        if beginning.match(data[:5000]):
            return what.format(recording=RECORDING, picture=PICTURE)
    if WKT.match(data):
        return f"is a walkable area in WKT; {AREA.format(name=path.name)}"
    lines = [line for line in data[:4000].decode("latin-1").splitlines()[:20] if line.strip()]
    return RECORDING if any(map(_is_row, lines[:10])) else ""


def _is_row(line: str) -> bool:
    """Whether a line has three numbers or more, as tables of positions have."""
    words = re.split(r"[\s,;]+", line.strip())
    return len(words) > 2 and sum(NUMBER.fullmatch(word) is not None for word in words) > 2


def describe_text(data: bytes) -> str:
    """Return that a file is of no kind that is imported; empty if it can be an order of the CrowdBot simulator."""
    lines = [line.strip() for line in data[:65_536].decode("utf-8", "replace").splitlines() if line.strip()]
    if lines and TRIAL_NAME.match(lines[0]):
        return ""
    begins = f"begins with {lines[0][:30]!r}" if lines else "is empty"
    return f"is of no kind that is imported, it {begins}; {KINDS}"


def is_json_text(data: bytes) -> bool:
    """Whether a text begins as JSON does, unlike the sections of TOML and INI files or the templates of Jinja.

    >>> is_json_text(b'{"scenario": 1}'), is_json_text(b"[1, 2]"), is_json_text(b"[project]"), is_json_text(b"{% if %}")
    (True, True, False, False)
    """
    return JSON.match(data) is not None


def describe_xml(root: str) -> str:
    """Return what an XML file with this root element is; empty if it is not known."""
    return ROOTS.get(root, "")


def describe_json(path: Path, content: Any) -> str:
    """Return what a JSON or YAML file is that is no scene; empty if it can be one."""
    if not isinstance(content, dict):
        return ""
    keys = set(content)
    if content.get("type") in ("FeatureCollection", "Feature", "GeometryCollection", "Polygon", "MultiPolygon"):
        return f"is an area in GeoJSON; {AREA.format(name=path.name)}"
    if {"image", "resolution"} <= keys:
        return f'is a map of ROS; a trial names it itself: <stage map="{path.name}"/>'
    if {"asset", "scenes"} <= keys or {"asset", "meshes"} <= keys:
        return "is glTF as text; export it as binary glTF (.glb) and import that"
    if {"type", "CityObjects"} <= keys:
        return "is a city model in CityJSON, which is not read; write the free area as GeoJSON in metres"
    return ""


def keys_of(content: Any) -> str:
    """The first keys of the content of a file, for a message."""
    if not isinstance(content, dict):
        return f"it is a {'list' if isinstance(content, list) else 'single value'}"
    names = [json.dumps(str(key)[:30]) for key in list(content)[:MOST_KEYS]]
    return f"it has {', '.join(names)}" if names else "it is empty"
