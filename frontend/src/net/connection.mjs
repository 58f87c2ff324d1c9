// Connection: commands to the server, events and state frames back. Connects again when the server or the net was away.
import { decodeFrame } from "./state_frame.mjs";

const RETRY = [250, 500, 1000, 2000];

export class Connection extends EventTarget {
  /**
   * @param {string} session name of the session
   * @param {string} socket name of the socket of the server
   * @param {() => object} query values for the server, at each connection
   */
  constructor(session, socket = "socket", query = () => ({})) {
    super();
    this._name = socket;
    this._query = query;
    this.session = session;
    this._calls = new Map();
    this._frames = new Map();
    this._number = 0;
    this._failures = 0;
    this._connect();
  }

  /** Whether a command reaches the server; a socket that is closing takes none, although "lost" comes later. */
  get open() {
    return this._socket.readyState === WebSocket.OPEN;
  }

  /** Whether a command waits for its answer. */
  get busy() {
    return this._calls.size > 0;
  }

  /** Calls a command such as "simulator.open" and returns its result; rejects with the sentence of the server. */
  call(address, args = {}) {
    return new Promise((resolve, reject) => {
      if (!this.open) return reject(new Error("the server is not connected"));
      const id = ++this._number;
      this._calls.set(id, { resolve, reject });
      this._socket.send(JSON.stringify({ id, call: address, args }));
    });
  }

  /** Calls listener(data) at each event such as "simulator.status"; returns a function that ends it. */
  on(event, listener) {
    const wrap = (one) => listener(one.detail);
    this.addEventListener(event, wrap);
    return () => this.removeEventListener(event, wrap);
  }

  /**
   * Sets the function that draws the frames of a channel; it may return a promise. The server sends the frames of channels
   * that are drawn and shown; `shown()` is asked at each call of `tellWants`.
   */
  draw(channel, listener, shown = () => true) {
    this._frames.set(channel, { listener, shown });
    this.tellWants();
  }

  /** Tells the server which channels are shown, if this has changed. */
  tellWants() {
    const wants = [...this._frames].filter(([, one]) => one.shown()).map(([channel]) => channel);
    if (!this.open || wants.join() === this._wants) return;
    this._wants = wants.join();
    this._socket.send(JSON.stringify({ wants }));
  }

  /** Address of a file of a desk. */
  address(desk, path, query = {}) {
    const words = new URLSearchParams(query).toString();
    return `api/${this.session}/${desk}/${path}${words ? `?${words}` : ""}`;
  }

  _connect() {
    const url = new URL(`api/${this.session}/${this._name}`, location.href);
    url.protocol = url.protocol.replace("http", "ws");
    url.search = new URLSearchParams(this._query());
    const socket = new WebSocket(url);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      this._failures = 0;
      this._wants = null;
      this.tellWants();
      this._emit("connected");
    };
    socket.onmessage = (message) => this._receive(message.data);
    socket.onclose = () => this._lost();
    this._socket = socket;
  }

  async _receive(data) {
    if (typeof data !== "string") {
      const frame = decodeFrame(data);
      try {
        await this._frames.get(frame.channel)?.listener(frame);
      } finally {
        if (this.open) this._socket.send(JSON.stringify({ drawn: frame.sequence }));
      }
      return;
    }
    const message = JSON.parse(data);
    if (message.event) return this._emit(message.event, message.data);
    const call = this._calls.get(message.id);
    this._calls.delete(message.id);
    if ("error" in message) call?.reject(new Error(message.error));
    else call?.resolve(message.result);
  }

  _lost() {
    for (const { reject } of this._calls.values()) reject(new Error("the connection to the server was lost"));
    this._calls.clear();
    this._emit("lost");
    const wait = RETRY[Math.min(this._failures++, RETRY.length - 1)];
    setTimeout(() => this._connect(), wait);
  }

  _emit(event, data) {
    this.dispatchEvent(new CustomEvent(event, { detail: data }));
  }
}
