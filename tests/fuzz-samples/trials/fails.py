from dataclasses import dataclass

from crowdbot.core import Twist
from crowdbot.navigation import Navigator


@dataclass(frozen=True)
class Fails(Navigator):
    after: float = 0.5

    def act(self, observation):
        if observation.time >= self.after:
            raise RuntimeError("the map is empty")
        return Twist(0.5)
