"""Fixed cameras of a trial, and what they see of the floor."""
