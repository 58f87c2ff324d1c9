"""Faults of robots in a trial: sensors, localization, commands and wheels that fail for some time."""
