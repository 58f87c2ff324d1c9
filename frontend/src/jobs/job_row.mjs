// A job in the list: state, progress, command, and what can be done with it.
import { h } from "../ui/dom.mjs";
import { copyText } from "../ui/copy.mjs";
import { dayAndTime } from "../ui/time.mjs";

const SIGNS = { waiting: "…", running: "▶", done: "✓", failed: "✗", cancelled: "■", interrupted: "!" };

const still = matchMedia("(prefers-reduced-motion: reduce)");

export const units = {
  bytes: (n) => (n < 1e6 ? `${(n / 1e3).toFixed(0)} kB` : n < 1e9 ? `${(n / 1e6).toFixed(1)} MB` : `${(n / 1e9).toFixed(2)} GB`),
  seconds: (n) => (n < 90 ? `${n.toFixed(0)} s` : n < 5400 ? `${(n / 60).toFixed(0)} min` : `${(n / 3600).toFixed(1)} h`),
};

/** Makes the row of a job; `actions` are functions of the job: cancel, again, log, results, remove. */
export function jobRow(job, actions) {
  const active = job.state === "waiting" || job.state === "running";
  const button = (text, action) => h("button", { type: "button", "aria-label": `${text} ${job.title}`, onclick: () => action(job) }, text);
  const bar = h("progress", { max: 1, value: job.share, "aria-label": `Progress of ${job.title}` });
  const words = h("span", { class: "note" }), log = h("span", { class: "note" });
  const update = (now) => {
    Object.assign(job, now);
    if (job.state === "running" && job.share === 0 && !still.matches) bar.removeAttribute("value");
    else bar.value = job.share;
    const share = active ? `${Math.round(100 * job.share)} %, ` : "";
    const since = dayAndTime(new Date(1000 * job.created));
    words.textContent = job.state === "waiting" ? `added ${since}` : `${share}${units.seconds(job.seconds)}, started ${since}`;
    log.textContent = active && job.note ? `Log: ${job.note}` : "";
    log.hidden = !log.textContent;
  };
  const copy = h("button", { type: "button", class: "link", onclick: () => copyText(job.command, "Copy as command line") }, "Copy command");
  const element = h(
    "li",
    { class: `job ${job.state}`, "data-number": job.number },
    h("div", { class: "job-head" }, h("span", { class: "sign", "aria-hidden": "true" }, SIGNS[job.state]), h("strong", {}, job.title), h("span", { class: "kind" }, job.kind), h("span", { class: "state" }, job.state)),
    active ? bar : null,
    words,
    log,
    job.problem ? h("p", { class: "problem" }, job.problem) : null,
    job.command ? h("p", { class: "command" }, h("code", {}, job.command)) : null,
    h(
      "div",
      { class: "row" },
      active ? button("Cancel", actions.cancel) : null,
      !active && job.words.length ? button(job.state === "done" ? "Run again" : "Continue", actions.again) : null,
      job.words.length ? button("Log", actions.log) : null,
      !active && job.results ? button("Results", actions.results) : null,
      !active ? button("Remove", actions.remove) : null,
      job.command ? copy : null,
    ),
  );
  update(job);
  return { element, update };
}
