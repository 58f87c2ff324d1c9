"""Robots: drives, wheels, sensor mounts, and the files that describe them."""
