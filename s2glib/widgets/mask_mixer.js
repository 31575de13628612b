// The mask mixer: a slider and a solo button for every warp, and the picture that the mixture makes.
//
// A desk holds the mixture of one widget, and each of its views shows it.

const HELP = "Gain 0 is as the network chose, the left end is off; solo lets one warp count alone. With keys: Tab goes on, the arrow keys move a gain.";
const ALL_OFF = "All are off. Only differences count, so this is the same as all on.";
const TINT = [0.835, 0.369, 0]; // Okabe and Ito's vermilion
const nameOf = (k) => (k ? `warp ${k}` : "background");
const signed = (value) => (value > 0 ? "+" : "") + `${value}`.replace("-", "−");
const gainOf = (value) => (value > -LIMIT ? signed(value) : "off");

const greyOf = ([red, green, blue]) => fillMap(red.length, (p) => (red[p] + green[p] + blue[p]) / 3);

class Desk {
  constructor(model) {
    Object.assign(this, { model, mixing: new Mixing(model.get("scene")), views: new Set() });
    const { mixing } = this;
    this.alone = mixing.warps.map((flow) => greyOf(mixing.bend(flow))); // the source under each warp
    const bent = mixing.bend(mixing.combine(mixing.weigh(mixing.shares.map(() => 0))));
    const own = [bent, mixing.fill(bent)].map((picture) => mixing.error(picture));
    this.errors = { own, copying: mixing.error(mixing.source) };
    this.obey = () => this.show(model.get("order"));
    model.on("change:order", this.obey);
    const heard = model.get("heard");
    this.show(heard.number === model.get("order").number ? heard : model.get("order"));
  }
  show(mix) {
    const { mixing } = this;
    const added = mix.gains.map((gain, k) => (mix.alone === null ? (gain > -LIMIT ? gain : OFF) : k === mix.alone ? 0 : OFF));
    this.weights = mixing.weigh(added);
    const bent = mixing.bend(mixing.combine(this.weights));
    this.picture = mix.painted ? mixing.fill(bent) : bent;
    Object.assign(this, { mix, error: mixing.error(this.picture) });
    for (const view of this.views) view.stale = true;
  }
  /** Something was moved in the page: show it and let Python hear. */
  change(part) {
    this.show({ ...this.mix, ...part });
    this.model.set("heard", this.mix);
    this.model.save_changes();
  }
  setGain(index, gain) {
    this.change({ gains: this.mix.gains.map((value, k) => (k === index ? gain : value)) });
  }
  reset() {
    this.change({ gains: this.mix.gains.map(() => 0), alone: null });
  }
  close() {
    this.model.off("change:order", this.obey);
  }
}

const canvas = (size, label) => `<canvas width="${size}" height="${size}" role="img" aria-label="${label}"></canvas>`;
const figure = (size, label, caption) => `<figure>${canvas(size, label)}<figcaption>${caption}</figcaption></figure>`;
const bar = (name) => `<tr><th scope="row">${name}</th><td class="mix-bar"><i></i></td><td class="mix-number"></td></tr>`;
const strip = (size, k) => `<div class="mix-strip" role="group" aria-label="${nameOf(k)}">
  ${canvas(size, `The source, bent by ${nameOf(k)} alone; orange where it counts`)}
  <div>
    <p><b>${nameOf(k)}</b><span class="mix-share"></span></p>
    <input type="range" min="${-LIMIT}" max="${LIMIT}" step="0.5" aria-label="Gain of ${nameOf(k)}">
    <p><span class="mix-gain"></span><button type="button" aria-label="Solo: ${nameOf(k)} alone">solo</button></p>
  </div>
</div>`;
const sheet = ({ size, count }) => `
  <p class="mix-title"><b>Mask mixer</b> The flow mixes ${count - 1} warps and the background. Who moves what?</p>
  <div class="mix-pictures">
    ${figure(size, "The source picture", "source")}
    ${figure(size, "The driving picture, the truth", "driving picture: the truth")}
    ${figure(size, "The source as the mixture bends it", "")}
  </div>
  <div class="mix-desk">
    <table><caption>Mean absolute error against the truth</caption>${["this mixture", "the network's", "copying the source"].map(bar).join("")}</table>
    <div>
      <label><input type="checkbox"> Occlusion mask: hide what the source cannot show; the network paints it</label>
      <button type="button" class="mix-reset">Start again</button><span class="mix-note" role="status"></span>
    </div>
  </div>
  <div class="mix-strips">${Array.from({ length: count }, (_, k) => strip(size, k)).join("")}</div>
  <p class="mix-help"><i></i>The source bent by each warp alone; orange where it counts; its share of the picture in percent.</p>
  <p class="mix-help">${HELP}</p>`;

class MixerView {
  constructor(model, desk, host) {
    Object.assign(this, { model, desk, stale: true });
    this.build();
    this.listen();
    host.append(this.root);
    desk.views.add(this);
    this.loop();
  }

  build() {
    const { mixing } = this.desk;
    this.root = document.createElement("div");
    this.root.innerHTML = sheet(mixing);
    const attributes = { class: "s2g-mixer", role: "group", "aria-label": `Mask mixer. ${HELP}`, "data-lm-suppress-shortcuts": "true" };
    for (const [name, value] of Object.entries(attributes)) this.root.setAttribute(name, value);
    this.root.style.setProperty("--width", `${this.model.get("width")}px`);
    const all = (where) => [...this.root.querySelectorAll(where)];
    [this.source, this.truth, this.mixture] = all(".mix-pictures canvas");
    [this.caption] = all("figcaption").slice(-1);
    this.bars = all("tr");
    [this.painted, this.reset, this.note] = ["[type=checkbox]", ".mix-reset", ".mix-note"].map((where) => all(where)[0]);
    this.strips = all(".mix-strip").map((root) => {
      const [thumb, share, slider, gain, solo] = ["canvas", ".mix-share", "input", ".mix-gain", "button"].map((where) => root.querySelector(where));
      return { root, thumb, share, slider, gain, solo };
    });
    this.put(this.source, mixing.source);
    this.put(this.truth, mixing.driving);
    this.root.readPicture = () => this.desk.picture.map((color) => [...color]);
  }
  listen() {
    const { desk } = this;
    this.painted.onchange = () => desk.change({ painted: this.painted.checked });
    this.reset.onclick = () => desk.reset();
    this.strips.forEach(({ slider, solo }, k) => {
      slider.oninput = () => desk.setGain(k, +slider.value);
      slider.onchange = () => this.say(`${nameOf(k)}: ${gainOf(+slider.value)}; error ${desk.error.toFixed(4)}`);
      solo.onclick = () => desk.change({ alone: desk.mix.alone === k ? null : k });
    });
    this.root.onkeydown = (event) => event.stopPropagation(); // the arrow keys are not the notebook's
  }
  say(words) {
    const { gains, alone } = this.desk.mix;
    this.note.textContent = alone === null && gains.every((gain) => gain <= -LIMIT) ? ALL_OFF : words;
  }

  /** Show three planes of colours on a canvas. */
  put(canvas, colors) {
    const image = new ImageData(canvas.width, canvas.height);
    image.data.fill(255);
    colors.forEach((color, c) => {
      for (let p = 0; p < color.length; p++) image.data[4 * p + c] = 255 * color[p];
    });
    canvas.getContext("2d").putImageData(image, 0, 0);
  }
  loop() {
    this.request = requestAnimationFrame(() => this.loop());
    if (!this.stale) return;
    this.stale = false;
    this.draw();
  }
  draw() {
    const { picture, error, errors, mix } = this.desk;
    this.put(this.mixture, picture);
    this.strips.forEach((_, k) => this.drawStrip(k));
    const untouched = mix.alone === null && mix.gains.every((gain) => gain === mix.gains[0]);
    this.caption.textContent = untouched ? "the network's mixture" : mix.alone === null ? "your mixture" : `${nameOf(mix.alone)} alone`;
    this.painted.checked = mix.painted;
    const own = errors.own[+mix.painted];
    const shown = [error, own, errors.copying];
    this.bars.forEach((row, k) => {
      row.querySelector("i").style.width = `${(100 * shown[k]) / Math.max(...shown)}%`;
      row.querySelector(".mix-number").textContent = shown[k].toFixed(4);
    });
    this.bars[0].classList.toggle("mix-better", error < own - 5e-5);
    const { dataset } = this.root;
    Object.assign(dataset, { error, draws: 1 + +(dataset.draws ?? 0) });
  }
  drawStrip(k) {
    const { mixing, alone, weights, mix } = this.desk;
    const { root, thumb, share, slider, gain, solo } = this.strips[k];
    const tint = enlarge(weights[k], mixing.coarse, mixing.size);
    this.put(thumb, TINT.map((color) => fillMap(tint.length, (p) => alone[k][p] + 0.75 * tint[p] * (color - alone[k][p]))));
    share.textContent = `${Math.round((100 * weights[k].reduce((a, b) => a + b, 0)) / weights[k].length)} %`;
    slider.value = mix.gains[k];
    slider.setAttribute("aria-valuetext", gainOf(mix.gains[k]));
    gain.textContent = `gain ${gainOf(mix.gains[k])}`;
    solo.setAttribute("aria-pressed", mix.alone === k);
    root.classList.toggle("mix-silent", mix.alone === null ? mix.gains[k] <= -LIMIT : mix.alone !== k);
  }

  close() {
    cancelAnimationFrame(this.request);
    this.desk.views.delete(this);
    this.root.remove();
  }
}

export default entry((model) => new Desk(model), (...place) => new MixerView(...place));
