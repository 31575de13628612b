// Playback: one clock for all views of a widget, and what all views have: controls and keys.
//
// The sound is the clock; the wall clock is where there is none, or where it does not move. Every
// view only reads the time and draws, so that a widget shown twice still sounds once.

const TELL_EVERY = 150; // milliseconds between frames that Python hears of
const STUCK_AFTER = 1000; // milliseconds in which a sound that plays has to move
const SPEEDS = [1, 0.5, 0.25];
const BLOCKED = "The browser waits for a click before it makes a sound: press Play once.";
const STUCK = "The sound does not start; the pictures go on without it.";
const KEYS = "Space plays and pauses, the arrow keys step, Home returns to the start";

/** The time of one widget; its kind says how to `load` what is shown: `frames` of them, `fps` a second. */
class Clock {
  constructor(model, content) {
    Object.assign(this, { model, audio: new Audio(), playing: false, held: 0, since: 0, speed: 1 });
    const heard = model.get("heard");
    Object.assign(this, { views: 0, message: "", toldAt: 0, stuck: false, soundAt: 0, movedAt: 0 });
    this.obeyed = { frame: heard.frame[0], playing: heard.playing[0] };
    this.watched = {
      "change:sound": () => this.loadSound(),
      [`change:${content}`]: () => this.load(),
      "change:order": () => this.obey(),
    };
    for (const [event, act] of Object.entries(this.watched)) model.on(event, act);
    this.audio.addEventListener("ended", () => this.pause());
    this.load();
    this.loadSound();
    this.show(heard.frame[1]);
    this.obey();
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

  get duration() {
    return (this.url && this.audio.duration) || this.frames / this.fps;
  }
  get leads() {
    return this.url && !this.stuck;
  }
  get time() {
    const wall = this.held + (this.playing ? ((performance.now() - this.since) / 1000) * this.speed : 0);
    return Math.min(this.leads ? this.audio.currentTime : wall, this.duration);
  }
  get frame() {
    return Math.min(Math.floor(this.time * this.fps + 1e-3), this.frames - 1);
  }

  async play() {
    if (this.time > this.duration - 0.02) this.seek(0);
    this.since = this.movedAt = performance.now();
    this.playing = true;
    this.stuck = false;
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
    if (this.stuck) this.audio.currentTime = this.held;
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
  show(frame) {
    this.seek((frame + 0.01) / this.fps);
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
    if (move) this.show(frame[1]);
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
    if (this.leads) this.listen();
    if (!this.leads && this.time >= this.duration) this.pause();
    else if (performance.now() - this.toldAt > TELL_EVERY) this.tell();
  }
  /** Let the wall clock lead where the sound stands still, as on a machine without a sound card. */
  listen() {
    const [now, { currentTime }] = [performance.now(), this.audio];
    if (currentTime !== this.soundAt) Object.assign(this, { soundAt: currentTime, movedAt: now });
    else if (now - this.movedAt > STUCK_AFTER) {
      this.audio.pause();
      Object.assign(this, { stuck: true, held: currentTime, since: now, message: STUCK });
    }
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

/** A view of a clock: a screen that its kind fills and draws, and the controls below it. */
class ClockView {
  constructor(model, clock, host, name) {
    Object.assign(this, { model, clock, stale: true });
    this.message = element("p", { class: "s2g-message", role: "status" });
    this.screen = element("div", { class: "s2g-screen" }, this.message);
    this.bar = element("div", { class: "s2g-bar" }, ...this.buildControls());
    this.root = element("div", { class: "s2g-player", role: "group", "aria-label": name, "data-lm-suppress-shortcuts": "true" }, this.screen, this.bar);
    this.keys = {
      " ": () => clock.toggle(),
      ArrowRight: () => clock.show(clock.frame + 1),
      ArrowLeft: () => clock.show(clock.frame - 1),
      Home: () => clock.seek(0),
    };
    host.append(this.root);
    clock.views += 1;
  }

  buildControls() {
    const { clock } = this;
    this.button = element("button", { type: "button", class: "s2g-play" }, "Play");
    this.slider = element("input", { type: "range", min: 0, step: "any", "aria-label": "Time" });
    this.label = element("span", { class: "s2g-time" });
    const speed = element("select", { "aria-label": "Speed" },
      ...SPEEDS.map((speed) => element("option", { value: speed }, `${speed} ×`)));
    this.button.onclick = () => clock.toggle();
    this.slider.oninput = () => clock.seek(+this.slider.value);
    speed.onchange = () => clock.setSpeed(+speed.value);
    return [this.button, this.slider, this.label, speed];
  }

  key(event) {
    if (!(event.key in this.keys) || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    event.stopPropagation();
    this.keys[event.key]();
  }

  loop() {
    this.request = requestAnimationFrame(() => this.loop());
    this.clock.tick();
    const { time, playing, message } = this.clock;
    if (this.shownMessage !== (this.failure ?? message)) this.message.textContent = this.shownMessage = this.failure ?? message;
    if (this.shownPlaying !== playing) this.showPlaying(playing);
    if (!this.stale && time === this.shownTime) return;
    this.showTime(time);
    if (this.ready) this.draw(time);
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
  close() {
    cancelAnimationFrame(this.request);
    this.root.remove();
    this.clock.views -= 1;
    if (!this.clock.views) this.clock.pause();
  }
}
