"""An emulated headset in a real browser: opening the page, entering, pointing at the board."""

import asyncio
import contextlib
import time

from crowdbot.vr import VR_DESKS

DEVICE = """() => {
  const device = new IWER.XRDevice(IWER.MODEL, { stereoEnabled: false });
  device.installRuntime({ forceInstall: true });
  device.position.set(0, 1.6, 0);
  window.device = device;
}"""
STATE = "crowdbotVr.state?.participants[0]"
CUT = ("WebSocket connection", "ERR_CONNECTION_REFUSED", "ERR_INTERNET_DISCONNECTED")
AIM = """([text, kind]) => {
  const board = crowdbotVr.board;
  const at = board.middle(board.boxes.find((one) => one.action && one.text === text));
  const tool = device[kind].right;
  const from = { x: 0.2, y: 1.2, z: -0.3 };
  const length = Math.hypot(at.x - from.x, at.y - from.y, at.z - from.z);
  const [dx, dy, dz] = [(at.x - from.x) / length, (at.y - from.y) / length, (at.z - from.z) / length];
  const size = Math.hypot(dy, dx, 1 - dz);
  tool.position.set(from.x, from.y, from.z);
  tool.quaternion.set(dy / size, -dx / size, 0, (1 - dz) / size);
}"""
NUMBERS = """JSON.stringify({
  scene: crowdbotVr.scene.info(), pictures: crowdbotVr.pictures, work: crowdbotVr.work, dropped: crowdbotVr.dropped,
  reflections: crowdbotVr.mirror.reflections, note: crowdbotVr.note.textContent, said: crowdbotVr.room.said,
  status: crowdbotVr.status, problem: crowdbotVr.board.problem, state: crowdbotVr.state,
  experiment: crowdbotVr.experiment,
}, null, 1)"""
PRESS = """([hand, value]) => {
  if (hand) device.hands.right.updatePinchValue(value);
  else device.controllers.right.updateButtonValue("trigger", value);
}"""


def desks(first):
    """Return the tabs of the app with virtual reality that open a trial first."""
    return tuple(
        type("SimulatorDesk", (item,), {"first": first}) if item.name == "simulator" else item for item in VR_DESKS
    )


@contextlib.contextmanager
def emulated_headsets(browser, app, modules):
    """Yield a function that opens the page of participants; errors of the page fail the test."""
    script = (modules / "node_modules/iwer/build/iwer.min.js").read_text()
    contexts, faults = [], []

    def open_page(model="metaQuest3"):
        context = browser.new_context(viewport={"width": 320, "height": 180})
        contexts.append(context)
        page = context.new_page()
        page.set_default_timeout(300_000)
        page.add_init_script(script + f";({DEVICE.replace('MODEL', model)})();")
        page.on("console", lambda one: faults.append(one.text) if one.type == "error" else None)
        page.on("pageerror", lambda one: faults.append(str(one)))
        page.goto(app.vr_url)
        return page

    yield open_page
    for context in contexts:
        context.close()
    assert [fault for fault in faults if not any(word in fault for word in CUT)] == []


def wait(page, expression, seconds=300.0):
    """Wait until an expression of the page is true; the first picture waits for kernels that are compiled."""
    end = time.monotonic() + seconds
    while not page.evaluate(expression):
        if time.monotonic() > end:
            raise TimeoutError(f"not true after {seconds:g} s: {expression}\n{page.evaluate(NUMBERS)}")
        page.wait_for_timeout(40)


def call(app, command, **arguments):
    """Call a command as the operator does; a headset may not."""
    session = app.sessions["main"]
    return asyncio.run_coroutine_threadsafe(session.call(command, arguments), session._loop).result(120)


def enter(page, app):
    """Enter; pictures take long without a graphics card, so they have no shadows, and late poses pause nothing."""
    wait(page, "crowdbotVr.connection.open && crowdbotVr.state !== null")
    wait(
        page, "crowdbotVr.status && crowdbotVr.status.state !== 'preparing'", 900
    )  # kernels are compiled before pictures
    call(app, "vr.set", settings={"timeout": 8.0, "pause_when_lost": False})
    call(app, "vr.show", own_body=False)
    page.evaluate("crowdbotVr.scene.setLayer('shadows', false)")
    page.get_by_role("button", name="Enter VR").click()
    wait(page, "crowdbotVr.immersed && crowdbotVr.link?.avatar !== null && crowdbotVr.pictures > 3")


def point(page, text, hand=False):
    """Point at a button of the board with the right controller or hand, and press."""
    words = repr(text)
    wait(page, f"crowdbotVr.board.boxes.some((one) => one.action && one.text === {words})")
    page.evaluate(AIM, [text, "hands" if hand else "controllers"])
    wait(page, f"crowdbotVr.board.hovered.some((one) => one.text === {words})")
    presses = page.evaluate("crowdbotVr.board.presses")
    page.evaluate(PRESS, [hand, 1])
    wait(page, f"crowdbotVr.board.presses > {presses}")
    page.evaluate(PRESS, [hand, 0])
    wait(page, "crowdbotVr.pointers.free")
