// Density, time to collision and predicted paths of a crowd seen from above.
import { densityImage, eachCollision, eachPathPiece, TIMES } from "../scene/field.mjs";

let sheet = null;

export function drawDensity(context, state) {
  const image = densityImage(state.frame);
  if (!image) return;
  sheet ??= document.createElement("canvas");
  Object.assign(sheet, { width: image.width, height: image.height });
  sheet.getContext("2d").putImageData(new ImageData(image.data, image.width, image.height), 0, 0);
  context.drawImage(sheet, image.x, image.y, image.width * image.cell, image.height * image.cell);
}

export function drawPaths(context, state, look, pixel) {
  context.beginPath();
  eachPathPiece(state.frame, (x0, y0, x1, y1) => {
    context.moveTo(x0, y0);
    context.lineTo(x1, y1);
  });
  context.strokeStyle = look.path;
  context.lineWidth = 1.5 * pixel;
  context.globalAlpha = 0.75;
  context.stroke();
  context.globalAlpha = 1;
}

export function drawCollisions(context, state, look, pixel) {
  TIMES.forEach(({ color, width }, wanted) => {
    context.beginPath();
    eachCollision(state.frame, (at, x0, y0, x1, y1) => {
      if (at !== wanted) return;
      context.moveTo(x0, y0);
      context.lineTo(x1, y1);
    });
    context.strokeStyle = color;
    context.lineWidth = width * pixel;
    context.stroke();
  });
}
