// Modal dialogs.
import { h } from "./dom.mjs";

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
