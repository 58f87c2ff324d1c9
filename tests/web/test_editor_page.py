"""A person's path through the editor: draw a stage, people and a robot, correct an error, undo, save, open again."""

import pytest
from playwright.sync_api import expect

from crowdbot.trials import load_trial, parse_trial, trial_xml

pytestmark = pytest.mark.live

TAB = "#tab=editor"


@pytest.fixture
def editor(page):
    """The editor tab of an empty start."""
    page.get_by_role("tab", name="Editor").click()
    page.wait_for_function("() => document.querySelector('.editor textarea').value.includes('new-trial')")
    return page


def text_of(page):
    return page.get_by_label("XML of the trial").input_value()


def draw(page, tool, *places):
    """Click places of the canvas, as shares of its width and height."""
    if tool is not None:
        page.get_by_role("button", name=tool, exact=True).click()
    box = page.locator(".editor canvas").bounding_box()
    for x, y in places:
        page.mouse.click(box["x"] + x * box["width"], box["y"] + y * box["height"])


def wait_for_text(page, word):
    page.wait_for_function("word => document.querySelector('.editor textarea').value.includes(word)", arg=word)


def test_a_trial_is_drawn_checked_saved_and_opened_again(editor, app):
    page = editor
    draw(page, "Wall", (0.1, 0.2), (0.9, 0.2))
    page.keyboard.press("Enter")
    wait_for_text(page, "<wall")
    draw(page, "People", (0.1, 0.4), (0.3, 0.6), (0.7, 0.4), (0.9, 0.6))
    wait_for_text(page, "<spawner")
    draw(page, "Robot", (0.5, 0.8), (0.5, 0.3))
    wait_for_text(page, "<robot")
    page.get_by_text("No errors").wait_for()
    trial = parse_trial(text_of(page))
    assert (len(trial.stage.walls), trial.spawners[0].count, len(trial.robots)) == (1, 5, 1)

    page.get_by_role("option", name="spawner").click()
    count = page.locator(".inspector").get_by_label("count")
    count.fill("-2")
    count.press("Tab")
    problem = page.locator(".editor .below .problems button").first
    expect(problem).to_contain_text("must be at least 0")
    expect(page.get_by_role("button", name="Run")).to_be_disabled()
    page.get_by_role("button", name="Undo").click()
    page.get_by_text("No errors").wait_for()

    page.get_by_role("button", name="Make single people").click()
    wait_for_text(page, "<agent")
    page.get_by_role("button", name="Places").click()
    page.wait_for_function("() => crowdbot._views.get('editor').tab.model.people?.people.length === 5")

    page.get_by_role("button", name="Save").click()
    page.get_by_label("Name in the folder of the app").fill("hall")
    page.get_by_role("dialog").get_by_role("button", name="Save").click()
    page.get_by_text("saved as hall.xml").wait_for()
    saved = (app.folder / "hall.xml").read_text()
    assert saved == text_of(page)
    assert len(parse_trial(saved).agents) == 5

    page.get_by_role("button", name="Open").click()
    page.get_by_role("button", name="frontal", exact=True).click()
    wait_for_text(page, 'name="frontal"')
    assert text_of(page) == trial_xml(load_trial("frontal"))
    page.get_by_role("button", name="Open").click()
    page.get_by_role("button", name="hall.xml").click()
    wait_for_text(page, "<agent")
    assert text_of(page) == saved


def test_rare_elements_are_chosen_from_a_list_and_drawn(editor):
    page = editor
    page.get_by_role("option", name="trial").first.click()
    page.locator(".inspector").get_by_label("world").select_option("physics")
    wait_for_text(page, 'world="physics"')
    corners = ((0.2, 0.3), (0.4, 0.5))
    for name in ("ramp", "stairs", "platform", "threshold", "avatar"):
        page.get_by_label("More tools").select_option(name)
        draw(page, None, *corners)
        wait_for_text(page, f"<{name} ")
        page.keyboard.press("Escape")
        expect(page.get_by_label("More tools")).to_have_value("")
    page.get_by_text("No errors").wait_for()
    trial = parse_trial(text_of(page))
    ramp, stairs, platform, threshold = trial.stage.ground
    assert (ramp.x, ramp.y, ramp.length) == (stairs.x, stairs.y, pytest.approx(threshold.width, abs=0.01))
    assert platform.length > 0.0
    assert platform.width > 0.0
    assert trial.avatars[0].name == "you"


def test_an_element_is_dragged_and_the_xml_follows(editor):
    page = editor
    page.evaluate("crowdbot.connection.call('editor.start', {trial: 'frontal'})")
    wait_for_text(page, 'name="frontal"')
    page.get_by_role("button", name="Whole view").click()
    before = parse_trial(text_of(page)).robots[0].x
    at = page.evaluate(
        """() => {
          const view = crowdbot._views.get('editor').tab.view;
          const robot = view.shapes.find((one) => one.tag === 'robot');
          const bounds = view.canvas.getBoundingClientRect();
          const [x, y] = view.pixel(robot.centre);
          return [x + bounds.left, y + bounds.top, view.scale];
        }"""
    )
    page.mouse.move(at[0], at[1])
    page.mouse.down()
    page.mouse.move(at[0] + at[2], at[1], steps=4)
    page.mouse.up()
    page.wait_for_function(f"() => !document.querySelector('.editor textarea').value.includes('x=\"{before:g}\"')")
    assert parse_trial(text_of(page)).robots[0].x == pytest.approx(before + 1.0, abs=0.051)


def test_text_and_elements_follow_each_other_in_two_windows(editor, browser, app):
    page = editor
    other = browser.new_page()
    other.goto(app.url + "#tab=editor")
    wait_for_text(other, "new-trial")
    area = page.get_by_label("XML of the trial")
    area.fill(text_of(page).replace("<stage/>", '<stage>\n    <!-- mine -->\n    <wall points="0,0 3,0"/>\n  </stage>'))
    wait_for_text(other, "<!-- mine -->")
    other.get_by_role("option", name="wall").click()
    other.locator(".inspector").get_by_label("points").fill("0,0 5,0")
    other.keyboard.press("Tab")
    wait_for_text(page, "0,0 5,0")
    assert "<!-- mine -->" in text_of(page)
    other.close()


def test_ways_follow_an_edit_of_a_wall(editor):
    page = editor
    text = (
        '<trial name="t" duration="9"><stage><wall points="2,-3 2,3"/></stage><crowd type="orca"/>'
        '<agent x="0" y="0" goal="4,0"/></trial>'
    )
    page.get_by_label("XML of the trial").fill(text)
    page.get_by_role("button", name="Places").click()
    ways = "crowdbot._views.get('editor').tab.model.people?.ways[0].length"
    page.wait_for_function(f"() => {ways} > 2")
    page.get_by_role("option", name="wall").click()
    page.keyboard.press("Delete")
    page.wait_for_function(f"() => {ways} === 2")
    assert page.evaluate(ways) == 2


def test_lengths_stand_at_the_walls_that_are_drawn_or_chosen(editor):
    page = editor
    page.evaluate(
        """() => {
          const { prototype } = CanvasRenderingContext2D, { fillText } = prototype;
          prototype.fillText = function (text, ...place) {
            (window.written ??= []).push(text);
            return fillText.call(this, text, ...place);
          };
        }"""
    )
    wall = '<trial name="t"><stage><wall points="-2,0 2,0 2,3"/></stage></trial>'
    page.get_by_label("XML of the trial").fill(wall)
    page.get_by_role("option", name="wall").click()
    page.wait_for_function("() => window.written.includes('4 m') && window.written.includes('3 m')")
    page.get_by_role("button", name="Wall", exact=True).click()
    x, y, scale = page.evaluate(
        """() => {
          const { view } = crowdbot.tab('editor').tab;
          const bounds = view.canvas.getBoundingClientRect(), [x, y] = view.pixel([-1, 1]);
          return [x + bounds.left, y + bounds.top, view.scale];
        }"""
    )
    page.mouse.click(x, y)
    page.mouse.move(x + 2.5 * scale, y)
    page.wait_for_function("() => window.written.includes('2.5 m')")
    assert {"4 m", "3 m", "2.5 m"} <= set(page.evaluate("window.written"))


def test_the_keyboard_alone_is_enough(editor):
    page = editor
    page.get_by_role("listbox", name="Elements").focus()
    page.keyboard.press("Home")
    page.get_by_label("Element to add").select_option("agent")
    page.get_by_role("button", name="Add inside").focus()
    page.keyboard.press("Enter")
    wait_for_text(page, "<agent")
    page.get_by_role("listbox", name="Elements").focus()
    page.keyboard.press("End")
    page.keyboard.press("Delete")
    page.wait_for_function("() => !document.querySelector('.editor textarea').value.includes('<agent')")
    assert "<agent" not in text_of(page)


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_axe_finds_nothing(editor, axe, theme):
    page = editor
    page.evaluate("theme => document.documentElement.dataset.theme = theme", theme)
    page.evaluate("crowdbot.connection.call('editor.start', {trial: 'crossing-flows'})")
    wait_for_text(page, "crossing-flows")
    assert axe(page) == []


def canvas_place(page, x, y):
    """Pixels of the page at a place of the trial [m]."""
    return page.evaluate(
        """([x, y]) => {
          const view = crowdbot.tab('editor').tab.view;
          const bounds = view.canvas.getBoundingClientRect();
          const [px, py] = view.pixel([x, y]);
          return [px + bounds.left, py + bounds.top];
        }""",
        [x, y],
    )


def test_a_way_is_drawn_for_people_and_changed_with_the_mouse(editor):
    page = editor
    draw(page, "People", (0.1, 0.4), (0.2, 0.6), (0.8, 0.4), (0.9, 0.6))
    wait_for_text(page, "<spawner")
    draw(page, "Way", (0.3, 0.2), (0.6, 0.2), (0.6, 0.8))
    page.keyboard.press("Enter")
    wait_for_text(page, 'journey="way1"')
    page.get_by_text("No errors").wait_for()
    trial = parse_trial(text_of(page))
    assert (len(trial.journeys[0].stops), trial.spawners[0].journey, trial.spawners[0].goal) == (3, "way1", ())

    page.keyboard.press("Escape")
    (x1, y1), (x2, y2) = [(stop.x, stop.y) for stop in trial.journeys[0].stops[:2]]
    page.mouse.dblclick(*canvas_place(page, (x1 + x2) / 2, (y1 + y2) / 2))
    page.wait_for_function("() => document.querySelector('.editor textarea').value.split('<point').length === 5")
    page.get_by_role("button", name="Undo").click()  # back to three stops
    page.wait_for_function("() => document.querySelector('.editor textarea').value.split('<point').length === 4")

    before = text_of(page)
    page.mouse.move(*canvas_place(page, x1, y1))
    page.mouse.down()
    page.mouse.move(*canvas_place(page, x1, y1 - 1.0), steps=4)
    page.mouse.up()
    page.wait_for_function("before => document.querySelector('.editor textarea').value !== before", arg=before)
    moved = parse_trial(text_of(page)).journeys[0].stops
    assert moved[0].y == pytest.approx(y1 - 1.0, abs=0.11)
    assert [(item.x, item.y) for item in moved[1:]] == [(stop.x, stop.y) for stop in trial.journeys[0].stops[1:]]

    page.get_by_role("option", name="spawner").click()
    page.locator(".inspector").get_by_label("journey").select_option("")
    page.get_by_role("option", name="journey way1").click()
    page.keyboard.press("Delete")
    page.wait_for_function("() => !document.querySelector('.editor textarea').value.includes('journey')")


def test_single_people_are_gathered_with_a_rectangle(editor):
    page = editor
    draw(page, "People", (0.3, 0.4), (0.5, 0.6), (0.8, 0.4), (0.9, 0.6))
    wait_for_text(page, "<spawner")
    page.get_by_role("button", name="Make single people").click()
    wait_for_text(page, "<agent")
    page.keyboard.press("Escape")
    box = page.locator(".editor canvas").bounding_box()
    corners = [(box["x"] + x * box["width"], box["y"] + y * box["height"]) for x, y in ((0.25, 0.3), (0.6, 0.7))]
    page.keyboard.down("Shift")
    page.mouse.move(*corners[0])
    page.mouse.down()
    page.mouse.move(*corners[1], steps=4)
    page.mouse.up()
    page.keyboard.up("Shift")
    page.get_by_role("button", name="Make a spawner").click()
    wait_for_text(page, "<spawner")
    trial = parse_trial(text_of(page))
    assert (trial.spawners[0].count, trial.agents) == (5, ())


def test_the_scale_of_a_floor_plan_is_set_with_two_points(editor, app, tmp_path):
    from PIL import Image, ImageDraw

    plan = Image.new("L", (560, 280), 255)
    ImageDraw.Draw(plan).rectangle((10, 10, 549, 269), outline=0, width=6)
    plan.save(tmp_path / "plan.png")
    page = editor
    page.get_by_role("button", name="Open").click()
    page.get_by_label("Picture (.png, .jpg)").set_input_files(tmp_path / "plan.png")
    canvas = page.get_by_role("img", name="Floor plan")
    canvas.wait_for()
    box = canvas.bounding_box()
    for x in (0.1, 0.6):
        page.mouse.click(box["x"] + x * box["width"], box["y"] + 100)
    page.get_by_label("Distance between the two points [m]").fill("14")
    page.get_by_text("The picture is 28.0 m x 14.0 m.").wait_for()
    page.get_by_role("button", name="Use as stage").click()
    wait_for_text(page, 'map="plan.yaml"')
    page.wait_for_function("() => crowdbot.tab('editor').tab.model.state.rings.length > 0")
    assert (app.folder / "plan.yaml").read_text().splitlines()[1].startswith("resolution: 0.05")


def test_run_opens_the_trial_in_the_simulator(editor, app):
    """By keyboard, and again right after the run of another trial."""
    page = editor
    status = "crowdbot.tab('simulator')?.status"
    for name in ("first", "second"):
        page.get_by_label("XML of the trial").fill(
            f'<trial name="{name}" duration="9"><crowd type="orca"/><agent x="0" y="0" goal="4,0"/></trial>'
        )
        page.wait_for_function(f"() => crowdbot.tab('editor').tab.model.state.text.includes('\"{name}\"')")
        page.get_by_role("button", name="Run", exact=True).focus()
        page.keyboard.press("Enter")
        page.wait_for_function("() => crowdbot.keys.active === 'simulator'")
        page.wait_for_function(f"() => {status}?.trial === '{name}' && {status}.time > 0")
        page.keyboard.press("Space")  # the picture has the focus
        page.wait_for_function(f"() => {status}.trial === '{name}' && ['paused', 'ended'].includes({status}.state)")
        page.get_by_role("tab", name="Editor").click()
    assert len(list(app.folder.glob("*.xml"))) == 1
