"""Wheel odometry: the rotation of wheels, and the pose that a robot integrates from it."""
