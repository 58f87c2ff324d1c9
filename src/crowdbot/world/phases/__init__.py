"""Phases of a step of a planar world, one file each: motion of people and robots, contacts, and flow of people."""
