// EpisodePanel: events of a recorded episode, and branches of it.
import { openDialog } from "../ui/dialog.mjs";
import { attempt, say } from "../ui/messages.mjs";
import { fill, h } from "../ui/dom.mjs";
import { makeForm } from "../ui/form.mjs";

export class EpisodePanel {
  /** @param {{transport, library, names()}} parts */
  constructor(app, parts) {
    this.app = app;
    this.parts = parts;
    this.events = [];
    this.list = h("ol", { class: "events" });
    this.branch = h("button", { type: "button", onclick: () => this._dialog() }, "Branch from here…");
    this.share = h("progress", { "aria-label": "Progress of the branch", max: 1, value: 0, hidden: true });
    this.element = h("details", { open: true, hidden: true }, h("summary", {}, "Episode"), this.branch, this.share,
      h("p", { class: "faint" }, "Keys J and K jump to the event before and after"), this.list);
    app.connection.on("simulator.branch", (state) => this._progress(state));
  }

  /** Shows events [{time, kind, about}]. */
  show(events) {
    this.events = events;
    fill(this.list, events.map((one) => h("li", { class: one.kind.replace(" ", "-") },
      h("button", { type: "button", onclick: () => this.parts.transport.seek(one.time) }, `${one.time.toFixed(1)} s  ${one.kind}: ${one.about}`))));
    if (!events.length) fill(this.list, h("li", { class: "faint" }, "No contact, fall, near miss or stall"));
  }

  /** Jumps to the next event (1) or to the one before (-1). */
  jump(way) {
    const now = this.parts.transport.status.time;
    const ahead = this.events.filter((one) => (way > 0 ? one.time > now + 0.05 : one.time < now - 0.05));
    const found = way > 0 ? ahead[0] : ahead.at(-1);
    if (found) this.parts.transport.seek(found.time);
  }

  _dialog() {
    const at = this.parts.transport.status.time;
    const form = makeForm([
      { name: "navigator", label: "Navigator of the robot", kind: "choice", value: "", choices: [["", "as recorded"], ...this.parts.names().navigators] },
      { name: "more", label: "Other values, such as robot/drive/max-speed=0.3", kind: "text", value: "" },
    ]);
    const start = async () => {
      const { navigator, more } = form.values();
      const changes = Object.fromEntries(more.split(/\s+/).filter(Boolean).map((one) => [one.split("=")[0], one.slice(one.indexOf("=") + 1)]));
      if (navigator) changes["robot/navigator/type"] = navigator;
      return (await attempt(() => this.app.connection.call("simulator.branch", { at, changes }))) !== undefined;
    };
    openDialog(`Branch at ${at.toFixed(1)} s`, form.element, [["Cancel", () => true], ["Branch", start]]);
  }

  async _progress({ name, share, done, error, at, outcome }) {
    this.share.hidden = done === true || error !== undefined;
    this.share.value = share ?? 0;
    if (error) return say(error, "error");
    if (!done) return undefined;
    say(`${name}: ${outcome}`);
    await this.parts.library.loadEpisodes();
    return this.parts.library.openEpisode(name, at);
  }
}
