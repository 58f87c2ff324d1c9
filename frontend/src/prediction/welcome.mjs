// What a new user sees instead of an empty scene: the steps to the first prediction.
import { fill, h } from "../ui/dom.mjs";
import { openRecording } from "./recording_panel.mjs";

/** Makes a card over the scene that is there while no recording is open. */
export function makeWelcome(store) {
  const examples = h("div", { class: "buttons" });
  const card = h(
    "section",
    { class: "welcome", "aria-label": "First steps", hidden: true },
    h("h2", {}, "Predict where people walk"),
    h("ol", {},
      h("li", {}, "Open a recording of people, or start with an example."),
      h("li", {}, "Add predictors: a crowd model that is calibrated in each frame, a baseline, or a learned one."),
      h("li", {}, "Run them, and compare their paths and errors with the true future.")),
    h("div", { class: "buttons" }, h("button", { type: "button", class: "main", onclick: () => openRecording(store) }, "Choose a recording…")),
    examples,
  );
  let asked = false;
  store.on("board", async () => {
    card.hidden = Boolean(store.recording);
    if (asked || store.recording) return;
    asked = true;
    const found = await store.call("files");
    const buttons = (found?.examples ?? []).map(({ name, about }) =>
      h("button", { type: "button", title: about, onclick: () => store.call("example", { name }) }, `Example: ${name}`));
    fill(examples, buttons);
  });
  return card;
}
