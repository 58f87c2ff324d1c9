"""Drives: limits of each kind of base, and the twist and wheel speeds of its commands."""
