// The panel of motion capture: suits of participants, and systems that see people and robots.
import { field, fill, h } from "../ui/dom.mjs";

const COLUMNS = ["Motion capture", "Samples", "Rate", "Lost", "Age", ""];

/** Makes the panel; returns {element, take(captures)}. */
export function capturesPanel(tab) {
  const input = h("input", { type: "text", placeholder: "xsens:9763=participant" });
  const rows = h("tbody");
  const add = () => tab._call("add_capture", { capture: input.value.trim() });
  const head = h("tr", {}, COLUMNS.map((one) => h("th", { scope: "col" }, one || h("span", { class: "vr-quiet" }, "Actions"))));
  const element = h(
    "section",
    { "aria-label": "Motion capture", class: "vr-wide" },
    h("h2", {}, "Motion capture"),
    h("p", {}, "A suit below the headset, a person without one, or a robot. Examples: xsens:9763=participant, natnet:192.168.0.5#Cart=robot."),
    h("div", { class: "vr-buttons" }, field("Source and who it moves", input), h("button", { type: "button", onclick: add }, "Add motion capture")),
    h("div", { class: "vr-scroll", tabindex: "0", role: "region", "aria-label": "Motion capture sources" }, h("table", {}, h("thead", {}, head), rows)),
  );
  const row = (one) => {
    const remove = h("button", { type: "button", "aria-label": `Remove ${one.capture}`, onclick: () => tab._call("remove_capture", { capture: one.capture }) }, "Remove");
    const cells = [one.samples, `${one.rate.toFixed(1)} Hz`, one.lost, one.age === null ? "–" : `${one.age.toFixed(1)} ms`];
    return h("tr", {}, h("th", { scope: "row" }, one.capture + (one.reason ? ` (${one.reason})` : "")), cells.map((text) => h("td", {}, String(text))), h("td", {}, remove));
  };
  const take = (captures) => fill(rows, captures.length ? captures.map(row) : h("tr", {}, h("td", { colspan: COLUMNS.length }, "None.")));
  return { element, take };
}
