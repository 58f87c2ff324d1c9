"""Recorded scans with annotated people or odometry, and scores of detectors and trackers on them."""
