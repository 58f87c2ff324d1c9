"""A participant with an emulated headset goes through an experiment on the board in the virtual room."""

import json

import pytest
from vr_headset import call, desks, emulated_headsets, enter, point, wait

from crowdbot.experiments import SYMPTOMS, load_experiment, read_log, sickness_scores
from crowdbot.recording import read_episode, replay
from crowdbot.vr import VrServer

pytestmark = [pytest.mark.live, pytest.mark.xdist_group("headset")]

TRIAL = """<trial name="meet" duration="{duration}"><stage/><crowd type="orca"/>
<avatar name="guest" source="external" x="1" y="0.5" body="man-20"/><agent x="4" y="1.2" goal="-5,1.2"/>
<robot name="robot" type="turtlebot2" x="4" y="-1"><goal x="-5" y="-1"/><navigator type="straight" speed="0.3"/></robot>
<end goal="false" collision="false"/></trial>"""
EXPERIMENT = """<experiment name="visit"><instructions name="consent" text="You meet a robot. Stop at any time.">
<choice name="agree" text="Do you take part?"><option value="yes" text="Yes, I do"/>
<option value="no" text="No" ends="true"/></choice>
<number name="age" text="How old are you?" unit="years" min="18" max="120" integer="true"/></instructions>
<block name="main"><trial name="meet" source="meet.xml"/><after name="rating">
<scale name="comfort" text="How comfortable was it?" low="1" high="5" low-text="not at all" high-text="very"/></after>
</block>{symptoms}</experiment>"""


def symptoms():
    """Return the questions on simulator sickness of the built-in experiment, after the trial."""
    screen = next(ending for ending in load_experiment("leader-follower").endings if ending.name == "sickness_after")
    rows = "".join(
        f'<scale name="{question.name}" text="{question.text}" low="0" high="3"/>' for question in screen.questions
    )
    return f'<ending name="sickness" text="How strongly do you feel each of these now?">{rows}</ending>'


@pytest.fixture
def app(tmp_path, serve):
    folder = tmp_path / "files"
    folder.mkdir()
    (folder / "first.xml").write_text(TRIAL.format(duration=600))
    (folder / "meet.xml").write_text(TRIAL.format(duration=2))
    (folder / "visit.xml").write_text(EXPERIMENT.format(symptoms=symptoms()))
    with serve(folder, desks("first.xml"), VrServer) as server:
        yield server


@pytest.fixture
def headset(browser, app, modules):
    with emulated_headsets(browser, app, modules) as opened:
        yield opened


def test_a_participant_answers_and_moves_from_consent_to_the_end(headset, app, browser):
    page = headset()
    wait(page, "crowdbotVr.state !== null")
    call(app, "experiments.open", experiment="visit.xml", participant=1)
    enter(page, app)
    wait(page, "crowdbotVr.scene.empty")
    point(page, "Continue")
    wait(page, "crowdbotVr.board.problem === 'Please answer: Do you take part?'")
    point(page, "Yes, I do")
    wait(page, "crowdbotVr.experiment.answers.agree === 'yes'")  # the operator sees it, too
    point(page, "point here to write")
    for key in ("3", "1", "Done"):
        point(page, key)
    page.evaluate("device.primaryInputMode = 'hand'")
    point(page, "Continue", hand=True)
    page.evaluate("device.primaryInputMode = 'controller'")
    wait(page, "crowdbotVr.experiment.phase === 'running' && !crowdbotVr.board.shown && !crowdbotVr.scene.empty")
    wait(page, "crowdbotVr.experiment.phase === 'screen' && crowdbotVr.board.shown")
    point(page, "4")
    point(page, "Continue")
    wait(page, "crowdbotVr.board.pages > 1")
    shown = set()
    while len(shown) < len(SYMPTOMS):
        boxes = "crowdbotVr.board.boxes.filter((one) => one.action?.[2] === 1)"
        names = page.evaluate(f"{boxes}.map((one) => one.action[1])")
        assert names
        for name in names:  # pointing is tried above: sixteen more answers are given as the board takes them
            page.evaluate(
                "name => crowdbotVr.board.press(((one) => ({x: one.x + 5, y: one.y + 5}))"
                "(crowdbotVr.board.boxes.find((one) => one.action?.[1] === name && one.action[2] === 1)))",
                name,
            )
        shown.update(names)
        point(page, "More" if len(shown) < len(SYMPTOMS) else "Continue")
    wait(page, "crowdbotVr.experiment.phase === 'done'")
    wait(page, "crowdbotVr.board.screen?.text.startsWith('The session is complete')")

    folder = app.folder / "experiments" / "visit" / "participant-001"
    given = [json.loads(line) for line in (folder / "answers.jsonl").read_text().splitlines()]
    answers = {item["question"]: item["answer"] for item in given}
    assert (answers["agree"], answers["age"]) == ("yes", 31)
    assert sickness_scores(answers)["total"] == 78.54
    records = read_log(folder / "session.jsonl")
    assert [record["value"] for record in records if record.get("question") == "comfort"] == [4]
    assert sum(record.get("event") == "answered" for record in records) == 3 + len(SYMPTOMS)
    episode = folder / "001-meet" / "episode.mcap"
    assert {order.avatar for _, order in read_episode(episode).orders} == {"guest"}
    assert replay(episode).equal
    assert (folder / "001-meet" / "guest.headset").stat().st_size > 1000
