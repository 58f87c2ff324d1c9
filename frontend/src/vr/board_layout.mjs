// Layout of a board: text, questions and buttons as boxes in pixels of its canvas, divided into pages.
export const WIDTH = 1536;
export const HEIGHT = 1152;
const EDGE = 64;
const LINE = 54;
const ROW = 84;
const GAP = 16;
const FOOT = 120;
const KEYS = ["1234567890", "qwertyuiop", "asdfghjkl-", "zxcvbnm,.'"];

/**
 * Returns the pages of a screen: [[{x, y, w, h, kind, text, action?, chosen?}]].
 * @param {{text: string, questions: object[]}} screen as the server tells it
 * @param {object} values answers by the names of questions
 * @param {(text: string, size: number, strong?: boolean) => number} measure width of a text in pixels
 * @param {{name: string, typed: string}|null} typing question whose keys are shown
 */
export function boardPages(screen, values, measure, typing = null) {
  if (typing) return [keyboard(screen.questions.find((one) => one.name === typing.name), typing.typed, measure)];
  const blocks = [];
  for (const text of screen.text ? lines(screen.text, 40, WIDTH - 2 * EDGE, measure) : []) blocks.push([LINE, (y) => [label(text, EDGE, y, 40)]]);
  if (screen.text && screen.questions.length) blocks.push([LINE / 2, () => []]);
  for (const one of screen.questions) blocks.push(question(one, values[one.name] ?? null, measure));
  return divide(blocks);
}

/** Adds the buttons at the foot of a page. */
export function footer(page, number, count, words) {
  const y = HEIGHT - FOOT + 10;
  const wide = 330;
  const boxes = [...page];
  if (number > 0) boxes.push({ ...button("Back", EDGE, y, wide, ROW), action: ["page", -1] });
  if (count > 1) boxes.push({ ...label(`${number + 1} of ${count}`, WIDTH / 2 - 60, y + 18, 34), faint: true });
  const last = number === count - 1;
  if (words || !last) {
    boxes.push({ ...button(last ? words : "More", WIDTH - EDGE - wide, y, wide, ROW), main: true, action: last ? ["finish"] : ["page", 1] });
  }
  return boxes;
}

function divide(blocks) {
  const pages = [[]];
  let y = EDGE;
  for (const [height, make] of blocks) {
    if (y + height > HEIGHT - FOOT && pages.at(-1).length) {
      pages.push([]);
      y = EDGE;
    }
    pages.at(-1).push(...make(y));
    y += height;
  }
  return pages;
}

/** Height and boxes of a question. */
function question(one, value, measure) {
  const title = lines(one.text + (one.unit ? ` [${one.unit}]` : "") + (one.required ? "" : " (optional)"), 38, WIDTH - 2 * EDGE, bold(measure));
  const head = (y) => title.map((text, k) => ({ ...label(text, EDGE, y + LINE * k, 38), strong: true }));
  const top = LINE * title.length + 6;
  if (one.kind === "scale") {
    const wide = (WIDTH - 2 * EDGE + GAP) / one.steps.length;
    const ends = one.low || one.high ? 40 : 0;
    return [
      top + ROW + ends + 26,
      (y) => [
        ...head(y),
        ...one.steps.map((step, k) => ({ ...button(String(step), EDGE + k * wide, y + top, wide - GAP, ROW), chosen: step === value, action: ["set", one.name, step] })),
        ...(ends ? [{ ...label(one.low, EDGE, y + top + ROW + 6, 30), faint: true }, { ...label(one.high, WIDTH - EDGE - measure(one.high, 30), y + top + ROW + 6, 30), faint: true }] : []),
      ],
    ];
  }
  if (one.kind === "choice") {
    const chosen = [value ?? []].flat();
    return [
      top + (ROW + GAP) * one.options.length + 30,
      (y) => [
        ...head(y),
        ...one.options.map((option, k) => ({
          ...button(option.text, EDGE, y + top + (ROW + GAP) * k, WIDTH - 2 * EDGE, ROW),
          chosen: chosen.includes(option.value), left: true, action: [one.multiple ? "toggle" : "set", one.name, option.value],
        })),
      ],
    ];
  }
  return [top + ROW + 46, (y) => [...head(y), { ...button(value === null ? "point here to write" : String(value), EDGE, y + top, WIDTH - 2 * EDGE, ROW), left: true, chosen: value !== null, action: ["write", one.name] }]];
}

/** Keys to write an answer: digits for a number, else letters. */
function keyboard(one, typed, measure) {
  const boxes = lines(one.text, 38, WIDTH - 2 * EDGE, bold(measure)).slice(0, 3).map((text, k) => ({ ...label(text, EDGE, EDGE + LINE * k, 38), strong: true }));
  boxes.push({ ...button(typed, EDGE, 250, WIDTH - 2 * EDGE, ROW), left: true });
  const rows = one.kind === "number" ? ["123", "456", "789", "-0."] : KEYS;
  const wide = one.kind === "number" ? 260 : (WIDTH - 2 * EDGE) / 10;
  rows.forEach((row, r) => {
    [...row].forEach((key, k) => boxes.push({ ...button(key, EDGE + k * wide, 370 + r * (ROW + GAP), wide - GAP, ROW), action: ["key", key] }));
  });
  const y = 370 + 4 * (ROW + GAP);
  if (one.kind !== "number") boxes.push({ ...button("space", EDGE, y, 700, ROW), action: ["key", " "] });
  boxes.push({ ...button("delete", 800, y, 300, ROW), action: ["delete"] }, { ...button("Done", WIDTH - EDGE - 330, y, 330, ROW), main: true, action: ["written"] });
  return boxes;
}

const bold = (measure) => (text, size) => measure(text, size, true);
const label = (text, x, y, size) => ({ kind: "label", text, x, y, size });
const button = (text, x, y, w, h) => ({ kind: "button", text, x, y, w, h });

/** Lines of a text that are not wider than a number of pixels; empty lines are kept. */
function lines(text, size, width, measure) {
  const found = [];
  for (const part of text.split("\n")) {
    let line = "";
    for (const word of part.split(" ")) {
      const longer = line ? `${line} ${word}` : word;
      if (line && measure(longer, size) > width) {
        found.push(line);
        line = word;
      } else line = longer;
    }
    found.push(line);
  }
  return found;
}
