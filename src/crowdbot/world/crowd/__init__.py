"""People: routing, journeys, sources, speed limits, contacts between discs and replay of recordings."""
