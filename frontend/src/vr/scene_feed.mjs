// SceneFeed: the state that the headset shows: the trial of the simulator, or that of an experiment.
import { unpackBones } from "./bone_triples.mjs";
import { SceneGone } from "../net/state_frame.mjs";
import { StateBuffer } from "./state_buffer.mjs";

const CHANNELS = { scene: "simulator", trial: "experiments" };

export class SceneFeed {
  /**
   * @param {Connection} connection
   * @param {Scene3D} scene
   * @param {(text: string) => void} say called with what went wrong
   */
  constructor(connection, scene, say) {
    Object.assign(this, { connection, scene, say });
    this.desk = "simulator";
    this.delay = 0;
    this._loading = null;
    this._buffers = Object.fromEntries(Object.values(CHANNELS).map((desk) => [desk, new StateBuffer()]));
  }

  /** Calls listener when frames arrive, with the time at which they do [s]. */
  listen(now) {
    for (const [channel, desk] of Object.entries(CHANNELS)) {
      this.connection.draw(channel, (frame) => this._buffers[desk].add(unpackBones(frame), now()));
    }
  }

  /** Address of a mesh. */
  address(path, query) {
    return this.connection.address(this.desk, path, query);
  }

  /** Shows what a desk runs. */
  choose(desk) {
    if (desk === this.desk) return;
    this.desk = desk;
    this._buffers[desk].clear();
    this.ask();
  }

  /** Asks for the state, since this window has not seen it. */
  ask() {
    this.connection.call(`${this.desk}.show_frame`).catch(() => {});
  }

  /** Forgets the states of another scene. */
  clear() {
    this._buffers.simulator.clear();
  }

  /** Applies the state for a time [s]; returns {frame, stamp} with the stamp of the server, or null. */
  show(time) {
    const buffer = this._buffers[this.desk];
    buffer.delay = this.delay;
    const found = buffer.at(time);
    if (!found) return this.scene.state.frame ? { frame: null, stamp: null } : null;
    if (!this._loading && this.scene.state.frame !== found.frame && !this.scene.apply(found.frame)) this._load();
    return this.scene.state.frame ? found : null;
  }

  _load() {
    this._loading = this.connection
      .call(`${this.desk}.description`)
      .then((description) => (description.revision === undefined ? null : this.scene.load(description)))
      .then(() => this.ask())
      .catch((error) => error instanceof SceneGone || this.say(error.message))
      .finally(() => {
        this._loading = null;
      });
  }
}
