"""Evaluation of predictors of scans on logged scans."""
