"""Faults of robots in a running simulation."""
