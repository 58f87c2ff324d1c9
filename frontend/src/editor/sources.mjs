// Dialogs of the editor: open a built-in trial or a file, bring a map or a file in, save.
import { attempt, openDialog, say } from "../ui/dialog.mjs";
import { field, h } from "../ui/dom.mjs";

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
  const upload = h("input", { type: "file", multiple: true, accept: ".xml,.yaml,.pgm,.png,.wkt,.geojson", onchange: () => send(upload.files, app, model, start) });
  const dialog = openDialog(
    "Open a trial",
    h(
      "div",
      {},
      h("ul", { class: "sources" }, button("Empty trial", null, {}), sources.files.map((name) => button(name, "file of this session", { file: name }))),
      field("Trials (.xml), ROS maps (.yaml with its picture), areas (.wkt, .geojson)", upload),
      sources.maps.length ? maps(sources.maps, model, () => dialog.close()) : null,
      h("h3", {}, "Built-in trials"),
      filter,
      list,
    ),
    [["Cancel", () => true]],
  );
}

function maps(names, model, close) {
  const use = async (name) => {
    close();
    const stage = model.state.tree.children.findIndex((one) => one.tag === "stage");
    if (stage < 0) await model.edit("insert", { path: [], xml: "<stage/>", position: 0 });
    await model.edit("change", { changes: [{ path: [Math.max(stage, 0)], name: "map", value: name }] });
  };
  return h("ul", { class: "sources" }, names.map((name) => h("li", {}, h("button", { type: "button", class: "link", onclick: () => use(name) }, `Use the map ${name} as stage`))));
}

async function send(files, app, model, start) {
  for (const file of files) {
    const url = `api/${app.connection.session}/upload?${new URLSearchParams({ name: file.name })}`;
    const done = await attempt(async () => {
      const answer = await fetch(url, { method: "POST", body: file });
      if (!answer.ok) throw new Error((await answer.text()).trim());
      return answer.json();
    });
    if (!done) return;
    say(`${done.name} is in the folder of the app`);
    if (done.name.endsWith(".xml")) await start({ file: done.name });
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
