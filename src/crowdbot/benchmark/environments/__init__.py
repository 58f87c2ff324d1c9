"""Speed of simulations of many environments, with navground and ir-sim in the same run."""
