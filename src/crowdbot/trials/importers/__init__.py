"""Trials from other sources: the original simulator, recordings of people."""
