"""Plugs: names, addresses and text attributes, and what is said when they are wrong."""

import types
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import pytest

from crowdbot.core import InputError, UnknownName, builtin_classes, find_class, from_attributes, kebab_case


class Walker(ABC):
    @abstractmethod
    def walk(self): ...


@dataclass(frozen=True)
class FastWalker(Walker):
    speed: float = 1.0
    count: int = 3
    label: str | None = None
    brave: bool = False
    box: tuple[float, ...] = ()

    def walk(self):
        return self.speed


@dataclass(frozen=True)
class SlowWalker(Walker):
    builtin_name: ClassVar[str] = "slow-pace"
    pause: float

    def __post_init__(self):
        if self.pause < 0.0:
            raise InputError(f"pause {self.pause} s is below 0")

    def walk(self):
        return 0.1


room = types.ModuleType("room")
room.__all__ = ["Walker", "FastWalker", "SlowWalker", "number"]
room.Walker, room.FastWalker, room.SlowWalker, room.number = Walker, FastWalker, SlowWalker, 7


@pytest.mark.parametrize(
    ("name", "spoken"),
    [
        ("SocialForce", "social-force"),
        ("ORCA", "orca"),
        ("VBM", "vbm"),
        ("Lidar2D", "lidar2d"),
        ("RGBCamera", "rgbcamera"),
    ],
)
def test_kebab(name, spoken):
    assert kebab_case(name) == spoken


def test_built_in_lists_concrete_classes_only():
    assert builtin_classes(room, Walker) == {"fast": FastWalker, "slow-pace": SlowWalker}


@pytest.mark.parametrize("name", ["fast", "fast-walker", "FastWalker", "fast_walker", "FASTWALKER", " fast-walker "])
def test_find_takes_every_spelling(name):
    assert find_class(name, room, Walker) is FastWalker


@pytest.mark.parametrize("name", ["slow-pace", "SlowPace", "SlowWalker", "slow-walker"])
def test_a_class_can_state_its_name(name):
    assert find_class(name, room, Walker) is SlowWalker


def test_unknown_name_suggests_a_known_one():
    with pytest.raises(UnknownName, match="unknown walker 'slow-pase', did you mean 'slow-pace'"):
        find_class("slow-pase", room, Walker)


def test_find_by_file_and_trust(tmp_path):
    (tmp_path / "mine.py").write_text("from crowdbot.core import Scene\nclass Mine(Scene): pass\nOther = 3\n")
    from crowdbot.core import Scene

    assert find_class("mine.py:Mine", room, Scene, folder=tmp_path).__name__ == "Mine"
    assert find_class("mine.py:Mine", room, Scene, folder=tmp_path, trust=False).__name__ == "Mine"
    with pytest.raises(InputError, match="mine.py:Other is not a concrete Scene; mine.py holds"):
        find_class("mine.py:Other", room, Scene, folder=tmp_path)
    with pytest.raises(InputError, match="lies outside"):
        find_class("../mine.py:Mine", room, Scene, folder=tmp_path / "inner", trust=False)
    with pytest.raises(InputError, match="pass --trust"):
        find_class("os:getcwd", room, Scene, trust=False)


def test_a_file_that_fails_is_named(tmp_path):
    (tmp_path / "broken.py").write_text("1 / 0\n")
    with pytest.raises(InputError, match=r"broken\.py cannot be loaded: ZeroDivisionError"):
        find_class("broken.py:X", room, Walker, folder=tmp_path)
    with pytest.raises(InputError, match="there is no file"):
        find_class("absent.py:X", room, Walker, folder=tmp_path)


def test_read_converts_by_field():
    made = from_attributes(FastWalker, {"speed": "2.5", "count": "4", "label": "a b", "brave": "true", "box": "1 2,3"})
    assert made == FastWalker(2.5, 4, "a b", True, (1.0, 2.0, 3.0))


@pytest.mark.parametrize(
    ("kind", "attributes", "words"),
    [
        (FastWalker, {"spede": "1"}, "fast-walker has no attribute 'spede', did you mean 'speed'"),
        (FastWalker, {"speed": "fast"}, "speed: 'fast' is not a number"),
        (FastWalker, {"speed": "nan"}, "speed: 'nan' is not finite"),
        (FastWalker, {"count": "2.5"}, "count: '2.5' is not a int"),
        (FastWalker, {"brave": "yes"}, "brave: 'yes' is not a bool"),
        (SlowWalker, {}, "slow-walker needs the attribute 'pause'"),
        (SlowWalker, {"pause": "-1"}, r"trial.xml:7: pause -1.0 s is below 0"),
    ],
)
def test_read_names_what_is_wrong(kind, attributes, words):
    with pytest.raises(InputError, match=words):
        from_attributes(kind, attributes, "trial.xml:7")
