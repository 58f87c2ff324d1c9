// Line plots with uPlot, in the colours of the theme.
import uPlot from "uplot";
import { h } from "./dom.mjs";
import { describeData, drawable, labelOf } from "./plot_text.mjs";

const HEIGHT = 170;

/** A CSS colour; names such as "--data-1" are looked up in the theme. */
export function themeColour(colour) {
  return colour?.startsWith("--") ? getComputedStyle(document.documentElement).getPropertyValue(colour).trim() : colour;
}

/**
 * Makes a plot in an element.
 * @param {HTMLElement} element place of the plot; its width is that of the plot
 * @param {{title: string, x: {label, unit}, series: {label, unit, colour, dash}[], height?: number, points?: boolean, legend?: boolean, log?: boolean}} options
 *   colour: CSS colour or name of a property such as "--data-1"; dash: lengths [px], [] for a solid line
 * @returns {{set(data: number[][]), mark(x: number|null), destroy()}} set takes [xs, values of series 1, ...]; values
 *   that are not finite are gaps; mark draws a vertical line at x
 */
export function makePlot(element, { title, x, series, height = HEIGHT, points = false, legend = true, log = false }) {
  const place = h("div", { role: "img", "aria-label": `${title}: no data yet`, class: "plot-canvas" });
  const figure = h("figure", { class: "plot" }, h("figcaption", {}, title), place);
  element.append(figure);
  let data = [[], ...series.map(() => [])];
  let plot = null;
  let marked = null;

  const width = () => Math.max(160, place.clientWidth);

  function drawMark(one) {
    if (marked === null) return;
    const at = one.valToPos(marked, "x", true);
    const { left, top, width: wide, height: high } = one.bbox;
    if (at < left || at > left + wide) return;
    one.ctx.save();
    one.ctx.strokeStyle = themeColour("--faint");
    one.ctx.lineWidth = devicePixelRatio;
    one.ctx.beginPath();
    one.ctx.moveTo(at, top);
    one.ctx.lineTo(at, top + high);
    one.ctx.stroke();
    one.ctx.restore();
  }

  function build() {
    plot?.destroy();
    const axis = (label) => ({
      label,
      labelSize: 18,
      labelFont: "11px system-ui, sans-serif",
      font: "11px system-ui, sans-serif",
      stroke: themeColour("--ink"),
      grid: { stroke: themeColour("--line"), width: 0.5 },
      ticks: { stroke: themeColour("--line"), width: 0.5 },
      size: 54,
    });
    const units = [...new Set(series.map((one) => one.unit ?? ""))].filter(Boolean);
    plot = new uPlot(
      {
        width: width(),
        height,
        scales: { x: { time: false }, y: log ? { distr: 3 } : {} },
        axes: [{ ...axis(labelOf(x)), size: 30 }, { ...axis(units.length === 1 ? `[${units[0]}]` : ""), ...(log ? { grid: { show: false }, ticks: { show: false } } : {}) }],
        series: [
          { label: labelOf(x) },
          ...series.map((one) => ({
            label: labelOf(one),
            stroke: themeColour(one.colour),
            dash: one.dash ?? [],
            width: 1.6,
            spanGaps: false,
            points: points ? { show: true, size: 5 } : undefined,
          })),
        ],
        legend: { show: legend },
        cursor: { drag: { x: true, y: false } },
        hooks: { draw: [drawMark] },
      },
      data,
      place,
    );
  }

  const onTheme = () => build();
  document.addEventListener("theme", onTheme);
  const observer = new ResizeObserver(() => {
    if (plot && place.clientWidth && plot.width !== width()) plot.setSize({ width: width(), height });
  });
  observer.observe(place);
  build();
  return {
    set(next) {
      data = next.map(drawable);
      plot.setData(data);
      place.setAttribute("aria-label", describeData(title, x, series, next));
    },
    mark(value) {
      if (value === marked) return;
      marked = value;
      plot.redraw(false, true); // with false, a plot that is not drawn yet would never place its axes
    },
    destroy() {
      document.removeEventListener("theme", onTheme);
      observer.disconnect();
      plot.destroy();
      figure.remove();
    },
  };
}
