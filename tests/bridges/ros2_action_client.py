"""A client of FollowJointTrajectory by rclpy, as MoveIt and users have it: python ros2_action_client.py DOMAIN.

It prints one line of JSON: state and error code of a goal that is followed, of one that is canceled and of one that a
newer goal ends, whether feedback came, its last position, and whether a goal for an unknown joint was accepted.
"""

import json
import sys

import rclpy
from builtin_interfaces.msg import Duration
from control_msgs.action import FollowJointTrajectory
from rclpy.action import ActionClient
from trajectory_msgs.msg import JointTrajectoryPoint


def main():
    rclpy.init(domain_id=int(sys.argv[1]))
    node = rclpy.create_node("arm_program")
    client = ActionClient(node, FollowJointTrajectory, "/pepper/follow_joint_trajectory")
    assert client.wait_for_server(timeout_sec=60.0)
    feedback = []

    def done(future):
        rclpy.spin_until_future_complete(node, future, timeout_sec=60.0)
        return future.result()

    def send(joint, seconds):
        goal = FollowJointTrajectory.Goal()
        goal.trajectory.joint_names = [joint]
        point = JointTrajectoryPoint(positions=[0.5], time_from_start=Duration(sec=seconds))
        goal.trajectory.points = [point]
        return done(client.send_goal_async(goal, feedback_callback=lambda message: feedback.append(message.feedback)))

    def end(handle):
        answer = done(handle.get_result_async())
        return [answer.status, answer.result.error_code]

    def fed():
        feedback.clear()
        while not feedback:
            rclpy.spin_once(node, timeout_sec=0.1)

    found = {"result": end(send("HeadYaw", 1))}
    found |= {"feedback": len(feedback) > 5, "position": round(feedback[-1].actual.positions[0], 3)}
    handle = send("HeadYaw", 100)
    fed()
    found["accepted_cancel"] = len(done(handle.cancel_goal_async()).goals_canceling)
    found["canceled"] = end(handle)
    older = send("HeadYaw", 100)
    newer = send("HeadYaw", 1)
    found["replaced"], found["newer"] = end(older), end(newer)
    found["rejected"] = not send("HeadYow", 1).accepted
    send("HeadYaw", 100)  # it is followed when this program is gone, until the run ends
    print(json.dumps(found), flush=True)
    client.destroy()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
