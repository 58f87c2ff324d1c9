// The tabs, in the order of the page; crowdbot.web.tabs has the desks behind them.
import { editor } from "./editor/tab.mjs";
import { evaluation } from "./evaluation/tab.mjs";
import { experiments } from "./experiments/tab.mjs";
import { jobs } from "./jobs/tab.mjs";
import { prediction } from "./prediction/tab.mjs";
import { vr } from "./vr/tab.mjs";
import { simulator } from "./simulator/tab.mjs";

export const tabs = [simulator, prediction, editor, evaluation, experiments, jobs, vr];
