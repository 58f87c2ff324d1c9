"""Wrong input: one sentence on stderr, status 2, no stack trace, nothing half-written."""

import sys

import pytest

from crowdbot.cli import main

OBSMAT_ROWS = "\n".join(f"{10 * k}\t1\t{0.5 * k}\t0.0" for k in range(25))
TRIAL = """<trial name="t" duration="2" step="0.05">
  <crowd type="orca"/>
  <stage><obstacle points="4,-1 6,-1 6,1 4,1"/></stage>
  <spawner count="{count}" zone="{zone}" goal="10,-3 11,-3 11,3 10,3" {extra}/>
</trial>
"""
ZONE = "0,-3 3,-3 3,3 0,3"


def _assert_refused(capsys, tmp_path, arguments, *words):
    before = sorted(tmp_path.rglob("*"))
    status = main(arguments)
    said = capsys.readouterr()
    assert status == 2
    assert said.out == ""
    assert said.err.startswith("crowdbot: ")
    assert "Traceback" not in said.err
    for word in words:
        assert word in said.err, said.err
    assert sorted(tmp_path.rglob("*")) == before
    return said.err


def _file(tmp_path, name, content):
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return str(path)


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("empty.txt", "", ("empty",)),
        ("table.csv", "frame,person,east\n1,2,3\n2,2,4\n", ("table.csv", "column")),
        ("nan.csv", "frame,id,x,y\n0,1,0.0,0.0\n1,1,nan,0.0\n", ("nan.csv", "nan")),
        ("inf.csv", "frame,id,x,y\n0,1,0.0,0.0\n1,1,inf,0.0\n", ("inf.csv", "inf")),
        ("twice.txt", "0 1 0.0 0.0\n10 1 1.0 0.0\n10 1 1.0 0.5\n", ("twice.txt", "frame 10", "1")),
        ("noise.bin", bytes(range(256)) * 8, ("noise.bin",)),
    ],
)
def test_recordings(capsys, tmp_path, name, content, words):
    _assert_refused(capsys, tmp_path, ["predict", "--data", _file(tmp_path, name, content)], *words)


def test_a_missing_recording(capsys, tmp_path):
    _assert_refused(capsys, tmp_path, ["predict", "--data", str(tmp_path / "absent.txt")], "absent.txt")


def test_a_recording_that_is_too_short_says_why(capsys, tmp_path):
    path = _file(tmp_path, "short.txt", "\n".join(f"{10 * k}\t1\t{0.5 * k}\t0.0" for k in range(6)))
    _assert_refused(capsys, tmp_path, ["predict", "--data", path], "short.txt", "20")


def test_unknown_words_say_what_may_be_meant(capsys, tmp_path):
    path = _file(tmp_path, "one.txt", OBSMAT_ROWS)
    _assert_refused(capsys, tmp_path, ["predict", "--data", path, "--predictor", "kalmann"], "did you mean 'kalman'")
    _assert_refused(capsys, tmp_path, ["predict", "--data", path, "--protocol", "sgam"], "did you mean 'sgan'")
    _assert_refused(capsys, tmp_path, ["predict", "--data", path, "--set", "displacements"], "NAME=VALUE")
    _assert_refused(capsys, tmp_path, ["predict", "--data", path, "--set", "speed=3"], "has no attribute 'speed'")
    _assert_refused(capsys, tmp_path, ["list", "model"], "did you mean 'models'")
    _assert_refused(capsys, tmp_path, ["run", "crossing-flow"], "did you mean 'crossing-flows'")
    _assert_refused(capsys, tmp_path, ["cite", "orka"], "did you mean 'orca'")
    _assert_refused(capsys, tmp_path, ["bench", "orca"], "known are")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (TRIAL.format(count=3, zone=ZONE, extra="").replace("<crowd ", "<crowds "), ("t.xml:2", "crowds", "crowd")),
        (TRIAL.format(count=3, zone=ZONE, extra='sped="1"'), ("t.xml:4", "sped", "did you mean 'speed'")),
        (TRIAL.format(count=3, zone="4.5,-0.5 5.5,-0.5 5.5,0.5 4.5,0.5", extra=""), ("t.xml:4",)),
        (TRIAL.format(count=500, zone=ZONE, extra=""), ("t.xml:4", "500", "fit")),
        (TRIAL.format(count=3, zone=ZONE, extra='radius="-0.2"'), ("t.xml:4", "-0.2")),
        (TRIAL.format(count=3, zone=ZONE, extra='radius="nan"'), ("t.xml:4", "nan")),
        ("<trial name='t'", ("t.xml:1",)),
        ("", ("t.xml",)),
    ],
)
def test_trials(capsys, tmp_path, text, words):
    path = _file(tmp_path, "t.xml", text)
    _assert_refused(capsys, tmp_path, ["run", path, "--out", str(tmp_path / "out")], *words)
    assert main(["check", path]) == 2


def test_an_entity_bomb_and_external_entities_are_refused(capsys, tmp_path):
    secret = _file(tmp_path, "secret.txt", "do not read me")
    bomb = "".join(f'<!ENTITY e{k} "{f"&e{k - 1};" * 10 if k else "boom"}">' for k in range(12))
    body = '<trial name="t" duration="2" about="&{};"><crowd type="orca"/></trial>'
    for number, declared in enumerate((bomb, f'<!ENTITY e11 SYSTEM "file://{secret}">')):
        text = f"<!DOCTYPE trial [{declared}]>" + body.format("e11")
        error = _assert_refused(
            capsys, tmp_path, ["run", _file(tmp_path, f"bomb{number}.xml", text)], f"bomb{number}.xml:1"
        )
        assert "do not read me" not in error


def test_episodes(capsys, tmp_path):
    assert main(["run", "frontal", "--out", str(tmp_path / "whole")]) == 0
    whole = (tmp_path / "whole" / "episode.mcap").read_bytes()
    capsys.readouterr()
    for name, content in (
        ("cut.mcap", whole[: len(whole) // 2] + whole[-40:]),
        ("head.mcap", whole[:20]),
        ("none.mcap", b""),
    ):
        path = _file(tmp_path, name, content)
        _assert_refused(capsys, tmp_path, ["replay", path], name)
        _assert_refused(capsys, tmp_path, ["predict", "--data", path], name)
    _assert_refused(capsys, tmp_path, ["replay", str(tmp_path / "absent.mcap")], "absent.mcap")


@pytest.mark.parametrize(
    ("words", "message"),
    [(["qqq"], "'qqq' is not a command; crowdbot --help"), (["--debug", "runn", "x"], ", did you mean 'run'?")],
)
def test_an_unknown_command_is_a_usage_error(capsys, words, message):
    with pytest.raises(SystemExit, match="2"):
        main(words)
    assert message in capsys.readouterr().err


def test_an_interrupt_is_said_in_one_word(capsys, monkeypatch):
    from crowdbot import catalogue

    def interrupted(kind):
        raise KeyboardInterrupt

    monkeypatch.setattr(catalogue, "builtin_names", interrupted)
    assert main(["list"]) == 130
    assert capsys.readouterr().err == "crowdbot: interrupted\n"
    assert sys.stdout is not None
