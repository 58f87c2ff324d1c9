"""AccessPolicy: who may use a server of this package: the app, headsets, rosbridge and Foxglove; and its end."""

from __future__ import annotations

import asyncio
import base64
import contextlib
import hashlib
import hmac
import ipaddress
import secrets
from dataclasses import dataclass, field
from urllib.parse import urlsplit

SIGNATURE = 32
"""Characters of the signature in the token of a session: 192 bits."""


def is_loopback(host: str) -> bool:
    """Return whether a host is this machine only.

    >>> is_loopback("127.0.0.1"), is_loopback("localhost"), is_loopback("0.0.0.0")
    (True, True, False)
    """
    if host.casefold() == "localhost":
        return True
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False


@dataclass(frozen=True)
class AccessPolicy:
    """Rules for requests: the host they name, the page they come from, and a token.

    A browser says from which page a request comes, ``null`` for a file and for a frame without rights. Only the pages
    of the server itself and those of ``origins`` are allowed, unless the client gives the token. Programs that are no
    browser have no origin. On the loopback address no token is needed; a name that another site has pointed at this
    machine (DNS rebinding) is refused by its host. Beyond it every request needs the token, unless the server says that
    it is open.

    Args:
        host: address that the server listens on.
        token: secret of the server; random by default.
        origins: pages of others that are allowed, such as ``https://app.foxglove.dev``.
        asks: whether requests need the token; None: only beyond the loopback address.

    >>> AccessPolicy("127.0.0.1").refusal("localhost:8000", "https://example.org", None)
    'requests from https://example.org are refused: open the page of this server, or let it allow them'
    >>> AccessPolicy("127.0.0.1", origins=("https://example.org",)).refusal("localhost:80", "https://example.org", None)
    """

    host: str
    token: str = field(default_factory=lambda: secrets.token_urlsafe(24))
    origins: tuple[str, ...] = ()
    asks: bool | None = None

    @property
    def needs_token(self) -> bool:
        """Whether requests need the token."""
        return not is_loopback(self.host) if self.asks is None else self.asks

    def session_token(self, session: str) -> str:
        """Return the token that opens one session only: its name and a signature by the token of the server.

        >>> AccessPolicy("0.0.0.0", "secret").session_token("anna").partition(".")[0]
        'anna'
        """
        digest = hmac.new(self.token.encode(), b"session:" + session.encode(), hashlib.sha256).digest()
        return f"{session}.{base64.urlsafe_b64encode(digest).decode()[:SIGNATURE]}"

    def opens(self, token: str, path: str) -> bool:
        """Return whether the token of a session opens an address of the server: the page, or what its session has.

        >>> policy = AccessPolicy("0.0.0.0", "secret")
        >>> token = policy.session_token("anna")
        >>> [policy.opens(token, path) for path in ("/", "/api/anna/socket", "/api/ben/socket")]
        [True, True, False]
        """
        session = token.partition(".")[0]
        if not hmac.compare_digest(token.encode("utf-8", "surrogatepass"), self.session_token(session).encode()):
            return False
        return not path.startswith("/api/") or path.startswith(f"/api/{session}/")

    def refusal(self, host: str | None, origin: str | None, token: str | None, given: bool = False) -> str | None:
        """Return why a request is refused, or None if it is allowed.

        Args:
            host: header ``Host``, if the request has one.
            origin: header ``Origin``, if the request has one.
            token: token of the request, from the address, a header or a cookie.
            given: whether the client itself gives the token: a browser adds a cookie for pages that do not know it.
        """
        name = _hostname(host)
        if not name:
            return "the request has no header Host with an address"
        knows = hmac.compare_digest((token or "").encode("utf-8", "surrogatepass"), self.token.encode())
        if not self.needs_token and not self._is_reached_as(name, origin):
            place = "the loopback address" if is_loopback(self.host) else "its address"
            return f"the server answers on {place} only, not as {_shown(host)}"
        own = origin is None or origin.casefold() in {f"{scheme}://{host}".casefold() for scheme in ("http", "https")}
        if not own and origin not in self.origins and not (self.needs_token and given and knows):
            return f"requests from {_shown(origin)} are refused: open the page of this server, or let it allow them"
        if self.needs_token and not knows:
            return "the token is missing or wrong: add ?token=TOKEN of the server to the address"
        return None

    def _is_reached_as(self, name: str, origin: str | None) -> bool:
        """Return whether a request names this machine, and not a name that a site has pointed at it."""
        if is_loopback(self.host):
            return is_loopback(name)
        return origin is None or is_loopback(name) or _is_address(name)


def _hostname(host: str | None) -> str:
    try:
        return urlsplit(f"//{host or ''}").hostname or ""
    except ValueError:
        return ""


def _shown(text: str | None) -> str:
    """Return a header for a sentence: its bytes need not be text."""
    return (text or "")[:80].encode("ascii", "backslashreplace").decode()


def _is_address(host: str) -> bool:
    try:
        return bool(ipaddress.ip_address(host))
    except ValueError:
        return False


async def close_listener(listener: asyncio.Server) -> None:
    """Stop to listen; the server gets each connection that was accepted before, and closes it.

    A listener that is closed while a connection is on its way to the server loses it, with its socket open
    (https://github.com/python/cpython/issues/109564).
    """
    for socket in listener.sockets:
        with contextlib.suppress(NotImplementedError):  # on Windows nothing lies between accepting and the server
            asyncio.get_running_loop().remove_reader(socket.fileno())
    for _ in range(2):  # turns of the loop from accepting to the server
        await asyncio.sleep(0)
    listener.close()
