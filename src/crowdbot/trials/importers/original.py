"""Import of trials, orders and configurations of the CrowdBot simulator of 2021, with a list of what is not imported.

Its files have x and y on the ground in a left-handed frame, and headings in degrees, clockwise from +y. The import
keeps x, changes the sign of y, and converts headings to radians, counter-clockwise from +x.
"""

from __future__ import annotations

import contextlib
import functools
import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any

from crowdbot import models
from crowdbot.core import Element, InputError, TrialError, parameters, parse_number
from crowdbot.core.fields import Points
from crowdbot.models import CrowdModel
from crowdbot.trials.agent import Agent, AgentParameter
from crowdbot.trials.crowd import Crowds, Routing
from crowdbot.trials.files.trial_files import resolve_file
from crowdbot.trials.journey import Journey
from crowdbot.trials.robot import RobotGoal, RobotSpec
from crowdbot.trials.stage import Obstacle, Stage, Wall
from crowdbot.trials.trial import End, EndCondition, Trial
from crowdbot.trials.xml.trial_text import parse_trial_xml, read_trial_bytes
from crowdbot.world import Direction, Point

KINDS: dict[str, tuple[type[CrowdModel], dict[str, str]]] = {
    "RVOconfig": (
        models.ORCA,
        {
            "neighborDist": "neighbor_distance",
            "maxNeighbors": "max_neighbors",
            "timeHorizon": "time_horizon",
            "timeHorizonObst": "time_horizon_walls",
        },
    ),
    "VOGConfig": (
        models.VOG,
        {
            "neighborDist": "neighbor_distance",
            "maxNeighbors": "max_neighbors",
            "timeHorizon": "time_horizon",
            "timeHorizonObst": "wall_horizon",
            "weightPrefVel": "preference_weight",
            "weightGroup": "group_weight",
            "neighbourNum": "group_neighbors",
            "neighbourDist": "group_radius",
            "neighbourDetectionDist": "group_distance",
            "horizonTime": "group_horizon",
        },
    ),
    "VBMConfig": (
        models.VBM,
        {
            "neighborAgentDist": "neighbor_distance",
            "neighborWallDist": "wall_distance",
            "sigTtca": "time_scale",
            "sigDca": "distance_scale",
            "sigSpeed": "speed_scale",
            "sigAngle": "angle_scale",
        },
    ),
    "HelbingConfig": (models.SocialForce, {"neighborDist": "neighbor_distance"}),
    "TangentConfig": (
        models.Tangent,
        {
            "personalArea": "personal_area",
            "g_beta": "direction_error",
            "g_gamma": "speed_error",
            "timeHorizon": "time_horizon",
            "maxNeighbors": "max_neighbors",
        },
    ),
    "UMANSconfig": (models.ORCA, {}),
}
KINDS["RosSimConfig"] = KINDS["RVOconfig"]
CLOSED = {
    "HelbingConfig": "its binary is closed: the social force model replaces it",
    "TangentConfig": "its binary is closed: the tangent model replaces it",
    "UMANSconfig": "its policies are in another file: ORCA replaces it",
}


@dataclass(frozen=True)
class Walker:
    """An agent of an original trial: its element, control law, simulator and radius [m]."""

    element: Element
    law: Element
    sim: Element | None
    radius: float

    @property
    def kind(self) -> str:
        """Type of its simulator."""
        return self.sim.tag if self.sim is not None and self.sim.tag in KINDS else "RVOconfig"

    @property
    def crowd(self) -> str:
        """Name of its crowd."""
        return self.kind.removesuffix("onfig").removesuffix("C").removesuffix("c")

    @property
    def speed(self) -> float:
        """Preferred speed [m/s], from the simulator if it has one, otherwise from the control law."""
        return max(
            0.05,
            _value(self.sim, "prefered_speed")
            or _value(self.sim, "speedComfort")
            or _value(self.law, "speedDefault")
            or 1.33,
        )

    @property
    def group(self) -> int:
        """Number of its group, -1 without a group."""
        inner = [child for child in self.sim.children if child.tag == "group"] if self.sim else []
        found = _value(inner[0], "groupID") if inner else _value(self.sim, "groupID")
        return int(found) if found is not None and found >= 0.0 else -1

    def parameters(self) -> dict[str, float]:
        """Return the parameters of the model in the file."""
        if self.sim is None:
            return {}
        model, words = KINDS[self.kind]
        known = {row.name for row in parameters(model)}
        places = (self.sim, *(child for child in self.sim.children if child.tag == "group"))
        result = {}
        for place in places:
            for word, name in words.items():
                value = _value(place, word)
                if value is not None and name in known:
                    result[name] = value
        return result


def crowds_of(walkers: Sequence[Walker], note: Callable[[str], None]) -> tuple[CrowdModel, list[dict[str, Any]]]:
    """Return the crowd model of all agents, and the individual fields of each :class:`Agent`."""
    kinds = list(dict.fromkeys(walker.kind for walker in walkers)) or ["RVOconfig"]
    rows = [walker.parameters() for walker in walkers]
    made: dict[str, CrowdModel] = {}
    for kind in kinds:
        if kind in CLOSED:
            note(f"the simulator {kind}: {CLOSED[kind]}")
        first = next((row for row, walker in zip(rows, walkers, strict=True) if walker.kind == kind), {})
        made[kind] = _model(KINDS[kind][0], first, note)
    for walker in walkers:
        if walker.sim is not None and walker.sim.tag not in KINDS:
            note(f"the simulator {walker.sim.tag}: ORCA replaces it")
    own = []
    for row, walker in zip(rows, walkers, strict=True):
        model = made[walker.kind]
        different = [
            AgentParameter(name.replace("_", "-"), value)
            for name, value in row.items()
            if getattr(model, name) != value
        ]
        own.append({"parameters": tuple(different)} if different else {})
    if len(kinds) == 1:
        return made[kinds[0]], own
    names = [Walker(Element(""), Element(""), Element(kind), 0.0).crowd for kind in kinds]
    return Crowds(tuple(made.values()), names=tuple(names)), own


def _model(kind: type[CrowdModel], values: dict[str, float], note: Callable[[str], None]) -> CrowdModel:
    try:
        return kind(**values)
    except InputError as error:
        note(f"parameters of {kind.__name__}: {error}")
        return kind()


def _value(element: Element | None, key: str) -> float | None:
    if element is None:
        return None
    inner = next((child.stray for child in element.children if child.tag == key), "")
    text = element.attributes.get(key, inner)
    if not text:
        return None
    try:
        value = parse_number(text.replace(",", "."))
    except InputError as error:
        raise TrialError(f"line {element.line}: <{element.tag[:40]}> {key}={text[:40]!r} {error}") from None
    return min(max(value, -1e6), 1e6)


MOST_LINES = 1000
MOST_USERS = 100
MOST_FILES = 100_000
DEFAULT = "./Scenario/Test/FileOrder{USER}.csv"


@dataclass(frozen=True)
class Plan:
    """The order of trials in a configuration or an order file.

    Fields:
        path: the configuration or order file.
        folder: its folder; names in it are relative to this folder.
        pattern: name of the order files; ``{USER}`` is the participant, ``{TWO}`` the participant modulo 2.
        user: participant that the configuration names.
        first: first line of the order, counted from 0.
        notes: one sentence for everything that is not imported.
        root: folder that is searched for files instead of ``folder``, None for none.
    """

    path: Path
    folder: Path
    pattern: str = DEFAULT
    user: int = 0
    first: int = 0
    notes: tuple[str, ...] = ()
    root: Path | None = None

    def fill_in(self, name: str, user: int) -> str:
        """Return a name with the number of a participant filled in."""
        return name.replace("\\", "/").replace("{USER}", str(user)).replace("{TWO}", str(user % 2))

    def entries(self, user: int) -> tuple[str, ...]:
        """Return the names of the trials of a participant in their order.

        Raises:
            TrialError: the order file does not exist or is not text.
        """
        order = self.fill_in(self.pattern, user)
        try:
            file = self.find(order)
            lines = [line.strip() for line in file.read_text(encoding="utf-8-sig").splitlines() if line.strip()]
        except (InputError, UnicodeDecodeError, OSError) as error:
            raise TrialError(f"{self.path}: the order file {order[:80]!r} cannot be read: {error}") from None
        chosen = lines[self.first : self.first + MOST_LINES]
        return tuple(self.fill_in(line.split(";")[0].split(",")[0].strip(), user) for line in chosen)

    def users(self) -> tuple[int, ...]:
        """Return the participants, from 0, with an order file; without any, the one of the configuration."""
        if "{USER}" not in self.pattern and "{TWO}" not in self.pattern:
            return (self.user,)
        most = MOST_USERS if "{USER}" in self.pattern else 2
        return tuple(user for user in range(most) if self._is_there(user)) or (self.user,)

    def find(self, name: str) -> Path:
        """Return the path of a file named in a configuration or an order.

        Names begin at the root of the simulator's project, such as ``./Assets/Scenario/a.xml``. Leading folders that
        do not exist here are dropped. A file in ``folder`` comes first. With a ``root``, the file in it that shares
        most of the end of the name is next; otherwise the three folders above ``folder`` are searched.

        Raises:
            InputError: the file does not exist, or two files match equally well.
        """
        with contextlib.suppress(InputError):
            return resolve_file(name, self.folder, trust=False)
        if self.root is not None:
            return self._find_in_root(name, self.root)
        for folder in (self.folder, *self.folder.resolve().parents[:3]):
            for end in (name, *_ends(name)):
                try:
                    return resolve_file(end, folder, trust=False)
                except InputError:
                    continue
        return resolve_file(name, self.folder, trust=False)

    def _find_in_root(self, name: str, root: Path) -> Path:
        for end in (name, *_ends(name)):
            try:
                return resolve_file(end, root, trust=False)
            except InputError:
                fits = [path for path in self._files.get(PurePosixPath(end).name, ()) if path.endswith(f"/{end}")]
            if len(fits) > 1:
                raise InputError(f"{len(fits)} files in {root} end with {end[:80]!r}: {', '.join(fits[:3])[:300]}")
            if fits:
                return resolve_file(fits[0].lstrip("/"), root, trust=False)
        return resolve_file(name, root, trust=False)

    @functools.cached_property
    def _files(self) -> Mapping[str, tuple[str, ...]]:
        """The files in ``root``, by name: each path begins with ``/``."""
        found: dict[str, list[str]] = {}
        if self.root is not None:
            for path in itertools.islice(self.root.rglob("*"), MOST_FILES):
                if path.is_file():
                    found.setdefault(path.name, []).append(f"/{path.relative_to(self.root).as_posix()}")
        return {name: tuple(sorted(paths)) for name, paths in found.items()}

    def _is_there(self, user: int) -> bool:
        try:
            return self.find(self.fill_in(self.pattern, user)).is_file()
        except InputError:
            return False


def _ends(name: str) -> list[str]:
    """Return the ends of a path, the longest first.

    >>> _ends("./Assets/Scenario/a.xml")
    ['Assets/Scenario/a.xml', 'Scenario/a.xml', 'a.xml']
    """
    parts = [part for part in PurePosixPath(name).parts if part not in (".", "..", "/")][-20:]
    return ["/".join(parts[k:]) for k in range(len(parts))]


NEVER = 600.0
"""Duration [s] of a trial without an end."""
ROOTS = ("Trial", "Config")


@dataclass(frozen=True)
class ImportedTrial:
    """Trials of an original file.

    Fields:
        trials: trials by file name, in the order of the experiment.
        left_out: one sentence for everything that is not imported.
    """

    trials: tuple[tuple[str, Trial], ...]
    left_out: tuple[str, ...]


def import_original(
    path: str | Path, *, participant: int | None = None, root: str | Path | None = None
) -> ImportedTrial:
    """Read a trial, a configuration or an order of the original simulator.

    Args:
        path: file with the root element ``Trial`` or ``Config``, or an order file (one trial per line).
        participant: participant whose order is read (default: from the configuration).
        root: root folder of the simulator's project; paths in the file are relative to it, and files are searched by
            the ends of their paths (default: the folder of the file and the three folders above it).

    Raises:
        TrialError: the file is missing, malformed or of another kind.
    """
    path = Path(path)
    data = read_trial_bytes(path)
    if data.lstrip(b"\xef\xbb\xbf \t\r\n")[:1] == b"<":
        tree = parse_trial_xml(data, str(path))
        if tree.tag == "Trial":
            return _one(tree, path)
    plan = plan_of(path, root)
    rows, notes = trials_of(plan, plan.user if participant is None else participant)
    return ImportedTrial(tuple((Path(entry).stem, trial) for entry, trial in rows), notes)


def plan_of(path: str | Path, root: str | Path | None = None) -> Plan:
    """Read the order of trials from a configuration or an order file.

    Args:
        path: configuration or order file.
        root: as in :func:`import_original`.

    Raises:
        TrialError: the file is missing, malformed or of another kind, or the root is not a folder.
    """
    path = Path(path)
    base = None if root is None else Path(root)
    if base is not None and not base.is_dir():
        raise TrialError(f"there is no folder {base}")
    data = read_trial_bytes(path)
    if data.lstrip(b"\xef\xbb\xbf \t\r\n")[:1] != b"<":
        return Plan(path, path.parent, pattern=path.name.replace("{", "").replace("}", ""), root=base)
    tree = parse_trial_xml(data, str(path))
    if tree.tag != "Config":
        raise TrialError(
            f"{path}:{tree.line}: the root element is <{tree.tag[:40]}>, an original file has {' or '.join(ROOTS)}"
        )
    experience = _find(tree, "experience") or Element("experience")
    notes = {
        f"<{element.tag}> of the configuration: recording and plug-ins are not imported": None
        for element in tree.children
        if element.tag in ("log", "Recording", "AddOns")
    }
    if _text(experience, "userHeight"):
        notes["userHeight of the configuration: the eye height is that of the participant"] = None
    return Plan(
        path,
        path.parent,
        _text(experience, "sourceFileExperiment") or DEFAULT,
        int(_number(experience, "currentUser", 0.0)),
        max(0, int(_number(experience, "startingTrial", 0.0))),
        tuple(notes),
        base,
    )


def trials_of(plan: Plan, user: int) -> tuple[list[tuple[str, Trial]], tuple[str, ...]]:
    """Return the trials of a participant by their entries in the order, and what is not imported.

    Raises:
        TrialError: none of the trials can be read.
    """
    rows: list[tuple[str, Trial]] = []
    notes = dict.fromkeys(plan.notes)
    for entry in plan.entries(user):
        try:
            place = plan.find(entry)
            inner = _one(parse_trial_xml(read_trial_bytes(place), str(place)), place)
        except (InputError, TrialError) as error:
            notes[f"trial {entry[:80]!r} and all after it: {error}"] = None
            break
        rows += [(entry, trial) for _, trial in inner.trials]
        notes |= dict.fromkeys(inner.left_out)
    if not rows:
        said = "; ".join(notes)
        raise TrialError(
            f"{plan.path}: no trial of the order {plan.fill_in(plan.pattern, user)[:80]!r} can be read: {said}"
        )
    return rows, tuple(notes)


def _one(root: Element, path: Path) -> ImportedTrial:
    if root.tag != "Trial":
        raise TrialError(f"{path}:{root.line}: the root element is <{root.tag[:40]}>, an original trial has Trial")
    reader = _Reader(path.stem)
    trial = reader.trial(root)
    return ImportedTrial(((path.stem, trial),), tuple(reader.notes))


@dataclass
class _Reader:
    """Converts an original trial, and notes what is not imported."""

    name: str
    notes: dict[str, None] = field(default_factory=dict)

    def note(self, sentence: str) -> None:
        self.notes[sentence] = None

    def trial(self, root: Element) -> Trial:
        """Return the trial."""
        stage = self._stage(root)
        when, duration = self._end(root)
        walkers = [self._walker(kind) for kind in _kinds(root, "agents", "agent")]
        crowd, parameters = crowds_of(walkers, self.note)
        ways: dict[Journey, str] = {}
        agents = []
        for k, walker in enumerate(walkers):
            agents.append(self._agent(k, walker, ways, parameters[k], isinstance(crowd, Crowds)))
        robots = [self._robot(k, kind, when) for k, kind in enumerate(_kinds(root, "robots", "robot"))]
        self._rest(root)
        return Trial(
            name=(self.name.strip() or "imported")[:80],
            about="Imported from the CrowdBot simulator of 2021.",
            duration=duration,
            heading_jitter=0.001,
            stage=stage,
            routing=Routing(radius=0.33, unreachable="nearest") if stage.rings and ways else None,
            crowd=crowd,
            journeys=tuple(ways),
            agents=tuple(agents),
            robots=tuple(robots),
            end=End(goal=bool(robots), collision=False, conditions=tuple(when)),
        )

    def _stage(self, root: Element) -> Stage:
        scene = _find(root, "scene")
        mesh = scene.attributes.get("meshName", "") if scene else ""
        if mesh:
            self.note(f"stage {mesh[:40]!r}: only the walls and pillars in the trial are imported")
        walls: list[Wall] = []
        solids: list[Obstacle] = []
        for kind in _kinds(root, "obstacles", "obstacle"):
            for line in _all(kind, "Line"):
                ends = [(_number(line, f"x{k}", 0.0), -_number(line, f"y{k}", 0.0)) for k in (1, 2)]
                self._add_wall(ends, _number(line, "thickness", 0.0), walls, solids)
            for spot in _all(kind, "Point"):
                x, y = _number(spot, "x1", 0.0), -_number(spot, "y1", 0.0)
                solids.append(Obstacle(_disc(x, y, max(0.05, _number(spot, "thickness", 0.5) / 2.0))))
        return Stage(walls=tuple(walls), obstacles=tuple(solids))

    def _add_wall(
        self, ends: list[tuple[float, float]], thick: float, walls: list[Wall], solids: list[Obstacle]
    ) -> None:
        (ax, ay), (bx, by) = ends
        length = math.hypot(bx - ax, by - ay)
        if length == 0.0:
            self.note("walls without length")
        elif thick <= 0.0:
            walls.append(Wall(Points.of(ends)))
        else:
            nx, ny = -(by - ay) / length * thick / 2.0, (bx - ax) / length * thick / 2.0
            corners = [(ax + nx, ay + ny), (bx + nx, by + ny), (bx - nx, by - ny), (ax - nx, ay - ny)]
            solids.append(Obstacle(Points.of(corners)))

    def _end(self, root: Element) -> tuple[list[EndCondition], float]:
        """Return the end conditions and the duration."""
        when, duration = [], math.inf
        for item in _all(root, "condition"):
            what, test = item.attributes.get("parameter", "time"), item.attributes.get("test", "less")
            value = _number(item, "value", 0.0)
            if what == "time" and test == "greater" and value > 0.0:
                duration = min(duration, value)
            elif what in ("x", "y") and test in ("less", "greater"):
                up = (test == "greater") == (what == "x")
                value = -value if what == "y" else value
                when.append(
                    EndCondition(what, above=value if up else None, below=None if up else value, outcome="success")
                )
            elif not (what == "time" and test == "less" and value <= 0.0):
                self.note(f"the end condition {what} {test} {value:g}")
        if math.isinf(duration):
            self.note(f"no end by time was set: the trial now ends after {NEVER:g} s")
            duration = NEVER
        return when, min(duration, 86_400.0)

    def _walker(self, element: Element) -> Walker:
        law = _inner(element, "controlLaw") or Element("LawFake", line=element.line)
        sim = _inner(element, "controlSim")
        return Walker(element, law, sim, max(0.05, _number(element, "radius", 0.33)))

    def _agent(self, k: int, walker: Walker, ways: dict[Journey, str], own: dict[str, object], several: bool) -> Agent:
        one, law = walker.element, walker.law
        x, y = _place(_find(one, "Position"))
        heading = _heading(_find(one, "Rotation"))
        stops = [Point(*_place(stop), tolerance=_reach(law)) for stop in (*_all(law, "Waypoint"), *_all(law, "Goal"))]
        journey = ""
        if law.tag in ("LawWaypoints", "LawGoals") and stops:
            again = (law.attributes.get("isLooping") or _text(law, "isLooping")).lower() == "true"
            journey = self._way(tuple(stops), "again" if again else "stay", ways)
        elif law.tag == "LawMoveStraight":
            journey = self._way((Direction(math.remainder(heading, 2.0 * math.pi)),), "stay", ways)
        elif law.tag == "LawStanding":
            look = _find(law, "LookAt")
            if look is not None:
                lx, ly = _place(look)
                heading = math.atan2(ly - y, lx - x)
        else:
            self.note(f"agents steered by {law.tag} stand still: they were moved externally or from a table")
        return Agent(
            name=f"agent{k + 1}",
            x=x,
            y=y,
            heading=heading,
            journey=journey,
            speed=min(10.0, walker.speed),
            radius=min(5.0, walker.radius),
            group=walker.group,
            crowd=walker.crowd if several else "",
            **own,  # type: ignore[arg-type]
        )

    def _way(self, stops: tuple[Point | Direction, ...], then: str, ways: dict[Journey, str]) -> str:
        name = next((way.name for way in ways if way.stops == stops and way.then == then), "")
        if not name:
            name = f"way{len(ways) + 1}"
            ways[Journey(name=name, stops=stops, then=then)] = name
        return name

    def _robot(self, k: int, element: Element, when: list[EndCondition]) -> RobotSpec:
        from crowdbot.navigation import ORCANavigator
        from crowdbot.world import DifferentialDrive

        x, y = _place(_find(element, "Position"))
        heading = _heading(_find(element, "Rotation"))
        crossed = next((w.above for w in when if w.what == "x" and w.above is not None), None)
        if crossed is not None and k == 0:
            goal = RobotGoal(crossed + 0.5, y, 0.5)
            self.note("the goal of the first robot is set behind the line where the trial ends")
        else:
            goal = RobotGoal(x + 10.0 * math.cos(heading), y + 10.0 * math.sin(heading), 0.5)
            self.note("robots had no goal: it is set 10 m ahead of each")
        self.note("robots were controlled externally: they are now discs with a differential drive and ORCA")
        return RobotSpec(
            name=f"robot{k + 1}" if k else "robot",
            x=x,
            y=y,
            heading=heading,
            radius=min(10.0, max(0.05, _number(element, "radius", 0.33))),
            visible=element.attributes.get("in_sim", "true").lower() == "true",
            goal=goal,
            drive=DifferentialDrive(),
            navigator=ORCANavigator(),
        )

    def _rest(self, root: Element) -> None:
        """Note the elements that are not imported."""
        player = _find(root, "player")
        for item in player.children if player else ():
            walks = item.tag == "TrialRegularPlayer"
            self.note(f"the player {item.tag}: " + ("a participant joins with a headset" if walks else "a camera only"))
        for word, what in (
            ("config", "data of plug-ins"),
            ("screenRecorder", "pictures of the screen"),
            ("SavedDataList", "chosen columns of the recorder: everything is recorded"),
            ("recordingFile", "the name of the recording: it is given when a trial runs"),
        ):
            if _all(root, word):
                self.note(f"<{word}>: {what}")
        if _kinds(root, "agents", "agent"):
            self.note("mesh, height, variation and animation of agents: people are discs here")


def _disc(x: float, y: float, radius: float) -> Points:
    turns = [2.0 * math.pi * k / 12.0 for k in range(12)]
    return Points.of([(x + radius * math.cos(turn), y + radius * math.sin(turn)) for turn in turns])


def _walk(element: Element) -> Iterator[Element]:
    for inner in element.children:
        yield inner
        yield from _walk(inner)


def _all(element: Element, tag: str) -> list[Element]:
    return [item for item in _walk(element) if item.tag == tag]


def _find(element: Element, tag: str) -> Element | None:
    return next((child for child in element.children if child.tag == tag), None)


def _inner(element: Element, tag: str) -> Element | None:
    """Return the only child of a child; its tag is the kind."""
    outer = _find(element, tag)
    return outer.children[0] if outer and outer.children else None


def _kinds(root: Element, several: str, one: str) -> list[Element]:
    return [
        inner for outer in _all(root, several) for row in outer.children if row.tag == one for inner in row.children
    ]


def _text(element: Element, key: str) -> str:
    """Return the text of a value, which is an attribute or a child element."""
    if key in element.attributes:
        return element.attributes[key]
    inner = _find(element, key)
    return inner.stray if inner else ""


def _number(element: Element, key: str, otherwise: float) -> float:
    text = _text(element, key).replace(",", ".")
    if not text:
        return otherwise
    try:
        value = parse_number(text)
    except InputError as error:
        raise TrialError(f"line {element.line}: <{element.tag[:40]}> {key}={text[:40]!r} {error}") from None
    if abs(value) > 1e6:
        raise TrialError(f"line {element.line}: <{element.tag[:40]}> {key}={text[:40]!r} is more than 1e6")
    return value


def _place(element: Element | None) -> tuple[float, float]:
    """Return a position on the ground in the frame of crowdbot."""
    if element is None:
        return 0.0, 0.0
    return _number(element, "x", 0.0), -_number(element, "y", 0.0)


def _heading(element: Element | None) -> float:
    """Return the heading [rad] of a rotation about z [degrees]: 0 is along +y of the file, which is -y here."""
    turn = math.radians(_number(element, "z", 0.0)) if element else 0.0
    return math.atan2(-math.cos(turn), -math.sin(turn))


def _reach(law: Element) -> float:
    return min(1e3, max(0.05, _number(law, "reachedDist", 0.5)))
