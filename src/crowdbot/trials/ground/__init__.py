"""Elements of the stage for uneven ground, and the floor plan."""
