"""Files beside a trial: maps, areas, recordings and code that it refers to."""
