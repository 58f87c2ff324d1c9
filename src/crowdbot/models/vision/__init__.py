"""Vision-based models: they use directions, times and distances of closest approach."""
