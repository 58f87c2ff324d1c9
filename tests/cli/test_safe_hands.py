"""Full disks: one sentence, no trace, no half-written file."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import crowdbot as cb

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="limits and permissions of POSIX")
SOURCES = Path(cb.__file__).parents[1]
LIMITED = """
import resource, signal, sys
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (200, 200))
from crowdbot.cli import main
raise SystemExit(main(sys.argv[1:]))
"""


def run(folder, *command, text="", **options):
    environment = {**os.environ, "PYTHONPATH": str(SOURCES), "CROWDBOT_DEBUG": "", **options}
    return subprocess.run(
        [sys.executable, *map(str, command)], cwd=folder, env=environment, input=text, capture_output=True, text=True
    )


@pytest.mark.parametrize("words", [["trial", "t.xml"], ["navigator", "t.py"], ["schema", "t.xsd"], ["robot", "t"]])
def test_new_on_a_full_disk_is_one_sentence_and_leaves_no_file(words, tmp_path):
    done = run(tmp_path, "-B", "-c", LIMITED, "new", *words)
    assert done.returncode == 2
    assert done.stderr.endswith("cannot be written: File too large\n")
    assert done.stderr.count("\n") == 1
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == []
