"""Speed of crowd models beside other engines: the same people, time step and neighbours, in one run."""
