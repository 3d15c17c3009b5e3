// Charts with a common time axis, live or at a position in the last hour.

import { clock, number } from "./words.js";

/* global uPlot */

const WIDE_PX = 56; // width of the left axis
const RIGHT_PX = 28; // space for half of the last time label
const PAD = 0.08;
const ZOOM = 1.2;
const LEAST_ROWS = 200;
const PIXEL_PARTS = 4; // charts are redrawn when the newest point has moved by this part of a pixel,
const SLOWEST_MS = 250; // or after this time

const known = new Map();

// Color of the style sheet, cached until the scheme changes: a query makes the browser compute all styles.
function color(name) {
  if (!known.has(name)) {
    known.set(name, getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim());
  }
  return known.get(name);
}

const fixed = (digits) => (_, value) => (Number.isFinite(value) ? number(value, digits) : "");
const time = (_, value) => (Number.isFinite(value) ? clock(value) : "");
const PLAIN = new Intl.NumberFormat("en", { maximumFractionDigits: 6, useGrouping: false }); // slow to make
const ticks = (_, values) => values.map((value) => PLAIN.format(value).replace("-", "−"));

// A range with a margin, and with a minimum span so that it does not show noise alone.
const atLeast = (span) => (_, low, high) => {
  if (low === null) return [-span / 2, span / 2];
  const room = Math.max((high - low) * PAD, (span - (high - low)) / 2);
  return [low - room, high + room];
};

const doubled = (view, value, sigma, sign) => {
  const [values, sigmas] = [view.column(value), view.column(sigma)];
  return view.values((row) => values[row] + 2 * sign * sigmas[row]);
};

// A line has a name, a color, and a function that gets its values from a view. A `band` is filled up to the next line.
const CHARTS = [
  {
    title: "Yaw", unit: "deg", height: 240, hasTimes: true, digits: 2, range: atLeast(1),
    lines: [
      { name: "+2σ", color: "yaw", band: true, of: (view) => doubled(view, "yaw_deg", "yaw_sigma_deg", 1) },
      { name: "−2σ", color: "yaw", bound: true, of: (view) => doubled(view, "yaw_deg", "yaw_sigma_deg", -1) },
      { name: "raw", color: "raw", dash: [8, 3], of: (view) => view.span("raw_yaw_deg") },
      { name: "corrected", color: "yaw", width: 2, of: (view) => view.span("yaw_deg") },
      { name: "encoder", color: "encoder", of: (view) => view.span("encoder_deg"), needs: "encoder_deg", dash: [4, 6] },
    ],
  },
  {
    title: "Yaw error against encoder", unit: "deg", height: 110, digits: 3, range: atLeast(0.2), needs: "encoder_deg",
    lines: [
      { name: "+2σ", color: "yaw", band: true, of: (view) => doubled(view, "error_deg_hi", "yaw_sigma_deg", 1) },
      { name: "−2σ", color: "yaw", bound: true, of: (view) => doubled(view, "error_deg_lo", "yaw_sigma_deg", -1) },
      { name: "error", color: "yaw", width: 1.5, of: (view) => view.span("error_deg") },
    ],
  },
  {
    title: "Yaw minus the device's own", unit: "deg", height: 110, digits: 3, range: atLeast(0.2), needs: "device_difference_deg",
    lines: [{ name: "difference", color: "device", width: 1.5, of: (view) => view.span("device_difference_deg") }],
  },
  {
    title: "Roll and pitch", unit: "deg", height: 110, digits: 1, range: atLeast(2), needs: "roll_deg",
    lines: [
      { name: "roll", color: "roll", width: 1.5, of: (view) => view.span("roll_deg") },
      { name: "pitch", color: "pitch", width: 1.5, dash: [8, 3], of: (view) => view.span("pitch_deg") },
    ],
  },
  {
    title: "Bias", unit: "deg/s", height: 110, digits: 4, range: atLeast(0.01),
    lines: [
      { name: "+2σ", color: "drift", band: true, of: (view) => doubled(view, "bias_dps", "bias_sigma_dps", 1) },
      { name: "−2σ", color: "drift", bound: true, of: (view) => doubled(view, "bias_dps", "bias_sigma_dps", -1) },
      { name: "estimate", color: "drift", width: 1.5, of: (view) => view.values((row) => view.column("bias_dps")[row]) },
    ],
  },
  {
    title: "Rate before the filter", unit: "deg/s", height: 110, digits: 2, range: atLeast(1),
    lines: [{ name: "rate", color: "rate", of: (view) => view.span("rate_dps") }],
  },
  {
    title: "Probability of rest", unit: "", height: 72, hasTimes: true, digits: 2, range: () => [0, 1], needs: "rest_probability", strip: true,
    lines: [{ name: "rest", color: "rest", fill: true, of: (view) => view.span("rest_probability") }],
  },
];

function seriesOf(line, digits) {
  const isBound = line.band || line.bound;
  return {
    label: line.name,
    class: isBound ? "bound" : `line-${line.color}`,
    stroke: isBound ? "transparent" : () => color(line.color),
    fill: line.fill ? () => color(`${line.color}-fill`) : undefined,
    width: line.width ?? 1.25,
    dash: line.dash,
    points: { show: false },
    value: fixed(digits),
  };
}

// Draw a vertical line at each change of the config.
function drawMarks(plot, marks) {
  const { ctx, bbox } = plot;
  ctx.save();
  ctx.strokeStyle = color("quiet");
  ctx.lineWidth = devicePixelRatio;
  ctx.setLineDash([2 * devicePixelRatio, 3 * devicePixelRatio]);
  for (const atS of marks) {
    if (atS < plot.scales.x.min || atS > plot.scales.x.max) continue;
    const x = Math.round(plot.valToPos(atS, "x", true)) + 0.5;
    ctx.beginPath();
    ctx.moveTo(x, bbox.top);
    ctx.lineTo(x, bbox.top + bbox.height);
    ctx.stroke();
  }
  ctx.restore();
}

const TITLE_PX = 24;

// Save a chart with its title as a PNG file, on the color of its card.
function savePicture(plot, title) {
  const source = plot.ctx.canvas;
  const top = TITLE_PX * devicePixelRatio;
  const picture = Object.assign(document.createElement("canvas"), { width: source.width, height: source.height + top });
  const ctx = picture.getContext("2d");
  ctx.fillStyle = color("card");
  ctx.fillRect(0, 0, picture.width, picture.height);
  ctx.fillStyle = color("ink");
  ctx.font = `600 ${0.6 * top}px system-ui, sans-serif`;
  ctx.fillText(title, 0.3 * top, 0.75 * top);
  ctx.drawImage(source, 0, top);
  picture.toBlob((blob) => {
    const link = document.createElement("a");
    Object.assign(link, { href: URL.createObjectURL(blob), download: `${title}.png` });
    link.click();
    URL.revokeObjectURL(link.href);
  });
}

class Chart {
  // hands(plot) adds the listeners of mouse and touch; marks are times to mark.
  constructor(place, made, hands, marks) {
    this.made = made;
    const figure = document.createElement("figure");
    figure.className = made.strip ? "strip" : "";
    const caption = document.createElement("figcaption");
    caption.textContent = made.unit ? `${made.title}, ${made.unit}` : made.title;
    const save = Object.assign(document.createElement("button"), { type: "button", className: "save", textContent: "PNG" });
    save.title = "Save this chart as a picture";
    save.addEventListener("click", () => savePicture(this.plot, caption.firstChild.data));
    caption.append(save);
    figure.append(caption);
    place.append(figure);
    this.figure = figure;
    this.plot = new uPlot(this.options(made, hands, marks), [[], ...made.lines.map(() => [])], figure);
  }

  options(made, hands, marks) {
    const axis = { stroke: () => color("quiet"), grid: { stroke: () => color("grid"), width: 1 }, ticks: { show: false } };
    const font = "12px system-ui, sans-serif";
    return {
      width: 300,
      height: made.height,
      scales: { x: { time: true, auto: false }, y: { range: made.range } },
      cursor: { sync: { key: "time" }, drag: { x: false, y: false }, points: { size: 6 } },
      legend: { show: made.lines.length > 1, live: true },
      padding: [8, RIGHT_PX, 0, 0],
      axes: [
        { ...axis, font, size: made.hasTimes ? 24 : 6, values: made.hasTimes ? "{HH}:{mm}:{ss}" : () => [], space: 90 },
        { ...axis, font, size: WIDE_PX, space: 22, values: ticks, splits: made.strip ? () => [0, 1] : undefined },
      ],
      bands: made.lines.flatMap((line, at) => (line.band ? [{ series: [at + 1, at + 2], fill: () => color(`${line.color}-band`) }] : [])),
      series: [{ value: time }, ...made.lines.map((line) => seriesOf(line, made.digits))],
      hooks: { init: [(plot) => hands(plot)], draw: [(plot) => drawMarks(plot, marks)] },
    };
  }

  draw(history, view, fromS, toS) {
    const has = (needed) => !needed || Number.isFinite(history.last(needed));
    const isShown = has(this.made.needs);
    if (this.figure.hidden === isShown) {
      this.figure.hidden = !isShown;
      this.fit();
    }
    if (!isShown) return;
    this.made.lines.forEach((line, at) => {
      if (line.needs) this.plot.root.classList.toggle(`without-${line.name}`, !has(line.needs));
    });
    this.plot.batch(() => {
      this.plot.setData([view.times, ...this.made.lines.map((line) => line.of(view))], false);
      this.plot.setScale("x", { min: fromS, max: toS });
    });
  }

  fit() {
    const width = this.figure.clientWidth;
    if (width && width !== this.plot.width) this.plot.setSize({ width, height: this.made.height });
  }
}

export class Charts {
  // marks: Unix times to mark in all charts, s. onMove() is called when the time range has changed.
  constructor(place, history, marks, windowS, onMove) {
    this.place = place;
    this.history = history;
    this.onMove = onMove;
    this.windowS = windowS;
    this.endS = null; // live
    this.dueMs = 0; // time of the next drawing
    this.later = null;
    const possible = CHARTS.filter((made) => !made.needs || history.has(made.needs));
    this.charts = possible.map((made) => new Chart(place, made, (plot) => this.hearHands(plot), marks));
    new ResizeObserver(() => this.fit()).observe(place);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.repaint());
    this.fit();
  }

  fit() {
    this.widthPx = this.place.clientWidth;
    for (const chart of this.charts) chart.fit();
    this.move();
  }

  repaint() {
    known.clear();
    for (const chart of this.charts) chart.plot.redraw();
  }

  // Redraw at once after a change of range or size.
  move() {
    this.dueMs = 0;
    this.onMove();
  }

  // Whether a drawing is due; if not, it is scheduled. In the view of an hour a pixel takes seconds.
  isDue() {
    const nowMs = performance.now();
    if (nowMs >= this.dueMs) {
      this.dueMs = nowMs + Math.min(SLOWEST_MS, (1000 * this.windowS) / this.widthPx / PIXEL_PARTS);
      return true;
    }
    this.later ??= setTimeout(() => {
      this.later = null;
      this.onMove();
    }, this.dueMs - nowMs);
    return false;
  }

  draw() {
    const toS = this.endS ?? this.history.lastS;
    if (!Number.isFinite(toS) || !this.isDue()) return;
    const fromS = toS - this.windowS;
    const view = this.history.view(fromS, toS, Math.max(LEAST_ROWS, this.widthPx));
    for (const chart of this.charts) chart.draw(this.history, view, fromS, toS);
  }

  // Show a range that ends at a time; at the newest point the charts follow the stream.
  lookAt(endS, windowS = this.windowS) {
    const { firstS, lastS } = this.history;
    this.windowS = Math.min(3600, Math.max(2, windowS));
    this.endS = endS >= lastS ? null : Math.max(endS, Math.min(lastS, firstS + this.windowS));
    this.move();
  }

  // Drag sideways to look back; turn the wheel to zoom.
  hearHands(plot) {
    const over = plot.over;
    let grip = null;
    over.addEventListener("pointerdown", (event) => {
      grip = { x: event.clientX, endS: this.endS ?? this.history.lastS };
      over.setPointerCapture(event.pointerId);
    });
    over.addEventListener("pointermove", (event) => {
      if (!grip || Math.abs(event.clientX - grip.x) < 3) return;
      this.lookAt(grip.endS - ((event.clientX - grip.x) / over.clientWidth) * this.windowS);
    });
    for (const end of ["pointerup", "pointercancel"]) over.addEventListener(end, () => (grip = null));
    over.addEventListener("wheel", (event) => {
      event.preventDefault();
      const endS = this.endS ?? this.history.lastS;
      if (Math.abs(event.deltaX) > Math.abs(event.deltaY)) {
        this.lookAt(endS + (event.deltaX / over.clientWidth) * this.windowS);
        return;
      }
      const windowS = this.windowS * (event.deltaY > 0 ? ZOOM : 1 / ZOOM);
      const share = this.endS === null ? 1 : event.offsetX / over.clientWidth;
      this.lookAt(endS + (1 - share) * (windowS - this.windowS), windowS);
    }, { passive: false });
  }
}
