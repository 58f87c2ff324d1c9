"""Models based on velocity obstacles."""
