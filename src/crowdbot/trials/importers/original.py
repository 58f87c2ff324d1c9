"""Import of trials, orders and configurations of the CrowdBot simulator of 2021, with a list of what is not imported.

Its files have x and y on the ground in a left-handed frame, and headings in degrees, clockwise from +y. The import
keeps x, changes the sign of y, and converts headings to radians, counter-clockwise from +x.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from crowdbot.core import Element, InputError, TrialError, parse_number
from crowdbot.trials.agent import Agent
from crowdbot.trials.crowd import Crowds, Routing
from crowdbot.trials.journey import Direction, Journey, Point
from crowdbot.trials.notation import Points
from crowdbot.trials.robot import RobotGoal, RobotSpec
from crowdbot.trials.stage import Obstacle, Stage, Wall
from crowdbot.trials.trial import End, EndCondition, Trial
from crowdbot.trials.xml.trial_text import parse_trial_xml, read_trial_bytes

from .original_crowd import Walker, crowds_of
from .original_order import DEFAULT, Plan

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
