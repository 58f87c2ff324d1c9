"""Sensors with the effects of real ones: pulsed laser scanners, and cameras with exposure and a rolling shutter."""
