"""A program for ROS 2 in a process of its own that calls the services of the simulation, by rclpy.

    python ros2_services.py DOMAIN

It prints one line of JSON: what the services have answered.
"""

import json
import sys

import rclpy
from std_srvs.srv import Empty, Trigger


def main():
    rclpy.init(domain_id=int(sys.argv[1]))
    node = rclpy.create_node("caller")

    def call(name, kind):
        client = node.create_client(kind, f"/crowdbot/{name}")
        assert client.wait_for_service(60.0), name
        waiting = client.call_async(kind.Request())
        rclpy.spin_until_future_complete(node, waiting, timeout_sec=60.0)
        response = waiting.result()
        return [response.success, response.message] if kind is Trigger else "done"

    words = ["step", "pause", "step", "step", "unpause", "reset"]
    found = [call(name, Trigger if name == "step" else Empty) for name in words]
    print(json.dumps(found))
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
