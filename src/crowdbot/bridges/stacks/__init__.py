"""Robot software in processes of its own as the navigator of a trial."""
