"""Runs of a search with a sensor of people have the digests of single runs, however many run together."""

from __future__ import annotations

import numpy as np
import pytest

from crowdbot.falsification import PlainSampling, SearchSpace, falsify, parse_factor
from crowdbot.simulation import simulate
from crowdbot.trials import parse_trial

TRIAL = """<trial name="tracked" duration="3" step="0.1">
<crowd type="orca"/>
{agents}
<robot x="0" y="-3" heading="1.57" radius="0.3" visible="false" control-period="0.2" holonomic="true">
<goal x="0" y="3"/>
<drive type="omnidirectional" max-speed="1" max-acceleration="1000"/>
<navigator type="orca" safety="0.15"/>
<sensor type="ground-truth-people" name="people" rate="10" visible-only="{only}"/>
<fault type="late-sensor" delay="0.05"/>
</robot>
</trial>"""
STILL = '<agent name="p1" x="2" y="0" goal="-2,0" speed="1"/>'
LEAVES = '<agent name="p2" x="1" y="2" goal="1,1.4" speed="1.3"/>'


@pytest.mark.parametrize("only", ["true", "false"])
@pytest.mark.parametrize("agents", [STILL, LEAVES + STILL])
def test_digests_of_people_sensors_do_not_depend_on_the_batch(agents: str, only: str) -> None:
    factors = ("agent[p1]/x=normal(2, 0.2)", "robot/fault/delay=normal(0.1, 0.1, 0, 0.4)")
    space = SearchSpace(parse_trial(TRIAL.format(agents=agents, only=only)), tuple(map(parse_factor, factors)))
    samples = falsify(space, "collision", PlainSampling(), runs=6, seed=4).samples
    assert len({sample.digest for sample in samples}) == 6
    for sample in samples:
        assert simulate(space.variant(np.array(sample.point)), sample.seed).digest == sample.digest
