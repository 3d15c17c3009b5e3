// Stream of the service: one WebSocket at a time, reconnected for as long as the page is open.

const FIRST_WAIT_MS = 500;
const LONGEST_WAIT_MS = 5000;
const POLICY_VIOLATION = 1008; // RFC 6455, section 7.4.1
const SILENT_MS = 6000; // the service sends its state once a second

export class Connection {
  // on.message(content) with an object or an ArrayBuffer; on.change("open" | "lost") when that changes; on.refused() when
  // the service closed the stream for what this page sent.
  constructor(url, on) {
    this.url = url;
    this.on = on;
    this.waitMs = FIRST_WAIT_MS;
    this.open();
    window.addEventListener("online", () => this.hurry());
    document.addEventListener("visibilitychange", () => document.hidden || this.hurry());
  }

  open() {
    this.socket = new WebSocket(this.url);
    this.socket.binaryType = "arraybuffer";
    this.wait();
    this.socket.onopen = () => this.listen();
    this.socket.onmessage = (event) => {
      this.listen();
      this.waitMs = FIRST_WAIT_MS;
      this.on.message(typeof event.data === "string" ? JSON.parse(event.data) : event.data);
    };
    this.socket.onclose = (event) => {
      if (event.code === POLICY_VIOLATION) this.on.refused();
      this.lost();
    };
  }

  send(message) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  // Limit the wait: a lost network does not close the socket.
  wait() {
    clearTimeout(this.silence);
    this.silence = setTimeout(() => this.lost(), SILENT_MS);
  }

  listen() {
    this.wait();
    this.on.change("open");
  }

  lost() {
    clearTimeout(this.silence);
    this.socket.onopen = this.socket.onmessage = this.socket.onclose = null;
    this.socket.close();
    this.on.change("lost");
    this.retry = setTimeout(() => this.again(), this.waitMs);
    this.waitMs = Math.min(2 * this.waitMs, LONGEST_WAIT_MS);
  }

  again() {
    this.retry = null;
    this.open();
  }

  // The page is visible or the network is back: reconnect at once.
  hurry() {
    if (!this.retry) return;
    clearTimeout(this.retry);
    this.waitMs = FIRST_WAIT_MS;
    this.again();
  }
}
