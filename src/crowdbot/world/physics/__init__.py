"""The physics world: bodies with mass, and the forces between them, simulated by MuJoCo."""
