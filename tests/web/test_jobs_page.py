"""A person's path through the jobs tab: start a search for failures, reload, see its results, remove it."""

import json
import re

import pytest
from playwright.sync_api import expect

from crowdbot.data import load

pytestmark = pytest.mark.live

TAB = "#tab=jobs"


@pytest.fixture
def done(page):
    """The tab with a search that has ended."""
    page.get_by_role("button", name="Search for failures").click()
    form = page.get_by_role("form", name="Search for failures")
    form.get_by_label("Navigator").fill("straight")
    form.locator("select[name=search]").select_option("plain")
    form.get_by_label("Runs").fill("4")
    form.get_by_label("Name of the results").fill("tries")
    form.get_by_role("button", name="Start").click()
    page.locator(".job.running").wait_for()
    page.reload()
    page.locator(".job.done").wait_for(timeout=300_000)
    return page


def test_a_job_survives_a_reload_and_gives_its_results(done, app, axe):
    page = done
    job = page.get_by_role("listitem").filter(has_text="tries")
    expect(job).to_contain_text("crowdbot falsify frontal --navigator=straight")
    expect(job.locator(".kind")).to_have_text("Search for failures")
    expect(job).to_contain_text(re.compile(r"started (today|yesterday) at \d+:\d\d"))
    page.get_by_role("button", name="Log tries").click()
    expect(page.get_by_role("region", name="Log")).to_contain_text("4 runs in")
    assert axe(page) == []
    page.get_by_role("dialog").get_by_role("button", name="Close").click()
    page.get_by_role("button", name="Results tries").click()
    page.get_by_role("link", name="report.html").wait_for()
    with page.expect_download() as saved:
        page.get_by_role("link", name="result.json").click()
    assert saved.value.path().read_bytes() == (app.folder / "falsifications/tries/result.json").read_bytes()
    page.get_by_role("dialog").get_by_role("button", name="Close").click()
    page.get_by_role("button", name="Remove tries").click()
    page.get_by_role("button", name="Remove with results").click()
    page.get_by_text("No job yet").wait_for()
    assert not (app.folder / "falsifications/tries").exists()


def test_people_of_a_recording_are_measured_at_a_line(page, app):
    page.get_by_role("button", name="Measure people").click()
    form = page.get_by_role("form", name="Measure people")
    form.get_by_label("Recordings").select_option("example:bottleneck")
    form.get_by_label("Methods").select_option("line")
    form.get_by_label("Line for the flow").fill("0 -1 0 1")
    form.get_by_label("Name of the results").fill("door")
    form.get_by_role("button", name="Start").click()
    page.locator(".job.done").wait_for(timeout=300_000)
    page.get_by_role("button", name="Results door").click()
    page.get_by_role("link", name="measurements.json").wait_for()
    (recording,) = json.loads((app.folder / "measurements/door/measurements.json").read_text())["recordings"]
    assert recording["figures"]["crossings"] > 0


def test_tracks_of_a_trial_are_a_recording_for_the_other_forms(page, app):
    page.get_by_role("button", name="Track people").click()
    form = page.get_by_role("form", name="Track people")
    form.get_by_label("Duration").fill("3")
    form.get_by_label("Name of the results").fill("seen")
    form.get_by_role("button", name="Start").click()
    page.locator(".job.done").wait_for(timeout=300_000)
    page.get_by_role("button", name="Results seen").click()
    for name in ("tracks.csv", "scores.json", "tracks.png"):
        page.get_by_role("link", name=name).wait_for()
    assert len(load(app.folder / "tracks/seen/tracks.csv")) > 20
    page.get_by_role("dialog").get_by_role("button", name="Close").click()
    page.get_by_role("button", name="Measure people").click()
    recordings = page.get_by_role("form", name="Measure people").get_by_label("Recordings")
    recordings.select_option("tracks/seen/tracks.csv")


def test_what_was_typed_stays_while_other_forms_and_tabs_are_looked_at(page):
    page.get_by_role("button", name="Search for failures").click()
    form = page.get_by_role("form", name="Search for failures")
    form.get_by_label("Navigator").fill("orca")
    form.locator("select[name=search]").select_option("plain")
    form.get_by_label("Runs").fill("17")
    page.get_by_role("button", name="Generate data").click()
    page.get_by_label("Trials or a recipe").select_option(["frontal", "bottleneck"])
    page.locator("#tab-simulator").click()
    page.locator("#tab-jobs").click()
    chosen = "(list) => [...list.selectedOptions].map((one) => one.value)"
    expect(page.get_by_role("form", name="Generate data")).to_be_visible()
    assert sorted(page.get_by_label("Trials or a recipe").evaluate(chosen)) == ["bottleneck", "frontal"]
    page.get_by_role("button", name="Search for failures").click()
    expect(form.get_by_label("Navigator")).to_have_value("orca")
    expect(form.locator("select[name=search]")).to_have_value("plain")
    expect(form.get_by_label("Runs")).to_have_value("17")


def test_errors_are_shown_at_the_job_and_the_work_is_cancelled(page, axe):
    page.get_by_role("button", name="Generate data").click()
    page.get_by_role("form").get_by_role("button", name="Start").click()
    page.get_by_text("Trials or a recipe: choose at least one").wait_for()
    page.get_by_role("button", name="Search for failures").click()
    page.get_by_label("Navigator").fill("orka")
    page.get_by_role("form").get_by_role("button", name="Start").click()
    page.locator(".job.failed .problem").get_by_text("orka").wait_for(timeout=300_000)
    page.get_by_role("button", name="Remove first").click()
    page.get_by_role("button", name="Remove from the list").click()
    page.get_by_role("button", name="Generate data").click()
    page.get_by_label("Trials or a recipe").select_option("frontal")
    page.get_by_label("Sensors").fill("sick-tim571")
    page.get_by_label("Seeds").fill("0:100000")
    page.get_by_role("form").get_by_role("button", name="Start").click()
    page.get_by_role("tab", name="Jobs (1)").wait_for()
    page.get_by_role("button", name="Cancel first").click()
    page.locator(".job.cancelled").wait_for()
    for theme in ("light", "dark"):
        page.evaluate("theme => document.documentElement.dataset.theme = theme", theme)
        assert axe(page) == []
