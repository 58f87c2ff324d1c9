"""Load of a bridge: its processor time with many topics at once."""
