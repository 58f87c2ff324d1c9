"""A client with the real roslibpy in a process of its own: python roslibpy_client.py PORT JOB [NUMBER]."""

import json
import sys
import threading
import time

import roslibpy

TWIST = "geometry_msgs/Twist"


def wait_for(ros, service):
    """Wait until a client of the server has advertised a service."""
    for _ in range(300):
        if service in ros.get_services():
            return
        time.sleep(0.1)
    raise TimeoutError(service)


def look(ros):
    """Ask rosapi and the simulation."""
    wait_for(ros, "/crowdbot/get_entity_state")
    features = roslibpy.Service(ros, "/crowdbot/get_simulator_features", "simulation_interfaces/GetSimulatorFeatures")
    state = roslibpy.Service(ros, "/crowdbot/get_entity_state", "simulation_interfaces/GetEntityState")
    found = state.call(roslibpy.ServiceRequest({"entity": "robot"}))
    return {
        "topics": ros.get_topics(),
        "type": ros.get_topic_type("/robot/scan"),
        "services": ros.get_services(),
        "service_type": ros.get_service_type("/crowdbot/step_simulation"),
        "nodes": ros.get_nodes(),
        "time": ros.get_time().to_sec(),
        "details": [item["type"] for item in ros.get_message_details("geometry_msgs/Twist")["typedefs"]],
        "features": features.call(roslibpy.ServiceRequest())["features"]["features"],
        "x": found["state"]["pose"]["position"]["x"],
    }


def control(ros, number):
    """Answer odometry messages with commands, and count scans and map messages."""
    command = roslibpy.Topic(ros, "/robot/cmd_vel", TWIST, queue_size=10)
    command.advertise()
    done, counts = threading.Event(), {"odometry": 0, "scans": 0, "rays": 0, "maps": 0, "sent": 0}

    def answer(message):
        counts["odometry"] += 1
        if counts["sent"] < number:
            command.publish(roslibpy.Message({"linear": {"x": 0.3}, "angular": {"z": 0.0}}))
            counts["sent"] += 1
        if counts["sent"] == number:
            done.set()

    def scan(message):
        counts["scans"] += 1
        counts["rays"] = len(message["ranges"])

    def count_map(message):
        counts["maps"] += 1

    roslibpy.Topic(ros, "/map", "nav_msgs/OccupancyGrid").subscribe(count_map)
    roslibpy.Topic(ros, "/robot/scan", "sensor_msgs/LaserScan").subscribe(scan)
    roslibpy.Topic(ros, "/robot/odom", "nav_msgs/Odometry", queue_length=50).subscribe(answer)
    assert done.wait(60.0 + number / 10.0)
    ros.get_time()  # the commands before it have arrived
    return counts


def follow(ros):
    """Follow a joint trajectory to its end, cancel one, and send one for an unknown joint."""
    client = roslibpy.ActionClient(ros, "/pepper/follow_joint_trajectory", "control_msgs/action/FollowJointTrajectory")
    servers = roslibpy.Service(ros, "/rosapi/action_servers", "rosapi_msgs/GetActionServers")
    for _ in range(300):  # until a client of the server has advertised it
        if client.name in servers.call(roslibpy.ServiceRequest())["action_servers"]:
            break
        time.sleep(0.1)
    feedback, results, errors = threading.Event(), [], []

    def send(joint, seconds):
        points = [{"positions": [0.5], "time_from_start": {"sec": seconds, "nanosec": 0}}]
        goal = {"trajectory": {"joint_names": [joint], "points": points}}
        return client.send_goal(goal, results.append, lambda values: feedback.set(), errors.append)

    client.wait_goal(send("HeadYaw", 1), 30)
    found = {"feedback": feedback.is_set()}
    feedback.clear()
    name = send("HeadYaw", 100)
    assert feedback.wait(30.0)
    client.cancel_goal(name)
    client.wait_goal(name, 30)
    client.wait_goal(send("HeadYow", 1), 30)
    ends = [[item["values"]["error_code"], item["values"]["error_string"]] for item in results]
    return {**found, "result": ends[0], "canceled": ends[1], "rejected": len(errors) == 1}


def main():
    port, job = int(sys.argv[1]), sys.argv[2]
    number = int(sys.argv[3]) if len(sys.argv) > 3 else 0
    ros = roslibpy.Ros("127.0.0.1", port)
    ros.run(timeout=30)
    found = look(ros) if job == "look" else follow(ros) if job == "follow" else control(ros, number)
    print(json.dumps(found), flush=True)
    ros.close()
    ros.terminate()


if __name__ == "__main__":
    main()
