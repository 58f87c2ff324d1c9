"""Postures of people who lose their balance."""
