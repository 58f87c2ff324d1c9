"""A rosbridge server of others, without a simulation: ``python other_server.py PORT``. It prints its port."""

import sys
import threading

from bridge_runs import endless_trial

from crowdbot.bridges import Inbox, RobotInterface
from crowdbot.bridges.rosbridge.server import RosbridgeServer


def main():
    """Serve until it is killed."""
    empty = RobotInterface(endless_trial(1.0), (), (), ())
    server = RosbridgeServer(port=int(sys.argv[1]))
    server.start(empty, Inbox(empty))
    print(server.port, flush=True)
    threading.Event().wait()


if __name__ == "__main__":
    main()
