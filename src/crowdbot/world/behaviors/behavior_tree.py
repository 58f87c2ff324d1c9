"""BehaviorTree: a tree of control nodes, conditions and actions that is ticked for many people at once.

The semantics are those of BehaviorTree.CPP (https://www.behaviortree.dev): nodes return RUNNING, SUCCESS or FAILURE,
control nodes remember the child that runs, and nodes that no longer run are halted. A tree is a value; its state is a
row of numbers for each person.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.typing import Bools, Floats
from crowdbot.world.reactions.reaction import RobotReaction

Statuses = NDArray[np.int8]

IDLE, RUNNING, SUCCESS, FAILURE = 0, 1, 2, 3
"""Statuses of nodes; a node that is not ticked yet, or has been reset, is idle."""
PERSON, STEP = 0, 1
"""Entries of the blackboard that the world writes: ``id``, identity of the person, and ``dt``, time step [s]."""
MOST_CYCLES = 1000
"""Largest number of cycles of a node within one tick."""
UNWRITTEN = math.inf
"""Value of an entry that nothing has written yet."""


@dataclass(frozen=True)
class Entry:
    """An entry of the blackboard, by its number in the tree."""

    number: int


@dataclass(frozen=True)
class Node:
    """A node of a tree.

    Fields:
        kind: name, one of :data:`.node_kinds.KINDS`.
        slot: number of the node in the tree, by which it finds its state.
        children: nodes below it.
        ports: constant or entry of each input.
        output: entry that ``SetBlackboard`` writes.
        reaction: reaction that an action chooses, None for other nodes.
        version: version of BehaviorTree.CPP, 3 or 4. In version 4, a child that begins and ends within one tick ends
            the tick of ``SequenceWithMemory``, ``Repeat`` and ``RetryUntilSuccessful`` if another one or another cycle
            follows, a sequence with memory that is halted goes on where it was, and ``Parallel`` counts all children
            that have finished, not only those up to the one that is ticked.
        place: file and line, for messages.
    """

    kind: str
    slot: int
    children: tuple[Node, ...] = ()
    ports: Mapping[str, float | Entry] = field(default_factory=dict)
    output: Entry | None = None
    reaction: RobotReaction | None = None
    version: int = 4
    place: str = ""

    def each(self) -> Iterator[Node]:
        """Yield the node and all nodes below it."""
        yield self
        for inner in self.children:
            yield from inner.each()


Leaf = Callable[[Node, Bools, Mapping[str, Floats], Floats], Statuses]
"""Ticks a condition or an action: node, who ``[N]``, inputs ``[N]`` by name, and the number ``[N]`` that the node
keeps, which it may change. Returns statuses ``[N]``."""


@dataclass(frozen=True)
class BehaviorTree:
    """A behaviour tree.

    Fields:
        root: root node.
        entries: initial value of each entry of the blackboard; the first two are written by the world.
        entry_names: their names, for messages.
        name: name of the tree.
        regular: how robots are seen while ``RegularNav`` walks: ``regular``, ``ignore`` or ``impassive``.

    >>> from crowdbot.world import parse_behavior_tree
    >>> text = b'<root><BehaviorTree ID="a"><Inverter><AlwaysFailure/></Inverter></BehaviorTree></root>'
    >>> tree = parse_behavior_tree(text, "a.xml")
    >>> state = tree.begin(1)
    >>> tree.tick(state, np.array([True]), lambda node, who, inputs, kept: np.array([3], dtype=np.int8)).tolist()
    [2]
    """

    root: Node
    entries: tuple[float, ...] = (0.0, 0.0)
    entry_names: tuple[str, ...] = ("id", "dt")
    name: str = ""
    regular: str = "regular"

    @functools.cached_property
    def nodes(self) -> tuple[Node, ...]:
        """All nodes, by slot."""
        return tuple(sorted(self.root.each(), key=lambda node: node.slot))

    @property
    def width(self) -> int:
        """Numbers in the state of a person: status and number of each node, and the entries of the blackboard."""
        return 2 * len(self.nodes) + len(self.entries)

    @property
    def leads_journey(self) -> bool:
        """Whether the tree, and not the arrival, decides when a person goes to the next stop."""
        return any(node.kind == "UpdateGoal" for node in self.nodes)

    @property
    def reactions(self) -> tuple[RobotReaction, ...]:
        """The reactions that the actions choose, in order of their nodes; the first one is that of ``RegularNav``."""
        return (RobotReaction(self.regular), *(node.reaction for node in self.nodes if node.reaction is not None))

    def begin(self, people: int) -> Floats:
        """Return the initial state ``[N, width]`` of some people."""
        row = np.concatenate([np.zeros(2 * len(self.nodes)), self.entries])
        return np.tile(row, (people, 1))

    def write(self, state: Floats, who: Bools, entry: int, value: Floats | float) -> None:
        """Write an entry of the blackboard of the people ``who`` ``[N]``; ``state`` is modified."""
        state[:, 2 * len(self.nodes) + entry] = np.where(who, value, state[:, 2 * len(self.nodes) + entry])

    def tick(self, state: Floats, who: Bools, leaf: Leaf) -> Statuses:
        """Tick the tree once for the people ``who`` ``[N]``, and return their statuses ``[N]``, idle for others.

        Args:
            state: ``[N, width]``, modified in place.
            who: ``[N]`` people.
            leaf: ticks conditions and actions.

        Raises:
            InputError: a node reads an entry that nothing has written, or repeats its child without end.
        """
        found = _Tick(self, state, leaf).run(self.root, who)
        done = who & (found >= SUCCESS)
        state[done, 2 * self.root.slot] = IDLE
        return np.where(who, found, IDLE).astype(np.int8)


class _Tick:
    """One tick of a tree for N people."""

    def __init__(self, tree: BehaviorTree, state: Floats, leaf: Leaf) -> None:
        self.tree, self.state, self.leaf = tree, state, leaf
        self.first_entry = 2 * len(tree.nodes)
        self.kinds = {
            "Sequence": lambda node, who: self.pass_on(node, who, FAILURE),
            "SequenceWithMemory": lambda node, who: self.pass_on(node, who, FAILURE, keeps=True),
            "Fallback": lambda node, who: self.pass_on(node, who, SUCCESS),
            "ReactiveSequence": lambda node, who: self.react(node, who, FAILURE),
            "ReactiveFallback": lambda node, who: self.react(node, who, SUCCESS),
            "Parallel": self.parallel,
            "Inverter": lambda node, who: self.turn(node, who, FAILURE, SUCCESS),
            "ForceSuccess": lambda node, who: self.turn(node, who, SUCCESS, SUCCESS),
            "ForceFailure": lambda node, who: self.turn(node, who, FAILURE, FAILURE),
            "KeepRunningUntilFailure": lambda node, who: self.turn(node, who, RUNNING, FAILURE),
            "SubTree": lambda node, who: self.turn(node, who, SUCCESS, FAILURE),
            "Repeat": lambda node, who: self.repeat(node, who, SUCCESS, "num_cycles"),
            "RetryUntilSuccessful": lambda node, who: self.repeat(node, who, FAILURE, "num_attempts"),
            "SetBlackboard": self.set_entry,
        }

    def run(self, node: Node, who: Bools) -> Statuses:
        """Tick a node for some people; return statuses ``[N]``, which others ignore."""
        if not np.any(who):
            return np.zeros(len(who), dtype=np.int8)
        if node.kind in self.kinds:
            found = self.kinds[node.kind](node, who)
        else:
            kept = self.state[:, 2 * node.slot + 1].copy()
            found = self.leaf(node, who, self.inputs(node, who), kept)
            self.state[who, 2 * node.slot + 1] = kept[who]
        self.state[who, 2 * node.slot] = found[who]
        return found

    def inputs(self, node: Node, who: Bools) -> dict[str, Floats]:
        """Return the inputs ``[N]`` of a node."""
        values = {}
        for name, value in node.ports.items():
            if isinstance(value, Entry):
                values[name] = self.state[:, self.first_entry + value.number].copy()
                if np.any(who & (values[name] == UNWRITTEN)):
                    raise InputError(
                        f"{node.place}: <{node.kind}> {name} reads the entry"
                        f" {{{self.tree.entry_names[value.number]}}} before a SetBlackboard has written it"
                    )
            else:
                values[name] = np.full(len(self.state), value)
        return values

    def set_entry(self, node: Node, who: Bools) -> Statuses:
        value = self.inputs(node, who)["value"]
        if node.output is not None:
            self.tree.write(self.state, who, node.output.number, value)
        return np.full(len(who), SUCCESS, dtype=np.int8)

    def reset(self, node: Node, who: Bools) -> None:
        """Halt the nodes below a node where they run, and make them idle."""
        for inner in node.children:
            running = who & (self.state[:, 2 * inner.slot] == RUNNING)
            if np.any(running):
                self.halt(inner, running)
            self.state[who, 2 * inner.slot] = IDLE

    def halt(self, node: Node, who: Bools) -> None:
        """Stop a node that runs: it begins anew, except a sequence with memory of version 4."""
        if node.kind != "SequenceWithMemory" or node.version == 3:
            self.state[who, 2 * node.slot + 1] = 0.0
        self.reset(node, who)

    def pass_on(self, node: Node, who: Bools, end: int, keeps: bool = False) -> Statuses:
        """Tick one child after the other, from the one that runs, until one returns RUNNING or ``end``."""
        index, going = self.state[:, 2 * node.slot + 1], who.copy()
        out = np.full(len(who), SUCCESS if end == FAILURE else FAILURE, dtype=np.int8)
        for number, inner in enumerate(node.children):
            now = going & (index == number)
            fresh = self.state[:, 2 * inner.slot] == IDLE
            found = self.run(inner, now)
            stopped, ended = now & (found == RUNNING), now & (found == end)
            out[stopped], out[ended] = RUNNING, end
            passed = now & ~stopped & ~ended
            index[passed] = number + 1
            self.reset(node, ended)
            if not keeps:
                index[ended] = 0.0
            going &= ~(stopped | ended)
            if keeps and node.version == 4 and number + 1 < len(node.children):
                out[passed & fresh] = RUNNING
                going &= ~(passed & fresh)
        self.reset(node, going)
        index[going] = 0.0
        return out

    def react(self, node: Node, who: Bools, end: int) -> Statuses:
        """Tick all children from the first one until one returns RUNNING or ``end``; the others are halted."""
        going = who.copy()
        out = np.full(len(who), SUCCESS if end == FAILURE else FAILURE, dtype=np.int8)
        for inner in node.children:
            found = self.run(inner, going)
            stopped, ended = going & (found == RUNNING), going & (found == end)
            out[stopped], out[ended] = RUNNING, end
            if np.any(stopped):
                for other in node.children:
                    if other is not inner:
                        running = stopped & (self.state[:, 2 * other.slot] == RUNNING)
                        self.halt(other, running)
                        self.state[stopped, 2 * other.slot] = IDLE
            self.reset(node, ended)
            going &= ~(stopped | ended)
        self.reset(node, going)
        return out

    def parallel(self, node: Node, who: Bools) -> Statuses:
        """Tick all children that have not finished, until enough of them have succeeded or failed."""
        count, going, inputs = len(node.children), who.copy(), self.inputs(node, who)
        need, bear = (
            np.where(inputs[name] < 0.0, np.maximum(count + inputs[name] + 1.0, 0.0), inputs[name])
            for name in ("success_count", "failure_count")
        )
        out = np.full(len(who), RUNNING, dtype=np.int8)
        slots = [2 * inner.slot for inner in node.children]
        for number, inner in enumerate(node.children):
            status = self.state[:, 2 * inner.slot]
            self.run(inner, going & (status < SUCCESS))
            counted = self.state[:, slots if node.version == 4 else slots[: number + 1]]
            succeeded, failed = np.sum(counted == SUCCESS, axis=1), np.sum(counted == FAILURE, axis=1)
            good = going & (succeeded >= need)
            bad = going & ~good & ((count - failed < need) | (failed == bear))
            if node.version == 3:
                good, bad = good & (status == SUCCESS) & (need > 0.0), bad & (status == FAILURE)
            out[good], out[bad] = SUCCESS, FAILURE
            self.reset(node, good | bad)
            going &= ~(good | bad)
        return out

    def turn(self, node: Node, who: Bools, success: int, failure: int) -> Statuses:
        """Tick the child, and return other statuses for those with which it ends."""
        found = self.run(node.children[0], who)
        self.reset(node, who & (found >= SUCCESS))
        return np.array([IDLE, RUNNING, success, failure], dtype=np.int8)[found]

    def repeat(self, node: Node, who: Bools, again: int, port: str) -> Statuses:
        """Tick the child until it has returned ``again`` often enough."""
        inner, most = node.children[0], self.inputs(node, who)[port]
        cycle = self.state[:, 2 * node.slot + 1]
        out = np.full(len(who), again, dtype=np.int8)
        going = who & ((cycle < most) | (most == -1.0))
        for cycles in itertools.count():
            if not np.any(going):
                break
            if cycles == MOST_CYCLES:
                raise InputError(
                    f"{node.place}: <{node.kind}> ticks its node more than {MOST_CYCLES} times within one tick; give it"
                    f" a node that runs for some time, or a smaller {port}"
                )
            fresh = self.state[:, 2 * inner.slot] == IDLE
            found = self.run(inner, going)
            stopped, ended = going & (found == RUNNING), going & (found >= SUCCESS) & (found != again)
            out[stopped], out[ended] = RUNNING, SUCCESS + FAILURE - again
            cycle[going & (found == again)] += 1.0
            self.reset(node, going & (found >= SUCCESS))
            cycle[ended] = 0.0
            going &= ~(stopped | ended) & ((cycle < most) | (most == -1.0))
            if node.version == 4:
                out[going & fresh] = RUNNING
                going &= ~fresh
        cycle[who & (out == again)] = 0.0
        return out
