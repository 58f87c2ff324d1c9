"""Training of learned predictors with PyTorch (extra ``[learn]``); predicting needs none of it."""
