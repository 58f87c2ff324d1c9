"""Evaluation of predictors on recordings, clean and degraded, and its plots."""
