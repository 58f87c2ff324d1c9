"""What the real server of actionlib does, without a master: python3 ros1_action_rules.py SEQUENCES.

SEQUENCES is a JSON file with lists of steps: ``["goal", id, stamp]``, ``["cancel", id, stamp]``, ``["take"]`` and
``["wait", seconds]``. It prints one line of JSON: for each list, ids and states after each step, and the results.
"""

import json
import sys
import types
from pathlib import Path

import rospy
from actionlib.action_server import ActionServer
from actionlib_msgs.msg import GoalID, GoalStatus
from rospy.rostime import _set_rostime, set_rostime_initialized

ENDED = (GoalStatus.PREEMPTED, GoalStatus.RECALLED)


def spec():
    """Return an action whose messages have the fields that the server uses."""
    goal = type("Goal", (), {})
    result = type("Result", (), {"header": types.SimpleNamespace(), "result": None})
    kinds = types.SimpleNamespace(action_goal=goal(), action_result=result(), action_feedback=goal())
    return lambda: kinds


def row(status):
    """Return id and state."""
    return [status.goal_id.id, status.status]


def answers(steps):
    """Return what the server does for some steps. All handles of goals end with the goal, as in C++."""
    waiting, states, results = [], [], []
    server = ActionServer("server", spec(), waiting.append, lambda handle: None, auto_start=False)
    lists = []
    server.status_pub = types.SimpleNamespace(publish=lambda message: lists.append(message.status_list))
    server.result_pub = types.SimpleNamespace(publish=lambda message: results.append(row(message.status)))
    server.started, server.status_list_timeout = True, rospy.Duration(5)
    now = 100.0
    _set_rostime(rospy.Time.from_sec(now))
    for word, *values in steps:
        if word in ("goal", "cancel"):
            identity = GoalID(id=values[0], stamp=rospy.Time(values[1]))
            if word == "goal":
                server.internal_goal_callback(types.SimpleNamespace(goal_id=identity, goal=None))
            else:
                server.internal_cancel_callback(identity)
        elif word == "take":  # the user's loop accepts what is new and ends what is canceled
            for handle in waiting:
                state = handle.get_goal_status().status
                if state == GoalStatus.PENDING:
                    handle.set_accepted()
                elif state in (GoalStatus.RECALLING, GoalStatus.PREEMPTING):
                    handle.set_canceled()
        else:
            now += values[0]
            _set_rostime(rospy.Time.from_sec(now))
        for tracker in server.status_list:
            if tracker.status.status in ENDED:
                tracker.handle_tracker = None
                tracker.handle_destruction_time = tracker.handle_destruction_time or rospy.Time.now()
        server.publish_status()
        states.append([row(status) for status in lists[-1]])
    return [states, results]


if __name__ == "__main__":
    set_rostime_initialized(True)
    rospy.is_shutdown = lambda: False
    print(json.dumps([answers(steps) for steps in json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))]))
