// The pad: control points to drag over a picture that follows, in the page and without Python.
//
// A board holds the points of one widget, and each of its views shows them. The spline leads from
// where the points are now (driving) to where they were in the picture (source): backward.

const STEP = 0.02; // that an arrow key moves a point by; five times as much with Shift
const WAYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
const HELP = "Drag the points. Or press Tab to go to a point and move it with the arrow keys, faster with Shift; Home takes it back to its start.";
const STUCK = "No plate passes through these points: two coincide, or all lie on one line. Move one.";

class Board {
  constructor(model) {
    Object.assign(this, { model, source: model.get("source"), views: new Set() });
    this.obey = () => {
      const { number, driving } = model.get("order");
      this.show(driving, number);
    };
    this.fit = () => this.show(this.driving, this.number);
    model.on("change:order", this.obey);
    model.on("change:ridge", this.fit);
    const { number, driving } = model.get("heard");
    if (number === model.get("order").number && driving.length) this.show(driving, number);
    else this.obey();
  }
  show(driving, number) {
    Object.assign(this, { driving, number });
    this.spline = fitTps(driving, this.source, this.model.get("ridge"));
    for (const view of this.views) view.stale = true;
  }
  move(index, place) {
    const inside = place.map((value) => Math.round(1e4 * Math.min(Math.max(value, -1), 1)) / 1e4);
    this.moveAll(this.driving.map((point, k) => (k === index ? inside : point)));
  }
  moveAll(driving) {
    this.show(driving, this.number);
    this.model.set("heard", { number: this.number, driving });
    this.model.save_changes();
  }
  close() {
    this.model.off("change:order", this.obey);
    this.model.off("change:ridge", this.fit);
  }
}

/** A new element with attributes, and children inside it. */
function element(tag, attributes, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  node.append(...children);
  return node;
}
const percent = (value) => `${50 + 50 * value}%`;
const spoken = ([x, y]) => `x ${x.toFixed(2)}, y ${y.toFixed(2)}`.replaceAll("-", "−");

class PadView {
  constructor(model, board, host) {
    Object.assign(this, { model, board, stale: true });
    this.build();
    host.append(this.root);
    this.resizing = new ResizeObserver(() => this.resize());
    this.resizing.observe(this.canvas);
    this.canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    this.canvas.addEventListener("webglcontextrestored", () => this.open());
    board.views.add(this);
    this.open();
    this.loop();
  }

  build() {
    const { source } = this.board;
    this.canvas = element("canvas", { role: "img", "aria-label": "A picture that bends with its control points" });
    this.starts = source.map(() => element("i", { "aria-hidden": "true" }));
    this.handles = source.map((_, index) => this.buildHandle(index));
    this.message = element("p", { class: "s2g-message", role: "alert" });
    this.field = element("div", { class: "s2g-field" }, this.canvas, ...this.starts, ...this.handles, this.message);
    this.energy = element("span", { class: "s2g-energy" });
    this.status = element("span", { class: "s2g-spoken", role: "status" });
    const reset = element("button", { type: "button" }, "Start again");
    reset.onclick = () => this.board.moveAll(source);
    const bar = element("div", { class: "s2g-bar" }, reset, this.energy, this.status);
    this.root = element("div", { class: "s2g-pad", role: "group", "aria-label": `Control points on a picture. ${HELP}`, title: HELP, "data-lm-suppress-shortcuts": "true" }, this.field, bar);
    this.root.style.setProperty("--width", `${this.model.get("width")}px`);
    this.root.readSpline = (points) => points.map((point) => applyTps(this.board.spline, point));
  }
  buildHandle(index) {
    const handle = element("button", { type: "button", class: "s2g-handle" }, `${index + 1}`);
    handle.onpointerdown = (event) => {
      if (event.button) return;
      handle.focus();
      handle.setPointerCapture(event.pointerId);
      event.preventDefault();
    };
    handle.onpointermove = (event) => {
      if (!handle.hasPointerCapture(event.pointerId)) return;
      const { left, top, width, height } = this.canvas.getBoundingClientRect();
      this.board.move(index, [(2 * (event.clientX - left)) / width - 1, (2 * (event.clientY - top)) / height - 1]);
    };
    handle.onpointerup = () => this.say(index);
    handle.onkeydown = (event) => this.key(event, index);
    return handle;
  }

  key(event, index) {
    const { board } = this;
    if ((!(event.key in WAYS) && event.key !== "Home") || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    event.stopPropagation();
    const step = event.shiftKey ? 5 * STEP : STEP;
    const there = event.key === "Home" ? board.source[index] : board.driving[index].map((value, k) => value + step * WAYS[event.key][k]);
    board.move(index, there);
    this.say(index);
  }
  say(index) {
    this.status.textContent = `Point ${index + 1}: ${spoken(this.board.driving[index])}`;
  }

  async open() {
    try {
      const picture = await createImageBitmap(new Blob([this.model.get("picture")], { type: "image/png" }));
      this.field.style.aspectRatio = `${picture.width} / ${picture.height}`;
      this.sheet = new Sheet(this.canvas, picture);
      this.stale = true;
    } catch (error) {
      this.fault = error.message;
      this.message.textContent = this.fault;
    }
  }
  resize() {
    const sharp = Math.min(2, window.devicePixelRatio || 1);
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight].map((size) => Math.max(1, Math.round(sharp * size)));
    Object.assign(this.canvas, { width, height });
    this.stale = true;
  }
  loop() {
    this.request = requestAnimationFrame(() => this.loop());
    if (!this.stale) return;
    this.stale = false;
    this.draw();
  }
  draw() {
    const { source, driving, spline } = this.board;
    const put = (node, [x, y]) => Object.assign(node.style, { left: percent(x), top: percent(y) });
    this.starts.forEach((start, k) => put(start, source[k]));
    this.handles.forEach((handle, k) => {
      put(handle, driving[k]);
      handle.setAttribute("aria-label", `Point ${k + 1}, ${spoken(driving[k])}`);
    });
    this.message.textContent = this.fault ?? (spline ? "" : STUCK);
    if (!spline) return; // the last picture stays
    this.sheet?.draw((point) => applyTps(spline, point));
    const energy = bendingEnergy(spline);
    this.energy.textContent = `Bending energy ${energy.toFixed(1)}`;
    const { dataset } = this.root;
    Object.assign(dataset, { energy, draws: 1 + +(dataset.draws ?? 0), drawn: !!this.sheet });
  }

  close() {
    cancelAnimationFrame(this.request);
    this.resizing.disconnect();
    this.board.views.delete(this);
    this.sheet?.close();
    this.root.remove();
  }
}

export default entry((model) => new Board(model), (...place) => new PadView(...place));
