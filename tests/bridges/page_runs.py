"""Types what the page of a transport says into two terminals, with addresses that are free."""

import re
import shlex
import signal
import subprocess
import sys
from pathlib import Path

from bridge_runs import wait
from partner_runs import ENDLESS, OWN, Meeting, number_of_orders

from crowdbot.recording import read_episode, replay

HOW_TO = Path(__file__).parents[2] / "docs" / "how-to"
PAGES = {
    "rosbridge": "rosbridge", "rosbridge-client": "rosbridge-client", "ros1": "ros1", "ros2": "ros2",
    "naoqi": "naoqi", "foxglove": "foxglove", "tcp": "challenge-tcp",
}  # fmt: skip
"""Page of each transport."""
FENCE = re.compile(r"^```(?P<language>\w*)(?: title=\"(?P<title>[^\"]+)\")?\n(?P<text>.*?)^```", flags=re.S | re.M)


def follow_page(page, folder):
    """Write the files of a page; return the words of its first simulation, and of the program that drives."""
    text = (HOW_TO / f"{page}.md").read_text(encoding="utf-8")
    lines = []
    for block in FENCE.finditer(text):
        if block["title"]:
            (folder / block["title"]).write_text(block["text"], encoding="utf-8")
        elif not block["language"]:
            lines += [shlex.split(line) for line in block["text"].splitlines() if line]
    simulation = next(words for words in lines if words[0] == "crowdbot")
    program = next((words for words in lines if words[0].endswith(("python", "python3"))), [])
    return simulation[1:], program


def begin(words, folder, environment):
    """Start a program in a folder."""
    pipe = subprocess.PIPE
    return subprocess.Popen(words, cwd=folder, env=environment, stdout=pipe, stderr=pipe, text=True)


def simulation_words(words, opening):
    """Return the command of a simulation with another address, and without an end before that of the test."""
    k = words.index("--bridge") + 1
    assert words[k].partition(":")[0] == opening.partition(":")[0]
    assert words[-2] == "--out"
    return [sys.executable, "-m", "crowdbot", *words[:k], opening, *words[k + 1 :], *ENDLESS]


def drive(transport, folder):
    """Type the commands of a page, end the run after some; return how many are in its recording."""
    simulation, program = follow_page(PAGES[transport], folder)
    out = folder / "driven"
    with Meeting(transport, folder, served=False) as meeting:
        meeting.environment["ROS_DOMAIN_ID"] = str(meeting.domain)
        first = begin(simulation_words(simulation, meeting.opening), folder, meeting.environment | OWN)
        meeting.callback(first.kill)
        wait(lambda: out.exists() or first.poll() is not None, 120.0)
        server, _, port = meeting.address.partition(":")
        places = {"192.168.0.2": server, "9090": port, "8765": port, "25001": port}
        assert program[0] == ("/usr/bin/python3" if transport == "ros1" else "python")
        words = [*meeting.words, *(places.get(item, item) for item in program[1:])]
        second = begin(words, folder, meeting.environment)
        meeting.callback(second.kill)
        wait(lambda: second.poll() is not None or (transport != "tcp" and number_of_orders(out) > 10), 120.0, 0.5)
        if transport == "tcp":  # its client ends the simulation
            wait(lambda: first.poll() is not None)
        end(first)
        printed = second.communicate(timeout=90)
        assert second.returncode == 0, printed
    return count_commands(out / "episode.mcap")


def end(process):
    """End a simulation with Ctrl-C."""
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
    errors = process.communicate(timeout=90)[1]
    assert process.returncode in (0, 130), errors


def count_commands(path):
    """Return the number of commands in a recording, which is whole, and in which the robot has moved."""
    episode = read_episode(path)
    assert abs(episode.velocity[:, episode.robots[0]]).max() > 0.1
    assert episode.complete
    assert replay(path).equal
    return len(episode.orders)
