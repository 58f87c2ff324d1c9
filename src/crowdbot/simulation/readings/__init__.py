"""Readings of sensors in a running simulation: names of people, and late or old readings."""
