"""Elements of the stage for uneven ground and doors."""
