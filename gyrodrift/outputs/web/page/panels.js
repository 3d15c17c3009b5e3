// Panels beside the charts: numbers, link, config, events, clients.

import { nose, side } from "./horizon.js";
import * as words from "./words.js";

const MOST_EVENTS = 100;

const byId = (id) => document.getElementById(id);

function made(kind, text = "", name = "") {
  const element = document.createElement(kind);
  element.textContent = text;
  element.className = name;
  return element;
}

// Names and values as a list, without empty values. Only changed elements are updated.
function showFacts(place, facts) {
  const shown = facts.filter(([, value]) => value !== "" && value !== null && value !== undefined);
  while (place.children.length > 2 * shown.length) place.lastChild.remove();
  shown.forEach(([name, value, kind = ""], at) => {
    if (place.children.length <= 2 * at) place.append(made("dt"), made("dd"));
    const [term, text] = [place.children[2 * at], place.children[2 * at + 1]];
    if (term.textContent !== name) term.textContent = name;
    if (term.className !== kind) term.className = kind;
    if (text.textContent !== value) text.textContent = value;
  });
}

const finite = (value, text) => (Number.isFinite(value) ? text : "");

const degrees = (value) => `${words.signed(words.fixed(value, 1), 1)}°`;

let isCalibrated = false; // rates are calibrated before the filter

const rateName = (name) => (isCalibrated ? `${name}, calibrated` : name);

let scaleSigmaDeg = NaN; // share of the yaw sigma from the scale factor, once a second

let own = { yawDeg: NaN, sigmaDeg: NaN }; // last result of the device's own filter; not every sample has one

export function showNumbers(history) {
  const last = (name) => history.last(name);
  if (Number.isFinite(last("device_yaw_deg"))) own = { yawDeg: last("device_yaw_deg"), sigmaDeg: last("device_yaw_sigma_deg") };
  const hasNorth = Number.isFinite(last("heading_deg"));
  byId("main-name").textContent = hasNorth ? "Heading" : "Yaw";
  byId("main-value").textContent = words.angle(hasNorth ? last("heading_deg") : last("yaw_deg"));
  const scaleDeg = Math.min(scaleSigmaDeg, last("yaw_sigma_deg")); // a share that is a second old may exceed the whole
  const scale = Number.isFinite(scaleDeg) ? `, scale ${words.number(scaleDeg, 2)}°` : "";
  byId("main-sigma").textContent = words.margin(last("yaw_sigma_deg"), 2, `° (1σ${scale})`);
  const errorDeg = last("yaw_deg") - last("encoder_deg");
  byId("error").hidden = !Number.isFinite(errorDeg);
  byId("error-value").textContent = `${words.signed(errorDeg, 2)}°`;
  const bias = `${words.signed(last("bias_dps"), 4)}${words.margin(last("bias_sigma_dps"), 4)} deg/s`;
  showFacts(byId("values"), [
    ["Yaw", hasNorth ? words.angle(last("yaw_deg")) : "", "key yaw"],
    [rateName("Raw yaw"), words.angle(last("raw_yaw_deg")), "key raw"],
    ["Encoder", finite(last("encoder_deg"), words.angle(last("encoder_deg"))), "key encoder"],
    ["Device yaw", finite(own.yawDeg, `${words.angle(own.yawDeg)}${words.margin(own.sigmaDeg, 2, "°")}`)],
    ["Difference", finite(last("device_difference_deg"), `${words.signed(last("device_difference_deg"), 2)}°`), "key device"],
    ["Roll", finite(last("roll_deg"), degrees(last("roll_deg"))), "key roll"],
    ["Pitch", finite(last("pitch_deg"), degrees(last("pitch_deg"))), "key pitch"],
    ["Tilt", finite(last("tilt_deg"), `${words.number(last("tilt_deg"), 1)}${words.margin(last("tilt_sigma_deg"), 2)}°`)],
    ["Bias", bias, "key drift"],
    [rateName("Rate"), `${words.signed(last("rate_dps"), 2)} deg/s`, "key rate"],
    ["Corrected rate", `${words.signed(last("corrected_dps"), 2)} deg/s`],
    ["At rest", finite(last("rest_probability"), words.percent(last("rest_probability"))), "key rest"],
    ["Temperature", finite(last("temp_c"), `${words.number(last("temp_c"), 1)} °C`)],
  ]);
}

// The tilt in words, below the dial; hidden for a device with one axis.
export function showTilt({ roll, pitch }) {
  const hasTilt = Number.isFinite(roll) && Number.isFinite(pitch);
  byId("tilt").hidden = !hasTilt;
  document.querySelector(".now").classList.toggle("tilts", hasTilt);
  if (!hasTilt) return;
  byId("tilt-roll").textContent = side(roll);
  byId("tilt-pitch").textContent = nose(pitch);
}

// Age and weight of a second source, or why it is left out.
function aidText({ age_s: ageS, weight, differs }) {
  if (differs) return `left out: ${differs}`;
  return `${ageS === null ? "no measurement" : `${words.number(ageS, 1)} s ago`}${weight === null ? "" : `, ${words.percent(weight)} agree`}`;
}

export function showState({ status, health }) {
  const { link, device, config } = status;
  isCalibrated = config.calibration !== null;
  scaleSigmaDeg = status.filter.scale_sigma_deg ?? NaN;
  byId("device").textContent = [device.device_id, link.port].filter(Boolean).join(" on ");
  byId("health").replaceChildren(...health.map((finding) => made("li", finding.says, finding.level)));
  showFacts(byId("link"), [
    ["Sample rate", `${words.number(link.rate_hz, 1)} Hz`],
    ["Jitter", `${words.number(link.jitter_ms, 1)} ms`],
    ["Samples", words.count(link.samples)],
    ["Gaps", link.gaps ? `${words.count(link.gaps)} (${words.counted(link.missing, "sample")})` : "0"],
    ["Damaged frames", words.count(link.damaged)],
    ["Device clock", link.clock_ppm === null ? "" : `${words.signed(link.clock_ppm, 0)} ppm`],
    ["Line used", link.busy ? words.percent(link.busy) : ""],
    ["Protocol", link.protocol + (link.baud ? `, ${link.baud} baud` : "")],
    ...Object.entries(status.filter.aids ?? {}).map(([name, aid]) => [`Second source ${name}`, aidText(aid)]),
  ]);
  const taken = config.applied ? `, ${words.counted(config.applied, "change")} applied, the last at ${words.clock(config.applied_s)}` : "";
  byId("config-file").textContent = config.file ? `${config.file}${taken}` : `Without a file: ${config.filter} at its defaults.`;
  const values = [...Object.entries(config.params), ...Object.entries(config.calibration ?? {}).map(([name, value]) => [`calibration ${name}`, value])];
  showFacts(byId("config"), [["filter", config.filter], ...values.map(([name, value]) => [name, String(value)])]);
  showClients(status.outputs);
  showFacts(byId("service"), [
    ["Service", `gyrodrift ${status.version}, process ${status.pid}`],
    ["Uptime", words.duration(status.uptime_s)],
    ["Memory", words.megabytes(status.memory_bytes)],
  ]);
}

function showClients(outputs) {
  const rows = outputs.flatMap((output) => {
    const name = [output.output, output.problem || output.address.replace(/^http:\/\//, "")];
    const others = output.client_count - output.clients.length;
    const lines = output.clients.map((client) => [client.peer, client.sent, client.dropped]);
    if (others > 0) lines.push([`and ${others} more`, "", ""]);
    if (!lines.length) lines.push([output.problem ? "" : "no client", output.sent, output.dropped]);
    return lines.map((cells, at) => row(at ? ["", ""] : name, cells));
  });
  byId("clients").replaceChildren(...rows);
}

function row([name, address], [peer, sent, dropped]) {
  const line = made("tr");
  const output = made("th", name);
  if (address) output.append(made("small", address));
  const numbers = [sent, dropped].map((value) => made("td", value === "" ? "" : words.count(value), "number"));
  line.append(output, made("td", peer), ...numbers);
  return line;
}

// Events that are on the page, such as those of the connection before.
const shownEvents = new Set();

export function showEvent({ t_s: atS, event, fields }) {
  const key = `${atS} ${event}`;
  if (shownEvents.has(key)) return;
  shownEvents.add(key);
  const place = byId(event.startsWith("config_") ? "config-events" : "events");
  place.querySelector(".none")?.remove();
  const item = made("li", "", event.endsWith("_rejected") || event === "link_lost" ? "bad" : "");
  const [sentence, ...details] = words.event(event, fields);
  item.append(made("time", words.clock(atS)), made("span", sentence), ...details.map((line) => made("code", line)));
  place.prepend(item);
  while (place.children.length > MOST_EVENTS) place.lastChild.remove();
}
