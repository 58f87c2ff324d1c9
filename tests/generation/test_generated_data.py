"""Generated data against episodes, an independent count of who is hidden, and itself."""

from __future__ import annotations

import dataclasses
import io
import json
import tarfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError
from crowdbot.generation import RECIPES, GenerationPlan, generate, occluded_shares
from crowdbot.recording import read_episode
from crowdbot.sensors import RGBCamera
from crowdbot.simulation import simulate
from crowdbot.trials import Mount, RobotGoal, Spawner, Stage, load_trial, place

SCAN = "robot/sick_tim571"


def plan_of(seeds: Any = range(3), **values: Any) -> GenerationPlan:
    trial = load_trial("crossing-flows", duration="2")
    return GenerationPlan([trial], seeds, ["sick-tim571@10"], **values)


def arrays_of(folder: Path) -> dict[str, Any]:
    (file,) = folder.glob("*.npz")
    with np.load(file, allow_pickle=False) as found:
        return dict(found)


def hashes(folder: Path) -> dict[str, bytes]:
    files = [path for path in sorted(folder.rglob("*")) if path.is_file() and path.parent.name != "parts"]
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


def test_states_and_scans_are_those_of_episodes(tmp_path: Path) -> None:
    plan = plan_of()
    generate(plan, tmp_path)
    found = arrays_of(tmp_path)
    for k, seed in enumerate(plan.seeds):
        episode = simulate(plan.variants[0], seed)
        rows = found["agents/episode"] == k
        assert np.array_equal(found["agents/nanoseconds"][rows], np.round(episode.times * 1e9))
        for name in ("position", "velocity", "heading"):
            stored, true = found[f"agents/{name}"][rows], getattr(episode, name)
            assert np.array_equal(stored[:, : true.shape[1]], true.astype(np.float32), equal_nan=True)
        scans = episode.readings[SCAN]
        mine = found[f"{SCAN}/episode"] == k
        assert len(scans) == mine.sum() > 15
        for row, scan in zip(np.flatnonzero(mine), scans, strict=True):
            assert np.array_equal(found[f"{SCAN}/ranges"][row], scan.ranges[0].astype(np.float32))
            assert np.array_equal(found[f"{SCAN}/hit"][row], scan.hit[0])


def test_a_run_alone_gives_the_same_samples(tmp_path: Path) -> None:
    generate(plan_of(), tmp_path / "three")
    generate(plan_of([1]), tmp_path / "one")
    three, one = arrays_of(tmp_path / "three"), arrays_of(tmp_path / "one")
    for name, array in one.items():
        if name == "seeds" or "shared." in name:
            continue
        rows = three[f"{name.rpartition('/')[0]}/episode"] == 1
        if not name.endswith("/episode"):
            assert np.array_equal(three[name][rows], array, equal_nan=array.dtype.kind == "f"), name


def test_labels_agree_with_the_scan(tmp_path: Path) -> None:
    generate(plan_of(), tmp_path)
    found = arrays_of(tmp_path)
    ids, returns, hit = (found[f"{SCAN}/{name}"] for name in ("ids", "returns", "hit"))
    for row in range(0, len(ids), 7):
        for column, item in enumerate(ids[row]):
            assert returns[row, column] == (np.sum(hit[row] == item) if item >= 0 else 0)
    seen, hidden = returns > 0, found[f"{SCAN}/occluded"]
    assert not (seen & (hidden == 1.0)).sum() > 0.02 * seen.sum()
    assert np.isnan(hidden[:, -1]).all()  # the robot itself
    assert 0.05 < np.nanmean(hidden) < 0.95


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_occlusion_agrees_with_geometry(seed: int) -> None:
    rng = np.random.default_rng(seed)
    place, size = rng.uniform(-4.0, 4.0, (1, 7, 2)), rng.uniform(0.15, 0.5, (1, 7))
    walls = rng.uniform(-4.0, 4.0, (2, 3, 2))
    active = rng.random((1, 7)) < 0.8
    origin = rng.uniform(-4.0, 4.0, (1, 2))
    found = occluded_shares(origin, place, size, active, 6, (walls[0], walls[1]))[0]
    discs = [shapely.Point(*place[0, a]).buffer(size[0, a], quad_segs=64) for a in range(7)]
    for a in range(7):
        away = place[0, a] - origin[0]
        reach = float(np.hypot(*away))
        if not active[0, a] or a == 6 or reach <= size[0, a]:
            assert np.isnan(found[a])
            continue
        across = np.array([-away[1], away[0]]) / reach
        steps = (2.0 * np.arange(16) + 1.0) / 16 - 1.0
        lines = [shapely.LineString([origin[0], place[0, a] + size[0, a] * step * across]) for step in steps]
        others = [discs[b] for b in range(6) if b != a and active[0, b]]
        others += [shapely.LineString(pair) for pair in zip(walls[0], walls[1], strict=True)]
        share = np.mean([any(line.intersects(other) for other in others) for line in lines])
        assert abs(found[a] - share) <= 1.0 / 16 + 1e-9


def test_occlusion_does_not_depend_on_turns_and_order() -> None:
    rng = np.random.default_rng(2)
    place, size, active = rng.uniform(-4, 4, (1, 9, 2)), rng.uniform(0.2, 0.4, (1, 9)), np.ones((1, 9), bool)
    walls = rng.uniform(-4, 4, (2, 4, 2))
    base = occluded_shares(np.zeros((1, 2)), place, size, active, -1, (walls[0], walls[1]))
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    turned = occluded_shares(np.zeros((1, 2)), place @ turn.T, size, active, -1, (walls[0] @ turn.T, walls[1] @ turn.T))
    assert np.array_equal(base, turned, equal_nan=True)
    order = rng.permutation(9)
    other = occluded_shares(np.zeros((1, 2)), place[:, order], size[:, order], active, -1, (walls[0], walls[1]))
    assert np.array_equal(base[:, order], other, equal_nan=True)


def test_processes_and_interruptions_do_not_change_the_files(tmp_path: Path) -> None:
    plan = plan_of(range(5), shard_bytes=1_000_000)
    assert len(plan.jobs(tmp_path)) == 1
    plan = plan_of(range(70))
    assert len(plan.jobs(tmp_path)) == 2
    generate(plan, tmp_path / "one")
    seen: list[float] = []

    def stop(share: float) -> None:
        seen.append(share)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        generate(plan, tmp_path / "two", progress=stop)
    assert len(list((tmp_path / "two").glob("*.npz"))) == 1
    card = generate(plan, tmp_path / "two", workers=2)
    assert seen == [0.5]
    assert hashes(tmp_path / "one") == hashes(tmp_path / "two")
    assert card.outcomes == {"timeout": 70}


def test_a_lost_file_is_told(tmp_path: Path) -> None:
    generate(plan_of(), tmp_path)
    (file,) = tmp_path.glob("*.npz")
    file.unlink()
    with pytest.raises(InputError, match=r"is damaged \(ValueError\); remove it to run its job again"):
        generate(plan_of(), tmp_path)


def test_parquet_holds_the_same(tmp_path: Path) -> None:
    from pyarrow import parquet

    generate(plan_of(), tmp_path / "npz")
    generate(plan_of(kind="parquet", compressed=True), tmp_path / "parquet")
    arrays = arrays_of(tmp_path / "npz")
    (file,) = (tmp_path / "parquet").glob("*.sick_tim571.parquet")
    table = parquet.read_table(file)
    for name in table.column_names:
        column = np.array(table[name].combine_chunks().to_pylist(), dtype=np.float64)
        if name == "seed":
            assert np.array_equal(column, arrays["seeds"][arrays[f"{SCAN}/episode"]])
            continue
        shape = tuple(map(int, filter(None, table.schema.field(name).metadata[b"shape"].decode().split(","))))
        wanted = arrays[f"{SCAN}/{name}"].astype(np.float64)
        assert np.array_equal(column.reshape(len(table), *shape), wanted, equal_nan=True), name
    angles = np.array(table.schema.metadata[b"angles"].split(b","), dtype=float)
    assert np.array_equal(angles, arrays[f"{SCAN}/shared.angles"])


def test_webdataset_samples_hold_the_same(tmp_path: Path) -> None:
    generate(plan_of(), tmp_path / "npz")
    generate(plan_of(kind="webdataset"), tmp_path / "tar")
    arrays = arrays_of(tmp_path / "npz")
    (file,) = (tmp_path / "tar").glob("*.tar")
    with tarfile.open(file) as tar:
        names = tar.getnames()
        keys = list(dict.fromkeys(name.partition(".")[0] for name in names))
        assert len(keys) == len(arrays[f"{SCAN}/episode"])
        for row in (0, 11, len(keys) - 1):
            stream = tar.extractfile(f"{keys[row]}.robot-sick_tim571.ranges.npy")
            assert stream is not None
            assert np.array_equal(np.load(io.BytesIO(stream.read())), arrays[f"{SCAN}/ranges"][row])
            stream = tar.extractfile(f"{keys[row]}.json")
            assert stream is not None
            facts = json.load(stream)
            assert facts["robot-sick_tim571"]["returns"] == arrays[f"{SCAN}/returns"][row].tolist()


def test_episodes_are_recordings(tmp_path: Path) -> None:
    card = generate(plan_of([4], kind="mcap"), tmp_path)
    (file,) = tmp_path.glob("*.mcap")
    assert read_episode(file).digest == simulate(plan_of([4]).variants[0], 4).digest
    assert card.rows == {"episodes": 1}


def test_images_have_boxes_and_masks(tmp_path: Path) -> None:
    trial = load_trial("frontal", duration="1")
    camera = Mount(name="eye", sensor=RGBCamera(width=48, height=32, rate=5.0), z=1.2)
    robot = dataclasses.replace(trial.robots[0], sensors=(camera,))
    plan = GenerationPlan([dataclasses.replace(trial, robots=(robot,))], range(2), coco=True)
    generate(plan, tmp_path)
    coco = json.loads((tmp_path / "coco.json").read_text())
    assert len(coco["images"]) == 2 * 6
    assert [item["id"] for item in coco["images"]] == list(range(1, 13))
    assert all((tmp_path / "images" / item["file_name"]).is_file() for item in coco["images"])
    assert len(coco["annotations"]) >= 12
    for item in coco["annotations"]:
        counts = np.array(item["segmentation"]["counts"])
        mask = np.repeat(np.arange(len(counts)) % 2, counts).reshape(48, 32).T
        rows, columns = np.nonzero(mask)
        box = [columns.min(), rows.min(), columns.max() - columns.min() + 1, rows.max() - rows.min() + 1]
        assert item["bbox"] == box
        assert item["area"] == mask.sum()


def test_a_seed_without_room_is_told(tmp_path: Path) -> None:
    tight = [(0, 0), (1.2, 0), (1.2, 1.2), (0, 1.2)]
    base = load_trial("frontal", duration="1")
    spawner = Spawner(name="s", count=5, zone=tight, goal=tight, radius=0.25)
    robot = dataclasses.replace(base.robots[0], x=-9.0, y=-9.0, goal=RobotGoal(-5.0, -9.0))
    crowded = dataclasses.replace(base, agents=(), spawners=(spawner,), robots=(robot,), stage=Stage())
    fits = [not place(crowded.stage, crowded.spawners, [], seed)[1] for seed in range(60)]
    assert 0 < sum(fits) < 60
    seeds = [fits.index(True), fits.index(False), 61]
    card = generate(GenerationPlan([crowded], seeds), tmp_path)
    assert card.outcomes["impossible"] >= 1
    assert arrays_of(tmp_path)["seeds"].tolist()[0] == seeds[0]
    assert seeds[1] not in arrays_of(tmp_path)["seeds"]


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"kind": "csv"}, "format 'csv' must be one of npz, parquet, webdataset, mcap"),
        ({"seeds": []}, "generated data needs seeds; the list is empty"),
        ({"seeds": [1, 1]}, "seeds: a seed is there twice"),
        ({"coco": True}, "images for COCO need a colour camera, and its robot has none"),
        ({"shard_bytes": 10}, "shard_bytes = 10 must be at least 1000000"),
        ({"sensors": ["sick-tim57"]}, "sensor 'sick-tim57': unknown sensor preset 'sick-tim57'"),
        ({"sensors": ["sick-tim571@fast"]}, "the rate is 'fast', it must be a number"),
        ({"sensors": ["sick-tim571@40"]}, "is shorter than the time step of 0.05 s"),
    ],
)
def test_wrong_plans_are_told(values: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError) as caught:
        GenerationPlan([load_trial("crossing-flows")], **values)
    assert message in str(caught.value)


def test_recipes_can_be_made() -> None:
    for recipe in RECIPES.values():
        trials = [load_trial(name, **values) for name, values in recipe.trials]
        plan = GenerationPlan(trials, range(recipe.seeds), recipe.sensors)
        assert len(set(plan.names)) == len(plan.variants)
