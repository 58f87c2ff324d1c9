"""The lock of an output file: a process that was killed before it wrote its lock does not block the next one."""

import pytest

from crowdbot.core import lock_output

pytestmark = pytest.mark.live


def test_an_empty_lock_of_a_killed_process_is_taken_over(tmp_path):
    lock = tmp_path / ".episode.mcap.lock"
    lock.touch()
    with lock_output(tmp_path / "episode.mcap"):
        assert lock.read_text().split()[0].isdigit()
    assert not lock.exists()
