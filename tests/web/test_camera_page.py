"""Camera images in a real browser: chosen in the display list, drawn over the picture, by mouse and keyboard."""

import time

import pytest
from playwright.sync_api import expect
from test_camera_images import TRIAL

pytestmark = pytest.mark.live

VIEW = "window.crowdbot._views.get('simulator')"
PIXELS = """(label) => {
  const canvas = document.querySelector(`.camera-image canvas[aria-label^='${label}']`);
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  const colors = new Set();
  for (let k = 0; k < data.length; k += 4) colors.add((data[k] << 16) | (data[k + 1] << 8) | data[k + 2]);
  return { width: canvas.width, height: canvas.height, colors: colors.size };
}"""


def wait(page, expression, seconds=180.0):
    end = time.monotonic() + seconds
    while not page.evaluate(expression):
        if time.monotonic() > end:
            raise TimeoutError(expression)
        page.wait_for_timeout(50)


def drawn(name):
    return f"({VIEW}.display.images.figures.figure('{name}')?.drawn ?? 0)"


def test_images_are_chosen_seen_and_closed(page, app, axe):
    page.get_by_label("View", exact=True).select_option("2d")
    (app.folder / "seen.xml").write_text(TRIAL)
    page.evaluate("window.crowdbot.connection.call('simulator.open', {name: 'seen.xml', seed: 1})")
    box = page.get_by_role("checkbox", name="eye / color: colour")
    box.wait_for()
    assert page.get_by_role("group", name="Camera images").locator("figure").count() == 0
    box.focus()
    page.keyboard.press("Space")
    wait(page, f"{drawn('eye/color/color')} > 0")
    figure = page.get_by_role("img", name="eye / color: colour, 160 by 120 pixels, 10 Hz, measured at")
    expect(figure).to_have_count(1)
    seen = page.evaluate(PIXELS, "eye / color: colour")
    assert (seen["width"], seen["height"]) == (160, 120)
    assert seen["colors"] > 20
    page.get_by_role("checkbox", name="eye / depth: depth").check()
    wait(page, f"{drawn('eye/depth/depth')} > 0")
    assert page.evaluate(PIXELS, "eye / depth: depth")["colors"] > 10
    scale = page.locator(".camera-scale").text_content()
    assert all(word in scale for word in ("0.5 m", "6 m", "nearer", "beyond"))
    wait(page, "location.hash.includes('images=')")

    larger = page.get_by_role("button", name="Larger: eye / color: colour")
    small = page.locator(".camera-image").first.bounding_box()["width"]
    larger.press("Enter")
    expect(larger).to_have_attribute("aria-pressed", "true")
    assert page.locator(".camera-image").first.bounding_box()["width"] > 1.3 * small
    for _ in range(2):
        assert axe(page) == []
        page.get_by_role("button", name="Theme").click()
    page.get_by_role("button", name="Close: eye / color: colour").press("Enter")
    expect(page.locator(".camera-image")).to_have_count(1)
    expect(box).not_to_be_checked()
    page.reload()  # a link shows the same
    wait(page, f"{drawn('eye/depth/depth')} > 0")
    expect(page.locator(".camera-image")).to_have_count(1)
    page.evaluate("window.crowdbot.connection.call('simulator.open', {name: 'frontal'})")
    wait(page, f"{VIEW}.status.trial === 'frontal' && document.querySelector('.cameras').hidden")
    expect(page.get_by_text("Camera images", exact=True)).to_be_hidden()
    expect(page.locator(".camera-image")).to_have_count(0)
