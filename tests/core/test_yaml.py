"""YAML files: plain data of limited size."""

from __future__ import annotations

import math
from typing import Any

import pytest

from crowdbot.core import InputError, parse_yaml


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("- 1\n- [2, 3]\n-\n  - x\n", [1, [2, 3], ["x"]]),
        ("a: 'x: y'\nb: \"# no\"\n", {"a": "x: y", "b": "# no"}),
        ("k:\n- 1\n- 2\nz: 3\n", {"k": [1, 2], "z": 3}),
        ("3", 3),
        ("{}", {}),
        ("", None),
        ("\ufeffa: 1", {"a": 1}),
        ("a: |\n  text\n  more\n", {"a": "text\nmore\n"}),
        ("a: &x {b: 2}\nc: *x\nd:\n  <<: *x\n  e: 3", {"a": {"b": 2}, "c": {"b": 2}, "d": {"b": 2, "e": 3}}),
        ("a: !degrees 90\nb: !radians 2", {"a": math.pi / 2, "b": 2.0}),
        ("[1e5, 010, 1_000, .5, -2., +3]", [1e5, 10, 1000, 0.5, -2.0, 3]),
        ("[yes, Off, TRUE, ~, null, y, 0x1f]", [True, False, True, None, None, "y", "0x1f"]),
        ("[12:30, 2020-01-01, 1.2.3, =]", ["12:30", "2020-01-01", "1.2.3", "="]),
        ("[.inf, -.inf]", [math.inf, -math.inf]),
        ("a: !!str 5", {"a": "5"}),
    ],
)
def test_forms_of_yaml(text: str, value: Any) -> None:
    yaml = parse_yaml(text, "m.yaml")
    assert yaml == value
    assert repr(yaml) == repr(value)  # types, too: True == 1


LAUGHS = "a0: &a0 [1, 1]\n" + "".join(f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 10)}]\n" for k in range(1, 8))


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("a: !!python/object:os.system x", "w.yaml:1: the tag '!!python/object:os.system' is not supported"),
        ("a: 1\nb: !include x", "w.yaml:2: the tag '!include' is not supported; only !degrees and !radians are"),
        ("a: !!binary aGVsbG8=", "w.yaml:1: the tag '!!binary' is not supported"),
        ("a: !degrees north", "w.yaml:1: 'north' is not a number"),
        ("a: !!int 1.5", "w.yaml:1: 1.5 is not a whole number"),
        ("a: !!bool maybe", "w.yaml:1: 'maybe' is not a truth value"),
        ("a: [1, 2", "w.yaml:1: expected ',' or ']'"),
        ("a:\n\t- 1", "w.yaml:2: found character '\\t'"),
        ("a: 1\n   b: 2", "w.yaml:2: mapping values are not allowed here"),
        ("a: 'x", "w.yaml:1: found unexpected end of stream"),
        ("a: 1\n---\nb: 2", "w.yaml:2: but found another document"),
        ("? [1, 2]\n: 3", "w.yaml:1: found unhashable key"),
        ("a: " + "[" * 50 + "]" * 50, "w.yaml is nested more than 20 levels deep"),
        ("[" * 100_000, "w.yaml is nested more than 20 levels deep"),
        ("a: &a [*a]", "w.yaml is nested more than 20 levels deep, or an alias contains itself"),
        (LAUGHS, "w.yaml has more than 200000 values with its aliases"),
        ("\n" * 20_000, "w.yaml has more than 20000 lines"),
        ("a: \x00", "w.yaml is not YAML: unacceptable character"),
    ],
)
def test_other_yaml_is_refused(text: str, sentence: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_yaml(text, "w.yaml")
    assert sentence in str(caught.value)
