"""The TCP protocol of the challenge "Crowd against the machine"."""
