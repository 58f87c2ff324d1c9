"""Work of jobs for tests; a module of its own, since worker processes import it."""

import os
import subprocess
import sys
import time

from crowdbot.core import InputError


def count(pipe, to, seconds=0.0):
    """Count in the worker process."""
    for number in range(to):
        pipe.send(("number", number))
        pipe.share((number + 1) / to)
        time.sleep(seconds)


def burn(pipe):
    """Use the processor without end."""
    while True:
        sum(range(100_000))


def fill_disk(pipe, file):
    """Write without end."""
    with open(file, "wb") as out:
        while True:
            out.write(bytes(1_000_000))
            out.flush()
            pipe.share(0.5)
            time.sleep(0.02)


def fail(pipe, sentence):
    """End with an error."""
    raise InputError(sentence) if sentence else ZeroDivisionError("a bug")


def die(pipe):
    """End without a word."""
    os._exit(3)


def fill_memory(pipe, megabytes):
    """Take memory, and then wait."""
    taken = bytearray(megabytes * 1_000_000)
    taken[::1000] = bytes(len(taken[::1000])).replace(b"\0", b"\1")
    while True:
        time.sleep(1.0)


def fill_memory_of_a_child(pipe, megabytes):
    """Take memory in another process, and wait for it."""
    program = f"import time; taken = bytearray(b'1') * {megabytes * 1_000_000}; time.sleep(600)"
    pipe.send(("number", subprocess.Popen([sys.executable, "-c", program]).pid))
    while True:
        time.sleep(1.0)
