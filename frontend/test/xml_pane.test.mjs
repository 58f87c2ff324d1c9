// When the XML pane of the editor sends what is typed.
import assert from "node:assert/strict";
import test from "node:test";
import { XmlPane } from "../src/editor/xml_pane.mjs";

/** A pane without a page, and the answers that its texts wait for. */
function paneOf(value) {
  const sent = [];
  const conflicts = [];
  const model = {
    connection: { open: true },
    state: { text: value, problems: [] },
    edit: (command, { text }) => new Promise((answer) => sent.push({ command, text, answer })),
    emit: (name) => conflicts.push(name),
  };
  const pane = Object.assign(Object.create(XmlPane.prototype), {
    model,
    timer: 0,
    base: "",
    sent: "",
    sending: false,
    offline: false,
    area: { value },
    numbers: {},
  });
  return { pane, sent, conflicts };
}

const settled = () => new Promise((done) => setImmediate(done));

function type(pane, text) {
  pane.area.value = text;
  pane.wait();
}

test("a text on its way is not sent again when the pane loses the focus", async (t) => {
  t.mock.timers.enable({ apis: ["setTimeout"] });
  const { pane, sent, conflicts } = paneOf("<trial/>");
  type(pane, "<trial name='a'/>");
  t.mock.timers.tick(400);
  pane.send(); // blur
  pane.send();
  assert.deepEqual(sent.map((one) => one.text), ["<trial name='a'/>"]);
  sent[0].answer({ revision: 1 });
  await settled();
  t.mock.timers.tick(2000);
  assert.equal(sent.length, 1);
  assert.deepEqual(conflicts, []);
});

test("what is typed while a text is on its way follows after the answer", async (t) => {
  t.mock.timers.enable({ apis: ["setTimeout"] });
  const { pane, sent, conflicts } = paneOf("<trial/>");
  type(pane, "<trial name='a'/>");
  t.mock.timers.tick(400);
  type(pane, "<trial name='ab'/>");
  t.mock.timers.tick(400);
  assert.equal(sent.length, 1);
  sent[0].answer({ revision: 1 });
  await settled();
  t.mock.timers.tick(400);
  assert.deepEqual(sent.map((one) => one.text), ["<trial name='a'/>", "<trial name='ab'/>"]);
  sent[1].answer({ revision: 2 });
  await settled();
  assert.deepEqual(conflicts, []);
});

test("a refused text asks which one stays", async (t) => {
  t.mock.timers.enable({ apis: ["setTimeout"] });
  const { pane, sent, conflicts } = paneOf("<trial/>");
  type(pane, "<trial name='a'/>");
  pane.send();
  sent[0].answer(undefined);
  await settled();
  assert.deepEqual(conflicts, ["conflict"]);
});

test("a text that arrived before the server was away is no change of somebody else", async (t) => {
  t.mock.timers.enable({ apis: ["setTimeout"] });
  const { pane, sent, conflicts } = paneOf("<trial/>");
  type(pane, "<trial name='a'/>");
  t.mock.timers.tick(400);
  pane.model.connection.open = false;
  sent[0].answer(undefined); // lost
  await settled();
  type(pane, "<trial name='ab'/>");
  pane.model.connection.open = true;
  pane.model.state = { text: "<trial name='a'/>", problems: [] };
  pane.update();
  assert.deepEqual(conflicts, []);
  assert.equal(sent.at(-1).text, "<trial name='ab'/>");
});
