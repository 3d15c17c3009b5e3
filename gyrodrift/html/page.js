/* The script of a report: legend entries switch curves, and panels can be zoomed.
   Without it the page shows the same; nothing is fetched, because the figures already have all curves. */
(() => {
"use strict";

const HINT = "Click a name to switch its curves; with Shift, only its curves stay. Drag across a panel to zoom into that " +
  "time; a double click shows everything again. The vertical scale follows the visible curves.";
const MOST_TICKS = 6;
const LEAST_APART = { x: 16, y: 9 }; // distance of ticks, in units of the drawing
const LEAST_SHARE = 1e-3; // share of the width of a panel: the deepest zoom
const MARGIN = 0.06;

const all = (root, what) => [...root.querySelectorAll(what)];
const made = (name, kind, words) => Object.assign(document.createElement(name), { className: kind, textContent: words });

/* Values on a scale, and back, as matplotlib draws them. */
const LINEAR_SHARE = 10 / 9;
const SCALES = {
  linear: { to: v => v, from: u => u },
  log: { to: v => Math.log10(v), from: u => 10 ** u },
  symlog: {
    to: v => Math.abs(v) <= 1 ? v * LINEAR_SHARE : Math.sign(v) * (LINEAR_SHARE + Math.log10(Math.abs(v))),
    from: u => Math.abs(u) <= LINEAR_SHARE ? u / LINEAR_SHARE : Math.sign(u) * 10 ** (Math.abs(u) - LINEAR_SHARE),
  },
};

const numbered = value => String(+value.toPrecision(6)).replace("-", "−");

function even(low, high) {
  const rough = (high - low) / MOST_TICKS, power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find(times => times * power >= rough);
  const first = Math.ceil(low / step - 1e-9), count = Math.floor(high / step + 1e-9) - first + 1;
  return Array.from({ length: Math.max(0, count) }, (_, at) => (first + at) * step);
}

function decades(low, high) {
  const powers = Array.from({ length: 31 }, (_, at) => 10 ** (at - 15));
  const within = [...powers.map(v => -v).reverse(), 0, ...powers].filter(v => v >= low && v <= high);
  const every = Math.ceil(within.length / MOST_TICKS);
  return within.filter((_, at) => at % every === 0);
}

function marks(kind, low, high) {
  const known = kind === "linear" ? [] : decades(low, high).filter(v => kind === "log" || v === 0 || Math.abs(v) >= 1);
  return known.length >= 3 ? known : even(low, high);
}

/* An axis of a panel: its pixels from `begin` to `end`, and its ticks. */
class Axis {
  constructor(group, begin, end, scale) {
    Object.assign(this, { group, begin, end, kind: scale.kind, scale: SCALES[scale.kind] });
    this.isX = group.dataset.axis === "x";
    this.ends = [scale.low, scale.high].map(this.scale.to);
    this.drawn = all(group, ".tick");
    this.extra = [];
  }

  value(pixel) {
    const share = (pixel - this.begin) / (this.end - this.begin);
    return this.scale.from(this.ends[0] + share * (this.ends[1] - this.ends[0]));
  }

  pixel(value) {
    const share = (this.scale.to(value) - this.ends[0]) / (this.ends[1] - this.ends[0]);
    return this.begin + share * (this.end - this.begin);
  }

  /* Stretches the pixels from `low` to `high` over the whole axis, or restores the drawing. */
  show(low, high, isWhole) {
    this.extra.forEach(one => one.remove());
    this.drawn.forEach(one => one.classList.toggle("passed", !isWhole));
    this.extra = isWhole || !this.drawn.length ? [] : this.places(low, high).map(([value, at]) => this.mark(value, at));
  }

  /* Ticks and their pixels, with enough distance for their labels. */
  places(low, high) {
    const kept = [], least = LEAST_APART[this.group.dataset.axis];
    for (const value of marks(this.kind, this.value(low), this.value(high))) {
      const at = this.begin + (this.pixel(value) - low) / (high - low) * (this.end - this.begin);
      if (kept.every(([, other]) => Math.abs(other - at) >= least)) kept.push([value, at]);
    }
    return kept;
  }

  mark(value, pixel) {
    const copy = this.drawn[0].cloneNode(true), words = copy.querySelector("text");
    const was = +copy.querySelector("use").getAttribute(this.isX ? "x" : "y");
    all(copy, "defs").forEach(one => one.remove());
    copy.classList.remove("passed");
    copy.setAttribute("transform", this.isX ? `translate(${pixel - was} 0)` : `translate(0 ${pixel - was})`);
    if (words) words.textContent = numbered(value);
    return this.group.appendChild(copy);
  }
}

/* A curve: its drawn points in pixels; a stroke ends at NaN. */
class Curve {
  constructor(group) {
    this.group = group;
    this.path = group.querySelector("path");
    this.whole = this.path.getAttribute("d");
    this.points = (this.whole.match(/[ML][^ML]*/g) || []).map(one =>
      [one[0], ...one.slice(1).trim().split(/[\s,]+/).map(Number)]);
  }

  get isShown() { return !this.group.classList.contains("off"); }

  draw(map) {
    this.path.setAttribute("d", map ? this.points.map(([kind, x, y]) => {
      const [right, down] = map(x, y);
      return `${kind} ${right.toFixed(2)} ${down.toFixed(2)}`;
    }).join(" ") : this.whole);
  }
}

class Panel {
  constructor(group) {
    const { box: [left, top, right, bottom], x, y } = JSON.parse(group.dataset.scales);
    Object.assign(this, { left, top, right, bottom });
    this.x = new Axis(group.querySelector("[data-axis=x]"), left, right, x);
    this.y = new Axis(group.querySelector("[data-axis=y]"), bottom, top, y);
    this.curves = all(group, "[data-curve]").map(one => new Curve(one));
    this.lines = all(group, "[data-line]").map(one => new Curve(one));
  }

  show(low, high) {
    const isWhole = low === this.left && high === this.right && this.curves.every(one => one.isShown);
    const [bottom, top] = isWhole ? [this.bottom, this.top] : this.heights(low, high);
    const across = (this.right - this.left) / (high - low), up = (this.top - this.bottom) / (top - bottom);
    const map = isWhole ? null : (x, y) => [this.left + (x - low) * across, this.bottom + (y - bottom) * up];
    [...this.curves, ...this.lines].forEach(one => one.draw(map));
    this.x.show(low, high, isWhole);
    this.y.show(bottom, top, isWhole);
  }

  /* Pixels of the lowest and the highest visible point, with a margin, within the drawing. */
  heights(low, high) {
    const found = this.curves.filter(one => one.isShown).flatMap(one => one.points)
      .filter(([, x]) => x >= low && x <= high).map(([, , y]) => Math.min(Math.max(y, this.top), this.bottom));
    if (!found.length) return [this.bottom, this.top];
    const lowest = found.reduce((a, b) => Math.max(a, b)), highest = found.reduce((a, b) => Math.min(a, b));
    const margin = MARGIN * (lowest - highest) || 1;
    return [Math.min(lowest + margin, this.bottom), Math.max(highest - margin, this.top)];
  }
}

/* A drawing of panels above each other with a common time axis. */
class Drawing {
  constructor(svg) {
    this.svg = svg;
    this.panels = all(svg, "[data-scales]").map(one => new Panel(one));
    [this.left, this.right] = [this.panels[0].left, this.panels[0].right];
    this.range = [this.left, this.right];
    svg.classList.add("zooms");
    svg.setAttribute("tabindex", "0");
    svg.addEventListener("pointerdown", event => this.begin(event));
    svg.addEventListener("pointermove", event => this.move(event));
    svg.addEventListener("pointerup", event => this.end(event));
    svg.addEventListener("pointercancel", () => this.drop());
    svg.addEventListener("dblclick", () => this.zoom(this.left, this.right));
    svg.addEventListener("keydown", event => this.key(event));
  }

  show() { this.panels.forEach(one => one.show(...this.range)); }

  zoom(low, high) {
    const least = LEAST_SHARE * (this.right - this.left), width = Math.max(high - low, least);
    const begin = Math.min(Math.max(low, this.left), Math.max(this.right - width, this.left));
    this.range = [begin, Math.min(begin + width, this.right)];
    this.show();
  }

  at(event) {
    const { x } = new DOMPoint(event.clientX, event.clientY).matrixTransform(this.svg.getScreenCTM().inverse());
    return Math.min(Math.max(x, this.left), this.right);
  }

  begin(event) {
    if (event.button !== 0) return;
    this.from = this.at(event);
    this.shade = document.createElementNS(this.svg.namespaceURI, "rect");
    this.shade.setAttribute("class", "shade");
    this.svg.append(this.shade);
    if (event.isTrusted) this.svg.setPointerCapture(event.pointerId);
    this.move(event);
  }

  move(event) {
    if (!this.shade) return;
    const to = this.at(event), { top } = this.panels[0], { bottom } = this.panels.at(-1);
    const place = { x: Math.min(this.from, to), y: top, width: Math.abs(to - this.from), height: bottom - top };
    Object.entries(place).forEach(([name, value]) => this.shade.setAttribute(name, value));
  }

  end(event) {
    if (!this.shade) return;
    const ends = [this.from, this.at(event)].sort((a, b) => a - b), [low, high] = this.range;
    const inside = ends.map(pixel => low + (pixel - this.left) / (this.right - this.left) * (high - low));
    this.drop();
    if (ends[1] - ends[0] > 4) this.zoom(...inside);
  }

  drop() {
    this.shade?.remove();
    this.shade = null;
  }

  key(event) {
    const [low, high] = this.range, width = high - low;
    const moves = {
      "+": [low + width / 4, high - width / 4], "-": [low - width / 2, high + width / 2],
      ArrowLeft: [low - width / 4, high - width / 4], ArrowRight: [low + width / 4, high + width / 4],
      Escape: [this.left, this.right], 0: [this.left, this.right],
    };
    if (!(event.key in moves)) return;
    event.preventDefault();
    this.zoom(...moves[event.key]);
  }
}

/* A figure: its legend entries switch the curves of all its drawings. */
class Figure {
  constructor(figure) {
    this.figure = figure;
    this.drawings = all(figure, "svg").filter(svg => svg.querySelector("[data-scales]")).map(svg => new Drawing(svg));
    this.names = all(figure, ".switch");
    this.names.forEach(name => this.arm(name));
    if (this.names.length > 1) this.names.at(-1).after(" ", this.button("all", true), " ", this.button("none", false));
    all(figure, ".panel > .name").forEach(name => name.prepend(this.enlarger(name.parentElement)));
    const off = this.names.filter(name => "off" in name.dataset);
    if (off.length) this.turn(off, false);
  }

  arm(name) {
    name.setAttribute("role", "button");
    name.setAttribute("tabindex", "0");
    const press = alone => alone ? this.only(name) : this.turn([name], name.classList.contains("off"));
    name.addEventListener("click", event => press(event.shiftKey));
    name.addEventListener("keydown", event => {
      if (event.key !== "Enter" && event.key !== " ") return;
      event.preventDefault();
      press(event.shiftKey);
    });
    name.setAttribute("aria-pressed", "true");
  }

  only(name) {
    this.turn(this.names.filter(other => other !== name), false);
    this.turn([name], true);
  }

  turn(names, isOn) {
    names.forEach(name => {
      name.classList.toggle("off", !isOn);
      name.setAttribute("aria-pressed", String(isOn));
      all(this.figure, `[data-curve="${CSS.escape(name.dataset.switch)}"]`)
        .forEach(curve => curve.classList.toggle("off", !isOn));
    });
    this.drawings.forEach(one => one.show());
  }

  button(words, isOn) {
    const button = made("button", "small", words);
    button.addEventListener("click", () => this.turn(this.names, isOn));
    return button;
  }

  enlarger(panel) {
    const button = made("button", "small larger", "⤢");
    button.title = "enlarge, or shrink again";
    button.addEventListener("click", () => panel.classList.toggle("wide"));
    return button;
  }
}

addEventListener("DOMContentLoaded", () => {
  const figures = all(document, "figure").filter(one => one.querySelector("[data-curve]")).map(one => new Figure(one));
  figures[0]?.figure.querySelector("figcaption").append(made("span", "hint", HINT)); // only once per page
});
})();
