"""A client with the real actionlib in a process of its own: python3 ros1_action_client.py TYPES.

TYPES is a JSON file with the definitions of the types of the action, since Debian has no control_msgs. It prints one
line of JSON: whether feedback came, and state and error code of a goal that is followed, canceled and rejected.
"""

import json
import sys
import threading
import types
from pathlib import Path

import actionlib
import genpy.dynamic
import rospy

NAME = "control_msgs/FollowJointTrajectory"


def main():
    texts = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    made = {part: genpy.dynamic.generate_dynamic(f"{NAME}Action{part}", text) for part, text in texts.items()}
    kinds = {f"action_{part.lower()}": made[part][f"{NAME}Action{part}"]() for part in made}
    rospy.init_node("arm_program", disable_signals=True)
    action = types.SimpleNamespace(**kinds)
    client = actionlib.SimpleActionClient("/pepper/follow_joint_trajectory", lambda: action)
    assert client.wait_for_server(rospy.Duration(30))
    fed = threading.Event()

    def goal(joint, seconds):
        sent = type(action.action_goal.goal)()
        sent.trajectory.joint_names = [joint]
        point = made["Goal"]["trajectory_msgs/JointTrajectoryPoint"](positions=[0.5])
        point.time_from_start = rospy.Duration(seconds)
        sent.trajectory.points = [point]
        return sent

    def end():
        assert client.wait_for_result(rospy.Duration(30))
        return [client.get_state(), client.get_result().error_code]

    client.send_goal(goal("HeadYaw", 0.5), feedback_cb=lambda feedback: fed.set())
    found = {"result": end(), "feedback": fed.is_set()}
    fed.clear()
    client.send_goal(goal("HeadYaw", 100.0), feedback_cb=lambda feedback: fed.set())
    assert fed.wait(30.0)
    client.cancel_goal()
    found["canceled"] = end()
    client.send_goal(goal("HeadYow", 0.5))
    found["rejected"] = end()
    print(json.dumps(found), flush=True)
    rospy.signal_shutdown("done")


if __name__ == "__main__":
    main()
