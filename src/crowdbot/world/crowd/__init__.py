"""Crowd: routing, journeys, sources, portals, speed limits, contacts between people, and replay of recorded tracks."""
