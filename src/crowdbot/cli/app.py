"""``crowdbot app``: the app in the browser."""

from __future__ import annotations

import argparse
import asyncio
import dataclasses
import os
import ssl
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from crowdbot.core import PROGRAMS, InputError, is_loopback

if TYPE_CHECKING:
    from crowdbot.vr import VrServer
    from crowdbot.web import SessionLimits

    from .parser import CommandParser

LIMITS: dict[str, tuple[type, int, str, str]] = {
    "jobs": (int, 1, "N", "jobs that run at the same time (default: 2; 1)"),
    "waiting": (int, 1, "N", "jobs that may wait (default: 20; 5)"),
    "cpu-time": (float, 1, "SECONDS", "processor time of all jobs (default: no limit; 7200)"),
    "memory": (float, 10**6, "MB", "memory of each job (default: 80 %% of this machine; 2000)"),
    "upload-size": (float, 10**6, "MB", "largest file that is taken (default: 512; 128)"),
    "disk-space": (float, 10**6, "MB", "size of the folder (default: no limit; 1000)"),
    "windows": (int, 1, "N", "windows at the same time (default: 20; 6)"),
    "idle-time": (float, 60, "MINUTES", "time without a window and a job until the session ends (default: never; 120)"),
}
"""Options of the limits: type, factor to the unit of the limit, metavariable, help."""

EVERYWHERE = "0.0.0.0"  # noqa: S104 - asked for with --vr; every request then needs the token


def arguments(parser: CommandParser) -> None:
    """Declare the options."""
    parser.add_argument("--port", type=int, default=8700, metavar="N", help="port (default: 8700; 0 takes a free one)")
    parser.add_argument(
        "--host",
        metavar="ADDRESS",
        help="address to listen on (default: 127.0.0.1, this machine only; with --vr all addresses of this machine);"
        " others need the token that is printed",
    )
    parser.add_argument(
        "--folder",
        type=Path,
        default=Path("crowdbot-app"),
        metavar="DIR",
        help="folder for the files that the app reads and writes (default: crowdbot-app)",
    )
    parser.add_argument(
        "--open",
        metavar="FILE|TRIAL",
        help="what is shown first: a trial (file or built-in name), an episode, a recording of people, or the result of"
        " an evaluation (result.json or its folder); default: a robot among walking people",
    )
    parser.add_argument("--no-browser", action="store_true", help="do not open a browser window")
    parser.add_argument(
        "--vr",
        action="store_true",
        help="let headsets of the local network in: HTTPS with an own certificate, on all addresses of this machine",
    )
    _server_arguments(parser)
    _stream_arguments(parser)


def _server_arguments(parser: CommandParser) -> None:
    parser.add_argument("--certificate", type=Path, metavar="FILE", help="certificate for HTTPS, PEM")
    parser.add_argument("--key", type=Path, metavar="FILE", help="private key of the certificate, PEM")
    parser.add_argument(
        "--programs",
        action="store_true",
        help="let trials start programs (process navigators, robot software) on a server for other machines (--host)",
    )
    parser.add_argument("--sessions", type=int, default=40, metavar="N", help="sessions at the same time (default: 40)")
    parser.add_argument(
        "--students",
        type=lambda text: text.split(","),
        default=[],
        metavar="NAME,...",
        help="print an address for each of these sessions, which opens no other session",
    )
    group = parser.add_rare_group(
        "limits of each session", "the second default is that of a server for other machines (--host)"
    )
    for name, (kind, _, word, text) in LIMITS.items():
        group.add_argument(f"--{name}", type=kind, metavar=word, help=text)


def _stream_arguments(parser: CommandParser) -> None:
    parser.add_argument(
        "--lsl",
        action="store_true",
        help="sessions of experiments send events, head poses and robot poses over the Lab Streaming Layer",
    )
    parser.add_argument(
        "--lsl-record",
        action="append",
        default=[],
        metavar="STREAM",
        help="sessions of experiments record streams of the Lab Streaming Layer: a name, or PROPERTY=VALUE such as"
        " type=EEG (repeatable)",
    )
    parser.add_argument(
        "--mocap",
        action="append",
        default=[],
        metavar="SOURCE=NAME",
        help="motion capture that moves an avatar or robot, and the suit of a participant in a headset:"
        " xsens:9763=participant or natnet:HOST#Cart=robot; repeatable",
    )


def main(options: argparse.Namespace) -> int:
    """Serve until Ctrl-C."""
    from crowdbot.vr import VR_DESKS, VrServer, with_captures
    from crowdbot.web import opened_first, with_streams

    if not 0 <= options.port <= 65535:
        raise InputError(f"--port = {options.port}: expected 0 to 65535")
    desks, readable, tab = VR_DESKS, tuple[Path, ...](), ""
    if options.open is not None:
        desks, readable, tab = opened_first(VR_DESKS, options.open)
    if options.lsl or options.lsl_record:
        desks = with_streams(desks, options.lsl, options.lsl_record)
    if options.mocap:
        desks = with_captures(desks, options.mocap)
    host = options.host or (EVERYWHERE if options.vr else "127.0.0.1")
    # with --vr alone, other machines are headsets, whose token opens no trial
    if options.host is not None and not is_loopback(host) and not options.programs:
        os.environ[PROGRAMS] = "refuse"  # jobs inherit it
    server = VrServer(
        desks,
        options.folder,
        host,
        options.port,
        readable=readable,
        tls=_tls(options),
        limits=_limits(options, host),
        most_sessions=options.sessions,
    )
    try:
        place = f"#tab={tab}" if tab else ""
        asyncio.run(_serve(server, not options.no_browser, options.vr, place, options.students))
    except KeyboardInterrupt:
        print("crowdbot: the app has stopped")
    return 0


def _limits(options: argparse.Namespace, host: str) -> SessionLimits:
    """Return the limits of each session: those of the place, with the options that are given."""
    from crowdbot.web import CLASSROOM, SessionLimits

    if options.sessions < 1:
        raise InputError(f"--sessions = {options.sessions}: expected at least 1")
    given = {}
    for name, (_, unit, _, _) in LIMITS.items():
        value = getattr(options, name.replace("-", "_"))
        if value is not None:
            if not value > 0:
                raise InputError(f"--{name} = {value:g}: expected a positive number")
            given[name.partition("-")[0]] = value * unit
    return dataclasses.replace(SessionLimits() if is_loopback(host) else CLASSROOM, **given)


def _tls(options: argparse.Namespace) -> ssl.SSLContext | None:
    if options.certificate is None:
        if options.key is not None:
            raise InputError("--key needs --certificate")
        if options.vr:
            from crowdbot.vr import certificate_files, tls_context

            return tls_context(*certificate_files())
        return None
    context = ssl.create_default_context(ssl.Purpose.CLIENT_AUTH)
    try:
        context.load_cert_chain(options.certificate, options.key)
    except ssl.SSLError as error:
        raise InputError(f"--certificate {options.certificate}: not a certificate and key in PEM ({error})") from None
    return context


async def _serve(server: VrServer, browser: bool, vr: bool, place: str, students: Sequence[str]) -> None:
    import webbrowser

    from crowdbot.vr import link_text, local_addresses

    if server.host == EVERYWHERE:
        server.reached_at = next(iter(local_addresses()), "127.0.0.1")
    async with server.running():
        page = server.url.replace(EVERYWHERE, "127.0.0.1", 1) + place
        print(f"crowdbot app: {page}  (Ctrl-C stops it)", flush=True)
        for name in students:
            print(f"{name}: {server.session_address(name).replace(EVERYWHERE, server.reached_at, 1)}", flush=True)
        if vr:
            print(f"headset: {server.vr_url}")
            print("The certificate is made by this machine: accept the warning of the headset once.")
            print(link_text(server.vr_url), flush=True)
        if browser:
            await asyncio.get_running_loop().run_in_executor(None, webbrowser.open, page)
        await asyncio.Event().wait()
