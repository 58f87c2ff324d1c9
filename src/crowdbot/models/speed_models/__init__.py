"""First-order models: they choose a direction, and then a speed that depends on the space ahead."""
