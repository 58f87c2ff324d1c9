"""Models that sum forces: accelerations by the goal, other people and walls."""
