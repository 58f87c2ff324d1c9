"""Steps with the potentials of Vadere in random states, against which the tests hold OptimalSteps.

``python tools/vadere_steps.py VADERE`` writes ``tests/models/golden/vadere_steps.npz``. It needs a JDK and a checkout
of pedestrian-dynamics-HM/vadere (commit b8f4a7c6). The classes of both potentials and of their parameters are compiled
as they are, with the few methods of other classes that they call (below); ``Steps.java`` goes through the places of the
step disc as Vadere's discrete optimiser does, from ahead, and leaves out those beyond a wall (its ``seeSmallWalls``).
25 crowds with 40 people each: states, the step of everyone, its potential, and both potentials at 1000 distances.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

FILE = Path(__file__).parents[1] / "tests/models/golden/vadere_steps.npz"
CROWDS, PEOPLE, ROOM = 25, 40, 6.0
NEAREST = 0.35
"""Smallest distance of two people [m], some of whom touch."""
WALLS = [(-7.0, -6.3, 7.0, -6.3), (-7.0, -6.3, -7.0, 7.0), (1.0, 1.0, 3.0, 1.0), (3.0, 1.0, 3.0, 2.5)]
POTENTIAL = "VadereSimulator/src/org/vadere/simulator/models/potential/"
ORIGINALS = (
    f"{POTENTIAL}PotentialFieldPedestrianCompactSoftshell.java",
    f"{POTENTIAL}PotentialFieldObstacleCompactSoftshell.java",
    "VadereState/src/org/vadere/state/attributes/models/AttributesPotentialCompactSoftshell.java",
)
IMPORTS = """import java.util.*; import org.vadere.state.attributes.*; import org.vadere.state.attributes.scenario.*;
import org.vadere.state.scenario.*; import org.vadere.util.geometry.shapes.*; import org.vadere.simulator.projects.*;
"""
CALLED = {
    "annotation.factories.models.ModelClass": "@interface ModelClass {}",
    "annotation.factories.attributes.ModelAttributeClass": "@interface ModelAttributeClass {}",
    "state.attributes.Attributes": "class Attributes {}",
    "state.attributes.scenario.AttributesAgent": "class AttributesAgent { public double getRadius() { return 0.2; } }",
    "state.scenario.Agent": """class Agent { public int id; public double radius; public VPoint position;
        public int getId() { return id; } public double getRadius() { return radius; }
        public VPoint getPosition() { return position; } }""",
    "state.scenario.Pedestrian": "class Pedestrian extends Agent {}",
    "state.scenario.Obstacle": "class Obstacle {}",
    "state.scenario.Topography": """class Topography { public double[][] walls = {};
        public interface Near<T> { List<T> getObjects(VPoint center, double radius); }
        public AttributesAgent getAttributesPedestrian() { return new AttributesAgent(); }
        public <T> Near<T> getSpatialMap(Class<T> type) { throw new UnsupportedOperationException(); }
        public List<Obstacle> getObstacles() { return List.of(); }
        public double distanceToObstacle(IPoint p, Agent agent) { double least = 1e9;
            for (double[] w : walls) least = Math.min(least,
                java.awt.geom.Line2D.ptSegDist(w[0], w[1], w[2], w[3], p.getX(), p.getY()));
            return least; } }""",
    "simulator.projects.Domain": """class Domain { public Topography topography = new Topography();
        public Topography getTopography() { return topography; } }""",
    "simulator.models.Model": """interface Model {
        void initialize(List<Attributes> list, Domain domain, AttributesAgent agent, Random random);
        static <T> T findAttributes(List<Attributes> list, Class<T> type) { return type.cast(list.get(0)); } }""",
    "simulator.models.potential.fields.PotentialFieldAgent": """interface PotentialFieldAgent
        extends org.vadere.simulator.models.Model { double getMaximalInfluenceRadius();
        Collection<? extends Agent> getRelevantAgents(VCircle area, Agent agent, Topography topography);
        double getAgentPotential(IPoint pos, Agent agent, Agent other);
        double getAgentPotential(IPoint pos, Agent agent, Collection<? extends Agent> others);
        Vector2D getAgentPotentialGradient(IPoint p, Vector2D v, Agent agent, Collection<? extends Agent> others); }""",
    "simulator.models.potential.fields.PotentialFieldObstacle": """interface PotentialFieldObstacle
        extends org.vadere.simulator.models.Model { double getObstaclePotential(IPoint pos, Agent agent);
        Vector2D getObstaclePotentialGradient(VPoint pos, Agent agent); PotentialFieldObstacle copy(); }""",
    "util.geometry.shapes.IPoint": """interface IPoint { double getX(); double getY();
        double distance(IPoint p); double distanceSq(IPoint p); }""",
    "util.geometry.shapes.VPoint": """class VPoint implements IPoint { double x, y;
        public VPoint(double x, double y) { this.x = x; this.y = y; }
        public double getX() { return x; } public double getY() { return y; }
        public double distance(IPoint p) { return Math.sqrt(distanceSq(p)); }
        public double distanceSq(IPoint p) { double a = p.getX() - x, b = p.getY() - y; return a * a + b * b; } }""",
    "util.geometry.shapes.Vector2D": "class Vector2D extends VPoint { public Vector2D() { super(0, 0); } }",
    "util.geometry.shapes.VCircle": """class VCircle { public VPoint getCenter() { return null; }
        public double getRadius() { return 0; } }""",
    "util.logging.Logger": "class Logger { public static Logger getLogger(Object name) { return new Logger(); } }",
}
"""Methods of other classes that the originals call, by class."""
STEPS = """class Steps { public static void main(String[] args) {
    Scanner in = new Scanner(System.in).useLocale(Locale.ROOT);
    Domain domain = new Domain(); AttributesAgent own = new AttributesAgent(); Random random = new Random(0);
    List<Attributes> values = List.of(new org.vadere.state.attributes.models.AttributesPotentialCompactSoftshell());
    domain.topography.walls = new double[in.nextInt()][4];
    for (double[] wall : domain.topography.walls) for (int i = 0; i < 4; i++) wall[i] = in.nextDouble();
    var people = new org.vadere.simulator.models.potential.PotentialFieldPedestrianCompactSoftshell();
    var walls = new org.vadere.simulator.models.potential.PotentialFieldObstacleCompactSoftshell();
    people.initialize(values, domain, own, random); walls.initialize(values, domain, own, random);
    for (int distances = in.nextInt(); distances > 0; distances--) {
        Agent a = new Agent(), b = new Agent(); a.radius = b.radius = in.nextDouble(); b.id = 1;
        double d = in.nextDouble();
        b.position = new VPoint(d, 0); domain.topography.walls = new double[][] {{d, 0, d, 1}};
        VPoint zero = new VPoint(0, 0);
        System.out.println(people.getAgentPotential(zero, a, b) + " " + walls.getObstaclePotential(zero, a)); }
    double[][] room = new double[in.nextInt()][4];
    for (double[] wall : room) for (int i = 0; i < 4; i++) wall[i] = in.nextDouble();
    domain.topography.walls = room;
    for (int crowds = in.nextInt(); crowds > 0; crowds--) {
        int count = in.nextInt(); List<Agent> all = new ArrayList<>(); double[][] goal = new double[count][3];
        for (int i = 0; i < count; i++) { Agent a = new Agent(); a.id = i; a.radius = in.nextDouble();
            a.position = new VPoint(in.nextDouble(), in.nextDouble()); all.add(a);
            for (int c = 0; c < 3; c++) goal[i][c] = in.nextDouble(); }
        for (Agent a : all) { double[] g = goal[a.id];
            VPoint from = a.position, best = from, aim = new VPoint(g[0], g[1]);
            double ahead = Math.atan2(g[1] - from.getY(), g[0] - from.getX()), length = 0.4625 + 0.2345 * g[2];
            double least = aim.distance(from) + people.getAgentPotential(from, a, all)
                + walls.getObstaclePotential(from, a);
            for (int ring = 1; ring <= 4; ring++) for (int i = 0; i < 6 * ring; i++) {
                double r = length * ring / 4, angle = ahead + i * 2 * Math.PI / (6 * ring); boolean crosses = false;
                VPoint p = new VPoint(from.getX() + r * Math.cos(angle), from.getY() + r * Math.sin(angle));
                for (double[] w : room) crosses |= java.awt.geom.Line2D.linesIntersect(
                    from.getX(), from.getY(), p.getX(), p.getY(), w[0], w[1], w[2], w[3]);
                if (crosses) continue;
                double here = aim.distance(p) + people.getAgentPotential(p, a, all) + walls.getObstaclePotential(p, a);
                if (here < least) { least = here; best = p; } }
            System.out.println(best.getX() + " " + best.getY() + " " + least); } } } }"""


def states(rng: np.random.Generator) -> dict[str, np.ndarray]:
    """Return people at random places, with radii, goals and preferred speeds."""
    place: list[np.ndarray] = []
    while len(place) < PEOPLE:
        new = rng.uniform(-ROOM, ROOM, 2)
        if all(np.hypot(*(new - other)) >= NEAREST for other in place):
            place.append(new)
    return {
        "radius": rng.uniform(0.15, 0.25, PEOPLE),
        "position": np.array(place),
        "goal": np.array(place) + rng.uniform(2.0, 9.0, (PEOPLE, 2)) * rng.choice([-1.0, 1.0], (PEOPLE, 2)),
        "preferred_speed": rng.uniform(0.6, 2.0, PEOPLE),
    }


def run(vadere: Path, numbers: str) -> np.ndarray:
    """Return the numbers that the driver prints for those that it reads."""
    with tempfile.TemporaryDirectory() as folder:
        files = [str(vadere / name) for name in ORIGINALS]
        for name, text in {**CALLED, "Steps": STEPS}.items():
            package, kind = f"org.vadere.{name}".rsplit(".", 1)
            file = Path(folder) / f"{kind}.java"
            file.write_text(f"package {package};\n{IMPORTS}public {text}\n", encoding="utf-8")
            files.append(str(file))
        subprocess.run(["javac", "-nowarn", "-d", folder, *files], check=True)
        command = ["java", "-cp", folder, "org.vadere.Steps"]
        out = subprocess.run(command, input=numbers, capture_output=True, text=True, check=True).stdout
    return np.array(out.split(), dtype=float)


def main() -> None:
    """Write the file."""
    rng = np.random.default_rng(2012)
    crowds = [states(rng) for _ in range(CROWDS)]
    values = {name: np.stack([people[name] for people in crowds]) for name in crowds[0]}
    values["walls"], values["reach"] = np.array(WALLS), rng.uniform(0.15, 0.25, 1000)
    values["distance"] = rng.uniform(0.0, 2.0, 1000)
    table = [values["radius"], *np.moveaxis(values["position"], -1, 0), *np.moveaxis(values["goal"], -1, 0)]
    people = np.stack([*table, values["preferred_speed"]], axis=-1)
    words = ["0", "1000", *np.stack([values["reach"], values["distance"]], axis=-1).astype(str).reshape(-1)]
    words += [str(len(WALLS)), *values["walls"].astype(str).reshape(-1), str(CROWDS)]
    for crowd in people:
        words += [str(PEOPLE), *crowd.astype(str).reshape(-1)]
    out = run(Path(sys.argv[1]), " ".join(words))
    values["potentials"] = out[:2000].reshape(1000, 2)
    values["step"] = out[2000:].reshape(CROWDS, PEOPLE, 3)
    np.savez_compressed(FILE, **values)
    print(f"{FILE}: {FILE.stat().st_size} bytes")


if __name__ == "__main__":
    main()
