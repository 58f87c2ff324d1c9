"""Orders: everything that a program outside asks of a running simulation, one kind in each file."""
