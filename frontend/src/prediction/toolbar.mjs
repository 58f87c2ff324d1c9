// What is drawn, and what leaves the tab: pictures, tables, command line, Python.
import { copyText } from "../ui/copy.mjs";
import { h } from "../ui/dom.mjs";
import { say } from "../ui/messages.mjs";
import { save } from "../ui/save.mjs";

const LAYERS = [
  ["observed", "Observed"],
  ["truth", "True"],
  ["predicted", "Predicted"],
  ["density", "Density"],
  ["walls", "Walls"],
  ["background", "Ground"],
  ["ids", "Numbers"],
];

export function makeToolbar(store, scene) {
  const layers = LAYERS.map(([name, text]) => {
    const box = h("input", { type: "checkbox", checked: store.layers[name] });
    box.addEventListener("change", () => store.show(name, box.checked));
    return h("label", {}, box, text);
  });
  const menu = h("select", { "aria-label": "Export or copy" }, [
    h("option", { value: "" }, "Export or copy…"),
    ...actions(store, scene).map(([name, text]) => h("option", { value: name }, text)),
  ]);
  menu.addEventListener("change", () => {
    const found = actions(store, scene).find(([name]) => name === menu.value);
    menu.value = "";
    if (!store.recording) say("open a recording first", "error");
    else found?.[2]();
  });
  return h(
    "div",
    { class: "toolbar", role: "group", "aria-label": "Scene" },
    h("span", { class: "layers" }, layers),
    h("button", { type: "button", onclick: () => scene.fit() }, "Fit"),
    h("button", { type: "button", "aria-label": "Zoom in", onclick: () => scene.zoom(1.25) }, "+"),
    h("button", { type: "button", "aria-label": "Zoom out", onclick: () => scene.zoom(0.8) }, "−"),
    menu,
  );
}

function actions(store, scene) {
  const name = () => `${store.recording.file}-${store.recording.frames[store.index]}`;
  return [
    ["command", "Copy as command line", () => copyCommand(store, "command_line")],
    ["python", "Copy as Python", () => copyCommand(store, "python")],
    ["png", "Scene as PNG", async () => save(await scene.png(), `${name()}.png`)],
    ["svg", "Scene as SVG", () => save(new Blob([scene.svg()], { type: "image/svg+xml" }), `${name()}.svg`)],
    ["mp4", "This frame as video (MP4)", () => fetchFile(store, "animation.mp4", { index: store.index })],
    ["gif", "This frame as animation (GIF)", () => fetchFile(store, "animation.gif", { index: store.index })],
    ["frames.csv", "Results by frame as CSV", () => fetchFile(store, "frames.csv")],
    ["people.csv", "Results by person as CSV", () => fetchFile(store, "people.csv")],
    ["frames.parquet", "Results by frame as Parquet", () => fetchFile(store, "frames.parquet")],
    ["people.parquet", "Results by person as Parquet", () => fetchFile(store, "people.parquet")],
  ];
}

async function copyCommand(store, command) {
  const degraded = store.input === "degraded";
  const text = await store.call(command, { degraded });
  const title = command === "python" ? "Copy as Python" : "Copy as command line";
  if (text !== undefined) await copyText(text, title);
}

async function fetchFile(store, path, query = {}) {
  const answer = await fetch(store.app.connection.address("prediction", path, query)).catch((error) => ({ ok: false, text: () => error.message }));
  if (!answer.ok) return say((await answer.text()).trim(), "error");
  const name = /filename="([^"]+)"/.exec(answer.headers.get("Content-Disposition") ?? "")?.[1] ?? path;
  return save(await answer.blob(), name);
}
