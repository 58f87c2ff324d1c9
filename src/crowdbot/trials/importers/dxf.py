"""Stages from drawings in DXF (ASCII): lines, polylines, arcs and circles become thin walls, also those in blocks.

The format is that of the AutoCAD DXF reference: pairs of lines with a group code and a value. Entities of the model
space are read, in the unit of ``$INSUNITS``.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np

from crowdbot.core import TrialError
from crowdbot.core.fields import Points
from crowdbot.models import ORCA
from crowdbot.trials.stage import Stage, Wall
from crowdbot.trials.trial import End, Trial
from crowdbot.trials.validation.rates import LARGEST_EXTENT, SMALLEST_EXTENT, size_text

from .original import ImportedTrial

Ring = tuple[tuple[float, float], ...]

DEVIATION = 0.01
"""Largest distance [m] between an arc and its chords."""
MOST_CHORDS = 512
LEAST_CHORDS = 8
"""Number of chords of a full circle."""


def arc_points(
    center: tuple[float, float], radius: float, begin: float, end: float, unit: float
) -> list[tuple[float, float]]:
    """Return points of an arc from one angle counter-clockwise to another [deg]; equal angles are a full circle.

    Args:
        center, radius: in the unit of the drawing.
        begin, end: angles.
        unit: unit of the drawing [m].

    >>> [(round(x, 3), round(y, 3)) for x, y in arc_points((0.0, 0.0), 0.1, 0.0, 90.0, 1.0)]
    [(0.1, 0.0), (0.071, 0.071), (0.0, 0.1)]
    """
    begin = math.radians(math.fmod(begin, 360.0))
    angle = math.fmod(math.radians(math.fmod(end, 360.0)) - begin, 2.0 * math.pi)
    angle = angle if angle > 1e-9 else angle + 2.0 * math.pi
    return _chords(center, radius, begin, angle, unit)


def bulge_points(rows: Sequence[tuple[float, float, float]], closed: bool, unit: float) -> list[tuple[float, float]]:
    """Return points of a polyline with vertices x, y and bulge, the tangent of a quarter of the angle to the next.

    >>> [(round(x, 2), round(y, 2)) for x, y in bulge_points([(0, 0, 1.0), (0.2, 0, 0.0)], False, 1.0)]
    [(0, 0), (0.03, -0.07), (0.1, -0.1), (0.17, -0.07), (0.2, 0)]
    """
    if not rows:
        return []
    ends = [*rows[1:], rows[0]] if closed else rows[1:]
    found = [rows[0][:2]]
    for (x, y, bulge), (u, v, _) in zip(rows, ends, strict=False):
        chord = math.hypot(u - x, v - y)
        if abs(bulge) > 1e-9 and chord > 0.0:
            angle = 4.0 * math.atan(bulge)
            far = 0.25 * chord * (1.0 / bulge - bulge)  # of the centre, to the left of the chord
            center = (0.5 * (x + u) - far * (v - y) / chord, 0.5 * (y + v) + far * (u - x) / chord)
            radius = 0.25 * chord * (abs(bulge) + 1.0 / abs(bulge))
            begin = math.atan2(y - center[1], x - center[0])
            found += _chords(center, radius, begin, angle, unit)[1:-1]
        found.append((u, v))
    return found


def _chords(
    center: tuple[float, float], radius: float, begin: float, angle: float, unit: float
) -> list[tuple[float, float]]:
    size = max(radius * unit, 1e-9)
    widest = 2.0 * math.acos(max(-1.0, 1.0 - DEVIATION / size)) if size > DEVIATION else math.pi
    widest = min(2.0 * math.pi / LEAST_CHORDS, max(2.0 * math.pi / MOST_CHORDS, widest))
    count = max(1, math.ceil(abs(angle) / widest - 1e-9))
    turns = [begin + angle * k / count for k in range(count + 1)]
    return [(center[0] + radius * math.cos(turn), center[1] + radius * math.sin(turn)) for turn in turns]


MOST_BYTES = 64_000_000
MOST_ENTITIES = 50_000
MOST_WALLS = 10_000
MOST_CORNERS = 200_000
MOST_DEPTH = 16
"""Levels of blocks in blocks."""
MOST_INSERTED = 200_000
"""Largest number of entities with those of blocks, each time that a block is inserted."""
FARTHEST = 1e6
UNITS = {"in": 0.0254, "ft": 0.3048, "mm": 0.001, "cm": 0.01, "m": 1.0, "km": 1000.0}
"""Units by name [m]."""
INSUNITS = {1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m", 7: "km"}
"""Units by the number in ``$INSUNITS``."""
LIKELY_UNITS = ("m", "mm", "cm", "in", "ft")
"""Units that are tried for a drawing of implausible size, the likely ones first."""
KINDS = ("LINE", "LWPOLYLINE", "POLYLINE", "ARC", "CIRCLE")
PARTS = ("VERTEX", "SEQEND")


class DxfGroup(NamedTuple):
    """A group code with its value."""

    code: int
    value: str
    line: int


@dataclass
class DxfEntity:
    """An entity or a table entry: its kind, its groups, and the vertices of a polyline."""

    kind: str
    line: int
    groups: list[DxfGroup] = field(default_factory=list)
    vertices: list[DxfEntity] = field(default_factory=list)

    def text(self, code: int, otherwise: str = "") -> str:
        """Return the first value of a group code."""
        return next((group.value.strip() for group in self.groups if group.code == code), otherwise)


class BlockPlacement(NamedTuple):
    """Map ``x' = a x + c y + e``, ``y' = b x + d y + f`` from the coordinates of a block to those of the drawing."""

    a: float = 1.0
    b: float = 0.0
    c: float = 0.0
    d: float = 1.0
    e: float = 0.0
    f: float = 0.0

    def of(self, x: float, y: float) -> tuple[float, float]:
        """A point of the block in the drawing.

        >>> BlockPlacement(e=2.0).of(1.0, 5.0)
        (3.0, 5.0)
        """
        return self.a * x + self.c * y + self.e, self.b * x + self.d * y + self.f

    def after(self, inner: BlockPlacement) -> BlockPlacement:
        """The map of a block that is inserted by ``inner`` into the block of this map."""
        (a, b), (c, d) = ((self.a * u + self.c * v, self.b * u + self.d * v) for u, v in (inner[:2], inner[2:4]))
        return BlockPlacement(a, b, c, d, *self.of(inner.e, inner.f))

    @property
    def stretch(self) -> float:
        """Largest factor by which it lengthens a unit vector along an axis."""
        return max(math.hypot(self.a, self.b), math.hypot(self.c, self.d))


class PlacedEntity(NamedTuple):
    """An entity with its layer and the map of the block that it is in."""

    entity: DxfEntity
    layer: str
    placement: BlockPlacement


def is_dxf(data: bytes) -> bool:
    """Return whether a file begins as a DXF file.

    >>> is_dxf(b"  0\\r\\nSECTION\\r\\n"), is_dxf(b"<trial/>")
    (True, False)
    """
    if data.startswith(b"AutoCAD Binary DXF"):
        return True
    words = data[:2000].split(b"\n")
    while len(words) >= 2 and words[0].strip() == b"999":  # comments
        words = words[2:]
    return len(words) >= 2 and words[0].strip() == b"0" and words[1].strip() == b"SECTION"


def import_dxf(path: str | Path, layers: Collection[str] = (), unit: str = "") -> ImportedTrial:
    """Read the walls of a drawing into the stage of a trial without people.

    Args:
        path: the file, ASCII.
        layers: names of the layers to read (default: all that are on and not frozen).
        unit: unit of the drawing, one of :data:`UNITS` (default: from the file, or metres).

    Raises:
        TrialError: the file is missing, malformed, binary or too large, a layer or unit does not exist, or no wall is
            left.
    """
    path = Path(path)
    reader = _Reader(path, _read(path), unit)
    return ImportedTrial(((path.stem, reader.trial(layers)),), tuple(reader.notes))


def _read(path: Path) -> list[DxfGroup]:
    if not path.is_file():
        raise TrialError(f"there is no DXF file {path}")
    try:
        with path.open("rb") as stream:
            data = stream.read(MOST_BYTES + 1)
    except OSError as error:
        raise TrialError(f"{path} cannot be read: {error.strerror}") from None
    if len(data) > MOST_BYTES:
        raise TrialError(f"{path} is larger than {MOST_BYTES} bytes, the limit of a DXF file")
    if data.startswith(b"AutoCAD Binary DXF"):
        raise TrialError(f"{path} is a binary DXF file; save it as ASCII DXF")
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError:
        text = data.decode("cp1252", errors="replace")
    return list(_groups(path, text.replace("\r\n", "\n").split("\n")))


def _groups(path: Path, lines: Sequence[str]) -> Iterator[DxfGroup]:
    for k in range(0, len(lines) - 1, 2):
        try:
            code = int(lines[k])
        except ValueError:
            raise TrialError(f"{path}:{k + 1}: {lines[k].strip()[:40]!r} is not a group code of DXF") from None
        if code == 0 and lines[k + 1].strip() == "EOF":
            return
        yield DxfGroup(code, lines[k + 1], k + 2)
    raise TrialError(f"{path} ends without EOF: it is not a complete DXF file")


class _Reader:
    """Converts a drawing, and notes what is not imported."""

    def __init__(self, path: Path, groups: list[DxfGroup], unit: str) -> None:
        self.path = path
        self.notes: dict[str, None] = {}
        sections = _sections(path, groups)
        self.entities = _entities(path, sections.get("ENTITIES", []))
        self.blocks = _blocks(_entities(path, sections.get("BLOCKS", [])))
        self.inserted = 0
        tables = _entities(path, sections.get("TABLES", []))
        self.hidden = {table.text(2) for table in tables if table.kind == "LAYER" and self._is_hidden(table)}
        self.scale = self._unit(sections.get("HEADER", []), unit)
        self.corners = 0

    def trial(self, layers: Collection[str]) -> Trial:
        """Return the trial."""
        shapes = list(self._placed(self.entities, "", BlockPlacement(), 0))
        known = sorted({shape.layer for shape in shapes if shape.entity.kind in KINDS})
        for layer in layers:
            if layer not in known:
                some = ", ".join(known[:20]) or "none"
                raise TrialError(f"{self.path}: there is no layer {layer[:40]!r} with walls; layers are {some}")
        chosen = set(layers) or set(known) - self.hidden
        for layer in known:
            if layer not in chosen:
                why = "off or frozen" if layer in self.hidden and not layers else "not chosen"
                self.notes[f"layer {layer[:60]}: {why}"] = None
        rings: dict[Ring, None] = {}
        for shape in shapes:
            if shape.entity.kind not in KINDS:
                self.notes[f"entities {shape.entity.kind[:40]} are not imported"] = None
            elif shape.layer in chosen:
                ring = self._ring(shape)
                rings |= dict.fromkeys([ring] if len(set(ring)) > 1 else [])
        if not rings:
            raise TrialError(f"{self.path}: there are no lines, polylines, arcs or circles on the layers to read")
        if len(rings) > MOST_WALLS:
            raise TrialError(
                f"{self.path}: {len(rings)} walls are more than {MOST_WALLS}; choose layers: {', '.join(known[:20])}"
            )
        self._note_size(rings)
        self.notes["people and robots are not in the file: the trial has only the stage"] = None
        return Trial(
            name=(self.path.stem.strip() or "imported")[:80],
            about="Imported from DXF.",
            duration=60.0,
            stage=Stage(walls=tuple(Wall(Points.of(ring)) for ring in rings)),
            crowd=ORCA(),
            end=End(goal=False, collision=False),
        )

    def _placed(
        self, entities: Sequence[DxfEntity], layer: str, placement: BlockPlacement, depth: int
    ) -> Iterator[PlacedEntity]:
        """Yield the entities of the model space with those of the blocks that are inserted.

        Args:
            entities: of the drawing, or of a block.
            layer: layer of the block, which entities of a block on layer 0 have.
            placement: of the block.
            depth: levels of blocks.
        """
        for entity in entities:
            if depth == 0 and entity.text(67, "0") != "0":
                continue  # paper space
            own = entity.text(8, "0")
            own = layer if layer and own == "0" else own
            self._count(entity)
            if entity.kind != "INSERT":
                yield PlacedEntity(entity, own, placement)
                continue
            name = entity.text(2)
            block = self.blocks.get(name)
            if block is None or int(self._value(block[0], 70, 0.0)) & 4:
                why = "is not in the file" if block is None else "is in another file"
                self.notes[f"the block {name[:60]!r} {why} and is left out"] = None
                continue
            if depth >= MOST_DEPTH:
                raise TrialError(f"{self.path}:{entity.line}: blocks are nested more than {MOST_DEPTH} levels deep")
            for inner in self._insertions(entity, block[0]):
                self._count(entity)  # copies of an empty block take time, too
                yield from self._placed(block[1], own, placement.after(inner), depth + 1)

    def _count(self, entity: DxfEntity) -> None:
        self.inserted += 1
        if self.inserted > MOST_INSERTED:
            raise TrialError(
                f"{self.path}:{entity.line}: more than {MOST_INSERTED} entities with those of blocks are too many"
            )

    def _insertions(self, insert: DxfEntity, block: DxfEntity) -> Iterator[BlockPlacement]:
        """Yield the map of each copy of a block; none if it is not horizontal."""
        side = self._side(insert)
        if side == 0.0:
            return
        scale_x, scale_y = self._value(insert, 41, 1.0), self._value(insert, 42, 1.0)
        turn = math.radians(math.fmod(self._value(insert, 50, 0.0), 360.0))
        x, y = self._value(insert, 10), self._value(insert, 20)
        base_x, base_y = self._value(block, 10, 0.0), self._value(block, 20, 0.0)
        columns, rows = (max(1, int(self._value(insert, code, 1.0))) for code in (70, 71))
        if columns * rows > MOST_ENTITIES:
            raise TrialError(f"{self.path}:{insert.line}: {columns * rows} copies of a block are too many")
        cos, sin = math.cos(turn), math.sin(turn)
        for row, column in itertools.product(range(rows), range(columns)):
            u = column * self._value(insert, 44, 0.0) - scale_x * base_x
            v = row * self._value(insert, 45, 0.0) - scale_y * base_y
            yield BlockPlacement(
                side * cos * scale_x, sin * scale_x, -side * sin * scale_y, cos * scale_y,
                side * (x + cos * u - sin * v), y + sin * u + cos * v,
            )  # fmt: skip

    def _note_size(self, rings: Collection[Ring]) -> None:
        """Note a size that no hall has: editors often leave a unit in the header that is not that of the drawing."""
        corners = np.concatenate([np.array(ring) for ring in rings])
        width, height = np.ptp(corners, axis=0)
        longest = max(width, height)
        if SMALLEST_EXTENT <= longest <= LARGEST_EXTENT:
            return
        unit = next(name for name, size in UNITS.items() if size == self.scale)
        sentence = f"the drawing is {size_text(width, height)} in the unit {unit}, which may be wrong"
        for other in LIKELY_UNITS:
            ratio = UNITS[other] / self.scale
            if SMALLEST_EXTENT <= longest * ratio <= LARGEST_EXTENT:
                sentence += f"; with --unit {other} it is {size_text(width * ratio, height * ratio)}"
                break
        self.notes[sentence] = None

    def _unit(self, header: list[DxfGroup], unit: str) -> float:
        """Return the unit of the drawing [m]."""
        if unit:
            if unit not in UNITS:
                raise TrialError(f"the unit {unit[:20]!r} is unknown; units are {', '.join(UNITS)}")
            return UNITS[unit]
        for name, value in itertools.pairwise(header):
            if name.code == 9 and name.value.strip() == "$INSUNITS":
                number = int(self._number(value))
                if number in INSUNITS:
                    return UNITS[INSUNITS[number]]
                if number != 0:
                    raise TrialError(f"{self.path}: the unit $INSUNITS = {number} is not supported; give the unit")
        self.notes["the file has no unit: coordinates are metres"] = None
        return 1.0

    def _is_hidden(self, layer: DxfEntity) -> bool:
        flags, color = (next((g for g in layer.groups if g.code == code), None) for code in (70, 62))
        frozen = flags is not None and int(self._number(flags)) & 1
        return bool(frozen) or (color is not None and self._number(color) < 0.0)

    def _ring(self, placed: PlacedEntity) -> Ring:
        """Return the points of an entity [m]; a closed one ends at its first point. Empty if it cannot be a wall."""
        one, unit = placed.entity, self.scale * placed.placement.stretch
        if one.kind == "LINE":
            points = [(self._value(one, 10), self._value(one, 20)), (self._value(one, 11), self._value(one, 21))]
            return self._points(placed, points, 1.0)
        side = self._side(one)
        if side == 0.0:
            return ()
        if one.kind in ("LWPOLYLINE", "POLYLINE"):
            return self._points(placed, self._polyline(one, unit), side)
        center, radius = (self._value(one, 10), self._value(one, 20)), self._value(one, 40)
        if radius <= 0.0:
            raise TrialError(f"{self.path}:{one.line}: the radius {radius:g} of {one.kind} must be above 0")
        begin, end = (0.0, 360.0) if one.kind == "CIRCLE" else (self._value(one, 50), self._value(one, 51))
        return self._points(placed, arc_points(center, radius, begin, end, unit), side)

    def _polyline(self, dxf_entity: DxfEntity, unit: float) -> list[tuple[float, float]]:
        """Return the points of a polyline, with arcs for its bulges."""
        flags = int(self._value(dxf_entity, 70, 0.0))
        if dxf_entity.kind == "POLYLINE":
            if flags & (16 | 64):
                self.notes["polygon meshes are not imported"] = None
                return []
            spots = [part for part in dxf_entity.vertices if not int(self._value(part, 70, 0.0)) & 16]
            rows = [(self._value(part, 10), self._value(part, 20), self._value(part, 42, 0.0)) for part in spots]
        else:
            rows = []
            for group in dxf_entity.groups:
                if group.code == 10:
                    rows.append((self._number(group), 0.0, 0.0))
                elif group.code in (20, 42) and rows:
                    x, y, bulge = rows[-1]
                    value = self._number(group)
                    rows[-1] = (x, value, bulge) if group.code == 20 else (x, y, value)
        return bulge_points(rows, bool(flags & 1), unit)

    def _side(self, dxf_entity: DxfEntity) -> float:
        """Return 1, -1 for an entity that is drawn from below, 0 for one that is not horizontal."""
        x, y, z = (self._value(dxf_entity, code, otherwise) for code, otherwise in ((210, 0.0), (220, 0.0), (230, 1.0)))
        if abs(x) > 1e-6 or abs(y) > 1e-6:
            self.notes["entities that are not horizontal are not imported"] = None
            return 0.0
        return -1.0 if z < 0.0 else 1.0

    def _points(self, placed: PlacedEntity, points: Sequence[tuple[float, float]], side: float) -> Ring:
        one, found = placed.entity, list[tuple[float, float]]()
        for u, v in points:
            x, y = placed.placement.of(side * u, v)
            spot = (round(x * self.scale, 6), round(y * self.scale, 6))
            if not max(abs(spot[0]), abs(spot[1])) <= FARTHEST:
                raise TrialError(f"{self.path}:{one.line}: {one.kind} is more than {FARTHEST:g} m from the origin")
            if not found or found[-1] != spot:
                found.append(spot)
        self.corners += len(found)
        if self.corners > MOST_CORNERS:
            raise TrialError(f"{self.path}: the walls have more than {MOST_CORNERS} corners; choose layers")
        return tuple(found)

    def _value(self, dxf_entity: DxfEntity, code: int, otherwise: float | None = None) -> float:
        group = next((group for group in dxf_entity.groups if group.code == code), None)
        if group is None:
            if otherwise is None:
                raise TrialError(f"{self.path}:{dxf_entity.line}: {dxf_entity.kind} lacks the group {code}")
            return otherwise
        return self._number(group)

    def _number(self, group: DxfGroup) -> float:
        try:
            value = float(group.value)
        except ValueError:
            value = math.nan
        if not abs(value) < 1e300 or "_" in group.value:
            raise TrialError(f"{self.path}:{group.line}: {group.value.strip()[:40]!r} is not a finite number")
        return value


def _sections(path: Path, groups: list[DxfGroup]) -> dict[str, list[DxfGroup]]:
    """Return the groups of each section."""
    sections: dict[str, list[DxfGroup]] = {}
    now: list[DxfGroup] | None = None
    for k, group in enumerate(groups):
        if group.code == 0 and group.value.strip() == "SECTION":
            name = groups[k + 1].value.strip() if k + 1 < len(groups) and groups[k + 1].code == 2 else ""
            now = sections.setdefault(name, [])
        elif group.code == 0 and group.value.strip() == "ENDSEC":
            now = None
        elif now is not None:
            now.append(group)
    if "ENTITIES" not in sections:
        raise TrialError(f"{path} has no section ENTITIES: it is not a drawing in DXF")
    return sections


def _blocks(entities: Sequence[DxfEntity]) -> dict[str, tuple[DxfEntity, list[DxfEntity]]]:
    """Return the head and the entities of each block by name."""
    blocks: dict[str, tuple[DxfEntity, list[DxfEntity]]] = {}
    now: list[DxfEntity] | None = None
    for entity in entities:
        if entity.kind == "BLOCK":
            now = blocks.setdefault(entity.text(2), (entity, []))[1]
        elif entity.kind == "ENDBLK":
            now = None
        elif now is not None:
            now.append(entity)
    return blocks


def _entities(path: Path, groups: list[DxfGroup]) -> list[DxfEntity]:
    """Return the entities of a section; vertices belong to their polyline."""
    dxf_entities: list[DxfEntity] = []
    now: DxfEntity | None = None
    for group in groups:
        if group.code == 0:
            now = DxfEntity(group.value.strip(), group.line)
            if now.kind not in PARTS:
                dxf_entities.append(now)
            elif dxf_entities and now.kind == "VERTEX" and dxf_entities[-1].kind == "POLYLINE":
                dxf_entities[-1].vertices.append(now)
            if len(dxf_entities) > MOST_ENTITIES:
                raise TrialError(f"{path}:{group.line}: more than {MOST_ENTITIES} entities are too many")
        elif now is not None:
            now.groups.append(group)
    return dxf_entities
