"""Phases of a step of a simulation after the motion, one file each: evaluation, sensing, and decision."""
