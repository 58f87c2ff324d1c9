"""Independent jobs on several processes or on a Ray cluster."""

from __future__ import annotations

import concurrent.futures.process
import contextlib
import multiprocessing
import os
import re
import signal
import socket
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, TypeVar

from .errors import CrowdbotError, InputError, explain_write_errors, import_optional

Job = TypeVar("Job")
Result = TypeVar("Result")

ATTEMPTS = 3
"""Maximum number of attempts for a job whose process dies."""
LOCAL = "local"
"""Address of a cluster that is started on this machine."""
ADDRESS = re.compile(r"(?:ray://)?(?P<host>\[[^\]]+\]|[^:/]+):(?P<port>\d+)")
ANSWER = 10.0
"""Time [s] for a cluster to answer."""


def each(
    function: Callable[[Job], Result], jobs: Sequence[Job], workers: int = 1, cluster: str | None = None
) -> Iterator[tuple[int, Result]]:
    """Yield the index and the result of each job in order of completion.

    If a process dies, only its job is repeated. Function, jobs and results must be picklable if ``workers`` is above 1.

    Args:
        function: function of a job, defined at the top level of a module.
        jobs: arguments of the function.
        workers: number of processes; 1 runs the jobs in this process.
        cluster: address of a Ray cluster (``auto`` for the cluster of this environment, ``local`` to start one on this
            machine that ends with the last job); ``workers`` is then the number of simultaneous jobs. Requires
            ``pip install crowdbot[cluster]``.

    Raises:
        InputError: ``workers`` is below 1, or no cluster answers at the address.
        MissingExtra: Ray is not installed.
        CrowdbotError: the process of a job died in every attempt.

    >>> sorted(each(abs, [-3, 4]))
    [(0, 3), (1, 4)]
    """
    if workers < 1:
        raise InputError(f"workers = {workers} must be at least 1")
    if cluster is not None:
        return _on_ray(function, jobs, workers, cluster)
    if workers == 1 or len(jobs) < 2:
        return ((number, function(job)) for number, job in enumerate(jobs))
    return _in_processes(function, jobs, workers)


def run_saved_jobs(
    function: Callable[[Job], Result],
    jobs: Sequence[Job],
    files: Sequence[Path],
    save: Callable[[Result, Path], None],
    load: Callable[[Path], Result],
    workers: int = 1,
    cluster: str | None = None,
) -> Iterator[tuple[int, Result]]:
    """Yield the same as :func:`each`, and save each result to a file.

    An interrupted run continues: results of existing files are loaded. Files are written atomically.

    Args:
        function, jobs, workers, cluster: see :func:`each`.
        files: one file for each job; empty to save nothing.
        save, load: write and read a result.

    Raises:
        InputError: a file cannot be written, or is damaged.
    """
    left = [number for number in range(len(jobs)) if not files or not files[number].exists()]
    for number in sorted(set(range(len(jobs))) - set(left)):
        yield number, _load_saved(files[number], load)
    for order, result in each(function, [jobs[number] for number in left], workers, cluster):
        if files:
            _save_whole(files[left[order]], result, save)
        yield left[order], result


def _load_saved(file: Path, load: Callable[[Path], Result]) -> Result:
    try:
        return load(file)
    except Exception as error:  # NumPy raises many kinds of errors at damaged files
        raise InputError(f"{file} is damaged ({type(error).__name__}); remove it to run its job again") from None


def _save_whole(file: Path, result: Result, save: Callable[[Result, Path], None]) -> None:
    """Write a file atomically."""
    draft = file.with_suffix(".part")
    with explain_write_errors(file):
        try:
            draft.parent.mkdir(parents=True, exist_ok=True)
            save(result, draft)
            draft.replace(file)
        except BaseException:
            with contextlib.suppress(OSError):
                draft.unlink(missing_ok=True)
            raise


def _in_processes(function: Callable[[Job], Result], jobs: Sequence[Job], workers: int) -> Iterator[tuple[int, Result]]:
    left = dict(enumerate(jobs))
    for _ in range(ATTEMPTS):
        with _share_threads(workers):
            pool = concurrent.futures.ProcessPoolExecutor(
                workers, multiprocessing.get_context("spawn"), initializer=_ignore_interrupts
            )
            running = {pool.submit(function, job): number for number, job in left.items()}
        try:
            for done in concurrent.futures.as_completed(running):
                with contextlib.suppress(concurrent.futures.process.BrokenProcessPool):
                    result = done.result()
                    del left[running[done]]
                    yield running[done], result
        except BaseException:  # interrupted, or the caller stops early: do not wait for running jobs
            for process in list((pool._processes or {}).values()):
                process.terminate()
            raise
        finally:
            pool.shutdown(wait=False, cancel_futures=True)
        if not left:
            return
    raise CrowdbotError(
        f"{len(left)} of {len(jobs)} jobs were lost: their processes died {ATTEMPTS} times (out of memory?);"
        " use fewer workers"
    )


def _ignore_interrupts() -> None:
    """Ignore Ctrl-C; the main process terminates this one."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


@contextlib.contextmanager
def _share_threads(workers: int) -> Iterator[None]:
    """Divide the processor cores for compiled kernels among the processes started here."""
    name, before = "NUMBA_NUM_THREADS", os.environ.get("NUMBA_NUM_THREADS")
    os.environ[name] = str(max(1, (os.cpu_count() or 1) // workers))
    try:
        yield
    finally:
        if before is None:
            del os.environ[name]
        else:
            os.environ[name] = before


def _on_ray(
    function: Callable[[Job], Result], jobs: Sequence[Job], workers: int, cluster: str
) -> Iterator[tuple[int, Result]]:
    ray = import_optional("ray", "a cluster", "cluster")
    ours = not ray.is_initialized()
    _connect(ray, workers, cluster)
    try:
        remote: Any = ray.remote(max_retries=ATTEMPTS - 1)(_run_job)
        waiting = list(enumerate(jobs))[::-1]
        running: dict[Any, int] = {}
        while waiting or running:
            while waiting and len(running) < workers:
                number, job = waiting.pop()
                running[remote.remote(function, job)] = number
            (ready, *_), _ = ray.wait(list(running))
            yield running.pop(ready), _ray_result(ray, ready)
    finally:
        if ours:  # jobs that still run end with the connection
            ray.shutdown()


def _run_job(function: Callable[[Job], Result], job: Job) -> Result:
    """Run a job in a process of a cluster."""
    return function(job)


def _connect(ray: Any, workers: int, cluster: str) -> None:
    """Connect to a Ray cluster, or start one on this machine."""
    options: dict[str, Any] = {"address": cluster, "ignore_reinit_error": True, "log_to_driver": False}
    if cluster == LOCAL:
        options |= {"num_cpus": workers, "include_dashboard": False}
    else:
        _check_address(cluster)
    try:
        ray.init(**options)
    except (ConnectionError, ValueError) as error:
        raise InputError(f"cluster {cluster!r}: {' '.join(str(error).split())}") from None


def _check_address(cluster: str) -> None:
    """Raise an InputError if nobody answers at an address, since Ray itself tries for many minutes."""
    match = ADDRESS.fullmatch(cluster)
    if match is None:
        return
    try:
        socket.create_connection((match["host"].strip("[]"), int(match["port"])), timeout=ANSWER).close()
    except (OSError, OverflowError) as error:
        raise InputError(f"cluster {cluster!r}: nobody answers there ({error}); is the head node running?") from None


def _ray_result(ray: Any, ready: Any) -> Any:
    """Return the result of a job, or raise its error as it was raised."""
    try:
        return ray.get(ready)
    except ray.exceptions.RayTaskError as error:
        cause = error.cause
        raise (cause if isinstance(cause, CrowdbotError | KeyboardInterrupt) else error) from None
    except ray.exceptions.RayError as error:
        lines = str(error).strip().splitlines() or [type(error).__name__]
        raise CrowdbotError(f"a job was lost on the cluster in {ATTEMPTS} attempts: {lines[0]}") from None
