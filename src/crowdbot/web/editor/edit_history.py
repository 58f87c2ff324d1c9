"""EditHistory: the texts of a document for undo and redo."""

from __future__ import annotations

MOST_CHARACTERS = 64_000_000
"""Characters of all texts; the oldest are dropped."""


class EditHistory:
    """The texts of a document in the order of the edits.

    >>> history = EditHistory("a")
    >>> history.add("b"), history.undo(), history.redo(), history.can_redo
    (None, 'a', 'b', False)
    """

    def __init__(self, text: str) -> None:
        self._texts, self._now = [text], 0

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
