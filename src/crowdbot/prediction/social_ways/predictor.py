"""SocialWays: the predictor, and the function ``predict(obsv_p, noise, n_next)`` of the report."""

from __future__ import annotations

import functools
import math
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import InputError, Paper
from crowdbot.data import Forecast, Windows
from crowdbot.prediction.constant import ConstantVelocity, SampledConstantVelocity
from crowdbot.prediction.joint_futures import separate_people, stop_at_walls
from crowdbot.prediction.learned_predictor import LearnedPredictor, complete_tracks
from crowdbot.prediction.predictor import Predictor, window_streams
from crowdbot.prediction.training.checkpoint import load_checkpoint
from crowdbot.prediction.training.torch_backend import to_tensors, torch_device, torch_module, torch_threads
from crowdbot.typing import Floats

from .config import config_of

if TYPE_CHECKING:
    from .config import SocialWaysConfig
    from .inputs import Normalization
    from .network import Generator


KIND = "social-ways"
TRIES = 3
"""Number of tries per draw when there are walls."""
CONTACT = 0.25
"""Default minimum distance between people of a draw [m]; attention alone does not avoid collisions."""
AT_ONCE = 4096
"""Number of tracks (people times draws) per network evaluation."""


@dataclass(frozen=True)
class SocialWaysNetwork:
    """A trained network of Social Ways.

    Fields:
        config: settings.
        generator: generator with its weights.
        scales: normalization.
        facts: other values of the checkpoint: units, names of the training recordings.
        device: PyTorch device.
    """

    config: SocialWaysConfig
    generator: Generator
    scales: Normalization
    facts: dict[str, Any]
    device: Any

    @classmethod
    def load(cls, checkpoint: str, device: str = "cpu") -> SocialWaysNetwork:
        """Read a checkpoint.

        Raises:
            InputError: the file is damaged, or is not a checkpoint of this network; or the device does not exist.
            MissingExtra: torch is not installed.
        """
        place = torch_device(device)
        content = load_checkpoint(checkpoint, KIND)
        from .inputs import Normalization
        from .network import Generator

        try:
            config, scales = config_of(content["config"]), Normalization.read(content["facts"])
            generator = Generator(config, scales.dt, (scales.position, scales.velocity, scales.distance))
            generator.load_state_dict(to_tensors(content["weights"]))
        except (KeyError, TypeError, ValueError, RuntimeError) as why:
            text = str(why).splitlines()[0][:120] if str(why) else type(why).__name__
            raise InputError(f"the weights of {checkpoint} do not fit this crowdbot ({text}); train again") from None
        return cls(config, generator.to(place).eval(), scales, content["facts"], place)

    def predict(self, obsv_p: ArrayLike, noise: ArrayLike, n_next: int) -> Floats:
        """Return the forecast of N people ``[N, n_next, 2]`` [m], as the function of this name in the report.

        Args:
            obsv_p: ``[N, Tobs, 2]`` [m] observed positions.
            noise: ``[M]`` for all people or ``[N, M]``, in 0..1; the latent codes come first.
            n_next: number of predicted rows.

        Raises:
            InputError: a shape or a value is not allowed.
        """
        seen, drawn = np.asarray(obsv_p, dtype=np.float64), np.asarray(noise, dtype=np.float64)
        if seen.ndim != 3 or seen.shape[2] != 2 or seen.shape[1] < 1 or not np.all(np.isfinite(seen)):
            raise InputError(f"observed tracks have shape {list(seen.shape)}; they must be finite [N, Tobs, 2]")
        if drawn.shape not in ((self.config.inputs,), (len(seen), self.config.inputs)):
            raise InputError(
                f"noise has shape {list(drawn.shape)}; it must be [{self.config.inputs}] or"
                f" [{len(seen)}, {self.config.inputs}]"
            )
        if not np.all((drawn >= 0.0) & (drawn <= 1.0)):
            raise InputError("noise must be numbers from 0 to 1")
        if n_next < 1:
            raise InputError(f"n_next = {n_next} must be at least 1")
        if len(seen) == 0:
            return np.zeros((0, n_next, 2))
        place = seen.swapaxes(0, 1)[None]  # [1, T, N, 2]
        there = np.ones((1, place.shape[1], len(seen)), dtype=bool)
        nobody = np.zeros((1, len(seen)), dtype=bool)
        past = Windows(
            place, there, nobody, nobody, np.arange(len(seen))[None], np.arange(place.shape[1])[None], self.scales.dt,
            "none", "obsv_p",
        )  # fmt: skip
        each = np.broadcast_to(drawn, (1, len(seen), self.config.inputs))
        return np.ascontiguousarray(self.scene(past, each, n_next)[0].swapaxes(0, 1))

    def scene(self, past: Windows, noise: Floats, steps: int) -> Floats:
        """Return futures ``[K, steps, A, 2]`` [m] of one window; all agents must be present at its last row.

        Args:
            past: one window.
            noise: ``[K, A, M]`` in 0..1.
            steps: number of predicted rows; robots with a plan follow it.
        """
        torch = torch_module()
        from .inputs import scene_input

        here = past.present[:, -1]
        sight, seen = scene_input(
            complete_tracks(past, self.config.observe), here, self.config, self.scales, self.device
        )
        plan = None
        if past.plan is not None:
            ahead = np.stack([past.plan_at(step) for step in range(1, steps + 1)], axis=1)  # [1, T, A, 2]
            plan = torch.as_tensor(seen.own(ahead), dtype=torch.float32, device=self.device)
        found = []
        size = max(1, AT_ONCE // max(1, noise.shape[1]))
        with torch.no_grad(), torch_threads():
            for first in range(0, len(noise), size):
                part = torch.tensor(noise[first : first + size, None], dtype=torch.float32, device=self.device)
                place, _ = self.generator(sight, part, steps, plan)
                found.append(seen.world(place.double().cpu().numpy())[:, 0])
        return np.concatenate(found)


@dataclass(frozen=True)
class SocialWays(LearnedPredictor):
    """Random joint futures of the people in a window, drawn by the generator of Social Ways.

    With the setting ``frame = person``, forecasts are equivariant to translations and rotations, up to float32 (about
    1e-5 m), but not to reflections. With ``world``, they are valid for the place of the training data only. Missing
    rows are filled in; people observed once have a constant position. Windows are predicted one by one: forecasts do
    not depend on the batch, bit for bit.

    Robots with a plan follow it, and the network reads it. With walls, each draw is the best of three (fewest wall
    crossings), and paths that still cross a wall stop there. If the shipped weights cannot be used (other time steps
    than 0.4 s, pixels), a baseline is used, with a warning; own weights raise an error.

    Fields:
        contact: minimum distance between people of a draw [m]; 0, as in the report, allows collisions.

    Paper: Amirian, Hayet, Pettré (2019), doi 10.48550/arXiv.1904.09507.
    """

    contact: float = CONTACT

    paper: ClassVar[Paper] = Paper(
        "Amirian, Hayet, Pettré",
        2019,
        "Social Ways: learning multi-modal distributions of pedestrian trajectories with GANs",
        "CVPR Workshops",
        "10.48550/arXiv.1904.09507",
    )
    batched = draws = learned = True

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0.0 <= self.contact < math.inf:
            raise InputError(f"{KIND}: contact = {self.contact} m must be finite and at least 0")

    @property
    def kind(self) -> str:
        return KIND

    @property
    def name(self) -> str:
        return super().name + (f"(contact={self.contact:g})" if self.contact != CONTACT else "")

    def network(self, source: str = "") -> SocialWaysNetwork:
        """Return the network for a recording of this name; it is cached."""
        return _network(str(self.file(source)), self.digest, self.device)

    def predict(self, past: Windows, steps: int, samples: int = 1, rng: np.random.Generator | None = None) -> Forecast:
        """Return the forecast, see :meth:`Predictor.predict`.

        Raises:
            InputError: the windows have another time step or other units than the training data.
        """
        self.check(past, steps, samples)
        why = self.incompatibility(past)
        if why:
            one: Predictor = ConstantVelocity() if samples == 1 else SampledConstantVelocity()
            warnings.warn(f"{self.kind}: {why}; {one.name} is used instead", stacklevel=2)
            return one.predict(past, steps, samples, rng)
        network = self.network(past.source)
        self.fits(past, network.facts, self.name)
        W, _, A, _ = past.position.shape
        place = np.zeros((W, samples, steps, A, 2))
        for window, own in enumerate(window_streams(rng, W)):
            people = np.flatnonzero(past.present[window, -1])
            if len(people):
                only = _only(past[window : window + 1], people)
                place[window][:, :, people] = _draw(network, only, steps, samples, own)
        return self.forecast(past, separate_people(past, place, self.contact))


def _draw(network: SocialWaysNetwork, past: Windows, steps: int, samples: int, rng: np.random.Generator) -> Floats:
    """Return draws ``[K, T, A, 2]`` [m] of one window that do not cross walls."""
    people = np.arange(past.present.shape[2])
    tries = TRIES if past.walls else 1
    noise = rng.random((samples * tries, len(people), network.config.inputs))
    place = network.scene(past, noise, steps)
    if not past.walls:
        return place
    now = past.position[0, -1]
    path, hit = stop_at_walls(past, np.moveaxis(place - now, 2, 0), np.zeros_like(people), people)
    chosen = np.argmin(hit.sum(axis=0).reshape(samples, tries), axis=1) + tries * np.arange(samples)
    return np.asarray(now + np.moveaxis(path[:, chosen], 0, 2))


@functools.lru_cache(maxsize=4)
def _network(checkpoint: str, digest: str, device: str) -> SocialWaysNetwork:
    return SocialWaysNetwork.load(checkpoint, device)


def _only(past: Windows, people: NDArray[np.int64]) -> Windows:
    """Return a window with a subset of its agents."""
    import dataclasses

    plan = None if past.plan is None else past.plan[:, :, people]
    arrays = {name: getattr(past, name)[:, people] for name in ("scored", "robot", "id")}
    return dataclasses.replace(
        past, position=past.position[:, :, people], present=past.present[:, :, people], plan=plan, **arrays
    )
