"""Arrays of agents in the form that kernels accept: conversion and data types."""

from __future__ import annotations

import numpy as np

from crowdbot.core import dense

__all__ = ["BOOL", "FLOAT", "dense"]

FLOAT = np.dtype(np.float64)
BOOL = np.dtype(np.bool_)
