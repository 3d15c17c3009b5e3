// The horizon as a person on the device sees it: it rises on the side that is down, and sinks if the nose goes up.

import { drawn, set } from "./svg.js";
import { angle, fixed } from "./words.js";

const EDGE_DEG = 45; // pitch that moves the horizon to the rim
const RADIUS = 100;
const PER_DEG = RADIUS / EDGE_DEG;
const FAR = 400; // beyond the rim at any pitch

export class Horizon {
  constructor(place) {
    this.place = place;
    this.svg = drawn(place, "svg", { viewBox: "-110 -110 220 220", role: "img" });
    const clip = drawn(drawn(this.svg, "defs", {}), "clipPath", { id: "horizon-rim" });
    drawn(clip, "circle", { r: RADIUS });
    const view = drawn(this.svg, "g", { "clip-path": "url(#horizon-rim)" });
    this.world = drawn(view, "g", {});
    drawn(this.world, "rect", { x: -FAR, y: -FAR, width: 2 * FAR, height: FAR, class: "sky" });
    drawn(this.world, "rect", { x: -FAR, y: 0, width: 2 * FAR, height: FAR, class: "ground" });
    drawn(this.world, "line", { x1: -FAR, x2: FAR, y1: 0, y2: 0, class: "line" });
    for (let deg = -80; deg <= 80; deg += 10) {
      const half = deg % 20 ? 9 : 18;
      if (deg) drawn(this.world, "line", { x1: -half, x2: half, y1: deg * PER_DEG, y2: deg * PER_DEG, class: "step" });
    }
    drawn(this.svg, "circle", { r: RADIUS, class: "face" });
    for (const deg of [-60, -30, 0, 30, 60]) {
      drawn(this.svg, "line", { y1: -RADIUS, y2: deg ? -93 : -89, class: "tick", transform: `rotate(${deg})` });
    }
    this.bank = drawn(this.svg, "path", { d: "M0 -88L6 -77H-6Z", class: "bank" });
    drawn(this.svg, "path", { d: "M-62 0H-22L-14 9M62 0H22L14 9", class: "device" });
    drawn(this.svg, "circle", { r: 3.5, class: "nose" });
  }

  // Roll is positive with the right side down, pitch with the nose down; degrees. Undefined angles hide the horizon.
  show({ roll, pitch }) {
    this.place.hidden = !(Number.isFinite(roll) && Number.isFinite(pitch));
    if (this.place.hidden) return;
    set(this.world, "transform", `rotate(${(-roll).toFixed(2)}) translate(0 ${(-pitch * PER_DEG).toFixed(2)})`);
    set(this.bank, "transform", `rotate(${(-roll).toFixed(2)})`);
  }

  describe({ roll, pitch }) {
    set(this.svg, "aria-label", `Horizon. ${side(roll)}; ${nose(pitch)}.`);
  }
}

// Sentences about a tilt.
export function side(roll) {
  if (fixed(roll, 1) === 0) return "Sides level";
  return `${roll > 0 ? "Right" : "Left"} side ${angle(Math.abs(roll), 1)} down`;
}

export function nose(pitch) {
  if (fixed(pitch, 1) === 0) return "Nose level";
  return `Nose ${angle(Math.abs(pitch), 1)} ${pitch > 0 ? "down" : "up"}`;
}
