// Board: a panel in the virtual room with text, questions and buttons, which rays of controllers or hands point at.
import * as THREE from "three";
import { boardPages, footer, HEIGHT, WIDTH } from "./board_layout.mjs";

const METERS = 1.5;
const AWAY = 1.5;
const COLORS = { paper: "#f7f8fa", ink: "#141c26", faint: "#5b6673", line: "#9aa7b5", button: "#e3e8ee", hover: "#c9d8ec", chosen: "#0b62b8", main: "#0b62b8", error: "#b3261e" };

export class Board {
  /** @param {{draft(values), finish(values)}} actions what answers do */
  constructor(actions) {
    this.actions = actions;
    this.canvas = Object.assign(document.createElement("canvas"), { width: WIDTH, height: HEIGHT });
    this._pen = this.canvas.getContext("2d");
    const map = new THREE.CanvasTexture(this.canvas);
    map.colorSpace = THREE.SRGBColorSpace;
    map.generateMipmaps = true;
    map.anisotropy = 4;
    this.mesh = new THREE.Mesh(new THREE.PlaneGeometry(METERS, (METERS * HEIGHT) / WIDTH), new THREE.MeshBasicMaterial({ map, transparent: true, fog: false, toneMapped: false }));
    this.mesh.visible = false;
    // It is drawn in front of everything in the room; rays and hands, which are drawn after it, are in front of it.
    this.mesh.renderOrder = 5;
    this.mesh.onBeforeRender = (renderer) => renderer.clearDepth();
    this.screen = null;
    this.values = {};
    this.boxes = [];
    this.page = 0;
    this.pages = 1;
    this.presses = 0;
    this.problem = "";
    this.hovered = [];
    this._typing = null;
  }

  get shown() {
    return this.mesh.visible;
  }

  /**
   * Shows a screen {key, text, questions, answers, button}, or nothing for null. The key tells screens apart.
   * @param {THREE.Vector3|null} eye where the participant is, for the place of a new screen
   * @param {THREE.Vector3} ahead direction of the face
   */
  set(screen, eye, ahead) {
    if (screen && eye && (!this.shown || screen.key !== this.screen?.key)) this.place(eye, ahead);
    this.mesh.visible = Boolean(screen && (this.shown || eye));
    if (!screen) {
      this.screen = null;
      return;
    }
    if (screen.key !== this.screen?.key) {
      Object.assign(this, { page: 0, problem: "", hovered: [], _typing: null, values: {} });
    } else if (JSON.stringify(screen) === JSON.stringify(this.screen)) return;
    this.screen = screen;
    this.values = { ...this.values, ...screen.answers };
    this._draw();
  }

  /** Puts the board upright in front of the participant, where it stays; in the frame of the headset, y up. */
  place(eye, ahead) {
    const flat = new THREE.Vector3(ahead.x, 0, ahead.z).normalize();
    this.mesh.position.copy(eye).addScaledVector(flat, AWAY);
    this.mesh.position.y = Math.max(0.9, eye.y - 0.12);
    this.mesh.rotation.set(0, Math.atan2(-flat.x, -flat.z), 0);
  }

  /** Point x, y [pixels] of the canvas at which a ray hits the board, and its distance [m]; or null. */
  hit(origin, direction) {
    if (!this.shown) return null;
    this.mesh.updateMatrix();
    const inverse = this.mesh.matrix.clone().invert();
    const from = origin.clone().applyMatrix4(inverse);
    const along = direction.clone().transformDirection(inverse);
    if (along.z >= -1e-6 || from.z <= 0) return null;
    const away = -from.z / along.z;
    const x = ((from.x + away * along.x) / METERS + 0.5) * WIDTH;
    const y = (0.5 - (from.y + away * along.y) / ((METERS * HEIGHT) / WIDTH)) * HEIGHT;
    return x < 0 || y < 0 || x > WIDTH || y > HEIGHT ? null : { x, y, away };
  }

  /** Place of the middle of a box in the frame of the headset. */
  middle(box) {
    this.mesh.updateMatrix();
    const local = new THREE.Vector3(((box.x + box.w / 2) / WIDTH - 0.5) * METERS, ((0.5 - (box.y + box.h / 2) / HEIGHT) * METERS * HEIGHT) / WIDTH, 0);
    return local.applyMatrix4(this.mesh.matrix);
  }

  /** Marks what rays point at: points {x, y} of the canvas. */
  hover(points) {
    const boxes = points.map((point) => this._at(point)).filter(Boolean);
    if (boxes.length === this.hovered.length && boxes.every((box, k) => same(box, this.hovered[k]))) return;
    this.hovered = boxes;
    this._paint();
  }

  /** Does what the box at a point says. */
  press(point) {
    const box = this._at(point);
    if (!box) return false;
    this.problem = "";
    this.presses += 1;
    this._act(...box.action);
    if (this.screen) this._draw();
    return true;
  }

  _at({ x, y }) {
    return this.boxes.find((box) => box.action && x >= box.x && x <= box.x + box.w && y >= box.y && y <= box.y + box.h);
  }

  _act(kind, name, value) {
    if (kind === "page") this.page += name;
    else if (kind === "set") this._answer(name, value);
    else if (kind === "toggle") {
      const now = [this.values[name] ?? []].flat();
      this._answer(name, now.includes(value) ? now.filter((one) => one !== value) : [...now, value]);
    } else if (kind === "write") this._typing = { name, typed: String(this.values[name] ?? "") };
    else if (kind === "key") this._typing.typed += name;
    else if (kind === "delete") this._typing.typed = this._typing.typed.slice(0, -1);
    else if (kind === "written") this._written();
    else if (kind === "finish") this._finish();
    else if (kind === "do") name();
  }

  _answer(name, value) {
    this.values = { ...this.values, [name]: value };
    this.actions.draft(this.values);
  }

  _written() {
    const { name, typed } = this._typing;
    const one = this.screen.questions.find((question) => question.name === name);
    const text = typed.trim();
    const number = Number(text);
    const low = one.min ?? -Infinity;
    const high = one.max ?? Infinity;
    if (one.kind === "number" && text && !(number >= low && number <= high && (one.step !== 1 || Number.isInteger(number)))) {
      this.problem = `Please give ${one.hint}.`;
      return;
    }
    this._typing = null;
    if (text) this._answer(name, one.kind === "number" ? number : text);
  }

  _finish() {
    const missing = this.screen.questions.find((one) => one.required && (this.values[one.name] ?? null) === null);
    if (missing) {
      this.problem = `Please answer: ${missing.text}`;
      return;
    }
    const known = this.screen.questions.map((one) => one.name);
    this.actions.finish(Object.fromEntries(Object.entries(this.values).filter(([name]) => known.includes(name))));
  }

  /** Shows a sentence at the foot of the board. */
  complain(text) {
    this.problem = text;
    if (this.screen) this._paint();
  }

  _measure(text, size, strong = false) {
    this._pen.font = font(size, strong);
    return this._pen.measureText(text).width;
  }

  _draw() {
    const pages = boardPages(this.screen, this.values, (...how) => this._measure(...how), this._typing);
    this.pages = pages.length;
    this.page = Math.max(0, Math.min(this.page, pages.length - 1));
    const page = this._typing ? pages[0] : pages[this.page];
    this.boxes = this._typing ? page : footer(page, this.page, pages.length, this.screen.button);
    for (const one of this.screen.buttons ?? []) this.boxes.push(one);
    this._paint();
  }

  _paint() {
    const pen = this._pen;
    pen.fillStyle = COLORS.paper;
    pen.fillRect(0, 0, WIDTH, HEIGHT);
    pen.textBaseline = "middle";
    for (const box of this.boxes) {
      if (box.kind === "button") paintButton(pen, box, this.hovered.some((one) => same(one, box)));
      else {
        pen.font = font(box.size, box.strong);
        pen.fillStyle = box.faint ? COLORS.faint : COLORS.ink;
        pen.textAlign = "left";
        pen.fillText(box.text, box.x, box.y + box.size / 2);
      }
    }
    if (this.problem) {
      pen.font = font(34);
      pen.fillStyle = COLORS.error;
      pen.textAlign = "center";
      pen.fillText(this.problem, WIDTH / 2, HEIGHT - 136, WIDTH - 80);
    }
    this.mesh.material.map.needsUpdate = true;
  }
}

const same = (a, b) => a.text === b.text && a.x === b.x && a.y === b.y;

const font = (size, strong = false) => `${strong ? "600 " : ""}${size}px system-ui, sans-serif`;

function paintButton(pen, box, hovered) {
  const full = box.chosen || box.main;
  pen.fillStyle = full ? COLORS.chosen : hovered ? COLORS.hover : COLORS.button;
  pen.strokeStyle = hovered ? COLORS.ink : COLORS.line;
  pen.lineWidth = hovered ? 6 : 2;
  pen.beginPath();
  pen.roundRect(box.x, box.y, box.w, box.h, 16);
  pen.fill();
  pen.stroke();
  pen.fillStyle = full ? "#fff" : COLORS.ink;
  pen.font = font(38, full);
  pen.textAlign = box.left ? "left" : "center";
  pen.fillText(box.text, box.left ? box.x + 28 : box.x + box.w / 2, box.y + box.h / 2, box.w - 40);
}
