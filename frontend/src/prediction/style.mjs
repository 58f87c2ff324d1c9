// Colour and dash of each predictor: never told apart by colour alone.
import { themeColour } from "../ui/plot.mjs";

const DASHES = [[], [9, 5], [2, 4], [9, 4, 2, 4], [16, 5]];
const DEGRADED = [1, 3];

/** Name of the colour and the dash [px] of a predictor with a slot number; degraded input is dotted. */
export function styleOf(slot, input = "clean") {
  const dash = input === "degraded" ? DEGRADED : DASHES[(slot + Math.floor(slot / 6)) % DASHES.length];
  return { name: `--data-${(slot % 6) + 1}`, dash };
}

/** The colour as CSS, in the theme of the page. */
export function colourOf(slot) {
  return themeColour(styleOf(slot).name);
}
