"""Models that choose a velocity outside of velocity obstacles."""
