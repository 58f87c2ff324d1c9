"""Navigators in processes of their own on other operating systems: one sentence says what to do there."""

import sys

import pytest

from crowdbot.core import InputError
from crowdbot.navigation import ProcessNavigator
from crowdbot.navigation.process.child_process import ChildProcess
from crowdbot.navigation.process.sandbox import enter_sandbox, sandbox_problem


@pytest.mark.parametrize("sandbox", [False, True])
def test_windows_has_no_process_navigators(monkeypatch, sandbox):
    monkeypatch.setattr(sys, "platform", "win32")
    with pytest.raises(InputError) as caught:
        ProcessNavigator(address="mine.py:Mine", sandbox=sandbox)
    assert str(caught.value) == (
        "ProcessNavigator: a navigator in a process of its own needs Linux or macOS, this is Windows;"
        " let the navigator run in this process, as mine.py:Mine"
    )
    with pytest.raises(InputError, match=r"navigator mine: a process of its own needs Linux or macOS, this is Windows"):
        ChildProcess(["python"], "mine")


def test_without_linux_a_sandbox_must_be_switched_off(monkeypatch):
    monkeypatch.setattr(sys, "platform", "darwin")
    with pytest.raises(InputError) as caught:
        ProcessNavigator(address="mine.py:Mine")
    assert str(caught.value) == (
        "ProcessNavigator: the sandbox needs Linux, this is macOS; sandbox=false runs the code without one"
    )
    assert ProcessNavigator(address="mine.py:Mine", sandbox=False).title() == "mine.py:Mine"


@pytest.mark.parametrize(("system", "name"), [("darwin", "macOS"), ("win32", "Windows")])
def test_a_process_never_goes_on_without_its_sandbox(monkeypatch, tmp_path, system, name):
    monkeypatch.setattr(sys, "platform", system)
    assert sandbox_problem() == f"the sandbox needs Linux, this is {name}"
    with pytest.raises(InputError, match=f"the sandbox needs Linux, this is {name}"):
        enter_sandbox([tmp_path])
