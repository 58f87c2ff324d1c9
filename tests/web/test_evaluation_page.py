"""A person's path through the evaluation tab: compare two navigators, look at the failures, watch one."""

import pytest
from playwright.sync_api import expect

pytestmark = pytest.mark.live

TAB = "#tab=evaluation"
SHOWN = """<trial name="shown" duration="1" seed="1"><stage/><crowd type="orca"/><agent x="0" y="0" goal="4,0"/>
<robot x="0" y="3"><goal x="9" y="3"/><drive type="differential-drive"/><navigator type="straight"/></robot>
<end goal="false"/></trial>"""
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
    expect(rows).to_have_count(3)
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


def test_robots_are_named_checked_and_compared(page):
    page.get_by_role("tab", name="Evaluation").click()
    page.get_by_label("Trials").select_option("doorway")
    page.get_by_label("Navigators").fill("straight")
    page.get_by_label("Seeds").fill("0:2")
    robots = page.get_by_role("combobox", name="Robots")
    robots.fill("wheelchair, ")
    expect(page.locator("#known-robots option")).not_to_have_count(0)
    offered = page.locator("#known-robots option").evaluate_all("all => all.map((one) => one.value)")
    assert "wheelchair, pepper" in offered
    assert "wheelchair, wheelchair" not in offered
    robots.fill("wheelchair, peper")
    page.get_by_role("button", name="Run", exact=True).click()
    page.get_by_text("did you mean 'pepper'").wait_for()
    expect(robots).to_have_attribute("aria-invalid", "true")
    expect(robots).to_be_focused()
    assert page.get_by_role("button", name="first").count() == 0  # nothing has been run
    robots.fill("wheelchair, pepper")
    page.get_by_role("button", name="Run", exact=True).click()
    page.get_by_role("heading", name="first").wait_for(timeout=300_000)
    rows = page.get_by_role("region", name="Table").get_by_role("row").all_inner_texts()
    assert [row.split()[:3] for row in rows[1:]] == [
        ["doorway", "straight", "wheelchair"],
        ["doorway", "straight", "pepper"],
    ]
    results = page.locator(".results")
    results.get_by_text("robot 'robot' becomes pepper, with its own drive").wait_for()
    expect(results).to_contain_text("--robots wheelchair,pepper")
    page.get_by_role("button", name="2 runs").last.click()
    page.get_by_role("heading", name="doorway, straight, pepper").wait_for()
    for width in (1280, 800):
        page.set_viewport_size({"width": width, "height": 800})
        assert page.evaluate("document.documentElement.scrollWidth") <= width
    page.set_viewport_size({"width": 1280, "height": 800})
    page.get_by_role("button", name="Watch seed 1").click()
    page.wait_for_function("() => crowdbot.keys.active === 'simulator'")
    page.wait_for_function(f"() => {STATUS}.name === 'evaluations/first/row-2-seed-1.mcap'")


def test_a_planned_end_is_neither_a_timeout_nor_a_failure(page, app):
    (app.folder / "shown.xml").write_text(SHOWN)
    page.reload()
    page.get_by_role("tab", name="Evaluation").click()
    page.get_by_label("Trials").select_option("shown.xml")
    page.get_by_label("Navigators").fill("straight")
    page.get_by_label("Seeds").fill("0:2")
    page.get_by_role("button", name="Run", exact=True).click()
    page.get_by_role("heading", name="first").wait_for(timeout=300_000)
    page.get_by_role("button", name="2 runs").click()
    page.get_by_label("Only the 0 failures").wait_for()
    outcomes = page.locator(".results table").last.locator("tbody tr td:nth-of-type(2)").all_inner_texts()
    assert outcomes == ["finished", "finished"]
    assert page.locator(".strips .square").count() == 2


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_axe_finds_nothing(results, axe, theme):
    results.evaluate("theme => document.documentElement.dataset.theme = theme", theme)
    results.get_by_role("button", name="2 runs").first.click()
    assert axe(results) == []
