"""Trials from worlds of Gazebo (SDF): boxes, cylinders, spheres, outlines and meshes become solid, actors people.

The format is that of http://sdformat.org. Gazebo Classic (``.world``) and Gazebo (``.sdf``) are read.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from crowdbot.core import Element, InputError
from crowdbot.models import CrowdModel, SocialForce
from crowdbot.trials.files.trial_files import resolve_file
from crowdbot.typing import Floats
from crowdbot.world import Submesh, frame, read_mesh, roll_pitch_yaw

from .building import HEIGHTS, outlines
from .foreign_text import xml_of
from .original import ImportedTrial
from .scene_parts import ImportedScene, as_number, circle

LOW, HIGH = 0.1, 1.8
"""Heights [m] between which a solid is in the way of people."""
MOST_FILES, MOST_DEPTH = 200, 5
MOST_FRAMES = 100
"""Longest chain of poses that are relative to each other."""
MOST_TRIANGLES = 300_000
"""Largest number of triangles of all meshes of a world."""
WHOLE_TURN = 2.0 * math.pi
"""Largest range of a hinge [rad]; a joint that turns farther is a wheel."""
STILL = 1e-3
"""Distance [m] between waypoints at which a person waits."""
NOTHING = ("sun", "ground_plane")
"""Included models without walls."""
SILENT = {
    "gravity", "physics", "scene", "gui", "light", "state", "magnetic_field", "atmosphere", "wind", "audio",
    "spherical_coordinates", "plugin", "model", "actor", "include", "name", "world", "frame",
}  # fmt: skip
"""Elements of a world that are imported, or that change no wall and no person."""
FRAMED = ("link", "frame", "joint", "model")
"""Elements whose frames the pose of another may be relative to, beside included models."""
FIXED = np.eye(4)
Scope = dict[str, Element]
"""Elements of a model or world by name, whose frames others may name."""


def import_gazebo(path: str | Path) -> ImportedTrial:
    """Read a world of Gazebo (root element ``sdf`` or ``gazebo`` with a ``world``), or a model of a building.

    The collisions of models that are between 0.1 and 1.8 m above the ground become solid; meshes become walls where
    they are cut at body height. Included models and meshes are read if they are beside the file, in ``models``, or in
    the folder above or its ``models``, as in a package of ROS. Models stand where ``<state>`` puts them. Actors walk
    from waypoint to waypoint at their mean speed.

    Raises:
        TrialError: the file is missing or malformed, or nothing in it can be imported.
    """
    path = Path(path)
    root = xml_of(path)
    scene = ImportedScene(path, "Gazebo")
    worlds = root.each("world")
    if root.tag in ("sdf", "gazebo") and not worlds and root.each("model"):
        scene.note("the file has a model and no world: the model stands at its own pose")
        worlds = [root]
    if root.tag not in ("sdf", "gazebo") or not worlds:
        raise scene.error("is not a world of Gazebo: it has neither <world> nor <model> in <sdf>")
    if len(worlds) > 1:
        scene.note(f"the file has {len(worlds)} worlds: the first is imported")
    with scene.named_errors():
        return _Reader(scene).trial(worlds[0])


class _Reader:
    """Converts a world."""

    def __init__(self, scene: ImportedScene) -> None:
        self.scene, self.files, self.triangles = scene, 0, 0
        self.here = scene.path.resolve()
        """The file that is read, the world or an included model."""
        self.states: dict[str, Element] = {}
        """Models of the saved state by name."""
        self.meshes: dict[tuple[Path, tuple[float, float, float], Submesh], Floats] = {}

    def trial(self, world: Element) -> ImportedTrial:
        """The trial."""
        for part in world.children:
            if part.tag not in SILENT:
                self.scene.note(f"<{part.tag[:40]}> in line {part.line} is not imported")
            elif part.tag == "plugin":
                self.scene.note(f"the plugin {_name(part)} is not imported")
        self.states = {
            part.attributes.get("name", ""): part for state in world.each("state") for part in state.each("model")
        }
        scope = _scope(world)
        for part in world.children:
            if part.tag == "model":
                self._model(part, FIXED, 0, scope, placed=self._saved(part.attributes.get("name", "")))
            elif part.tag == "include":
                self._include(part, FIXED, 0, scope)
        for part in world.each("actor"):
            self._actor(part)
        crowd: CrowdModel = SocialForce()
        if world.each("actor"):
            self.scene.note("actors do not avoid anybody in Gazebo: here people have the social force model")
        return self.scene.trial(crowd=crowd)

    def _pose(self, part: Element, scope: Scope | None = None, above: Floats = FIXED) -> Floats:
        """Frame ``[4, 4]`` of an element in the model, or world, whose elements are ``scope``.

        ``above`` is the frame of its parent element there, from which SDF counts a pose that names nothing else.
        """
        pose = next(iter(part.each("pose")), None)
        other = _other(pose)
        if pose is None or other in ("", "world", "__model__"):
            return (FIXED if other else above) @ self._numbers_of(pose)
        base = self._frame_of(other, scope or {}, ())
        if base is None:
            self.scene.note(
                f"the pose in {self._where(pose)} is relative to {other[:40]!r}, which is not in the same model, and is"
                " read in its parent"
            )
            base = above
        return base @ self._numbers_of(pose)

    def _frame_of(self, name: str, scope: Scope, before: tuple[str, ...]) -> Floats | None:
        """Frame of a named element in its model; None if there is none of the name, or its file has its pose."""
        part = scope.get(name)
        if part is None or (part.tag == "include" and not part.each("pose")):
            return None
        if name in before or len(before) > MOST_FRAMES:
            raise self.scene.error(
                f"{self._where(part)}: the pose of {name[:40]!r} is relative to itself, or through more than"
                f" {MOST_FRAMES} others; say its place in the model"
            )
        pose = next(iter(part.each("pose")), None)
        child = next((item.stray.strip() for item in part.each("child")), "") if part.tag == "joint" else ""
        other = _other(pose) or part.attributes.get("attached_to", "") or child
        if not other or other in ("world", "__model__"):
            return self._numbers_of(pose)
        base = self._frame_of(other, scope, (*before, name))
        return None if base is None else base @ self._numbers_of(pose)

    def _numbers_of(self, pose: Element | None) -> Floats:
        """Frame ``[4, 4]`` of a <pose>."""
        if pose is None:
            return FIXED
        words = pose.stray.split() or ["0"] * 6
        if len(words) != 6:
            raise self.scene.error(
                f"{self._where(pose)}: <pose> has {len(words)} numbers, it needs x y z roll pitch yaw"
            )
        values = [as_number(word, f"{self._where(pose)}: <pose>") for word in words]
        if pose.attributes.get("degrees", "false") in ("true", "1"):
            values[3:] = [math.radians(value) for value in values[3:]]
        return np.asarray(frame(tuple(values[:3]), roll_pitch_yaw(*values[3:])), dtype=np.float64)

    def _saved(self, name: str) -> Element | None:
        """The saved state of a model of the world, if it has a pose."""
        state = self.states.get(name)
        if state is None or not state.each("pose"):
            return None
        if any(item.stray.split() not in ([], ["1"] * 3) for item in state.each("scale")):
            self.scene.note(f"the scale of {name[:60]!r} in <state> (line {state.line}) is not imported: set its size")
        return state

    def _where(self, part: Element) -> str:
        """Place of an element for a note."""
        file = "" if self.here == self.scene.path.resolve() else f" of {self.here.parent.name}/{self.here.name}"
        return f"line {part.line}{file}"

    def _find(self, uri: str, *endings: str) -> Path | None:
        """The file of a URI beside the world or the file that is read, or in the package around the world."""
        folder = self.scene.path.resolve().parent
        kind, _, name = uri.rpartition("://")
        if kind not in ("", "model", "file", "package"):
            return None
        name = name.removeprefix(f"{folder.parent.name}/").strip("/")
        for start in (self.here.parent, folder, folder / "models", folder.parent, folder.parent / "models"):
            for ending in endings or ("",):
                try:
                    return resolve_file(str(start / f"{name}{ending}"), folder.parent, trust=False)
                except InputError:
                    continue
        return None

    def _include(self, part: Element, parent: Floats, depth: int, scope: Scope) -> None:
        """Add an included model whose file is beside the world."""
        uri = next((item.stray.strip() for item in part.each("uri")), "")
        if uri.startswith(("https://", "http://")):  # models of Gazebo Fuel, perhaps with a version
            uri = f"model://{uri.rpartition('/models/')[2].partition('/')[0]}"
        model = uri.rpartition("://")[2].rstrip("/")
        name = next((item.stray.strip() for item in part.each("name")), "") or model
        if model.rpartition("/")[2] in NOTHING:
            return
        self.files += 1
        if self.files > MOST_FILES or depth >= MOST_DEPTH:
            raise self.scene.error(
                f"more than {MOST_FILES} included models, or {MOST_DEPTH} levels of them, are too many"
            )
        last = model.rpartition("/")[2]
        found = self._find(uri, "/model.sdf", f"/{last}.sdf", *([""] if last.endswith(".sdf") else []))
        if found is None:
            self.scene.note(
                f"<include> of {name[:60]!r} in {self._where(part)} is left out: {uri[:80]} is not beside the world;"
                " copy its folder there, or add its outline as <obstacle>"
            )
            return
        try:
            root = xml_of(found, f"{found.parent.name}/{found.name}")
        except InputError as error:
            self.scene.note(
                f"<include> of {name[:60]!r} in {self._where(part)} is left out: {error}; mend the file, or add its"
                " outline as <obstacle>"
            )
            return
        here, self.here = self.here, found
        placed = (self._saved(name) if depth == 0 else None) or (part if part.each("pose") else None)
        for inner in root.each("model"):
            self._model(inner, parent, depth + 1, scope, name, placed, next(iter(part.each("static")), None))
        self.here = here

    def _model(
        self,
        model: Element,
        parent: Floats,
        depth: int,
        scope: Scope,
        name: str = "",
        placed: Element | None = None,
        static_override: Element | None = None,
    ) -> None:
        """Add the collisions of a model and of the models in it; another element may override its pose, as in SDF.

        Poses of the model and of that element are in the frame ``parent`` with the elements ``scope``.
        """
        name = (name or _name(model)).strip("'")[:60]
        flag = static_override or next(iter(model.each("static")), None)
        static = flag is not None and flag.stray.strip() in ("true", "1")
        place, inside = parent @ self._pose(model if placed is None else placed, scope), _scope(model)
        joints = [item for item in model.each("joint") if item.attributes.get("type") != "fixed"]
        if joints and not static:
            at = f'x="{place[0, 3]:.4g}" y="{place[1, 3]:.4g}"'
            why = _robot_part(model, joints)
            if why:
                self.scene.note(
                    f"the model {name!r} in {self._where(model)} is left out: it has joints and {why}, and is probably"
                    f" a robot; add it as <robot {at}/>, or as <door> if it is one"
                )
                return
            self.scene.note(f"the model {name!r} in {self._where(model)} has joints: its links are fixed as they stand")
        if depth > MOST_DEPTH:
            raise self.scene.error(f"more than {MOST_DEPTH} levels of models are too many")
        before = len(self.scene.obstacles) + len(self.scene.walls)
        for link in model.each("link"):
            at_link = self._pose(link, inside)
            if not link.each("collision") and link.each("visual"):
                self.scene.note(
                    f"the <visual> of the model {name!r} in {self._where(link)} is left out: it has no <collision>, so"
                    " nothing collides with it in Gazebo"
                )
            for k, collision in enumerate(link.each("collision")):
                self._collision(name, k, collision, place @ self._pose(collision, inside, at_link))
        for inner in model.each("model"):
            self._model(inner, place, depth + 1, inside)
        for inner in model.each("include"):
            self._include(inner, place, depth, inside)
        if not static and len(self.scene.obstacles) + len(self.scene.walls) > before:
            self.scene.note(f"the model {name!r} can be moved in Gazebo, and is fixed here")

    def _collision(self, name: str, k: int, collision: Element, at: Floats) -> None:
        """Add a collision as an obstacle; one above or below people is left out."""
        shapes = [shape for geometry in collision.each("geometry") for shape in geometry.children]
        for shape in shapes:
            if shape.tag == "mesh":
                self._mesh(name, shape, at)
                continue
            corners = self._corners(name, shape)
            if corners is None:
                continue
            space = corners @ at[:3, :3].T + at[:3, 3]
            low, high = float(space[:, 2].min()), float(space[:, 2].max())
            if high < LOW or low > HIGH:
                where = f"below {LOW:g} m" if high < LOW else f"above {HIGH:g} m"
                self.scene.note(f"a {shape.tag[:20]} of the model {name!r} is {where}, and is left out")
                continue
            upright = abs(at[2, 2]) > 1.0 - 1e-9
            outline = [(round(float(x), 6), round(float(y), 6)) for x, y in space[: len(space) // 2, :2]]
            hull = outline if upright else _hull(space[:, :2])
            self.scene.obstacle(hull, f"collision {k + 1} of the model {name!r}")

    def _mesh(self, name: str, shape: Element, at: Floats) -> None:
        """Add the walls in which a mesh is cut at body height."""
        uri = next((item.stray.strip() for item in shape.each("uri")), "")
        lost = f"the <mesh> {uri[-60:]} of the model {name!r} in {self._where(shape)} is left out"
        remedy = "add its outline as <obstacle>"
        found = self._find(uri) if uri else None
        if found is None:
            self.scene.note(f"{lost}: the file is not beside the world; copy it there, or {remedy}")
            return
        x, y, z = self._numbers(shape, "scale", 3, negative=True) if shape.each("scale") else (1.0, 1.0, 1.0)
        words = {item.tag: item.stray.strip() for part in shape.each("submesh") for item in part.children}
        submesh = Submesh(words.get("name", ""), words.get("center") in ("true", "1"))
        if (found, (x, y, z), submesh) not in self.meshes:
            try:
                mesh = read_mesh(found, uri, (x, y, z), submesh=submesh)
            except InputError as error:
                self.scene.note(f"{lost}: {error}; {remedy}")
                return
            self.meshes[found, (x, y, z), submesh] = mesh.vertices[mesh.faces]
        corners = self.meshes[found, (x, y, z), submesh]
        self.triangles += len(corners)
        if self.triangles > MOST_TRIANGLES:
            self.scene.note(f"{lost}: meshes have more than {MOST_TRIANGLES} triangles in all; {remedy}")
            return
        rings = outlines(corners @ at[:3, :3].T + at[:3, 3])
        if not rings:
            heights = ", ".join(f"{height:g}" for height in HEIGHTS)
            self.scene.note(f"{lost}: nothing of it is {heights} m above the ground")
        for ring in rings:
            self.scene.wall(ring, f"a wall of the mesh of {name!r}")

    def _corners(self, name: str, shape: Element) -> Floats | None:
        """Corners ``[2 N, 3]`` of a shape in its own frame, lower outline first; None if it is none of those read."""
        if shape.tag == "box":
            x, y, z = self._numbers(shape, "size", 3)
            outline = [(-x / 2, -y / 2), (x / 2, -y / 2), (x / 2, y / 2), (-x / 2, y / 2)]
            return _prism(outline, -z / 2, z / 2)
        if shape.tag in ("cylinder", "capsule", "cone"):
            radius, length = (self._numbers(shape, tag, 1)[0] for tag in ("radius", "length"))
            reach = length / 2 + (radius if shape.tag == "capsule" else 0.0)
            return _prism(circle(0.0, 0.0, radius), -reach, reach)
        if shape.tag in ("sphere", "ellipsoid"):
            radii = (
                self._numbers(shape, "radii", 3) if shape.tag == "ellipsoid" else self._numbers(shape, "radius", 1) * 3
            )
            return _prism([(x * radii[0], y * radii[1]) for x, y in circle(0.0, 0.0, 1.0)], -radii[2], radii[2])
        if shape.tag == "polyline":
            outline = []
            for point in shape.each("point"):
                words = point.stray.split()
                if len(words) != 2:
                    raise self.scene.error(f"{self._where(point)}: <point> needs x and y")
                outline.append((self._number(words[0], point), self._number(words[1], point)))
            height = self._numbers(shape, "height", 1)[0]
            return _prism(outline, 0.0, height) if len(outline) >= 3 else None
        if shape.tag == "plane":
            return None
        if shape.tag == "heightmap":
            self._heightmap(name, shape)
            return None
        file = next((item.stray.strip() for item in shape.each("uri")), "")
        more = f" ({file[-60:]})" if file else ""
        self.scene.note(
            f"the <{shape.tag[:20]}>{more} of the model {name!r} in {self._where(shape)} is left out: its outline is"
            " not in the file; add it as <obstacle>"
        )
        return None

    def _heightmap(self, name: str, shape: Element) -> None:
        """Note how uneven the ground is that becomes level: the ground of a stage has slopes and steps only."""
        uri = next((item.stray.strip() for item in shape.each("uri")), "")
        x, y, z = self._numbers(shape, "size", 3) if shape.each("size") else (1.0, 1.0, 1.0)
        self.scene.note(
            f"the <heightmap> {uri[-60:]} of the model {name!r} in {self._where(shape)} is left out: its ground of"
            f" {x:g} x {y:g} m with heights up to {z:g} m is level here, and what stands on it counts by its height"
            " above 0; add its slopes as <ramp>, its steps as <stairs> or <platform>, and what nobody passes as"
            " <obstacle>"
        )

    def _number(self, word: str, part: Element) -> float:
        return as_number(word, f"{self._where(part)}: <{part.tag[:40]}>")

    def _numbers(self, shape: Element, tag: str, count: int, negative: bool = False) -> list[float]:
        part = next(iter(shape.each(tag)), None)
        words = [] if part is None else part.stray.split()
        if part is None or len(words) != count:
            raise self.scene.error(f"{self._where(shape)}: <{shape.tag[:40]}> needs <{tag}> with {count} numbers")
        values = [self._number(word, part) for word in words]
        if min(values) < 0.0 and not negative:
            raise self.scene.error(f"{self._where(part)}: <{tag}> must not be below 0")
        return values

    def _actor(self, actor: Element) -> None:
        """Add an actor with its waypoints."""
        name = _name(actor).strip("'")
        start = self._pose(actor)
        for plugin in actor.each("plugin"):
            self.scene.note(f"the plugin {_name(plugin)} of the actor {name!r} is not imported")
        scripts = actor.each("script")
        rows = [
            self._waypoint(item)
            for script in scripts
            for way in script.each("trajectory")
            for item in way.each("waypoint")
        ]
        rows.sort(key=lambda row: row[0])
        if sum(len(script.each("trajectory")) for script in scripts) > 1:
            self.scene.note(f"the actor {name!r} has several trajectories: their waypoints follow by time")
        if not rows:
            x, y = float(start[0, 3]), float(start[1, 3])
            self.scene.person(name, x, y, heading=float(np.arctan2(start[1, 0], start[0, 0])))
            return
        spots = [row[1:3] for row in rows]
        if np.hypot(*(start[:2, 3] - np.array(spots[0]))) > 0.01 and np.any(start[:2, 3]):
            self.scene.note(
                f"the actor {name!r} has a pose and waypoints: waypoints are read in the frame of the world"
            )
        kept = [spots[0], *(b for a, b in itertools.pairwise(spots) if math.dist(a, b) > STILL)]
        walked = [(math.dist(a[1:3], b[1:3]), b[0] - a[0]) for a, b in itertools.pairwise(rows)]
        if any(length <= STILL and time > 0.5 for length, time in walked):
            self.scene.note(f"the actor {name!r} waits at waypoints: here people go on at once")
        moving = [(length, time) for length, time in walked if length > STILL and time > 0.0]
        speed = sum(length for length, _ in moving) / sum(time for _, time in moving) if moving else None
        delay = next((item.stray.strip() for script in scripts for item in script.each("delay_start")), "0")
        if as_number(delay or "0", f"delay_start of {name!r}") > 0.0:
            self.scene.note(f"the actor {name!r} starts {delay} s later in Gazebo, here at once")
        loops = next((item.stray.strip() for script in scripts for item in script.each("loop")), "true")
        loop = loops in ("true", "1")
        way = [*kept[1:], *([kept[0]] if loop and kept[-1] != kept[0] and len(kept) > 1 else [])]
        heading = float(rows[0][3]) if not way else None
        self.scene.person(
            name, *kept[0], self.scene.points(way), then="again" if loop else "stay", heading=heading, speed=speed
        )

    def _waypoint(self, part: Element) -> tuple[float, float, float, float]:
        """Time [s], x, y [m] and heading [rad] of a waypoint."""
        time = next((item.stray.strip() for item in part.each("time")), "")
        at = self._pose(part)
        return (
            as_number(time or "nothing", f"line {part.line}: <time>"), float(at[0, 3]),
            float(at[1, 3]), float(np.arctan2(at[1, 0], at[0, 0])),
        )  # fmt: skip


def _other(pose: Element | None) -> str:
    """Name of what a pose is relative to; empty if its parent."""
    return "" if pose is None else pose.attributes.get("relative_to") or pose.attributes.get("frame") or ""


def _scope(parent: Element) -> Scope:
    """Elements of a model or world whose frames others may name."""
    named = [(part.attributes.get("name", ""), part) for part in parent.children if part.tag in FRAMED]
    own = [("".join(item.stray.strip() for item in part.each("name")), part) for part in parent.each("include")]
    return {name: part for name, part in (*own, *named) if name}


def _robot_part(model: Element, joints: Sequence[Element]) -> str:
    """What of a model with joints is that of a robot; empty if nothing is, as for a cabinet with a hinged door."""
    if model.each("plugin"):
        return "a <plugin>"
    if any(link.each("sensor") for link in model.each("link")):
        return "a <sensor>"
    for joint in joints:
        limits = [
            item.stray.strip()
            for axis in joint.each("axis")
            for limit in axis.each("limit")
            for tag in ("lower", "upper")
            for item in limit.each(tag)
        ]
        kind = joint.attributes.get("type", "")
        if kind == "continuous" or (kind == "revolute" and (len(limits) < 2 or any(map(_is_far, limits)))):
            return f"a wheel (joint {_name(joint)})"
    return ""


def _is_far(limit: str) -> bool:
    """Whether a limit of a joint is beyond a whole turn, or no number."""
    try:
        return not abs(float(limit)) <= WHOLE_TURN
    except ValueError:
        return True


def _name(part: Element) -> str:
    return repr(part.attributes.get("name", part.attributes.get("filename", part.tag))[:60])


def _prism(outline: Sequence[tuple[float, float]], low: float, high: float) -> Floats:
    return np.array([(x, y, z) for z in (low, high) for x, y in outline], dtype=np.float64)


def _hull(points: Floats) -> list[tuple[float, float]]:
    """Corners of the convex hull of points ``[N, 2]``."""
    import shapely

    hull = shapely.convex_hull(shapely.multipoints(points))
    corners = shapely.get_coordinates(hull)[:-1] if hull.geom_type == "Polygon" else shapely.get_coordinates(hull)
    return [(round(float(x), 6), round(float(y), 6)) for x, y in corners]
