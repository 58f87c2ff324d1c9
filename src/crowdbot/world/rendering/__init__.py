"""Cameras and offscreen rendering of a scene."""
