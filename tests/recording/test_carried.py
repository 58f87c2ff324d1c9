"""Files that a trial names travel with its recording: it replays where only the recording is."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap.writer import Writer

from crowdbot.cli import main
from crowdbot.core import EpisodeError
from crowdbot.recording import (
    AttachedFile,
    Recorder,
    SkippedAttachmentWarning,
    attachments,
    branch,
    named_files,
    open_run,
    read_episode,
    record,
    repair,
    replay,
)
from crowdbot.trials import Trial, load_trial, parse_trial
from trial_texts import GOOD, SHY

HALL = """<trial name="hall" duration="3" seed="1">
  <stage map="maps/hall.yaml" unknown="occupied"/>
  <crowd type="orca"/>
  <recorded data="people.txt" fps="25" mode="reactive" radius="0.2"/>
  <agent x="3" y="3" goal="6,3"/>
  <robot name="robot" x="2" y="2" radius="0.3">
    <goal x="7" y="2"/>
    <drive type="differential-drive"/>
    <navigator type="shy.py:Shy"/>
  </robot>
  <end collision="false"/>
</trial>
"""
YAML = "image: pictures/hall.pgm\nresolution: 0.5\norigin: [0, 0, 0]\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
NAMES = {"maps/hall.yaml", "maps/pictures/hall.pgm", "people.txt", "shy.py"}


def hall(folder: Path) -> Path:
    """Write a trial that names a map, a recording and code."""
    (folder / "maps" / "pictures").mkdir(parents=True)
    (folder / "maps" / "hall.yaml").write_text(YAML)
    picture = [[0 if row in (0, 15) or column in (0, 19) else 254 for column in range(20)] for row in range(16)]
    rows = "\n".join(" ".join(map(str, line)) for line in picture)
    (folder / "maps" / "pictures" / "hall.pgm").write_text(f"P2\n20 16\n255\n{rows}\n")
    lines = [f"{frame * 10} {who} {2.5 + 0.3 * frame} {4.0 + who}" for frame in range(9) for who in (1, 2)]
    (folder / "people.txt").write_text("\n".join(lines) + "\n")
    (folder / "shy.py").write_text(SHY)
    (folder / "hall.xml").write_text(HALL)
    return folder / "hall.xml"


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of the trial with its episode in ``out``."""
    folder = tmp_path_factory.mktemp("hall")
    record(load_trial(hall(folder)), out=folder / "out")
    return folder


@pytest.fixture
def moved(made: Path, tmp_path: Path) -> Path:
    """Return the episode, alone, in another folder."""
    return Path(shutil.copy(made / "out" / "episode.mcap", tmp_path / "episode.mcap"))


def test_a_recording_keeps_what_its_trial_names(made: Path) -> None:
    assert set(named_files(load_trial(made / "hall.xml"))) == NAMES
    path = made / "out" / "episode.mcap"
    with path.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        held = {attachment.name: attachment.data for attachment in reader.iter_attachments()}
        summary = reader.get_summary()
    assert held == {name: (made / name).read_bytes() for name in NAMES}
    assert summary is not None
    assert summary.statistics is not None
    assert summary.statistics.attachment_count == len(summary.attachment_indexes) == 4
    rows = json.loads(read_episode(path).metadata["files"])
    assert {row["name"]: row["kind"] for row in rows} == dict.fromkeys(NAMES, "data") | {"shy.py": "code"}
    assert all(row["kept"] and len(row["digest"]) == 32 for row in rows)


def test_an_episode_replays_alone_when_its_code_is_trusted(moved: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(EpisodeError, match=r"needs the code 'shy.py', which does not exist in .* use --trust"):
        replay(moved)
    assert main(["replay", str(moved)]) == 2
    assert "--trust" in capsys.readouterr().err
    assert main(["replay", str(moved), "--trust"]) == 0
    assert "replays with the same digest" in capsys.readouterr().out
    assert [path.name for path in moved.parent.iterdir()] == ["episode.mcap"]


@pytest.mark.parametrize("verb", [["render", "--at", "0.2"], ["export"]])
def test_films_and_pages_of_an_episode_take_the_folder_of_its_code(
    made: Path, moved: Path, verb: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    out = moved.with_name("film.png" if verb[0] == "render" else "page.html")
    words = [*verb, str(moved), "--out" if verb[0] == "render" else "--to", str(out)]
    assert main(words) == 2
    assert "name its folder with --folder" in capsys.readouterr().err
    assert main([*words, "--folder", str(made)]) == 0
    assert out.stat().st_size > 1000


def test_code_beside_the_episode_runs_without_trust_only_as_it_was_recorded(
    moved: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (moved.parent / "shy.py").write_text(SHY)
    assert replay(moved).equal
    (moved.parent / "shy.py").write_text(SHY.replace("0.8", "0.7"))
    for again in (lambda: replay(moved), lambda: branch(moved, 1.0)):
        with pytest.raises(EpisodeError, match=r"the code 'shy.py', which differs in .* --trust"):
            again()
    assert main(["replay", str(moved)]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    done = replay(moved, trust=True)
    assert (done.equal, done.changed) == (False, ("shy.py",))
    assert str(done).endswith("; shy.py differs from the recorded code")


def test_everything_beside_the_episode_but_other_code_is_refused_too(made: Path, tmp_path: Path) -> None:
    shutil.copytree(made, tmp_path / "all")
    path = Path(shutil.copy(made / "out" / "episode.mcap", tmp_path / "all" / "episode.mcap"))
    assert replay(path).equal
    with (tmp_path / "all" / "shy.py").open("a") as file:
        file.write("raise SystemExit('ran')\n")
    with pytest.raises(EpisodeError, match="differs in .* from the recorded code"):
        replay(path)


def test_code_in_an_episode_is_not_run_untrusted(made: Path, tmp_path: Path) -> None:
    folder = tmp_path / "trap"
    folder.mkdir()
    trial = hall(folder)
    (folder / "shy.py").write_text(
        f"import pathlib\npathlib.Path({str(tmp_path / 'ran')!r}).touch(exist_ok=False)\n{SHY}"
    )
    record(load_trial(trial), out=tmp_path / "out")
    (tmp_path / "ran").unlink()
    shutil.rmtree(folder)
    with pytest.raises(EpisodeError, match="--trust"):
        replay(tmp_path / "out" / "episode.mcap")
    with pytest.raises(EpisodeError, match="--trust"):
        branch(tmp_path / "out" / "episode.mcap", 1.0)
    assert not (tmp_path / "ran").exists()


def test_data_are_those_that_were_recorded_and_not_those_beside(moved: Path) -> None:
    (moved.parent / "people.txt").write_text("0 1 2 3\n10 1 2 4\n")
    assert replay(moved, trust=True).equal


def test_branches_take_their_files_along(moved: Path, tmp_path: Path) -> None:
    first = branch(moved, 1.0, out=tmp_path / "a", trust=True, seed=5)
    assert first.path is not None
    moved.unlink()
    second = branch(first.path, 2.0, out=tmp_path / "b", trust=True)
    assert second.digest == first.digest
    assert second.path is not None
    assert replay(second.path, trust=True).equal


def test_a_killed_run_has_its_files_too(made: Path, tmp_path: Path) -> None:
    with open_run(load_trial(made / "hall.xml"), out=tmp_path) as running:
        for _ in range(30):
            running.step()
        content = (tmp_path / "episode.mcap").read_bytes()
    torn = tmp_path / "torn" / "episode.mcap"
    torn.parent.mkdir()
    torn.write_bytes(content[:-40])
    assert replay(torn, trust=True).equal
    assert repair(torn) is not None
    with torn.open("rb") as stream:
        assert {attachment.name for attachment in make_reader(stream).iter_attachments()} == NAMES
    assert replay(torn, trust=True).equal


def test_large_files_are_named_and_not_kept(made: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(attachments, "MOST", 200)
    with pytest.warns(
        SkippedAttachmentWarning,
        match=r"does not contain 'maps/pictures/hall.pgm', .* \(too large, at most 200 bytes in total",
    ):
        record(load_trial(made / "hall.xml"), out=tmp_path)
    path = tmp_path / "episode.mcap"
    kept = {row["name"]: row["kept"] for row in json.loads(read_episode(path).metadata["files"])}
    assert (kept["maps/hall.yaml"], kept["maps/pictures/hall.pgm"]) == (True, False)
    with pytest.raises(EpisodeError, match=r"'maps/pictures/hall.pgm' of \d+ bytes, too large to be stored in it"):
        replay(path, trust=True)
    for name in NAMES:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(made / name, tmp_path / name)
    assert replay(path).equal


def rewritten(source: Path, target: Path, names: dict[str, str], data: bytes | None = None) -> Path:
    """Copy an episode with other names of its files, or other content."""
    with source.open("rb") as old, target.open("wb") as new:
        reader, writer = make_reader(old), Writer(new)
        writer.start(profile="ros2")
        for record_ in list(reader.iter_metadata()):
            values = dict(record_.metadata)
            if "files" in values:
                rows = json.loads(values["files"])
                for row in rows:
                    row["name"] = names.get(row["name"], row["name"])
                values["files"] = json.dumps(rows)
            writer.add_metadata(record_.name, values)
        for attachment in list(reader.iter_attachments()):
            writer.add_attachment(
                0, 0, names.get(attachment.name, attachment.name), attachment.media_type, data or attachment.data
            )
        schemas: dict[int, int] = {}
        channels: dict[int, int] = {}
        for schema, channel, message in reader.iter_messages(log_time_order=False):
            assert schema is not None
            if channel.id not in channels:
                schemas[channel.id] = writer.register_schema(schema.name, schema.encoding, schema.data)
                channels[channel.id] = writer.register_channel(channel.topic, "cdr", schemas[channel.id])
            writer.add_message(channels[channel.id], message.log_time, message.data, message.publish_time)
        writer.finish()
    return target


@pytest.mark.parametrize("name", ["../evil.txt", "/tmp/evil.txt", "a\\..\\evil.txt", "C:evil.txt", "maps/../../x", ""])
def test_names_that_lead_outside_are_refused(moved: Path, tmp_path: Path, name: str) -> None:
    target = rewritten(moved, tmp_path / "other.mcap", {"people.txt": name})
    with pytest.raises(EpisodeError, match="lists a file outside its folder"):
        replay(target, trust=True)


def test_files_that_were_changed_in_the_episode_are_refused(moved: Path, tmp_path: Path) -> None:
    target = rewritten(moved, tmp_path / "other.mcap", {}, b"other")
    with pytest.raises(EpisodeError, match=r"is damaged: the attached file '.*' differs from its digest"):
        replay(target, trust=True)


def test_a_trial_without_files_keeps_none(tmp_path: Path) -> None:
    record(parse_trial(GOOD), out=tmp_path)
    assert "files" not in read_episode(tmp_path / "episode.mcap").metadata


def test_elements_may_tell_of_their_files(made: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from crowdbot.trials import RobotSpec

    monkeypatch.setattr(RobotSpec, "files", lambda robot: (made / "people.txt",), raising=False)
    trial = dataclasses.replace(parse_trial(GOOD), folder=made)
    assert set(named_files(trial)) == {"people.txt"}
    assert AttachedFile("people.txt", "data", 0, "", True).lies_in(made) is False
    assert Recorder(tmp_path / "x.mcap", _tally(trial)).files[0][0].name == "people.txt"


TRAP = "import pathlib\npathlib.Path({mark!r}).touch()\n" + SHY


def retold(source: Path, target: Path, change: Callable[[dict[str, str]], None], attached: dict[str, bytes]) -> Path:
    """Copy an episode with other metadata and other files in it, as somebody hostile may."""
    with source.open("rb") as old, target.open("wb") as new:
        reader, writer = make_reader(old), Writer(new)
        writer.start(profile="ros2")
        held = {attachment.name: attachment.data for attachment in reader.iter_attachments()} | attached
        for name, data in held.items():
            writer.add_attachment(0, 0, name, "", data)
        for record_ in list(reader.iter_metadata()):
            values = dict(record_.metadata)
            if "trial" in values:
                change(values)
            writer.add_metadata(record_.name, values)
        channels: dict[int, int] = {}
        for schema, channel, message in reader.iter_messages(log_time_order=False):
            assert schema is not None
            if channel.id not in channels:
                number = writer.register_schema(schema.name, schema.encoding, schema.data)
                channels[channel.id] = writer.register_channel(channel.topic, "cdr", number)
            writer.add_message(channels[channel.id], message.log_time, message.data, message.publish_time)
        writer.finish()
    return target


def row_of(name: str, data: bytes, **more: object) -> dict[str, object]:
    digest = hashlib.blake2b(data, digest_size=16).hexdigest()
    return {"name": name, "kind": "data", "size": len(data), "digest": digest, "kept": True} | more


@pytest.mark.parametrize("name", ["shy.py", "__pycache__/shy.cpython-312.pyc", "SHY.PY", "shy.py."])
def test_an_episode_cannot_pass_code_off_as_data(moved: Path, tmp_path: Path, name: str) -> None:
    trap = TRAP.format(mark=str(tmp_path / "ran")).encode()

    def change(values: dict[str, str]) -> None:
        rows = [row for row in json.loads(values["files"]) if row["kind"] == "data"]
        values["files"] = json.dumps([*rows, row_of(name, trap)])

    target = retold(moved, tmp_path / "other.mcap", change, {name: trap})
    with pytest.raises(EpisodeError, match="needs the code '.*', which does not exist in .*--trust"):
        replay(target)
    assert not (tmp_path / "ran").exists()


@pytest.mark.parametrize("how", ["trial", "origin", "robot", "sweep"])
def test_code_of_which_the_episode_does_not_tell_is_not_run(tmp_path: Path, how: str) -> None:
    record(parse_trial(GOOD), out=tmp_path / "out")
    (tmp_path / "trap.py").write_text(TRAP.format(mark=str(tmp_path / "ran")))
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "trap.py").write_text(TRAP.format(mark=str(tmp_path / "ran")))
    (tmp_path / "mine" / "robot.xml").write_text('<robot><drive type="trap.py:Shy"/></robot>')
    trap = GOOD.replace('type="straight"', 'type="trap.py:Shy"')
    if how == "robot":
        trap = GOOD.replace('<robot name="robot"', '<robot name="robot" type="mine"')
    if how == "sweep":
        trap = GOOD.replace("<stage", '<sweep path="robot/navigator/type" values="straight trap.py:Shy"/><stage', 1)

    def change(values: dict[str, str]) -> None:
        if how == "origin":
            values["origin"] = json.dumps([{"tick": 0, "trial": trap, "seed": 3}])
        else:
            values["trial"] = trap

    target = retold(tmp_path / "out" / "episode.mcap", tmp_path / "episode.mcap", change, {})
    with pytest.raises(EpisodeError, match=r"needs the code '(mine/)?trap.py' but has no digest .* --trust"):
        replay(target)
    with pytest.raises(EpisodeError, match="--trust"):
        branch(target, 1.0)
    assert not (tmp_path / "ran").exists()


def outside(folder: Path) -> Path:
    """Write the trial one folder deeper than what it names."""
    trial = hall(folder)
    (folder / "deep").mkdir()
    text = HALL.replace("maps/hall", "../maps/hall").replace("people.txt", "../people.txt")
    (folder / "deep" / "hall.xml").write_text(text.replace("shy.py", "../shy.py"))
    trial.unlink()
    return folder / "deep" / "hall.xml"


def test_files_outside_are_named_in_a_warning(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    trial = outside(tmp_path)
    out = tmp_path / "deep" / "out"
    assert main(["run", str(trial), "--trust", "--out", str(out), "--json"]) == 0
    told = capsys.readouterr().err.splitlines()
    assert told[0] == "crowdbot: loads code from ../shy.py"
    assert len(told) == 2
    assert told[1].startswith(
        "crowdbot: warning: the recording does not contain '../maps/hall.yaml', '../maps/pictures/hall.pgm',"
        " '../people.txt' and 1 more (outside the folder of the trial): to replay it, identical files must be"
    )
    assert told[1].endswith(
        "move files from outside into the folder of the trial, or copy them along with the recording"
    )
    with pytest.warns(SkippedAttachmentWarning, match="does not contain"):
        record(load_trial(trial, trust=True), out=tmp_path / "again")
    assert main(["run", str(trial), "--trust"]) == 0
    assert "warning" not in capsys.readouterr().err
    rows = {row["name"]: row for row in json.loads(read_episode(out / "episode.mcap").metadata["files"])}
    assert set(rows) == {f"../{name}" for name in NAMES}
    assert not any(row["kept"] for row in rows.values())
    assert rows["../people.txt"] == row_of("../people.txt", (tmp_path / "people.txt").read_bytes(), kept=False)


def test_files_outside_must_be_there_with_the_recorded_bytes(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    trial = outside(tmp_path)
    with pytest.warns(SkippedAttachmentWarning):
        record(load_trial(trial, trust=True), out=tmp_path / "deep" / "out")
    path = str(tmp_path / "deep" / "out" / "episode.mcap")

    def refused(*words: str) -> str:
        assert main(["replay", path, *words]) == 2
        told = capsys.readouterr().err
        assert [line for line in told.splitlines() if "loads code from" not in line] == told.splitlines()[-1:]
        return told

    assert "outside the folder of its trial; pass --trust to allow it" in refused()
    assert "does not exist in" in refused("--trust")
    where = ["--trust", "--folder", str(tmp_path / "deep")]
    assert main(["replay", path, *where]) == 0
    assert main(["branch", path, "--at", "1", *where]) == 0
    capsys.readouterr()
    (tmp_path / "people.txt").write_text((tmp_path / "people.txt").read_text().replace("2.5", "2.6"))
    assert "'../people.txt' outside the folder of its trial" in (told := refused(*where))
    assert "has a different content; restore the recorded file" in told


def test_files_outside_and_inside_meet_in_a_folder_for_the_time(tmp_path: Path) -> None:
    trial = outside(tmp_path)
    (tmp_path / "people.txt").rename(tmp_path / "deep" / "people.txt")
    trial.write_text(trial.read_text().replace("../people.txt", "people.txt"))
    with pytest.warns(SkippedAttachmentWarning):
        first = record(load_trial(trial, trust=True), out=tmp_path / "deep")
    (tmp_path / "deep" / "people.txt").unlink()
    done = replay(tmp_path / "deep" / "episode.mcap", trust=True)
    assert (done.equal, done.replayed) == (True, first.digest)


def test_a_robot_folder_keeps_its_code_as_code_and_no_caches(tmp_path: Path) -> None:
    from shutil import copytree

    from crowdbot.trials.robot import _assets

    copytree(_assets("turtlebot2"), tmp_path / "mine")
    (tmp_path / "mine" / "more.py").write_text("")
    (tmp_path / "mine" / "__pycache__").mkdir()
    (tmp_path / "mine" / "__pycache__" / "more.pyc").write_text("")
    robot = '<robot type="mine" default-sensors="false" x="0" y="0"><goal x="9" y="0"/>'
    text = f'<trial name="t" duration="1"><crowd type="orca"/>{robot}'
    (tmp_path / "t.xml").write_text(f'{text}<navigator type="straight"/></robot></trial>')
    found = named_files(load_trial(tmp_path / "t.xml"))
    assert {name for name, (kind, _) in found.items() if kind == "code"} == {"mine/more.py"}
    assert "mine/robot.xml" in found
    assert not any("__pycache__" in name for name in found)


def _tally(trial: Trial):  # type: ignore[no-untyped-def]
    from crowdbot.simulation import EpisodeStatistics

    return EpisodeStatistics(trial, 0)
