"""Floor 5: whole jobs over the rooms below: the catalogue, the demo and its report, and speed."""

from .catalogue import catalogue, cite, papers
from .demo import Demo, run_demo
from .report import Predicted, write_report
from .speed.timing import Row, measure
from .speed.workloads import measurements

__all__ = [
    "Demo",
    "Predicted",
    "Row",
    "catalogue",
    "cite",
    "measure",
    "measurements",
    "papers",
    "run_demo",
    "write_report",
]
