// Motion: frames as they come from the server, and what to draw between them, so that motion is smooth at any rate.
import { blendFrames, BlendBuffer } from "./blend.mjs";

/** Largest simulated time [s] between two frames that are blended: within it, a leg swings less than half a step. */
const SMOOTH = 0.3;
/** Limits of the time [ms] in which the newest frame is reached, and share of a new interval in its mean. */
const FASTEST = 12;
const SLOWEST = 250;
const LEARN = 0.25;
/** Frames that wait; more mean that the page is slow, and the oldest are skipped. */
const MOST = 3;

/**
 * Shows frames one interval late: at the arrival of a frame the shown time begins to move to that of the frame, at such
 * a rate that it arrives there when the next one is expected.
 */
export class Motion {
  constructor() {
    this._frames = [];
    this._buffer = new BlendBuffer();
    this._interval = 50;
    this._arrival = null;
    this._shown = 0;
    this._rate = 0;
    this._last = 0;
    this._drawn = null;
  }

  /** Whether the newest frame is not yet reached. */
  get moving() {
    return this._frames.length > 1 || (this._frames.length === 1 && this._drawn !== this._frames[0]);
  }

  /** The newest frame, or null. */
  get newest() {
    return this._frames.at(-1) ?? null;
  }

  clear() {
    this._frames = [];
    this._arrival = this._drawn = null;
  }

  /** Takes a frame at a time [ms]. A jump, or another description, is shown at once. */
  push(frame, now) {
    const before = this.newest;
    if (this._arrival !== null) {
      const gap = Math.min(SLOWEST, Math.max(FASTEST, now - this._arrival));
      this._interval += LEARN * (gap - this._interval);
    }
    this._arrival = now;
    const ahead = before ? frame.time - before.time : -1;
    if (!(ahead > 0 && ahead <= SMOOTH) || before.arrays.revision[0] !== frame.arrays.revision[0]) {
      this._frames = [frame];
      this._shown = frame.time;
      this._rate = 0;
    } else {
      this._move(now);
      this._frames.push(frame);
      if (this._frames.length > MOST) this._frames.splice(0, this._frames.length - MOST);
      this._shown = Math.max(this._shown, this._frames[0].time);
      this._rate = (frame.time - this._shown) / this._interval;
    }
    this._last = now;
  }

  /** Returns the frame to draw at a time [ms], or null. Its arrays are valid until the next call. */
  at(now) {
    this._move(now);
    if (!this._frames.length) return null;
    const [from, to] = this._frames;
    const share = to ? (this._shown - from.time) / (to.time - from.time) : 0;
    this._drawn = blendFrames(from, to ?? from, share, this._buffer);
    return this._drawn;
  }

  _move(now) {
    this._shown += this._rate * Math.max(0, now - this._last);
    this._last = now;
    while (this._frames.length > 1 && this._shown >= this._frames[1].time) this._frames.shift();
    if (this._frames.length === 1) {
      this._shown = this._frames[0].time;
      this._rate = 0;
    }
  }
}
