// Prediction tab.
import { h } from "../ui/dom.mjs";
import { makePane } from "../ui/layout.mjs";
import { makePlots } from "./plots.mjs";
import { makePredictorPanel } from "./predictor_panel.mjs";
import { makeRecordingPanel } from "./recording_panel.mjs";
import { makePersonPanel, makeResultsPanel } from "./results_panel.mjs";
import { makeRunPanel } from "./run_panel.mjs";
import { PredictionScene } from "./scene.mjs";
import { Store } from "./store.mjs";
import { makeToolbar } from "./toolbar.mjs";
import { Transport } from "./transport.mjs";
import { makeWelcome } from "./welcome.mjs";

export const prediction = {
  name: "prediction",
  title: "Prediction",
  mount(root, app) {
    const store = new Store(app);
    const scene = new PredictionScene(store);
    const transport = new Transport(store);
    scene.element.append(makeWelcome(store));
    const side = (...panels) => h("div", { class: "side" }, panels);
    root.classList.add("prediction", "panes");
    root.append(
      ...makePane("prediction", "Recording, predictors and run", side(makeRecordingPanel(store, root), makePredictorPanel(store), makeRunPanel(store)), "left"),
      h("div", { class: "panes rows" },
        h("div", { class: "middle" }, makeToolbar(store, scene), scene.element, scene.summary, transport.element),
        makePane("prediction", "Metrics", makeResultsPanel(store), "below")),
      ...makePane("prediction", "Person and plots", side(makePersonPanel(store), makePlots(store)), "right"),
    );
    addKeys(app, store, scene, transport);
    listen(app, store);
    return {
      store,
      scene,
      hide: () => transport.pause(),
      show: () => scene.draw(),
      greet: (state) => greet(store, state),
    };
  },
};

async function greet(store, state) {
  store.tables ??= await store.call("tables");
  store.take(state.stored ? ((await store.call("restore")) ?? state) : state);
  const log = await store.call("log");
  if (log) store.emit("log", log);
}

function listen(app, store) {
  app.connection.on("prediction.board", (board) => store.take(board));
  for (const name of ["lines", "progress", "ended", "note"]) {
    app.connection.on(`prediction.${name}`, (data) => {
      if (name === "progress") store.board.run = { active: true, share: data.share };
      store.emit(name, data);
      if (name === "lines" || name === "ended") store.load();
    });
  }
}

function addKeys(app, store, scene, transport) {
  app.keys.add("prediction", [
    [" ", "Play or pause", () => transport.toggle()],
    ["ArrowRight", "Next frame", () => transport.step(1)],
    ["ArrowLeft", "Previous frame", () => transport.step(-1)],
    ["Home", "First frame", () => store.go(0)],
    ["End", "Last frame", () => store.go(Infinity)],
    ["n", "Next person", () => scene.step(1)],
    ["p", "Previous person", () => scene.step(-1)],
    ["Escape", "No person", () => store.choose(null)],
    ["f", "Fit the scene", () => scene.fit()],
    ["+", "Zoom in", () => scene.zoom(1.25)],
    ["-", "Zoom out", () => scene.zoom(0.8)],
  ]);
}
