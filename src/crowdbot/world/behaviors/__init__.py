"""Behaviour trees: which reaction, walk or stop a person chooses at each step."""
