// The model of the editor: edits that follow each other before the server has answered.
import assert from "node:assert/strict";
import test from "node:test";

const part = () => ({ setAttribute() {}, append() {}, addEventListener() {}, children: [] });
globalThis.document = { createElement: part };
const { EditorModel } = await import("../src/editor/model.mjs");

/** A server that keeps the tags below <trial>, answers when it is told to, and refuses an old revision. */
class Server {
  constructor() {
    Object.assign(this, { revision: 0, tags: ["stage", "spawner", "journey"], waiting: [], refused: 0 });
  }

  on() {}

  state() {
    return { revision: this.revision, problems: [], tree: { tag: "trial", children: this.tags.map((tag) => ({ tag, children: [] })) } };
  }

  call(address, { revision, paths = [] }) {
    return new Promise((resolve, reject) => {
      this.waiting.push(() => {
        if (revision !== this.revision) return reject(new Error(`refused ${++this.refused}`));
        this.tags = this.tags.filter((_, i) => !paths.some((path) => path[0] === i));
        this.revision += 1;
        resolve(this.state());
      });
    });
  }

  /** Answers all calls, also those that come meanwhile. */
  async answer() {
    for (let turn = 0; turn < 20; turn++) {
      this.waiting.shift()?.();
      await new Promise((resolve) => setImmediate(resolve));
    }
  }
}

function open() {
  const server = new Server(), model = new EditorModel(server);
  model.take(server.state());
  return [server, model];
}

test("an edit follows one that has not been answered", async () => {
  const [server, model] = open();
  const edits = [model.edit("change", { changes: [] }), model.edit("remove", { paths: [[2]] })];
  await server.answer();
  await Promise.all(edits);
  assert.deepEqual([server.tags, server.refused, model.state.revision], [["stage", "spawner"], 0, 2]);
});

test("an edit whose paths would name other elements is refused", async () => {
  const [server, model] = open();
  for (const _ of "ab") void model.edit("remove", { paths: [[1]] });
  await server.answer();
  assert.deepEqual([server.tags, server.refused], [["stage", "journey"], 1]);
});

test("a text that was typed before an edit was answered, or an edit of another window, is refused", async () => {
  const [server, model] = open();
  void model.edit("change", { changes: [] });
  void model.edit("write", { text: "" });
  await server.answer();
  assert.equal(server.refused, 1);
  server.revision += 1;
  void model.edit("change", { changes: [] });
  await server.answer();
  assert.equal(server.refused, 2);
});
