"""Checks of a whole trial: places, overlaps, flows, rates."""
