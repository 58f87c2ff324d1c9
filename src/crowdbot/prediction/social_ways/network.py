"""Social Ways, the network: a generator of futures with attention over neighbors, and its discriminator.

Axes: B scenes (draws of one scene are B apart), A people, T rows, H = 128 hidden, P = 64 pooled, M = 64 noise.
States are (x, y, vx, vy) in the frame of each person, divided by scales of the training data.

Choices where the report is not specific: attention scores are divided by sqrt(P); values are a linear map of the
hidden vectors to the 64 components of the pooled vector; no gradient passes through the social features (the bearing
angle of a standing person has none); the layers between LSTMs and heads of the discriminator are 128 x 64 each, then
128 x 64, since the sizes in the text are inconsistent.

Paper: Amirian, Hayet, Pettré (2019), Social Ways, CVPR Workshops, doi 10.48550/arXiv.1904.09507.
"""

from __future__ import annotations

from typing import NamedTuple

import torch
from torch import Tensor, nn

from .config import SocialWaysConfig

SMALL = 1e-6


class SceneInput(NamedTuple):
    """Input of the generator: B scenes, as tensors.

    Fields:
        state: ``[B, T, A, 4]`` observed states.
        here: ``[B, A]`` bool.
        origin, turn: ``[B, A, 2]`` [m] and cosine, sine: the frames of the people.
        velocity: ``[B, A, 2]`` [m/s] last observed velocity, in the frame of the person.
        place: ``[B, A, 2]`` [m] last observed position, in the frame of the person.
    """

    state: Tensor
    here: Tensor
    origin: Tensor
    turn: Tensor
    velocity: Tensor
    place: Tensor

    def repeat(self, draws: int) -> SceneInput:
        """Return all scenes ``draws`` times, one copy after the other."""
        return SceneInput(*(item.repeat(draws, *(1,) * (item.dim() - 1)) for item in self))


class Generator(nn.Module):
    """Generator of joint futures: at each step, everyone attends to the drawn positions of the others."""

    def __init__(self, config: SocialWaysConfig, dt: float, scales: tuple[float, float, float]) -> None:
        """Initialize with random weights; ``scales``: position [m], velocity [m/s] and distance [m]."""
        super().__init__()
        c = self.config = config
        self.dt, self.scales = dt, scales
        self.embed = nn.Linear(4, c.hidden)  # mu
        self.encoder = nn.LSTMCell(c.hidden, c.hidden)  # LSTM-E
        self.features = nn.Sequential(nn.Linear(3, c.pooled), nn.LeakyReLU(c.slope))  # phi
        self.keys = nn.Linear(c.hidden, c.pooled, bias=False)  # W sigma
        self.values = nn.Linear(c.hidden, c.pooled, bias=False)
        self.decoder = nn.LSTMCell(c.hidden + c.pooled + c.inputs, c.hidden)  # LSTM-D
        self.say = nn.Sequential(
            nn.Linear(c.hidden, 64), nn.LeakyReLU(c.slope), nn.Linear(64, 32), nn.LeakyReLU(c.slope), nn.Linear(32, 2)
        )

    def forward(
        self, sight: SceneInput, noise: Tensor, steps: int, plan: Tensor | None = None
    ) -> tuple[Tensor, Tensor]:
        """Return future positions [m] and states in agent frames, ``[K, B, T, A, 2]`` and ``[..., 4]``.

        Args:
            sight: B scenes.
            noise: ``[K, B, A, M]`` in 0..1, K draws; the codes come first.
            steps: number of predicted rows.
            plan: ``[B, T, A, 2]`` [m] known positions, in the frame of each person; NaN where unknown.
        """
        draws, scenes, people, _ = noise.shape
        hidden = self.encode(sight.state)  # h, c: [B * A, H]
        hidden = (hidden[0].repeat(draws, 1), hidden[1].repeat(draws, 1))  # [K * B * A, H]
        seen = sight.repeat(draws)  # [K * B, ...]
        rows = noise.reshape(draws * scenes * people, -1)  # [K * B * A, M]
        if self.config.code_levels > 0:
            codes, rest = rows[:, : self.config.latent_codes], rows[:, self.config.latent_codes :]
            levels = self.config.code_levels  # noise of exactly 1 belongs to the last step
            rows = torch.cat([((codes * levels).floor().clamp(max=levels - 1) + 0.5) / levels, rest], dim=1)
        if self.config.noise_gain > 0.0:
            rows = (rows - 0.5) * self.config.noise_gain
        spoken = (torch.zeros_like(hidden[0]), torch.zeros_like(hidden[0]))  # k: [K * B * A, H]
        place, velocity = seen.place, seen.velocity  # [K * B, A, 2]
        places, states = [], []
        for step in range(steps):
            pooled = self.pool(hidden[0], place, velocity, seen)  # [K * B * A, P]
            spoken = self.decoder(torch.cat([hidden[0], pooled, rows], dim=1), spoken)
            output = self.say(spoken[0]).view(-1, people, 2) * self.scales[1]  # [K * B, A, 2] m/s
            velocity = seen.velocity + output if self.config.residual else output.float()
            moved = place + self.dt * velocity
            if plan is not None:
                known = plan[:, step].repeat(draws, 1, 1)
                moved = torch.where(torch.isnan(known), moved, known)
                velocity = (moved - place) / self.dt
            place = moved
            state = torch.cat([place / self.scales[0], velocity / self.scales[1]], dim=-1)  # [K * B, A, 4]
            if step + 1 < steps:
                hidden = self.encoder(self.embed(state).flatten(0, 1), hidden)  # h continues with the drawn state
            places.append(place)
            states.append(state)
        shape = (draws, scenes, people)
        return tuple(torch.stack(x, dim=1).view(*shape[:2], steps, people, -1) for x in (places, states))  # type: ignore[return-value]

    def encode(self, state: Tensor) -> tuple[Tensor, Tensor]:
        """Return hidden and cell vectors ``[B * A, H]`` after the observed states ``[B, T, A, 4]``."""
        embedded = self.embed(state).permute(1, 0, 2, 3).flatten(1, 2)  # [T, B * A, H]
        hidden = (torch.zeros_like(embedded[0]), torch.zeros_like(embedded[0]))
        for row in embedded:
            hidden = self.encoder(row, hidden)
        return hidden

    def pool(self, hidden: Tensor, place: Tensor, velocity: Tensor, sight: SceneInput) -> Tensor:
        """Return the attention-pooled neighbors of each agent ``[B * A, P]``; 0 without neighbors.

        Args:
            hidden: ``[B * A, H]`` encoded tracks.
            place, velocity: ``[B, A, 2]`` [m] and [m/s] in agent frames.
            sight: B scenes.
        """
        count, people, _ = place.shape
        if not self.config.social or people == 1:
            return hidden.new_zeros(count * people, self.config.pooled)
        pairs = sight.here[:, :, None] & sight.here[:, None, :]  # [B, A, A]
        pairs = pairs & ~torch.eye(people, dtype=torch.bool, device=pairs.device)
        with torch.no_grad():
            delta = social_features(sight.origin + _rotate(place, sight.turn), _rotate(velocity, sight.turn))
            delta = delta / delta.new_tensor([self.scales[2], 1.0, self.scales[2]])
            delta = torch.where(pairs[..., None], delta, 0.0).transpose(1, 2).contiguous()  # [B, j, i, 3]
        mapped = hidden.view(count, people, -1)
        keys, values = self.keys(mapped), self.values(mapped)  # [B, A, P]
        score = (self.features(delta) @ keys[..., None])[..., 0].transpose(1, 2) / self.config.pooled**0.5  # [B, i, j]
        weight = torch.softmax(score.float().masked_fill(~pairs, -1e9), dim=-1) * pairs  # [B, A, A]
        return torch.bmm(weight, values).flatten(0, 1)


def social_features(place: Tensor, velocity: Tensor) -> Tensor:
    """Return distance [m], bearing angle [rad] and distance of closest approach [m] of all pairs, ``[B, A, A, 3]``.

    The bearing of j from i is the angle from the velocity of i to the vector from i to j, positive to the left. The
    closest approach is now or in the future, at constant velocities.

    Args:
        place, velocity: ``[B, A, 2]`` [m] and [m/s].
    """
    way = place[:, None] - place[:, :, None]  # [B, i, j, 2]: from i to j
    distance = torch.linalg.vector_norm(way, dim=-1)
    vx, vy = velocity[:, :, None, 0], velocity[:, :, None, 1]  # of i
    bearing = torch.atan2(vx * way[..., 1] - vy * way[..., 0], vx * way[..., 0] + vy * way[..., 1])
    apart = velocity[:, None] - velocity[:, :, None]  # velocity of j seen from i
    time = -(way * apart).sum(-1) / ((apart * apart).sum(-1) + SMALL)
    closest = torch.linalg.vector_norm(way + apart * time.clamp(min=0.0)[..., None], dim=-1)
    return torch.stack([distance, bearing, closest], dim=-1)


def _rotate(vector: Tensor, turn: Tensor) -> Tensor:
    cos, sin = turn[..., 0], turn[..., 1]
    x, y = vector[..., 0], vector[..., 1]
    return torch.stack([cos * x - sin * y, sin * x + cos * y], dim=-1)


class Discriminator(nn.Module):
    """Discriminator: classifies futures as real or generated, and recovers the latent codes."""

    def __init__(self, config: SocialWaysConfig) -> None:
        """Initialize with random weights."""
        super().__init__()
        c = config
        self.observed = nn.LSTM(4, c.hidden, batch_first=True)  # LSTM-OE
        self.future = nn.LSTM(4, c.hidden, batch_first=True)  # LSTM-PE
        self.of_observed = nn.Sequential(nn.Linear(c.hidden, 64), nn.LeakyReLU(c.slope))
        self.of_future = nn.Sequential(nn.Linear(c.hidden, 64), nn.LeakyReLU(c.slope))
        self.joined = nn.Sequential(nn.Linear(128, 64), nn.LeakyReLU(c.slope))
        self.real = nn.Linear(64, 1)  # D
        self.codes = nn.Linear(64, max(1, c.latent_codes))  # Q

    def forward(self, observed: Tensor, future: Tensor) -> tuple[Tensor, Tensor]:
        """Return the logits of being real ``[N]``, and the recovered codes ``[N, 2]``.

        Args:
            observed, future: ``[N, T, 4]`` states.
        """
        _, (past, _) = self.observed(observed)  # [1, N, H]
        _, (ahead, _) = self.future(future)  # [1, N, H]
        both = torch.cat([self.of_observed(past[0]), self.of_future(ahead[0])], dim=1)  # [N, 128]
        features = self.joined(both)  # [N, 64]
        return self.real(features)[:, 0], self.codes(features)
