"""XML trees: content and line numbers, limits, and rejected files."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from crowdbot.core import (
    Element,
    InputError,
    TrialError,
    format_xml,
    parse_number,
    parse_xml,
    read_bytes,
    reject_entities,
)
from crowdbot.core.markup import xml_tree

DOCTYPE = b'<!DOCTYPE a [<!ENTITY e SYSTEM "file:///etc/passwd">]>\n<a>&e;</a>'


def test_a_tree_has_attributes_children_lines_and_text() -> None:
    root = parse_xml(b'<trial name="t">\n  <robot name="r"> first\n second </robot>\n  <stage/>\n</trial>', "t.xml")
    assert (root.tag, root.attributes, root.line, root.stray) == ("trial", {"name": "t"}, 1, "")
    assert [(child.tag, child.line) for child in root.children] == [("robot", 2), ("stage", 4)]
    assert root.children[0].stray == "first\n second"
    assert root.each("stage") == [root.children[1]]
    assert root.each("robots") == []


def test_only_the_first_text_is_kept_and_long_text_is_cut() -> None:
    assert parse_xml(b"<a>one<b/>two</a>", "t.xml").stray == "one"
    long = b"<a>" + b"x" * (xml_tree.MOST_TEXT + 1) + b"</a>"
    assert parse_xml(long, "t.xml").stray == "x" * xml_tree.MOST_TEXT


def test_written_trees_are_read_back() -> None:
    tree = Element("a", {"text": 'one "two" & <three>\n\t\r'}, [Element("b", {"n": "1"}, [Element("c")])])
    text = format_xml(tree)
    assert text.splitlines()[2:] == ['  <b n="1">', "    <c/>", "  </b>", "</a>"]
    xml = parse_xml(text.encode(), "t.xml")
    assert (xml.attributes, xml.children[0].attributes) == (tree.attributes, {"n": "1"})
    assert [child.tag for child in xml.children[0].children] == ["c"]


def test_the_encoding_can_be_given() -> None:
    assert parse_xml('<a name="é"/>'.encode("latin-1"), "t.xml", "iso-8859-1").attributes == {"name": "é"}
    with pytest.raises(InputError, match=r"t\.xml:1: this is not well-formed XML: .*invalid token"):
        parse_xml('<a name="é"/>'.encode("latin-1"), "t.xml")


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", "t.xml is empty; a trial is an XML file with the root element <trial>"),
        (b" \n", "t.xml is empty"),
        (b"<a>\n<b></a>", "t.xml:2: this is not well-formed XML: mismatched tag"),
        (b'<?xml version="1.0" encoding="no-such"?><a/>', "this is not well-formed XML: unknown encoding"),
        (DOCTYPE, "t.xml:1: a trial must not have a DOCTYPE or entities"),
    ],
)
def test_wrong_files_are_rejected(data: bytes, words: str) -> None:
    with pytest.raises(TrialError, match=words):
        parse_xml(data, "t.xml", what="trial", root="trial", refusal=TrialError)


@pytest.mark.parametrize(
    ("limit", "size", "data", "words"),
    [
        ("MOST_BYTES", 8, b"<a>1</a>", "larger than 7 bytes"),
        ("MOST_ELEMENTS", 3, b"<a><b/><c/></a>", "t.xml:1: more than 2 elements, which no file needs"),
        ("MOST_DEPTH", 3, b"<a><b><c/></b></a>", "more than 2 levels of elements"),
        ("MOST_ATTRIBUTES", 2, b'<a b="1" c="2"/>', "more than 1 attributes in one element"),
    ],
)
def test_limits_are_inclusive(monkeypatch: pytest.MonkeyPatch, limit: str, size: int, data: bytes, words: str) -> None:
    monkeypatch.setattr(xml_tree, limit, size)
    assert parse_xml(data, "t.xml").tag == "a"
    monkeypatch.setattr(xml_tree, limit, size - 1)
    with pytest.raises(InputError, match=words):
        parse_xml(data, "t.xml")


def test_entities_are_rejected_in_files_of_any_size(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(xml_tree, "MOST_BYTES", 10)
    monkeypatch.setattr(xml_tree, "MOST_ELEMENTS", 1)
    reject_entities(b'<a name="a mesh">\n<b>text</b></a>', "m.dae")
    with pytest.raises(TrialError, match=r"m\.dae:1: a mesh must not have a DOCTYPE"):
        reject_entities(DOCTYPE, "m.dae", TrialError)
    with pytest.raises(InputError, match=r"m\.dae:1: this is not well-formed XML"):
        reject_entities(b"<a><b></a>", "m.dae")


def test_files_are_read_up_to_one_byte_above_the_limit(tmp_path, monkeypatch) -> None:
    file = tmp_path / "t.xml"
    file.write_bytes(b"<a>123456</a>")
    assert read_bytes(file) == b"<a>123456</a>"
    monkeypatch.setattr(xml_tree, "MOST_BYTES", 4)
    assert read_bytes(file) == b"<a>12"
    with pytest.raises(TrialError, match=r"there is no trial file .*absent\.xml"):
        read_bytes(tmp_path / "absent.xml", "trial", TrialError)
    with pytest.raises(InputError, match=r"is not a file; pass a robot file"):
        read_bytes(tmp_path, "robot")


@pytest.mark.parametrize("text", ["1", "-1.5e-3", "+.5", "5.", " 2 ", "1e308", "0"])
def test_numbers_in_plain_notation(text: str) -> None:
    assert parse_number(text) == float(text)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("1e309", "is not finite"),
        ("nan", "is not finite"),
        ("-inf", "is not finite"),
        ("+Infinity", "is not finite"),
        ("1_000", "is no length"),
        ("0x10", "is no length"),
        (".", "is no length"),
        ("", "is no length"),
        ("1e99999", "is no length"),
        ("٣", "is no length"),
    ],
)
def test_other_texts_are_not_numbers(text: str, words: str) -> None:
    with pytest.raises(InputError, match=f"^{words}$"):
        parse_number(text, "is no length")


@given(st.text(alphabet="ab&<>\"'\n\r\t;", max_size=12))
def test_attributes_are_quoted_as_the_standard_library_does(value: str) -> None:
    from xml.sax.saxutils import quoteattr

    assert f"a={quoteattr(value)}/>" in format_xml(Element("trial", {"a": value}))
