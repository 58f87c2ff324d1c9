"""Models that choose a direction first, and then a speed that depends on the space ahead (first-order models)."""
