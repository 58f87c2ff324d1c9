from dataclasses import dataclass
from crowdbot.core import Twist
from crowdbot.navigation import Navigator

@dataclass(frozen=True)
class Shy(Navigator):
    space: float = 1.0

    def act(self, observation):
        return Twist() if observation.nearest < self.space else observation.towards_goal(0.8)
