"""Evaluation of perception: detectors and trackers on logged readings, against the true people."""
