"""Learned predictors by name, ready to train."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from crowdbot.core import UnknownName

if TYPE_CHECKING:
    from .training.loop import Trainable
    from .training.samples import Samples


WEIGHTS_FIELDS = {"anchor-net": "file", "social-ways": "checkpoint"}
"""Learned predictor -> the parameter that takes the file of its weights."""


def make_learner(
    name: str,
    settings: str | None,
    values: Mapping[str, str],
    samples: Samples,
    watched: Samples,
    seed: int = 0,
    device: str = "cpu",
    start: str = "",
) -> Trainable:
    """Return a network with random weights, or those of another training, ready for :func:`~crowdbot.prediction.train`.

    Args:
        name: ``anchor-net`` or ``social-ways``.
        settings: name of a preset; None means the default preset.
        values: settings that differ from the preset, as text.
        samples: training data.
        watched: validation data.
        seed: seed of the weights and of all random draws.
        device: ``cpu``, ``cuda`` or ``cuda:N``.
        start: weights from which the training starts: a file, or shipped ones: ``open`` (anchor-net) or a place.

    Raises:
        UnknownName: the name is unknown.
        InputError: a setting is unknown or not allowed, or the samples have other rows.
        MissingExtra: PyTorch is not installed.
    """
    if name not in WEIGHTS_FIELDS:
        raise UnknownName("learned predictor", name, WEIGHTS_FIELDS)
    if name == "anchor-net":
        from .anchor_net import training as anchor_net

        return anchor_net.learner(settings, values, samples, watched, seed, device, start)
    from .social_ways import training as social_ways

    return social_ways.learner(settings, values, samples, watched, seed, device, start)
