"""The prediction tab in a real browser: a person's path from an empty start, by mouse and by keyboard."""

import json
import re
import shlex
from pathlib import Path

import pytest
from playwright.sync_api import expect

from crowdbot.cli import main

pytestmark = pytest.mark.live

LONG = 180_000

TAB = "#tab=prediction"


@pytest.fixture
def tab(page):
    """The prediction tab of an empty session."""
    page.get_by_role("tab", name="Prediction").click()
    expect(page.get_by_role("region", name="Recording")).to_contain_text("No recording is open")
    return page


def open_example(page, name="bottleneck"):
    page.get_by_role("button", name="Open…").click()
    page.get_by_role("dialog").get_by_role("button", name=name).click()
    expect(page.locator("canvas.scene")).to_have_attribute("data-frame", "0")


def add_base(page, name):
    page.get_by_role("button", name="Add base predictor…").click()
    page.get_by_role("dialog").get_by_label("Predictor").select_option(name)
    page.get_by_role("dialog").get_by_role("button", name="OK").click()
    expect(page.get_by_role("list", name="List of predictors")).to_contain_text(name)


def add_sim(page, budget=20):
    page.get_by_role("button", name="Add sim predictor…").click()
    dialog = page.get_by_role("dialog")
    dialog.get_by_label("Search (calibrator)").select_option("random-search")
    dialog.get_by_label("Budget").fill(str(budget))
    dialog.get_by_role("button", name="OK").click()
    expect(page.get_by_role("list", name="List of predictors")).to_contain_text("orca, progressive, random-search")


def run(page, rows):
    page.get_by_role("button", name="Run", exact=True).click()
    expect(page.locator(".metrics tbody tr")).to_have_count(rows, timeout=LONG)
    expect(page.get_by_role("button", name="Cancel")).to_be_disabled(timeout=LONG)
    assert overhang(page) <= 0
    assert overhang(page, "Height") <= 0
    values = "[...document.querySelectorAll('.metrics td span')]"
    assert page.evaluate(f"{values}.length") >= 8 * rows
    assert page.evaluate(f"{values}.filter((one) => one.getClientRects().length !== 1).length") == 0  # none is broken


def overhang(page, side="Width"):
    """Pixels of the table of metrics that are seen only after scrolling."""
    return page.evaluate(f"((one) => one.scroll{side} - one.client{side})(document.querySelector('.table-place'))")


def test_a_first_prediction_by_mouse(tab, app, axe, capsys):
    page = tab
    assert axe(page) == []
    open_example(page)
    facts = page.get_by_role("region", name="Recording")
    expect(facts).to_contain_text("2.5 frames/s, a row every frame = 0.4 s")
    add_base(page, "sampled-constant-velocity")
    add_sim(page)
    run(page, 2)

    log = page.get_by_role("region", name="Log, one line a frame")
    assert len(re.findall(r"^ +\d+ +\d+ +0\.\d{5} +20 +\d", log.inner_text(), re.MULTILINE)) == 34
    for title in ("Error (ADE)", "Execution time", "Error by horizon"):
        plot = page.get_by_role("img", name=re.compile(re.escape(title) + ".*random-search"))
        expect(plot).to_be_visible()
    expect(page.locator("canvas.scene")).to_have_attribute("data-forecasts", "2")

    page.get_by_role("combobox", name="Export or copy").select_option("Copy as command line")
    dialog = page.get_by_role("dialog", name="Copy as command line")
    lines = dialog.get_by_label("Text").input_value().splitlines()
    dialog.get_by_role("button", name="Close").click()
    shown = page.locator(".metrics tbody tr td:nth-of-type(3)").all_inner_texts()
    for line, ade in zip(lines, shown, strict=True):
        capsys.readouterr()
        assert main([*shlex.split(line)[1:], "--json"]) == 0
        total = json.loads(capsys.readouterr().out)["results"][0]["total"]
        assert f"{total['ade']:.3f}" == ade

    click_a_person(page)
    assert axe(page) == []
    page.get_by_role("button", name="Theme").click()
    assert axe(page) == []


def click_a_person(page):
    """Click a scored person and look at their errors and fit."""
    page.get_by_label("Jump to frame").fill("20")
    page.get_by_label("Jump to frame").press("Enter")
    expect(page.locator("canvas.scene")).to_have_attribute("data-frame", "13")
    place = page.evaluate(
        """() => {
          const found = window.crowdbot.tab("prediction");
          const person = found.store.frame.people.find((one) => one.scored);
          const [x, y] = found.scene.view.at(person.now);
          return { id: person.id, x, y };
        }"""
    )
    page.locator("canvas.scene").click(position={"x": place["x"], "y": place["y"]})
    panel = page.get_by_role("region", name="Person")
    expect(panel).to_contain_text(f"Person {place['id']} at")
    expect(panel.locator("table.fit")).to_contain_text("time horizon")
    page.get_by_role("button", name="Plot the error of this person").click()
    expect(page.get_by_role("img", name=f"Error (ADE) of person {place['id']}")).to_be_visible()


def test_columns_are_chosen_read_and_kept(tab, capsys):
    page = tab
    open_example(page)
    add_base(page, "sampled-constant-velocity")
    run(page, 1)
    page.get_by_text("Columns", exact=True).click()
    boxes = page.get_by_role("group", name="Columns that are shown").get_by_role("checkbox")
    heads = page.locator(".metrics thead th.number")
    assert heads.count() == boxes.count() > 8
    page.get_by_role("combobox", name="Export or copy").select_option("Copy as command line")
    dialog = page.get_by_role("dialog", name="Copy as command line")
    line = dialog.get_by_label("Text").input_value()
    dialog.get_by_role("button", name="Close").click()
    capsys.readouterr()
    assert main([*shlex.split(line)[1:], "--json"]) == 0
    total = json.loads(capsys.readouterr().out)["results"][0]["total"]
    cells = dict(zip(heads.all_inner_texts(), page.locator(".metrics tbody td").all_inner_texts(), strict=True))
    for head, name in (("swept [%]", "swept_collisions"), ("radii [%]", "swept_contacts")):
        assert cells[head] == f"{100 * total[name]:.1f} ({100 * total[f'{name}_truth']:.1f})"
    region = page.get_by_role("region", name="Table of metrics").bounding_box()
    for head in heads.all():  # each is seen whole, right of the names of the predictors, after scrolling in the panel
        head.scroll_into_view_if_needed()
        box = head.bounding_box()
        assert region["x"] <= box["x"]
        assert box["x"] + box["width"] <= region["x"] + region["width"]

    page.get_by_role("checkbox", name="NLL").uncheck()
    page.get_by_role("checkbox", name="windows").uncheck()
    rest = [head for head in cells if head not in ("NLL", "windows")]
    assert heads.all_inner_texts() == rest
    page.reload()
    expect(page.locator(".metrics tbody tr")).to_have_count(1)
    assert heads.all_inner_texts() == rest
    page.get_by_text("Columns", exact=True).click()
    page.get_by_role("checkbox", name="NLL").check()
    assert "NLL" in heads.all_inner_texts()


def test_degraded_input_shows_its_difference(tab):
    page = tab
    open_example(page)
    add_base(page, "constant-velocity")
    page.get_by_role("button", name="Degrade input…").click()
    page.get_by_role("dialog").get_by_label("Sd [m]").fill("0.1")
    page.get_by_role("dialog").get_by_role("button", name="OK").click()
    expect(page.get_by_role("region", name="Predictors")).to_contain_text("gaussian-noise(sd=0.1 m)")
    run(page, 2)
    row = page.locator(".metrics tr[data-input=degraded]")
    expect(row).to_have_count(1)
    assert overhang(page) <= 0
    assert float(row.locator("td").last.inner_text()) > 0.1
    page.get_by_role("combobox", name="Input that is drawn").select_option("degraded")
    page.get_by_role("combobox", name="Export or copy").select_option("Copy as command line")
    text = page.get_by_role("dialog").get_by_label("Text").input_value()
    assert "--by gaussian-noise --levels 0.1 --draws 1" in text


def test_the_keyboard_alone_is_enough(tab):
    page = tab
    page.get_by_role("button", name="Open…").press("Enter")
    page.get_by_role("dialog").get_by_role("button", name="bottleneck").press("Enter")
    expect(page.locator("canvas.scene")).to_have_attribute("data-frame", "0")
    page.get_by_role("button", name="Add base predictor…").press("Enter")
    page.get_by_role("dialog").get_by_role("button", name="OK").press("Enter")
    run_button = page.get_by_role("button", name="Run", exact=True)
    expect(run_button).to_be_enabled()
    run_button.press("Enter")
    expect(page.locator(".metrics tbody tr")).to_have_count(1, timeout=LONG)
    page.locator("canvas.scene").focus()
    page.keyboard.press("Home")
    expect(page.locator("canvas.scene")).to_have_attribute("data-frame", "0")
    page.keyboard.press("ArrowRight")
    expect(page.locator("canvas.scene")).to_have_attribute("data-frame", "1")
    page.keyboard.press("n")
    expect(page.get_by_role("region", name="Person")).to_contain_text(re.compile(r"(Person|Robot) \d+ at"))
    page.keyboard.press(" ")
    expect(page.get_by_role("button", name="Pause")).to_be_visible()
    page.keyboard.press(" ")
    expect(page.get_by_role("button", name="Play")).to_be_visible()
    assert "frame=" in page.evaluate("location.hash")


def test_a_file_is_uploaded_and_its_time_base_corrected(tab, tmp_path):
    page = tab
    rows = "".join(f"{10 * t} {p} {0.4 * t if p == 1 else 8 - 0.4 * t} {p}\n" for t in range(24) for p in (1, 2))
    (tmp_path / "<b>two.txt").write_text(rows)
    (tmp_path / "bad.txt").write_text("this is not a recording\n")
    page.get_by_role("button", name="Open…").click()
    page.get_by_label("File of this computer").set_input_files(tmp_path / "bad.txt")
    expect(page.locator(".message.error")).to_contain_text("is text and of an unknown format")
    page.get_by_label("File of this computer").set_input_files(tmp_path / "<b>two.txt")
    facts = page.get_by_role("region", name="Recording")
    expect(facts).to_contain_text("<b>two.txt")
    expect(facts).to_contain_text("25 frames/s, a row every 10 frames = 0.4 s")
    page.get_by_role("button", name="Options of the file…").click()
    page.get_by_role("dialog").get_by_label("Frame rate of the frame column").fill("50")
    page.get_by_role("dialog").get_by_role("button", name="Load").click()
    expect(facts).to_contain_text("50 frames/s, a row every 10 frames = 0.2 s")
    assert "25 frames/s" not in facts.inner_text()


def test_the_distance_that_is_typed_keeps_predicted_people_apart(tab, tmp_path):
    page = tab
    rows = "".join(f"{10 * t} {p} {0.4 * t if p == 1 else 8 - 0.4 * t} {p}\n" for t in range(24) for p in (1, 2))
    (tmp_path / "two.txt").write_text(rows)
    page.get_by_role("button", name="Open…").click()
    page.get_by_label("File of this computer").set_input_files(tmp_path / "two.txt")
    expect(page.get_by_role("region", name="Recording")).to_contain_text("two.txt")
    for contact in ("0.25", "1.5"):
        page.get_by_role("button", name="Add sim predictor…").click()
        dialog = page.get_by_role("dialog")
        for label in ("Cost function", "Search (calibrator)"):
            dialog.get_by_label(label).select_option("")
        dialog.get_by_label("Contact [m]").fill(contact)
        dialog.get_by_role("button", name="OK").click()
    run(page, 2)
    page.get_by_label("Jump to frame").fill("70")
    page.get_by_label("Jump to frame").press("Enter")
    expect(page.locator("canvas.scene")).to_have_attribute("data-forecasts", "2")
    expect(page.locator("canvas.scene")).to_have_attribute("data-frame", "0")
    near = page.evaluate(
        """() => crowdbot.tab("prediction").store.frame.forecasts.map(({ paths: [{ people: [one, other] }] }) =>
          Math.min(...one.points.map(([x, y], k) => Math.hypot(x - other.points[k][0], y - other.points[k][1]))))"""
    )
    assert near[0] < 1.2
    assert near[1] > 1.49
    page.get_by_role("combobox", name="Export or copy").select_option("Copy as command line")
    lines = page.get_by_role("dialog").get_by_label("Text").input_value().splitlines()
    assert ["--set contact=1.5" in line for line in lines] == [False, True]


def test_a_file_is_dropped_on_the_tab(tab):
    page = tab
    rows = "".join(f"{10 * t} {p} {0.4 * t if p == 1 else 8 - 0.4 * t} {p}\n" for t in range(24) for p in (1, 2))
    page.evaluate(
        """(text) => {
          const data = new DataTransfer();
          data.items.add(new File([text], "walk.txt"));
          const panel = document.getElementById("panel-prediction");
          panel.dispatchEvent(new DragEvent("drop", { dataTransfer: data, bubbles: true, cancelable: true }));
        }""",
        rows,
    )
    expect(page.get_by_role("region", name="Recording")).to_contain_text("walk.txt")
    page.get_by_role("button", name="Open…").click()
    expect(page.get_by_role("dialog").get_by_role("button", name="walk.txt")).to_be_visible()
    assert page.locator(".message.error").count() == 0


def test_pictures_and_tables_are_saved(tab):
    page = tab
    open_example(page)
    add_base(page, "constant-velocity")
    run(page, 1)
    starts = {"Scene as PNG": b"\x89PNG", "Scene as SVG": b"<svg xmlns", "Results by frame as CSV": b"recording,"}
    for text, start in starts.items():
        with page.expect_download() as waiting:
            page.get_by_role("combobox", name="Export or copy").select_option(text)
        assert Path(waiting.value.path()).read_bytes().startswith(start), text


def test_a_second_window_sees_the_same_run(tab, app, browser):
    page = tab
    open_example(page)
    add_base(page, "constant-velocity")
    run(page, 1)
    context = browser.new_context()
    other = context.new_page()
    other.goto(f"{app.url}#tab=prediction&frame=3")
    expect(other.locator(".metrics tbody tr")).to_have_count(1, timeout=LONG)
    expect(other.locator("canvas.scene")).to_have_attribute("data-frame", "3")
    expect(other.get_by_role("region", name="Log, one line a frame")).to_contain_text("constant-velocity")
    table = ".metrics tbody"
    assert other.locator(table).inner_text() == page.locator(table).inner_text()
    context.close()
