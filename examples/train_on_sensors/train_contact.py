"""Train a small network while the simulation steps: will a person come near the robot within 2 s?

    pip install 'crowdbot[learn]'
    python examples/train_on_sensors/train_contact.py --seconds 120 --out contact.npz --plot contact.png

Sixteen simulations advance together. Each scan becomes a sample as soon as the simulation has reached the 2 s behind
it; after each scan the network takes a gradient step on samples drawn from all that came so far. At the end it is
tested on seeds that it has never seen, beside the distance to the nearest return of the scan.
"""

from __future__ import annotations

import argparse
import time

import numpy as np
import torch
from contact_samples import LAGS, POOL, SampleStream, collect

BEAMS = 1080 // POOL
HELD_OUT = 1000
"""First seed of the test."""


class ContactNetwork(torch.nn.Module):
    """Convolutions around the robot: ``[N, lags, beams]`` -> ``[N]``, the logit of the probability."""

    def __init__(self):
        super().__init__()
        around = {"padding_mode": "circular", "stride": 2}
        self.layers = torch.nn.Sequential(
            torch.nn.Conv1d(len(LAGS), 16, 9, padding=4, **around),
            torch.nn.ReLU(),
            torch.nn.Conv1d(16, 32, 5, padding=2, **around),
            torch.nn.ReLU(),
            torch.nn.Conv1d(32, 32, 5, padding=2, **around),
            torch.nn.ReLU(),
            torch.nn.Flatten(),
            torch.nn.Linear(32 * -(-BEAMS // 8), 32),
            torch.nn.ReLU(),
            torch.nn.Linear(32, 1),
        )

    def forward(self, scans):
        return self.layers(scans)[:, 0]


def save(network, file):
    """Write the weights as arrays of NumPy, without pickle."""
    np.savez(file, **{name: value.numpy() for name, value in network.state_dict().items()})


def load(file):
    """Return the network of a file of :func:`save`."""
    network = ContactNetwork()
    with np.load(file, allow_pickle=False) as arrays:
        network.load_state_dict({name: torch.from_numpy(arrays[name]) for name in arrays.files})
    return network.eval()


def train(seconds, environments, report=print):
    """Return a network trained while the simulations run, and the number of samples.

    Args:
        seconds: simulated time of each environment [s].
        environments: number of environments, with the seeds from 0 on.
        report: takes lines of text.
    """
    torch.manual_seed(0)
    torch.set_num_threads(1)  # for batches of this size, threads that wait for each other take longer than the work
    rng = np.random.default_rng(0)
    network, stream = ContactNetwork(), SampleStream(range(environments))
    optimizer = torch.optim.AdamW(network.parameters(), lr=2e-3, weight_decay=1e-2)
    inputs = np.empty((round(10 * seconds) * environments, len(LAGS), BEAMS), dtype=np.float32)
    labels, count, losses = np.empty(len(inputs), dtype=np.float32), 0, []
    for scan in range(1, round(10 * seconds) + 1):
        found = stream.advance()
        if found is not None:
            inputs[count : count + environments], labels[count : count + environments] = found[:2]
            count += environments
        if count >= 256:
            chosen = rng.integers(count, size=128)
            scores = network(torch.from_numpy(inputs[chosen]))
            loss = torch.nn.functional.binary_cross_entropy_with_logits(scores, torch.from_numpy(labels[chosen]))
            optimizer.zero_grad()
            loss.backward()
            optimizer.step()
            losses.append(loss.item())
        if scan % 100 == 0 and losses:
            report(f"{scan / 10:5.0f} s simulated, {count} samples, loss {np.mean(losses[-100:]):.3f}")
    return network.eval(), count


def probabilities(network, inputs):
    """Return the probability of each sample ``[N]``."""
    with torch.no_grad():
        return torch.sigmoid(network(torch.from_numpy(inputs))).numpy()


def operating_curve(scores, labels):
    """Return the shares of false and of true alarms ``[N + 1]`` for falling thresholds."""
    order = np.argsort(-scores, kind="stable")
    right = np.concatenate([[0], np.cumsum(labels[order])])
    wrong = np.arange(len(right)) - right
    return wrong / max(1, wrong[-1]), right / max(1, right[-1])


def area(scores, labels):
    """Return the area under :func:`operating_curve`: 1 is perfect, 0.5 is chance."""
    return float(np.trapezoid(operating_curve(scores, labels)[1], operating_curve(scores, labels)[0]))


def plot(scores, nearest, labels, file):
    """Write a plot of the curves of network and distance, and of the frequency over the probability."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.6, 3.8), layout="constrained")
    left, right = figure.subplots(1, 2)
    for values, name, style in ((scores, "network", "-"), (-nearest, "nearest return", "--")):
        left.plot(*operating_curve(values, labels), style, label=f"{name}, area {area(values, labels):.3f}")
    left.set(xlabel="false alarms", ylabel="true alarms", title="A person comes near within 2 s")
    left.legend(loc="lower right")
    edges = np.linspace(0.0, 1.0, 11)
    group = np.clip(np.digitize(scores, edges) - 1, 0, 9)
    known = [k for k in range(10) if (group == k).sum() >= 20]
    right.plot([0, 1], [0, 1], color="0.7")
    right.plot([scores[group == k].mean() for k in known], [labels[group == k].mean() for k in known], "o-")
    right.set(xlabel="predicted probability", ylabel="frequency", title=f"{len(labels)} samples of new seeds")
    for axes in (left, right):
        axes.set(xlim=(0.0, 1.0), ylim=(0.0, 1.02), aspect="equal")
        axes.grid(alpha=0.3)
    figure.savefig(file, dpi=110)


def main():
    """Train, test on new seeds, and save."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=120.0, help="simulated time of each environment [s]")
    parser.add_argument("--environments", type=int, default=16, help="number of environments")
    parser.add_argument("--test-seconds", type=float, default=40.0, help="simulated time of each new seed [s]")
    parser.add_argument("--out", default="contact.npz", help="file of the weights")
    parser.add_argument("--plot", help="file of a plot")
    options = parser.parse_args()
    begin = time.perf_counter()
    network, count = train(options.seconds, options.environments)
    print(f"trained on {count} samples in {time.perf_counter() - begin:.0f} s")
    save(network, options.out)
    seeds = range(HELD_OUT, HELD_OUT + options.environments)
    inputs, labels, nearest = collect(seeds, round(10 * options.test_seconds))
    scores = probabilities(load(options.out), inputs)
    print(f"new seeds: {len(labels)} samples, a person comes near in {100 * labels.mean():.0f} %")
    print(f"area under the curve: network {area(scores, labels):.3f}, nearest return {area(-nearest, labels):.3f}")
    if options.plot:
        plot(scores, nearest, labels, options.plot)


if __name__ == "__main__":
    main()
