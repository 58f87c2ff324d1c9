"""Placement: who stands where at the beginning, with which body."""
