"""A sender of what a VRPN server sends, such as that of Vicon Tracker; it needs the published protocol only."""

from __future__ import annotations

import contextlib
import math
import socket
import struct
import threading
import time


class VrpnServer(threading.Thread):
    """A VRPN server (version 07) with a tracker ``Cart`` that drives along x and turns, z up, over TCP.

    It says its version, describes senders and types as the first messages, then sends poses.

    Args:
        rate: poses per second.
        cookie: what it says first.
        port: port to listen on; 0: any.
    """

    def __init__(self, rate: float = 120.0, cookie: bytes = b"vrpn: ver. 07.34  0", port: int = 0) -> None:
        super().__init__(daemon=True)
        self.rate, self.cookie = rate, cookie.ljust(24, b"\0")
        self.socket = socket.create_server(("127.0.0.1", port))
        self.socket.settimeout(0.05)
        self.port = self.socket.getsockname()[1]
        self.end, self.hang_up = threading.Event(), threading.Event()
        self.clients: list[socket.socket] = []
        self.sent = self.met = 0

    def run(self) -> None:
        start = time.monotonic()
        with self.socket:
            while not self.end.is_set():
                if self.hang_up.is_set():
                    self.drop()
                    self.hang_up.clear()
                with contextlib.suppress(OSError):
                    self.meet(self.socket.accept()[0]) if not self.clients else self.end.wait(1.0 / self.rate)
                t = time.monotonic() - start
                for client in list(self.clients):
                    try:
                        client.sendall(vrpn_message(1, 3, vrpn_pose(t), t, self.sent))
                        self.sent += 1
                    except OSError:
                        self.clients.remove(client)
                        client.close()
            self.drop()

    def meet(self, client: socket.socket) -> None:
        """Say the version and what there is."""
        self.met += 1
        self.clients.append(client)  # closed at the end, whatever it does
        client.settimeout(5.0)
        client.sendall(self.cookie)
        client.recv(24, socket.MSG_WAITALL)
        names = [(k, -1, name) for k, name in enumerate(("VRPN Control", "Cart"))]
        kinds = ("vrpn_Base ping_message", "vrpn_Base pong_message", "VRPN_Connection_Got_Connection")
        names += [(k, -2, name) for k, name in enumerate((*kinds, "vrpn_Tracker Pos_Quat"))]
        for number, kind, name in names:
            body = name.encode() + b"\0"
            client.sendall(vrpn_message(number, kind, struct.pack(">i", len(body)) + body))

    def drop(self) -> None:
        """End all connections."""
        while self.clients:
            self.clients.pop().close()

    def __enter__(self) -> VrpnServer:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.end.set()
        self.join()


def vrpn_pose(t: float) -> bytes:
    """Return the content of a message with the pose of the cart at a time [s]."""
    half = 0.25 * t
    return struct.pack(">ii7d", 0, 0, 0.5 * t, 1.0, 0.3, 0.0, 0.0, math.sin(half), math.cos(half))


def vrpn_message(sender: int, kind: int, body: bytes, t: float = 0.0, number: int = 0) -> bytes:
    """Return a message: big endian, padded to 8 bytes."""
    head = struct.pack(">6i", 24 + len(body), 1_700_000_000 + int(t), round(t % 1 * 1e6) % 10**6, sender, kind, number)
    return head + body + bytes(-len(body) % 8)
