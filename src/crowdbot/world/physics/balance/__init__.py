"""Balance of people in the physics world: bracing, recovery steps and falls."""
