// StateBuffer: the frames of the simulation, shown one interval late so that motion is smooth between them.
import { blendFrames } from "../scene/blend.mjs";

const LONGEST = 0.12;
const KEPT = 3;

export class StateBuffer {
  constructor() {
    this.delay = 0;
    this.interval = 0.05;
    this._frames = [];
    this._shown = null;
  }

  /** Takes a frame that arrived at a time [s]. */
  add(frame, arrival) {
    const last = this._frames.at(-1);
    if (last && last.frame.arrays.revision[0] !== frame.arrays.revision[0]) this._frames = [];
    if (last) {
      const gap = arrival - last.arrival;
      if (gap < LONGEST) this.interval += 0.1 * (gap - this.interval);
    }
    this._frames.push({ frame, arrival, stamp: frame.arrays.stamp?.[0] ?? NaN });
    while (this._frames.length > 2 && this._frames[1].arrival < arrival - this.delay - KEPT) this._frames.shift();
  }

  /** Returns {frame, stamp} to show at a time [s]; stamp is that of the server, null if nothing has changed. */
  at(time) {
    const wish = time - this.interval - this.delay;
    let k = this._frames.length - 1;
    while (k > 0 && this._frames[k].arrival > wish) k -= 1;
    const [from, to] = [this._frames[k], this._frames[k + 1]];
    if (!from || (!to && from.arrival > wish && this.delay > 0)) return null;
    const share = to ? Math.max(0, Math.min(1, (wish - from.arrival) / (to.arrival - from.arrival))) : 0;
    const stamp = to ? from.stamp + share * (to.stamp - from.stamp) : from.stamp;
    const fresh = stamp !== this._shown;
    this._shown = stamp;
    return { frame: to ? blendFrames(from.frame, to.frame, share) : from.frame, stamp: fresh ? stamp : null };
  }

  /** Forgets the frames of another scene. */
  clear() {
    this._frames = [];
    this._shown = null;
  }
}
