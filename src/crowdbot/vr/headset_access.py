"""The token of a headset: it opens one session for a participant, not the app of the operator."""

from __future__ import annotations

import base64
import hashlib
import hmac
import re

HEADSET_COOKIE = "crowdbot-headset"
"""Name of the cookie that holds the token of a headset; that of the operator stays beside it."""
LENGTH = 32
"""Characters of the signature: 192 bits."""
PAGES = frozenset(("/vr", "/vr.js", "/vr.css", "/icon.svg", "/licenses.txt"))
PARTS = re.compile(r"(headset|headset-window|(simulator|experiments)/(bodies|robots)/[^/]+\.bin)\Z")
"""Addresses below ``/api/SESSION/`` that a headset needs: its sockets, and meshes of bodies and robots."""


def token_of_session(secret: str, session: str) -> str:
    """Return the token of the headsets of a session: its name and a signature by the secret of the server.

    >>> token_of_session("secret", "main").partition(".")[0]
    'main'
    """
    digest = hmac.new(secret.encode(), b"headset:" + session.encode(), hashlib.sha256).digest()
    return f"{session}.{base64.urlsafe_b64encode(digest).decode()[:LENGTH]}"


def session_of_token(secret: str, token: str) -> str | None:
    """Return the session that a token of headsets opens, or None if it is none of this server.

    >>> session_of_token("secret", token_of_session("secret", "main"))
    'main'
    >>> session_of_token("secret", "main.AAAA") is None
    True
    """
    session = token.rpartition(".")[0]
    right = token_of_session(secret, session)
    return session if hmac.compare_digest(token.encode(), right.encode()) else None


def is_headset_path(path: str, session: str) -> bool:
    """Return whether a headset of a session needs an address of the server.

    >>> is_headset_path("/vr", "main"), is_headset_path("/api/main/socket", "main")
    (True, False)
    """
    start = f"/api/{session}/"
    return path in PAGES or (path.startswith(start) and bool(PARTS.match(path.removeprefix(start))))
