// The scale of a floor plan picture: two points whose distance is known, or the size of a pixel.
import { say } from "../ui/messages.mjs";
import { field, h } from "../ui/dom.mjs";
import { themeColour } from "../ui/plot.mjs";

const WIDTH = 560;
const HEIGHT = 300;

/** Returns {element, picture, size}: the inputs of the file and of the size of a pixel [m]. */
export function makeFloorScale() {
  const size = h("input", { type: "number", min: "0.001", max: "10", step: "any", value: "0.05" });
  const picture = h("input", { type: "file", accept: ".png,.jpg,.jpeg", onchange: () => load() });
  const distance = h("input", { type: "number", min: "0.01", step: "any", value: "1", oninput: () => apply() });
  const canvas = h("canvas", { width: WIDTH, height: HEIGHT, "aria-label": "Floor plan; click two points whose distance is known", role: "img" });
  const words = h("p", { class: "note", "aria-live": "polite" }, "");
  const scaled = h("div", { hidden: true }, canvas, words, field("Distance between the two points [m]", distance));
  const element = h("div", { class: "floor" }, field("Picture (.png, .jpg)", picture), scaled, field("Size of a pixel [m]", size));
  let image = null;
  let points = [];

  const zoom = () => Math.min(WIDTH / image.width, HEIGHT / image.height);

  async function load() {
    const [file] = picture.files;
    points = [];
    try {
      image = file ? await createImageBitmap(file) : null;
    } catch {
      image = null;
      say(`${file.name} is not a PNG or JPEG picture`, "error");
    }
    scaled.hidden = !image;
    if (image) draw();
  }

  canvas.addEventListener("click", (event) => {
    const bounds = canvas.getBoundingClientRect();
    const at = [((event.clientX - bounds.left) * WIDTH) / bounds.width / zoom(), ((event.clientY - bounds.top) * HEIGHT) / bounds.height / zoom()];
    points = points.length === 2 ? [at] : [...points, at];
    apply();
    draw();
  });

  function apply() {
    const pixels = points.length === 2 ? Math.hypot(points[0][0] - points[1][0], points[0][1] - points[1][1]) : 0;
    if (pixels > 0 && Number(distance.value) > 0) size.value = Number((Number(distance.value) / pixels).toPrecision(4));
    tell();
  }

  function tell() {
    const metres = (n) => (n * Number(size.value)).toFixed(1);
    words.textContent = points.length < 2 ? `Click ${points.length ? "the second point" : "two points whose distance you know"}.` : `The picture is ${metres(image.width)} m x ${metres(image.height)} m.`;
  }

  function draw() {
    const context = canvas.getContext("2d");
    context.clearRect(0, 0, WIDTH, HEIGHT);
    context.drawImage(image, 0, 0, image.width * zoom(), image.height * zoom());
    context.strokeStyle = context.fillStyle = themeColour("--focus");
    context.lineWidth = 2;
    context.beginPath();
    points.forEach(([x, y], i) => context[i ? "lineTo" : "moveTo"](x * zoom(), y * zoom()));
    context.stroke();
    for (const [x, y] of points) context.fillRect(x * zoom() - 4, y * zoom() - 4, 8, 8);
    tell();
  }

  size.addEventListener("input", tell);
  return { element, picture, size };
}
