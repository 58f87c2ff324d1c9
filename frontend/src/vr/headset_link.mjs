// HeadsetLink: the socket of a headset: poses to the server, its clock and touches back.
import { encodeFrame } from "./encode_frame.mjs";

const RETRY = 1000;
const BEHIND = 1 << 16;

/** Time of the headset [s]. */
export const now = () => performance.now() / 1000;

export class HeadsetLink {
  /**
   * @param {string} session name of the session
   * @param {(message: object) => void} tell called with the messages of the server
   */
  constructor(session, tell) {
    this.sent = 0;
    this.skipped = 0;
    this.avatar = null;
    this._before = null;
    this.refusal = "";
    this.answered = -Infinity;
    this.offset = NaN;
    this._session = session;
    this._tell = tell;
    this._exchange = null;
    this._best = Infinity;
    this._wanted = true;
    this._connect();
  }

  get open() {
    return this._socket.readyState === WebSocket.OPEN && this.avatar !== null;
  }

  /** Whether the server has not answered for a second. */
  get silent() {
    return now() - this.answered > 1;
  }

  /** Sends poses; a message that would wait in a queue is left out, since the next one is newer. */
  send(time, arrays) {
    if (!this.open) return false;
    if (this._socket.bufferedAmount > BEHIND) {
      this.skipped += 1;
      return false;
    }
    const all = this._exchange ? [...arrays, ["clock", this._exchange]] : arrays;
    this._exchange = null;
    this._socket.send(encodeFrame("headset", ++this.sent, time, all));
    return true;
  }

  close() {
    this._wanted = false;
    this._socket.close(1000, "the participant leaves");
  }

  _connect() {
    const url = new URL(`api/${this._session}/headset`, location.href);
    if (this._before) url.searchParams.set("avatar", this._before);
    url.protocol = url.protocol.replace("http", "ws");
    const socket = new WebSocket(url);
    socket.onmessage = (event) => this._receive(JSON.parse(event.data), now());
    socket.onclose = () => {
      this.avatar = null;
      this.answered = -Infinity;
      this._best = Infinity;
      if (this._wanted) setTimeout(() => this._wanted && this._connect(), RETRY);
    };
    this._socket = socket;
  }

  _receive(message, at) {
    if (message.clock) {
      const [sent, arrived, answered] = message.clock;
      this.answered = at;
      this._exchange = new Float64Array([sent, arrived, answered, at]);
      const delay = at - sent - (answered - arrived);
      if (delay < this._best) {
        this._best = delay;
        this.offset = 0.5 * (arrived - sent + answered - at);
      }
      return;
    }
    if (message.joined) {
      this.avatar = message.joined;
      this.refusal = "";
      this.sent = 0;
      this.answered = at;
    }
    if (message.avatar) this.avatar = message.avatar;
    if (this.avatar) this._before = this.avatar;
    if (message.refused) this.refusal = message.refused;
    this._tell(message);
  }
}
