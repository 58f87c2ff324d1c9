"""What the studies of the preset people share: recorded experiments, errors of tracks, crowds, fits and profiles."""
