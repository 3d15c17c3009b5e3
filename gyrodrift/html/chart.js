/* The script of charts: each can be copied, or saved as SVG or PNG. The picture has the colors of paper, the name of the
   chart and the legend of its curves, and it shows what the page shows: zoomed, and without curves that are off. */
(() => {
"use strict";

const PNG_WIDTH = 1600; // pixels
const FONT = "'DejaVu Sans', Arial, sans-serif"; // the font that charts were measured with
const TEXT_SIZE = 8, LINE_HEIGHT = 12, KEY_WIDTH = 14, PAD = 6, ENTRY_GAP = 12; // units of the chart
const SVG = "http://www.w3.org/2000/svg";
const DASHES = { dashed: "4 2", dotted: "1.4 1.6" };
const SHOWN_MS = 1500; // how long a button says that it is done

const all = (root, selector) => [...root.querySelectorAll(selector)];
const words = element => element.textContent.replace(/\s+/g, " ").trim();

/* Colors by name, as the style sheet states them for paper, whatever the screen shows now. */
const paperColors = () => {
  const [root] = [...document.styleSheets[0].cssRules].filter(rule => rule.selectorText === ":root");
  return name => root.style.getPropertyValue(`--${name}`).trim();
};

const element = (name, attributes, text = "") => {
  const made = document.createElementNS(SVG, name);
  Object.entries(attributes).forEach(([key, value]) => made.setAttribute(key, value));
  made.textContent = text;
  return made;
};

const textWidth = text => {
  const context = document.createElement("canvas").getContext("2d");
  context.font = `${TEXT_SIZE}px ${FONT}`;
  return context.measureText(text).width;
};

class Chart {
  constructor(svg) {
    this.svg = svg;
    const figure = svg.closest("figure"), panel = svg.closest(".panel");
    this.captions = [panel?.querySelector(".name"), figure?.querySelector("figcaption")].filter(Boolean);
    this.menu = this.captions[0] && new Menu(this);
    this.captions[0]?.prepend(this.menu.root);
  }

  get name() {
    const heading = this.captions.map(caption => caption.querySelector("b, strong")).find(Boolean);
    return heading ? words(heading) : this.svg.getAttribute("aria-label");
  }

  fileName(ending) {
    const parts = [document.title, this.name].map(part => part.toLowerCase().replace(/[^a-z0-9]+/g, "-"));
    return `${parts.join("-").replace(/^-+|-+$/g, "").slice(0, 80)}.${ending}`;
  }

  /* Color, shape and text of the curves that the chart shows. */
  legend() {
    const isDrawn = entry => !entry.dataset.switch ||
      (!entry.classList.contains("off") && this.svg.querySelector(`[data-curve="${CSS.escape(entry.dataset.switch)}"]`));
    return this.captions.flatMap(caption => all(caption, "span"))
      .filter(entry => entry.firstElementChild?.matches(".key, .dot") && isDrawn(entry))
      .map(entry => ({
        color: [...entry.classList].find(name => name !== "switch" && name !== "off") ?? "ink",
        shape: [...entry.firstElementChild.classList], text: words(entry),
      }));
  }

  /* The chart as a file of its own. */
  source() {
    const [, , width, height] = this.svg.getAttribute("viewBox").split(/\s+/).map(Number);
    const rows = rowsOf(this.legend(), width - 2 * PAD), top = 2 * LINE_HEIGHT;
    const whole = top + height + (rows.length ? rows.length * LINE_HEIGHT + PAD : 0);
    const inside = this.svg.cloneNode(true);
    all(inside, ".off, .passed, .shade").forEach(hidden => hidden.remove());
    const drawing = element("g", { transform: `translate(0 ${top})`, style: "stroke-linejoin: round; stroke-linecap: butt" });
    drawing.append(...inside.childNodes);
    const root = element("svg", {
      "xmlns:xlink": "http://www.w3.org/1999/xlink", viewBox: `0 0 ${width} ${whole}`, width: `${width}pt`, height: `${whole}pt`,
      "font-family": FONT, "font-size": TEXT_SIZE,
    });
    root.append(element("rect", { width, height: whole, fill: "var(--paper)" }),
      element("text", { x: PAD, y: 1.3 * LINE_HEIGHT, "font-weight": "bold", fill: "var(--ink)" }, this.name),
      drawing, ...rows.flatMap((row, i) => row.map(entry => drawnEntry(entry, top + height + (i + 0.5) * LINE_HEIGHT))));
    const color = paperColors();
    return new XMLSerializer().serializeToString(root).replace(/var\(--([\w-]+)\)/g, (_, name) => color(name));
  }

  svgBlob() { return new Blob([this.source()], { type: "image/svg+xml" }); }

  async pngBlob() {
    const image = new Image();
    image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(this.source())}`;
    await image.decode();
    const canvas = document.createElement("canvas");
    canvas.width = PNG_WIDTH;
    canvas.height = Math.round(PNG_WIDTH * image.naturalHeight / image.naturalWidth);
    canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
    return new Promise(resolve => canvas.toBlob(resolve, "image/png"));
  }
}

/* Legend entries in rows that fit the width, with the place of each. */
function rowsOf(entries, width) {
  const rows = [];
  let x = Infinity;
  for (const entry of entries) {
    const length = KEY_WIDTH + 3 + textWidth(entry.text);
    if (x + length > PAD + width) {
      rows.push([]);
      x = PAD;
    }
    rows.at(-1).push({ ...entry, x });
    x += length + ENTRY_GAP;
  }
  return rows;
}

function drawnEntry({ color, shape, text, x }, y) {
  const group = element("g", {}), paint = `var(--${color})`, isThin = shape.includes("thin");
  const dash = DASHES[shape.find(name => name in DASHES)] ?? "none";
  group.append(shape.includes("dot") ? element("circle", { cx: x + KEY_WIDTH / 2, cy: y, r: 1.6, fill: paint }) :
    element("path", { d: `M ${x} ${y} h ${KEY_WIDTH}`, fill: "none", stroke: paint, "stroke-dasharray": dash,
      "stroke-width": isThin ? 0.7 : 1.6 }),
  element("text", { x: x + KEY_WIDTH + 3, y: y + 0.35 * TEXT_SIZE, fill: "var(--ink)" }, text));
  return group;
}

/* The button of a chart, and what it offers. */
class Menu {
  constructor(chart) {
    this.root = Object.assign(document.createElement("details"), { className: "save" });
    const summary = Object.assign(document.createElement("summary"), { className: "small", textContent: "⤓" });
    summary.title = "copy or save this chart";
    summary.setAttribute("aria-label", `copy or save the chart ${chart.name}`);
    const offers = document.createElement("div");
    offers.append(
      this.offer("save SVG", () => save(chart.svgBlob(), chart.fileName("svg"))),
      this.offer("save PNG", async () => save(await chart.pngBlob(), chart.fileName("png"))),
      this.offer("copy SVG", () => navigator.clipboard.writeText(chart.source())),
      this.offer("copy PNG", () => navigator.clipboard.write([new ClipboardItem({ "image/png": chart.pngBlob() })])));
    this.root.append(summary, offers);
  }

  offer(text, act) {
    const button = Object.assign(document.createElement("button"), { className: "small", textContent: text });
    button.addEventListener("click", async () => {
      button.textContent = await Promise.resolve().then(act).then(() => "done", () => "not allowed here: save it");
      setTimeout(() => { button.textContent = text; }, SHOWN_MS);
    });
    return button;
  }
}

function save(blob, name) {
  const href = URL.createObjectURL(blob);
  Object.assign(document.createElement("a"), { href, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(href), 60_000);
}

const closeOthers = event => all(document, "details.save[open]")
  .filter(menu => event.key === "Escape" || (event.type === "click" && !menu.contains(event.target)))
  .forEach(menu => { menu.open = false; });

addEventListener("DOMContentLoaded", () => {
  all(document, "svg.chart").forEach(svg => new Chart(svg));
  ["click", "keydown"].forEach(kind => document.addEventListener(kind, closeOthers));
});
})();
