"""Train the navigators ``policy``, ``attention-policy`` and ``recurrent-policy`` with PPO of stable-baselines3.

    pip install 'crowdbot[gym]' stable-baselines3
    python train_navigator.py --out weights
    python train_navigator.py --network attention --out weights
    python train_navigator.py --network recurrent --out weights
    crowdbot evaluate crowdnav-circle-5 --navigators "orca, policy file=weights/policy.npz" --seeds 0:200

The network is that of the navigator: two layers for each person, whose outputs are pooled by their maximum or weighed
by attention, and three for the action, a velocity in the frame of the goal; ``recurrent`` has a recurrent network over
the last positions of each person before these layers. ``weights/policy.npz``, ``weights/attention-policy.npz`` or
``weights/recurrent-policy.npz`` has the weights, and ``weights/model.zip`` the model of stable-baselines3 with its value
and optimiser. Ctrl-C ends the training early and keeps both. ``--seed 0:5`` trains with five seeds, into the folders
``weights/seed-0`` to ``weights/seed-4``; the same command again leaves out those that are there with all their steps.
"""

import argparse
import dataclasses
import shlex
import sys
import time
from pathlib import Path

import numpy as np
import torch
from gymnasium import spaces
from stable_baselines3 import PPO
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor
from stable_baselines3.common.vec_env import VecEnv
from train_with_stable_baselines3 import OUTCOMES, CrowdVecEnv, OutcomeTable

from crowdbot.core import InputError
from crowdbot.evaluation import EvaluationPlan, evaluate, parse_methods, parse_seeds
from crowdbot.gym import ActionForm, ObservationForm, Reward
from crowdbot.navigation import (
    BODY_VALUES,
    FACING_VALUES,
    LAYERS,
    MOST_ATTENDED,
    OWN_VALUES,
    PERSON_VALUES,
    WALL_DIRECTIONS,
    WINDOW_STEPS,
    WINDOW_VALUES,
    AttentionWeights,
    PolicyWeights,
    RecurrentWeights,
    attention_inputs,
    empty_memory,
    goal_frame_twists,
    policy_inputs,
    recurrent_inputs,
    remember,
    with_memory,
)
from crowdbot.trials import load_trial

MAX_PEOPLE = 20
CROSSINGS = "crowdnav-circle-5, crowdnav-circle-10, crowdnav-square-10 people=8, crowdnav-circle-20 radius=6"
WALLED = (
    "crowdnav-circle-20, frontal, doorway, entering-room, corner-traffic, block, four-blocks, perpendicular-flow, "
    "random-hall layout=1"
)
TRIALS = {"pooled": CROSSINGS} | dict.fromkeys(("attention", "recurrent"), f"{CROSSINGS}, {WALLED}")
REWARD = Reward(success=1.0, collision=-1.0, discomfort_distance=0.2, discomfort=1.0, progress=0.1)
FIRST_CASE = 2**31 + 1000
"""Smallest seed of the cases of the test; the seeds that a training draws are below 2**31."""


@dataclasses.dataclass(frozen=True)
class PolicyObservation(ObservationForm):
    """The inputs of a navigator; ``known`` keeps what the robots of the environments know."""

    network: str = "pooled"
    known: dict = dataclasses.field(default_factory=dict)

    def shapes(self, beams):
        if self.network == "pooled":
            return {"own": (len(OWN_VALUES),), "people": (MAX_PEOPLE, len(PERSON_VALUES)), "present": (1,)}
        shapes = {"own": (len(OWN_VALUES) + len(FACING_VALUES),), "present": (1,), "walls": (WALL_DIRECTIONS,)}
        if self.network == "attention":
            return shapes | {"people": (MOST_ATTENDED, len(PERSON_VALUES))}
        some = 1 + MOST_ATTENDED
        windows = {"windows": (some, WINDOW_STEPS, len(WINDOW_VALUES)), "steps": (some,)}
        return shapes | windows | {"bodies": (MOST_ATTENDED, len(BODY_VALUES))}

    def bounds(self, name, longest):
        return -np.full(1, np.inf), np.full(1, np.inf)

    def arrays(self, batch, scan):
        if self.network == "recurrent":
            batch = self.remembered(batch)
            found = recurrent_inputs(batch)
        else:
            found = policy_inputs(batch, MAX_PEOPLE) if self.network == "pooled" else attention_inputs(batch)
        parts = found._asdict()
        self.known.update(batch=batch, axis=parts.pop("axis"))
        parts["present"] = found.present[:, None]
        return {name: value.astype(np.float32) for name, value in parts.items()}

    def remembered(self, batch):
        """Return the observations with where people were, in place of their velocities."""
        memory = self.known.get("memory")
        if memory is None or len(memory) != len(batch):
            memory = empty_memory(len(batch), batch.dt)
        memory = self.known["memory"] = remember(memory, batch)
        return with_memory(batch, memory)


@dataclasses.dataclass(frozen=True)
class GoalFrameAction(ActionForm):
    """Velocities in the goal frame, as shares of the maximum speed, that the drive realises as for the navigator."""

    form: str = "holonomic"
    known: dict = dataclasses.field(default_factory=dict)
    horizon: float = 0.0

    def twists(self, actions, limits, twist=None, dt=0.0):
        shares, out = np.array(actions, np.float64), np.zeros((len(actions), 3))
        batch, every = self.known["batch"], np.ones(len(actions), np.bool_)
        goal_frame_twists(batch, every, self.known["axis"], shares, out, horizon=self.horizon)
        return out


def environments_of(trials, wanted):
    """Return the number of environments: a multiple of the number of trials, at most the wanted one if possible."""
    return max(1, wanted // len(trials)) * len(trials)


class GoalFrame(VecEnv):
    """Environments of several trials, whose actions are shares of the maximum speed in the frame of the goal."""

    def __init__(self, trials, num_envs, network="pooled"):
        each = environments_of(trials, num_envs) // len(trials)
        self.parts = []
        for name, values in trials:
            seen = PolicyObservation(network=network)
            action = GoalFrameAction(known=seen.known, horizon=0.0 if network == "pooled" else 1.0)
            options = {"observation": seen, "action": action, "reward": REWARD}
            self.parts.append(CrowdVecEnv(load_trial(name, values), each, **options))
        super().__init__(each * len(trials), self.parts[0].observation_space, spaces.Box(-1.0, 1.0, (2,), np.float32))

    def _join(self, observations):
        return {name: np.concatenate([part[name] for part in observations]) for name in observations[0]}

    def reset(self):
        return self._join([part.reset() for part in self.parts])

    def step_async(self, actions):
        for part, action in zip(self.parts, np.split(actions, len(self.parts)), strict=True):
            part.step_async(action)

    def step_wait(self):
        observations, rewards, dones, infos = zip(*(part.step_wait() for part in self.parts), strict=True)
        return (
            self._join(observations),
            np.concatenate(rewards),
            np.concatenate(dones),
            [one for part in infos for one in part],
        )

    def seed(self, seed=None):
        for k, part in enumerate(self.parts):
            part.seed(None if seed is None else seed + k * part.num_envs)

    def close(self):
        for part in self.parts:
            part.close()

    def get_attr(self, attr_name, indices=None):
        return self.parts[0].get_attr(attr_name) * len(list(self._get_indices(indices)))

    def set_attr(self, attr_name, value, indices=None):
        for part in self.parts:
            part.set_attr(attr_name, value)

    def env_method(self, method_name, *arguments, indices=None, **options):
        raise NotImplementedError("the environments of a trial are one simulation")

    def env_is_wrapped(self, wrapper_class, indices=None):
        return [False] * len(list(self._get_indices(indices)))


class PooledPeople(BaseFeaturesExtractor):
    """Two layers for each person, pooled by their maximum, then the values of the robot."""

    def __init__(self, observation_space):
        person, pooled, _ = LAYERS
        own = len(OWN_VALUES)
        super().__init__(observation_space, pooled + own)
        self.person1 = torch.nn.Linear(own + len(PERSON_VALUES), person)
        self.person2 = torch.nn.Linear(person, pooled)

    def forward(self, observations):
        own, people, present = (observations[name] for name in ("own", "people", "present"))
        count = people.shape[1]
        both = torch.cat([people, own[:, None].expand(-1, count, -1)], dim=2)
        found = torch.relu(self.person2(torch.relu(self.person1(both))))
        there = torch.arange(count)[None, :, None] < present[:, None]
        return torch.cat([(found * there).amax(dim=1), own], dim=1)


class AttendedPeople(BaseFeaturesExtractor):
    """Embeddings of people, weighed by attention, then the values of the robot and the walls."""

    def __init__(self, observation_space):
        super().__init__(observation_space, AttentionWeights.widths["action1"][0])
        for name in ("person1", "person2", "score1", "score2"):
            setattr(self, name, torch.nn.Linear(*AttentionWeights.widths[name]))

    def forward(self, observations):
        own, people, present, walls = (observations[name] for name in ("own", "people", "present", "walls"))
        count = people.shape[1]
        both = torch.cat([people, own[:, None].expand(-1, count, -1)], dim=2)
        there = torch.arange(count)[None, :, None] < present[:, None]
        found = torch.relu(self.person2(torch.relu(self.person1(both)))) * there
        mean = found.sum(dim=1, keepdim=True) / present[:, None].clamp(min=1)
        score = self.score2(torch.relu(self.score1(torch.cat([found, mean.expand(-1, count, -1)], dim=2))))
        weight = torch.softmax(score.masked_fill(~there, -1e9), dim=1)
        return torch.cat([(weight * found).sum(dim=1), own, walls], dim=1)


class RememberedPeople(BaseFeaturesExtractor):
    """Recurrent networks over where the robot and people were, weighed by attention, then robot and walls."""

    def __init__(self, observation_space):
        super().__init__(observation_space, RecurrentWeights.widths["action1"][0])
        for name, widths in RecurrentWeights.widths.items():
            if not name.startswith("action"):
                setattr(self, name, torch.nn.Linear(*widths))

    def run(self, edge, windows, steps):
        """Return the states [M, H] after the last steps of windows [M, T, F]."""
        inputs, layer = getattr(self, f"{edge}_input")(windows), getattr(self, f"{edge}_state")
        state = windows.new_zeros(len(windows), layer.in_features)
        for t, row in enumerate(inputs.unbind(dim=1)):
            (reset, update, new), gates = row.chunk(3, dim=1), layer(state).chunk(3, dim=1)
            new = torch.tanh(new + torch.sigmoid(reset + gates[0]) * gates[2])
            new = new + torch.sigmoid(update + gates[1]) * (state - new)
            state = torch.where(steps[:, None] >= windows.shape[1] - t, new, state)
        return state

    def forward(self, observations):
        own, windows, steps, bodies = (observations[name] for name in ("own", "windows", "steps", "bodies"))
        there = torch.arange(bodies.shape[1])[None] < observations["present"]
        robot = torch.cat([self.run("temporal", windows[:, 0], steps[:, 0]), own], dim=1)
        states = self.run("spatial", windows[:, 1:][there], steps[:, 1:][there])  # of those who are there
        both = torch.cat([states, bodies[there], own[:, None].expand(-1, there.shape[1], -1)[there]], dim=1)
        embedded = own.new_zeros(*there.shape, self.person2.out_features)
        embedded[there] = torch.relu(self.person2(torch.relu(self.person1(both))))
        query = self.query(robot)
        score = (self.key(embedded) * query[:, None]).sum(dim=2) / query.shape[1] ** 0.5
        weight = torch.softmax(score.masked_fill(~there, -1e9), dim=1)
        return torch.cat([(weight[..., None] * embedded).sum(dim=1), robot, observations["walls"]], dim=1)


def make_model(envs, length, seed, network="pooled"):
    """Return PPO with the network of the navigator; ``length`` is the number of steps between two updates."""
    kind, extractor = NETWORKS[network]
    wide = kind.widths["action2"][0]
    return make_ppo(envs, length, seed, extractor, {"pi": [wide, wide], "vf": [64]})


def make_ppo(envs, length, seed, extractor, layers):
    """Return PPO with a part of the network before the layers of the action and of the value."""
    model = PPO(
        "MultiInputPolicy",
        envs,
        n_steps=length,
        batch_size=min(1024, length * envs.num_envs),
        n_epochs=4,
        learning_rate=lambda left: 1e-3 * left,  # falls to 0: the last policies differ little
        seed=seed,
        device="cpu",
        policy_kwargs={
            "features_extractor_class": extractor,
            "net_arch": layers,
            "activation_fn": torch.nn.ReLU,
            "log_std_init": float(np.log(0.6)),
        },
    )
    with torch.no_grad():
        model.policy.action_net.bias[0] = 0.5  # towards the goal
    return model


def network_weights(model):
    """Return the weights of the navigator."""
    policy = model.policy
    kind = next(kind for kind, extractor in NETWORKS.values() if isinstance(policy.features_extractor, extractor))
    layers = [layer for layer in policy.features_extractor.children() if isinstance(layer, torch.nn.Linear)]
    layers += [layer for layer in policy.mlp_extractor.policy_net if isinstance(layer, torch.nn.Linear)]
    arrays = [(layer.weight.detach().numpy().T, layer.bias.detach().numpy()) for layer in [*layers, policy.action_net]]
    return kind.of_layers(dict(zip(kind.widths, arrays, strict=True)))


NETWORKS = {
    "pooled": (PolicyWeights, PooledPeople),
    "attention": (AttentionWeights, AttendedPeople),
    "recurrent": (RecurrentWeights, RememberedPeople),
}
"""Weights of the navigator, and the part of the network before the layers of the action."""


def parse_trials(text, crowd=None):
    """Return names and values of trials, such as ``"crowdnav-circle-5, crowdnav-circle-10 people=8"``."""
    parts = [part.split() for part in text.split(",")]
    model = {"crowd/type": crowd} if crowd else {}
    return [(name, dict(word.split("=", 1) for word in words) | model) for name, *words in parts]


def add_options(parser, environments, cases):
    """Add the options that the trainings of all navigators have."""
    parser.add_argument("--steps", type=int, default=1_500_000)
    parser.add_argument("--environments", type=int, default=environments)
    parser.add_argument("--cases", type=int, default=cases, help="number of unseen cases of each trial (0: no test)")
    parser.add_argument("--crowd", help="crowd model of all trials, such as orca (default: that of each trial)")
    parser.add_argument("--seed", type=_seeds, default=(0,), help="one seed, or seeds such as 0:5 with a folder each")
    parser.add_argument("--out", type=Path, default=Path("weights"), help="folder of the weights and of model.zip")


def _seeds(text):
    try:
        return parse_seeds(text)
    except InputError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def trainings(options, trials, kind):
    """Yield the options of each training, which is that of one seed.

    Of several seeds, those are left out whose weights (class ``kind``) are there with all their steps; a training that
    ends early is the last one.
    """
    begin = 0.0  # the first training has the imports, too
    for seed in options.seed:
        out = options.out / f"seed-{seed}" if len(options.seed) > 1 else options.out
        one = argparse.Namespace(**vars(options) | {"seed": seed, "out": out, "begin": begin})
        file = out / f"{kind.navigator}.npz"
        if len(options.seed) > 1 and is_complete(file, one, trials, kind):
            print(f"{file} is there with all its steps", flush=True)
            continue
        yield one
        if not is_complete(file, one, trials, kind):
            return
        begin = time.process_time()


def is_complete(file, options, trials, kind):
    """Return whether a file has the weights of a training that was not ended early."""
    if not file.exists():
        return False
    _, card = kind.read(file)
    return plan_of(options, trials).items() <= card.items() and card["steps"] >= options.steps


def plan_of(options, trials):
    """Return what a training is to do, as values of the card of its weights."""
    return {
        "trials": [" ".join([name, *map("=".join, values.items())]) for name, values in trials],
        "environments": environments_of(trials, options.environments),
        "seed": options.seed,
        "planned_steps": options.steps,
    }


def train(model, options, trials, table, network_weights):
    """Train, write the weights with a card, and print the outcomes in unseen cases of the trials."""
    try:
        model.learn(options.steps, callback=table)
    except KeyboardInterrupt:
        print("the training ends early")
    options.out.mkdir(parents=True, exist_ok=True)
    model.save(options.out / "model.zip")
    weights, seconds = network_weights(model), round(time.process_time() - options.begin)
    file = options.out / f"{weights.navigator}.npz"
    command = shlex.join(["python", Path(sys.argv[0]).name, *sys.argv[1:]])
    made = {"command": command, "steps": model.num_timesteps, "processor_time": seconds}
    weights.save(file, plan_of(options, trials) | made)
    print(f"{model.num_timesteps} steps, {seconds} s of processor time, weights in {file}", flush=True)
    if not options.cases:
        return
    plan = EvaluationPlan(
        [dataclasses.replace(load_trial(name, values), name=f"{name}-{k}") for k, (name, values) in enumerate(trials)],
        parse_methods(f"{weights.navigator} file={file}"),
        seeds=range(FIRST_CASE, FIRST_CASE + options.cases),
    )
    for cell in evaluate(plan).cells:
        shares = [f"{name} {cell.estimate(f'{name}-rate')}" for name in OUTCOMES]
        print(f"{cell.trial}: {', '.join(shares)}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--network", choices=NETWORKS, default="pooled", help="of policy, attention-policy or recurrent-policy"
    )
    parser.add_argument("--trials", help="trials with values, separated by commas (default: TRIALS of the network)")
    add_options(parser, environments=256, cases=200)
    options = parser.parse_args()
    torch.set_num_threads(1)  # small networks: more threads only wait for each other
    trials = parse_trials(options.trials or TRIALS[options.network], options.crowd)
    for one in trainings(options, trials, NETWORKS[options.network][0]):
        envs = GoalFrame(trials, one.environments, one.network)
        model = make_model(envs, max(2, min(8192, one.steps) // envs.num_envs), one.seed, one.network)
        table = OutcomeTable(updates=20 if one.steps > 200_000 else 1)
        train(model, one, trials, table, network_weights)
        envs.close()


if __name__ == "__main__":
    main()
