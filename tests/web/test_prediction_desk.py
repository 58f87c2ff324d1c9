"""The prediction desk without a browser: the same numbers as the command line, hostile input, files."""

import io
import json
import math
import re
import shlex

import numpy as np
import pandas as pd
import pytest
from prediction_session import DeskCaller

from crowdbot.cli import main
from crowdbot.core import InputError
from crowdbot.data import FILE_OPTIONS, Trajectories, save
from crowdbot.web.prediction import EXAMPLES, PredictorChoice

ORCA = {
    "predictor": "simulated", "model": "orca", "cost": "progressive", "search": "random-search", "budget": 20,
    "values": {"time_horizon": 3.0},
}  # fmt: skip


@pytest.fixture
def desk(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made = DeskCaller(tmp_path / "files")
    yield made
    made.desk.close()


def command_json(capsys, line):
    """Run a copied command with --json and return what it prints."""
    capsys.readouterr()
    assert main([*shlex.split(line)[1:], "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def two_walkers(path, rows=24, **options):
    """Write two people who pass each other."""
    frame = np.repeat(np.arange(rows), 2)
    way = 0.5 * np.repeat(np.arange(rows), 2)
    side = np.tile([0.0, 1.0], rows)
    x = np.where(side > 0, 10.0 - way, way)
    save(Trajectories(np.tile([3, 8], rows), frame, x, side, row_rate=2.5, **options), path)


def test_the_lists_are_those_of_the_command_line(desk, capsys):
    tables = desk("tables")
    for kind in ("models", "costs", "searches", "goals", "predictors", "degradations"):
        capsys.readouterr()
        main(["list", kind, "--json"])
        known = json.loads(capsys.readouterr().out)[kind]
        missing = set(known) - {item["name"] for item in tables[kind]}
        assert missing <= {"simulated", "mixture", "weighted-sum"}, kind
        assert all(item["about"].startswith(known[item["name"]]) for item in tables[kind])
    assert all(
        row["kind"] in ("number", "whole", "switch", "choice", "text")
        for item in tables["models"]
        for row in item["parameters"]
    )
    contact = {"name": "contact", "label": "Contact", "kind": "number", "value": 0.25, "unit": "m"}
    learned = [item["parameters"] for item in tables["predictors"] if item["name"] == "anchor-net"]
    assert all(contact in rows for rows in [tables["crowd"], *learned])


@pytest.mark.parametrize("name", EXAMPLES)
def test_an_example_opens_with_format_time_base_and_units(desk, name):
    found = desk("example", name=name)["recording"]
    assert (found["format"], found["units"], found["dt"], found["robots"]) == ("parquet", "m", 0.4, 1)
    assert found["windows"] == len(found["frames"]) > 20
    assert "simulated" in found["note"]
    assert found["walls"]


@pytest.mark.live
def test_a_run_gives_the_numbers_of_the_copied_command_and_python(desk, capsys):
    desk("example", name="bottleneck")
    desk("add", settings={"predictor": "constant-velocity"})
    desk("add", settings={"predictor": "sampled-constant-velocity", "samples": 4, "values": {"speed_sd": 0.2}})
    desk("add", settings=ORCA)
    assert desk.run(seed=3) == {"problem": "", "cancelled": False}
    assert [row["note"] for row in desk("results")["table"]["rows"]] == ["", "best of 4 per person", ""]
    lines = desk("command_line").splitlines()
    scores = [item["results"]["clean"]["score"] for item in desk.desk.greet()["predictors"]]
    for line, own in zip(lines, scores, strict=True):
        (found,) = command_json(capsys, line)["results"]
        total = found["total"]
        assert [total[key] for key in ("predictor", "ade", "fde", "collisions", "horizon")] == [
            own[key] for key in ("predictor", "ade", "fde", "collisions", "horizon")
        ]
    text = desk("python").replace("print(result.score)", "found.append(result.score)")
    space = {"found": []}
    exec(compile(text, "copied.py", "exec"), space)
    assert [one.ade for one in space["found"]] == [score["ade"] for score in scores]


@pytest.mark.live
def test_each_frame_has_a_line_with_cost_iterations_and_time(desk):
    desk("example", name="bottleneck")
    key = desk("add", settings=ORCA)
    desk.run()
    (log,) = desk("log")
    assert log["key"] == key
    assert [line[0] for line in log["lines"]] == desk.desk.greet()["recording"]["frames"]
    _, people, cost, evaluations, seconds, ade = log["lines"][5]
    assert (people > 0, cost > 0, evaluations, seconds > 0, ade > 0) == (True, True, 20, True, True)
    sent = [line for data in desk.events("lines") for line in data["lines"]]
    assert sent == log["lines"]
    assert desk("series", variable="cost")["rows"][0]["values"][5] == cost


@pytest.mark.live
def test_degraded_input_gives_the_numbers_of_crowdbot_degrade(desk, capsys):
    desk("example", name="bottleneck")
    desk("add", settings={"predictor": "constant-velocity"})
    assert (
        desk("degrade", name="gaussian-noise", values={"sd": 0.1})["degradation"]["text"] == "gaussian-noise(sd=0.1 m)"
    )
    desk.run(seed=1)
    rows = {row["input"]: row for row in desk("results")["table"]["rows"]}
    results = desk.desk.greet()["predictors"][0]["results"]
    clean, degraded = (results[name]["score"]["ade"] for name in ("clean", "degraded"))
    assert rows["degraded"]["difference"] == degraded - clean > 0.1
    assert rows["clean"]["difference"] is None
    (found,) = command_json(capsys, desk("command_line", degraded=True))["degradations"]["gaussian-noise"]["rows"]
    assert found["score"]["ade"] == degraded
    text = desk("python", degraded=True).replace("print(scores[0].score)", "found.append(scores[0].score)")
    space = {"found": []}
    exec(compile(text, "copied.py", "exec"), space)
    assert [one.ade for one in space["found"]] == [degraded]
    desk("remove", key=desk.predictor("constant-velocity")["key"])
    desk("add", settings={"predictor": "simulated", "model": "social-force", "values": {"relaxation_time": 0.7}})
    desk.run(seed=1)
    line = desk("command_line", degraded=True)
    assert "--set-predictor relaxation_time=0.7" in line
    (found,) = command_json(capsys, line)["degradations"]["gaussian-noise"]["rows"]
    assert found["score"]["ade"] == desk.desk.greet()["predictors"][0]["results"]["degraded"]["score"]["ade"]
    desk("degrade", name="", values={})
    assert list(desk.desk.greet()["predictors"][0]["results"]) == ["clean"]


@pytest.mark.live
def test_a_calibration_gives_the_numbers_of_crowdbot_calibrate(desk, capsys):
    desk("example", name="bottleneck")
    key = desk("add", settings={**ORCA, "budget": 5})
    desk("calibrate", key=key)
    desk.wait(0)
    fit = desk.desk.greet()["predictors"][0]["fit"]
    (found,) = command_json(capsys, desk("calibrate_line", key=key)).values()
    assert {row["name"]: {"median": row["median"], "sd": row["sd"]} for row in fit["parameters"]} == found["parameters"]
    assert [fit[name] for name in ("cost", "given_cost", "persons")] == [
        found[name] for name in ("cost", "given_cost", "persons")
    ]


@pytest.mark.live
def test_a_person_has_errors_and_the_fit_of_the_frame(desk):
    desk("example", name="bottleneck")
    desk("add", settings=ORCA)
    desk.run()
    _, future = desk.desk.board.windows()
    index = 4
    id = int(future.id[index][future.scored[index]][0])
    found = desk("person", index=index, id=id)
    (row,) = found["results"]
    fit = {item["name"]: item for item in row["parameters"]}
    assert found["scored"]
    assert (fit["time_horizon"]["given"], fit["radius"]["unit"]) == (3.0, "m")
    series = desk("series", variable="ade", person=id)["rows"][0]["values"]
    assert series[index] == row["ade"]
    assert np.mean([item for item in series if item is not None]) == pytest.approx(row["mean_ade"])
    assert (
        desk("series", variable="time_horizon", person=id)["rows"][0]["values"][index] == fit["time_horizon"]["value"]
    )
    with pytest.raises(InputError, match="person 999 is not in this frame"):
        desk("person", index=index, id=999)


@pytest.mark.live
def test_the_frame_of_a_window_has_people_and_paths(desk):
    desk("example", name="bottleneck")
    desk("add", settings={"predictor": "sampled-constant-velocity", "samples": 3})
    desk.run()
    from crowdbot.web import StateFrame

    past, future = desk.desk.board.windows()
    frame = StateFrame.decode(desk.desk.resource("window", {"index": "6"}).data)
    who = np.flatnonzero(past.present[6, -1])
    assert frame.arrays["ids"].tolist() == past.id[6, who].tolist()
    assert frame.arrays["past"].reshape(len(who), 8, 2)[:, -1] == pytest.approx(past.position[6, -1, who])
    assert np.isnan(frame.arrays["truth"]).any(axis=1).sum() == (~future.present[6][:, who]).sum()
    assert frame.arrays["path.0"].shape == (3 * 12 * len(who), 2)
    assert frame.arrays["mass.0"].sum() == pytest.approx(1.0)
    assert "path.0" not in StateFrame.decode(desk.desk.resource("window", {"index": "6", "hide": "p1"}).data).arrays
    with pytest.raises(InputError, match="window 99 does not exist; there are 34"):
        desk.desk.resource("window", {"index": "99"})


def test_time_base_units_and_rows_can_be_corrected(desk):
    two_walkers(desk.folder / "two.csv")
    first = desk("open", file="two.csv")["recording"]
    assert (first["format"], first["dt"]) == ("csv", pytest.approx(0.4))
    options = {"fps": 5, "units": "cm", "observe": 4, "predict": 6}
    second = desk("open", file="two.csv", options=options)["recording"]
    assert (second["dt"], second["observe"], second["predict"]) == (0.2, 4, 6)
    assert second["summary"]["mean_speed"] == pytest.approx(first["summary"]["mean_speed"] * 2 / 100)
    desk("add", settings={"predictor": "constant-velocity"})
    assert desk("command_line") == (
        "crowdbot predict --data files/two.csv --fps=5.0 --units=cm --observe 4 --predict 6"
        " --predictor constant-velocity"
    )


def foreign_table(path, head="", per=1.0):
    """Write two people in columns of unusual names or without names, in pixels if ``per`` is pixels per metre."""
    rows = [
        (0.4 * k, 3 + 5 * side, per * (10 - 0.5 * k if side else 0.5 * k), per * side)
        for k in range(24)
        for side in (0, 1)
    ]
    path.parent.mkdir(exist_ok=True)
    path.write_text(head + "".join(f"{t:.1f};{who};{x};{y}\n" for t, who, x, y in rows))


@pytest.mark.parametrize(
    ("head", "per", "options", "words"),
    [
        ("when;who;east;north\n", 1.0, {"columns": "id=who time=when x=east y=north"},
         "--columns id=who time=when x=east y=north"),
        ("", 1.0, {"columns": "time=1 id=2 x=3 y=4"}, "--columns time=1 id=2 x=3 y=4"),
        ("time;id;x;y\n", 50.0, {"scale": 0.02}, "--scale=0.02"),
        ("time;id;x;y\n", 50.0, {"homography": "H.txt"}, "--homography=files/H.txt"),
        ("time;id;x;y\n", 1000.0, {"units": "mm", "agents": "all", "format": "csv"},
         "--format=csv --units=mm --agents=all"),
        ("time;id;x;y\n", 0.001, {"units": "km", "topic": "", "frame": None}, "--units=km"),
    ],
)  # fmt: skip
def test_every_option_of_the_command_line_is_in_the_form(desk, capsys, head, per, options, words):
    foreign_table(desk.folder / "own.csv", head, per)
    (desk.folder / "H.txt").write_text("0.02 0 0\n0 0.02 0\n0 0 1\n")
    assert [row["name"] for row in desk("file_options")] == [*FILE_OPTIONS]
    facts = desk("open", file="own.csv", options=options)["recording"]
    assert facts["summary"]["mean_speed"] == pytest.approx(1.25)
    assert {name: value for name, value in facts["options"].items() if name in options} == options
    desk("add", settings={"predictor": "constant-velocity"})
    line = desk("command_line")
    assert line == f"crowdbot predict --data files/own.csv {words} --predictor constant-velocity"
    assert command_json(capsys, line)["results"]
    again = DeskCaller(desk.folder)
    assert again("restore")["recording"]["options"] == facts["options"]
    again.desk.close()


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"columns": "who"}, "columns who: write NAME=COLUMN"),
        ({"columns": "speed=3"}, "columns: unknown 'speed'"),
        ({"scale": 0.02, "homography": "H.txt"}, "coordinates have one scale"),
        ({"homography": "../H.txt"}, "is outside the folder of the app"),
        ({"homography": "none.txt"}, "does not exist"),
        ({"homography": "own.csv"}, "the homography own.csv line 1 has 1 columns"),
        ({"scale": "wide"}, "scale = 'wide' must be a number"),
        ({"topic": "/people"}, "they need a ROS bag"),
        ({"frame": 3}, "frame = 3 must be a word"),
        ({"units": "parsec"}, "unknown units 'parsec'"),
    ],
)
def test_wrong_options_of_a_file_are_refused(desk, options, sentence):
    foreign_table(desk.folder / "own.csv", "time;id;x;y\n")
    (desk.folder / "H.txt").write_text("1 0 0\n0 1 0\n0 0 1\n")
    with pytest.raises(InputError, match=re.escape(sentence)):
        desk("open", file="own.csv", options=options)


@pytest.mark.live
def test_a_run_can_be_cancelled_and_keeps_its_results(desk):
    desk("example", name="crossing-flows")
    desk("add", settings={**ORCA, "budget": 3000})
    desk("run")
    import time

    end = time.monotonic() + 180
    while not desk.events("lines"):
        if time.monotonic() > end:
            raise TimeoutError
        time.sleep(0.01)
    with pytest.raises(InputError, match="a run is going on"):
        desk("run")
    desk("cancel")
    assert desk.events("ended")[-1] == {"problem": "", "cancelled": True}
    (one,) = desk.desk.greet()["predictors"]
    assert one["results"]["clean"]["state"] == "cancelled"
    assert 0 < one["results"]["clean"]["done"] < one["results"]["clean"]["windows"]
    (row,) = desk("results")["table"]["rows"]
    assert row["note"].endswith("frames")


@pytest.mark.live
def test_a_predictor_that_fails_says_why_and_the_others_go_on(desk):
    desk("example", name="bottleneck")
    desk("add", settings={**ORCA, "goal": "learned-destinations"})
    desk("add", settings={"predictor": "kalman"})
    desk.run()
    states = [item["results"]["clean"] for item in desk.desk.greet()["predictors"]]
    assert [state["state"] for state in states] == ["failed", "done"]
    assert "no learning part" in states[0]["problem"]


@pytest.mark.live
def test_results_can_be_saved_as_tables(desk):
    desk("example", name="bottleneck")
    with pytest.raises(InputError, match="there is no result yet"):
        desk.desk.resource("frames.csv", {})
    desk("add", settings={"predictor": "constant-velocity"})
    desk.run()
    frames = pd.read_csv(io.BytesIO(desk.desk.resource("frames.csv", {}).data))
    same = pd.read_parquet(io.BytesIO(desk.desk.resource("frames.parquet", {}).data))
    assert frames.frame.tolist() == same.frame.tolist() == desk.desk.greet()["recording"]["frames"]
    people = pd.read_csv(io.BytesIO(desk.desk.resource("people.csv", {}).data))
    assert len(pd.read_parquet(io.BytesIO(desk.desk.resource("people.parquet", {}).data))) == len(people)
    score = desk.desk.greet()["predictors"][0]["results"]["clean"]["score"]
    assert (len(people), people.ade.mean()) == (score["persons"], pytest.approx(score["ade"]))
    gif = desk.desk.resource("animation.gif", {"index": "2"})
    assert (gif.kind, gif.data[:6]) == ("image/gif", b"GIF89a")
    film = desk.desk.resource("animation.mp4", {"index": "2"})
    assert (film.kind, film.data[4:8], film.name[-4:]) == ("video/mp4", b"ftyp", ".mp4")


def test_hostile_files_and_names_are_refused(desk, tmp_path):
    (tmp_path / "secret.csv").write_text("0 1 0.0 0.0\n10 1 0.5 0.0\n")
    with pytest.raises(InputError, match="outside the folder of the app"):
        desk("open", file="../secret.csv")
    (desk.folder / "bad.parquet").write_bytes(b"PAR1" + bytes(range(256)) * 40)
    with pytest.raises(InputError, match="bad.parquet .*truncated or damaged"):
        desk("open", file="bad.parquet")
    (desk.folder / "<script>.txt").write_text("hello <script>alert(1)</script>\n")
    with pytest.raises(InputError, match="of an unknown format"):
        desk("open", file="<script>.txt")
    with pytest.raises(InputError, match="example '../x' does not exist"):
        desk("example", name="../x")
    assert desk.desk.greet()["recording"] is None


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"predictor": "own.py:Mine"}, "unknown predictor 'own.py:Mine'"),
        ({"predictor": "simulated", "model": "own.py:Mine"}, "unknown model"),
        (
            {"predictor": "social-ways", "values": {"checkpoint": "/etc/passwd"}},
            "checkpoint = '/etc/passwd' is unknown",
        ),
        ({"predictor": "anchor-net", "values": {"file": "/etc/passwd"}}, "has no parameter 'file'"),
        ({"predictor": "kalman", "values": {"speed": "fast"}}, "kalman speed: 'fast' is not a number"),
        ({"predictor": "simulated", "values": {"time_horizon": -1}}, "time_horizon = -1"),
        ({"predictor": "kalman", "samples": 1000}, "samples = 1000 must be a whole number from 1 to 100"),
        ({"predictor": "simulated", "search": "genetic", "budget": 10**9}, "budget = 1000000000 must be"),
        ({"predictor": "simulated", "search": "genetic", "free": ["speed"]}, "no parameter 'speed' to calibrate"),
        ({"predictor": "kalman", "evil": 1}, "a predictor has no setting 'evil'"),
    ],
)
def test_a_wrong_predictor_is_refused_with_a_sentence(desk, settings, message):
    with pytest.raises(InputError, match=message):
        desk("add", settings=settings)
    assert desk.desk.greet()["predictors"] == []


def test_the_same_predictor_is_added_once(desk):
    desk("add", settings=ORCA)
    with pytest.raises(InputError, match="is in the list already"):
        desk("add", settings=ORCA)
    desk("remove", key="p1")
    with pytest.raises(InputError, match="predictor 'p1' is not in the list"):
        desk("remove", key="p1")


def test_the_words_of_a_choice_make_the_same_predictor():
    settings = {
        **ORCA,
        "free": ["radius"],
        "patience": 5,
        "tolerance": 0.01,
        "values": {"radius": 0.3, "time_horizon": 1.0},
    }
    choice = PredictorChoice.of(settings)
    from crowdbot.cli import predict
    from crowdbot.cli.parser import CommandParser
    from crowdbot.cli.schemes import predictor_specs

    parser = CommandParser()
    predict.arguments(parser)
    (spec,) = predictor_specs(parser.parse_args(["--data", "x", *choice.words()]))
    assert spec == choice.spec()
    assert PredictorChoice.of(choice.settings | {"values": settings["values"]}) == choice


def test_a_picture_is_put_on_the_ground(desk):
    from PIL import Image

    two_walkers(desk.folder / "two.csv")
    Image.new("RGB", (200, 100), "green").save(desk.folder / "ground.png")
    desk("open", file="two.csv")
    with pytest.raises(InputError, match="give nine numbers of a homography"):
        desk("background", file="ground.png")
    found = desk("background", file="ground.png", homography="0.1")["recording"]
    assert found["background"]["bounds"] == pytest.approx([0.0, -10.0, 20.0, 0.0])
    picture = Image.open(io.BytesIO(desk.desk.resource("background.png", {}).data))
    assert picture.size == (1600, 800)
    assert picture.getpixel((800, 400)) == (0, 128, 0)
    for text, message in (
        ("1 2 3", "has 9 numbers"),
        ("a", "expected nine numbers"),
        ("1 0 0 0 1 0 -0.01 0 1", "horizon"),
    ):
        with pytest.raises(InputError, match=message):
            desk("background", file="ground.png", homography=text)
    (desk.folder / "no.png").write_bytes(b"\x89PNG\r\n\x1a\nnothing")
    with pytest.raises(InputError, match=r"no.png is not a picture"):
        desk("background", file="no.png", homography="0.1")


@pytest.mark.live
def test_numbers_that_are_not_finite_reach_the_page_as_gaps(desk):
    two_walkers(desk.folder / "two.csv")
    desk("open", file="two.csv")
    desk("add", settings={"predictor": "constant-velocity"})
    desk.run()
    assert desk("series", variable="cost")["rows"][0]["values"] == [None] * 5
    assert math.isfinite(desk("results")["horizon"]["rows"][0]["values"][0])


def test_a_server_that_is_started_again_has_the_recording_and_the_predictors(desk):
    desk("example", name="bottleneck")
    desk("add", settings={"predictor": "constant-velocity"})
    desk("add", settings={"predictor": "simulated", "model": "social-force", "cost": "progressive", "budget": 20})
    again = DeskCaller(desk.folder)
    assert again.desk.greet()["stored"]
    assert again.desk.greet()["recording"] is None
    again("restore")
    before, after = desk.desk.greet(), again.desk.greet()
    assert after["recording"]["path"] == before["recording"]["path"]
    assert [item["name"] for item in after["predictors"]] == [item["name"] for item in before["predictors"]]
    assert not after["stored"]


@pytest.mark.live
def test_a_server_that_is_started_again_has_the_results(desk):
    desk("example", name="bottleneck")
    desk("add", settings={"predictor": "constant-velocity", "samples": 1})
    desk("add", settings=ORCA | {"budget": 4})
    desk("degrade", name="late-start", values={"rows": 2})
    desk.run(seed=3)
    asked = ("log", "results", "variables")
    before = {name: desk(name) for name in asked}
    key = desk.desk.greet()["predictors"][1]["key"]
    who = int(desk.desk.board.member(key).results["clean"].forecast(2)[0][0])
    person, series = desk("person", index=2, id=who), desk("series", variable="ade")
    frame = desk.desk.resource("window", {"index": "2", "input": "degraded"}).data
    again = DeskCaller(desk.folder)
    again("restore")
    assert {name: again(name) for name in asked} == before
    assert (again("person", index=2, id=who), again("series", variable="ade")) == (person, series)
    assert again.desk.resource("window", {"index": "2", "input": "degraded"}).data == frame
    facts = [item.desk.greet() for item in (desk, again)]
    assert facts[0]["predictors"] == facts[1]["predictors"]
    assert facts[1]["predictors"][0]["results"]["degraded"]["score"]["ade"] > 0.0
    assert facts[0]["recording"] == facts[1]["recording"]
    assert again("command_line") == desk("command_line")


@pytest.mark.live
def test_results_that_do_not_fit_or_are_damaged_are_left_out(desk):
    desk("example", name="bottleneck")
    desk("add", settings={"predictor": "constant-velocity"})
    desk.run()
    draft = desk.folder / ".crowdbot-drafts" / "prediction.json"
    known = json.loads(draft.read_text())
    draft.write_text(json.dumps({**known, "options": {**known["options"], "every": 2}}))
    other = DeskCaller(desk.folder)
    other("restore")
    assert other.desk.greet()["recording"]["windows"] < known_windows(desk)
    assert other.predictor("constant")["results"] == {}
    draft.write_text(json.dumps(known))
    file = draft.with_name("prediction-results.npz")
    whole = file.read_bytes()
    for damaged in (b"", whole[: len(whole) // 2], bytes(200)):
        file.write_bytes(damaged)
        other = DeskCaller(desk.folder)
        other("restore")
        assert other.predictor("constant")["results"] == {}


def known_windows(desk):
    return desk.desk.greet()["recording"]["windows"]
