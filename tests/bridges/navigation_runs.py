"""Runs in which a navigation node of the examples drives a robot to its goal, over each transport."""

import subprocess
from pathlib import Path

from bridge_runs import Running
from partner_runs import Meeting

from crowdbot.trials import load_trial

EXAMPLES = Path(__file__).parents[2] / "examples" / "robot_bridge"
SOCKETS = ("rosbridge", "rosbridge-client", "foxglove")


def navigate(transport, program, folder):
    """Let a program drive through ``pillar.xml``; return the outcome, measures, and what the program has printed.

    A step is taken when the command for its instant has come, so the speed of the computer has no influence.
    """
    trial = load_trial(str(EXAMPLES / "pillar.xml"))
    goal = trial.robots[0].goal
    with Meeting(transport, folder) as meeting, Running(trial, [meeting.node], "commands") as running:
        port = ["--port", meeting.address.rpartition(":")[2]] if transport in SOCKETS else []
        words = [*meeting.words, str(EXAMPLES / program), "--goal", f"{goal.x},{goal.y}", *port]
        environment = {**meeting.environment, "ROS_DOMAIN_ID": str(meeting.domain)}
        process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment)
        meeting.callback(process.communicate)
        meeting.callback(process.kill)
        done = running.end(120.0)
        running.run.port.stop()
        if meeting.server:  # that of the others; the program ends with it
            meeting.server.stop()
        printed, errors = process.communicate(timeout=60)
    assert process.returncode == 0, errors
    chosen = {name: done.metrics[name] for name in ("path_length", "collision")}
    return {"outcome": done.outcome, "digest": done.digest, "printed": printed, **chosen}
