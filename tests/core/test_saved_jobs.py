"""Results of jobs in files: whole or absent, and a damaged one is named."""

import numpy as np
import pytest

from crowdbot.core import InputError, run_saved_jobs


def load(file):
    with file.open("rb") as stream, np.load(stream, allow_pickle=False) as entries:
        return float(entries["value"])


def save(value, file):
    with file.open("wb") as stream:
        np.savez(stream, value=np.array(value))


def full(value, file):
    file.write_bytes(b"half")
    raise OSError(28, "No space left on device")


def run(folder, save=save):
    files = [folder / "deep" / f"{number}.npz" for number in range(2)]
    return dict(run_saved_jobs(float, ["1", "2"], files, save, load)), files


def test_a_damaged_result_is_named(tmp_path):
    results, files = run(tmp_path)
    assert results == {0: 1.0, 1: 2.0}
    assert run(tmp_path)[0] == results
    files[1].write_bytes(files[1].read_bytes()[:-40])
    with pytest.raises(InputError, match=r"1\.npz is damaged \(.+\); remove it to run its job again"):
        run(tmp_path)


def test_a_full_disk_leaves_no_half_written_result(tmp_path):
    with pytest.raises(InputError, match=r"cannot write .*0\.npz: No space left on device"):
        run(tmp_path, full)
    assert list((tmp_path / "deep").iterdir()) == []
