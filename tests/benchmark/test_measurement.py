"""The memory that benchmarks report."""

import subprocess
import sys

import pytest

CODE = """
import numpy as np
from crowdbot.benchmark.speed.measurement import peak_memory
before = peak_memory()
room = np.ones(2**25)
del room
print(before, peak_memory())
"""


@pytest.mark.program
def test_peak_memory_counts_an_array_that_is_gone():
    done = subprocess.run([sys.executable, "-c", CODE], capture_output=True, text=True, check=True)
    before, after = map(float, done.stdout.split())
    assert 5.0 < before < 2000.0
    assert 200.0 < after - before < 300.0  # the array has 256 MiB
