"""AccessPolicy: who may use the server."""

from __future__ import annotations

import base64
import hashlib
import hmac
import ipaddress
import secrets
from dataclasses import dataclass, field
from urllib.parse import urlsplit

COOKIE = "crowdbot-token"
"""Name of the cookie that holds the token after the first page."""
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

    On the loopback address no token is needed, since a page of another site is refused by its origin, and a name that
    another site has pointed at this machine by its host (DNS rebinding). Beyond it every request needs the token.

    Args:
        host: address that the server listens on.
        token: secret of the server; random by default.

    >>> AccessPolicy("127.0.0.1").refusal("localhost:8000", "https://example.org", None)
    'requests from https://example.org are refused: open the page of this server'
    """

    host: str
    token: str = field(default_factory=lambda: secrets.token_urlsafe(24))

    @property
    def needs_token(self) -> bool:
        """Whether requests need the token."""
        return not is_loopback(self.host)

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
        if not hmac.compare_digest(token.encode(), self.session_token(session).encode()):
            return False
        return not path.startswith("/api/") or path.startswith(f"/api/{session}/")

    def refusal(self, host: str, origin: str | None, token: str | None) -> str | None:
        """Return why a request is refused, or None if it is allowed.

        Args:
            host: header ``Host``.
            origin: header ``Origin``, if the request has one.
            token: token of the request, from the address or the cookie.
        """
        if not self.needs_token and not is_loopback(urlsplit(f"//{host}").hostname or ""):
            return f"the server answers on the loopback address only, not as {host}"
        if origin is not None and urlsplit(origin).netloc != host:
            return f"requests from {origin} are refused: open the page of this server"
        if self.needs_token and not hmac.compare_digest((token or "").encode(), self.token.encode()):
            return "the token is missing or wrong: open the address that crowdbot app has printed"
        return None
