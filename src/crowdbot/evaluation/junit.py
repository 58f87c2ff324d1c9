"""JUnit XML of the verdicts of requirements, which continuous integration services read."""

from __future__ import annotations

from collections.abc import Sequence

from crowdbot.core import Element, format_xml

from .requirement import Requirement
from .result import EvaluationResult
from .verdict import judge_cell


def junit_xml(result: EvaluationResult, requirements: Sequence[Requirement]) -> str:
    """Return a report with one test case for each requirement and cell.

    >>> from crowdbot.evaluation import CellResult, RunRow, parse_requirement
    >>> runs = tuple(RunRow(k, "collision", "", {"collision": 1.0}) for k in range(4))
    >>> result = EvaluationResult((CellResult("hall", "orca", "", "", {}, runs),))
    >>> print(junit_xml(result, [parse_requirement("collision-rate<0.1")]).partition("suites")[2])
     name="crowdbot evaluate">
      <testsuite name="hall" tests="1" failures="1" errors="0">
        <testcase name="orca: collision-rate&lt;0.1" classname="hall">
          <failure message="collision-rate is 1 in 4 runs, required &lt; 0.1"/>
        </testcase>
      </testsuite>
    </testsuites>
    <BLANKLINE>
    """
    root = Element("testsuites", {"name": "crowdbot evaluate"})
    for trial in dict.fromkeys(cell.trial for cell in result.cells):
        suite = Element("testsuite", {"name": trial})
        failures = 0
        for cell in result.cells:
            if cell.trial != trial:
                continue
            for requirement in requirements:
                verdict = requirement.judge(cell.values(requirement.statistic.metric))
                label = " on ".join(filter(None, (cell.method, cell.robot)))
                warning = judge_cell(cell, requirements).warning
                case = Element("testcase", {"name": f"{label}: {requirement.text}", "classname": trial})
                if not verdict.holds:
                    case.children.append(Element("failure", {"message": verdict.sentence}))
                    failures += 1
                elif warning:
                    case.children.append(_warning(f"nothing is shown: {warning}"))
                suite.children.append(case)
        suite.attributes |= {"tests": str(len(suite.children)), "failures": str(failures), "errors": "0"}
        root.children.append(suite)
    return format_xml(root)


def _warning(text: str) -> Element:
    """Return the properties of a test case that passes, but shows nothing."""
    return Element("properties", children=[Element("property", {"name": "warning", "value": text})])
