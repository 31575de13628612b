// The player: one clock for all views of a widget, and a view with its controls.
//
// The sound is the clock; without sound the wall clock is. Every view only reads the time and
// draws, so that a widget shown twice still sounds once.

const TELL_EVERY = 150; // milliseconds between frames that Python hears of
const REDRAWS = ["change:motion", "change:view"];
const SPEEDS = [1, 0.5, 0.25];
const BLOCKED = "The browser waits for a click before it makes a sound: press Play once.";

class Clock {
  constructor(model) {
    Object.assign(this, { model, audio: new Audio(), playing: false, held: 0, since: 0, speed: 1 });
    const heard = model.get("heard");
    Object.assign(this, { views: 0, message: "", toldAt: 0 });
    this.obeyed = { frame: heard.frame[0], playing: heard.playing[0] };
    this.watched = {
      "change:sound": () => this.loadSound(),
      "change:motion": () => this.loadMotion(),
      "change:order": () => this.obey(),
    };
    for (const [event, act] of Object.entries(this.watched)) model.on(event, act);
    this.audio.addEventListener("ended", () => this.pause());
    this.loadMotion();
    this.loadSound();
    this.seek((heard.frame[1] + 0.01) / this.motion.fps);
    this.obey();
  }

  loadMotion() {
    this.motion = unpack(this.model.get("motion"));
  }
  loadSound() {
    const wav = this.model.get("sound");
    this.audio.pause();
    URL.revokeObjectURL(this.url);
    this.url = wav.byteLength ? URL.createObjectURL(new Blob([wav], { type: "audio/wav" })) : null;
    if (this.url) this.audio.src = this.url;
    else this.audio.removeAttribute("src");
    this.held = 0;
    this.since = performance.now();
    if (this.playing) this.play();
  }

  get frames() {
    return this.motion.turns.shape[1];
  }
  get duration() {
    return (this.url && this.audio.duration) || this.frames / this.motion.fps;
  }
  get time() {
    const wall = this.held + (this.playing ? ((performance.now() - this.since) / 1000) * this.speed : 0);
    return Math.min(this.url ? this.audio.currentTime : wall, this.duration);
  }
  get frame() {
    return Math.min(Math.floor(this.time * this.motion.fps + 1e-3), this.frames - 1);
  }

  async play() {
    if (this.time > this.duration - 0.02) this.seek(0);
    this.since = performance.now();
    this.playing = true;
    this.message = "";
    this.tell();
    if (!this.url) return;
    this.audio.playbackRate = this.speed;
    try {
      await this.audio.play();
    } catch (error) {
      if (error.name === "AbortError") return; // a pause or another sound came first
      this.pause();
      this.message = error.name === "NotAllowedError" ? BLOCKED : `The sound does not play: ${error.message}`;
    }
  }
  pause() {
    this.held = this.time;
    this.playing = false;
    this.audio.pause();
    this.tell();
  }
  toggle() {
    this.playing ? this.pause() : this.play();
  }
  seek(time) {
    this.held = Math.min(Math.max(time, 0), this.duration);
    this.since = performance.now();
    if (this.url) this.audio.currentTime = this.held;
    if (!this.playing) this.tell();
  }
  setSpeed(speed) {
    this.seek(this.time);
    this.speed = this.audio.playbackRate = speed;
  }

  /** Carry out Python's orders: those with another number than the last one carried out. */
  obey() {
    const { frame, playing } = this.model.get("order");
    const [move, turn] = [frame[0] !== this.obeyed.frame, playing[0] !== this.obeyed.playing];
    this.obeyed = { frame: frame[0], playing: playing[0] };
    if (move) this.seek((frame[1] + 0.01) / this.motion.fps);
    if (turn) playing[1] ? this.play() : this.pause();
  }
  tell() {
    this.toldAt = performance.now();
    const { frame, playing, obeyed } = this;
    this.model.set("heard", { frame: [obeyed.frame, frame], playing: [obeyed.playing, playing] });
    this.model.save_changes();
  }
  /** Called by each view before it draws: ends a silent clip and keeps Python roughly in step. */
  tick() {
    if (!this.playing) return;
    if (!this.url && this.time >= this.duration) this.pause();
    else if (performance.now() - this.toldAt > TELL_EVERY) this.tell();
  }
  close() {
    for (const [event, act] of Object.entries(this.watched)) this.model.off(event, act);
    this.audio.pause();
    URL.revokeObjectURL(this.url);
  }
}

/** A new element with attributes, and children inside it. */
function element(tag, attributes, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  node.append(...children);
  return node;
}

const KEYS = "Space plays and pauses, the arrow keys step, Home returns to the start, plus and minus zoom; drag to look around.";

class View {
  constructor(model, clock, host) {
    Object.assign(this, { model, clock, stale: true });
    this.camera = { turn: 0.22, rise: 0.06, zoom: 1, framing: "upper" };
    this.build();
    host.append(this.root);
    this.resizing = new ResizeObserver(() => this.resize());
    this.resizing.observe(this.canvas);
    this.redraw = () => (this.stale = true);
    for (const event of REDRAWS) model.on(event, this.redraw);
    this.listen();
    this.open();
    this.loop();
  }

  build() {
    this.canvas = element("canvas", { tabindex: 0, role: "application", "aria-label": `A body that gestures. ${KEYS}`, title: KEYS });
    this.button = element("button", { type: "button", class: "s2g-play" }, "Play");
    this.slider = element("input", { type: "range", min: 0, step: "any", "aria-label": "Time" });
    this.label = element("span", { class: "s2g-time" });
    this.speed = element("select", { "aria-label": "Speed" },
      ...SPEEDS.map((speed) => element("option", { value: speed }, `${speed} ×`)));
    this.frameButton = element("button", { type: "button" }, "Whole body");
    this.names = element("div", { class: "s2g-names", "aria-hidden": "true" });
    this.message = element("p", { class: "s2g-message", role: "status" });
    const screen = element("div", { class: "s2g-screen" }, this.canvas, this.names, this.message);
    const bar = element("div", { class: "s2g-bar" }, this.button, this.slider, this.label, this.speed, this.frameButton);
    this.root = element("div", { class: "s2g-player", role: "group", "aria-label": "Body and sound", "data-lm-suppress-shortcuts": "true" }, screen, bar);
    this.root.style.setProperty("--height", `${this.model.get("height")}px`);
  }

  listen() {
    const { clock, camera, canvas } = this;
    this.button.onclick = () => clock.toggle();
    this.slider.oninput = () => clock.seek(+this.slider.value);
    this.speed.onchange = () => clock.setSpeed(+this.speed.value);
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

  key(event) {
    const step = (frames) => () => this.clock.seek((this.clock.frame + frames + 0.01) / this.clock.motion.fps);
    const keys = {
      " ": () => this.clock.toggle(),
      ArrowRight: step(1),
      ArrowLeft: step(-1),
      Home: () => this.clock.seek(0),
      "+": () => this.zoom(0.9),
      "-": () => this.zoom(1.1),
    };
    if (!(event.key in keys) || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    event.stopPropagation();
    keys[event.key]();
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

  open() {
    try {
      this.stage = new Stage(this.canvas, unpack(this.model.get("mesh")));
      this.stale = true;
      this.root.readVertices = (time, body) => this.stage.readVertices(this.clock.motion, time, body);
    } catch (error) {
      this.failure = error.message;
    }
  }

  loop() {
    this.request = requestAnimationFrame(() => this.loop());
    this.clock.tick();
    const { time, playing, message } = this.clock;
    if (this.shownMessage !== (this.failure ?? message)) this.message.textContent = this.shownMessage = this.failure ?? message;
    if (this.shownPlaying !== playing) this.showPlaying(playing);
    if (!this.stale && time === this.shownTime) return;
    this.showTime(time);
    if (this.stage) this.draw(time);
    this.stale = false;
  }
  showPlaying(playing) {
    this.shownPlaying = playing;
    this.button.textContent = playing ? "Pause" : "Play";
    this.root.dataset.playing = playing;
  }
  showTime(time) {
    const { duration, frame } = this.clock;
    this.shownTime = time;
    this.slider.max = duration;
    this.slider.value = time;
    this.label.textContent = `${time.toFixed(1)} / ${duration.toFixed(1)} s`;
    this.slider.setAttribute("aria-valuetext", `${time.toFixed(1)} of ${duration.toFixed(1)} seconds`);
    Object.assign(this.root.dataset, { time: time.toFixed(3), frame });
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
    cancelAnimationFrame(this.request);
    this.resizing.disconnect();
    for (const event of REDRAWS) this.model.off(event, this.redraw);
    this.stage?.close();
    this.root.remove();
  }
}

const createPlayer = () => {
  let clock;
  return {
    initialize({ model }) {
      clock = new Clock(model);
      return () => clock.close();
    },
    render({ model, el }) {
      const view = new View(model, clock, el);
      clock.views += 1;
      return () => {
        view.close();
        clock.views -= 1;
        if (!clock.views) clock.pause();
      };
    },
  };
};

export default createPlayer;
