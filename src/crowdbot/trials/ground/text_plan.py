"""Floor plan of a trial that is given as XML, without its files and its own code."""

from __future__ import annotations

from crowdbot.core import Element, Path2D, format_xml, parse_xml

from .plan import floor_plan

DRAWN = ("ramp", "stairs", "platform", "threshold", "door")
"""Elements of a stage that a floor plan has."""


def floor_plan_of_xml(text: str, place: str = "trial") -> list[Path2D]:
    """Return the lines of uneven ground and doors of a trial as XML, see :func:`floor_plan`.

    Nothing else of the trial is read: its maps, recordings and classes may be missing. A recorded episode is drawn in
    this way.

    Args:
        text: the trial.
        place: name of the text in messages.

    Raises:
        InputError: the text is not XML.
        TrialError: a part of the ground or a door is invalid.

    >>> text = '<trial><stage map="no.yaml"><ramp x="2" y="0" length="4" width="2" height="0.3"/></stage></trial>'
    >>> len(floor_plan_of_xml(text)), floor_plan_of_xml("<trial/>")
    (2, [])
    """
    from crowdbot.trials.parser import parse_trial  # it reads the elements of this package

    root = parse_xml(text.encode(), place)
    parts = [part for stage in root.each("stage") for part in stage.children if part.tag in DRAWN]
    if not parts:
        return []
    stage, crowd = Element("stage", {}, parts), Element("crowd", {"type": "orca"})
    plain = Element("trial", {"name": "plan", "duration": "1", "world": "physics"}, [stage, crowd])
    return floor_plan(parse_trial(format_xml(plain), place=place).stage)
