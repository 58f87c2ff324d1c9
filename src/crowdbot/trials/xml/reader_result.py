"""Reader result: the object that was read from an XML file, and every problem that was found."""

from __future__ import annotations

from typing import Any, NamedTuple

from crowdbot.core import Element, TrialError

MOST_PROBLEMS = 100


class ReaderProblem(NamedTuple):
    """A problem of an XML element: its line, its tag, and the end of a sentence about it."""

    line: int
    tag: str
    sentence: str


class ReaderResult:
    """The object that was read from an XML file, and every problem that was found.

    Args:
        place: name of the file for messages.
        root: root of the XML tree; problems of unknown elements are reported there.

    Attributes:
        value: the object of the root element, None if there is a problem in it.
        problems: of the elements, in the order in which they were found.
    """

    def __init__(self, place: str, root: Element) -> None:
        self.place, self.root = place, root
        self.value: Any = None
        self.problems: list[ReaderProblem] = []
        self._sources: dict[int, tuple[Any, Element]] = {}

    def add_element(self, made: Any, source: Element) -> None:
        """Add the object that was made of an XML element."""
        self._sources[id(made)] = (made, source)  # keeps the object alive, so its id stays unique

    def add_problem(self, source: Element, sentence: str) -> None:
        """Add a problem of an XML element."""
        self.problems.append(ReaderProblem(source.line, source.tag[:40], sentence))

    def report(self, made: Any, sentence: str) -> None:
        """Add a problem of an object."""
        self.add_problem(self._sources.get(id(made), (None, self.root))[1], sentence)

    @property
    def sentences(self) -> list[str]:
        """A sentence for every problem, without the line."""
        return [f"<{problem.tag}> {problem.sentence}" for problem in self.problems]

    def raise_problems(self) -> None:
        """Raise :class:`TrialError` with every problem in the order of the lines; return if there is none."""
        rows = sorted(self.problems, key=lambda row: row.line)
        sentences = [f"{self.place}:{line}: <{tag}> {sentence}" for line, tag, sentence in rows]
        if len(sentences) > MOST_PROBLEMS:
            more = len(sentences) - MOST_PROBLEMS
            sentences = [*sentences[:MOST_PROBLEMS], f"{self.place}: and {more} more problems"]
        if sentences:
            raise TrialError(*sentences)
