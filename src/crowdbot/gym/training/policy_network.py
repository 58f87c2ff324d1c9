"""The network of the policy and of its value in PyTorch, with the layers of the navigator ``policy``."""

from __future__ import annotations

from typing import Any

import numpy as np

from crowdbot.navigation import LAYERS, OWN_VALUES, PERSON_VALUES, PolicyWeights
from crowdbot.prediction import torch_module

__all__ = ["PolicyNetwork"]


class PolicyNetwork:
    """Mean and spread of the action, and the value, of inputs of the policy.

    Each person has two layers, whose outputs are pooled by their maximum; the order of people has no effect. The value
    has layers of its own after the pooling.

    Args:
        generator: generator of PyTorch for the initial weights.
        spread: initial standard deviation of actions.
    """

    def __init__(self, generator: Any, spread: float) -> None:
        torch = torch_module()
        person, pooled, wide = LAYERS
        own = len(OWN_VALUES)
        shapes = {
            "person1": (own + len(PERSON_VALUES), person, 1.4), "person2": (person, pooled, 1.4),
            "action1": (pooled + own, wide, 1.4), "action2": (wide, wide, 1.4), "action3": (wide, 2, 0.1),
            "value1": (pooled + own, pooled, 1.4), "value2": (pooled, 1, 1.0),
        }  # fmt: skip
        self.layers: dict[str, Any] = {}
        for name, (wide_in, wide_out, gain) in shapes.items():
            draw = torch.randn(wide_in, wide_out, generator=generator)
            whole = torch.linalg.qr(draw if wide_in >= wide_out else draw.T)[0]
            weight = (whole if wide_in >= wide_out else whole.T) * gain
            self.layers[f"{name}.weight"] = weight.contiguous().requires_grad_()
            self.layers[f"{name}.bias"] = torch.zeros(wide_out).requires_grad_()
        with torch.no_grad():
            self.layers["action3.bias"][0] = 0.5
        self.layers["spread"] = torch.full((2,), float(np.log(spread))).requires_grad_()

    def _layer(self, name: str, values: Any) -> Any:
        return torch_module().addmm(self.layers[f"{name}.bias"], values, self.layers[f"{name}.weight"])

    def pool(self, own: Any, people: Any, present: Any) -> Any:
        """Return ``[N, P + F]`` pooled people and the values of the robot.

        Args:
            own: ``[N, F]``.
            people: ``[N, K, G]``; rows after ``present`` are ignored.
            present: ``[N, 1]`` number of people.
        """
        torch = torch_module()
        N, K, _ = people.shape
        both = torch.cat([people, own[:, None].expand(-1, K, -1)], dim=2).reshape(N * K, -1)
        found = torch.relu(self._layer("person2", torch.relu(self._layer("person1", both)))).reshape(N, K, -1)
        there = torch.arange(K)[None, :, None] < present[:, None]
        return torch.cat([(found * there).amax(dim=1), own], dim=1)

    def heads(self, pooled: Any) -> tuple[Any, Any]:
        """Return the mean actions ``[N, 2]`` and the values ``[N]`` of pooled inputs."""
        torch = torch_module()
        action = torch.relu(self._layer("action2", torch.relu(self._layer("action1", pooled))))
        value = self._layer("value2", torch.relu(self._layer("value1", pooled)))
        return self._layer("action3", action), value[:, 0]

    @property
    def spread(self) -> Any:
        """Logarithm of the standard deviation of each number of the action, ``[2]``."""
        return self.layers["spread"]

    def weights(self) -> PolicyWeights:
        """Return the weights of the navigator."""
        rows = {name.replace(".", "_"): value.detach().numpy().copy() for name, value in self.layers.items()}
        return PolicyWeights(**{name: rows[name] for name in PolicyWeights._fields})
