"""Plugs: names, addresses and text attributes, and what is said when they are wrong."""

import types
from abc import ABC, abstractmethod
from dataclasses import dataclass

import pytest

from crowdbot.core import (
    InputError,
    Scene,
    UnknownName,
    attribute_names,
    attribute_problems,
    builtin_classes,
    find_class,
    from_attributes,
    kebab_case,
    required_fields,
    sources_of,
)


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
    assert builtin_classes(room, Walker) == {"fast-walker": FastWalker, "slow-walker": SlowWalker}


@pytest.mark.parametrize("name", ["fast-walker", "FastWalker", "fast_walker", "FASTWALKER", " fast-walker "])
def test_find_takes_every_spelling(name):
    assert find_class(name, room, Walker) is FastWalker


def test_navigators_are_found_with_and_without_their_contract():
    class Navigator: ...

    class FastNavigator(Navigator): ...

    navigators = types.ModuleType("navigators")
    navigators.__all__, navigators.FastNavigator = ["FastNavigator"], FastNavigator
    assert builtin_classes(navigators, Navigator) == {"fast": FastNavigator}
    for name in ("fast", "fast-navigator", "FastNavigator"):
        assert find_class(name, navigators, Navigator) is FastNavigator


def test_unknown_name_suggests_a_known_one():
    with pytest.raises(UnknownName, match="unknown walker 'slow-walkr', did you mean 'slow-walker'"):
        find_class("slow-walkr", room, Walker)


def test_find_by_file_and_trust(tmp_path):
    (tmp_path / "mine.py").write_text("from crowdbot.core import Scene\nclass Mine(Scene): pass\nOther = 3\n")
    assert find_class("mine.py:Mine", room, Scene, folder=tmp_path).__name__ == "Mine"
    assert find_class("mine.py:Mine", room, Scene, folder=tmp_path, trust=False).__name__ == "Mine"
    with pytest.raises(InputError, match="mine.py:Other is not a concrete Scene; mine.py defines"):
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


def test_all_problems_of_attributes_are_reported():
    found = attribute_problems(SlowWalker, {"paus": "1", "pause": "x"}, also=["name"])
    assert found == {
        "paus": "has no attribute 'paus', did you mean 'pause'?; it takes pause, name",
        "pause": "pause: 'x' is not a number",
    }
    assert attribute_problems(SlowWalker, {"nam": "1"}, also=["name"]) == {
        "nam": "has no attribute 'nam', did you mean 'name'?; it takes pause, name",
        "pause": "needs the attribute 'pause'",
    }
    assert attribute_problems(SlowWalker, {"pause": "-1"}) == {}  # only the types are checked
    long = attribute_problems(FastWalker, {"x" * 50: "1"})["x" * 50]
    assert long.startswith(f"has no attribute {'x' * 40!r};")


def test_fields_and_their_names():
    assert required_fields(SlowWalker) == ["pause"]
    assert required_fields(FastWalker) == []
    assert attribute_names(FastWalker) == ["speed", "count", "label", "brave", "box"]


@pytest.mark.parametrize(
    ("text", "number"), [("+3", 3), (" -4 ", -4), ("9" * 18, 10**18 - 1), ("9" * 19, None), ("", None)]
)
def test_whole_numbers_have_at_most_18_digits(text, number):
    if number is None:
        with pytest.raises(InputError, match="is not a int"):
            from_attributes(FastWalker, {"count": text})
    else:
        assert from_attributes(FastWalker, {"count": text}).count == number


def test_untrusted_files_of_the_folder_are_loaded_once(tmp_path):
    (tmp_path / "once.py").write_text("from crowdbot.core import Scene\nclass Once(Scene): pass\n")
    first = find_class("once.py:Once", room, Scene, folder=tmp_path, trust=False)
    assert find_class("once.py:Once", room, Scene, folder=tmp_path) is first


def test_the_sources_of_a_class_are_all_files_of_its_folder(tmp_path):
    for name in ("lab/__init__.py", "lab/walks.py", "lab/deep/more.py", "alone.py"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("from crowdbot.core import Scene\nclass Mine(Scene): pass\n")
    folder = find_class("lab/:walks.Mine", room, Scene, folder=tmp_path)
    found = {path.relative_to(tmp_path).as_posix() for path in sources_of(folder)}
    assert found == {"lab/__init__.py", "lab/walks.py", "lab/deep/more.py"}
    assert sources_of(find_class("alone.py:Mine", room, Scene, folder=tmp_path)) == (tmp_path / "alone.py",)
    assert sources_of(FastWalker) == ()


def test_a_module_is_an_address():
    assert find_class("crowdbot.core.scene:Scene", room, Scene) is Scene
    with pytest.raises(InputError, match="the module 'no.such' cannot be imported"):
        find_class("no.such:Scene", room, Scene)
    with pytest.raises(InputError, match="crowdbot.core.scene:Walls is not a concrete Scene; .* defines Scene"):
        find_class("crowdbot.core.scene:Walls", room, Scene)
