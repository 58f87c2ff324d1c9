"""Physics world: rigid bodies and contact forces, simulated by MuJoCo."""
