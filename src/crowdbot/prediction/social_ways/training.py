"""Training of Social Ways: losses, unrolled discriminator, updates."""

from __future__ import annotations

import copy
import dataclasses
import hashlib
import math
from collections.abc import Mapping
from typing import Any, ClassVar, NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from crowdbot.core import InputError, from_attributes, stream
from crowdbot.prediction.pretrained_weights import FOLDS, pretrained_file
from crowdbot.prediction.training.loop import Trainable
from crowdbot.prediction.training.samples import Samples, Scenes
from crowdbot.prediction.training.torch_backend import to_tensors, torch_device

from .config import SocialWaysConfig, preset
from .inputs import Normalization, scene_input, states_of
from .network import Discriminator, Generator, SceneInput
from .predictor import SocialWaysNetwork

DRAWS, CHECKED = 20, 60
"""Number of draws and maximum number of scenes for validation errors."""
ASIDE = 0.01
"""Step of the finite difference for the slope of the discriminator, in units of the scales."""


def learner(
    settings: str | None,
    values: Mapping[str, str],
    samples: Samples,
    watched: Samples,
    seed: int,
    device: str,
    start: str = "",
) -> SocialWaysTraining:
    """Return a Social Ways network ready to train, from the options of the command line.

    Args:
        settings: name of a preset; None means ``report``.
        values: settings that differ from the preset, as text.
        samples, watched, seed, device: see :class:`SocialWaysTraining`.
        start: checkpoint, or place of shipped weights, from which the generator starts; empty: random weights. Its
            settings are the preset then, and its normalization is kept; the discriminator starts at random.
    """
    rows = {"observe": samples.observe, "predict": samples.predict}
    read = from_attributes(SocialWaysConfig, dict(values))
    changed = {name.replace("-", "_"): getattr(read, name.replace("-", "_")) for name in values}
    if not start:
        return SocialWaysTraining(preset(settings or "report", rows | changed), samples, watched, seed, device)
    if settings is not None:
        raise InputError(f"social-ways: the settings are those of the start weights; omit --settings {settings}")
    found = SocialWaysNetwork.load(str(pretrained_file("social-ways", start)) if start in FOLDS else start, device)
    how = dataclasses.replace(found.config, **rows | changed)
    return SocialWaysTraining(how, samples, watched, seed, device, found)


class _TensorBatch(NamedTuple):
    """A batch as tensors: input of the generator, mask of the N scored people, their observed and future states."""

    sight: SceneInput
    scored: Tensor  # [S, A]
    observed: Tensor  # [N, T, 4]
    future: Tensor  # [N, T, 4]


class SocialWaysTraining(Trainable):
    """Social Ways with its data; see :class:`~crowdbot.prediction.Trainable`.

    Args:
        config: settings.
        samples: training data; also the source of the normalization.
        watched: validation data.
        seed: seed of the initial weights.
        device: ``cpu`` or ``cuda``.
        start: network whose generator and normalization the training starts with; None: random weights.

    Raises:
        InputError: rows of config and samples differ, or the device does not exist.
    """

    kind: ClassVar[str] = "social-ways"

    def __init__(
        self, config: SocialWaysConfig, samples: Samples, watched: Samples, seed: int = 0, device: str = "cpu",
        start: SocialWaysNetwork | None = None,
    ) -> None:  # fmt: skip
        for part in (samples, watched):
            if (part.observe, part.predict) != (config.observe, config.predict):
                raise InputError(
                    f"social ways requires {config.observe} + {config.predict} rows, {part.names[0]} has"
                    f" {part.observe} + {part.predict}"
                )
        self.config, self.samples = config, samples
        self.watched = watched.subsample(CHECKED)
        self.data = f"{samples.digest}-{self.watched.digest}"
        self.scales = Normalization.of(samples, config) if start is None else start.scales
        self.facts = {**dataclasses.asdict(self.scales), "units": samples.units, "learned": list(samples.names)}
        self.device = torch_device(device)
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(int(stream(seed, "weights").integers(2**62)))
            sizes = (self.scales.position, self.scales.velocity, self.scales.distance)
            self.generator = Generator(config, samples.dt, sizes)
            self.discriminator = Discriminator(config)
        if start is not None:
            self._start_from(start)
        self.generator.to(self.device)
        self.discriminator.to(self.device)
        betas = (config.momentum, 0.999)
        self.of_generator = torch.optim.Adam(self.generator.parameters(), config.generator_rate, betas, fused=True)
        self.of_discriminator = torch.optim.Adam(
            self.discriminator.parameters(), config.discriminator_rate, betas, fused=True
        )
        self.mean = {name: value.detach().clone() for name, value in self.generator.state_dict().items()}

    def _start_from(self, start: SocialWaysNetwork) -> None:
        weights = start.generator.state_dict()
        try:
            self.generator.load_state_dict(weights)
        except RuntimeError:
            raise InputError("social-ways: the sizes of the settings are not those of the start weights") from None
        content = b"".join(value.cpu().numpy().tobytes() for value in weights.values())
        self.data += f"-{hashlib.blake2b(content, digest_size=6).hexdigest()}"

    def batches(self, rng: np.random.Generator) -> list[Any]:
        return list(self.samples.batches(rng, self.config.batch))

    def update(self, batch: Any, rng: np.random.Generator, number: int, total: int) -> Mapping[str, float]:
        self._rates(number, total)
        tensors = self._to_tensors(augment(self.samples.batch(batch), self.samples.observe, self.config, rng))
        c = self.config
        noise = self._noise(tensors, rng, c.variety_draws if c.use_variety_loss else 1)
        codes = noise[0][tensors.scored][:, : c.latent_codes]
        _, made = self._draw(tensors, noise)  # both networks use the same draw
        sample = made[0].detach()
        penalty = self._penalty(number / total)
        losses = self._discriminator_step(tensors, sample, codes, rng, penalty)
        kept = None
        if c.unrolling_steps:
            kept = copy.deepcopy((self.discriminator.state_dict(), self.of_discriminator.state_dict()))
            for _ in range(c.unrolling_steps):
                self._discriminator_step(tensors, sample, codes, rng, penalty)
        losses |= self._generator_step(tensors, made, codes, self._variety_weight(number / total))
        if kept is not None:  # all layers and the state of Adam
            self.discriminator.load_state_dict(kept[0])
            self.of_discriminator.load_state_dict(kept[1])
        self._update_average()
        return losses

    def check(self) -> Mapping[str, float]:
        # best-of-20 ADE and FDE per person [m], always with the same noise
        kept = {name: value.detach().clone() for name, value in self.generator.state_dict().items()}
        self.generator.load_state_dict(self.mean)
        rng = stream(0, "check")
        sums = np.zeros(3)
        observe = self.samples.observe
        for part in self.watched.batches(stream(0, "parts"), self.config.batch):
            scenes = self.watched.batch(part)
            tensors = self._to_tensors(scenes)
            with torch.no_grad():
                place, _ = self._generate(tensors.sight, self._noise(tensors, rng, DRAWS))
            true = self._frames(scenes).own(scenes.position[:, observe:])
            away = np.linalg.norm(place.cpu().numpy() - true, axis=-1)  # [K, S, T, A]
            ade, fde = away.mean(axis=2).min(axis=0), away[:, :, -1].min(axis=0)
            sums += scenes.scored.sum(), ade[scenes.scored].sum(), fde[scenes.scored].sum()
        self.generator.load_state_dict(kept)
        count = max(1.0, sums[0])
        return {"ade": float(sums[1] / count), "fde": float(sums[2] / count)}

    def sample_futures(self, past: NDArray[np.float64], draws: int, rng: np.random.Generator) -> NDArray[np.float64]:
        """Return futures ``[K, S, T, A, 2]`` [m] of observed tracks, drawn with the averaged generator.

        Args:
            past: ``[S, T, A, 2]`` [m] complete tracks.
            draws: number K of futures.
            rng: random generator of the noise.
        """
        here = np.ones((len(past), past.shape[2]), dtype=bool)
        sight, seen = scene_input(past, here, self.config, self.scales, self.device)
        noise = torch.as_tensor(rng.random((draws, *here.shape, self.config.inputs), dtype=np.float32))
        kept = {name: value.detach().clone() for name, value in self.generator.state_dict().items()}
        self.generator.load_state_dict(self.mean)
        with torch.no_grad():
            place, _ = self._generate(sight, noise.to(self.device))
        self.generator.load_state_dict(kept)
        return seen.world(place.double().cpu().numpy())

    def weights(self) -> Mapping[str, Any]:
        return self.mean

    def state(self) -> Mapping[str, Any]:
        return {
            "generator": dict(self.generator.state_dict()),
            "discriminator": dict(self.discriminator.state_dict()),
            "of_generator": self.of_generator.state_dict(),
            "of_discriminator": self.of_discriminator.state_dict(),
            "mean": self.mean,
        }

    def restore(self, state: Mapping[str, Any]) -> None:
        kept = to_tensors(dict(state), self.device)
        self.mean = kept.pop("mean")
        for name, value in kept.items():
            getattr(self, name).load_state_dict(value)

    def _to_tensors(self, scenes: Scenes) -> _TensorBatch:
        rows = self.samples.observe
        past, future = scenes.position[:, :rows], scenes.position[:, rows:]
        sight, seen = scene_input(past, scenes.here, self.config, self.scales, self.device)
        true = states_of(seen.own(future), self.scales, seen.local[:, -1])  # [S, T, A, 4]
        scored = torch.as_tensor(scenes.scored, device=self.device)
        ahead = torch.as_tensor(true.swapaxes(1, 2)[scenes.scored], dtype=torch.float32, device=self.device)
        return _TensorBatch(sight, scored, sight.state.transpose(1, 2)[scored], ahead)

    def _frames(self, scenes: Scenes) -> Any:
        return scene_input(scenes.position[:, : self.samples.observe], scenes.here, self.config, self.scales)[1]

    def _noise(self, tensors: _TensorBatch, rng: np.random.Generator, draws: int) -> Tensor:
        """Return ``[K, S, A, M]`` in 0..1."""
        drawn = rng.random((draws, *tensors.scored.shape, self.config.inputs), dtype=np.float32)
        return torch.as_tensor(drawn, device=self.device)

    def _generate(self, sight: SceneInput, noise: Tensor) -> tuple[Tensor, Tensor]:
        rolled: tuple[Tensor, Tensor] = self.generator(sight, noise, self.config.predict)
        return rolled

    def _draw(self, tensors: _TensorBatch, noise: Tensor) -> tuple[Tensor, Tensor]:
        """Return drawn positions ``[K, N, T, 2]`` [m] and states ``[K, N, T, 4]`` of scored people."""
        with torch.autocast(self.device.type, torch.bfloat16, enabled=self.config.mixed):
            place, state = self._generate(tensors.sight, noise)
        return place.transpose(2, 3)[:, tensors.scored], state.transpose(2, 3)[:, tensors.scored]

    def _discriminator_step(
        self, tensors: _TensorBatch, made: Tensor, codes: Tensor, rng: np.random.Generator, penalty: float
    ) -> dict[str, float]:
        both = torch.cat([tensors.future, made])  # [2 N, T, 4]: true ones, then drawn ones
        asked = both
        if penalty > 0.0:
            aside = torch.as_tensor(rng.standard_normal(both.shape, dtype=np.float32), device=self.device)
            asked = torch.cat([both, both + ASIDE * aside])
        logits, read = self.discriminator(tensors.observed.repeat(len(asked) // len(made), 1, 1), asked)
        real, fake, *others = logits.split(len(made))
        adversarial = adversarial_loss(real, True, self.config) + adversarial_loss(fake, False, self.config)
        loss = adversarial + self._info(read[len(made) : len(both)], codes)
        for here, there in zip((real, fake), others, strict=False):
            loss = loss + 0.5 * penalty * ((there - here) / ASIDE).square().mean()
        self._optimise(loss, self.of_discriminator, self.discriminator)
        return {"discriminator": float(adversarial.detach())}

    def _generator_step(
        self, tensors: _TensorBatch, made: Tensor, codes: Tensor, variety_weight: float
    ) -> dict[str, float]:
        c = self.config
        self.discriminator.requires_grad_(False)  # gradients of the generator only
        fake, read = self.discriminator(tensors.observed, made[0])
        parts = {"adversarial": c.adversarial_weight * adversarial_loss(fake, True, c)}
        if c.use_info_loss:
            parts["info"] = self._info(read, codes)
        true = tensors.future[..., :2]
        if c.use_l2_loss:
            parts["l2"] = c.l2_weight * (made[0, ..., :2] - true).square().sum(-1).mean()
        if c.use_variety_loss:
            parts["variety"] = variety_weight * variety_loss(made[..., :2], true)
        self._optimise(torch.stack(list(parts.values())).sum(), self.of_generator, self.generator)
        self.discriminator.requires_grad_(True)
        return {name: float(value.detach()) for name, value in parts.items()}

    def _penalty(self, done: float) -> float:
        """Return the weight of the slope penalty at a completed share of the updates."""
        fallen = min(1.0, max(0.0, (done - 0.3) / 0.6))
        return float(self.config.slope_penalty * self.config.slope_penalty_left**fallen)

    def _variety_weight(self, done: float) -> float:
        """Return the weight of the variety loss at a completed share of the updates."""
        grown = min(1.0, max(0.0, (done - 0.3) / 0.5))
        return float(self.config.variety_weight * self.config.variety_growth**grown)

    def _info(self, read: Tensor, codes: Tensor) -> Tensor:
        """Return the information loss: the squared error of the recovered codes, for a normal density."""
        if not self.config.use_info_loss:
            return read.new_zeros(())
        away: Tensor = nn.functional.mse_loss(read[:, : codes.shape[1]], codes) * self.config.info_weight
        return away

    def _optimise(self, loss: Tensor, optimiser: torch.optim.Optimizer, network: nn.Module) -> None:
        optimiser.zero_grad(set_to_none=True)
        loss.backward()  # type: ignore[no-untyped-call]
        if self.config.clip > 0.0:
            nn.utils.clip_grad_norm_(network.parameters(), self.config.clip)
        optimiser.step()

    def _rates(self, number: int, total: int) -> None:
        share = 0.5 * (1.0 + math.cos(math.pi * number / total)) if self.config.decay else 1.0
        self.of_generator.param_groups[0]["lr"] = share * self.config.generator_rate
        self.of_discriminator.param_groups[0]["lr"] = share * self.config.discriminator_rate

    def _update_average(self) -> None:
        keep = self.config.average
        for name, value in self.generator.state_dict().items():
            self.mean[name].mul_(keep).add_(value.detach(), alpha=1.0 - keep)


def adversarial_loss(said: Tensor, real: bool, config: SocialWaysConfig) -> Tensor:
    """Return the loss of discriminator outputs ``[N]`` for the label ``real``: cross-entropy or least squares."""
    wanted = torch.full_like(said, float(real))
    if config.adversarial == "cross-entropy":
        return nn.functional.binary_cross_entropy_with_logits(said, wanted)
    return nn.functional.mse_loss(said, wanted)


def variety_loss(drawn: Tensor, true: Tensor) -> Tensor:
    """Return the squared distance of each person's nearest draw to the truth, mean over people and rows.

    Args:
        drawn: ``[K, N, T, 2]``, K draws of N people.
        true: ``[N, T, 2]``.
    """
    away = (drawn - true).square().sum(-1).mean(-1)  # [K, N]
    return away.min(dim=0).values.mean()


def augment(scenes: Scenes, observe: int, config: SocialWaysConfig, rng: np.random.Generator) -> Scenes:
    """Return a batch with random reflections, time reversal and scaling, as configured."""
    count = len(scenes.position)
    place, there, scored, here = scenes
    if config.reverse and rng.random() < 0.5 and place.shape[1] >= 2 * observe:
        place, there = place[:, ::-1], there[:, ::-1]
        here = np.asarray(there[:, :observe].all(axis=1))
        scored = scored & here
    factor: NDArray[np.float64] = np.ones((count, 1, 1, 2))
    if config.scale_sd > 0.0:
        factor = factor * np.clip(np.exp(rng.normal(0.0, config.scale_sd, (count, 1, 1, 1))), 0.4, 2.5)
    if config.mirror:
        factor[..., 1] = factor[..., 1] * rng.choice([-1.0, 1.0], (count, 1, 1))
    return Scenes(place * factor, there, scored, here)
