"""A robot software for tests: it answers each tick of /clock over rosbridge, and can fail in several ways.

python stack_client.py PORT MODE
"""

import asyncio
import json
import sys

import aiohttp

TELEPORT = {"op": "call_service", "service": "/crowdbot/set_entity_state", "args": {"entity": "robot"}}


async def main(port, mode):
    async with aiohttp.ClientSession() as http, http.ws_connect(f"ws://127.0.0.1:{port}") as socket:
        if mode == "cheat":
            await socket.send_json(TELEPORT)
            await socket.send_json({"op": "publish", "topic": "/robot/goal_pose", "msg": {"pose": {}}})
            await socket.send_json({"op": "subscribe", "topic": "/people"})
        await socket.send_json({"op": "subscribe", "topic": "/clock"})
        await socket.send_json({"op": "subscribe", "topic": "/robot/scan"})
        async for message in socket:
            frame = json.loads(message.data)
            if frame.get("topic") == "/people":
                print("people", file=sys.stderr)
                return 4
            if frame.get("topic") != "/clock":
                continue
            clock = frame["msg"]["clock"]
            now = clock["sec"] * 10**9 + clock["nanosec"]
            if now >= 10**9:
                if mode == "die":
                    print("no battery", file=sys.stderr)
                    return 3
                if mode == "leave":
                    await socket.close()
                    await asyncio.sleep(60.0)
                if mode == "hang":
                    await asyncio.sleep(60.0)
                if mode == "late" and now == 10**9:
                    await asyncio.sleep(0.5)
            twist = {"linear": {"x": 0.5}, "angular": {"z": 0.2 if now % (4 * 10**8) else -0.2}}
            await socket.send_json({"op": "publish", "topic": "/robot/cmd_vel", "msg": twist})
    return 0


if __name__ == "__main__":
    sys.exit(asyncio.run(main(int(sys.argv[1]), sys.argv[2])))
