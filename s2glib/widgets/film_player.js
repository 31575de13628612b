// The film player: films side by side, whose frames lie together on sheets, in step with a clock.

const FILM_KEYS = `Films that play in step. ${KEYS}; a click plays and pauses.`;

class FilmClock extends Clock {
  load() {
    Object.assign(this, this.model.get("film"));
    this.opened = this.open();
  }
  /** Decode the sheets, which stand in one row of bytes. */
  async open() {
    const { buffer, byteOffset } = this.model.get("sheets");
    let start = byteOffset;
    const pictures = this.lengths.map((length) => {
      const data = new Uint8Array(buffer, start, length);
      start += length;
      return createImageBitmap(new Blob([data], { type: this.kind }));
    });
    this.sheets = await Promise.all(pictures);
  }
  /** The sheet that a frame is on, and where its upper left corner is there. */
  find(frame) {
    const { columns, rows, size: [width, height] } = this;
    const place = frame % (columns * rows);
    const sheet = this.sheets[Math.floor(frame / (columns * rows))];
    return [sheet, width * (place % columns), height * Math.floor(place / columns)];
  }
  close() {
    super.close();
    for (const sheet of this.sheets ?? []) sheet.close();
  }
}

class FilmView extends ClockView {
  constructor(model, clock, host) {
    const title = model.get("title");
    super(model, clock, host, title || "Films and sound");
    this.build(title);
    this.resizing = new ResizeObserver(() => this.resize());
    this.resizing.observe(this.screen);
    const failed = (error) => (this.failure = `The pictures do not open: ${error.message}`);
    clock.opened.then(() => (this.stale = true), failed);
    this.loop();
  }

  build(title) {
    const { screen, clock } = this;
    this.pictures = clock.films.map(({ name, width, height }) => {
      const canvas = element("canvas", { role: "img", "aria-label": name || "Film" });
      canvas.style.aspectRatio = `${width} / ${height}`;
      return { canvas, small: new OffscreenCanvas(width, height) };
    });
    const figures = this.pictures.map(({ canvas }, k) => {
      const { name } = clock.films[k];
      return element("figure", {}, canvas, ...(name ? [element("figcaption", {}, name)] : []));
    });
    screen.prepend(...figures);
    for (const [key, value] of Object.entries({ tabindex: 0, role: "application", "aria-label": FILM_KEYS, title: FILM_KEYS })) screen.setAttribute(key, value);
    screen.onkeydown = (event) => this.key(event);
    screen.onclick = () => clock.toggle();
    this.root.classList.add("s2g-film");
    this.root.style.setProperty("--width", `${this.model.get("width")}px`);
    if (title) this.root.prepend(element("p", { class: "s2g-title" }, title));
  }

  resize() {
    const sharp = Math.min(2, window.devicePixelRatio || 1);
    for (const { canvas } of this.pictures) {
      const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((x) => Math.max(1, Math.round(x * sharp)));
      Object.assign(canvas, { width, height });
    }
    this.stale = true;
  }

  get ready() {
    return this.clock.sheets && (this.stale || this.clock.frame !== this.shownFrame);
  }
  draw() {
    const { clock, root: { dataset } } = this;
    this.shownFrame = clock.frame;
    const [sheet, left, top] = clock.find(this.shownFrame);
    this.pictures.forEach(({ canvas, small }, k) => {
      const { left: beside, width, height } = clock.films[k];
      small.getContext("2d").drawImage(sheet, left + beside, top, width, height, 0, 0, width, height);
      const large = canvas.getContext("2d");
      large.imageSmoothingQuality = "high";
      large.drawImage(small, 0, 0, canvas.width, canvas.height);
    });
    dataset.draws = 1 + +(dataset.draws ?? 0);
  }

  close() {
    super.close();
    this.resizing.disconnect();
  }
}

const createFilmPlayer = entry((model) => new FilmClock(model, "film"), (...place) => new FilmView(...place));
