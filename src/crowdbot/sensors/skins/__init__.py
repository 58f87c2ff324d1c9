"""Rays at triangle skins: a tree of boxes for each person, and the casting of beams through it."""
