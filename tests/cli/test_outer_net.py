"""What the program says and does about errors that nobody expected, and about closed or narrow standard streams."""

import io
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from crowdbot.cli import main
from crowdbot.core import CrowdbotError
from samples import sample

BUG = """
import crowdbot.cli.list as command

def main(options):
    print("half the output")
    raise {error}

command.main = main
from crowdbot.cli import main
raise SystemExit(main({words}))
"""


def crowdbot(*words, **options):
    return run([sys.executable, "-m", "crowdbot", *words], **options)


def run(command, environment=None, **options):
    settings = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "timeout": 120, **options}
    return subprocess.run(command, env={**os.environ, **(environment or {})}, **settings)


@pytest.fixture
def fail(monkeypatch, capsys, tmp_path):
    """Return a function that runs a command which raises an error after half of its output; traces go to tmp_path."""

    def run_command(error, words=("list",), debug=""):
        def broken(options):
            print("half the output")
            raise error

        monkeypatch.setattr("crowdbot.cli.list.main", broken)
        monkeypatch.setenv("CROWDBOT_DEBUG", debug)
        monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
        status = main(list(words))
        return status, *capsys.readouterr()

    return run_command


@pytest.mark.program
def test_an_unexpected_error_is_one_sentence_with_a_trace_in_a_file(tmp_path):
    program = BUG.format(error="ZeroDivisionError('nothing\\nto divide')", words=["list"])
    done = run([sys.executable, "-c", program], environment={"TMPDIR": str(tmp_path), "CROWDBOT_DEBUG": ""})
    assert done.returncode == 1
    assert done.stdout == "half the output\n"
    match = re.fullmatch(
        r"crowdbot: ZeroDivisionError: nothing to divide \(<string>, line \d+\); this is a bug in crowdbot or in your"
        r" code; the traceback is in (.+)\n",
        done.stderr,
    )
    assert match, done.stderr
    trace = Path(match.group(1))
    assert trace.parent == tmp_path
    assert "Traceback (most recent call last)" in trace.read_text(encoding="utf-8")
    assert "ZeroDivisionError: nothing\nto divide" in trace.read_text(encoding="utf-8")


@pytest.mark.parametrize(("words", "debug"), [(["--debug", "list"], ""), (["list", "--debug"], ""), (["list"], "1")])
def test_debug_prints_the_trace(fail, words, debug, tmp_path):
    status, _, printed = fail(KeyError("x"), words, debug)
    assert status == 1
    assert printed.startswith("Traceback (most recent call last)")
    assert printed.splitlines()[-1].startswith(f"crowdbot: KeyError: 'x' ({__file__}, line ")
    assert "the traceback is in" not in printed
    assert not list(tmp_path.iterdir())


def test_without_a_temporary_folder_the_trace_is_printed(fail, tmp_path):
    tmp_path.rmdir()
    status, _, printed = fail(KeyError("x"))
    assert status == 1
    assert printed.startswith("Traceback (most recent call last)")


@pytest.mark.parametrize(
    ("error", "status", "message"),
    [
        (CrowdbotError("no such thing"), 2, "crowdbot: no such thing\n"),
        (OSError(28, "No space left on device", "a.xml"), 2, "crowdbot: a.xml: No space left on device\n"),
        (EOFError(), 2, "crowdbot: standard input ended before all questions were answered\n"),
        (KeyboardInterrupt(), 130, "crowdbot: interrupted\n"),
        (BrokenPipeError(), 0, ""),
    ],
)
def test_errors_of_the_user_and_the_system_have_a_sentence_and_a_status(fail, error, status, message):
    assert fail(error, debug="0") == (status, "half the output\n", message)


@pytest.mark.program
@pytest.mark.parametrize("words", [["list"], ["--help"], ["list", "--help"], ["--version"]])
def test_a_reader_that_ends_early_is_no_error(words):
    reader, writer = os.pipe()
    os.close(reader)
    done = crowdbot(*words, stdout=writer)
    os.close(writer)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.program
@pytest.mark.skipif(sys.platform == "win32", reason="needs a POSIX shell")
@pytest.mark.parametrize("closed", sample(["<&- >&- 2>&-", "<&-", ">&-", "2>&-"], 1))
def test_closed_streams_are_no_error(closed):
    done = run(f"{sys.executable} -m crowdbot list {closed}", shell=True)
    assert (done.returncode, done.stderr) == (0, "")
    assert ("orca" in done.stdout) == (">&-" not in closed.replace("2>&-", ""))


@pytest.mark.program
@pytest.mark.skipif(sys.platform == "win32", reason="needs a POSIX shell")
def test_files_are_not_written_into_closed_streams(tmp_path):
    trial = tmp_path / "t.xml"
    done = run(f"{sys.executable} -m crowdbot new trial {trial} <&- >&- 2>&-", shell=True)
    assert done.returncode == 0
    assert trial.read_text().startswith("<?xml")


@pytest.mark.program
@pytest.mark.skipif(sys.platform != "linux", reason="/dev/full is a file of Linux")
def test_a_full_disk_behind_the_output_is_one_sentence(monkeypatch, capsys):
    sentence = "crowdbot: standard output: No space left on device\n"
    with Path("/dev/full").open("w", encoding="utf-8") as full:
        done = crowdbot("cite", "orca", stdout=full)
    assert (done.returncode, done.stderr) == (2, sentence)
    with Path("/dev/full").open("w", encoding="utf-8") as full:
        monkeypatch.setattr(sys, "stdout", full)
        assert main(["list"]) == 2
    assert capsys.readouterr().err == sentence


@pytest.mark.program
def test_an_output_of_ascii_prints_question_marks():
    done = run(
        [sys.executable, "-c", BUG.format(error="SystemExit(print('Molnár'))", words=["list"])],
        environment={"PYTHONIOENCODING": "ascii"},
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "half the output\nMoln?r\n", "")


@pytest.mark.parametrize("words", [["list"], ["cite", "social-force"], ["--help"], ["validate", "--help"]])
def test_commands_print_to_an_output_of_ascii(words, monkeypatch, capsys):
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(io.BytesIO(), encoding="ascii"))
    try:
        status = main(words)
    except SystemExit as end:  # of --help
        status = end.code
    assert (status, capsys.readouterr().err) == (0, "")
    assert sys.stdout.buffer.getvalue().isascii()
    assert sys.stdout.buffer.getvalue()
