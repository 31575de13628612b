// The player: a view of bodies that move to a clock, to be looked at from all sides.

const REDRAWS = ["change:motion", "change:view"];
const BODY_KEYS = `A body that gestures. ${KEYS}, plus and minus zoom; drag to look around.`;

class BodyClock extends Clock {
  load() {
    this.motion = unpack(this.model.get("motion"));
    this.fps = this.motion.fps;
    this.frames = this.motion.turns.shape[1];
  }
}

class BodyView extends ClockView {
  constructor(model, clock, host) {
    super(model, clock, host, "Body and sound");
    this.camera = { turn: 0.22, rise: 0.06, zoom: 1, framing: "upper" };
    Object.assign(this.keys, { "+": () => this.zoom(0.9), "-": () => this.zoom(1.1) });
    this.build();
    this.resizing = new ResizeObserver(() => this.resize());
    this.resizing.observe(this.canvas);
    this.redraw = () => (this.stale = true);
    for (const event of REDRAWS) model.on(event, this.redraw);
    this.listen();
    this.open();
    this.loop();
  }

  build() {
    this.canvas = element("canvas", { tabindex: 0, role: "application", "aria-label": BODY_KEYS, title: BODY_KEYS });
    this.names = element("div", { class: "s2g-names", "aria-hidden": "true" });
    this.frameButton = element("button", { type: "button" }, "Whole body");
    this.screen.prepend(this.canvas, this.names);
    this.bar.append(this.frameButton);
    this.root.style.setProperty("--height", `${this.model.get("height")}px`);
  }

  listen() {
    const { camera, canvas } = this;
    this.frameButton.onclick = () => {
      camera.framing = camera.framing === "upper" ? "whole" : "upper";
      camera.zoom = 1;
      this.frameButton.textContent = camera.framing === "upper" ? "Whole body" : "Upper body";
      this.stale = true;
    };
    canvas.onkeydown = (event) => this.key(event);
    canvas.onpointerdown = (event) => canvas.setPointerCapture(event.pointerId);
    canvas.onpointermove = (event) => {
      if (!canvas.hasPointerCapture(event.pointerId)) return;
      camera.turn -= 0.008 * event.movementX;
      camera.rise = Math.min(1.3, Math.max(-0.05, camera.rise + 0.008 * event.movementY));
      this.stale = true;
    };
    canvas.addEventListener("wheel", (event) => {
      if (document.activeElement !== canvas) return; // the page scrolls on over it
      event.preventDefault();
      this.zoom(Math.exp(0.001 * event.deltaY));
    }, { passive: false });
    canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    canvas.addEventListener("webglcontextrestored", () => this.open());
  }

  zoom(factor) {
    this.camera.zoom = Math.min(3, Math.max(0.25, this.camera.zoom * factor));
    this.stale = true;
  }
  resize() {
    const sharp = Math.min(2, window.devicePixelRatio || 1);
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight].map((x) => Math.max(1, Math.round(x * sharp)));
    if (width === this.canvas.width && height === this.canvas.height) return;
    Object.assign(this.canvas, { width, height });
    this.stale = true;
  }

  get ready() {
    return !!this.stage;
  }
  open() {
    try {
      this.stage = new Stage(this.canvas, unpack(this.model.get("mesh")));
      this.stale = true;
      this.root.readVertices = (time, body) => this.stage.readVertices(this.clock.motion, time, body);
    } catch (error) {
      this.failure = error.message;
    }
  }

  draw(time) {
    const { motion } = this.clock;
    const one = motion.names.indexOf(this.model.get("view"));
    const bodies = one < 0 ? [...motion.names.keys()] : [one];
    const right = this.stage.draw(motion, time, bodies, this.camera);
    this.root.dataset.draws = 1 + +(this.root.dataset.draws ?? 0);
    const labels = bodies.map((body, k) => {
      const label = element("span", {}, motion.names[body]);
      label.style.left = `${50 + 50 * right[k]}%`;
      return label;
    });
    this.names.replaceChildren(...labels.filter((label) => label.textContent));
  }

  close() {
    super.close();
    this.resizing.disconnect();
    for (const event of REDRAWS) this.model.off(event, this.redraw);
    this.stage?.close();
  }
}

const createPlayer = entry((model) => new BodyClock(model, "motion"), (...place) => new BodyView(...place));
