// Colours of scenes, for the light and the dark theme. Colours of data are those of Okabe and Ito.
export const LOOKS = {
  light: {
    sky: "#e6ebf1", floor: "#e9ecef", line: "#d3d9de", line10: "#c3cbd2", wall: "#dfe4e9", wallTop: "#6c7884",
    ground: "#d9c9ad", prop: "#c79f63", door: "#2a7f9e", ink: "#1b2733", shade: 0.34, sun: 2.0, dome: 1.75,
    start: "#0072b2", goal: "#009e73", source: "#56b4e9", exit: "#d55e00", portal: "#cc79a7", stop: "#e69f00",
    scan: "#d1431f", cloud: "#8a4fd0", cone: "#e69f00", force: "#c2185b", path: "#5b3fa0", robotGoal: "#d55e00", mark: "#d55e00",
  },
  dark: {
    sky: "#171e26", floor: "#3a444f", line: "#4a5561", line10: "#617080", wall: "#6a7886", wallTop: "#a9b7c4",
    ground: "#6b5d45", prop: "#a97f45", door: "#4fb3d4", ink: "#e8edf2", shade: 0.6, sun: 2.0, dome: 1.6,
    start: "#56b4e9", goal: "#2fd0a0", source: "#7cc7f0", exit: "#ff8a3d", portal: "#e79ac4", stop: "#f2b84b",
    scan: "#ff7a4d", cloud: "#b99cff", cone: "#f2b84b", force: "#ff5c9a", path: "#b7a1ff", robotGoal: "#ff8a3d", mark: "#ff9a52",
  },
};

const ZONES = {
  start: "Start of people", goal: "Goal of people", source: "Entrance", exit: "Exit", portal: "Portal", stop: "Stop of a journey",
};
/** Colours of layers that have one colour. */
const COLOURS = { scans: "scan", clouds: "cloud", ranges: "cone", forces: "force", goals: "goal" };
/** Layers of points. */
const DOTTED = new Set(["scans", "clouds"]);

/** Rows of the legend for zones that a scene has, and for visible layers of one colour: [{color, text, width, dotted?}]. */
export function sceneLegend(description, layers, look) {
  const visible = layers.filter((one) => one.visible);
  const zones = visible.some((one) => one.name === "zones") ? description.zones.map((one) => one.kind) : null;
  const rows = Object.keys(ZONES).filter((kind) => zones?.includes(kind)).map((kind) => ({ color: look[kind], text: ZONES[kind], width: 10 }));
  if (zones && description.robots.some((one) => !one.ghost)) rows.push({ color: look.robotGoal, text: "Goal of a robot", width: 3 });
  return [...rows, ...visible.flatMap(({ name, title }) => (COLOURS[name] ? [{ color: look[COLOURS[name]], text: title, width: 3, dotted: DOTTED.has(name) }] : []))];
}

/** Layers that a picture draws from the description and every frame; the others are asked for by name. */
export const OWN_LAYERS = [
  { name: "people", title: "People", visible: true },
  { name: "robots", title: "Robots", visible: true },
  { name: "walls", title: "Walls", visible: true },
  { name: "props", title: "Props and doors", visible: true },
  { name: "zones", title: "Zones", visible: true },
  { name: "grid", title: "Grid of 1 m", visible: true },
  { name: "shadows", title: "Shadows", visible: true },
  { name: "ids", title: "Numbers", visible: false },
];
