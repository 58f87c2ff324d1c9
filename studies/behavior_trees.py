"""Compare the ticks of random behaviour trees with those of BehaviorTree.CPP.

    python studies/behavior_trees.py CHECKOUT --version 4 --count 2500

CHECKOUT is a clone of https://github.com/BehaviorTree/BehaviorTree.CPP with a shared library in its folder ``build``
(``cmake -S . -B build && make -C build``); of the branch v3.8 for ``--version 3``. The study compiles a program with
the library, in which each leaf returns the status of a table by tick and number of the leaf. A tree agrees if in each
of 40 ticks the root returns the same status, and the same leaves are ticked in the same order.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.world import parse_behavior_tree

TICKS, LEAVES = 40, 5
LETTERS = "irsf"
CONTROLS = ("Sequence", "Fallback", "ReactiveSequence", "ReactiveFallback", "Parallel", "SequenceWithMemory")
DECORATORS = ("Inverter", "ForceSuccess", "ForceFailure", "KeepRunningUntilFailure")
LOOPS = {"Repeat": "num_cycles", "RetryUntilSuccessful": "num_attempts"}
OLD = {
    "SequenceWithMemory": "SequenceStar", "success_count": "success_threshold", "failure_count": "failure_threshold",
}  # fmt: skip
PACKAGE = {3: "behaviortree_cpp_v3", 4: "behaviortree_cpp"}
PROGRAM = """
#include <PACKAGE/bt_factory.h>
#include <iostream>
using namespace BT;
static std::vector<std::vector<int>> table;
static int now;
static std::string ticked;
struct Leaf : ActionNodeBase {
  using ActionNodeBase::ActionNodeBase;
  static PortsList providedPorts() { return {InputPort<int>("seconds")}; }
  NodeStatus tick() override {
    const int number = getInput<int>("seconds").value();
    ticked += char('a' + number);
    const int status = table[now][number];
    return status == 1 ? NodeStatus::RUNNING : status == 2 ? NodeStatus::SUCCESS : NodeStatus::FAILURE;
  }
  void halt() override { RESET; }
};
int main() {
  std::string path;
  int ticks, leaves;
  while (std::cin >> path >> ticks >> leaves) {
    table.assign(ticks, std::vector<int>(leaves));
    for (auto& row : table) for (auto& status : row) std::cin >> status;
    BehaviorTreeFactory factory;
    factory.registerNodeType<Leaf>("Wait");
    auto tree = factory.createTreeFromFile(path);
    for (now = 0; now < ticks; now++) {
      ticked.clear();
      const auto status = tree.TICK();
      std::cout << (status == NodeStatus::RUNNING ? 'r' : status == NodeStatus::SUCCESS ? 's' : 'f') << ticked << ' ';
    }
    std::cout << std::endl;
  }
}
"""


def main() -> int:
    """Compare, and return 1 if a tree differs."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("checkout", type=Path)
    parser.add_argument("--version", type=int, choices=(3, 4), default=4)
    parser.add_argument("--count", type=int, default=1500)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    rng = np.random.default_rng(options.seed)
    trees = [draw_tree(rng, options.version) for _ in range(options.count)]
    tables = [rng.choice([1, 2, 3], p=[0.3, 0.4, 0.3], size=(TICKS, LEAVES)) for _ in trees]
    with tempfile.TemporaryDirectory() as folder:
        program = compile_program(options.checkout.resolve(), options.version, Path(folder))
        theirs = run_program(program, trees, tables, Path(folder))
    wrong = 0
    for text, table, row in zip(trees, tables, theirs, strict=True):
        mine = ticks_of(text, table)
        if mine != row:
            wrong += 1
            tick = next(k for k in range(TICKS) if mine[k : k + 1] != row[k : k + 1])
            print(f"tick {tick}: {mine[tick]} here, {row[tick : tick + 1]} there\n{text}")
    print(f"{len(trees)} trees, {TICKS} ticks each: {wrong} differ from version {options.version}")
    return 1 if wrong else 0


def draw_tree(rng: np.random.Generator, version: int) -> str:
    """Return the XML of a random tree with subtrees."""

    def node(depth: int, subtrees: bool) -> str:
        luck = rng.random()
        if depth == 0 or luck < 0.2:
            return f'<Wait seconds="{rng.integers(LEAVES)}"/>'
        if luck < 0.25 and subtrees:
            return f'<SubTree ID="sub{rng.integers(2)}"/>'
        if luck < 0.4:
            tag = DECORATORS[rng.integers(len(DECORATORS))]
            return f"<{tag}>{node(depth - 1, subtrees)}</{tag}>"
        if luck < 0.5:
            tag, port = list(LOOPS.items())[rng.integers(2)]
            return f'<{tag} {port}="{rng.integers(1, 4)}">{node(depth - 1, subtrees)}</{tag}>'
        tag, count, ports = CONTROLS[rng.integers(len(CONTROLS))], int(rng.integers(1, 5)), ""
        if tag == "Parallel":
            names = ("success_count", "failure_count")
            ports = "".join(f' {word(name)}="{rng.integers(1, count + 1)}"' for name in names)
        return f"<{word(tag)}{ports}>{''.join(node(depth - 1, subtrees) for _ in range(count))}</{word(tag)}>"

    def word(name: str) -> str:
        return OLD.get(name, name) if version == 3 else name

    head = f'BTCPP_format="{version}" ' if version == 4 else ""
    parts = [("main", node(5, True)), ("sub0", node(3, False)), ("sub1", node(3, False))]
    body = "".join(f'<BehaviorTree ID="{name}">{inner}</BehaviorTree>' for name, inner in parts)
    return f'<root {head}main_tree_to_execute="main">{body}</root>'


def ticks_of(text: str, table: NDArray[Any]) -> list[str]:
    """Return the status of the root and the ticked leaves of each tick."""
    tree, rows = parse_behavior_tree(text.encode(), "tree.xml"), []
    state, who = tree.begin(1), np.array([True])
    for row in table:
        ticked: list[str] = []

        def leaf(
            node: Any, who: Any, inputs: Mapping[str, Any], kept: Any, row: Any = row, ticked: list[str] = ticked
        ) -> Any:
            number = int(inputs["seconds"][0])
            ticked.append(chr(ord("a") + number))
            return np.array([row[number]], dtype=np.int8)

        status = int(tree.tick(state, who, leaf)[0])
        rows.append(LETTERS[status] + "".join(ticked))
    return rows


def compile_program(checkout: Path, version: int, folder: Path) -> Path:
    """Compile the program with the library of a checkout, and return its path."""
    package = PACKAGE[version]
    library = checkout / "build" / f"lib{package}.so"
    source, program = folder / "ticks.cpp", folder / "ticks"
    reset, tick = ("setStatus(NodeStatus::IDLE)", "tickRoot") if version == 3 else ("resetStatus()", "tickExactlyOnce")
    source.write_text(
        PROGRAM.replace("PACKAGE", package).replace("RESET", reset).replace("TICK", tick), encoding="utf-8"
    )
    subprocess.run(
        ["g++", "-std=c++20", f"-I{checkout / 'include'}", str(source), str(library), f"-Wl,-rpath,{library.parent}",
         "-lpthread", "-o", str(program)],
        check=True,
    )  # fmt: skip
    return program


def run_program(program: Path, trees: list[str], tables: list[NDArray[Any]], folder: Path) -> list[list[str]]:
    """Return the ticks of each tree in the program."""
    lines = []
    for number, (text, table) in enumerate(zip(trees, tables, strict=True)):
        path = folder / f"{number}.xml"
        path.write_text(text, encoding="utf-8")
        lines.append(f"{path} {TICKS} {LEAVES} {' '.join(map(str, table.ravel().tolist()))}")
    done = subprocess.run([str(program)], input="\n".join(lines), capture_output=True, text=True, check=True)
    return [row.split() for row in done.stdout.splitlines()]


if __name__ == "__main__":
    sys.exit(main())
