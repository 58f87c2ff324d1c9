"""Parts of a robot of a trial: its type and its predictor."""
