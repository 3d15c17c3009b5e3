// History of one hour at several levels of detail, so that any range is drawn from few rows.
//
// A row has a time, values of the last sample (NAME), and minimum and maximum of all samples (NAME_lo, NAME_hi). Coarser
// levels merge rows by the same rule, so no spike is lost.

const FINEST_S = 1 / 30;
const FACTOR = 4;
const LEVELS = 7;
const KEPT_S = 3660;
const FIRST_ROWS = 4096;
const SAME_CLOCK_S = 1;

const least = (a, b) => (a <= b || Number.isNaN(b) ? a : b);
const greatest = (a, b) => (a >= b || Number.isNaN(b) ? a : b);
const newest = (a, b) => b;

const ruleOf = (name) => (name.endsWith("_lo") ? least : name.endsWith("_hi") ? greatest : newest);

// Rows in time order: one per interval of a width, or all rows if the width is 0.
class Level {
  constructor(rules, widthS) {
    this.rules = rules;
    this.widthS = widthS;
    this.stretch = NaN;
    this.count = 0;
    this.columns = rules.map((_, at) => new (at ? Float32Array : Float64Array)(FIRST_ROWS));
  }

  add(row) {
    const stretch = Math.floor(row[0] / this.widthS);
    if (stretch === this.stretch && this.widthS) this.merge(row);
    else this.append(row);
    this.stretch = stretch;
  }

  append(row) {
    if (this.count === this.columns[0].length) this.makeRoom(row[0] - KEPT_S);
    for (let at = 0; at < row.length; at++) this.columns[at][this.count] = row[at];
    this.count += 1;
  }

  merge(row) {
    const last = this.count - 1;
    for (let at = 0; at < row.length; at++) {
      const column = this.columns[at];
      column[last] = this.rules[at](column[last], row[at]);
    }
  }

  // Drop old rows; grow if they are less than an eighth.
  makeRoom(beforeS) {
    const old = this.atOrAfter(beforeS);
    const long = this.columns[0].length;
    this.columns = this.columns.map((column) => {
      const roomy = old < long / 8 ? new column.constructor(2 * long) : column;
      roomy.set(column.subarray(old, this.count));
      return roomy;
    });
    this.count -= old;
  }

  // Index of the first row at or after a time.
  atOrAfter(timeS) {
    const times = this.columns[0];
    let low = 0;
    let high = this.count;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (times[middle] < timeS) low = middle + 1;
      else high = middle;
    }
    return low;
  }
}

export class History {
  // columns: names of the values of a row; the first is the time, Unix, s.
  constructor(columns) {
    this.names = columns;
    this.index = Object.fromEntries(columns.map((name, at) => [name, at]));
    this.clear();
  }

  clear() {
    const rules = this.names.map(ruleOf);
    this.levels = Array.from({ length: LEVELS }, (_, depth) => new Level(rules, depth && FINEST_S * FACTOR ** depth));
    this.lastS = -Infinity;
  }

  // Read the rows of a message; known rows are skipped.
  read(buffer) {
    const view = new DataView(buffer);
    const width = 8 + 4 * (this.names.length - 1);
    const row = new Array(this.names.length);
    for (let offset = 0; offset + width <= buffer.byteLength; offset += width) {
      row[0] = view.getFloat64(offset, true);
      for (let at = 1; at < row.length; at++) row[at] = view.getFloat32(offset + 4 + 4 * at, true);
      this.add(row);
    }
  }

  add(row) {
    if (row[0] <= this.lastS) return;
    for (const level of this.levels) level.add(row);
    this.lastS = row[0];
  }

  // Clear the history if the clock of the service was set back: its rows would lie in the future.
  startsAt(nowS) {
    if (nowS < this.lastS - SAME_CLOCK_S) this.clear();
  }

  get rows() {
    return this.levels[0].count;
  }

  get firstS() {
    return this.rows ? Math.max(this.levels[0].columns[0][0], this.lastS - KEPT_S) : NaN;
  }

  // Whether the stream has a column.
  has(name) {
    return name in this.index;
  }

  // Newest value of a column; NaN without rows, or without the column.
  last(name) {
    return this.rows && this.has(name) ? this.levels[0].columns[this.index[name]][this.rows - 1] : NaN;
  }

  // Rows between two times, and one more on each side, of the finest level with at most `most` rows.
  view(fromS, toS, most) {
    let found = null;
    for (const level of this.levels) {
      const from = Math.max(0, level.atOrAfter(fromS) - 1);
      const to = Math.min(level.count, level.atOrAfter(toS) + 1);
      found = new View(level.columns, this.index, from, to);
      if (to - from <= most) break;
    }
    return found;
  }
}

const GAP_S = 1.5;
const GAP_TIMES = 3;

// A range of one level for uPlot: two points on the time axis per row, and an empty point in each gap.
class View {
  constructor(columns, index, from, to) {
    this.columns = columns;
    this.index = index;
    this.from = from;
    this.to = to;
    this.times = [];
    this.gaps = new Set();
    let stepS = Infinity;
    for (let row = from; row < to; row++) {
      const atS = columns[0][row];
      const passedS = row > from ? atS - columns[0][row - 1] : Infinity;
      const isGap = row > from && passedS > GAP_S && passedS > GAP_TIMES * stepS;
      if (isGap) {
        this.gaps.add(row);
        this.times.push(atS - passedS / 2);
      }
      this.times.push(isGap || row === from ? atS : atS - passedS / 2, atS);
      stepS = isGap ? Infinity : passedS;
    }
  }

  column(name) {
    return this.columns[this.index[name]];
  }

  // A line through minimum and maximum of each row, in the order with the shorter way.
  span(name) {
    const [low, high] = [this.column(`${name}_lo`), this.column(`${name}_hi`)];
    let before = NaN;
    return this.places((row) => {
      const rises = !(Math.abs(before - high[row]) < Math.abs(before - low[row]));
      const [first, second] = rises ? [low[row], high[row]] : [high[row], low[row]];
      before = second;
      return first === second ? [undefined, second] : [first, second];
    });
  }

  // A line through one computed value of each row.
  values(of) {
    return this.places((row) => [undefined, of(row)]);
  }

  places(of) {
    const found = [];
    for (let row = this.from; row < this.to; row++) {
      if (this.gaps.has(row)) found.push(null);
      for (const value of of(row)) found.push(Number.isNaN(value) ? null : value);
    }
    return found;
  }
}
