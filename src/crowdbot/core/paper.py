"""Paper: the publication of a model, sensor or metric."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Paper:
    """One publication.

    >>> print(Paper("Reynolds", 1987, "Flocks, herds and schools", "SIGGRAPH", "10.1145/37401.37406"))
    Reynolds (1987). Flocks, herds and schools. SIGGRAPH. https://doi.org/10.1145/37401.37406
    """

    authors: str
    year: int
    title: str
    venue: str
    doi: str = ""

    def __str__(self) -> str:
        link = f" https://doi.org/{self.doi}" if self.doi else ""
        return f"{self.authors} ({self.year}). {self.title}. {self.venue}.{link}"

    def bibtex(self) -> str:
        """Return the BibTeX entry."""
        key = self.authors.split(",")[0].split()[-1].lower() + str(self.year)
        doi = f"  doi = {{{self.doi}}},\n" if self.doi else ""
        return (
            f"@article{{{key},\n  author = {{{self.authors}}},\n  title = {{{self.title}}},\n"
            f"  journal = {{{self.venue}}},\n  year = {{{self.year}}},\n{doi}}}"
        )
