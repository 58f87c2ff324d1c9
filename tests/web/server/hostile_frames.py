"""Torn and hostile WebSocket frames from a seed."""

import asyncio
import base64
import json
import os
import struct

NASTY = (
    None, True, -1, 10**30, 1e308, "", "\0", "../../etc/passwd", "/etc/passwd", "<script>alert(1)</script>", "a" * 5000,
    [], {}, [[]], {"a": {"b": []}}, "\ud800", "%00", "file:///etc/passwd", "evil.py:Evil", [None], [[0, 0]], ["x"], 0,
)  # fmt: skip
NAMES = (
    "path", "file", "name", "trial", "trials", "navigators", "seeds", "values", "settings", "options", "revision",
    "number", "kind", "text", "xml", "changes", "paths", "index", "id", "key", "seed", "variable", "person", "results",
)  # fmt: skip


def frame(opcode, data, rng, final=True, mask=True, reserved=0):
    """Return the bytes of a WebSocket frame."""
    head = bytes([(0x80 if final else 0) | reserved << 4 | opcode])
    bit = 0x80 if mask else 0
    size = len(data)
    if size < 126:
        head += bytes([bit | size])
    elif size < 1 << 16:
        head += bytes([bit | 126]) + struct.pack(">H", size)
    else:
        head += bytes([bit | 127]) + struct.pack(">Q", size)
    if not mask:
        return head + data
    key = rng.randbytes(4)
    return head + key + bytes(byte ^ key[i % 4] for i, byte in enumerate(data))


def call(rng, commands):
    """Return the text of a call with hostile arguments."""
    words = {rng.choice(NAMES): rng.choice(NASTY) for _ in range(rng.randrange(1, 5))}
    address = rng.choice(commands) if rng.random() < 0.8 else str(rng.choice(NASTY))
    number = rng.randrange(1000) if rng.random() < 0.9 else rng.choice(NASTY)
    return json.dumps({"id": number, "call": address, "args": words})


def torn_text(rng, commands):
    """Return a call that was cut or changed somewhere."""
    text = bytearray(call(rng, commands).encode())
    for _ in range(rng.randrange(1, 4)):
        text[rng.randrange(len(text))] = rng.randrange(256)
    return bytes(text[: rng.randrange(len(text) + 1)])


def hostile_frame(rng, commands):
    """Return the bytes of one hostile frame."""
    kind = rng.randrange(12)
    if kind < 4:
        return frame(1, call(rng, commands).encode(), rng)
    if kind == 4:
        return frame(1, torn_text(rng, commands), rng)
    if kind == 5:
        return frame(1, json.dumps({"drawn": rng.choice((-1, 10**40, 1.5, "x", None))}).encode(), rng)
    if kind == 6:
        return frame(2, rng.randbytes(rng.randrange(200)), rng)
    if kind == 7:  # opcodes that do not exist, reserved bits, no mask
        return frame(rng.randrange(16), rng.randbytes(20), rng, True, rng.random() < 0.5, rng.randrange(8))
    if kind == 8:  # a length that never comes
        return (
            b"\x81\xff" + struct.pack(">Q", rng.choice((1 << 62, 1 << 32, 5 << 20, (1 << 64) - 1))) + rng.randbytes(9)
        )
    if kind == 9:
        return frame(9, rng.randbytes(rng.randrange(200)), rng)
    if kind == 10:
        return frame(1, call(rng, commands).encode(), rng, final=False)
    whole = frame(1, call(rng, commands).encode(), rng)
    return whole[: rng.randrange(1, len(whole))]


async def send_frames(host, port, session, rng, commands, count):
    """Open a window, send hostile frames until the server closes it; return how many were sent, and the answers."""
    reader, writer = await asyncio.open_connection(host, port)
    key = base64.b64encode(os.urandom(16)).decode()
    writer.write(
        f"GET /api/{session}/socket HTTP/1.1\r\nHost: {host}:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
        f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n".encode()
    )
    answers, sent = bytearray(), 0

    async def read():
        while block := await reader.read(1 << 16):
            answers.extend(block)

    reading = asyncio.create_task(read())
    try:
        while sent < count and not reading.done():
            writer.write(hostile_frame(rng, commands))
            sent += 1
            await writer.drain()
            if rng.random() < 0.5:
                await asyncio.sleep(0)
        if rng.random() < 0.7:
            writer.write(frame(8, b"", rng))
        await asyncio.wait((reading,), timeout=0.3)
    except (ConnectionError, OSError):
        pass
    finally:
        reading.cancel()
        await asyncio.gather(reading, return_exceptions=True)
        writer.transport.abort()
    return max(sent, 1), bytes(answers)
