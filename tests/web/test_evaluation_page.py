"""A person's path through the evaluation tab: compare two navigators, look at the failures, watch one."""

import pytest

pytestmark = pytest.mark.live

TAB = "#tab=evaluation"
STATUS = "crowdbot.tab('simulator').status"


@pytest.fixture
def results(page):
    """The tab with a small evaluation that has been run."""
    page.get_by_role("tab", name="Evaluation").click()
    page.get_by_label("Trials").select_option("frontal")
    page.get_by_label("Navigators").fill("straight, orca")
    page.get_by_label("Seeds").fill("0:2")
    page.get_by_role("button", name="Run", exact=True).click()
    page.get_by_role("heading", name="first").wait_for(timeout=300_000)
    return page


def test_navigators_are_compared_and_a_run_is_chosen(results, app):
    page = results
    rows = page.get_by_role("region", name="Table").get_by_role("row")
    assert rows.count() == 3
    page.get_by_role("button", name="2 runs").first.click()
    page.get_by_role("heading", name="frontal, straight").wait_for()
    for seed in (1, 0):  # also right after the run of another one
        page.get_by_role("button", name=f"Watch seed {seed}").focus()
        page.keyboard.press("Enter")
        page.wait_for_function("() => crowdbot.keys.active === 'simulator'")
        page.wait_for_function(f"() => {STATUS}.name === 'evaluations/first/row-1-seed-{seed}.mcap'")
        page.wait_for_function(f"() => {STATUS}.time > 0 && {STATUS}.trial === 'frontal' && {STATUS}.seed === {seed}")
        assert page.evaluate(f"{STATUS}.time > {STATUS}.duration - 6")
        page.get_by_role("tab", name="Evaluation").click()
    assert (app.folder / "evaluations/first/row-1.xml").is_file()
    assert (app.folder / "evaluations/first/report.html").is_file()


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_axe_finds_nothing(results, axe, theme):
    results.evaluate("theme => document.documentElement.dataset.theme = theme", theme)
    results.get_by_role("button", name="2 runs").first.click()
    assert axe(results) == []
