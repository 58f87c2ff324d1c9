"""Settings of Social Ways: the options of the report and additional ones."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from crowdbot.core import InputError, did_you_mean

ADVERSARIAL = ("cross-entropy", "least-squares")
FRAMES = ("person", "world")


@dataclass(frozen=True)
class SocialWaysConfig:
    """Settings of the network and its training; the defaults are those of the report (table 2, section 2.2.8).

    Fields of table 2:
        unrolling_steps: unrolled discriminator steps per generator step; 0 for a plain GAN.
        use_info_loss, info_weight: loss for recovering the latent codes from the prediction.
        latent_codes: number of latent codes.
        use_l2_loss, l2_weight: squared distance of one sample to the ground truth.
        generator_rate, discriminator_rate: learning rates of Adam.
    Fields of the text:
        adversarial: ``cross-entropy`` or ``least-squares``; ``adversarial_weight`` is its weight for the generator.
        use_variety_loss, variety_weight, variety_draws: squared distance of the best sample of each person.
        momentum: first-moment coefficient of Adam.
        batch: approximate number of people with a known future per update; scenes are not split.
        observe, predict: number of rows, tau + 1 and T.
        hidden, pooled, noise: sizes of the LSTMs, the pooled vector and the noise without the codes.
        slope: negative slope of the LeakyReLU.
        social: attention pooling over neighbors.
    Fields of this code:
        frame: ``person``: the frame of each person, which makes predictions independent of place and direction;
            ``world``: the frame of the recording, as in the report, valid at that place only.
        residual: the network predicts the difference to the last observed velocity.
        mirror, reverse, scale_sd: random mirroring, time reversal and scaling by exp(normal) of training scenes.
        average: factor of the moving average of the weights used for prediction; 0 for the last weights.
        decay: cosine decay of the learning rates to 0.
        clip: maximum norm of a gradient; 0 for no limit.
        mixed: train the generator with bfloat16 products (about twice as fast on processors with support);
            everything else, and all forecasts, in float32.
        noise_gain: factor of codes and noise after centering; sqrt(12) gives variance 1, 0 keeps the interval 0..1 as
            in the report.
        code_levels: number of equal steps to which codes are quantized; 0 for continuous codes as in the report.
        slope_penalty: weight of the squared gradient of the discriminator at true and drawn futures (Mescheder et al.
            2018, doi 10.48550/arXiv.1801.04406, R1 + R2, by finite differences as in Lin et al. 2025, doi
            10.48550/arXiv.2501.08316); 0 for none.
        slope_penalty_left: final share of the penalty; it decreases between 30 and 90 % of the updates.
        variety_growth: final factor of the weight of the variety loss; it grows between 30 and 80 % of the updates.

    Raises:
        InputError: a value is not allowed.
    """

    unrolling_steps: int = 0
    use_info_loss: bool = True
    info_weight: float = 0.5
    latent_codes: int = 2
    use_l2_loss: bool = False
    l2_weight: float = 0.5
    generator_rate: float = 1e-3
    discriminator_rate: float = 1e-4
    adversarial: str = "cross-entropy"
    adversarial_weight: float = 1.0
    use_variety_loss: bool = False
    variety_weight: float = 0.5
    variety_draws: int = 20
    momentum: float = 0.9
    batch: int = 64
    observe: int = 8
    predict: int = 12
    hidden: int = 128
    pooled: int = 64
    noise: int = 62
    slope: float = 0.1
    social: bool = True
    frame: str = "person"
    residual: bool = True
    mirror: bool = False
    reverse: bool = False
    scale_sd: float = 0.0
    average: float = 0.0
    decay: bool = False
    clip: float = 0.0
    mixed: bool = False
    noise_gain: float = 0.0
    code_levels: int = 0
    slope_penalty: float = 0.0
    slope_penalty_left: float = 1.0
    variety_growth: float = 1.0

    def __post_init__(self) -> None:
        for name, known in (("adversarial", ADVERSARIAL), ("frame", FRAMES)):
            word = getattr(self, name)
            if word not in known:
                raise InputError(f"unknown {name} {word!r}{did_you_mean(word, known)}; known are {', '.join(known)}")
        least = {"unrolling_steps": 0, "latent_codes": 0, "noise": 0, "variety_draws": 1, "batch": 1, "observe": 2}
        least |= {"predict": 1, "hidden": 1, "pooled": 1, "info_weight": 0, "l2_weight": 0, "variety_weight": 0}
        least |= {"adversarial_weight": 0, "scale_sd": 0, "average": 0, "clip": 0, "momentum": 0, "slope": 0}
        least |= {"noise_gain": 0, "code_levels": 0, "slope_penalty": 0}
        for name, low in least.items():
            if not getattr(self, name) >= low:
                raise InputError(f"social ways: {name} = {getattr(self, name)} must be at least {low}")
        for name in ("generator_rate", "discriminator_rate"):
            if not getattr(self, name) > 0.0:
                raise InputError(f"social ways: {name} = {getattr(self, name)} must be above 0")
        for name in ("momentum", "average"):
            if not getattr(self, name) < 1.0:
                raise InputError(f"social ways: {name} = {getattr(self, name)} must be below 1")
        if not 0.0 < self.slope_penalty_left <= 1.0:
            raise InputError(
                f"social ways: slope_penalty_left = {self.slope_penalty_left} must be above 0 and at most 1"
            )
        if not 0.0 < self.variety_growth <= 1e6:
            raise InputError(f"social ways: variety_growth = {self.variety_growth} must be above 0 and at most 1000000")
        if self.use_info_loss and self.latent_codes == 0:
            raise InputError("social ways: the information loss requires latent_codes >= 1, or use_info_loss=False")

    @property
    def inputs(self) -> int:
        """Length of the noise vector: the codes first, then the rest."""
        return self.latent_codes + self.noise


STEADY: dict[str, Any] = {
    "slope_penalty": 0.002, "slope_penalty_left": 0.1, "noise_gain": 12.0**0.5, "momentum": 0.0, "decay": True,
    "generator_rate": 2e-3, "discriminator_rate": 2e-3, "average": 0.99,
}  # fmt: skip
"""Settings that keep all modes: equal learning rates and a gradient penalty."""
PRESETS: dict[str, dict[str, Any]] = {
    "report": {},
    "variety": {
        "use_variety_loss": True, "variety_weight": 10.0, "variety_draws": 10, "adversarial_weight": 0.1,
        "mirror": True, "reverse": True, "scale_sd": 0.3, "average": 0.995, "decay": True, "clip": 1.0,
        "mixed": True,
    },
    "modes": {
        **STEADY, "average": 0.995, "latent_codes": 1, "code_levels": 3, "noise": 5, "use_variety_loss": True,
        "variety_weight": 10.0, "variety_draws": 10, "variety_growth": 30.0,
    },
}  # fmt: skip
"""``report``: the defaults; ``variety``: settings of the best-of-20 tables; ``modes``: one code with three steps
selects the mode."""


def preset(name: str, values: Mapping[str, Any] | None = None) -> SocialWaysConfig:
    """Return named settings with some values changed.

    Raises:
        InputError: the name or a value is not known.

    >>> preset("variety", {"unrolling_steps": 5}).unrolling_steps
    5
    """
    if name not in PRESETS:
        raise InputError(f"unknown preset {name!r}{did_you_mean(name, PRESETS)}; known are {', '.join(PRESETS)}")
    return config_of({**PRESETS[name], **(values or {})})


def config_of(values: Mapping[str, Any]) -> SocialWaysConfig:
    """Return the settings of a checkpoint.

    Raises:
        InputError: a name is unknown or a value not allowed.
    """
    known = [field.name for field in dataclasses.fields(SocialWaysConfig)]
    wrong = next((name for name in values if name not in known), None)
    if wrong is not None:
        raise InputError(f"social ways has no setting {wrong!r}{did_you_mean(wrong, known)}; it has {', '.join(known)}")
    return SocialWaysConfig(**values)
