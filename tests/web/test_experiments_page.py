"""A participant's and an operator's path through an experiment in two windows."""

import pytest

pytestmark = pytest.mark.live

TAB = "#tab=experiments"


@pytest.fixture
def experiments(page):
    """The experiments tab of an empty start."""
    page.get_by_role("tab", name="Experiments").click()
    page.get_by_role("heading", name="Start a session").wait_for()
    page.get_by_role("combobox", name="Experiment").select_option("robot-speed")
    return page


def test_a_participant_answers_and_watches_while_the_operator_controls(experiments, browser, app):
    operator = experiments
    participant = browser.new_page()
    participant.goto(app.url + "#tab=experiments&role=participant")
    participant.get_by_text("The experiment has not started yet.").wait_for()

    operator.get_by_label("Speed of the trials").fill("20")
    operator.get_by_role("button", name="Start", exact=True).click()
    participant.get_by_label("How old are you?").wait_for()
    participant.get_by_role("button", name="Continue").click()
    participant.get_by_text("Please answer").wait_for()
    participant.get_by_label("How old are you?").fill("31")
    participant.get_by_label("at least once a month").check()
    participant.get_by_role("button", name="Continue").click()
    participant.get_by_text("First one trial for practice").wait_for()
    participant.get_by_role("button", name="Continue").click()
    participant.wait_for_function("() => crowdbot._views.get('experiments').tab.trial.newest")
    participant.get_by_text("Now the robot meets a person").wait_for()

    operator.get_by_text("alone (trial):").wait_for()
    operator.get_by_role("button", name="Pause").click()
    participant.get_by_text("Please wait.").wait_for()
    operator.get_by_text("State: paused").wait_for()
    operator.get_by_role("button", name="Resume").click()
    participant.get_by_text("Now the robot meets a person").wait_for()

    operator.get_by_role("button", name="Abort").click()
    operator.get_by_label("Reason").fill("the test is over")
    operator.get_by_role("button", name="Abort the session").click()
    participant.get_by_text("The session has ended: the test is over").wait_for()
    operator.get_by_text("State: ended early (the test is over)").wait_for()
    log = next((app.folder / "experiments").glob("*/participant-001/session.jsonl")).read_text()
    assert '"abort"' in log
    assert "the test is over" in log
    participant.close()


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_axe_finds_nothing_on_a_screen(experiments, axe, theme):
    page = experiments
    page.evaluate("theme => document.documentElement.dataset.theme = theme", theme)
    page.get_by_role("button", name="Start", exact=True).click()
    page.get_by_label("How old are you?").wait_for()
    assert axe(page) == []
