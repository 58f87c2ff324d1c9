// A command is refused while the socket closes: the browser would log an error and forget it.
import assert from "node:assert/strict";
import { test } from "node:test";

class FakeSocket {
  static OPEN = 1;
  constructor() {
    this.readyState = FakeSocket.OPEN;
    this.sent = [];
    FakeSocket.last = this;
  }
  send(text) {
    assert.equal(this.readyState, FakeSocket.OPEN);
    this.sent.push(JSON.parse(text));
  }
}
globalThis.location = new URL("http://127.0.0.1:8700/");
globalThis.WebSocket = FakeSocket;
const { Connection } = await import("../src/net/connection.mjs");

test("a command reaches an open socket and is answered", async () => {
  const connection = new Connection("main");
  const answer = connection.call("simulator.ping", {});
  assert.deepEqual(FakeSocket.last.sent, [{ id: 1, call: "simulator.ping", args: {} }]);
  FakeSocket.last.onmessage({ data: '{"id": 1, "result": 7}' });
  assert.equal(await answer, 7);
});

test("the server is told which channels are shown, at each connection and once", () => {
  const connection = new Connection("main");
  let shown = false;
  connection.draw("scene", () => {});
  connection.draw("trial", () => {}, () => shown);
  connection.tellWants();
  shown = true;
  connection.tellWants();
  assert.deepEqual(FakeSocket.last.sent, [{ wants: ["scene"] }, { wants: ["scene", "trial"] }]);
  connection._connect();
  FakeSocket.last.onopen();
  assert.deepEqual(FakeSocket.last.sent, [{ wants: ["scene", "trial"] }]);
});

test("nothing is sent to a socket that closes", async () => {
  const connection = new Connection("main");
  FakeSocket.last.readyState = 2;
  assert.equal(connection.open, false);
  await assert.rejects(connection.call("simulator.ping"), /not connected/);
  assert.deepEqual(FakeSocket.last.sent, []);
});
