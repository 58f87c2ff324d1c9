// Opens recordings: files of the session, dropped files, examples; shows and corrects how a file is read.
import { openDialog } from "../ui/dialog.mjs";
import { attempt, say } from "../ui/messages.mjs";
import { fill, h } from "../ui/dom.mjs";
import { makeForm } from "../ui/form.mjs";
import { upload } from "../ui/upload.mjs";

export function makeRecordingPanel(store, root) {
  const facts = h("div", {}, h("p", {}, "No recording is open."));
  const correct = h("button", { type: "button", onclick: () => openOptions(store), disabled: true }, "Options of the file…");
  const ground = h("button", { type: "button", onclick: () => openBackground(store), disabled: true }, "Background…");
  const element = h(
    "section",
    { "aria-label": "Recording" },
    h("h2", {}, "Recording"),
    h("div", { class: "buttons" }, h("button", { type: "button", onclick: () => openRecording(store) }, "Open…"), correct, ground),
    facts,
    h("p", { class: "hint" }, "Files may be dropped anywhere on this tab."),
  );
  store.on("board", () => {
    const { recording } = store;
    correct.disabled = ground.disabled = !recording;
    fill(facts, recording ? h("dl", { class: "facts" }, factRows(recording)) : h("p", {}, "No recording is open."));
  });
  listenForDrops(store, root);
  return element;
}

function factRows(one) {
  const { summary: s } = one;
  const rows = [
    ["File", one.file],
    ["Format", `${one.format} (${one.about})`],
    ["Time base", `${round(one.fps)} frames/s, a row every ${one.frame_step === 1 ? "frame" : `${one.frame_step} frames`} = ${round(one.dt)} s`],
    ["Units", `${one.units}, mean speed ${round(s.mean_speed)} ${one.units}/s, largest ${round(s.max_speed)}`],
    ["Content", `${s.tracks} tracks, ${s.rows} rows, ${round(s.seconds)} s, ${counted(one.robots, "robot")}, ${counted(one.walls.length, "wall")}`],
    ["Windows", `${one.windows} of ${one.observe} observed and ${one.predict} predicted rows, protocol ${one.protocol}`],
  ];
  if (one.note) rows.push(["Note", one.note]);
  return rows.flatMap(([name, text]) => [h("dt", {}, name), h("dd", {}, text)]);
}

const counted = (n, word) => `${n} ${word}${n === 1 ? "" : "s"}`;
const round = (number) => (number === null ? "unknown" : Number(number.toPrecision(4)));

/** Asks for a recording: an example, a file of this computer or of the session. */
export async function openRecording(store) {
  const found = await store.call("files");
  if (!found) return;
  const input = h("input", { type: "file", "aria-label": "File of this computer" });
  const take = (action) => async () => (await action()) !== undefined && dialog.close();
  const entry = (text, note, action) => h("li", {}, h("button", { type: "button", onclick: take(action) }, text), h("small", {}, note));
  const files = found.files.map((one) => entry(one.name, `${bytes(one.bytes)}, ${new Date(one.changed * 1000).toLocaleString()}`, () => store.call("open", { file: one.name })));
  const examples = found.examples.map((one) => entry(one.name, one.about, () => store.call("example", { name: one.name })));
  input.addEventListener("change", take(() => openFile(store, input.files[0])));
  const dialog = openDialog(
    "Open a recording",
    [
      h("h3", {}, "Example recordings"),
      h("ul", { class: "files" }, examples),
      h("h3", {}, "From this computer"),
      input,
      h("h3", {}, "Recent files"),
      files.length ? h("ul", { class: "files" }, files) : h("p", {}, "The folder of the session has no files yet."),
    ],
    [["Close", () => true]],
  );
}

const bytes = (count) => (count < 1e6 ? `${Math.ceil(count / 1e3)} kB` : `${(count / 1e6).toFixed(1)} MB`);

/** Sends a file to the folder of the session; returns its name, or undefined after a message. */
const send = (store, file) => attempt(() => upload(store.app, file));

async function openFile(store, file) {
  const name = file && (await send(store, file));
  return name && store.call("open", { file: name });
}

function listenForDrops(store, root) {
  root.addEventListener("dragover", (event) => {
    event.preventDefault();
    root.classList.add("dropping");
  });
  root.addEventListener("dragleave", () => root.classList.remove("dropping"));
  root.addEventListener("drop", (event) => {
    event.preventDefault();
    root.classList.remove("dropping");
    const [file] = event.dataTransfer.files;
    if (file) openFile(store, file);
  });
}

async function openOptions(store) {
  const { options, file, format } = store.recording;
  const fields = await store.call("file_options");
  if (!fields) return;
  const detected = (row) => (row.name === "format" ? [["", `detected: ${format}`], ...row.choices.slice(1)] : row.choices);
  const names = (rows) => rows.map((one) => [one.name, `${one.name}: ${one.about}`]);
  const { protocols } = store.tables;
  const form = makeForm([
    ...fields.map((row) => ({ ...row, choices: detected(row), value: options[row.name] ?? row.value })),
    { name: "step", label: "Time step after resampling", unit: "s", kind: "number", value: options.step, low: 0, note: "empty: the step of the file" },
    { name: "observe", label: "Observed rows", kind: "whole", value: options.observe, low: 1 },
    { name: "predict", label: "Predicted rows", kind: "whole", value: options.predict, low: 1 },
    { name: "protocol", label: "Protocol", kind: "choice", value: options.protocol, choices: names(protocols) },
    { name: "every", label: "Use every n-th window", kind: "whole", value: options.every, low: 1 },
    { name: "learn", label: "Share of the recording for learning goals", kind: "number", value: options.learn, low: 0, high: 0.99 },
    { name: "near", label: "Score only people this near to a robot", unit: "m", kind: "number", value: options.near, low: 0, note: "empty: everybody" },
    { name: "late", label: "People who appear during the observation", kind: "choice", value: options.late, choices: ["skip", "extrapolate"] },
  ]);
  const path = store.recording.path;
  const load = async () => (await store.call("open", { file: path, options: form.values() })) !== undefined;
  openDialog(`Options of ${file}`, form.element, [["Cancel", () => true], ["Load", load]]);
}

function openBackground(store) {
  const input = h("input", { type: "file", accept: "image/*", "aria-label": "Picture" });
  const form = makeForm([
    { name: "homography", label: "Homography from (column, row, 1) to the tracks", kind: "text", value: "", note: "nine numbers by rows, or one: metres per pixel; empty: that of the recording" },
  ]);
  const put = async () => {
    const [file] = input.files;
    if (!file) return (say("choose a picture first", "error"), false);
    const name = await send(store, file);
    return name !== undefined && (await store.call("background", { file: name, ...form.values() })) !== undefined;
  };
  openDialog("Background picture", [h("label", { class: "field" }, h("span", {}, "Picture of the ground, from above or from a fixed camera"), input), form.element], [["Cancel", () => true], ["Show", put]]);
}
