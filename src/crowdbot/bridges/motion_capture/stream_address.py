"""Addresses of streams, such as ``xsens:9763`` or ``walk.bvh``, and who moves whom, such as ``xsens:9763=guide``."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from crowdbot.core import InputError, read_bytes
from crowdbot.trials import Trial

from .bvh import read_bvh
from .csv_take import read_csv
from .motion_capture import MotionBinding, MotionCapture
from .mvnx import read_mvnx
from .natnet import NatNetStream
from .pose_stream import PoseStream
from .server_stream import ServerStream
from .vrpn import VrpnStream
from .xsens import PORT as XSENS_PORT
from .xsens import XsensStream

SERVERS: dict[str, type[ServerStream]] = {"natnet": NatNetStream, "vrpn": VrpnStream}
FILES = {".bvh": read_bvh, ".csv": read_csv, ".mvnx": read_mvnx}
FORM = "SOURCE[#SUBJECT]=NAME[@X,Y,HEADING]"
EXAMPLES = "xsens:9763=guide, natnet:192.168.0.5#Cart=twin or walk.bvh=guide@4,0,3.14"


def open_stream(address: str) -> PoseStream:
    """Return the stream at an address; enter it as a context to receive.

    Args:
        address: ``xsens:PORT`` or ``xsens:HOST:PORT`` (the address to listen on), ``natnet:SERVER`` or
            ``natnet:SERVER:PORT``, ``vrpn:SERVER`` or ``vrpn:SERVER:PORT``, or the path of a .bvh, .csv or .mvnx file.

    Raises:
        InputError: the address or file is not valid.

    >>> open_stream("natnet:127.0.0.1").port
    1510
    """
    kind, _, rest = address.partition(":")
    if kind == "xsens":
        host, port = _host_port(rest, "127.0.0.1", XSENS_PORT, address)
        return XsensStream(host, port)
    if kind in SERVERS:
        server, _, port_text = rest.partition(":")
        stream = SERVERS[kind]
        return stream(server or "127.0.0.1", _port(port_text, stream.default_port, address))
    path = Path(address)
    reader = FILES.get(path.suffix.lower())
    if reader is None:
        raise InputError(
            f"motion capture {address!r} must be xsens:PORT, natnet:SERVER, vrpn:SERVER or a file that ends in"
            f" {', '.join(FILES)}"
        )
    return reader(read_bytes(path), str(path))


def _host_port(text: str, host: str, port: int, address: str) -> tuple[str, int]:
    """Return host and port of ``HOST:PORT``, ``HOST`` or ``PORT``."""
    first, colon, second = text.partition(":")
    if colon:
        return first or host, _port(second, port, address)
    return (host, _port(first, port, address)) if first.isdigit() or not first else (first, port)


def _port(text: str, default: int, address: str) -> int:
    if not text:
        return default
    if not re.fullmatch(r"\d{1,5}", text) or int(text) > 65535:
        raise InputError(f"motion capture {address!r}: port {text[:40]!r} must be a number from 0 to 65535")
    return int(text)


def parse_captures(texts: Sequence[str], trial: Trial) -> list[MotionCapture]:
    """Return the motion captures that some texts describe; those with the same source share a stream.

    Args:
        texts: such as ``xsens:9763=guide``: source, possibly ``#`` and a subject, ``=``, the name of an avatar or
            robot, and possibly ``@`` and the place of the origin of the source in the trial: x, y [m], heading [rad].
        trial: the trial, which must have the avatars and robots.

    Raises:
        InputError: a text, a file or a name is not valid.

    >>> from crowdbot.trials import parse_trial
    >>> trial = parse_trial('''<trial name="led" duration="1"><stage/><crowd type="orca"/>
    ...   <avatar name="guide" source="external" x="0" y="0"/></trial>''')
    >>> parse_captures(["xsens:9763#Anna=guide@2,0,1.57"], trial)[0].bindings[0].subject
    'Anna'
    """
    found: dict[str, list[MotionBinding]] = {}
    for text in texts:
        address, binding = parse_binding(text)
        found.setdefault(address, []).append(binding)
    targets = [one.target for bindings in found.values() for one in bindings]
    for name in targets:
        if targets.count(name) > 1:
            raise InputError(f"motion capture moves {name!r} twice")
    captures = []
    for address, bindings in found.items():
        capture = MotionCapture(open_stream(address), bindings)
        capture.check(trial)
        known = capture.stream.subjects()
        for one in bindings:
            if not capture.stream.live and one.subject and one.subject not in known:
                raise InputError(f"{address} has no subject {one.subject!r}; it has {', '.join(known)}")
        captures.append(capture)
    return captures


def parse_binding(text: str) -> tuple[str, MotionBinding]:
    """Return the address of a stream and the binding that a text such as ``xsens:9763=guide`` describes.

    Raises:
        InputError: the text has another form.

    >>> parse_binding("walk.bvh=guide@1,2")[1].y
    2.0
    """
    match = re.fullmatch(r"(?P<source>[^#=]+)(#(?P<subject>[^=]+))?=(?P<name>[^@=]+)(@(?P<origin>.*))?", text)
    if match is None:
        raise InputError(f"motion capture {text!r} must have the form {FORM}, such as {EXAMPLES}")
    origin = [0.0, 0.0, 0.0]
    if match["origin"] is not None:
        try:
            numbers = [float(word) for word in match["origin"].split(",")]
        except ValueError:
            numbers = []
        if len(numbers) not in (2, 3):
            raise InputError(f"motion capture {text!r}: {match['origin']!r} must be X,Y or X,Y,HEADING in m and rad")
        origin[: len(numbers)] = numbers
    return match["source"], MotionBinding(match["name"], match["subject"] or "", *origin)
