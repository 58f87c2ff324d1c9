"""A fake NAOqi robot with the real ``qi``: service directory, memory that it rewrites in each cycle, and motion.

    python naoqi_robot.py PORT [still|idle|loop]

With "idle", it has no program of its own; with "still", no motion either. With "loop", the program commands another
velocity 20 times a second.

Its own sensors see nothing (3 m, 0). A program on the robot, over a connection of its own, drives forward while the
front laser of the memory is free for 1 m, and stops otherwise. A line on its input asks for one line of JSON on its
output: reads of the program, those with virtual values, the cycle, and the least distance that it has seen.
"""

import json
import math
import os
import sys
import threading
import time

import qi

CYCLE = 0.012
PERIOD = 0.05
FRONT = "Device/SubDeviceList/Platform/LaserSensor/Front/Horizontal"
KEYS = [f"{FRONT}/Seg{k:02}/{axis}/Sensor/Value" for k in range(1, 16) for axis in "XY"]
KEYS += [key.replace("Front", side) for side in ("Left", "Right") for key in KEYS[:30]]
KEYS += [f"Device/SubDeviceList/Platform/{side}/Sonar/Sensor/Value" for side in ("Front", "Back")]
KEYS += [f"Device/SubDeviceList/Platform/{side}/Bumper/Sensor/Value" for side in ("FrontLeft", "FrontRight", "Back")]


class Memory:
    """ALMemory."""

    def __init__(self):
        self.values = {}
        self.real = {key: 0.25 if key.endswith("Y/Sensor/Value") else 2.75 for key in KEYS}

    def insertListData(self, rows):  # noqa: N802
        self.values.update(dict(rows))

    def insertData(self, key, value):  # noqa: N802
        self.values[key] = value

    def getData(self, key):  # noqa: N802
        return self.values[key]

    def getListData(self, keys):  # noqa: N802
        return [self.values.get(key) for key in keys]


class Motion:
    """ALMotion of a base that follows at once."""

    def __init__(self):
        self.velocity, self.pose, self.moment = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0], time.monotonic()

    def move(self, x, y, turn):
        self.getRobotPosition(True)
        self.velocity = [x, y, turn]

    def stopMove(self):  # noqa: N802
        self.move(0.0, 0.0, 0.0)

    def getRobotVelocity(self):  # noqa: N802
        return self.velocity

    def getRobotPosition(self, use_sensors):  # noqa: N802
        seconds, self.moment = time.monotonic() - self.moment, time.monotonic()
        (x, y, heading), (forward, left, turn) = self.pose, self.velocity
        cos, sin = math.cos(heading), math.sin(heading)
        x, y = x + seconds * (cos * forward - sin * left), y + seconds * (sin * forward + cos * left)
        self.pose = [x, y, heading + seconds * turn]
        return self.pose


class Program:
    """What runs on the robot."""

    def __init__(self, url, memory):
        self.url, self.real = url, memory.real
        self.reads = self.virtual = 0
        self.nearest, self.sent = math.inf, []

    def loop(self):
        """Command another velocity 20 times a second, and keep when."""
        session = qi.Session()
        session.connect(self.url)
        memory, motion, due = session.service("ALMemory"), session.service("ALMotion"), time.monotonic()
        while True:
            memory.getListData(KEYS[:30])
            velocity = 0.1 * math.sin(0.37 * len(self.sent) + 0.1)
            motion.move(velocity, 0.0, 0.0)
            self.sent.append((velocity, time.monotonic()))
            due = max(due + PERIOD, time.monotonic() + 0.5 * PERIOD)  # after a hold-up, no burst of commands
            time.sleep(max(0.0, due - time.monotonic()))

    def run(self):
        session = qi.Session()
        session.connect(self.url)
        memory, motion = session.service("ALMemory"), session.service("ALMotion")
        while True:
            rows = memory.getListData(KEYS[:30])
            own = rows == [self.real[key] for key in KEYS[:30]]
            self.reads += 1
            self.virtual += not own
            if not own and None not in rows:
                distance = min(math.hypot(x, y) for x, y in zip(rows[::2], rows[1::2], strict=True))
                self.nearest = min(self.nearest, distance)
                motion.move(0.4 if distance > 1.0 else 0.0, 0.0, 0.0)
            time.sleep(0.0037)


def rewrite(memory):
    """Write the real values in each cycle, as the device communication manager does."""
    due = time.monotonic()
    while True:
        memory.values.update(memory.real)
        due += CYCLE
        time.sleep(max(0.0, due - time.monotonic()))


def main():
    out = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # qi writes its log to file 1
    url = f"tcp://127.0.0.1:{sys.argv[1]}"
    session, memory, motion = qi.Session(), Memory(), Motion()
    session.listenStandalone(url)
    session.registerService("ALMemory", memory)
    if "still" not in sys.argv:
        session.registerService("ALMotion", motion)
    threading.Thread(target=rewrite, args=(memory,), daemon=True).start()
    program = Program(url, memory)
    if len(sys.argv) == 2 or "loop" in sys.argv:
        work = program.loop if "loop" in sys.argv else program.run
        threading.Thread(target=work, daemon=True).start()
    print("ready", flush=True, file=out)
    for _ in sys.stdin:
        told = {"reads": program.reads, "virtual": program.virtual, "nearest": program.nearest}
        told |= {"sent": list(program.sent), "place": motion.getRobotPosition(True)}
        print(json.dumps(told | {"values": memory.values}), flush=True, file=out)
    session.close()


if __name__ == "__main__":
    main()
