"""Doors: leaves that close a passage, and when they open."""
