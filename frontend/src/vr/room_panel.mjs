// The panel of a real room: its place in the virtual one, calibration, limits.
import { field, fill, h } from "../ui/dom.mjs";

const TITLES = { person: "Room of the person", robot: "Room of the robot" };
const titleOf = (name) => TITLES[name] ?? `Room of ${name.replace(/^person /, "")}`;
const number = (value, digits = 3) => (value === null || value === undefined ? "–" : value.toFixed(digits));

/** Makes the panel; returns {element, take(room, participants)}. */
export function roomPanel(name, tab) {
  const call = (command, args = {}) => tab._call(command, { room: name, ...args });
  const input = (label) => h("input", { type: "number", step: "any", value: 0, "aria-label": `${titleOf(name)}: ${label}` });
  const place = { x: input("x [m]"), y: input("y [m]"), heading: input("heading [deg]") };
  const source = ["x", "y", "z"].map((axis) => input(`${axis} in the room [m]`));
  const target = ["x", "y", "z"].map((axis) => input(`${axis} in the virtual room [m]`));
  const corners = h("input", { type: "text", placeholder: "0,0 4,0 4,3 0,3" });
  const values = (inputs) => inputs.map((one) => Number(one.value));
  const result = h("p", { role: "status" });
  const near = h("p", {});
  const points = h("tbody");
  let avatar = null;

  const add = () => {
    if (name === "robot") return call("add_pair", { source: values(source), target: values(target) });
    const [x, y, z] = values(target);
    return tab._call("add_wrist_pair", { avatar: avatar ?? "", x, y, z });
  };
  const setPlace = () => {
    const [x, y, heading] = values(Object.values(place));
    return call("place_room", { x, y, heading: (heading * Math.PI) / 180 });
  };
  const setLimits = () => {
    const rows = corners.value.trim().split(/\s+/).filter(Boolean);
    return call("limit_room", { corners: rows.map((one) => one.split(",").map(Number)) });
  };
  const button = (text, action) => h("button", { type: "button", onclick: action }, text);
  const line = (label, inputs) => h("fieldset", { class: "vr-line" }, h("legend", {}, label), inputs);

  const element = h(
    "section",
    { "aria-label": titleOf(name) },
    h("h2", {}, titleOf(name)),
    line("Origin x, y [m] and heading [deg]", Object.values(place)),
    button("Set place", setPlace),
    h("h3", {}, "Calibration"),
    name === "robot" ? line("Point in the room x, y, z [m]", source) : h("p", {}, "Touch a known point with the right wrist, then add it."),
    line("The same point in the virtual room x, y, z [m]", target),
    h("div", { class: "vr-buttons" }, button(name === "robot" ? "Add point" : "Add touched point", add), button("Calibrate", () => call("calibrate")), button("Clear points", () => call("clear_points"))),
    h("table", { class: "vr-points" }, h("thead", {}, h("tr", {}, ["Room x, y, z [m]", "Virtual x, y, z [m]", "Residual [m]"].map((one) => h("th", { scope: "col" }, one)))), points),
    result,
    h("h3", {}, "Limits"),
    field("Corners of the free floor x,y [m]", corners),
    button("Set limits", setLimits),
    near,
  );

  const take = (room, participants, margin) => {
    avatar = participants.find((one) => one.room === name)?.avatar ?? null;
    if (!element.contains(document.activeElement)) {
      place.x.value = number(room.x);
      place.y.value = number(room.y);
      place.heading.value = number((room.heading * 180) / Math.PI, 1);
      corners.value = room.limits.map((one) => one.join(",")).join(" ");
    }
    near.textContent = margin === null || margin === undefined ? "" : `A robot is ${number(margin, 2)} m from the limits.`;
    const words = (row) => row.map((one) => number(one)).join(", ");
    fill(points, room.source.map((row, k) => h("tr", {}, [words(row), words(room.target[k]), number(room.residual[k])].map((one) => h("td", {}, one)))));
    result.textContent = room.rms === null ? "Not calibrated." : `Residual ${number(room.rms)} m (root mean square), noise of a point ${number(room.noise)} m.`;
  };
  return { element, take };
}
