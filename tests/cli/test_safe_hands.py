"""Full disks, places that cannot be written, closed or narrow standard streams, Ctrl-C: one sentence, no trace."""

import contextlib
import io
import os
import signal
import stat
import subprocess
import sys
from pathlib import Path

import pytest

import crowdbot as cb
from crowdbot.cli import main
from crowdbot.core import InputError, lock_output
from samples import sample

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="limits and permissions of POSIX")
SOURCES = Path(cb.__file__).parents[1]
LIMITED = """
import resource, signal, sys
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
limit = int(sys.argv.pop(1))
resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
from crowdbot.cli import main
raise SystemExit(main(sys.argv[1:]))
"""
SHORT = ("--set", "duration=0.5")
PREDICT = ("predict", "--data", "walk.txt", "--predictor", "constant-velocity")
CALIBRATE = ("calibrate", "--data", "walk.txt", "--budget", "10")


@pytest.fixture
def folder(tmp_path):
    """Return a folder with a short recording."""
    rows = (f"{10 * k}\t{who}\t{0.5 * k}\t{2 * who}\n" for k in range(21) for who in (1, 2))
    (tmp_path / "walk.txt").write_text("".join(rows))
    return tmp_path


def run(folder, *command, text="", **options):
    environment = {**os.environ, "PYTHONPATH": str(SOURCES), "CROWDBOT_DEBUG": "", **options}
    return subprocess.run(
        [sys.executable, *map(str, command)], cwd=folder, env=environment, input=text, capture_output=True, text=True
    )


def run_limited(folder, limit, *words):
    """Run the program where no file may be larger than ``limit`` bytes, as on a full disk."""
    return run(folder, "-B", "-c", LIMITED, str(limit), *words)


@pytest.fixture
def run_here(tmp_path, monkeypatch, capsys):
    """Return a function that runs a command in this process, where no file may be larger than ``limit`` bytes."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("CROWDBOT_DEBUG", "")

    def call(limit, *words):
        with file_limit(limit):
            status = main(list(map(str, words)))
        return subprocess.CompletedProcess(words, status, *capsys.readouterr())

    return call


@contextlib.contextmanager
def file_limit(limit):
    """Let no file be larger inside the block; Python ignores the signal, so that a write fails as on a full disk."""
    import resource

    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def last_line(done):
    assert done.returncode == 2, done.stderr
    assert "Traceback" not in done.stderr + done.stdout
    return done.stderr.splitlines()[-1]


def written(folder):
    return {path.name for path in folder.rglob("*") if path.is_file()} - {"walk.txt"}


NEW = [["trial", "t.xml"], ["navigator", "t.py"], ["schema", "t.xsd"], ["robot", "t"]]


def assert_new_failed(done, folder):
    assert done.returncode == 2
    assert done.stderr.startswith("crowdbot: cannot write ")
    assert done.stderr.endswith(": File too large\n")
    assert done.stderr.count("\n") == 1
    assert [path for path in folder.rglob("*") if path.is_file()] == []


@pytest.mark.program
def test_the_program_on_a_full_disk_prints_one_sentence_and_leaves_no_file(tmp_path):
    assert_new_failed(run_limited(tmp_path, 200, "new", *NEW[0]), tmp_path)


@pytest.mark.parametrize("words", NEW)
def test_new_on_a_full_disk_is_one_sentence_and_leaves_no_file(words, run_here, tmp_path):
    assert_new_failed(run_here(200, "new", *words), tmp_path)


def test_a_device_is_not_replaced(run_here, tmp_path):
    device = tmp_path / "device"
    os.mkfifo(device)
    done = run_here(3000, "new", "trial", device, "--force")
    assert last_line(done) == f"crowdbot: {device} is a device; give the path of a file"
    with pytest.raises(InputError, match="is a device; give the path of a file"), lock_output(device, force=True):
        pass
    assert [path.name for path in tmp_path.iterdir()] == ["device"]
    assert stat.S_ISFIFO(device.stat().st_mode)


def test_a_copy_of_a_recording_on_a_full_disk_is_one_sentence_and_leaves_no_file(folder, run_here):
    (folder / "trials").mkdir()
    done = run_here(200, "new", "trial", "trials/t.xml", "--recorded", "walk.txt")
    assert last_line(done) == f"crowdbot: cannot write {Path('trials/walk.txt')}: File too large"
    assert written(folder) == set()
    assert not (folder / "trials" / "walk.txt").exists()


FULL = {
    "predict": (200, PREDICT, "out/parts/"),
    "run": (3000, ("run", "frontal", *SHORT), "out/episode.mcap"),
    "demo": (200, ("demo",), "out/episode.mcap"),
    "calibrate": (200, CALIBRATE, "out/parts/"),
}


@pytest.mark.parametrize("command", sample(FULL, 2))
def test_a_full_disk_is_one_sentence_that_names_the_file(folder, run_here, command):
    limit, words, what = FULL[command]
    done = run_here(limit, *words, "--out", "out")
    line = last_line(done)
    assert line.startswith(f"crowdbot: cannot write {what}")
    assert line.endswith(": File too large")
    assert written(folder) == set()


@pytest.mark.sweep
def test_a_full_disk_at_the_last_plot_names_the_folder(folder):
    assert last_line(run_limited(folder, 20_000, *PREDICT, "--out", "out")) == (
        "crowdbot: cannot write out: File too large"
    )
    assert not any(name.endswith(".part") for name in written(folder))


PLACES = {"file": "walk.txt", "below a file": "walk.txt/deep", "system": "/proc/crowdbot"}


@pytest.mark.parametrize("place", PLACES.values(), ids=PLACES)
@pytest.mark.parametrize(
    "words", [["run", "frontal", *SHORT], ["demo"], PREDICT, CALIBRATE], ids=["run", "demo", "predict", "calibrate"]
)
def test_a_place_that_cannot_be_written_is_one_sentence(folder, monkeypatch, capsys, words, place):
    monkeypatch.chdir(folder)
    before = (folder / "walk.txt").read_bytes()
    assert main([*words, "--out", place]) == 2
    line = capsys.readouterr().err.splitlines()[-1]
    assert line.startswith((f"crowdbot: cannot write {place}", f"crowdbot: {place} is a file"))
    assert written(folder) == set()
    assert (folder / "walk.txt").read_bytes() == before


@pytest.mark.parametrize("place", ["/proc/t.xml", "walk.txt/t.xml"])
def test_a_trial_in_a_place_that_cannot_be_written_is_one_sentence(folder, monkeypatch, capsys, place):
    monkeypatch.chdir(folder)
    assert main(["new", "trial", place]) == 2
    err = capsys.readouterr().err
    assert err.startswith("crowdbot: ")
    assert err.count("\n") == 1
    assert written(folder) == set()


@pytest.mark.program
@pytest.mark.parametrize("streams", sample(["<&-", "</dev/null", "<&- >&-"], 1))
def test_an_experiment_without_an_input_waits_in_one_sentence(folder, streams):
    command = f"{sys.executable} -m crowdbot experiment run robot-speed --participant 1 --out out {streams}"
    done = subprocess.run(
        command, shell=True, cwd=folder, capture_output=True, text=True, env={**os.environ, "PYTHONPATH": str(SOURCES)}
    )
    assert last_line(done).endswith("crowdbot: the input ended before welcome.age; continue later with --resume")
    assert "session.jsonl" in written(folder)


@pytest.mark.program
@pytest.mark.parametrize("words", sample([PREDICT, ("run", "frontal", *SHORT)], 1), ids=["predict", "run"])
@pytest.mark.parametrize("closed", sample(["<&- >&- 2>&-", ">&-"], 1))
def test_commands_end_well_with_closed_streams(folder, words, closed):
    command = " ".join([sys.executable, "-m", "crowdbot", *words, closed])
    done = subprocess.run(
        command, shell=True, cwd=folder, capture_output=True, text=True, env={**os.environ, "PYTHONPATH": str(SOURCES)}
    )
    assert (done.returncode, done.stdout) == (0, "")
    assert "Traceback" not in done.stderr


def test_questions_are_printed_to_an_output_of_ascii(folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    monkeypatch.setattr(sys, "stdin", io.StringIO("30\n"))
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(io.BytesIO(), encoding="ascii"))
    assert main(["experiment", "run", "robot-speed", "--participant", "1", "--out", "out"]) == 2
    assert capsys.readouterr().err.splitlines()[-1].startswith("crowdbot: the input ended before ")
    assert b"How often do you meet robots?" in sys.stdout.buffer.getvalue()


@pytest.mark.sweep
def test_scores_are_printed_to_an_output_of_ascii(folder):
    done = run(folder, "-m", "crowdbot", *PREDICT, PYTHONIOENCODING="ascii")
    assert (done.returncode, done.stdout.isascii(), done.stderr.isascii()) == (0, True, True)
    assert "walk.txt" in done.stdout


def hear_ctrl_c():
    """Undo what a shell does to programs in its background, whose children ignore Ctrl-C."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@pytest.mark.live
@pytest.mark.parametrize("workers", sample(["1", "2"], 1))
def test_predict_ends_soon_on_ctrl_c(folder, workers):
    rows = (f"{10 * k}\t{who}\t{0.5 * k + 0.01 * who}\t{0.7 * who}\n" for k in range(2000) for who in range(1, 40))
    (folder / "large.txt").write_text("".join(rows))
    words = ["predict", "--data", "large.txt", "--predictor", "simulated", "--model", "social-force", "--samples", "40"]
    process = subprocess.Popen(
        [sys.executable, "-m", "crowdbot", *words, "--workers", workers, "--out", "out"],
        cwd=folder, env={**os.environ, "PYTHONPATH": str(SOURCES)},
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=hear_ctrl_c,  # noqa: PLW1509
    )  # fmt: skip
    for line in process.stderr:
        if line.endswith("...\n"):
            break
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)  # the whole job takes many minutes
    assert (process.returncode, out) == (130, "")
    assert err.endswith("crowdbot: interrupted\n")
    assert "run the same command again to resume" in err
    assert "Traceback" not in err
