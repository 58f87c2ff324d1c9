"""GAN methods against mode collapse that are compared on the toy data."""

from __future__ import annotations

from typing import Any

from crowdbot.prediction import PRESETS, STEADY

__all__ = ["METHODS"]

METHODS: dict[str, dict[str, Any]] = {
    "vanilla": {},
    "l2": {"use_l2_loss": True},
    "s-gan-v20": {"use_variety_loss": True, "variety_draws": 20},
    "unrolled10": {"unrolling_steps": 10},
    "info": {"use_info_loss": True},
    "info+unrolled5": {"use_info_loss": True, "unrolling_steps": 5},
    "unrolled10+l2": {"unrolling_steps": 10, "use_l2_loss": True},
    "info+rates-of-code": {
        "use_info_loss": True, "generator_rate": 1e-4, "discriminator_rate": 1e-3, "adversarial": "least-squares"
    },
    "vanilla+slope-penalty": STEADY,
    "info+slope-penalty": {"use_info_loss": True, **STEADY},
    "info+discrete-codes": {"use_info_loss": True, **STEADY, "code_levels": 3, "noise": 4},
    "info+discrete-code+variety": {
        "use_info_loss": True, **PRESETS["modes"], "variety_draws": 20, "variety_growth": 100.0
    },
}  # fmt: skip
"""Settings of each method that differ from a plain GAN with the settings of the report.

The first seven are in figures 17 and 18 of the report; ``info+rates-of-code`` has the settings of its published code;
the others are new.
"""
