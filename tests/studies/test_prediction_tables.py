"""studies/prediction_tables.py on a few synthetic people: every part runs, resumes, and its numbers are right."""

from __future__ import annotations

import importlib
import json
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from crowdbot.core import stream
from crowdbot.data import load
from crowdbot.metrics import ade, fde
from crowdbot.prediction import ConstantVelocity
from crowdbot.prediction.anchor_net.own_weights import load_reaction

ROOT = Path(__file__).parents[2]
Tool = Callable[..., str]


def paths(people: int, rows: int, seed: int) -> np.ndarray:
    """Return tracks ``[people, rows, 2]`` [m] at 0.4 s of people who walk along a street and sway."""
    rng = stream(seed, "street")
    pace = rng.choice([-1.0, 1.0], people) * rng.uniform(0.9, 1.5, people)
    x = rng.uniform(-3.0, 3.0, people)[:, None] + pace[:, None] * 0.4 * (np.arange(rows) - rows / 2)
    y = rng.uniform(-3.0, 3.0, people)[:, None] + np.cumsum(rng.normal(0.0, 0.03, (people, rows)), axis=1)
    return np.stack([x, y], axis=2)


def write_table(file: Path, tracks: np.ndarray) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    lines = [
        f"{10 * row}\t{person + 1}\t{x:.3f}\t{y:.3f}"
        for row in range(tracks.shape[1])
        for person, (x, y) in enumerate(tracks[:, row])
    ]
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")


def write_scenes(file: Path, tracks: np.ndarray) -> None:
    """Write a TrajNet++ file with a scene for each of three categories."""
    file.parent.mkdir(parents=True, exist_ok=True)
    lines = [
        {"scene": {"id": k, "p": k, "s": 0, "e": 200, "fps": 2.5, "tag": tag}}
        for k, tag in enumerate(([1, []], [3, [2]], [4, []]))
    ]
    lines += [
        {"track": {"f": 10 * row, "p": person, "x": float(x), "y": float(y)}}
        for row in range(21)
        for person, (x, y) in enumerate(tracks[:, row])
    ]  # fmt: skip
    file.write_text("\n".join(json.dumps(line) for line in lines) + "\n", encoding="utf-8")


def write_cart_run(folder: Path, name: str, seed: int) -> None:
    """Write three people and a cart in the format of CITR."""
    folder.mkdir(parents=True, exist_ok=True)
    rows, rng = 260, stream(seed, "cart")
    time = np.arange(rows) / 29.97
    people = ["id,frame,label,x_est,y_est,vx_est,vy_est"]
    for number, y in enumerate((0.6, -0.9, 5.0), start=1):
        sway = np.cumsum(rng.normal(0.0, 0.002, rows))
        people += [f"{number},{k + 300},ped,{-5.0 + 1.2 * t},{y + sway[k]},1.2,0" for k, t in enumerate(time)]
    cart = ["id,frame,label,x_est,y_est,psi_est,vel_est"]
    cart += [f"1,{k + 300},veh,{6.0 - 1.0 * t},0,3.14,1.0" for k, t in enumerate(time)]
    (folder / f"{name}_traj_ped_filtered.csv").write_text("\n".join(people) + "\n", encoding="utf-8")
    (folder / f"{name}_traj_veh_filtered.csv").write_text("\n".join(cart) + "\n", encoding="utf-8")


@pytest.fixture(scope="session")
def tiny(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with all data sets, each of a few people."""
    data = tmp_path_factory.mktemp("data")
    splits = data / "eth_ucy_splits/all_data"
    for number, name in enumerate(("biwi_eth", "biwi_hotel", "students001", "students003", "crowds_zara01",
                                   "crowds_zara02")):  # fmt: skip
        write_table(splits / f"{name}.txt", paths(4, 24, number))
    train = data / "eth_ucy_splits/train"
    for number, name in enumerate(("crowds_zara01", "crowds_zara02", "crowds_zara03", "students001", "students003")):
        write_table(train / f"{name}_train.txt", paths(8, 24, 20 + number))
    for number, name in enumerate(("biwi_hotel", "crowds_zara01", "crowds_students001")):
        write_scenes(data / f"trajnetpp/{name}.ndjson", paths(4, 21, 10 + number))
    for number, name in enumerate(("front_interaction_01", "front_interaction_02")):
        write_cart_run(data / "citr/vci_front", name, number)
    return data


@pytest.fixture
def tool(monkeypatch: pytest.MonkeyPatch) -> Iterator[ModuleType]:
    """The tool, with few trials and seeds, and one place without training."""
    monkeypatch.syspath_prepend(str(ROOT / "studies"))
    names = ("prediction_tables", "prediction_page", "robot_plans", "citr_runs", "zero_shot", "train_plan_reaction")
    for name in names:
        sys.modules.pop(name, None)
    found = importlib.import_module("prediction_tables")
    monkeypatch.setattr(found.robot_plans, "TRIALS", ("frontal",))
    monkeypatch.setattr(found.robot_plans, "SEEDS", range(1))
    monkeypatch.setattr(found.places, "RECORDINGS", {"CITR": ("citr/*/*ped_filtered.csv",)})
    yield found
    for name in names:
        sys.modules.pop(name, None)


@pytest.fixture
def run(
    tool: ModuleType, tiny: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Tool:
    """Run the tool with options; return what it prints."""

    def made(*options: str) -> str:
        monkeypatch.setattr(sys, "argv", ["prediction_tables.py", str(tiny), str(tmp_path), *options])
        tool.main()
        return capsys.readouterr().out

    return made


def rows(folder: Path, part: str) -> dict[str, dict]:
    kept = [json.loads(file.read_text(encoding="utf-8")) for file in (folder / "parts").glob(f"{part}-*.json")]
    return {item["name"]: item["row"] for item in kept}


def test_leave_one_out_has_the_errors_of_the_recordings_and_resumes(run: Tool, tiny: Path, tmp_path: Path) -> None:
    said = run("--part", "leave-one-out")
    assert said.count("leave-one-out: ") == 5 * 10
    found = rows(tmp_path, "leave-one-out")
    past, future = load(tiny / "eth_ucy_splits/all_data/biwi_eth.txt", fps=25).windows()
    forecast = ConstantVelocity().predict(past, 12)
    row = found["all|eth|constant velocity"]
    assert row["ADE"] == pytest.approx(ade(forecast, future)[:, 0][future.scored].mean())
    assert row["FDE"] == pytest.approx(fde(forecast, future)[:, 0][future.scored].mean())
    assert row["persons"] == future.scored.sum()
    assert row["JADE"] == pytest.approx(row["ADE"])
    many = found["all|univ|AnchorNet, 20, seed 0"]
    assert many["ADE"] < many["JADE"]
    assert many["persons"] == 2 * row["persons"]
    assert {"energy", "NLL", "swept 0.2", "swept 0.4", "truth 0.4", "missed"} <= set(many)
    (one, *_) = sorted((tmp_path / "parts").glob("*.json"))
    one.unlink()
    assert run("--part", "leave-one-out").count("leave-one-out: ") == 1
    page = (tmp_path / "tables.md").read_text(encoding="utf-8")
    assert "Protocol all, eth:" in page
    assert "Protocol sgan, zara2:" in page


def test_other_seeds_come_from_a_folder_of_weights(run: Tool, tmp_path: Path) -> None:
    weights = tmp_path / "weights"
    weights.mkdir()
    source = ROOT / "src/crowdbot/assets/predictors/anchor-net-eth.npz"
    for seed in (1, 2):
        (weights / f"anchor-net-eth-seed{seed}.npz").write_bytes(source.read_bytes())
    run("--part", "leave-one-out", "--weights", str(weights))
    own = [rows(tmp_path, "leave-one-out")[f"all|eth|AnchorNet, 20, seed {seed}"]["ADE"] for seed in range(3)]
    assert own == [own[0]] * 3
    page = (tmp_path / "tables.md").read_text(encoding="utf-8")
    assert f"{own[0]:.3f} ± 0.000" in page
    assert "(3) |" in page


def test_trajnet_has_a_row_for_each_category(run: Tool, tmp_path: Path) -> None:
    run("--part", "trajnet")
    found = rows(tmp_path, "trajnet")
    assert len(found) == 12
    for row in found.values():
        assert {name: own["scenes"] for name, own in row.items()} == {
            "all": 3, "static": 1, "interacting": 1, "collision avoidance": 1, "non-interacting": 1
        }  # fmt: skip
        assert row["all"]["ADE"] == pytest.approx(
            np.mean([row[name]["ADE"] for name in ("static", "interacting", "non-interacting")])
        )
        assert all(0.0 <= own[name] <= 1.0 for own in row.values() for name in ("Col-I", "Col-II"))


def test_degraded_tracks_cost_something(run: Tool, tmp_path: Path) -> None:
    run("--part", "degraded")
    found = rows(tmp_path, "degraded")
    assert len(found) == 8 * 6
    assert found["noise 0.1 m|constant velocity"]["ADE"] > found["clean|constant velocity"]["ADE"]
    assert found["2 rows|constant velocity"]["ADE"] == pytest.approx(found["clean|constant velocity"]["ADE"])
    assert found["10 Hz|constant velocity"]["persons"] > 0
    page = (tmp_path / "tables.md").read_text(encoding="utf-8")
    assert "| tracks | " in page
    assert page.count("\n| ") == 8 + 2  # the head, its line, and eight kinds of tracks


def test_plans_are_compared_by_person(run: Tool, tmp_path: Path) -> None:
    run("--part", "robot-plan")
    found = rows(tmp_path, "robot-plan")
    net = found["CITR: AnchorNet"]
    assert net["without plan"]["people"] == 4  # two of three people pass the cart in each run
    assert net["without plan"]["difference"] == 0.0
    assert net["without plan, farther than 2 m"]["people"] == 2
    for name, what in (("CITR: AnchorNet", "plan and radii"), ("CITR: orca", "plan")):
        row, before = found[name][what], found[name]["without plan"]
        assert row["low"] <= row["difference"] <= row["high"]
        assert row["ADE"] == pytest.approx(before["ADE"] + row["difference"])
    assert "trial frontal: AnchorNet" in found
    assert "| CITR: AnchorNet | plan and radii | 4 |" in (tmp_path / "tables.md").read_text(encoding="utf-8")


def test_trials_and_other_places_are_compared_with_constant_velocity(run: Tool, tmp_path: Path) -> None:
    said = run("--part", "trials", "zero-shot", "--trial", "one-way-with", "elevator", "--windows", "5")
    found = rows(tmp_path, "trials")
    assert set(found["one-way-with"]) == {"constant velocity", "AnchorNet, 1", "anchors, 20", "AnchorNet, 20"}
    page = (tmp_path / "tables.md").read_text(encoding="utf-8")
    assert "| one-way-with | " in page
    kept = rows(tmp_path, "zero-shot")["CITR|constant velocity"]
    assert kept["persons"] > 0
    assert "| CITR | " in page
    assert said.count("trials: ") == 2


def test_paired_differences_have_an_interval_and_a_power(tool: ModuleType) -> None:
    rng = stream(1)
    before = rng.uniform(0.4, 0.6, 50)
    after = before - 0.1 + rng.normal(0.0, 0.02, 50)
    row = tool.robot_plans.paired(before, after)
    assert row["low"] < -0.1 < row["high"] < 0.0
    assert row["power"] > 0.99
    noisy = tool.robot_plans.paired(before, before + rng.normal(0.0, 0.5, 50))
    assert noisy["power"] < 0.2
    assert tool.robot_plans.paired(before[:1], after[:1])["power"] is None
    assert tool.robot_plans.paired(before[:0], after[:0])["ADE"] is None


@pytest.mark.parametrize("citr", [False, True])
def test_one_command_trains_the_reaction_anew(
    citr: bool, tool: ModuleType, tiny: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    trainer = importlib.import_module("train_plan_reaction")
    assert tool.robot_plans.ROOM == trainer.ROOM
    monkeypatch.setattr(trainer, "SCENES", 1)
    monkeypatch.setattr(sys, "argv", ["train_plan_reaction.py", "train", str(tiny), str(tmp_path), *["--citr"] * citr])
    trainer.main()
    file = tmp_path / ("plan-reaction-citr.npz" if citr else "plan-reaction-open.npz")
    reaction = load_reaction(str(file))
    assert reaction["reaction_room"] == trainer.ROOM
    assert np.any(reaction["reaction_lateral"] != 0.0)
    monkeypatch.setattr(sys, "argv", ["train_plan_reaction.py", "train", str(tiny), str(tmp_path), *["--citr"] * citr])
    trainer.main()
    again = load_reaction(str(file))
    assert all(np.array_equal(values, again[name]) for name, values in reaction.items())


def test_the_shipped_reaction_has_the_room_of_the_tool(tool: ModuleType) -> None:
    assert float(load_reaction("open")["reaction_room"]) == tool.robot_plans.ROOM
