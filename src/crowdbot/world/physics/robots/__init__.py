"""Robots in the physics world: bodies, servos of wheels and bases, springs of castors, forces on links."""
