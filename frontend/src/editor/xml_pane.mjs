// XmlPane: the text of the trial, editable; changes are sent when typing stops.
import { h } from "../ui/dom.mjs";

const PAUSE = 400;

export class XmlPane {
  constructor(root, model) {
    Object.assign(this, { model, timer: 0, base: "", sent: "", sending: false, offline: false });
    this.numbers = h("pre", { class: "numbers", "aria-hidden": "true" });
    this.area = h("textarea", { spellcheck: "false", "aria-label": "XML of the trial", wrap: "off", oninput: () => this.wait() });
    this.area.addEventListener("scroll", () => (this.numbers.scrollTop = this.area.scrollTop));
    this.area.addEventListener("blur", () => this.send());
    root.append(this.numbers, this.area);
  }

  /** Shows the text of the server unless the user is typing. */
  update() {
    if (this.offline) return this.resume();
    if (this.timer) return;
    if (this.area.value !== this.model.state.text) {
      const at = this.area.selectionStart;
      this.area.value = this.model.state.text;
      this.area.setSelectionRange(at, at);
    }
    this.count();
  }

  /** After the server was away: sends what was typed meanwhile, or asks if the trial has changed. */
  resume() {
    this.offline = false;
    const { text } = this.model.state;
    if (text === this.base || text === this.sent) return void this.send(); // the last text may have arrived unanswered
    this.timer = 0;
    this.model.emit("conflict");
  }

  count() {
    const wrong = new Set(this.model.state.problems.map((one) => one.line));
    const lines = this.area.value.split("\n").length;
    this.numbers.textContent = Array.from({ length: lines }, (_, i) => `${wrong.has(i + 1) ? "!" : " "}${i + 1}`).join("\n");
  }

  /** Puts the cursor on a line. */
  show(line) {
    const lines = this.area.value.split("\n");
    const begin = lines.slice(0, line - 1).join("\n").length + (line > 1 ? 1 : 0);
    this.area.focus();
    this.area.setSelectionRange(begin, begin + (lines[line - 1] ?? "").length);
    this.area.scrollTop = Math.max(0, (line - 4) * 18);
  }

  wait() {
    if (!this.timer) this.base = this.model.state.text;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.send(), PAUSE);
    this.count();
  }

  /** Sends the text; while one is on its way, the pane waits for the answer, since it brings the next revision. */
  async send() {
    if (!this.timer) return;
    clearTimeout(this.timer);
    if (this.sending) return;
    if (!this.model.connection.open) return void (this.offline = true);
    const text = this.area.value;
    this.sent = text;
    this.sending = true;
    const done = await this.model.edit("write", { text }).finally(() => (this.sending = false));
    if (!done && !this.model.connection.open) return void (this.offline = true);
    if (done) this.base = text;
    if (this.area.value !== text) {
      clearTimeout(this.timer);
      this.timer = setTimeout(() => this.send(), PAUSE);
      return;
    }
    this.timer = 0;
    if (!done) {
      // The trial was changed elsewhere: the typed text stays in the pane until it is sent on top of that change.
      this.model.emit("conflict");
    }
  }

  /** After a conflict: sends the typed text, or takes the one of the server. */
  async resolve(mine) {
    if (mine) await this.model.edit("write", { text: this.area.value });
    else this.area.value = this.model.state.text;
    this.update();
  }
}
