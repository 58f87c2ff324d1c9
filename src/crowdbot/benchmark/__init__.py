"""Floor 5: whole jobs over the rooms below: the catalogue, the demo and its report, and speed."""

from .catalogue import catalogue, cite, papers
from .demo import Demo, run_demo
from .report import Predicted, write_report
from .speed import MEASUREMENTS, Row, measure

__all__ = [
    "MEASUREMENTS",
    "Demo",
    "Predicted",
    "Row",
    "catalogue",
    "cite",
    "measure",
    "papers",
    "run_demo",
    "write_report",
]
