// Numbers and times as text, with units.

const MISSING = "–";

export const number = (value, digits) =>
  Number.isFinite(value) ? value.toFixed(digits).replace(/^-(?=[0.]*$)/, "").replace("-", "−") : MISSING;

export const signed = (value, digits) =>
  Number.isFinite(value) ? (value < 0 ? "" : "+") + number(value, digits) : MISSING;

export const angle = (value, digits = 2) => (Number.isFinite(value) ? `${number(value, digits)}°` : MISSING);

export const fixed = (value, digits) => Number(value.toFixed(digits));

// Standard deviation behind a value; empty if unknown.
export const margin = (sigma, digits, unit = "") => (Number.isFinite(sigma) ? ` ± ${number(sigma, digits)}${unit}` : "");

export const count = (value) => Math.round(value).toLocaleString("en").replaceAll(",", "\u202f");

export const counted = (value, what) => `${count(value)} ${what}${value === 1 ? "" : "s"}`;

export const clock = (unixS) => new Date(1000 * unixS).toLocaleTimeString([], { hour12: false });

export function duration(seconds) {
  if (seconds < 60) return `${Math.round(seconds)} s`;
  if (seconds < 3600) return `${Math.floor(seconds / 60)} min ${Math.round(seconds % 60)} s`;
  return `${Math.floor(seconds / 3600)} h ${Math.floor((seconds % 3600) / 60)} min`;
}

export const megabytes = (bytes) => `${number(bytes / 1e6, 0)} MB`;

export const percent = (share) => (Number.isFinite(share) ? `${number(100 * share, 0)} %` : MISSING);

const valueText = (value) =>
  Array.isArray(value) ? value.map(valueText).join("; ") : typeof value === "number" ? String(+value.toPrecision(6)) : String(value);

const SENTENCES = {
  config_applied: (f) => [`${f.file} was applied.`, ...list(f.changes)],
  config_rejected: (f) => ["Rejected; the old config stays.", ...list(f.reasons)],
  history_filtered: (f) => [`The last ${duration(f.seconds)} were filtered again; yaw changed by ${angle(f.step_deg)}.`],
  gap: (f) => [`${counted(f.missing, "sample")} lost; the longest gap was ${number(1000 * f.longest_s, 0)} ms.`],
  link_open: (f) => [`${f.port} was opened.`],
  link_lost: (f) => [`${f.port} is gone.`],
  link_refused: (f) => [`${f.port} cannot be opened: ${f.reason}`],
  link_restored: (f) => [`${f.port} is back after ${duration(f.gone_s)}.`],
  link_silent: (f) => [`No sample for ${duration(f.seconds)}.`],
  link_speaks: () => ["Samples arrive again."],
  device_reset: () => ["The device restarted."],
  yaw_zeroed: () => ["Yaw was set to 0."],
  recording_started: (f) => [`Recording to ${f.file}.`],
  recording_stopped: (f) => [`Recording ended: ${f.files.join(", ") || "no file"}.`],
  calibration_applied: () => ["A calibration was applied."],
  heading_set: (f) => [`The heading was set to ${angle(f.heading_deg)}.`],
  protocol_found: (f) => [`The protocol is ${f.protocol}${f.baud ? ` at ${f.baud} baud` : ""}.`],
  samples_rejected: (f) => [`Invalid samples: ${entries(f)}`],
  page_too_slow: (f) => [`This page was too slow for ${counted(f.messages, "message")}.`],
  samples_dropped: (f) => [`The outputs were too slow for ${counted(f.count, "sample")}.`],
};

const list = (value) => (Array.isArray(value) ? value : value ? [value] : []).map(valueText);
const entries = (fields) =>
  Object.entries(fields).filter(([, value]) => value !== null && value !== "").map(([name, value]) => `${name} ${valueText(value)}`).join(", ");

// Sentences about an event of the log.
export const event = (name, fields) =>
  name in SENTENCES ? SENTENCES[name](fields) : [`${name.replaceAll("_", " ")}: ${entries(fields)}`];
