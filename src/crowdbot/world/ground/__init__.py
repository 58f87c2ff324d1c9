"""Uneven ground: ramps, stairs, platforms and thresholds, how high they are, who can pass them, and what rays hit."""
