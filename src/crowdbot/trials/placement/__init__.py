"""Placement: positions and bodies of people at the beginning of a trial."""
