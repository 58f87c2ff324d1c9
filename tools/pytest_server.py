"""Runs of pytest in forks of one process that has loaded the large libraries, for ``mutate.py``.

Each line of standard input is an order: ``{"arguments": of pytest, "plan": of call_recorder.py, "printed": file of the
output, "cpu": limit in s, "memory": limit in byte}``. The answers are two lines: the process, and its exit status.
"""

from __future__ import annotations

import json
import os
import resource
import sys
from typing import Any

import hypothesis.stateful  # noqa: F401  (loaded once, for all forks)
import numba  # noqa: F401
import numpy as np  # noqa: F401
import pytest
import scipy.optimize
import scipy.spatial  # noqa: F401


def run(order: dict[str, Any]) -> int:
    """Run pytest as ordered, with its output in a file, and return the exit status."""
    os.setsid()
    printed = os.open(order["printed"], os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    for source, target in ((os.open(os.devnull, os.O_RDONLY), 0), (printed, 1), (printed, 2)):
        os.dup2(source, target)
    os.environ["CALL_RECORDER"] = order["plan"]
    resource.setrlimit(resource.RLIMIT_CPU, (order["cpu"], order["cpu"] + 1))
    if sys.platform == "linux":
        resource.setrlimit(resource.RLIMIT_DATA, (order["memory"], order["memory"]))
    return int(pytest.main(order["arguments"]))


def main() -> None:
    """Carry out one order after the other."""
    sys.path.insert(0, os.getcwd())
    for line in sys.stdin:
        child = os.fork()
        if child == 0:
            status = 70
            try:
                status = run(json.loads(line))
            finally:
                sys.stdout.flush()
                os._exit(status)
        print(child, flush=True)
        _, status = os.waitpid(child, 0)
        print(os.waitstatus_to_exitcode(status), flush=True)


if __name__ == "__main__":
    main()
