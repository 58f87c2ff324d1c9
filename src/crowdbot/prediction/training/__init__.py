"""Training of learned predictors: samples, training loop, checkpoints, access to PyTorch.

PyTorch is an optional dependency: ``pip install 'crowdbot[learn]'``. Importing this package does not load it.
"""
