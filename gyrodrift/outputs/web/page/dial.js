// The dial: a compass after a heading was set, otherwise yaw with 0 at the top. Unknown needles are hidden.

import { drawn, set } from "./svg.js";

const NARROWEST_DEG = 0.6;

// Point on a circle around 0, 0; clockwise from the top.
const at = (deg, radius) => {
  const turned = (deg * Math.PI) / 180;
  return [(radius * Math.sin(turned)).toFixed(2), (-radius * Math.cos(turned)).toFixed(2)];
};

function sector(fromDeg, toDeg, radius) {
  const [left, right] = [at(fromDeg, radius), at(toDeg, radius)];
  return `M0 0L${left}A${radius} ${radius} 0 ${toDeg - fromDeg > 180 ? 1 : 0} 1 ${right}Z`;
}

export class Dial {
  constructor(place) {
    this.svg = drawn(place, "svg", { viewBox: "-140 -128 280 256", role: "img", "aria-label": "Heading dial" });
    drawn(this.svg, "circle", { r: 100, class: "face" });
    for (let deg = 0; deg < 360; deg += 10) {
      const [x1, y1] = at(deg, 100);
      const [x2, y2] = at(deg, deg % 90 ? (deg % 30 ? 95 : 91) : 87);
      drawn(this.svg, "line", { x1, y1, x2, y2, class: deg % 30 ? "tick" : "tick strong" });
    }
    this.labels = [0, 90, 180, 270].map((deg) => {
      const [x, y] = at(deg, 118);
      return drawn(this.svg, "text", { x, y, class: "label" });
    });
    this.band = drawn(this.svg, "path", { class: "band" });
    this.raw = drawn(this.svg, "path", { d: "M0 0V-84", class: "raw" });
    this.encoder = drawn(this.svg, "path", { d: "M-5 -108L5 -108L0 -99Z", class: "encoder" });
    this.yaw = drawn(this.svg, "path", { d: "M0 -92L6 0L0 8L-6 0Z", class: "yaw" });
    drawn(this.svg, "circle", { r: 3, class: "hub" });
  }

  // Angles in degrees; NaN if unknown. Yaw is counter-clockwise, a heading clockwise.
  show({ yaw, raw, encoder, sigma, heading }) {
    const hasNorth = Number.isFinite(heading);
    const words = hasNorth ? ["N", "E", "S", "W"] : ["0", "−90", "180", "90"];
    this.labels.forEach((label, number) => label.textContent === words[number] || (label.textContent = words[number]));
    const turned = hasNorth ? heading : -yaw;
    this.turn(this.yaw, turned);
    this.turn(this.raw, turned + yaw - raw);
    this.turn(this.encoder, turned + yaw - encoder);
    const half = Math.min(179.9, Math.max(NARROWEST_DEG, 2 * sigma));
    set(this.band, "d", Number.isFinite(half) ? sector(turned - half, turned + half, 92) : "");
  }

  turn(needle, deg) {
    set(needle, "visibility", Number.isFinite(deg) ? "visible" : "hidden");
    if (Number.isFinite(deg)) set(needle, "transform", `rotate(${(deg % 360).toFixed(2)})`);
  }
}
