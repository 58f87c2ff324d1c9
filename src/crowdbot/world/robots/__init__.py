"""Robots: drives, wheels, sensor mounts, and robot files."""
