"""The editor without a browser: edits, checks, conflicts, people, files."""

import asyncio

import pytest

from crowdbot.core import InputError, TrialError, parse_xml
from crowdbot.trials import builtin_trials, expand_spawners, load_trial, parse_trial, trial_xml
from crowdbot.web import AppSession, Workspace
from crowdbot.web.editor import EditHistory, EditorDesk, edit_history, element_table
from crowdbot.web.editor.editor_desk import EMPTY


@pytest.fixture
def session(tmp_path):
    loop = asyncio.new_event_loop()
    session = AppSession("main", Workspace(tmp_path / "files"), (EditorDesk,), loop)
    yield session
    session.close()
    loop.close()


@pytest.fixture
def desk(session):
    return session.desk("editor")


def test_an_empty_trial_becomes_one_that_runs(desk):
    state = desk.greet()
    assert state["problems"] == []
    state = desk.insert([0], '<wall points="0,0 9,0"/>', state["revision"])
    state = desk.insert([], '<spawner count="3" zone="0,1 2,1 2,3 0,3" goal="7,1 8,1 8,3 7,3"/>', state["revision"])
    assert state["problems"] == []
    trial = parse_trial(state["text"])
    assert (len(trial.stage.walls), trial.spawners[0].count) == (1, 3)


def test_problems_are_those_of_check_and_stand_at_their_elements(desk):
    state = desk.start("crossing-flows")
    wrong = desk.change([{"path": [2], "name": "count", "value": "-3"}], state["revision"])
    with pytest.raises(TrialError) as error:
        parse_trial(wrong["text"])
    assert [item["message"] for item in wrong["problems"]] == list(error.value.problems)
    assert wrong["problems"][0]["path"] == [2]
    assert "must be at least 0" in wrong["problems"][0]["message"]
    assert desk.undo()["problems"] == []


def test_text_that_is_not_xml_keeps_the_text_and_names_the_line(desk):
    state = desk.write("<trial>\n<wall", desk.greet()["revision"])
    assert state["tree"] is None
    assert state["text"] == "<trial>\n<wall"
    assert state["problems"][0]["line"] == 2
    with pytest.raises(InputError, match="not well-formed XML; correct it first"):
        desk.insert([], "<a/>", state["revision"])


def test_an_edit_of_an_older_revision_is_refused(desk):
    first = desk.greet()["revision"]
    state = desk.change([{"path": [], "name": "duration", "value": "7"}], first)
    with pytest.raises(InputError, match="changed in another window"):
        desk.change([{"path": [], "name": "duration", "value": "8"}], first)
    assert desk.greet()["text"] == state["text"]


@pytest.mark.parametrize("name", ["crossing-flows", "bottleneck", "frontal"])
def test_a_spawner_becomes_the_people_that_the_run_draws(desk, name):
    state = desk.start(name)
    trial = load_trial(name)
    while any(item["tag"] == "spawner" for item in state["tree"]["children"]):
        number = [item["tag"] for item in state["tree"]["children"]].index("spawner")
        state = desk.expand([number], trial.seed, state["revision"])
    made = parse_trial(state["text"])
    assert len(made.agents) == sum(spawner.count for spawner in trial.spawners)
    if len(trial.spawners) == 1:
        same = expand_spawners(trial, trial.seed)
        assert [(agent.x, agent.y) for agent in made.agents] == [(agent.x, agent.y) for agent in same.agents]


def test_single_people_become_a_spawner(desk):
    state = desk.start("crossing-flows")
    state = desk.expand([2], 1, state["revision"])
    paths = [[i] for i, item in enumerate(state["tree"]["children"]) if item["tag"] == "agent"]
    state = desk.gather(paths, state["revision"])
    spawner = parse_trial(state["text"]).spawners[-1]
    assert (spawner.count, state["problems"]) == (20, [])
    with pytest.raises(InputError, match="choose one or more agents"):
        desk.gather([[0]], state["revision"])


def test_the_preview_shows_the_start_of_the_run_and_ways_around_walls(desk):
    desk.start("crossing-flows")
    shown = desk.preview()
    assert len(shown["people"]) == 40
    ways = (
        desk.write(
            '<trial name="t" duration="9"><stage><wall points="2,-3 2,3"/></stage><crowd type="orca"/>'
            '<agent x="0" y="0" goal="4,0"/></trial>',
            desk.greet()["revision"],
        )
        and desk.preview()["ways"]
    )
    assert ways[0][0] == [0.0, 0.0]
    assert ways[0][-1] == [4.0, 0.0]
    assert any(abs(y) > 3 for _, y in ways[0])


@pytest.mark.parametrize("name", builtin_trials()[::9])
def test_a_builtin_trial_opens_without_problems(desk, name):
    state = desk.start(name)
    assert state["problems"] == []
    assert state["text"] == trial_xml(load_trial(name))


def test_files_are_saved_and_opened_in_the_folder_only(desk, session):
    desk.start("frontal")
    assert desk.save("mine")["file"] == "mine.xml"
    text = (session.workspace.folder / "mine.xml").read_bytes().decode()
    assert text == trial_xml(load_trial("frontal"))
    assert desk.sources()["files"] == ["mine.xml"]
    desk.start()
    assert desk.start(file="mine.xml")["text"] == text
    for wrong in ("../mine", "/tmp/x"):
        with pytest.raises(InputError, match="outside the folder"):
            desk.save(wrong)
    with pytest.raises(InputError, match="outside the folder"):
        desk.start(file="../../etc/passwd")
    with pytest.raises(InputError, match="did you mean 'frontal'"):
        desk.start("frontl")


def test_code_of_a_trial_is_not_run_by_the_check(desk, session):
    (session.workspace.folder / "mine.py").write_text("raise SystemExit('run')\n")
    state = desk.start("frontal")
    number = [item["tag"] for item in state["tree"]["children"]].index("robot")
    inner = [item["tag"] for item in state["tree"]["children"][number]["children"]].index("navigator")
    row = {"path": [number, inner], "name": "type", "value": "mine.py:Mine"}
    state = desk.change([row], state["revision"])
    assert "mine.py" in state["text"]


def test_the_table_has_the_elements_and_attributes_of_the_written_trials():
    table = element_table()
    for name in builtin_trials()[::5]:
        missing = list(unknown(parse_xml(trial_xml(load_trial(name)).encode(), name), table["Trial"], table))
        assert missing == []


def unknown(element, kind, table):
    known = {row["name"] for row in kind["attributes"]}
    if "types" in kind:
        known |= {"type", *(row["name"] for row in kind["types"].get(element.attributes["type"], kind)["attributes"])}
    yield from ((element.tag, attribute) for attribute in element.attributes if attribute not in known)
    for child in element.children:
        yield from unknown(child, table[kind["children"][child.tag]], table)


def test_a_picture_of_a_floor_plan_becomes_the_stage(desk, session):
    from PIL import Image

    picture = Image.new("L", (80, 40), 255)
    picture.paste(0, (38, 0, 42, 25))  # a wall from above
    picture.save(session.workspace.folder / "plan.png")
    name = desk.floor("plan.png", 0.1)
    state = desk.change([{"path": [0], "name": "map", "value": name}], desk.greet()["revision"])
    assert state["problems"] == []
    (ring,) = state["rings"]
    x, y = zip(*ring, strict=True)
    assert (min(x), max(x), min(y), max(y)) == pytest.approx((3.8, 4.2, 1.5, 4.0), abs=0.11)


@pytest.mark.parametrize(
    ("data", "size", "sentence"),
    [
        (b"no picture", 0.1, "plan.png is not a PNG or JPEG picture"),
        (b"", 0.1, "plan.png is not a PNG or JPEG picture"),
        (b"no picture", 0.0, "size of a pixel = 0 m: expected 0.001 to 10 m"),
        (b"no picture", float("nan"), "size of a pixel = nan m"),
    ],
)
def test_other_pictures_are_refused(desk, session, data, size, sentence):
    (session.workspace.folder / "plan.png").write_bytes(data)
    with pytest.raises(InputError, match=sentence):
        desk.floor("plan.png", size)


def test_a_server_that_is_started_again_can_undo_and_redo(session):
    desk = session.desk("editor")
    texts = [EMPTY.replace("60", str(seconds)) for seconds in (10, 20, 30, 40)]
    for text in texts:
        desk.write(text, desk.greet()["revision"])
    desk.undo()
    again = EditorDesk(session)  # as another server makes it
    assert [again.undo()["text"] for _ in range(3)] == [texts[1], texts[0], EMPTY]
    again.start("frontal")
    again.undo()
    third = EditorDesk(session)
    assert (third.greet()["undo"], third.greet()["redo"]) == (False, True)
    assert '<trial name="frontal"' in third.redo()["text"]


@pytest.mark.parametrize(
    "values",
    [{"texts": []}, {"texts": ["a"], "now": 1}, {"texts": ["a"], "now": True}, {"texts": ["a", 1], "now": 0},
     {"now": 0}, {"texts": ["long"], "now": 0}, {"texts": "ab", "now": 0}],
)  # fmt: skip
def test_a_damaged_history_is_not_restored(values):
    assert EditHistory.restored(values, longest=3) is None


def test_of_a_long_history_the_texts_nearest_to_the_present_one_are_stored(monkeypatch):
    monkeypatch.setattr(edit_history, "STORED", 10)
    history = EditHistory("1st")
    for text in ("2nd", "3rd", "4th"):
        history.add(text)
    assert history.stored() == {"texts": ["2nd", "3rd", "4th"], "now": 2}
    history.undo(), history.undo(), history.undo()
    assert history.stored() == {"texts": ["1st", "2nd", "3rd"], "now": 0}
    history.add("longer than all")
    assert history.stored() == {"texts": ["longer than all"], "now": 0}


def test_a_server_that_is_started_again_has_the_text(tmp_path):
    loop = asyncio.new_event_loop()
    for text in ("<trial", '<trial name="mine" duration="9" seed="1">\n  <stage/>\n</trial>\n'):
        first = AppSession("main", Workspace(tmp_path), (EditorDesk,), loop)
        first.desk("editor").write(text, first.desk("editor").greet()["revision"])
        second = AppSession("main", Workspace(tmp_path), (EditorDesk,), loop)
        assert second.desk("editor").greet()["text"] == text
    (tmp_path / ".crowdbot-drafts" / "editor.json").write_text("[")
    assert "new-trial" in AppSession("main", Workspace(tmp_path), (EditorDesk,), loop).desk("editor").greet()["text"]
    loop.close()
