"""People exchange, the fourth phase of a step: people leave, pass through portals, and enter."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Scene
from crowdbot.world.crowd.departure import leave_at_goals, leave_in_zone
from crowdbot.world.crowd.people_flow import PeopleFlow
from crowdbot.world.crowd.portal import PortalTransfer, apply_portals
from crowdbot.world.crowd.waypoint import PolygonZone

__all__ = ["exchange_people"]


def exchange_people(
    before: Scene,
    after: Scene,
    leave_radius: float | None,
    exits: Sequence[PolygonZone],
    portals: Sequence[PortalTransfer],
    flow: PeopleFlow,
    elapsed: float | NDArray[np.float64],
) -> Scene:
    """Return the scene after people at their goals and in exits have left, portals were used, and others entered.

    Args:
        before, after: scenes at the start of the step and after the motion.
        leave_radius: distance to the goal [m] below which people leave; None: they stay.
        exits, portals: zones.
        flow: journeys and sources; new people get identities from it.
        elapsed: time since the start [s], one or ``[E]``.
    """
    if leave_radius is not None:
        after = leave_at_goals(after, leave_radius)
    for zone in exits:
        after = leave_in_zone(after, zone)
    after = apply_portals(before, after, portals, flow.ids, flow.following)
    return flow.advance(after, elapsed)
