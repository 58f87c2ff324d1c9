"""State: a simulation as plain values, for keyframes of episodes, and back."""
