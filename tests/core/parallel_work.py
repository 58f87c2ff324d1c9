"""A program that forks and calls a parallel kernel from several threads; prints what came of it.

Its words are the steps to take, one after the other: ``fork``, ``threads``, ``fork-threads``, ``fork-during``,
``fork-from-thread`` and ``layer``.
"""

import hashlib
import os
import select
import sys
import threading

import numba
import numpy as np

from crowdbot.core.neighbors import nearest

LIMIT = 60.0
CROWD = np.random.default_rng(0).uniform(0.0, 40.0, (1, 2000, 2))


def work(times=3):
    digest = hashlib.blake2b(digest_size=8)
    for _ in range(times):
        found = nearest(CROWD, 3.0, 10)
        digest.update(found.agent.tobytes() + found.number.tobytes())
    return digest.hexdigest()


def in_threads(count=3):
    found = []
    threads = [threading.Thread(target=lambda: found.append(work())) for _ in range(count)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return " ".join(sorted(set(found)))


def in_child(task):
    """Return what a task gives in a forked process, or ``hangs``."""
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        os.write(writer, task().encode())
        os._exit(0)
    os.close(writer)
    ended = bool(select.select([reader], [], [], LIMIT)[0])
    if not ended:
        os.kill(child, 9)
    found = os.read(reader, 1000).decode()
    os.close(reader)
    os.waitpid(child, 0)
    return found if ended else "hangs"


def fork_during():
    """Fork again and again while another thread runs the kernel."""
    stop = threading.Event()

    def go_on():
        while not stop.is_set():
            work(1)

    other = threading.Thread(target=go_on)
    other.start()
    found = {in_child(in_threads) for _ in range(3)}
    stop.set()
    other.join()
    return " ".join(sorted(found))


def fork_from_thread():
    found = []
    thread = threading.Thread(target=lambda: found.append(in_child(in_threads)))
    thread.start()
    thread.join()
    return found[0]


STEPS = {
    "work": work,
    "fork": lambda: in_child(work),
    "threads": in_threads,
    "fork-threads": lambda: in_child(in_threads),
    "fork-during": fork_during,
    "fork-from-thread": fork_from_thread,
    "layer": numba.threading_layer,
}

if __name__ == "__main__":
    for word in sys.argv[1:]:
        print(f"result {word} {STEPS[word]()}", flush=True)
