/* The script of a report: uPlot draws the scales of each chart and zooms; the marks, and a copy as SVG for paper and for
   files, come from the same paths. Legend entries switch curves. Nothing is fetched. */
(() => {
"use strict";

/* global uPlot */

const HINT = "Click a name to switch its curves; with Shift, only its curves stay. Drag across a panel to zoom into that " +
  "time; a double click shows everything again. The vertical scale follows the visible curves.";
const FONT = "system-ui, 'DejaVu Sans', Arial, sans-serif";
const TEXT_PX = 12, LINE_PX = 16, KEY_PX = 18, PAD_PX = 8, LABEL_PX = 4;
const AXIS_PX = 35; // height of the horizontal axis
const PNG_WIDTH = 1600; // pixels
const LINES = new Set(["line", "strokes"]); // shapes that are not filled
const DASHES = { dashed: [6, 4], dotted: [2, 3] };
const MARGIN = 0.06; // of the vertical scale of a part of a chart
const LEAST_SHARE = 1e-3; // of the width: the deepest zoom
const SHOWN_MS = 1500; // how long a button says that it is done

/* Scales: their kinds in uPlot, and maps to and from a straight line. */
const MAPS = {
  linear: { distr: 1, to: Number, from: Number },
  log: { distr: 3, to: Math.log, from: Math.exp },
  symlog: { distr: 4, to: Math.asinh, from: Math.sinh },
};

const all = (root, selector) => [...root.querySelectorAll(selector)];
const made = (name, className, textContent = "") =>
  Object.assign(document.createElement(name), { className, textContent });
const words = element => element.textContent.replace(/\s+/g, " ").trim();

const drawn = (name, attributes, text = "") => {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  Object.entries(attributes).forEach(([key, value]) => element.setAttribute(key, value));
  element.textContent = text;
  return element;
};

/* Colors by name: those of the screen now, or those that the style sheet states for paper. */
const screenColor = name => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
const paperColors = () => {
  const [root] = [...document.styleSheets[0].cssRules].filter(rule => rule.selectorText === ":root");
  return name => root.style.getPropertyValue(`--${name}`).trim();
};

/* Text of a number: without many zeros, with a true minus. */
function numbered(value) {
  const size = Math.abs(value);
  if (value && (size < 1e-3 || size >= 1e6)) {
    const [factor, power] = value.toExponential(2).split("e");
    const raised = [...String(+power)].map(letter => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(letter)]).join("");
    return `${+factor === 1 ? "" : `${+factor}·`}10${raised}`.replace("-", "−");
  }
  return String(+value.toPrecision(4)).replace("-", "−");
}

function evenTicks(low, high, most, least) {
  const rough = Math.max((high - low) / most, least), power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find(times => times * power >= rough * (1 - 1e-9));
  const first = Math.ceil(low / step - 1e-9), count = Math.floor(high / step + 1e-9) - first + 1;
  return Array.from({ length: Math.max(0, count) }, (_, index) => +((first + index) * step).toPrecision(12));
}

function ticks({ kind, step }, low, high, most) {
  const powers = Array.from({ length: 31 }, (_, index) => 10 ** (index - 15));
  const known = kind === "log" ? powers : powers.filter(value => value >= 1);
  const decades = [...known.map(value => -value).reverse(), 0, ...known].filter(value => value >= low && value <= high);
  if (kind === "linear" || decades.length < (kind === "log" ? 2 : 3)) return evenTicks(low, high, most, step);
  const every = Math.ceil(decades.length / most), zero = Math.max(0, decades.indexOf(0)) % every;
  return decades.filter((_, index) => index % every === zero);
}

/* Path of a series; at.x and at.y give pixels, at.left, at.right, at.top and at.bottom are the edges. */
function pathOf({ shape, x, y, xEnd, yEnd, width }, at) {
  const corner = (value, scale, edge) => (value === null ? edge : scale(value)).toFixed(2);
  const point = (right, down) => (down === null ? null : [at.x(right).toFixed(2), at.y(down).toFixed(2)]);
  const points = values => x.map((value, index) => point(value, values[index]));
  switch (shape) {
    case "line": {
      const placed = points(y);
      return placed.map((pair, index) => (pair ? `${placed[index - 1] ? "L" : "M"}${pair.join(" ")}` : "")).join("");
    }
    case "band": {
      const runs = [[]], [starts, ends] = [points(y), points(yEnd)];
      starts.forEach((start, index) => (start && ends[index] ? runs.at(-1).push([start, ends[index]]) : runs.push([])));
      const around = run => [...run.map(([start]) => start), ...run.map(([, end]) => end).reverse()];
      return runs.filter(run => run.length).map(run => `M${around(run).map(pair => pair.join(" ")).join("L")}Z`).join("");
    }
    case "dots":
      return points(y).filter(Boolean).map(([right, down]) => `M${right - width / 2} ${down}` +
        `a${width / 2} ${width / 2} 0 1 0 ${width} 0a${width / 2} ${width / 2} 0 1 0 ${-width} 0`).join("");
    default:
      return x.map((value, index) => {
        const [left, top] = [corner(value, at.x, at.left), corner(y[index], at.y, at.bottom)];
        const [right, bottom] = [corner(xEnd[index], at.x, at.right), corner(yEnd[index], at.y, at.top)];
        return shape === "boxes" ? `M${left} ${top}H${right}V${bottom}H${left}Z` : `M${left} ${top}L${right} ${bottom}`;
      }).join("");
  }
}

/* A part of a chart: one uPlot with its series. */
class Part {
  constructor(chart, { y, share, series }, isLast) {
    Object.assign(this, { chart, y, share, series, isLast });
    const font = `${TEXT_PX}px ${FONT}`;
    const axis = index => ({
      label: isLast && !index ? chart.x.label : null, labelSize: 15, labelGap: 0, labelFont: font, font, gap: 3,
      size: index ? 44 : isLast ? 20 : 6, stroke: () => screenColor("quiet"), ticks: { show: false },
      grid: { stroke: () => screenColor("grid"), width: 1 }, splits: () => this.ticks(index), filter: (_, splits) => splits,
      values: (_, values) => values.map(value => (index || isLast ? numbered(value) : "")),
    });
    this.plot = new uPlot({
      ...this.size(), padding: [LINE_PX + 4, 10, 0, 0], legend: { show: false },
      cursor: {
        y: false, points: { show: false }, drag: { x: true, y: false, dist: 4, setScale: false },
        bind: { dblclick: () => () => chart.zoom(chart.x.low, chart.x.high) },
      },
      scales: {
        x: { time: false, distr: MAPS[chart.x.kind].distr, range: (_, low, high) => [low, high] },
        y: { distr: MAPS[y.kind].distr, asinh: 1, range: () => this.heights() },
      },
      axes: [axis(0), axis(1)], series: [{}, { paths: () => null, points: { show: false } }],
      hooks: { draw: [() => this.draw()], setSelect: [() => this.zoom()], setCursor: [() => chart.tell(this)] },
    }, [[chart.x.low, chart.x.high], [null, null]], chart.place);
  }

  size() {
    const { clientWidth, clientHeight } = this.chart.place;
    return { width: clientWidth, height: (clientHeight - AXIS_PX) * this.share + (this.isLast ? AXIS_PX : 0) };
  }

  get visible() { return this.series.filter(one => !this.chart.off.has(one.key)); }

  /* Ends of the vertical scale: as stated, or those of the visible points with a margin within the stated ones. */
  heights() {
    const { low, high, kind } = this.y, { x, range, off } = this.chart;
    const isWhole = range[0] === x.low && range[1] === x.high;
    if (isWhole && !this.series.some(one => off.has(one.key))) return [low, high];
    const keyed = this.visible.filter(one => one.key), inside = x => x !== null && x >= range[0] && x <= range[1];
    const within = one => column => column.filter((value, index) => value !== null && inside(one.x[index]));
    const values = (keyed.length ? keyed : this.visible).flatMap(one => [one.y, one.yEnd ?? []].flatMap(within(one)));
    const [least, most] = [1, -1].map(sign => sign * values.reduce((end, value) => Math.min(end, sign * value), Infinity));
    if (!values.length) return [low, high];
    const { to, from } = MAPS[kind];
    const extra = MARGIN * (to(most) - to(least)) || MARGIN * (to(high) - to(low));
    return [Math.max(low, from(to(least) - extra)), Math.min(high, from(to(most) + extra))];
  }

  /* Zooms into the selected range. */
  zoom() {
    const { plot } = this, { left, width } = plot.select;
    if (!width) return;
    plot.setSelect({ left: 0, width: 0 }, false);
    this.chart.zoom(plot.posToVal(left, "x"), plot.posToVal(left + width, "x"));
  }

  ticks(index) {
    const { min, max } = this.plot.scales[index ? "y" : "x"], { width, height } = this.plot.over.getBoundingClientRect();
    const most = Math.max(2, Math.floor(index ? height / 24 : width / 52));
    return ticks(index ? this.y : this.chart.x, min, max, most);
  }

  /* Edges and scales in CSS pixels. */
  frame() {
    const { plot } = this, { left, top, width, height } = plot.bbox, ratio = uPlot.pxRatio;
    return {
      left: left / ratio, top: top / ratio, right: (left + width) / ratio, bottom: (top + height) / ratio,
      x: value => plot.valToPos(value, "x", true) / ratio, y: value => plot.valToPos(value, "y", true) / ratio,
    };
  }

  draw() {
    const { ctx } = this.plot, frame = this.frame();
    ctx.save();
    ctx.scale(uPlot.pxRatio, uPlot.pxRatio);
    ctx.beginPath();
    ctx.rect(frame.left, frame.top, frame.right - frame.left, frame.bottom - frame.top);
    ctx.clip();
    for (const one of this.visible) {
      const path = new Path2D(pathOf(one, frame)), color = screenColor(one.color);
      Object.assign(ctx, { globalAlpha: one.opacity ?? 1, lineWidth: one.width, lineJoin: "round" });
      Object.assign(ctx, { strokeStyle: color, fillStyle: color });
      ctx.setLineDash(DASHES[one.dash] ?? []);
      LINES.has(one.shape) ? ctx.stroke(path) : ctx.fill(path);
    }
    ctx.restore();
    Object.assign(ctx, { font: `${TEXT_PX * uPlot.pxRatio}px ${FONT}`, fillStyle: screenColor("quiet") });
    Object.assign(ctx, { textAlign: "left", textBaseline: "alphabetic" });
    ctx.fillText(this.y.label, LABEL_PX * uPlot.pxRatio, TEXT_PX * uPlot.pxRatio);
  }

  /* The part as SVG, below other parts. */
  svg(down, clip) {
    const frame = this.frame(), group = drawn("g", { transform: `translate(0 ${down})`, fill: "var(--quiet)" });
    const box = { x: frame.left, y: frame.top, width: frame.right - frame.left, height: frame.bottom - frame.top };
    const text = (x, y, words, more = {}) => group.append(drawn("text", { x, y, ...more }, words));
    const grid = d => group.append(drawn("path", { d, stroke: "var(--grid)", fill: "none" }));
    this.ticks(0).forEach(value => {
      grid(`M${frame.x(value)} ${frame.top}V${frame.bottom}`);
      if (this.isLast) text(frame.x(value), frame.bottom + 14, numbered(value), { "text-anchor": "middle" });
    });
    this.ticks(1).forEach(value => {
      grid(`M${frame.left} ${frame.y(value)}H${frame.right}`);
      text(frame.left - 5, frame.y(value) + 4, numbered(value), { "text-anchor": "end" });
    });
    text(LABEL_PX, TEXT_PX, this.y.label);
    const middle = (frame.left + frame.right) / 2;
    if (this.isLast) text(middle, frame.bottom + 31, this.chart.x.label, { "text-anchor": "middle" });
    const inside = drawn("g", { "clip-path": `url(#${clip})` }), shape = drawn("clipPath", { id: clip });
    shape.append(drawn("rect", box));
    inside.append(...this.visible.map(one => drawn("path", {
      d: pathOf(one, frame), opacity: one.opacity ?? 1, "data-curve": one.key ?? "", "stroke-linejoin": "round",
      "stroke-width": one.width, "stroke-dasharray": (DASHES[one.dash] ?? ["none"]).join(" "),
      [LINES.has(one.shape) ? "stroke" : "fill"]: `var(--${one.color})`,
      ...(LINES.has(one.shape) ? { fill: "none" } : {}),
    })));
    group.append(shape, inside);
    return group;
  }
}

/* Parts below each other with a common horizontal scale. */
class Chart {
  constructor(place, number) {
    const { x, height, parts, arrays } = JSON.parse(place.dataset.chart);
    Object.assign(this, { place, number, x, off: new Set(), range: [x.low, x.high], parts });
    const figure = place.closest("figure"), panel = place.closest(".panel");
    this.captions = [panel?.querySelector(".name"), figure?.querySelector("figcaption")].filter(Boolean);
    place.style.height = `${height}px`;
    place.tabIndex = 0;
    this.told = made("div", "values");
    const known = one => ["x", "y", "xEnd", "yEnd"].forEach(name => { one[name] = arrays[one[name]]; });
    parts.forEach(part => part.series.forEach(known));
    this.parts = parts.map((part, index) => new Part(this, part, index === parts.length - 1));
    this.captions[0]?.prepend(menu(this));
    place.append(this.told);
    place.addEventListener("keydown", event => this.key(event));
    place.addEventListener("pointerleave", () => { this.told.hidden = true; });
    new ResizeObserver(() => this.fit()).observe(place);
  }

  fit() { this.parts.forEach(part => part.plot.setSize(part.size())); }

  redraw() { this.zoom(...this.range); }

  /* All parts show a range, at most as wide as the chart. */
  zoom(low, high) {
    const { x } = this, { to, from } = MAPS[x.kind], [first, last] = [to(x.low), to(x.high)];
    const width = Math.max(to(high) - to(low), LEAST_SHARE * (last - first));
    const begin = Math.min(Math.max(to(low), first), Math.max(last - width, first));
    this.range = [begin === first ? x.low : from(begin), begin + width >= last ? x.high : from(begin + width)];
    this.parts.forEach(({ plot }) => plot.setScale("x", { min: this.range[0], max: this.range[1] }));
  }

  key(event) {
    const [low, high] = this.range, width = high - low;
    const moves = {
      "+": [low + width / 4, high - width / 4], "-": [low - width / 2, high + width / 2],
      ArrowLeft: [low - width / 4, high - width / 4], ArrowRight: [low + width / 4, high + width / 4],
      Escape: [this.x.low, this.x.high], 0: [this.x.low, this.x.high],
    };
    if (!(event.key in moves)) return;
    event.preventDefault();
    this.zoom(...moves[event.key]);
  }

  /* Values of the named series under the pointer, on the other side of the chart. */
  tell({ plot, visible }) {
    const { left } = plot.cursor, x = plot.posToVal(left, "x");
    this.told.hidden = !(left >= 0);
    if (this.told.hidden) return;
    const rows = visible.filter(one => one.name).map(one => {
      const far = index => Math.abs(one.x[index] - x);
      const nearest = one.x.reduce((best, _, index) => (far(index) < far(best) ? index : best), 0);
      return made("span", one.color, `${one.name} ${one.y[nearest] === null ? "–" : numbered(one.y[nearest])}`);
    });
    this.told.replaceChildren(made("span", "quiet", `${this.x.label}: ${numbered(x)}`), ...rows);
    this.told.classList.toggle("before", left > plot.over.clientWidth / 2);
  }

  get name() {
    const heading = this.captions.map(caption => caption.querySelector("b, strong")).find(Boolean);
    return heading ? words(heading) : this.place.getAttribute("aria-label");
  }

  fileName(ending) {
    const parts = [document.title, this.name].map(part => part.toLowerCase().replace(/[^a-z0-9]+/g, "-"));
    return `${parts.join("-").replace(/^-+|-+$/g, "").slice(0, 80)}.${ending}`;
  }

  /* Color, shape and text of the curves that the chart shows. */
  legend() {
    const keys = new Set(this.parts.flatMap(part => part.visible.map(one => one.key)));
    return this.captions.flatMap(caption => all(caption, "span"))
      .filter(entry => entry.firstElementChild?.matches(".key, .dot"))
      .filter(entry => !entry.dataset.switch || keys.has(entry.dataset.switch))
      .map(entry => ({
        color: [...entry.classList].find(name => name !== "switch" && name !== "off") ?? "ink",
        shape: [...entry.firstElementChild.classList], text: words(entry),
      }));
  }

  /* The chart as an element of SVG with the colors of paper; as a file it has its name and its legend, too. */
  svg(isFile = false) {
    const width = this.place.clientWidth, entries = isFile ? this.legend() : [];
    const root = drawn("svg", { "font-family": FONT, "font-size": TEXT_PX });
    let bottom = isFile ? 2 * LINE_PX : 0;
    const parts = this.parts.map((part, index) => {
      const group = part.svg(bottom, `clip-${this.number}-${index}${isFile ? "-file" : ""}`);
      bottom += part.plot.height;
      return group;
    });
    const height = bottom + entries.length * LINE_PX + (isFile ? PAD_PX : 0);
    root.setAttribute("viewBox", `0 0 ${width} ${height}`);
    if (isFile) {
      Object.entries({ width, height }).forEach(([name, value]) => root.setAttribute(name, value));
      root.append(drawn("rect", { width, height, fill: "var(--paper)" }),
        drawn("text", { x: PAD_PX, y: 1.3 * LINE_PX, "font-weight": "bold", fill: "var(--ink)" }, this.name));
    }
    root.append(...parts, ...entries.map((entry, index) => drawnEntry(entry, bottom + (index + 0.5) * LINE_PX)));
    return root;
  }

  source() {
    const color = paperColors();
    return new XMLSerializer().serializeToString(this.svg(true)).replace(/var\(--([\w-]+)\)/g, (_, name) => color(name));
  }

  async png() {
    const image = new Image();
    image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(this.source())}`;
    await image.decode();
    const height = Math.round(PNG_WIDTH * image.naturalHeight / image.naturalWidth);
    const canvas = Object.assign(document.createElement("canvas"), { width: PNG_WIDTH, height });
    canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
    return new Promise(resolve => canvas.toBlob(resolve, "image/png"));
  }
}

/* An entry of the legend of a file, which has an entry a line. */
function drawnEntry({ color, shape, text }, y) {
  const group = drawn("g", {}), dash = DASHES[shape.find(name => name in DASHES)] ?? ["none"];
  group.append(drawn("text", { x: 2 * PAD_PX + KEY_PX, y: y + 4, fill: "var(--ink)" }, text));
  group.append(shape.includes("dot") ? drawn("circle", { cx: PAD_PX + KEY_PX / 2, cy: y, r: 2, fill: `var(--${color})` }) :
    drawn("path", { d: `M${PAD_PX} ${y}h${KEY_PX}`, fill: "none", stroke: `var(--${color})`,
      "stroke-dasharray": dash.join(" "), "stroke-width": shape.includes("thin") ? 1 : 2 }));
  return group;
}

/* The button of a chart, and what it offers. */
function menu(chart) {
  const root = made("details", "save"), summary = made("summary", "small", "⤓"), offers = made("div", "");
  summary.title = "copy or save this chart";
  summary.setAttribute("aria-label", `copy or save the chart ${chart.name}`);
  const svg = () => new Blob([chart.source()], { type: "image/svg+xml" });
  const actions = {
    "save SVG": () => save(svg(), chart.fileName("svg")),
    "save PNG": async () => save(await chart.png(), chart.fileName("png")),
    "copy SVG": () => navigator.clipboard.writeText(chart.source()),
    "copy PNG": () => navigator.clipboard.write([new ClipboardItem({ "image/png": chart.png() })]),
  };
  offers.append(...Object.entries(actions).map(([text, act]) => {
    const button = made("button", "small", text);
    button.addEventListener("click", async () => {
      button.textContent = await Promise.resolve().then(act).then(() => "done", () => "not allowed here: save it");
      setTimeout(() => { button.textContent = text; }, SHOWN_MS);
    });
    return button;
  }));
  root.append(summary, offers);
  return root;
}

function save(blob, name) {
  const href = URL.createObjectURL(blob);
  Object.assign(document.createElement("a"), { href, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(href), 60_000);
}

/* The legend entries of a figure switch the curves of all its charts. */
class Legend {
  constructor(figure, charts) {
    Object.assign(this, { charts, names: all(figure, ".switch") });
    this.names.forEach(name => this.arm(name));
    if (this.names.length > 1) this.names.at(-1).after(" ", this.button("all", true), " ", this.button("none", false));
    this.turn(this.names.filter(name => "off" in name.dataset), false);
  }

  arm(name) {
    const marks = { role: "button", tabindex: "0", "aria-pressed": "true" };
    Object.entries(marks).forEach(([key, value]) => name.setAttribute(key, value));
    const press = alone => {
      if (alone) this.turn(this.names, false);
      this.turn([name], alone || name.classList.contains("off"));
    };
    name.addEventListener("click", event => press(event.shiftKey));
    name.addEventListener("keydown", event => {
      if (event.key !== "Enter" && event.key !== " ") return;
      event.preventDefault();
      press(event.shiftKey);
    });
  }

  turn(names, isOn) {
    names.forEach(name => {
      name.classList.toggle("off", !isOn);
      name.setAttribute("aria-pressed", String(isOn));
      this.charts.forEach(({ off }) => (isOn ? off.delete(name.dataset.switch) : off.add(name.dataset.switch)));
    });
    this.charts.forEach(chart => chart.redraw());
  }

  button(text, isOn) {
    const button = made("button", "small", text);
    button.addEventListener("click", () => this.turn(this.names, isOn));
    return button;
  }
}

function enlarger(panel) {
  const button = made("button", "small larger", "⤢");
  button.title = "enlarge, or shrink again";
  button.addEventListener("click", () => panel.classList.toggle("wide"));
  return button;
}

addEventListener("DOMContentLoaded", () => {
  const charts = all(document, ".chart").map((place, number) => new Chart(place, number));
  all(document, ".panel > .name").forEach(name => name.prepend(enlarger(name.parentElement)));
  const figures = all(document, "figure").filter(figure => figure.querySelector(".switch"));
  figures.forEach(figure => new Legend(figure, charts.filter(({ place }) => figure.contains(place))));
  figures[0]?.querySelector("figcaption").append(made("span", "hint", HINT)); // only once per page
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => charts.forEach(chart => chart.redraw()));
  const closeOthers = event => all(document, "details.save[open]")
    .filter(one => event.key === "Escape" || (event.type === "click" && !one.contains(event.target)))
    .forEach(one => { one.open = false; });
  ["click", "keydown"].forEach(kind => document.addEventListener(kind, closeOthers));
  addEventListener("beforeprint", () => charts.forEach(chart => chart.place.append(chart.svg())));
  addEventListener("afterprint", () => all(document, ".chart > svg").forEach(svg => svg.remove()));
});
})();
