"""Files of a trial: maps, areas, recordings and code."""
