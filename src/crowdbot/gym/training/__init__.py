"""Training of the navigator ``policy`` by proximal policy optimisation (PPO), in PyTorch.

PyTorch is an optional dependency: ``pip install 'crowdbot[gym,learn]'``. Importing this package does not load it.
"""
