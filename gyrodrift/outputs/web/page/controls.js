// Buttons of the page: zero, heading, recording and a guided calibration. They work in a browser on the machine of the
// service, when its user opened the page with the token that `gyrodrift ctl PATH page` prints.

const POLL_MS = 500; // state of a calibration
const KEY = "gyrodrift-token";

const byId = (id) => document.getElementById(id);

// The token stands behind the # of the address, which no request carries. It leaves the address bar at once, also when
// the address is opened in a tab that has the page already: the browser then loads nothing.
function takeToken() {
  const token = new URLSearchParams(location.hash.slice(1)).get("token");
  if (token) {
    sessionStorage.setItem(KEY, token);
    history.replaceState(null, "", location.pathname + location.search);
  }
  return sessionStorage.getItem(KEY);
}

export class Controls {
  // send(object) gives a message to the service.
  constructor(send) {
    this.send = send;
    this.token = takeToken();
    this.hasButtons = false;
    window.addEventListener("hashchange", () => {
      this.token = takeToken();
      this.greet(this.hasButtons);
    });
    this.isRecording = false;
    this.polling = null;
    byId("zero").addEventListener("click", () => this.command("zero"));
    byId("record").addEventListener("click", () => this.command(this.isRecording ? "record stop" : "record start"));
    byId("heading-form").addEventListener("submit", (event) => {
      event.preventDefault();
      const degrees = Number(byId("heading").value);
      if (Number.isFinite(degrees)) this.command(`heading ${degrees.toFixed(2)}`);
    });
    this.hasAxes = false;
    this.isIdle = true;
    byId("calibrate").addEventListener("click", () => this.command("calibrate start"));
    byId("calibrate-axes").addEventListener("click", () => this.command("calibrate axis-turns"));
    for (const word of ["mark", "undo", "finish", "cancel"]) {
      byId(`calibrate-${word}`).addEventListener("click", () => this.command(`calibrate ${word}`));
    }
  }

  // A page was greeted by the service: hasButtons where it lets this browser control it.
  greet(hasButtons) {
    this.hasButtons = hasButtons;
    const isOn = hasButtons && Boolean(this.token);
    byId("controls").hidden = !isOn;
    byId("read-only").hidden = isOn;
    byId("read-only").textContent = hasButtons
      ? "Read only. For buttons open the address that gyrodrift ctl PATH page prints."
      : "Read only. Buttons need serve --control PATH and a browser on that machine.";
    if (isOn) this.command("calibrate state");
  }

  // The service closed the stream for a wrong token.
  forget() {
    this.token = null;
    sessionStorage.removeItem(KEY);
    this.stopPolling();
  }

  showState(status) {
    this.isRecording = status.recording !== null;
    byId("record").textContent = this.isRecording ? "Stop recording" : "Record";
    byId("record").classList.toggle("on", this.isRecording);
    byId("recording").textContent = this.isRecording ? `Recording ${status.recording}` : "";
  }

  // A device with three axes has a calibration of its own.
  showAxes(hasAxes) {
    this.hasAxes = hasAxes;
    byId("calibrate-axes").hidden = !(hasAxes && this.isIdle);
  }

  command(words) {
    byId("control-error").textContent = "";
    this.send({ token: this.token, command: words });
  }

  answer({ command, answer }) {
    if (!answer.ok) byId("control-error").textContent = `${command}: ${answer.error}`;
    if (!answer.ok || !command.startsWith("calibrate")) return;
    const { step, line, says } = answer;
    const isIdle = step === "idle";
    const isPolled = command === "calibrate state";
    this.isIdle = isIdle;
    byId("calibrate").hidden = !isIdle;
    this.showAxes(this.hasAxes);
    byId("guide").hidden = isIdle && !says.length;
    byId("guide-buttons").hidden = isIdle;
    byId("guide-line").textContent = line;
    byId("calibrate-mark").textContent = step === "ready" ? "Begin" : "At the mark";
    byId("calibrate-mark").disabled = step === "rest" || step === "warming";
    const items = says.map((sentence) => Object.assign(document.createElement("li"), { textContent: plain(sentence) }));
    byId("guide-says").replaceChildren(...items);
    if (isIdle) this.stopPolling();
    else if (isPolled || !this.polling) this.pollSoon();
  }

  pollSoon() {
    clearTimeout(this.polling);
    this.polling = setTimeout(() => this.send({ token: this.token, command: "calibrate state" }), POLL_MS);
  }

  stopPolling() {
    clearTimeout(this.polling);
    this.polling = null;
  }
}

// The guide speaks of the keys of a terminal; the page has buttons.
const WORDS = [
  [/Press Enter to (start|repeat)/, "Press Begin to $1"],
  [/then press Enter/, "then press At the mark"],
  [/Press Enter when/, "Press At the mark when"],
  [/\bu removes\b/, "Undo removes"],
  [/\bq ends\b/, "Finish ends"],
];

export const plain = (sentence) => WORDS.reduce((text, [word, button]) => text.replace(word, button), sentence.trim());
