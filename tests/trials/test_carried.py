"""Files that a trial names travel with its recording: it replays where only the recording is."""

from __future__ import annotations

import dataclasses
import json
import shutil
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap.writer import Writer
from trial_texts import GOOD, SHY

from crowdbot.cli import main
from crowdbot.core import EpisodeError
from crowdbot.trials import Trial, branch, carried, load_trial, read_episode, record, repair, replay
from crowdbot.trials.carried import Carried, named_files
from crowdbot.trials.recording import Recorder
from crowdbot.trials.run import opened

HALL = """<trial name="hall" duration="3" seed="1">
  <stage map="maps/hall.yaml" unknown="occupied"/>
  <crowd type="orca"/>
  <recorded data="people.txt" fps="2.5" mode="reactive" radius="0.2"/>
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
        held = {one.name: one.data for one in reader.iter_attachments()}
        summary = reader.get_summary()
    assert held == {name: (made / name).read_bytes() for name in NAMES}
    assert summary is not None
    assert summary.statistics is not None
    assert summary.statistics.attachment_count == len(summary.attachment_indexes) == 4
    rows = json.loads(read_episode(path).metadata["files"])
    assert {row["name"]: row["kind"] for row in rows} == dict.fromkeys(NAMES, "data") | {"shy.py": "code"}
    assert all(row["kept"] and len(row["digest"]) == 32 for row in rows)


def test_an_episode_replays_alone_when_its_code_is_trusted(moved: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(EpisodeError, match=r"needs the code 'shy.py', which does not lie in .* pass --trust"):
        replay(moved)
    assert main(["replay", str(moved)]) == 2
    assert "--trust" in capsys.readouterr().err
    assert main(["replay", str(moved), "--trust"]) == 0
    assert "replays to the same bytes" in capsys.readouterr().out
    assert [path.name for path in moved.parent.iterdir()] == ["episode.mcap"]


def test_code_beside_the_episode_is_used_without_trust(moved: Path) -> None:
    (moved.parent / "shy.py").write_text(SHY)
    assert replay(moved).equal
    (moved.parent / "shy.py").write_text(SHY.replace("0.8", "0.7"))
    assert not replay(moved).equal


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
    with opened(load_trial(made / "hall.xml"), out=tmp_path) as running:
        for _ in range(30):
            running.step()
        content = (tmp_path / "episode.mcap").read_bytes()
    torn = tmp_path / "torn" / "episode.mcap"
    torn.parent.mkdir()
    torn.write_bytes(content[:-40])
    assert replay(torn, trust=True).equal
    assert repair(torn) is not None
    with torn.open("rb") as stream:
        assert {one.name for one in make_reader(stream).iter_attachments()} == NAMES
    assert replay(torn, trust=True).equal


def test_large_files_are_named_and_not_kept(made: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(carried, "MOST", 200)
    record(load_trial(made / "hall.xml"), out=tmp_path)
    path = tmp_path / "episode.mcap"
    kept = {row["name"]: row["kept"] for row in json.loads(read_episode(path).metadata["files"])}
    assert (kept["maps/hall.yaml"], kept["maps/pictures/hall.pgm"]) == (True, False)
    with pytest.raises(EpisodeError, match=r"'maps/pictures/hall.pgm' of \d+ bytes, too large to be kept in it"):
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
        for one in list(reader.iter_attachments()):
            writer.add_attachment(0, 0, names.get(one.name, one.name), one.media_type, data or one.data)
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
    with pytest.raises(EpisodeError, match="names a file outside its folder"):
        replay(target, trust=True)


def test_files_that_were_changed_in_the_episode_are_refused(moved: Path, tmp_path: Path) -> None:
    target = rewritten(moved, tmp_path / "other.mcap", {}, b"other")
    with pytest.raises(EpisodeError, match=r"is damaged: the file '.*' in it is not the one that was recorded"):
        replay(target, trust=True)


def test_a_trial_without_files_keeps_none(tmp_path: Path) -> None:
    record(Trial.parse(GOOD), out=tmp_path)
    assert "files" not in read_episode(tmp_path / "episode.mcap").metadata


def test_elements_may_tell_of_their_files(made: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from crowdbot.trials import Robot

    monkeypatch.setattr(Robot, "files", lambda robot: (made / "people.txt",), raising=False)
    trial = dataclasses.replace(Trial.parse(GOOD), folder=made)
    assert set(named_files(trial)) == {"people.txt"}
    assert Carried("people.txt", "data", 0, "", True).lies_in(made) is False
    assert Recorder(tmp_path / "x.mcap", _tally(trial)).files[0][0].name == "people.txt"


def _tally(trial: Trial):  # type: ignore[no-untyped-def]
    from crowdbot.trials.tally import Tally

    return Tally(trial, 0)
