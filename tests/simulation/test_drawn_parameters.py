"""Parameters that differ from person to person: kept by changes of a running simulation, new after a restart."""

import numpy as np

from crowdbot.simulation import AddElementOrder, Simulation
from crowdbot.trials import load_trial


def gaps(simulation):
    return np.asarray(simulation.world.model.robot_gap)


def test_a_new_robot_changes_nobody_and_has_room():
    simulation = Simulation(load_trial("frontal"), 3)
    before = gaps(simulation)
    parts = '<goal x="1" y="3"/><drive type="omnidirectional"/><navigator type="orca"/>'
    AddElementOrder(xml=f'<robot name="second" x="0" y="3">{parts}</robot>').apply(simulation)
    simulation.advance()
    assert np.array_equal(gaps(simulation)[: len(before)], before)
    assert len(gaps(simulation)) == simulation.world.scene.shape[1]


def test_a_restart_draws_by_the_new_seed():
    simulation = Simulation(load_trial("frontal"), 3)
    simulation.restart([0], [8])
    assert np.array_equal(gaps(simulation), gaps(Simulation(load_trial("frontal"), 8)))
    assert not np.array_equal(gaps(simulation), gaps(Simulation(load_trial("frontal"), 3)))
