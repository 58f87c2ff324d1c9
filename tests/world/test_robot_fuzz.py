"""Hostile xacro and robot files: a refusal in sentences, no trace, no hang, and no file outside."""

import numpy as np
import pytest
from base_texts import BASES, base_file
from xacro_texts import EXPANSIONS, HEAD

from crowdbot.core import InputError, RobotError, parse_xml
from crowdbot.world import import_robot
from crowdbot.world.xacro import expand_xacro
from samples import sizes

WORDS = (
    "${", "}", "$(", ")", "(", "[", "]", "{", "'", '"', "**", "9" * 20, "1e999", "lambda", "__class__", ".format",
    "for x in",
    " if ", "%s", "xacro:", "scope='parent'", "value=", "<", "/>", "&lt;", "\\x00", "../",
    "$(find a)", "$(eval ", "pi",
    ",", "range(9999)", "* 9999", "-", "not ", "name='p'", "params='*a **b c:=^'", "nan", "inf",
)  # fmt: skip


def damage(text, rng):
    """Return a text with words inserted, removed or doubled."""
    for _ in range(rng.integers(1, 6)):
        at = int(rng.integers(0, len(text)))
        until = at + int(rng.integers(0, 12))
        kind = rng.integers(3)
        word = WORDS[rng.integers(len(WORDS))] if kind == 0 else (text[at:until] * 2 if kind == 1 else "")
        text = text[:at] + word + text[until:]
    return text


@pytest.mark.parametrize("count", sizes(300, 10_000))
def test_damaged_xacro_is_refused_in_a_sentence(count):
    rng = np.random.default_rng(11)
    refused = read = unplaced = 0
    for _ in range(count):
        text = damage(f"{HEAD}{EXPANSIONS[rng.integers(len(EXPANSIONS))][0]}</robot>", rng)
        try:
            expand_xacro(parse_xml(text.encode(), "r.xacro"), "r.xacro", None)
            read += 1
        except InputError as error:
            refused += 1
            unplaced += not str(error).startswith("r.xacro")
    assert refused
    assert read
    assert unplaced == 0


@pytest.mark.parametrize("count", sizes(60, 3000))
def test_damaged_robots_are_refused_or_converted(tmp_path, count):
    rng = np.random.default_rng(13)
    path = tmp_path / "r.xacro"
    kinds = list(BASES)
    outcomes = {"read": 0, "refused": 0}
    for _ in range(count):
        path.write_text(damage(base_file(kinds[rng.integers(len(kinds))]), rng), encoding="utf-8")
        try:
            made = import_robot(path, "r")
            outcomes["read"] += bool(made.texts["robot.xml"])
        except (RobotError, InputError) as error:
            outcomes["refused"] += bool(str(error))
    assert min(outcomes.values()) > 0
    assert [item.name for item in tmp_path.iterdir()] == ["r.xacro"]
