// Messages of the page: notes that go, errors that stay until they are closed. They cover no control.
import { h } from "./dom.mjs";

const MOST = 4;
const SECONDS = 6;
const STRIDE = 16;
const MARGIN = 14;
const CONTROLS = "button, input, select, textarea, summary, a[href], [role='separator']";

/** The element that holds the messages; the page adds it once. */
export const messageRegion = h("div", { class: "messages", role: "status", "aria-live": "polite" });

/** Shows a message for some seconds; errors stay until they are closed. */
export function say(text, kind = "note") {
  const message = h("div", { class: `message ${kind}` }, h("span", {}, text));
  message.append(h("button", { type: "button", "aria-label": "Close message", onclick: () => message.remove() }, "×"));
  messageRegion.append(message);
  while (messageRegion.children.length > MOST) messageRegion.firstChild.remove();
  if (kind !== "error") setTimeout(() => message.remove(), 1000 * SECONDS);
}

/** Runs an action and shows its error. */
export async function attempt(action) {
  try {
    return await action();
  } catch (error) {
    say(error.message, "error");
    return undefined;
  }
}

/** Keeps the messages where they cover no control; while there are some, also as controls and dialogs come and go. */
export function placeMessages() {
  let timer = null;
  const home = messageRegion.parentNode;
  document.addEventListener("close", () => enter(home), true);
  new MutationObserver(() => {
    if (!messageRegion.children.length) {
      timer = clearInterval(timer);
      return;
    }
    if (!timer) messageRegion.style.right = messageRegion.style.bottom = `${MARGIN}px`;
    timer ??= setInterval(() => place(home), 250);
    place(home);
  }).observe(messageRegion, { childList: true });
}

/** Moves the messages into the modal dialog that is open, since the page behind it is covered and takes no click. */
function enter(home) {
  const host = [...document.querySelectorAll("dialog[open]")].at(-1) ?? home;
  if (messageRegion.parentNode !== host) host.append(messageRegion);
}

/** Puts the messages where they cover least: if they cover something now, from the right below to the left above. */
function place(home) {
  enter(home);
  const controls = [...document.querySelectorAll(CONTROLS)]
    .filter((one) => !messageRegion.contains(one) && one.checkVisibility())
    .map((one) => one.getBoundingClientRect());
  const { left, top, width, height } = messageRegion.getBoundingClientRect();
  const covered = (x, y) =>
    controls.reduce((sum, one) => {
      const wide = Math.min(one.right, x + width) - Math.max(one.left, x);
      const high = Math.min(one.bottom, y + height) - Math.max(one.top, y);
      return sum + (wide > 0 && high > 0 ? wide * high : 0);
    }, 0);
  const [right, bottom] = [innerWidth - MARGIN - width, innerHeight - MARGIN - height];
  let best = { x: Math.max(0, Math.min(left, right)), y: Math.max(0, Math.min(top, bottom)) };
  best.cost = covered(best.x, best.y);
  for (let y = bottom; best.cost && y >= 0; y -= STRIDE) {
    for (let x = right; best.cost && x >= 0; x -= STRIDE) {
      const cost = covered(x, y);
      if (cost < best.cost) best = { x, y, cost };
    }
  }
  messageRegion.style.right = `${innerWidth - best.x - width}px`;
  messageRegion.style.bottom = `${innerHeight - best.y - height}px`;
}
