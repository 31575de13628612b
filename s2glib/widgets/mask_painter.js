// The mask painter's rows: fields to paint with mouse, finger or keys, and a button that asks for a new motion.
//
// A board holds the painting of one widget, and each of its views shows it.

const WAYS = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [-1, 0], ArrowDown: [1, 0], Home: [0, -Infinity], End: [0, Infinity] };
const HELP = "Drag over the fields to paint. With keys: arrows go from field to field and paint on with Shift; Space changes a field.";
const clamp = (value, most) => Math.min(Math.max(value, 0), most);
const ones = (row, test) => [...row].map((_, k) => +test(k / row.length)).join("");
const PRESETS = {
  "in-between": (row) => ones(row, (t) => t < 0.3 || t >= 0.7),
  continue: (row) => ones(row, (t) => t < 0.3),
  "hands stay": (row, name) => ones(row, () => name.endsWith("hand")),
  "body stays": (row, name) => ones(row, () => name === "body"),
  everything: (row) => ones(row, () => true),
  nothing: (row) => ones(row, () => false),
};

class Board {
  constructor(model) {
    Object.assign(this, { model, views: new Set() });
    const [order, heard] = [model.get("order"), model.get("heard")];
    this.pressed = heard.pressed;
    this.obey = () => this.show(model.get("order"));
    this.refresh = () => this.views.forEach((view) => view.draw());
    model.on("change:order", this.obey);
    model.on("change:done", this.refresh);
    this.show(heard.number === order.number ? heard : order);
  }
  get busy() {
    return this.pressed > this.model.get("done");
  }
  show({ kept, number }) {
    Object.assign(this, { kept, number });
    this.refresh();
  }
  tell() {
    const { kept, number, pressed } = this;
    this.model.set("heard", { kept, number, pressed });
    this.model.save_changes();
  }
  paint(kept) {
    this.show({ kept, number: this.number });
    this.tell();
  }
  /** Give all fields between two of them, rows and columns alike, one value. */
  fill([row, column], [row2, column2], value) {
    const within = (k, a, b) => k >= Math.min(a, b) && k <= Math.max(a, b);
    this.paint(this.kept.map((line, r) => (within(r, row, row2) ? [...line].map((old, c) => (within(c, column, column2) ? value : old)).join("") : line)));
  }
  /** Ask Python for a new motion, unless it is still at the last one. */
  press() {
    if (this.busy) return;
    this.pressed += 1;
    this.tell();
    this.refresh();
  }
  close() {
    this.model.off("change:order", this.obey);
    this.model.off("change:done", this.refresh);
  }
}

const line = (name, count) => `<div role="row"><button type="button" class="paint-name" aria-label="${name}: all or nothing">${name}</button>${'<span role="gridcell" tabindex="-1"></span>'.repeat(count)}</div>`;
const tick = (second, seconds) => `<i style="left: ${(100 * second) / seconds}%">${second} s</i>`;
const sheet = (names, count, seconds) => `
  <p class="paint-title"><b>Mask painter</b> What shall stay of the original?</p>
  <div class="paint-grid" role="grid" aria-label="Parts of the body over time. ${HELP}" style="--count: ${count}">
    ${names.map((name) => line(name, count)).join("")}
  </div>
  <div class="paint-times" aria-hidden="true">${Array.from({ length: Math.ceil(seconds) }, (_, second) => tick(second, seconds)).join("")}</div>
  <div class="paint-bar"><button type="button" class="paint-make">Make the rest anew</button>
    ${Object.keys(PRESETS).map((name) => `<button type="button" class="paint-preset">${name}</button>`).join("")}</div>
  <p class="paint-help"><i class="paint-kept"></i>stays <i></i>is made anew. ${HELP}</p>
  <p class="paint-status" role="status"></p>`;

class TimelineView {
  constructor(model, board, host) {
    Object.assign(this, { model, board, at: [0, 0] });
    this.names = model.get("names");
    this.count = board.kept[0].length;
    this.field = model.get("field") / model.get("fps"); // seconds
    this.build(host);
    this.listen();
    this.mark = () => this.showMoment();
    model.on("change:moment", this.mark);
    board.views.add(this);
    this.draw();
    this.mark();
  }

  build(host) {
    this.root = document.createElement("div");
    this.root.innerHTML = sheet(this.names, this.count, this.count * this.field);
    const attributes = { class: "s2g-painter", role: "group", "aria-label": "Mask painter", "data-lm-suppress-shortcuts": "true" };
    for (const [name, value] of Object.entries(attributes)) this.root.setAttribute(name, value);
    const all = (where, root = this.root) => [...root.querySelectorAll(where)];
    [this.grid, this.make, this.status] = [".paint-grid", ".paint-make", ".paint-status"].map((where) => this.root.querySelector(where));
    this.cells = all("[role=row]").map((row) => all("[role=gridcell]", row));
    this.titles = all(".paint-name");
    this.presets = all(".paint-preset");
    host.append(this.root);
  }

  listen() {
    const { board, grid } = this;
    this.make.onclick = () => board.press();
    this.presets.forEach((button) => {
      button.onclick = () => board.paint(board.kept.map((row, k) => PRESETS[button.textContent](row, this.names[k])));
    });
    this.titles.forEach((button, row) => {
      const change = () => (board.kept[row].includes("0") ? "1" : "0");
      button.onclick = () => board.fill([row, 0], [row, Infinity], change());
    });
    grid.onpointerdown = (event) => this.begin(event);
    grid.onpointermove = (event) => this.drag(event);
    grid.onpointerup = grid.onpointercancel = () => (this.brush = null);
    grid.onkeydown = (event) => this.key(event);
  }

  /** The field under a pointer, or the nearest one. */
  under({ clientX, clientY }) {
    const [first, last] = [this.cells[0][0], this.cells.at(-1).at(-1)].map((cell) => cell.getBoundingClientRect());
    const place = (value, low, high, count) => clamp(Math.floor(((value - low) / (high - low)) * count), count - 1);
    return [place(clientY, first.top, last.bottom, this.cells.length), place(clientX, first.left, last.right, this.cells[0].length)];
  }
  begin(event) {
    if (event.button || event.target.getAttribute("role") !== "gridcell") return;
    event.preventDefault();
    this.grid.setPointerCapture(event.pointerId);
    const place = this.under(event);
    this.brush = this.other(place);
    this.board.fill(place, place, this.brush);
    this.go(place);
  }
  drag(event) {
    if (!this.brush) return;
    const place = this.under(event);
    if (`${place}` === `${this.at}`) return;
    this.board.fill(this.at, place, this.brush);
    this.go(place);
  }
  other([row, column]) {
    return this.board.kept[row][column] === "1" ? "0" : "1";
  }

  key(event) {
    if (event.target.getAttribute("role") !== "gridcell" || event.ctrlKey || event.metaKey || event.altKey) return;
    const [row, column] = this.at;
    if (event.key === " " || event.key === "Enter") this.board.fill(this.at, this.at, this.other(this.at));
    else if (event.key in WAYS) {
      const [down, right] = WAYS[event.key];
      const place = [clamp(row + down, this.cells.length - 1), clamp(column + right, this.cells[0].length - 1)];
      if (event.shiftKey) this.board.fill(this.at, place, this.board.kept[row][column]);
      this.go(place);
    } else return;
    event.preventDefault();
    event.stopPropagation(); // the keys are not the notebook's
  }
  go(place) {
    this.at = place;
    this.draw();
    this.cells[place[0]][place[1]].focus({ preventScroll: true });
  }

  draw() {
    const { board, cells, names, field } = this;
    cells.forEach((row, r) => row.forEach((cell, c) => {
      const kept = board.kept[r][c] === "1";
      cell.setAttribute("aria-selected", kept);
      cell.setAttribute("aria-label", `${names[r]}, ${(c * field).toFixed(1)} s, ${kept ? "stays" : "is made anew"}`);
      cell.tabIndex = r === this.at[0] && c === this.at[1] ? 0 : -1;
    }));
    const all = board.kept.join("");
    const share = Math.round((100 * [...all].filter((value) => value === "1").length) / all.length);
    this.make.setAttribute("aria-disabled", board.busy);
    this.status.textContent = board.busy ? "Making ..." : `${share} % of the fields stay.`;
    Object.assign(this.root.dataset, { kept: board.kept.join(" "), busy: board.busy });
  }
  showMoment() {
    const { frame } = this.model.get("moment");
    this.root.style.setProperty("--moment", frame[1] / this.model.get("field") / this.count);
  }
  close() {
    this.model.off("change:moment", this.mark);
    this.board.views.delete(this);
    this.root.remove();
  }
}

export default entry((model) => new Board(model), (...place) => new TimelineView(...place));
