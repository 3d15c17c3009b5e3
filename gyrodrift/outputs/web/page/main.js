// Main module: messages of the stream go into the history, which is drawn with the next frame of the screen.

import { Charts } from "./charts.js";
import { Connection } from "./connection.js";
import { Controls } from "./controls.js";
import { Dial } from "./dial.js";
import { History } from "./history.js";
import { Horizon } from "./horizon.js";
import { showEvent, showNumbers, showState, showTilt } from "./panels.js";
import { clock } from "./words.js";

const WINDOWS = [["10 s", 10], ["30 s", 30], ["2 min", 120], ["10 min", 600], ["1 h", 3600]];

const TEXT_MS = 100; // faster changes of numbers cannot be read

const byId = (id) => document.getElementById(id);
const dial = new Dial(byId("dial"));
const horizon = new Horizon(byId("horizon"));
const changes = new Set(); // times at which a config was applied
let windowS = 30; // at the start
let history = null;
let charts = null;
let isDue = false;
let textTimer = null;
let lostAt = null;

function drawSoon() {
  if (isDue || !history) return;
  isDue = true;
  requestAnimationFrame(draw);
}

function draw() {
  isDue = false;
  if (!history.rows) return;
  charts.draw();
  dial.show({
    yaw: history.last("yaw_deg"), raw: history.last("raw_yaw_deg"), encoder: history.last("encoder_deg"),
    sigma: history.last("yaw_sigma_deg"), heading: history.last("heading_deg"),
  });
  horizon.show(tilt());
  textTimer ??= setTimeout(drawText, TEXT_MS);
}

// Tilt of the newest sample, NaN for a device with one axis.
const tilt = () => ({ roll: history.last("roll_deg"), pitch: history.last("pitch_deg") });

function drawText() {
  textTimer = null;
  showNumbers(history);
  showTilt(tilt());
  horizon.describe(tilt());
  controls.showAxes(Number.isFinite(tilt().roll));
  showPosition();
}

// Position of the charts in the hour.
function showPosition() {
  const isLive = charts.endS === null;
  byId("live").hidden = isLive;
  const back = byId("back");
  const { firstS, lastS } = history;
  [back.min, back.max] = [firstS, lastS];
  back.value = charts.endS ?? lastS;
  byId("back-text").textContent = isLive ? "Look back" : `Until ${clock(charts.endS)}`;
  for (const button of byId("windows").children) {
    button.setAttribute("aria-pressed", String(Number(button.value) === charts.windowS));
  }
}

// Make history and charts for the columns of the stream.
function begin(hello) {
  if (!history || history.names.join() !== hello.columns.join()) {
    history = new History(hello.columns);
    byId("charts").replaceChildren();
    charts = new Charts(byId("charts"), history, changes, windowS, drawSoon);
  }
  history.startsAt(hello.now_s);
  controls.greet(hello.has_buttons);
}

function takeEvent(message) {
  if (message.event === "config_applied") changes.add(message.t_s);
  showEvent(message);
}

const HANDLERS = {
  hello: begin,
  event: takeEvent,
  state: (message) => {
    showState(message);
    controls.showState(message.status);
  },
  answer: (message) => controls.answer(message),
  dropped: ({ messages }) => showEvent({ t_s: Date.now() / 1000, event: "page_too_slow", fields: { messages } }),
};

function take(content) {
  if (content instanceof ArrayBuffer) history.read(content);
  else HANDLERS[content.kind]?.(content);
  drawSoon();
}

function showConnection(state) {
  const element = byId("connection");
  if (state === "lost") lostAt ??= Date.now() / 1000;
  else lostAt = null;
  const text = lostAt === null ? "Live" : `No connection since ${clock(lostAt)}; reconnecting …`;
  if (element.textContent === text) return;
  element.textContent = text;
  element.dataset.state = state;
  document.body.classList.toggle("stale", state === "lost");
}

for (const [text, lengthS] of WINDOWS) {
  const button = document.createElement("button");
  Object.assign(button, { type: "button", textContent: text, value: lengthS });
  button.addEventListener("click", () => {
    windowS = lengthS;
    charts?.lookAt(charts.endS ?? Infinity, windowS);
  });
  byId("windows").append(button);
}
byId("live").addEventListener("click", () => charts?.lookAt(Infinity));
byId("back").addEventListener("input", (event) => charts?.lookAt(Number(event.target.value)));
document.addEventListener("visibilitychange", drawSoon);

const connection = new Connection(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/stream`, {
  message: take,
  change: showConnection,
  refused: () => controls.forget(),
});
const controls = new Controls((message) => connection.send(message));
