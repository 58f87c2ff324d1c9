"""Tracking of people by the sensors of robots in a simulation."""
