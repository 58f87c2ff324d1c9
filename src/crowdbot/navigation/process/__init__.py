"""A navigator in a process of its own: the protocol, both ends, and a sandbox for code that is not trusted."""
