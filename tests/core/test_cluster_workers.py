"""Jobs on a cluster of Ray."""

from __future__ import annotations

import socket

import pytest
from ray import exceptions

from crowdbot.core import InputError, each, workers


def square(number: int) -> int:
    return number * number


class FakeRay:
    """A cluster in this process that finishes the newest job first."""

    exceptions = exceptions

    def __init__(self) -> None:
        self.options: dict[str, object] = {}
        self.retries, self.most, self.runs = 0, 0, False

    def is_initialized(self) -> bool:
        return self.runs

    def init(self, **options: object) -> None:
        self.options, self.runs = options, True

    def shutdown(self) -> None:
        self.runs = False

    def remote(self, max_retries: int):
        self.retries = max_retries

        def decorate(function):
            class Remote:
                @staticmethod
                def remote(*words):
                    return (words, function(*words))

            return Remote

        return decorate

    def wait(self, running):
        self.most = max(self.most, len(running))
        return running[-1:], running[:-1]

    def get(self, ready):
        return ready[1]


def test_a_cluster_runs_as_many_jobs_as_workers(monkeypatch: pytest.MonkeyPatch) -> None:
    ray = FakeRay()
    monkeypatch.setattr(workers, "import_optional", lambda *words: ray)
    assert sorted(each(square, [1, 2, 3, 4], workers=2, cluster="auto")) == [(0, 1), (1, 4), (2, 9), (3, 16)]
    assert (ray.options["address"], ray.retries, ray.most, ray.runs) == ("auto", 2, 2, False)


def test_a_cluster_of_the_caller_stays(monkeypatch: pytest.MonkeyPatch) -> None:
    ray = FakeRay()
    ray.runs = True
    monkeypatch.setattr(workers, "import_optional", lambda *words: ray)
    assert list(each(square, [3], workers=3, cluster="local")) == [(0, 9)]
    assert (ray.options["num_cpus"], ray.runs) == (3, True)


@pytest.mark.live
def test_an_address_where_nobody_answers_is_refused_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    ray = FakeRay()
    monkeypatch.setattr(workers, "import_optional", lambda *words: ray)
    with socket.socket() as there:  # bound, but it does not listen
        there.bind(("127.0.0.1", 0))
        for form in ("127.0.0.1:{}", "ray://127.0.0.1:{}"):
            with pytest.raises(InputError, match="nobody answers there .*is the head node running"):
                list(each(square, [1], cluster=form.format(there.getsockname()[1])))
    assert not ray.options
    with socket.create_server(("127.0.0.1", 0)) as there:
        assert list(each(square, [1], cluster=f"127.0.0.1:{there.getsockname()[1]}")) == [(0, 1)]


def test_a_cluster_that_ray_does_not_find_is_an_input_error(monkeypatch: pytest.MonkeyPatch) -> None:
    ray = FakeRay()

    def init(**options: object) -> None:
        raise ConnectionError("Could not find any\nrunning Ray instance.")

    monkeypatch.setattr(ray, "init", init)
    monkeypatch.setattr(workers, "import_optional", lambda *words: ray)
    with pytest.raises(InputError, match="cluster 'auto': Could not find any running Ray instance"):
        list(each(square, [1], cluster="auto"))
