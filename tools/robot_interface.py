"""Print docs/reference/robot-interface.md: topics, types, frames, rates and QoS of a trial, from the code.

python tools/robot_interface.py > docs/reference/robot-interface.md
"""

from __future__ import annotations

from collections.abc import Iterable

from crowdbot.bridges import MODES, PLAIN_SERVICES, QUALITIES, SERVICES, TRANSPORTS, RobotInterface
from crowdbot.trials import Trial, parse_trial

TRIAL = """<trial name="robot-interface" duration="0.4">
  <crowd type="orca"/>
  <robot name="robot" type="pepper" x="0" y="0" cameras="true"><goal x="9" y="0"/><navigator type="external"/>
    <sensor name="points" type="lidar3d"/><sensor name="imu" type="imu"/><sensor name="wheels" type="wheel-odometry"/>
    <sensor name="depth" type="depth-camera"/><sensor name="touch" type="bumper"/>
    <sensor name="tracked" type="ground-truth-people"/>
  </robot>
</trial>
"""

HEAD = """# Robot interface

Topics, services and actions of `crowdbot run TRIAL --bridge ...`, made from the code by
`python tools/robot_interface.py`. The robot of this page is a Pepper named `robot` with more sensors, at a time step of
0.05 s. In your trial, the first part of a topic is the name of the robot, and the second the name of its sensor. Every
robot has its own name space.

The messages are those of [recordings](recording.md), converted by the same code: what is recorded is what is sent.
All time stamps are simulated time.

## Topics that are sent

Rates are in Hz of simulated time. A dash means: when something happens, or once if the topic is latched.
"""
INPUTS = """
## Topics that are received

A command is applied before the next step, recorded, and applied again in a replay. A robot stops if no velocity came
for 0.5 s of simulated time, or for the `timeout` of its `<navigator type="external"/>`. Robots without this navigator
are driven from outside if no robot of the trial has it.

`/clock` is received instead of sent with `--clock follow`.
"""
SERVICE_TEXT = """
## Services

The services are those of [simulation_interfaces](https://github.com/ros-simulation/simulation_interfaces) 2.1.0. An
entity is a robot by its name, or a person as `person_ID`. What is added or moved is there after the next step. A reset,
and another world, begin another episode (`episode-2.mcap`). A reset of scope 4 removes only what was added.
"""
PLAIN = """
The bridges `ros1` and `ros2` have services of `std_srvs`, too, for systems without `simulation_interfaces`:
"""
ACTION_TEXT = """
## Actions

Programs send a goal, and get feedback and a result; see
[joints](../how-to/joints.md#by-a-goal-of-followjointtrajectory). The bridge `rosbridge` carries both actions,
`rosbridge-client` that of robots, and `ros1` that of robots as topics of actionlib.
"""
TRANSPORT = """
## Transports

What `--bridge` takes; several are possible at the same time.
"""
QUALITY = """
## Quality of service

The classes of the tables above, as ROS 2 knows them.
"""
CLOCKS = """
## Clocks

No clock changes the result: the same orders at the same instants give the same bytes.

With `commands`, programs answer each instant with one velocity command for each robot, however long they compute. The
instant is sent to new subscribers, and again if nobody answers, since DDS can lose the first messages.
"""
ANSWERS = """
### Which instant a velocity command answers

With `paced`, `free`, `step` and `follow`, the newest command that has come before a step counts for this step. With
`commands`, and for robots with the [navigators `rosbridge` and `ros2`](../how-to/stack-navigator.md), each command
counts for one instant:
"""
INSTANTS = (
    (
        "`geometry_msgs/TwistStamped` with a time of `/clock`, over each bridge that has topics",
        "its stamp. The first one counts; copies and late ones are dropped, whenever they come",
    ),
    ("`vel_cmd` of a request over `tcp`", "the `clock` of the latest reply to this client, in the same way"),
    (
        "`geometry_msgs/Twist`; `TwistStamped` with the time 0 (so that of the instant 0, too) or with that of another"
        " clock; the velocities of `naoqi`",
        "the one at which it comes",
    ),
)
PLAIN_COMMANDS = """
For the last row, the instant at which a command comes is the one that it answers if the program sends one command for
each message that it gets, and none by itself. All answers to a repeated instant are awaited, until none has come for
1.5 times what the first one took, and at least 0.3 s. Nothing is guaranteed for a program that sends plain commands at
a rate of its own, several for a message, or an answer after that: its runs depend on real time. Such programs stamp
their commands.
"""


def table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """Return a table in Markdown."""
    lines = [list(head), *(list(row) for row in rows)]
    lines.insert(1, ["---"] * len(lines[0]))
    return "".join("| " + " | ".join(line) + " |\n" for line in lines)


def example_trial() -> Trial:
    """Return the trial of the page."""
    return parse_trial(TRIAL, place="robot-interface")


def page() -> str:
    """Return the page."""
    interface = RobotInterface.of(example_trial())
    follows = RobotInterface.of(example_trial(), follows_clock=True)
    outputs = (
        (f"`{output.name}`", f"`{output.kind}`", f"`{output.frame}`" if output.frame else "-",
         f"{output.rate:g}" if output.rate else "-", output.quality.name, output.about)
        for output in interface.outputs
    )  # fmt: skip
    inputs = (
        (
            f"`{input_topic.name}`",
            " or ".join(f"`{kind}`" for kind in input_topic.kinds),
            input_topic.quality.name,
            input_topic.about,
        )
        for input_topic in follows.inputs
    )
    services = ((f"`/crowdbot/{name}`", f"`{item.kind}`", item.about) for name, item in SERVICES.items())
    plain = ((f"`{name}`", f"`std_srvs/{item.kind}`", item.about) for name, item in PLAIN_SERVICES.items())
    actions = [(f"`{action.name}`", f"`{action.kind}`", action.about) for action in interface.actions]
    actions += [("`/crowdbot/simulate_steps`", "`simulation_interfaces/action/SimulateSteps`", "steps while paused")]
    transports = (
        (f"`{address}`", about) for address, _, about in (line.partition(", ") for _, line in TRANSPORTS.values())
    )
    qualities = (
        (item.name, "reliable" if item.reliable else "best effort", "transient local" if item.latched else "volatile",
         str(item.depth))
        for item in QUALITIES
    )  # fmt: skip
    return (
        HEAD + "\n" + table(("topic", "type", "frame", "rate", "QoS", "content"), outputs)
        + INPUTS + "\n" + table(("topic", "type", "QoS", "content"), inputs)
        + SERVICE_TEXT + "\n" + table(("service", "type", "effect"), services)
        + PLAIN + "\n" + table(("service", "type", "effect"), plain)
        + ACTION_TEXT + "\n" + table(("action", "type", "effect"), actions)
        + TRANSPORT + "\n" + table(("bridge", "what"), transports)
        + QUALITY + "\n" + table(("class", "reliability", "durability", "depth"), qualities)
        + CLOCKS + "\n" + table(("`--clock`", "meaning"), ((f"`{name}`", about) for name, about in MODES.items()))
        + ANSWERS + "\n" + table(("command", "instant"), INSTANTS) + PLAIN_COMMANDS
    )  # fmt: skip


if __name__ == "__main__":
    print(page(), end="")
