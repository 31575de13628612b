// Players without a kernel: the same players on a model that only lives in the page.

class LocalModel {
  constructor(state) {
    this.state = state;
    this.listeners = [];
  }
  get(name) {
    return this.state[name];
  }
  set(name, value) {
    if (this.state[name] === value) return;
    this.state[name] = value;
    for (const [event, act] of [...this.listeners]) if (event === `change:${name}`) act();
  }
  on(event, act) {
    this.listeners.push([event, act]);
  }
  off(event, act) {
    this.listeners = this.listeners.filter(([e, a]) => e !== event || a !== act);
  }
  save_changes() {}
}

/** The bytes behind base64; a plain loop, because half an hour of motion and sound is 10^8 of them. */
function bytes(text) {
  const letters = atob(text);
  const found = new Uint8Array(letters.length);
  for (let k = 0; k < found.length; k++) found[k] = letters.charCodeAt(k);
  return found;
}

/** A player in `host`, of a state that nothing but the page knows. */
function openLocally(createPlayer, state, host) {
  const start = { frame: [0, 0], playing: [0, false] };
  const model = new LocalModel({ ...state, order: start, heard: start });
  const player = createPlayer();
  player.initialize({ model });
  player.render({ model, el: host });
  return model;
}

/** Buttons that show one motion alone, or all of them side by side. */
function addChoices(model, names, host) {
  const choices = [...names.map((name) => [name, name]), ["", "side by side"]];
  const buttons = choices.map(([view, text]) => {
    const button = element("button", { type: "button", "aria-pressed": view === model.get("view") }, text);
    button.onclick = () => {
      model.set("view", view);
      for (const other of buttons) other.setAttribute("aria-pressed", other === button);
    };
    return button;
  });
  host.append(...buttons);
}

/** A player in `host`, of what Python packed as base64; buttons for its motions, if several, above it. */
function openPlayer(content, host) {
  const packed = { mesh: bytes(content.mesh), motion: bytes(content.motion), sound: bytes(content.sound) };
  const { names } = unpack(packed.motion);
  const above = element("div", { class: "s2g-choices", role: "group", "aria-label": "Which motion" });
  if (names.length > 1) host.append(above);
  const model = openLocally(createPlayer, { ...content, ...packed }, host);
  addChoices(model, names, above);
}

/** A film player in `host`, of what Python packed as base64. */
function openFilm(content, host) {
  openLocally(createFilmPlayer, { ...content, sheets: bytes(content.sheets), sound: bytes(content.sound) }, host);
}
