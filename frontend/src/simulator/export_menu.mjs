// Export menu: the run as a command line or as Python, and the picture as a file.
import { copyText } from "../ui/copy.mjs";
import { attempt, say } from "../ui/messages.mjs";
import { h } from "../ui/dom.mjs";
import { save } from "../ui/save.mjs";

/** Makes the menu. */
export function makeExport(app, picture) {
  const copy = (command, title) => async () => {
    const text = await attempt(() => app.connection.call(`simulator.${command}`));
    if (text !== undefined) await copyText(text, title);
  };
  const actions = [
    ["Copy as command line", copy("command_line", "Copy as command line")],
    ["Copy as Python", copy("python", "Copy as Python")],
    ["Picture as PNG", async () => {
      const file = await picture.png();
      if (file) save(file, "crowdbot.png");
      else say("there is no picture yet", "error");
    }],
  ];
  const menu = h("select", { "aria-label": "Export or copy" }, h("option", { value: "" }, "Export or copy…"), actions.map(([text], k) => h("option", { value: String(k) }, text)));
  menu.addEventListener("change", () => {
    const [, action] = actions[Number(menu.value)];
    menu.value = "";
    action();
  });
  return menu;
}
