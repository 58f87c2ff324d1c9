// Dialogs of the editor: open a built-in trial or a file, bring a map or a file in, save.
import { openDialog } from "../ui/dialog.mjs";
import { attempt, say } from "../ui/messages.mjs";
import { field, h } from "../ui/dom.mjs";
import { upload } from "../ui/upload.mjs";
import { makeFloorScale } from "./floor_scale.mjs";

/** Shows what a trial may start from. */
export async function openSources(model, app, opened) {
  const sources = await model.call("sources");
  if (!sources) return;
  const start = async (args) => {
    opened();
    dialog.close();
    await model.step("start", args);
  };
  const button = (text, note, args) => h("li", {}, h("button", { type: "button", class: "link", onclick: () => start(args) }, text), note && h("small", {}, note));
  const filter = h("input", { type: "search", "aria-label": "Filter the trials", placeholder: "filter" });
  const list = h("ul", { class: "sources" }, sources.trials.map((one) => button(one.name, one.about, { trial: one.name })));
  filter.addEventListener("input", () => {
    for (const row of list.children) row.hidden = !row.textContent.includes(filter.value);
  });
  const chosen = h("input", { type: "file", multiple: true, accept: ".xml,.yaml,.pgm,.wkt,.geojson", onchange: () => send(chosen.files, app, start) });
  const dialog = openDialog(
    "Open a trial",
    h(
      "div",
      {},
      h("ul", { class: "sources" }, button("Empty trial", null, {}), sources.files.map((name) => button(name, "file in the folder of the app", { file: name }))),
      field("Trials (.xml), ROS maps (.yaml with its picture), areas (.wkt, .geojson)", chosen),
      floor(app, model, () => dialog.close()),
      sources.maps.length ? maps(sources.maps, model, () => dialog.close()) : null,
      h("h3", {}, "Built-in trials"),
      filter,
      list,
    ),
    [["Cancel", () => true]],
  );
}

/** Makes a map the stage of the trial. */
async function useMap(name, model) {
  const stage = model.state.tree.children.findIndex((one) => one.tag === "stage");
  if (stage < 0) await model.edit("insert", { path: [], xml: "<stage/>", position: 0 });
  await model.edit("change", { changes: [{ path: [Math.max(stage, 0)], name: "map", value: name }] });
}

function floor(app, model, close) {
  const scale = makeFloorScale();
  const use = async () => {
    const [name] = await uploadAll(scale.picture.files, app);
    const map = name && (await model.call("floor", { picture: name, resolution: Number(scale.size.value) }));
    if (!map) return;
    close();
    await useMap(map, model);
  };
  return h(
    "fieldset",
    {},
    h("legend", {}, "Stage from a picture of a floor plan: dark pixels are walls"),
    scale.element,
    h("button", { type: "button", onclick: use }, "Use as stage"),
  );
}

function maps(names, model, close) {
  const use = (name) => {
    close();
    return useMap(name, model);
  };
  return h("ul", { class: "sources" }, names.map((name) => h("li", {}, h("button", { type: "button", class: "link", onclick: () => use(name) }, `Use the map ${name} as stage`))));
}

/** Sends files to the folder of the app and returns their names there. */
async function uploadAll(files, app) {
  const names = [];
  for (const file of files) {
    const name = await attempt(() => upload(app, file));
    if (!name) break;
    names.push(name);
  }
  return names;
}

async function send(files, app, start) {
  for (const name of await uploadAll(files, app)) {
    say(`${name} is in the folder of the app`);
    if (name.endsWith(".xml")) await start({ file: name });
  }
}

/** Asks for a name and saves. */
export function saveAs(model) {
  const input = h("input", { type: "text", value: model.state.file || "new-trial.xml" });
  openDialog("Save the trial", field("Name in the folder of the app", input), [
    ["Cancel", () => true],
    [
      "Save",
      async () => {
        const state = await model.call("save", { file: input.value });
        if (!state) return false;
        model.take(state);
        say(`saved as ${state.file}`);
        return true;
      },
    ],
  ]);
}
