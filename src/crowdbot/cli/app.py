"""``crowdbot app``: the app in the browser."""

from __future__ import annotations

import argparse
import asyncio
import ssl
from pathlib import Path
from typing import TYPE_CHECKING

from crowdbot.core import InputError

if TYPE_CHECKING:
    from crowdbot.web import AppServer


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("--port", type=int, default=8700, metavar="N", help="port (default: 8700; 0 takes a free one)")
    parser.add_argument(
        "--host",
        default="127.0.0.1",
        metavar="ADDRESS",
        help="address to listen on (default: 127.0.0.1, this machine only); others need the token that is printed",
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
        metavar="TRIAL|EPISODE",
        help="trial file, built-in name, or episode that is shown first (default: a robot among walking people)",
    )
    parser.add_argument("--no-browser", action="store_true", help="do not open a browser window")
    parser.add_argument("--certificate", type=Path, metavar="FILE", help="certificate for HTTPS, PEM")
    parser.add_argument("--key", type=Path, metavar="FILE", help="private key of the certificate, PEM")


def main(options: argparse.Namespace) -> int:
    """Serve until Ctrl-C."""
    from crowdbot.web import DESKS, AppServer, opened_first

    if not 0 <= options.port <= 65535:
        raise InputError(f"--port = {options.port}: expected 0 to 65535")
    desks, readable = DESKS, tuple[Path, ...]()
    if options.open is not None:
        desks, readable = opened_first(DESKS, options.open)
    server = AppServer(desks, options.folder, options.host, options.port, readable=readable, tls=_tls(options))
    try:
        asyncio.run(_serve(server, not options.no_browser))
    except KeyboardInterrupt:
        print("crowdbot: the app has stopped")
    return 0


def _tls(options: argparse.Namespace) -> ssl.SSLContext | None:
    if options.certificate is None:
        if options.key is not None:
            raise InputError("--key needs --certificate")
        return None
    context = ssl.create_default_context(ssl.Purpose.CLIENT_AUTH)
    try:
        context.load_cert_chain(options.certificate, options.key)
    except ssl.SSLError as error:
        raise InputError(f"--certificate {options.certificate}: not a certificate and key in PEM ({error})") from None
    return context


async def _serve(server: AppServer, browser: bool) -> None:
    import webbrowser

    async with server.running():
        print(f"crowdbot app: {server.url}  (Ctrl-C stops it)", flush=True)
        if browser:
            await asyncio.get_running_loop().run_in_executor(None, webbrowser.open, server.url)
        await asyncio.Event().wait()
