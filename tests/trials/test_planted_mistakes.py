"""Mistakes planted in a file that is right: a check tells each of them at once, with its line, and nothing else."""

import itertools
from pathlib import Path

import numpy as np
import pytest

from crowdbot.core import TrialError
from crowdbot.trials import load_trial

RIGHT = """<trial name="rich" duration="20" step="0.05">
  <stage walkable="-10,-5 10,-5 10,5 -10,5">
    <wall points="-3,1 -3,3"/>
    <obstacle points="2,2 3,2 3,3 2,3"/>
  </stage>
  <crowd name="calm" type="orca" neighbor-distance="4"/>
  <crowd name="hasty" type="social-force" relaxation-time="0.6"/>
  <journey name="across"><zone points="7,-4 9,-4 9,0 7,0"/></journey>
  <spawner name="left" count="3" zone="-9,-4 -7,-4 -7,4 -9,4" goal="7,-4 9,-4 9,4 7,4" crowd="calm"/>
  <spawner name="right" count="2" zone="-5,-4 -4,-4 -4,0 -5,0" journey="across" crowd="hasty"/>
  <source name="late" zone="-2,-4 -1,-4 -1,0 -2,0" goal="7,-4 9,-4 9,4 7,4" rate="0.2" crowd="calm"/>
  <agent name="ann" x="0" y="-2" goal="6,-2" speed="1.2" crowd="hasty"/>
  <robot name="rob" x="0" y="0" type="cuybot" equipped="false">
    <goal x="5" y="0"/>
    <navigator type="straight"/>
    <sensor name="scan" type="lidar2d" rate="10"/>
  </robot>
  <camera name="above" robot="rob" x="0" y="0" z="3"/>
  <recording period="0.1"/>
  <sweep path="crowd[calm]/neighbor-distance" values="3 4"/>
</trial>
"""
MISTAKES = {
    "wall": (3, '<wall points="-3,1 -3,3"/>', '<wall points="-3,1 x,3"/>', "'x,3'"),
    "obstacle": (4, "2,2 3,2 3,3 2,3", "2,2 3,3 3,2 2,3", "points"),
    "model": (6, 'neighbor-distance="4"', 'neighbor-distance="-4"', "-4"),
    "attribute": (7, "relaxation-time", "relaxation-tme", "'relaxation-time'"),
    "zone": (8, "7,-4 9,-4 9,0 7,0", "47,-4 49,-4 49,0 47,0", "outside"),
    "crowd": (9, 'crowd="calm"', 'crowd="clam"', "'calm'"),
    "journey": (10, 'journey="across"', 'journey="acros"', "'across'"),
    "rate": (11, 'rate="0.2"', 'rate="-0.2"', "-0.2"),
    "speed": (12, 'speed="1.2"', 'speed="fast"', '"fast"'),
    "type": (13, 'type="cuybot"', 'type="cuibot"', "'cuybot'"),
    "goal": (14, '<goal x="5" y="0"/>', '<goal x="50" y="0"/>', "outside"),
    "navigator": (15, 'type="straight"', 'type="strait"', "'straight'"),
    "sensor": (16, 'type="lidar2d"', 'type="lidar22d"', "'lidar2d'"),
    "camera": (18, 'robot="rob"', 'robot="bob"', "'rob'"),
    "period": (19, 'period="0.1"', 'period="0.12"', "0.12 s"),
    "sweep": (20, "crowd[calm]/neighbor-distance", "crowd[calm]/neighbor-distanc", "'neighbor-distance'"),
}


def planted(names: tuple[str, ...]) -> str:
    lines = RIGHT.splitlines()
    for name in names:
        line, old, new, _ = MISTAKES[name]
        assert old in lines[line - 1], name
        lines[line - 1] = lines[line - 1].replace(old, new)
    return "\n".join(lines)


def told(names: tuple[str, ...], folder: Path) -> list[str]:
    """Return what is wrong with what a check of a file with planted mistakes tells."""
    path = folder / "trial.xml"
    path.write_text(planted(names), encoding="utf-8")
    with pytest.raises(TrialError) as error:
        load_trial(str(path))
    problems = list(error.value.problems)
    found = [f"{names}: not told: {name}: {problems}" for name in names if not _is_told(name, problems)]
    if len(problems) != len(names):
        found.append(f"{names}: {len(problems)} problems: {problems}")
    return found


def _is_told(name: str, problems: list[str]) -> bool:
    line, _, _, words = MISTAKES[name]
    line -= name == "goal"  # told of the robot whose goal it is
    return any(f"trial.xml:{line}:" in problem and words in problem for problem in problems)


def test_the_file_without_mistakes_is_right(tmp_path: Path) -> None:
    path = tmp_path / "trial.xml"
    path.write_text(RIGHT, encoding="utf-8")
    assert load_trial(str(path)).robots[0].name == "rob"


def test_every_mistake_is_told_beside_every_other(tmp_path: Path) -> None:
    pairs = [(name,) for name in MISTAKES] + list(itertools.combinations(MISTAKES, 2))
    assert not [wrong for names in pairs for wrong in told(names, tmp_path)]


def test_many_mistakes_are_told_at_once(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    some = [tuple(rng.permutation(list(MISTAKES))[: rng.integers(3, 9)]) for _ in range(20)]
    assert not [wrong for names in [*some, tuple(MISTAKES)] for wrong in told(names, tmp_path)]
