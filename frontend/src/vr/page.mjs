// VrPage: the page of a participant: the scene on the screen, and in the headset after "Enter VR".
import * as THREE from "three";
import { Connection } from "../net/connection.mjs";
import { Scene3D } from "../scene3d/scene3d.mjs";
import { fill, h } from "../ui/dom.mjs";
import { HeadsetLink, now } from "./headset_link.mjs";
import { Limits } from "./limits.mjs";
import { Board } from "./board.mjs";
import { EYE_FEATURES, readPoses, vibrate } from "./headset_poses.mjs";
import { Mirror } from "./mirror.mjs";
import { Pointers } from "./pointers.mjs";
import { Room } from "./room.mjs";
import { SceneFeed } from "./scene_feed.mjs";
import { emptyRoom, experimentScreen, pauseText, stopScreen } from "./screens.mjs";

const FEATURES = { requiredFeatures: ["local-floor"], optionalFeatures: ["hand-tracking", ...EYE_FEATURES] };
const SLOW = 1.5;

export class VrPage {
  constructor(root) {
    const address = new URLSearchParams(location.hash.slice(1));
    this.session = address.get("session") ?? "main";
    this.connection = new Connection(this.session, "headset-window");
    this.room = new Room();
    this.robotLimits = new Limits("#0ca5b8");
    this.link = null;
    this.state = null;
    this.status = null;
    this.experiment = null;
    this.menu = false;
    this.work = 0;
    this.pictures = 0;
    this.dropped = 0;
    this.touches = [];
    this._xr = null;
    this._ownBefore = null;
    this._layout(root);
    this._listen();
    requestAnimationFrame(() => this._tick());
  }

  /** Whether the headset shows the scene. */
  get immersed() {
    return this._xr !== null;
  }

  _layout(root) {
    this.canvas = h("canvas", { class: "vr-stage", role: "img", "aria-label": "Picture of the virtual room" });
    this.button = h("button", { type: "button", class: "main", disabled: true, onclick: () => this.enter() }, "Enter VR");
    this.note = h("p", { role: "status" }, "connecting");
    fill(root, this.canvas, h("main", { class: "vr-panel" }, h("h1", {}, "crowdbot"), this.note, this.button));
    this.scene = new Scene3D(this.canvas, (path, query) => this.feed.address(path, query));
    this.feed = new SceneFeed(this.connection, this.scene, (text) => this._say(text));
    this.feed.listen(now);
    this.scene.engine.scene.add(this.room.group, this.robotLimits.group);
    this.board = new Board({ draft: (answers) => this._draft(answers), finish: (answers) => this._finish(answers) });
    this.pointers = new Pointers(this.board);
    this.mirror = new Mirror(this.scene, [this.board.mesh, this.pointers.group]);
    this.room.rig.add(this.board.mesh, this.pointers.group, this.mirror.group);
    this._measureDrawing();
  }

  _listen() {
    this.connection.on("connected", () => this._offer());
    this.connection.on("lost", () => this._say("The server is not connected; trying again."));
    this.connection.on("hello", ({ desks }) => {
      if (!desks.vr) return this._say("This server has no virtual reality: start it with crowdbot app.");
      this._take(desks.vr);
      this.status = desks.simulator?.status ?? null;
      this._takeExperiment(desks.experiments);
      return this.feed.ask();
    });
    this.connection.on("vr.state", (state) => this._take(state));
    this.connection.on("simulator.status", (status) => {
      this.status = status;
    });
    this.connection.on("experiments.state", (state) => this._takeExperiment(state));
    this.connection.on("simulator.opened", () => this.feed.clear());
  }

  async _offer() {
    if (!navigator.xr) {
      return this._say(isSecureContext ? "This browser has no WebXR: open this page in the browser of a headset." : "WebXR needs HTTPS: start the server with crowdbot app --vr.");
    }
    if (!(await navigator.xr.isSessionSupported("immersive-vr"))) return this._say("No headset is connected to this browser.");
    this.button.disabled = false;
    return this._say("Put the headset on and enter.");
  }

  _say(text) {
    this.note.textContent = text;
  }

  _take(state) {
    this.state = state;
    this.room.set(state.rooms[this._participant()?.room ?? "person"]);
    this.robotLimits.set(state.rooms.robot);
    this.robotLimits.show(state.robot_margin ?? Infinity);
    this.feed.delay = this._participant()?.picture_delay ?? state.settings.picture_delay;
  }

  _takeExperiment(state) {
    this.experiment = state ?? null;
    if (state?.open && state.phase === "running") this.feed.choose("experiments");
    else if (!state?.open) this.feed.choose("simulator");
  }

  _draft(answers) {
    this.connection.call("experiments.draft", { index: this.experiment.index, answers }).catch((error) => this.board.complain(error.message));
  }

  _finish(answers) {
    const { index } = this.experiment;
    this.connection.call("experiments.finish_screen", { index, answers }).catch((error) => this.board.complain(error.message));
  }

  /** Notes the time that drawing takes, so that `work` is the time of our own functions in a picture [ms]. */
  _measureDrawing() {
    const { renderer } = this.scene.engine;
    const render = renderer.render.bind(renderer);
    this._drawing = 0;
    let depth = 0;
    renderer.render = (...args) => {
      const begin = performance.now();
      depth += 1;
      render(...args);
      depth -= 1;
      if (!depth) this._drawing += performance.now() - begin;
    };
  }

  /** Enters virtual reality; the browser asks the participant first. */
  async enter() {
    try {
      const session = await navigator.xr.requestSession("immersive-vr", FEATURES);
      const { renderer } = this.scene.engine;
      renderer.xr.enabled = true;
      renderer.xr.setReferenceSpaceType("local-floor");
      session.addEventListener("end", () => this._leave());
      await renderer.xr.setSession(session);
      this._xr = session;
      this.link = new HeadsetLink(this.session, (message) => this._hear(message));
      this._last = now();
      renderer.setAnimationLoop((_, frame) => frame && this._draw(frame));
      this.button.disabled = true;
      this._say("In virtual reality.");
    } catch (error) {
      this._say(`The headset cannot be entered: ${error.message}`);
    }
  }

  _leave() {
    const { renderer } = this.scene.engine;
    renderer.setAnimationLoop(null);
    renderer.xr.enabled = false;
    this.link?.close();
    this.link = null;
    this._xr = null;
    this.scene.empty = false;
    this._offer();
    requestAnimationFrame(() => this._tick());
  }

  _hear(message) {
    if (message.refused) this._say(message.refused);
    if (!message.touch) return;
    this.touches.push(message.touch);
    while (this.touches.length > 50) this.touches.shift();
    if (this._xr) vibrate(this._xr, message.touch.side, message.touch.strength);
  }

  /** Draws on the screen while nobody is in the headset. */
  _tick() {
    if (this._xr) return;
    requestAnimationFrame(() => this._tick());
    if (!this.feed.show(now()) || document.hidden) return;
    this.scene.render();
  }

  _draw(frame) {
    const time = now();
    this._drawing = 0;
    const { renderer } = this.scene.engine;
    const poses = readPoses(frame, renderer.xr.getReferenceSpace());
    const shown = this.feed.show(time);
    const seconds = time - this._last;
    const rate = this._xr.frameRate ?? 72;
    if (this.pictures > 0 && seconds > SLOW / rate) this.dropped += Math.round(seconds * rate) - 1;
    this._last = time;
    const arrays = [...poses.arrays, ["dropped", new Uint32Array([this.dropped])]];
    if (shown && shown.stamp !== null && this._finished) arrays.push(["pictures", new Float64Array([shown.stamp, time]), 2]);
    this.link.send(time, arrays);
    this.room.update(poses);
    this._warn(poses.tracked, seconds);
    this._showBoard(poses, seconds);
    const eye = this.room.camera.getWorldPosition(new THREE.Vector3());
    const body = this._bodyShown();
    if (body && !this.board.shown) this.room.hideHands(); // before the board, the plain hands are drawn in front of it
    this.scene.renderFrom(this.room.camera, eye, this._own(), body);
    this.work = 1000 * (now() - time) - this._drawing;
    this._finished = true;
    this.pictures += 1;
  }

  /** Hides the picture while tracking is lost, and says why the world stands still. */
  _warn(tracked, seconds) {
    const lost = !tracked;
    const cut = this.link.silent;
    this.room.fade(lost ? 1 : cut ? 0.75 : 0, seconds);
    const refusal = this.link.refusal;
    if (lost) this.room.say("Tracking is lost.\nStand still.");
    else if (refusal) this.room.say(refusal);
    else if (cut) this.room.say("The connection is lost.\nStand still or take the headset off.");
    else if (!this.scene.state.frame) this.room.say("Loading the room.");
    else if (this._posing()) this.room.say("Stand upright.\nStretch both arms out to the sides\nand hold still.");
    else if (!this.experiment?.open && this.status?.state === "paused") this.room.say(this._pauseText("operator"));
    else this.room.say("");
  }

  /** Shows the screen of the experiment, or what the participant can do after a stop, and takes answers. */
  _showBoard(poses, seconds) {
    const eye = poses.head && new THREE.Vector3().copy(poses.head.position);
    const ahead = poses.head && new THREE.Vector3(0, 0, -1).applyQuaternion(poses.head.orientation);
    const close = () => {
      this.menu = false;
    };
    const pause = () => this.connection.call("vr.pause", { avatar: this.link?.avatar ?? "" }).then(close, (error) => this.board.complain(error.message));
    this.board.set(this.menu ? stopScreen(pause, close) : experimentScreen(this.experiment, this._pauseText("experimenter")), eye, ahead);
    this.scene.empty = this.board.shown && !this.menu && !this.state?.mirror && emptyRoom(this.experiment);
    this.mirror.show(Boolean(this.state?.mirror), eye, ahead);
    if (!this.pointers.update(poses, seconds)) return;
    this.menu = true;
    this.connection.call("vr.stop_robots").catch((error) => this.board.complain(error.message));
  }

  _pauseText(operator) {
    return pauseText(this.state?.pause ?? null, this.link?.avatar ?? null, operator);
  }

  _bodyShown() {
    return !this.scene.empty && Boolean(this.state?.own_body || this.mirror.shown) && this._own() !== null;
  }

  _posing() {
    return this.state?.pose?.avatar === this.link.avatar && this.link.avatar !== null;
  }

  /** What the server says about this participant. */
  _participant() {
    return this.state?.participants.find((one) => one.avatar === this.link?.avatar);
  }

  /** Id of the participant's own avatar, or null; between two trials it is that of the picture that still stands. */
  _own() {
    const id = this._participant()?.id ?? null;
    if (id !== null) this._ownBefore = id;
    const between = this.experiment?.open && this.experiment.phase !== "running";
    return id ?? (between ? this._ownBefore : null);
  }
}
