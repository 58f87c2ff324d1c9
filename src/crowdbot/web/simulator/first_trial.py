"""The trial that a new session shows."""

from __future__ import annotations

FIRST: tuple[str, dict[str, str], int] = (
    "two-way",
    {"robot/type": "pepper", "end/collision": "false"},
    1,
)
"""Trial, values and seed that a new session shows: a robot among walking people."""
