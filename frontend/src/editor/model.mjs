// EditorModel: the trial on the server, the chosen elements, and edits that name the revision they change.
import { attempt } from "../ui/messages.mjs";

export class EditorModel extends EventTarget {
  constructor(connection) {
    super();
    this.connection = connection;
    this.state = null;
    this.table = null;
    this.chosen = [];
    this.people = null;
    this.places = false;
    this.last = null;
    connection.on("editor.state", (state) => this.take(state));
  }

  /** Takes a state of the server; an older one is ignored. */
  take(state) {
    if (this.state && state.revision < this.state.revision) return;
    this.state = state;
    this.chosen = this.chosen.filter((path) => this.node(path));
    if (!this.places) this.people = null;
    this.emit("state");
    if (this.places && !state.problems.length) this.preview();
  }

  emit(name) {
    this.dispatchEvent(new Event(name));
  }

  on(name, listener) {
    this.addEventListener(name, listener);
  }

  /** The element at a path, or undefined. */
  node(path) {
    return path.reduce((node, number) => node?.children[number], this.state?.tree ?? undefined);
  }

  /** The row of the table for the element at a path. */
  kind(path) {
    let row = this.table?.Trial;
    let node = this.state?.tree;
    for (const number of path) {
      node = node?.children[number];
      row = this.table?.[row?.children[node?.tag]];
    }
    return row;
  }

  choose(paths) {
    this.chosen = paths;
    this.emit("chosen");
  }

  call(command, args = {}) {
    return attempt(() => this.connection.call(`editor.${command}`, args));
  }

  /**
   * An edit of the trial as it is shown; returns the new state, or undefined after an error.
   *
   * It follows an edit of this page that is on its way, if its paths then name the same elements. A whole text does not:
   * it would undo that edit.
   */
  edit(command, args = {}) {
    const { revision, tree } = this.state;
    const before = command === "write" ? null : this.last;
    const send = async () => {
      const done = await before;
      const follows = done?.revision > revision && shape(done.tree) === shape(tree);
      const state = await this.call(command, { ...args, revision: follows ? done.revision : revision });
      if (state) this.take(state);
      return state;
    };
    return (this.last = send());
  }

  /** Adds an element and chooses it. */
  async insert(path, xml) {
    const state = await this.edit("insert", { path, xml });
    if (state) this.choose([[...path, this.node(path).children.length - 1]]);
  }

  async step(command, args = {}) {
    const state = await this.call(command, args);
    if (state) this.take(state);
  }

  /** Shows where people start and walk, also after each edit, or hides it. */
  async showPlaces(places) {
    this.places = places;
    if (places) return this.preview();
    this.people = null;
    this.emit("people");
  }

  async preview() {
    const revision = this.state.revision;
    const people = await this.call("preview");
    if (revision !== this.state.revision || !this.places) return;
    this.people = people;
    this.emit("people");
  }
}

/** The tags of a tree as text. */
const shape = (node) => (node ? `${node.tag}(${node.children.map(shape)})` : "");

/** Paths as text, to compare them. */
export const same = (one, other) => one.length === other.length && one.every((value, i) => value === other[i]);
