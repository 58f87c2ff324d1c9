"""EditHistory: the texts of a document for undo and redo."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

MOST_CHARACTERS = 64_000_000
"""Characters of all texts; the oldest are dropped."""
STORED = 1_000_000
"""Characters of the texts that are stored, since they are written after each edit."""


class EditHistory:
    """The texts of a document in the order of the edits.

    >>> history = EditHistory("a")
    >>> history.add("b"), history.undo(), history.redo(), history.can_redo
    (None, 'a', 'b', False)
    >>> EditHistory.restored(history.stored(), longest=10).undo()
    'a'
    """

    def __init__(self, text: str) -> None:
        self._texts, self._now = [text], 0

    @staticmethod
    def restored(values: Mapping[str, Any], longest: int) -> EditHistory | None:
        """The history that :meth:`stored` gave; None for other values or a text with more than `longest` characters."""
        texts, now = values.get("texts"), values.get("now")
        if not isinstance(texts, list) or not all(isinstance(text, str) and len(text) <= longest for text in texts):
            return None
        if not isinstance(now, int) or isinstance(now, bool) or not 0 <= now < len(texts):
            return None
        history = EditHistory("")
        history._texts, history._now = list(texts), now
        return history

    def stored(self) -> dict[str, Any]:
        """The text now and those nearest to it, JSON: `texts`, and the place `now` of the present one.

        Together they have at most :data:`STORED` characters; earlier texts come before later ones. The present text is
        always among them.
        """
        first, last, room = self._now, self._now + 1, STORED - len(self.text)
        while first > 0 and len(self._texts[first - 1]) <= room:
            first -= 1
            room -= len(self._texts[first])
        while last < len(self._texts) and len(self._texts[last]) <= room:
            room -= len(self._texts[last])
            last += 1
        return {"texts": self._texts[first:last], "now": self._now - first}

    @property
    def text(self) -> str:
        """The text now."""
        return self._texts[self._now]

    @property
    def can_undo(self) -> bool:
        """Whether there is an earlier text."""
        return self._now > 0

    @property
    def can_redo(self) -> bool:
        """Whether there is a later text."""
        return self._now < len(self._texts) - 1

    def add(self, text: str) -> None:
        """Add a text after the present one; later ones are dropped. The same text is not added."""
        if text == self.text:
            return
        self._texts[self._now + 1 :] = [text]
        self._now += 1
        total = sum(map(len, self._texts))
        while total > MOST_CHARACTERS and self._now > 0:
            total -= len(self._texts.pop(0))
            self._now -= 1

    def undo(self) -> str:
        """Go back by one text and return it."""
        self._now = max(0, self._now - 1)
        return self.text

    def redo(self) -> str:
        """Go forward by one text and return it."""
        self._now = min(len(self._texts) - 1, self._now + 1)
        return self.text
