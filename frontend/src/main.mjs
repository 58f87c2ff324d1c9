// Entry of the page.
import { App } from "./ui/app.mjs";
import { tabs } from "./tabs.mjs";

window.crowdbot = new App(document.getElementById("app"), tabs);
