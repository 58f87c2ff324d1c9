// Modal dialogs and messages.
import { fill, h } from "./dom.mjs";

/** Shows a modal dialog with a heading and content; returns it. `buttons` are [text, action] from left to right. */
export function openDialog(title, content, buttons = [["Close", () => true]]) {
  const dialog = h("dialog", { "aria-label": title });
  const close = async (action) => {
    if ((await action()) !== false) dialog.close();
  };
  dialog.append(
    h("h2", {}, title),
    h("div", { class: "dialog-body" }, content),
    h(
      "div",
      { class: "dialog-buttons" },
      buttons.map(([text, action], i) =>
        h("button", { type: "button", class: i === buttons.length - 1 ? "main" : "", onclick: () => close(action) }, text),
      ),
    ),
  );
  dialog.addEventListener("close", () => dialog.remove());
  document.body.append(dialog);
  dialog.showModal();
  return dialog;
}

const region = h("div", { class: "messages", role: "status", "aria-live": "polite" });

/** The element that holds the messages; the page adds it once. */
export const messageRegion = region;

/** Shows a message for some seconds; errors stay until they are closed. */
export function say(text, kind = "note") {
  const message = h("div", { class: `message ${kind}` }, h("span", {}, text));
  message.append(h("button", { type: "button", "aria-label": "Close message", onclick: () => message.remove() }, "×"));
  region.append(message);
  while (region.children.length > 4) region.firstChild.remove();
  if (kind !== "error") setTimeout(() => message.remove(), 6000);
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

export { fill };
