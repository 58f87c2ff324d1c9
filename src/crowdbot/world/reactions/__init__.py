"""Reactions of people to robots, on top of any crowd model."""
