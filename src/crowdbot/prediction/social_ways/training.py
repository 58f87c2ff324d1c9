"""How Social Ways learns: its losses, the look ahead of the discriminator, and one update after the other."""

from __future__ import annotations

import copy
import dataclasses
import math
from collections.abc import Mapping
from typing import Any, ClassVar, NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from crowdbot.core import InputError, from_attributes, stream
from crowdbot.prediction.training.loop import Trainable
from crowdbot.prediction.training.samples import Samples, Scenes
from crowdbot.prediction.training.torch_backend import to_tensors, torch_device

from .config import SocialWaysConfig, preset
from .inputs import Normalization, scene_input, states_of
from .network import Discriminator, Generator, SceneInput

__all__ = ["SocialWaysTraining", "adversarial_loss", "learner", "variety_loss"]

DRAWS, CHECKED = 20, 60
"""Errors are watched as the best of so many draws on at most so many scenes."""
ASIDE = 0.01
"""The slope of the discriminator is felt so far from a track, in units of the scales."""


def learner(
    settings: str | None, values: Mapping[str, str], samples: Samples, watched: Samples, seed: int, device: str
) -> SocialWaysTraining:
    """Return Social Ways ready to train, as the command line asks for it.

    Args:
        settings: name of a preset; None is ``report``.
        values: settings that differ, as text.
        samples, watched, seed, device: as of :class:`SocialWaysTraining`.
    """
    rows = {"observe": samples.observe, "predict": samples.predict}
    read = from_attributes(SocialWaysConfig, dict(values))
    changed = {name.replace("-", "_"): getattr(read, name.replace("-", "_")) for name in values}
    return SocialWaysTraining(preset(settings or "report", rows | changed), samples, watched, seed, device)


class _Lesson(NamedTuple):
    """A batch as tensors: sight, the true future states ``[N, T, 4]`` of the N who count, and who they are."""

    sight: SceneInput
    scored: Tensor  # [S, A]
    observed: Tensor  # [N, T, 4]
    future: Tensor  # [N, T, 4]


class SocialWaysTraining(Trainable):
    """Social Ways with its data; see :class:`~crowdbot.prediction.Trainable`.

    Args:
        config: what is trained.
        samples: what is learned from; the scales come from it alone.
        watched: what the errors are watched on.
        seed: of the first weights.
        device: ``cpu`` or ``cuda``.

    Raises:
        InputError: rows of config and samples differ, or the device is not there.
    """

    kind: ClassVar[str] = "social-ways"

    def __init__(
        self, config: SocialWaysConfig, samples: Samples, watched: Samples, seed: int = 0, device: str = "cpu"
    ) -> None:
        for part in (samples, watched):
            if (part.observe, part.predict) != (config.observe, config.predict):
                raise InputError(
                    f"social ways learns {config.observe} + {config.predict} rows, {part.names[0]} is cut into"
                    f" {part.observe} + {part.predict}"
                )
        self.config, self.samples = config, samples
        self.watched = watched.subsample(CHECKED)
        self.data = f"{samples.digest}-{self.watched.digest}"
        self.scales = Normalization.of(samples, config)
        self.facts = {**dataclasses.asdict(self.scales), "units": samples.units, "learned": list(samples.names)}
        self.device = torch_device(device)
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(int(stream(seed, "weights").integers(2**62)))
            sizes = (self.scales.position, self.scales.velocity, self.scales.distance)
            self.generator = Generator(config, samples.dt, sizes)
            self.discriminator = Discriminator(config)
        self.generator.to(self.device)
        self.discriminator.to(self.device)
        betas = (config.momentum, 0.999)
        self.of_generator = torch.optim.Adam(self.generator.parameters(), config.generator_rate, betas, fused=True)
        self.of_discriminator = torch.optim.Adam(
            self.discriminator.parameters(), config.discriminator_rate, betas, fused=True
        )
        self.mean = {name: value.detach().clone() for name, value in self.generator.state_dict().items()}

    def batches(self, rng: np.random.Generator) -> list[Any]:
        """Return scenes, about ``config.batch`` people at a time."""
        return list(self.samples.batches(rng, self.config.batch))

    def update(self, batch: Any, rng: np.random.Generator, number: int, total: int) -> Mapping[str, float]:
        """Do a step of the discriminator, those it looks ahead, and a step of the generator."""
        self._rates(number, total)
        lesson = self._lesson(augment(self.samples.batch(batch), self.samples.observe, self.config, rng))
        c = self.config
        noise = self._noise(lesson, rng, c.variety_draws if c.use_variety_loss else 1)
        codes = noise[0][lesson.scored][:, : c.latent_codes]
        _, made = self._made(lesson, noise)  # one drawing serves both networks
        told = made[0].detach()
        penalty = self._penalty(number / total)
        losses = self._discriminator_step(lesson, told, codes, rng, penalty)
        kept = None
        if c.unrolling_steps:
            kept = copy.deepcopy((self.discriminator.state_dict(), self.of_discriminator.state_dict()))
            for _ in range(c.unrolling_steps):
                self._discriminator_step(lesson, told, codes, rng, penalty)
        losses |= self._generator_step(lesson, made, codes, self._variety_weight(number / total))
        if kept is not None:  # every layer and everything that Adam knows
            self.discriminator.load_state_dict(kept[0])
            self.of_discriminator.load_state_dict(kept[1])
        self._averaged()
        return losses

    def check(self) -> Mapping[str, float]:
        """Return the best of 20 ADE and FDE per person [m], always with the same noise."""
        kept = {name: value.detach().clone() for name, value in self.generator.state_dict().items()}
        self.generator.load_state_dict(self.mean)
        rng = stream(0, "check")
        sums = np.zeros(3)
        observe = self.samples.observe
        for part in self.watched.batches(stream(0, "parts"), self.config.batch):
            scenes = self.watched.batch(part)
            lesson = self._lesson(scenes)
            with torch.no_grad():
                place, _ = self._rolled(lesson.sight, self._noise(lesson, rng, DRAWS))
            true = self._frames(scenes).own(scenes.position[:, observe:])
            away = np.linalg.norm(place.cpu().numpy() - true, axis=-1)  # [K, S, T, A]
            ade, fde = away.mean(axis=2).min(axis=0), away[:, :, -1].min(axis=0)
            sums += scenes.scored.sum(), ade[scenes.scored].sum(), fde[scenes.scored].sum()
        self.generator.load_state_dict(kept)
        count = max(1.0, sums[0])
        return {"ade": float(sums[1] / count), "fde": float(sums[2] / count)}

    def sample_futures(self, past: NDArray[np.float64], draws: int, rng: np.random.Generator) -> NDArray[np.float64]:
        """Return futures ``[K, S, T, A, 2]`` [m] that the averaged generator draws for observed tracks.

        Args:
            past: ``[S, T, A, 2]`` [m] complete tracks.
            draws: K, the number of futures.
            rng: source of the noise.
        """
        here = np.ones((len(past), past.shape[2]), dtype=bool)
        sight, seen = scene_input(past, here, self.config, self.scales, self.device)
        noise = torch.as_tensor(rng.random((draws, *here.shape, self.config.inputs), dtype=np.float32))
        kept = {name: value.detach().clone() for name, value in self.generator.state_dict().items()}
        self.generator.load_state_dict(self.mean)
        with torch.no_grad():
            place, _ = self._rolled(sight, noise.to(self.device))
        self.generator.load_state_dict(kept)
        return seen.world(place.double().cpu().numpy())

    def weights(self) -> Mapping[str, Any]:
        """Return the (averaged) generator."""
        return self.mean

    def state(self) -> Mapping[str, Any]:
        """Return both networks, both optimisers and the average."""
        return {
            "generator": dict(self.generator.state_dict()),
            "discriminator": dict(self.discriminator.state_dict()),
            "of_generator": self.of_generator.state_dict(),
            "of_discriminator": self.of_discriminator.state_dict(),
            "mean": self.mean,
        }

    def restore(self, state: Mapping[str, Any]) -> None:
        """Go back to a state."""
        kept = to_tensors(dict(state), self.device)
        self.mean = kept.pop("mean")
        for name, value in kept.items():
            getattr(self, name).load_state_dict(value)

    def _lesson(self, scenes: Scenes) -> _Lesson:
        rows = self.samples.observe
        past, future = scenes.position[:, :rows], scenes.position[:, rows:]
        sight, seen = scene_input(past, scenes.here, self.config, self.scales, self.device)
        true = states_of(seen.own(future), self.scales, seen.local[:, -1])  # [S, T, A, 4]
        scored = torch.as_tensor(scenes.scored, device=self.device)
        ahead = torch.as_tensor(true.swapaxes(1, 2)[scenes.scored], dtype=torch.float32, device=self.device)
        return _Lesson(sight, scored, sight.state.transpose(1, 2)[scored], ahead)

    def _frames(self, scenes: Scenes) -> Any:
        return scene_input(scenes.position[:, : self.samples.observe], scenes.here, self.config, self.scales)[1]

    def _noise(self, lesson: _Lesson, rng: np.random.Generator, draws: int) -> Tensor:
        """Return ``[K, S, A, M]`` in 0..1."""
        drawn = rng.random((draws, *lesson.scored.shape, self.config.inputs), dtype=np.float32)
        return torch.as_tensor(drawn, device=self.device)

    def _rolled(self, sight: SceneInput, noise: Tensor) -> tuple[Tensor, Tensor]:
        rolled: tuple[Tensor, Tensor] = self.generator(sight, noise, self.config.predict)
        return rolled

    def _made(self, lesson: _Lesson, noise: Tensor) -> tuple[Tensor, Tensor]:
        """Return drawn positions ``[K, N, T, 2]`` [m] and states ``[K, N, T, 4]`` of those who count."""
        with torch.autocast(self.device.type, torch.bfloat16, enabled=self.config.mixed):
            place, state = self._rolled(lesson.sight, noise)
        return place.transpose(2, 3)[:, lesson.scored], state.transpose(2, 3)[:, lesson.scored]

    def _discriminator_step(
        self, lesson: _Lesson, made: Tensor, codes: Tensor, rng: np.random.Generator, penalty: float
    ) -> dict[str, float]:
        both = torch.cat([lesson.future, made])  # [2 N, T, 4]: true ones, then drawn ones
        asked = both
        if penalty > 0.0:
            aside = torch.as_tensor(rng.standard_normal(both.shape, dtype=np.float32), device=self.device)
            asked = torch.cat([both, both + ASIDE * aside])
        said, read = self.discriminator(lesson.observed.repeat(len(asked) // len(made), 1, 1), asked)
        real, fake, *others = said.split(len(made))
        told = adversarial_loss(real, True, self.config) + adversarial_loss(fake, False, self.config)
        loss = told + self._info(read[len(made) : len(both)], codes)
        for here, there in zip((real, fake), others, strict=False):
            loss = loss + 0.5 * penalty * ((there - here) / ASIDE).square().mean()
        self._stepped(loss, self.of_discriminator, self.discriminator)
        return {"discriminator": float(told.detach())}

    def _generator_step(self, lesson: _Lesson, made: Tensor, codes: Tensor, variety_weight: float) -> dict[str, float]:
        c = self.config
        self.discriminator.requires_grad_(False)  # it only passes on what the generator should change
        fake, read = self.discriminator(lesson.observed, made[0])
        parts = {"adversarial": c.adversarial_weight * adversarial_loss(fake, True, c)}
        if c.use_info_loss:
            parts["info"] = self._info(read, codes)
        true = lesson.future[..., :2]
        if c.use_l2_loss:
            parts["l2"] = c.l2_weight * (made[0, ..., :2] - true).square().sum(-1).mean()
        if c.use_variety_loss:
            parts["variety"] = variety_weight * variety_loss(made[..., :2], true)
        self._stepped(torch.stack(list(parts.values())).sum(), self.of_generator, self.generator)
        self.discriminator.requires_grad_(True)
        return {name: float(value.detach()) for name, value in parts.items()}

    def _penalty(self, done: float) -> float:
        """Return the weight of the slope penalty when this share of the updates is done."""
        fallen = min(1.0, max(0.0, (done - 0.3) / 0.6))
        return float(self.config.slope_penalty * self.config.slope_penalty_left**fallen)

    def _variety_weight(self, done: float) -> float:
        """Return the weight of the variety loss when this share of the updates is done."""
        grown = min(1.0, max(0.0, (done - 0.3) / 0.5))
        return float(self.config.variety_weight * self.config.variety_growth**grown)

    def _info(self, read: Tensor, codes: Tensor) -> Tensor:
        """Return the loss of information: a normal density around what is read, so a squared distance."""
        if not self.config.use_info_loss:
            return read.new_zeros(())
        away: Tensor = nn.functional.mse_loss(read[:, : codes.shape[1]], codes) * self.config.info_weight
        return away

    def _stepped(self, loss: Tensor, optimiser: torch.optim.Optimizer, network: nn.Module) -> None:
        optimiser.zero_grad(set_to_none=True)
        loss.backward()  # type: ignore[no-untyped-call]
        if self.config.clip > 0.0:
            nn.utils.clip_grad_norm_(network.parameters(), self.config.clip)
        optimiser.step()

    def _rates(self, number: int, total: int) -> None:
        share = 0.5 * (1.0 + math.cos(math.pi * number / total)) if self.config.decay else 1.0
        self.of_generator.param_groups[0]["lr"] = share * self.config.generator_rate
        self.of_discriminator.param_groups[0]["lr"] = share * self.config.discriminator_rate

    def _averaged(self) -> None:
        keep = self.config.average
        for name, value in self.generator.state_dict().items():
            self.mean[name].mul_(keep).add_(value.detach(), alpha=1.0 - keep)


def adversarial_loss(said: Tensor, real: bool, config: SocialWaysConfig) -> Tensor:
    """Return how far ``[N]`` answers of the discriminator are from ``real``: cross-entropy, or least squares."""
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
    """Return a batch whose scenes are mirrored, run backwards and stretched at random, as the settings say."""
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
