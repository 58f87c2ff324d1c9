"""Speed measurements, the rows of ``crowdbot bench``."""
