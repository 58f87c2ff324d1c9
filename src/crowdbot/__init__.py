"""crowdbot: predict how a crowd moves in the next seconds, and test robots in simulated crowds."""
